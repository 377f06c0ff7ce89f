// SPDX-License-Identifier: MIT
// The pipeline's unit: it renders with an engine that it does not know.
#include "engine.hpp"
#include "moving_strip.hpp"

int main() { return print_frames(make_engine()); }
