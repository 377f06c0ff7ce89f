// SPDX-License-Identifier: MIT
// All that the two units share.
#pragma once

#include <genrender/injection/any_denoiser.hpp>

/// The engine.
genrender::any_denoiser<float> make_engine();
