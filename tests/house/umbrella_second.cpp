// SPDX-License-Identifier: MIT
// The second of two translation units that include the whole library.
#include <genrender/evaluation.hpp>
#include <genrender/genrender.hpp>
#include <genrender/inspection.hpp>
#include <genrender/reference.hpp>
#include <genrender/scene.hpp>

bool second_throws_what_first_catches() {
    try {
        genrender::require_value(false, "umbrella", "argument", 0, "1");
    } catch (genrender::value_error const&) {
        return true;
    }
    return false;
}
