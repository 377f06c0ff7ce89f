// SPDX-License-Identifier: MIT
// The program of the examples on a denoiser of your own: its scenes, models, maps, flags, pictures and reports.
#include "support/program.hpp"

#include <genrender/testing/analytic_denoiser.hpp>

using namespace genrender;

/// Knows pictures of soft colours, and mixes those of surface points that look alike.
struct my_denoiser : testing::analytic_denoiser<float> {
    my_denoiser() {
        grid = {32, 32};
        attention = 0.5F;
        site_list = {{"attn1", network_kind::denoising, network_part::decoder, grid, channels}};
    }
};

int main(int argc, char** argv) { return examples::run_program(argc, argv, my_denoiser{}); }
