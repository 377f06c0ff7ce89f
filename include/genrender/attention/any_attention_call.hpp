// SPDX-License-Identifier: MIT
// [GR eq. 1-3] Any engine's attention call behind one type.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/any_features.hpp>
#include <genrender/attention/attention_call.hpp>
#include <genrender/attention/feature_storage.hpp>
#include <genrender/attention/kept_variance.hpp>
#include <genrender/attention/length_correction.hpp>
#include <genrender/attention/projected_features.hpp>

#include <cstddef>
#include <span>
#include <utility>

namespace genrender {

/// Any attention_call, itself a model, a storing_, a projecting_ and a scaling_attention_call and a variance_keeping_call: what processors of any_features are given.
template <class Real>
class any_attention_call {
public:
    using features_type = any_features; ///< the engine's, held
    using real_type = Real;             ///< type of the weights of mix

    static constexpr bool scales_logits = true; ///< scaling_attention_call, as far as the engine's call is one

    static constexpr bool counts_keys = true; ///< counting_attention_call, the same

    /// Which site, which guidance branch.
    virtual attention_place place() const = 0;
    /// Which frame of the animation each entry of the frame axis is.
    virtual std::span<frame_index const> frames() const = 0;
    /// The input of the module.
    virtual any_features f() const = 0;
    /// W^Q f. Throws value_error, as all that follow, for features of another engine.
    virtual any_features query(any_features const& f) const = 0;
    /// W^K f.
    virtual any_features key(any_features const& f) const = 0;
    /// W^V f.
    virtual any_features value(any_features const& f) const = 0;
    /// All three of f, at once where the engine's call projects so.
    virtual projected_features<any_features> project(any_features const& f) const = 0;
    /// [GR eq. 1], each frame of the queries attending to its sources. Throws value_error if they are scaled and the
    /// engine's call is no scaling_attention_call.
    virtual any_features attend(any_features const& Q, attention_sources<any_features> const& sources) const = 0;
    /// F of eq. 6.
    virtual any_features mix(any_features const& F_hat, any_features const& F_KF,
                             std::span<sparse_rows<Real> const> rows, Real alpha) const = 0;
    /// The same with variance kept. Throws value_error too if it is and the engine's call is no variance_keeping_call.
    virtual any_features mix_keeping_variance(any_features const& F_hat, any_features const& F_KF,
                                              std::span<sparse_rows<Real> const> rows, Real alpha,
                                              kept_variance const& kept) const = 0;
    /// x in a format. Throws value_error if the engine's call cannot store it.
    virtual any_features stored(any_features const& x, feature_storage storage) const = 0;

protected:
    ~any_attention_call() = default;
};

/// An any_attention_call that runs an engine's, which it refers to.
template <attention_call Call>
class held_attention_call final : public any_attention_call<typename Call::real_type> {
public:
    using Real = typename Call::real_type;         ///< type of the weights of mix
    using Features = typename Call::features_type; ///< the engine's handle

    /// Runs `call`, which has to outlive this.
    explicit held_attention_call(Call& call) : call_(&call) {}

    attention_place place() const override { return call_->place(); }
    std::span<frame_index const> frames() const override { return call_->frames(); }
    any_features f() const override { return any_features::of<Features>(call_->f()); }
    any_features query(any_features const& f) const override {
        return any_features::of<Features>(call_->query(f.as<Features>()));
    }
    any_features key(any_features const& f) const override {
        return any_features::of<Features>(call_->key(f.as<Features>()));
    }
    any_features value(any_features const& f) const override {
        return any_features::of<Features>(call_->value(f.as<Features>()));
    }
    projected_features<any_features> project(any_features const& f) const override {
        auto own = projections_of(*call_, f.as<Features>());
        return {any_features::of<Features>(std::move(own.Q)), any_features::of<Features>(std::move(own.K)),
                any_features::of<Features>(std::move(own.V))};
    }
    any_features attend(any_features const& Q, attention_sources<any_features> const& sources) const override {
        auto const own =
            sources.template of_features<Features>([](any_features const& x) { return &x.as<Features>(); });
        return any_features::of<Features>(attend_scaled(*call_, Q.as<Features>(), own));
    }
    any_features mix(any_features const& F_hat, any_features const& F_KF, std::span<sparse_rows<Real> const> rows,
                     Real alpha) const override {
        return any_features::of<Features>(call_->mix(F_hat.as<Features>(), F_KF.as<Features>(), rows, alpha));
    }
    any_features mix_keeping_variance(any_features const& F_hat, any_features const& F_KF,
                                      std::span<sparse_rows<Real> const> rows, Real alpha,
                                      kept_variance const& kept) const override {
        return any_features::of<Features>(
            mixed_features(*call_, F_hat.as<Features>(), F_KF.as<Features>(), rows, alpha, kept));
    }
    any_features stored(any_features const& x, feature_storage storage) const override {
        return any_features::of<Features>(stored_features(*call_, x.as<Features>(), storage));
    }

private:
    Call* call_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
