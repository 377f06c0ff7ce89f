// SPDX-License-Identifier: MIT
// A denoiser of the user's own as a model of the program.
#pragma once

#include "picture_model.hpp"

#include <genrender/core/error.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>

namespace genrender::examples {

/// What the program has to be told of a denoiser of the user's own.
struct own_denoiser {
    any_denoiser<float> phi;    ///< it
    float sigma_min = 0.0292F;  ///< the lowest noise level of its training
    float sigma_max = 14.6146F; ///< the highest
    std::size_t scale = 1;      ///< pixels of a picture along a side of a token of the latents
    /// Pictures [frames, 3, height, width] of latents; empty for latents of three channels, which are pictures.
    std::function<tensor<float, 4>(latents<float> const&)> pictures{};
    /// Names its weights and whatever else changes frames, so that --resume refuses the run of another denoiser.
    std::string key{};
};

/// A model of pictures of one size, which knows its prompt by itself.
class own_model final : public picture_model {
public:
    /// Throws value_error if nothing says what pictures the latents are.
    explicit own_model(own_denoiser told) : told_(std::move(told)) {
        require_value(told_.pictures || told_.phi.latent_channels() == 3, "run_program", "pictures", "empty",
                      ("a function, since latents of " + std::to_string(told_.phi.latent_channels()) +
                       " channels are no pictures")
                          .c_str());
        require_value(told_.scale > 0, "run_program", "scale", told_.scale, "1 or more");
    }
    std::size_t scale() const override { return told_.scale; }
    grid_extents usual_size() const override {
        auto const grid = told_.phi.latent_grid();
        return {grid.height * told_.scale, grid.width * told_.scale};
    }
    bool is_of_one_size() const override { return true; }
    std::string key() const override { return told_.key; }
    float sigma_min() const override { return told_.sigma_min; }
    float sigma_max() const override { return told_.sigma_max; }
    any_denoiser<float> network(rendered_guidance const&, grid_extents, any_loop const&) override { return told_.phi; }
    tensor<float, 4> pictures(latents<float> const& z, any_loop const&) const override {
        auto images = told_.pictures ? told_.pictures(z) : tensor<float, 4>(z);
        auto const size = usual_size();
        require_extents("run_program", "pictures", images.shape(),
                        std::array<std::size_t, 4>{z.shape()[0], 3, size.height, size.width});
        for (auto& value : images) {
            value = std::clamp(value, 0.0F, 1.0F);
        }
        return images;
    }

private:
    own_denoiser told_;
};

} // namespace genrender::examples
