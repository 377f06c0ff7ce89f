// SPDX-License-Identifier: MIT
// LibTorch behind genrender: the attention call of features that are at::Tensor, on any of its devices.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/adapters/torch_mix.hpp>
#include <genrender/adapters/torch_plans.hpp>
#include <genrender/attention/attention_call.hpp>
#include <genrender/attention/feature_storage.hpp>
#include <genrender/attention/kept_variance.hpp>
#include <genrender/attention/length_correction.hpp>
#include <genrender/attention/projected_features.hpp>
#include <genrender/core/error.hpp>
#include <genrender/core/sparse_rows.hpp>

#include <ATen/core/Tensor.h>
#include <ATen/ops/addcmul.h>
#include <ATen/ops/cat.h>
#include <ATen/ops/embedding_bag.h>
#include <ATen/ops/linear.h>
#include <ATen/ops/scaled_dot_product_attention.h>
#include <ATen/ops/where.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace genrender::adapters {

/// A self-attention module as genrender asks for it: functions from features [frames, tokens, channels] to as many, and the
/// number of heads. It is kept by the engine, once a module.
struct torch_module {
    using projection = std::function<at::Tensor(at::Tensor const&)>; ///< from features to features
    projection query;                                                ///< W^Q f
    projection key;                                                  ///< W^K f
    projection value;                                                ///< W^V f
    std::int64_t heads = 1;                                          ///< of the attention, a divisor of channels
    /// The three at once, for engines that have one operation for them; empty for those that have not.
    std::function<projected_features<at::Tensor>(at::Tensor const&)> project{};

    /// Of three matrices [channels, channels] as at::linear takes them. Q, K and V are one multiplication of a matrix of
    /// its own, [3 channels, channels].
    static torch_module of_matrices(at::Tensor const& Q, at::Tensor const& K, at::Tensor const& V, std::int64_t heads) {
        auto const by = [](at::Tensor const& W) { return [W](at::Tensor const& f) { return at::linear(f, W); }; };
        auto const at_once = [QKV = at::cat({Q, K, V})](at::Tensor const& f) -> projected_features<at::Tensor> {
            auto const parts = at::linear(f, QKV).chunk(3, -1);
            return {parts[0], parts[1], parts[2]};
        };
        return {by(Q), by(K), by(V), heads, at_once};
    }
};

/// A model of attention_call over ATen: features are tensors [frames, tokens, channels] of any floating type on any device
/// and stay there. Attention is scaled_dot_product_attention, batched as the pattern of the sources allows; eq. 6 is one
/// embedding_bag, in float32 (float64 for such features). Features can be kept in 16 bits (storing_attention_call), and Q, K
/// and V come at once (projecting_attention_call). Put at::InferenceMode around the denoiser's call, which may run on any thread.
class torch_attention_call {
public:
    using real_type = float;          ///< type of the weights of mix
    using features_type = at::Tensor; ///< features on their device

    static constexpr bool scales_logits = true; ///< scaling_attention_call

    /// One run at `place` for `frames`, of a module with input f [frames, tokens, channels]; all but f and the plans, which
    /// are handles, must outlive it. Throws shape_error if f has another number of frames, value_error if heads do not
    /// divide its channels.
    torch_attention_call(attention_place place, std::span<frame_index const> frames, at::Tensor f,
                         torch_module const& module, torch_plans plans)
        : place_(place), frames_(frames), f_(std::move(f)), module_(&module), plans_(std::move(plans)) {
        require_value(f_.dim() == 3, "torch_attention_call", "f.dim()", f_.dim(), "[frames, tokens, channels]");
        require_frames("f", f_.size(0), frames.size());
        require_value(module.heads > 0 && f_.size(2) % module.heads == 0, "torch_attention_call", "module.heads",
                      module.heads, "a divisor of the channels of f");
    }

    /// Which site, which guidance branch.
    attention_place place() const { return place_; }
    /// Which frame of the animation each entry of the frame axis is.
    std::span<frame_index const> frames() const { return frames_; }
    /// The input of the module [frames, tokens, channels].
    at::Tensor f() const { return f_; }

    /// W^Q f.
    at::Tensor query(at::Tensor const& f) const { return module_->query(f); }
    /// W^K f.
    at::Tensor key(at::Tensor const& f) const { return module_->key(f); }
    /// W^V f.
    at::Tensor value(at::Tensor const& f) const { return module_->value(f); }
    /// W^Q f, W^K f and W^V f.
    projected_features<at::Tensor> project(at::Tensor const& f) const {
        return module_->project ? module_->project(f) : projected_features<at::Tensor>{query(f), key(f), value(f)};
    }

