// SPDX-License-Identifier: MIT
// A program of somebody who loads engines: a table of functions of another version is refused.
#include <genrender/c.hpp>

#include <iostream>

int main() {
    genrender_engine engine{};
    engine.version = GENRENDER_ENGINE_VERSION + 1;
    try {
        genrender::c::engine_denoiser const denoiser(engine);
    } catch (genrender::value_error const& error) {
        std::cout << error.what() << '\n';
        return 0;
    }
    return 1;
}
