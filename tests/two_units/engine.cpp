// SPDX-License-Identifier: MIT
// The engine's unit: it knows the engine and nothing of the pipeline.
#include "engine.hpp"

#include "../testing/second_denoiser.hpp"

genrender::any_denoiser<float> make_engine() { return second_engine::denoiser(); }
