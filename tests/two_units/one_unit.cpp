// SPDX-License-Identifier: MIT
// The same run where one unit knows engine and pipeline.
#include "../testing/second_denoiser.hpp"
#include "moving_strip.hpp"

int main() { return print_frames(second_engine::denoiser()); }
