// SPDX-License-Identifier: MIT
// A program of somebody who looks at his maps: every pixel is background, which is found.
#include <genrender/maps/uv_maps.hpp>
#include <genrender/inspection.hpp>

#include <iostream>

int main() {
    genrender::uv_maps const maps(2, {8, 8});
    auto const findings = genrender::recommendations_on(genrender::check_maps(to_uv_view(maps)), {4, 4});
    for (auto const& one : findings) {
        std::cout << one.name() << '\n';
    }
    return findings.empty() ? 1 : 0;
}
