// SPDX-License-Identifier: MIT
// A denoiser whose sites are numbers instead of descriptions.
// expected: denoiser: sites() is const and returns a random access range of attention_site
#include "right_models.hpp"

#include <vector>

struct sites_are_numbers : right_denoiser {
    std::vector<int> sites() const;
};

int main() { genrender::require_denoiser<sites_are_numbers>(); }
