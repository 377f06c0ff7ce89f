// SPDX-License-Identifier: MIT
// The program of the examples, with any denoiser.
#pragma once

#include "own_model.hpp"
#include "picture_model.hpp"

#include <genrender/sampling/denoiser.hpp>

#include <functional>
#include <memory>
#include <utility>

namespace genrender::examples {

struct render_options;

/// Makes the model that the options name. Throws value_error or file_error that say what is wrong.
using make_model = std::function<std::unique_ptr<picture_model>(render_options const&)>;

/// Whose denoiser the program renders with, which decides on its options.
enum class program_kind {
    of_models, ///< one that the options name
    own        ///< one that the caller gives: there are no options for prompt, size and model
};

/// Reads the command line, renders and writes pictures and report. The exit code: 0 done, 1 failed, 2 bad arguments.
int run_program(int argc, char const* const* argv, program_kind kind, make_model const& make);

/// The program with a denoiser of the user's own: all its options but those of prompt, size and model.
inline int run_program(int argc, char const* const* argv, own_denoiser const& told) {
    return run_program(argc, argv, program_kind::own,
                       [&](render_options const&) { return std::make_unique<own_model>(told); });
}

/// The same for one whose latents are pictures and whose noise levels are Stable Diffusion's.
template <denoiser Phi>
int run_program(int argc, char const* const* argv, Phi phi) {
    return run_program(argc, argv, own_denoiser{.phi = any_denoiser<float>(std::move(phi))});
}

} // namespace genrender::examples
