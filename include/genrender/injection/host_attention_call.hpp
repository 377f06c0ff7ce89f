// SPDX-License-Identifier: MIT
// [GR eq. 1-6] The attention call of an engine whose features lie in host memory: all it brings is its projections.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_call.hpp>
#include <genrender/attention/host_features.hpp>
#include <genrender/attention/scaled_dot_product.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/injection/post_attention.hpp>

#include <cstddef>
#include <deque>
#include <span>
#include <utility>
#include <vector>

namespace genrender {

/// What an engine brings of a self-attention module to a host_attention_call.
///
/// expression                                                        | type   | meaning
/// ------------------------------------------------------------------|--------|---------------------------------------
/// `module.query(out, f)` `module.key(out, f)` `module.value(out, f)` | void   | writes W^Q f, W^K f, W^V f [tokens,
///                                                                   |        | channels] of the features f [tokens,
///                                                                   |        | channels] of one frame into `out`
/// `module.heads()`                                                  | size_t | attention heads, a divisor of channels
///
/// All members are const and may be called from the threads of the call's loop at once.
template <class Projections, class Real>
concept attention_projections = requires(Projections const& module, strided_view<Real, 2> out,
                                         strided_view<Real const, 2> f) {
    module.query(out, f);
    module.key(out, f);
    module.value(out, f);
    { module.heads() } -> std::convertible_to<std::size_t>;
};

/// A model of attention_call over views: `f` is read where the engine keeps it, results are new memory that the handle
/// owns. Frames run through `loop`. Features can be kept in 16 bits (storing_attention_call).
template <class Real, attention_projections<Real> Projections>
class host_attention_call {
public:
    using real_type = Real;                    ///< type of the weights of mix
    using features_type = host_features<Real>; ///< features in host memory

    static constexpr bool scales_logits = true; ///< scaling_attention_call
    static constexpr bool counts_keys = true;   ///< counting_attention_call

    /// One run at `place` for `frames`, of a module with input f [frames, tokens, channels]. Throws shape_error if f
    /// has another number of frames. `frames`, f and `module` must outlive the call.
    host_attention_call(attention_place place, std::span<frame_index const> frames, features_type f,
                        Projections const& module, any_loop loop = {})
        : place_(place), frames_(frames), f_(std::move(f)), module_(&module), loop_(std::move(loop)) {
        require_extents("host_attention_call", "f", f_.extents(),
                        std::array{frames.size(), f_.extents()[1], f_.extents()[2]});
    }

    /// Which site, which guidance branch.
    attention_place place() const { return place_; }
    /// Which frame of the animation each entry of the frame axis is.
    std::span<frame_index const> frames() const { return frames_; }
    /// The input of the module [frames, tokens, channels].
    features_type f() const { return f_; }

    /// W^Q f [GR eq. 2], in new memory. Throws as the module's projection does.
    features_type query(features_type const& f) const {
        return projected(f, [this](auto out, auto in) { module_->query(out, in); });
    }
    /// W^K f [GR eq. 2], in new memory. Throws as the module's projection does.
    features_type key(features_type const& f) const {
        return projected(f, [this](auto out, auto in) { module_->key(out, in); });
    }
    /// W^V f [GR eq. 2], in new memory. Throws as the module's projection does.
    features_type value(features_type const& f) const {
        return projected(f, [this](auto out, auto in) { module_->value(out, in); });
    }

    /// [GR eq. 1] for every frame of Q over its own list of blocks.
    features_type attend(features_type const& Q, attention_sources<features_type> const& sources) const {
        require_extents("host_attention_call::attend", "sources", std::array{sources.size()},
                        std::array{Q.extents()[0]});
        auto F = features_type::allocate(Q.extents());
        loop_(sources.size(), [&](std::size_t i) {
            std::vector<key_value_view<Real>> blocks;
            std::deque<std::vector<Real>> counts; // of blocks that have some
            blocks.reserve(sources[i].size());
            for (auto const& block : sources[i]) {
                blocks.push_back({rows_of(*block.K, block.frame), rows_of(*block.V, block.frame)});
                if (block.counts != nullptr) {
                    auto const tokens = blocks.back().K.extent(0);
                    auto const& of = counts.emplace_back(block.counts, block.counts + tokens);
                    blocks.back().counts = strided_view<Real const, 1>(of.data(), {tokens});
                }
            }
            scaled_dot_product(F.view()[i], Q.view()[i], blocks, module_->heads(), loop_,
                               static_cast<Real>(sources.scale(i)));
        });
        return F;
    }

    /// [GR eq. 6] in place of F_hat.
    features_type mix(features_type const& F_hat, features_type const& F_KF, std::span<sparse_rows<Real> const> rows,
                      Real alpha) const {
        return mix_keeping_variance(F_hat, F_KF, rows, alpha, {});
    }

    /// The same with variance kept, as variance_keeping_call has it.
    features_type mix_keeping_variance(features_type const& F_hat, features_type const& F_KF,
                                       std::span<sparse_rows<Real> const> rows, Real alpha,
                                       kept_variance const& kept) const {
        require_extents("host_attention_call::mix", "rows", std::array{rows.size()}, std::array{F_hat.extents()[0]});
        loop_(rows.size(), [&](std::size_t i) {
            F_KF.visit([&](auto const& stored) { post_attention(F_hat.view()[i], stored, rows[i], alpha, kept); });
        });
        return F_hat;
    }

    /// x kept in a format, as storing_attention_call has it.
    features_type stored(features_type const& x, feature_storage storage) const {
        return storage == feature_storage::same ? x : features_type::rounded(x.view(), storage);
    }

private:
    /// One frame's rows, as they are kept.
    static stored_view<Real> rows_of(features_type const& features, std::size_t frame) {
        return features.visit([frame](auto const& kept) { return stored_view<Real>(kept[frame]); });
    }

    template <class Projection>
    features_type projected(features_type const& f, Projection const& project) const {
        auto out = features_type::allocate(f.extents());
        loop_(f.extents()[0], [&](std::size_t i) { project(out.view()[i], strided_view<Real const, 2>(f.view()[i])); });
        return out;
    }

    attention_place place_;
    std::span<frame_index const> frames_;
    features_type f_;
    Projections const* module_;
    any_loop loop_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
