// SPDX-License-Identifier: MIT
// A denoiser that takes one processor and is no template.
// expected: and is a template for every processor
#include "right_models.hpp"

#include <genrender/attention/plain_attention.hpp>

struct of_one_processor : right_denoiser {
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, genrender::plain_attention const& processor) const;
};

int main() { genrender::require_denoiser<of_one_processor>(); }