    /// F [frames, tokens, channels] of Q over its sources. Throws shape_error for sources of another number of frames.
    at::Tensor attend(at::Tensor const& Q, attention_sources<at::Tensor> const& sources) const {
        require_frames("sources", static_cast<std::int64_t>(sources.size()), static_cast<std::size_t>(Q.size(0)));
        auto const& pattern = sources.pattern();
        switch (pattern.meaning) {
        case attention_meaning::own:
            if (are_alike(sources.scales())) {
                return attention(Q, *pattern.K, *pattern.V, scale_of(sources, 0));
            }
            break;
        case attention_meaning::stack: // All frames have the same keys: one long row of queries.
            if (are_alike(sources.scales())) {
                return attention(in_a_row(Q), in_a_row(*pattern.K), in_a_row(*pattern.V), scale_of(sources, 0))
                    .view_as(Q);
            }
            break;
        case attention_meaning::own_and_joined:
            return attend_to_joined(Q, sources);
        case attention_meaning::listed:
            break;
        }
        std::vector<at::Tensor> F;
        for (std::int64_t i = 0; i < Q.size(0); ++i) {
            std::vector<at::Tensor> K;
            std::vector<at::Tensor> V;
            for (auto const& block : sources[static_cast<std::size_t>(i)]) {
                K.push_back(block.K->narrow(0, static_cast<std::int64_t>(block.frame), 1).to(Q.scalar_type()));
                V.push_back(block.V->narrow(0, static_cast<std::int64_t>(block.frame), 1).to(Q.scalar_type()));
            }
            F.push_back(attention(Q.narrow(0, i, 1), at::cat(K, 1), at::cat(V, 1),
                                  scale_of(sources, static_cast<std::size_t>(i))));
        }
        return at::cat(F);
    }

    /// F_out of eq. 6, in memory of its own unless a kernel of the device (torch_mix_kernel_of) writes into F_hat. Throws
    /// shape_error if rows are of other frames or tokens than F_hat, value_error as make_call_rows does.
    at::Tensor mix(at::Tensor const& F_hat, at::Tensor const& F_KF, std::span<sparse_rows<float> const> rows,
                   float alpha) const {
        require_frames("rows", static_cast<std::int64_t>(rows.size()), static_cast<std::size_t>(F_hat.size(0)));
        if (alpha == 0) {
            return F_hat;
        }
        return mix_torch_rows(F_hat, F_KF, plans_.rows(rows, alpha, F_hat.device()));
    }

    /// The same with variance kept (variance_keeping_call), in sums over the tokens of a frame; what F_hat holds at tokens
    /// that no keyframe covers is multiplied by 0 there and has to be finite. Throws as `mix` does, value_error for a
    /// most_gain below 1.
    at::Tensor mix_keeping_variance(at::Tensor const& F_hat, at::Tensor const& F_KF,
                                    std::span<sparse_rows<float> const> rows, float alpha,
                                    kept_variance const& kept) const {
        require_kept_variance("torch_attention_call", kept);
        if (kept.target == variance_target::none || alpha == 0 || F_hat.numel() == 0) {
            return mix(F_hat, F_KF, rows, alpha);
        }
        require_frames("rows", static_cast<std::int64_t>(rows.size()), static_cast<std::size_t>(F_hat.size(0)));
        auto const plan = plans_.rows(rows, alpha, F_hat.device());
        auto const type = c10::promoteTypes(F_hat.scalar_type(), at::kFloat);
        require_extents("torch_attention_call::mix", "rows", std::array{static_cast<std::size_t>(plan.own.size(0))},
                        std::array{static_cast<std::size_t>(F_hat.size(0) * F_hat.size(1))});
        auto const all = F_KF.reshape({-1, F_KF.size(2)}).to(type);
        auto const shift = all.mean(0, true); // A mean far from 0 costs no digits.
        auto const X = all.sub(shift);
        auto const own = F_hat.reshape({-1, F_hat.size(2)}).to(type).sub(shift);
        auto const weights = plan.weights.to(type);
        auto const sum_of = [&](at::Tensor const& x) {
            constexpr std::int64_t sum = 0;
            return std::get<0>(at::embedding_bag(x, plan.index, plan.offsets, false, sum, false, weights, true));
        };
        auto const by_frames = [&](at::Tensor const& x) { return x.view({F_hat.size(0), F_hat.size(1), -1}); };
        auto const own_share = plan.own.to(type);
        auto const blended = sum_of(X);
        auto const F = by_frames(at::addcmul(blended, own, own_share));
        auto const squares = sum_of(X.square());
        auto const ends = plan.offsets.slice(0, 1);
        auto const is_covered = by_frames(ends.gt(plan.offsets.slice(0, 0, -1)).unsqueeze(1));
        auto const covered = is_covered.to(type);
        auto const count = covered.sum(1, true);
        auto const mean_of = [&](at::Tensor const& x, double weight) {
            return by_frames(x).mul(covered).sum(1, true).div(count.mul(weight).clamp_min(1e-30));
        };
        auto const mean = mean_of(F, 1);
        auto const from = mean_of(F.sub(mean).square(), 1);
        at::Tensor to;
        if (kept.target == variance_target::total) {
            to = mean_of(at::addcmul(squares, own.square(), own_share), 1).sub(mean.square());
        } else {
            to = mean_of(squares, double{alpha}).sub(mean_of(blended, double{alpha}).square());
        }
        auto const has_gain = from.gt(0).logical_and(to.gt(0)).logical_and(count.gt(1));
        auto const gain =
            to.div(from).sqrt().clamp(1 / kept.most_gain, kept.most_gain).masked_fill(has_gain.logical_not(), 1);
        auto const kept_F = mean.add(F.sub(mean).mul(gain)).add(shift);
        return at::where(is_covered, kept_F.to(F_hat.scalar_type()), F_hat);
    }

