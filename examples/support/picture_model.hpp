// SPDX-License-Identifier: MIT
// What the program asks of a model: a denoiser for maps, and pictures of latents.
#pragma once

#include <genrender/core/index.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/injection/any_denoiser.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace genrender {
struct rendered_guidance;
} // namespace genrender

namespace genrender::examples {

/// A denoiser with what turns maps into its conditioning and its latents into pictures.
class picture_model {
public:
    virtual ~picture_model() = default;
    /// What a person should know before the run.
    virtual std::vector<std::string> notes() const { return {}; }
    /// Pixels of a picture along a side of a token of the latents.
    virtual std::size_t scale() const = 0;
    /// Height and width of pictures of a square input, unless the command line names others.
    virtual grid_extents usual_size() const = 0;
    /// Whether usual_size() is the only one.
    virtual bool is_of_one_size() const { return false; }
    /// Height and width of its latents are whole multiples of this.
    virtual std::size_t grid_divisor() const { return 1; }
    /// What its denoiser does not tell of itself, in short: another for other weights or another prompt.
    virtual std::string key() const = 0;
    /// The lowest noise level of its training.
    virtual float sigma_min() const = 0;
    /// The highest.
    virtual float sigma_max() const = 0;
    /// The denoiser for these maps and pictures of these extents.
    virtual any_denoiser<float> network(rendered_guidance const& guidance, grid_extents image,
                                        any_loop const& loop) = 0;
    /// Pictures [frames, 3, height, width] in [0, 1] of latents, as a file will hold them.
    virtual tensor<float, 4> pictures(latents<float> const& z, any_loop const& loop) const = 0;

protected:
    picture_model() = default;
    picture_model(picture_model const&) = default;
    picture_model& operator=(picture_model const&) = default;
};

} // namespace genrender::examples
