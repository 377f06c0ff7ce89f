// SPDX-License-Identifier: MIT
// Models that are right, for mistakes to be made in.
#pragma once

#include <genrender/attention/attention_call.hpp>
#include <genrender/sampling/denoiser.hpp>
#include <genrender/sampling/latent_lender.hpp>

#include <span>

using genrender::frame_index;
using genrender::strided_view;

struct features {};
struct engine_latents {};

using right_denoiser = genrender::denoiser_archetype<float, features>;
using right_lender = genrender::latent_lender_archetype<float, features, engine_latents>;
using right_call = genrender::attention_call_archetype<features, float>;
