// SPDX-License-Identifier: MIT
// The same sentences without a run.
// expected: denoiser: branches() is const and returns the number of guidance branches
#include <genrender/sampling/denoiser.hpp>

#include "right_models.hpp"

struct without_branches : right_denoiser {
    void branches() const;
};

int main() { genrender::require_denoiser<without_branches>(); }
