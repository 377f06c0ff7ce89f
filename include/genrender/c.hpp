// SPDX-License-Identifier: MIT
// The component c: engines as tables of functions, for hosts and engines below C++20.
#pragma once

#include <genrender/c/engine.h>
#include <genrender/c/engine_call.hpp>
#include <genrender/c/engine_denoiser.hpp>
