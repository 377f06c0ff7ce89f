// SPDX-License-Identifier: MIT
// The program of the examples on a denoiser of your own: its scenes, models, maps, flags, pictures and reports.
#include "support/program.hpp"

#include <genrender/testing/analytic_denoiser.hpp>

using namespace genrender;

/// Knows pictures of soft colours, and mixes those of surface points that look alike; engine_in_c/blur_engine.c in C++.
struct my_denoiser : testing::analytic_denoiser<float> {
    my_denoiser() {
        grid = {16, 16};
        attention = 0.5F;
        guidance_branches = 2;
        site_list = {{"decoder.attn1", network_kind::denoising, network_part::decoder, grid, channels}};
    }
};

// One whose noise levels are Stable Diffusion's needs no more than run_program(argc, argv, my_denoiser{}).
int main(int argc, char** argv) {
    return examples::run_program(argc, argv, {.phi = my_denoiser{}, .sigma_min = 0.02F, .sigma_max = 10});
}
