// SPDX-License-Identifier: MIT
// [GR alg. 1] The whole run written down once more in plain PyTorch: of the library it has what geometry decides, namely
// noise, noise levels, keyframes and rows of eq. 6. All else, eqs. 1 to 6, guidance, normalisation and Euler's steps, is here.
#pragma once

#include "../comparison.hpp"

#include <genrender/adapters/torch_denoiser.hpp>
#include <genrender/blending/blend_plan.hpp>
#include <genrender/blending/padded_rows.hpp>
#include <genrender/core/error.hpp>
#include <genrender/correspondence/chosen_correspondence.hpp>
#include <genrender/keyframes/draw_keyframes.hpp>
#include <genrender/maps/background_mask.hpp>
#include <genrender/noise/initial_noise.hpp>
#include <genrender/sampling/karras_schedule.hpp>

#include <ATen/ATen.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

/// One run of a network whose output is a velocity, with guidance, for the settings of a case: Euler's method, means
/// normalised, keyframes' average by quality, alpha 0.7 at every module of the decoder.
class plain_run {
public:
    plain_run(adapters::torch_network network, adapters::torch_conditioning told, engine_case const& given)
        : network_(std::move(network)), told_(std::move(told)), given_(&given) {
        require_value(told_.predicted == prediction::velocity, "plain_run", "told.predicted",
                      static_cast<int>(told_.predicted), "velocity");
    }

    /// z_0 [frames, channels, height, width], on the network's device.
    at::Tensor operator()() {
        c10::InferenceMode const no_gradients;
        auto const& settings = given_->settings;
        auto const scale = given_->config.hint_scale();
        auto const& hint = given_->conditioning.hint;
        grid_ = {hint.extent(2) / scale, hint.extent(3) / scale};
        std::vector<frame_index> every;
        for (std::uint32_t i = 0; i < hint.extent(0); ++i) {
            every.push_back({i});
        }
        auto noise = latents<float>::from_shape({every.size(), given_->config.in_channels, grid_.height, grid_.width});
        initial_noise(to_view(noise), to_uv_view(given_->UV), every, settings.noise);
        auto const sigmas =
            karras_schedule<float>(settings.steps, settings.sigma_min, settings.sigma_max, settings.rho);
        auto z = on_device(adapters::tensor_of(to_view(noise))) * sigmas[0];
        auto const mask = background_mask(to_uv_view(given_->UV), grid_);
        auto const background = on_device(adapters::tensor_of(to_view(mask))).unsqueeze(1);
        for (std::size_t step = 0; step < settings.steps; ++step) {
            keyframes_ = draw_keyframes(settings.keyframes, every.size(), step);
            rows_.clear();
            bank_.clear();
            is_recording_ = true;
            estimate(z.index_select(0, numbers(keyframes_)), sigmas[step], keyframes_);
            is_recording_ = false;
            auto const x0 = normalized(estimate(z, sigmas[step], every), background);
            z = x0 + sigmas[step + 1] / sigmas[step] * (z - x0);
        }
        return z;
    }

private:
    at::Tensor on_device(at::Tensor const& x) const { return x.to(told_.hints.device(), x.scalar_type(), false, true); }

    at::Tensor numbers(std::vector<frame_index> const& frames) const {
        std::vector<std::int64_t> values;
        for (auto const frame : frames) {
            values.push_back(frame.value);
        }
        return at::tensor(values).to(told_.hints.device());
    }

    /// x0 = a^2 z - b F of the velocity F that guidance gives, with a = 1 / sqrt(1 + sigma^2) and b = a sigma.
    at::Tensor estimate(at::Tensor const& z, float sigma, std::vector<frame_index> const& frames) {
        auto const a = 1 / std::sqrt(1 + sigma * sigma);
        auto const t = told_.schedule.t_of(static_cast<double>(sigma));
        auto const hints = told_.hints.index_select(0, numbers(frames));
        std::vector<at::Tensor> F;
        for (std::size_t branch = 0; branch < 2; ++branch) {
            F.push_back(network_(a * z, t, told_.prompts[branch], hints,
                                 [&](std::string const& name, at::Tensor const& f, at::Tensor const& Q,
                                     at::Tensor const& K, at::Tensor const& V, std::int64_t heads) {
                                     auto const q = at::linear(f, Q);
                                     auto const k = at::linear(f, K);
                                     auto const v = at::linear(f, V);
                                     return name.rfind("up_blocks.", 0) != 0 ? attention(q, k, v, heads)
                                            : is_recording_                  ? record({branch, name}, q, k, v, heads)
                                                            : inject(bank_.at({branch, name}), frames, q, k, v, heads);
                                 }));
        }
        return a * a * z - a * sigma * (F[0] + told_.guidance_scale * (F[1] - F[0]));
    }

