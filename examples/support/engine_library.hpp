// SPDX-License-Identifier: MIT
// An engine that is loaded from a library, over the header of C.
#pragma once

#include <genrender/c/engine_denoiser.hpp>
#include <genrender/core/error.hpp>

#include <dlfcn.h>

#include <filesystem>
#include <string>

namespace genrender::examples {

/// The engine of a library that exports genrender_engine_of (genrender/c/engine.h). The library stays loaded until the
/// program ends, since features of it may live as long. Throws file_error if the library cannot be loaded, exports no
/// such function or gives no engine, and what engine_denoiser throws for a table that it refuses.
inline c::engine_denoiser load_engine(std::filesystem::path const& path) {
    auto const fail = [&](std::string const& what) -> file_error { return file_error(path.string() + ": " + what); };
    if (!std::filesystem::exists(path)) {
        throw fail("there is nothing, expected the library of an engine");
    }
    // A path with a slash, or it would be looked for among the system's.
    auto* const library = dlopen(std::filesystem::absolute(path).c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) {
        throw fail(std::string("is no library that can be loaded: ") + dlerror());
    }
    auto* const symbol = dlsym(library, GENRENDER_ENGINE_FUNCTION);
    if (symbol == nullptr) {
        throw fail("has no function " GENRENDER_ENGINE_FUNCTION ", expected that of genrender/c/engine.h");
    }
    auto const* const engine = reinterpret_cast<genrender_engine_function>(symbol)();
    if (engine == nullptr) {
        throw fail(GENRENDER_ENGINE_FUNCTION " gave no engine");
    }
    return c::engine_denoiser(*engine);
}

} // namespace genrender::examples
