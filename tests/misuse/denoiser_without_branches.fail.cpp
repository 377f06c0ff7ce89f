// SPDX-License-Identifier: MIT
// A denoiser without branches().
// expected: denoiser: branches() is const and returns the number of guidance branches
#include "right_models.hpp"

struct without_branches : right_denoiser {
    void branches() const; // hides the right one, as if it were missing
};

int main() { genrender::require_denoiser<without_branches>(); }