    /// Eq. 1, written out: softmax(Q K^T / sqrt(d)) V, head by head.
    static at::Tensor attention(at::Tensor const& Q, at::Tensor const& K, at::Tensor const& V, std::int64_t heads) {
        auto const by_heads = [&](at::Tensor const& x) { return x.unflatten(2, {heads, -1}).transpose(1, 2); };
        auto const q = by_heads(Q);
        auto const logits = at::matmul(q, by_heads(K).transpose(2, 3)) / std::sqrt(static_cast<double>(q.size(3)));
        return at::matmul(at::softmax(logits, -1), by_heads(V)).transpose(1, 2).flatten(2);
    }

    using place = std::pair<std::size_t, std::string>;
    struct kept_features {
        at::Tensor K; ///< [1, keyframes * tokens, channels], as the others
        at::Tensor V;
        at::Tensor F;
    };

    /// Eq. 3: keyframes attend to all of them.
    at::Tensor record(place const& at, at::Tensor const& Q, at::Tensor const& K, at::Tensor const& V,
                      std::int64_t heads) {
        auto const row = [](at::Tensor const& x) { return x.reshape({1, -1, x.size(2)}); };
        auto const F = attention(row(Q), row(K), row(V), heads);
        bank_[at] = {row(K), row(V), F};
        return F.view_as(Q);
    }

    /// Eqs. 5 and 6: frames attend to themselves and the keyframes, and mix in what these look like.
    at::Tensor inject(kept_features const& kept, std::vector<frame_index> const& frames, at::Tensor const& Q,
                      at::Tensor const& K, at::Tensor const& V, std::int64_t heads) {
        auto const joined = [](at::Tensor const& own, at::Tensor const& more) {
            return at::cat({own, more.expand({own.size(0), -1, -1})}, 1);
        };
        auto const F_hat = attention(Q, joined(K, kept.K), joined(V, kept.V), heads);
        auto const& rows = rows_of(static_cast<std::size_t>(Q.size(1)), frames);
        auto const gathered = kept.F[0].index_select(0, rows.index.flatten()).unflatten(0, rows.index.sizes());
        return rows.own * F_hat + (rows.weights * gathered).sum(2);
    }

    struct device_rows {
        at::Tensor index;   ///< [frames, tokens, width]
        at::Tensor weights; ///< [frames, tokens, width, 1]
        at::Tensor own;     ///< [frames, tokens, 1]
    };

    /// The rows of eq. 6 of this step at a feature grid.
    device_rows const& rows_of(std::size_t tokens, std::vector<frame_index> const& frames) {
        if (auto const found = rows_.find(tokens); found != rows_.end()) {
            return found->second;
        }
        auto const& settings = given_->settings;
        auto grid = grid_;
        while (grid.size() > tokens) {
            grid = {grid.height / 2, grid.width / 2};
        }
        auto const UV = to_uv_view(given_->UV);
        auto const& map = maps_.try_emplace(tokens, UV, grid, settings.correspondence, any_loop{}).first->second;
        std::vector<blend_plan<float>> plans;
        std::vector<sparse_rows<float>> sparse;
        for (auto const i : frames) {
            plans.push_back(make_blend_plan<float>(map, keyframes_, i, settings.first_fill_share, settings.average));
        }
        for (auto const& plan : plans) {
            sparse.push_back(plan.rows());
        }
        auto padded = make_padded_rows(sparse, static_cast<float>(paper_alpha));
        auto const rows = padded.view();
        return rows_[tokens] = {on_device(adapters::tensor_of(rows.index)),
                                on_device(adapters::tensor_of(rows.weights)).unsqueeze(3),
                                on_device(adapters::tensor_of(rows.own)).unsqueeze(2)};
    }

    /// Every frame with the means of the first one's background over its own; frames without background stay.
    static at::Tensor normalized(at::Tensor const& x0, at::Tensor const& background) {
        auto const pixels = background.sum({2, 3}, true);
        auto const means = (x0 * background).sum({2, 3}, true) / pixels.clamp_min(1);
        auto const counts = (pixels >= 2).logical_and(pixels.slice(0, 0, 1) >= 2);
        return x0 + counts * (means.slice(0, 0, 1) - means);
    }

    adapters::torch_network network_;
    adapters::torch_conditioning told_;
    engine_case const* given_;
    grid_extents grid_{};
    std::vector<frame_index> keyframes_;
    bool is_recording_ = false;
    std::map<place, kept_features> bank_;
    std::map<std::size_t, device_rows> rows_; ///< of a step, by number of tokens
    std::map<std::size_t, chosen_correspondence<2>> maps_;
};

} // namespace genrender::examples
