// SPDX-License-Identifier: MIT
// Models that are right, for mistakes to be made in.
#pragma once

#include <genrender/attention/attention_call.hpp>
#include <genrender/sampling/denoiser.hpp>

#include <span>

using genrender::frame_index;
using genrender::strided_view;

struct features {};

using right_denoiser = genrender::denoiser_archetype<float, features>;
using right_call = genrender::attention_call_archetype<features, float>;