    /// x kept in a format, as storing_attention_call has it.
    at::Tensor stored(at::Tensor const& x, feature_storage storage) const {
        switch (storage) {
        case feature_storage::f16:
            return x.to(at::kHalf);
        case feature_storage::bf16:
            return x.to(at::kBFloat16);
        case feature_storage::same:
            break;
        }
        return x;
    }

private:
    static void require_frames(char const* argument, std::int64_t found, std::size_t expected) {
        require_extents("torch_attention_call", argument, std::array{static_cast<std::size_t>(found)},
                        std::array{expected});
    }

    /// A stack as one frame that has the tokens of all.
    static at::Tensor in_a_row(at::Tensor const& x) { return x.reshape({1, -1, x.size(2)}); }

    /// Whether all frames have the same scale.
    static bool are_alike(std::span<double const> scales) {
        return std::adjacent_find(scales.begin(), scales.end(), std::not_equal_to<>()) == scales.end();
    }

    /// The scale of a frame; 1 where there is no frame.
    static double scale_of(attention_sources<at::Tensor> const& sources, std::size_t i) {
        return sources.empty() ? 1.0 : sources.scale(i);
    }

    /// Frame i of Q over frame i of K and V, in the scalars of Q, with logits times `scale`.
    at::Tensor attention(at::Tensor const& Q, at::Tensor const& K, at::Tensor const& V, double scale) const {
        auto const by_heads = [&](at::Tensor const& x) {
            return x.to(Q.scalar_type()).unflatten(2, {module_->heads, x.size(2) / module_->heads}).transpose(1, 2);
        };
        auto const d = static_cast<double>(Q.size(2) / module_->heads);
        auto const of_logits = scale == 1.0 ? std::nullopt : std::optional(scale / std::sqrt(d));
        return at::scaled_dot_product_attention(by_heads(Q), by_heads(K), by_heads(V), {}, 0.0, false, of_logits)
            .transpose(1, 2)
            .flatten(2);
    }

    /// Eq. 5. Frames one after the other that leave out the same keyframe, or none, and have one scale are a batch.
    at::Tensor attend_to_joined(at::Tensor const& Q, attention_sources<at::Tensor> const& sources) const {
        auto const& pattern = sources.pattern();
        auto const frames = static_cast<std::size_t>(Q.size(0));
        auto const left_out = [&](std::size_t i) {
            return pattern.left_out.empty() ? std::nullopt : pattern.left_out[i];
        };
        std::vector<at::Tensor> F;
        for (std::size_t first = 0, count = 1; first < frames; first += count, count = 1) {
            while (first + count < frames && left_out(first + count) == left_out(first) &&
                   sources.scale(first + count) == sources.scale(first)) {
                ++count;
            }
            auto const begin = static_cast<std::int64_t>(first);
            auto const size = static_cast<std::int64_t>(count);
            auto const joined = [&](at::Tensor const& own, at::Tensor const& keyframes) {
                auto kept = keyframes.to(Q.scalar_type());
                if (auto const k = left_out(first)) {
                    auto const before = static_cast<std::int64_t>(*k);
                    kept = at::cat({kept.narrow(0, 0, before), kept.narrow(0, before + 1, kept.size(0) - before - 1)});
                }
                return at::cat({own.narrow(0, begin, size), in_a_row(kept).expand({size, -1, -1})}, 1);
            };
            F.push_back(attention(Q.narrow(0, begin, size), joined(*pattern.K, *pattern.K_KF),
                                  joined(*pattern.V, *pattern.V_KF), sources.scale(first)));
        }
        return F.size() == 1 ? F.front() : at::cat(F);
    }

    attention_place place_;
    std::span<frame_index const> frames_;
    at::Tensor f_;
    torch_module const* module_;
    torch_plans plans_;
};

} // namespace genrender::adapters

#include <genrender/core/end_header.inl>
