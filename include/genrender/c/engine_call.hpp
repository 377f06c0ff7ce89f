// SPDX-License-Identifier: MIT
// [GR eq. 1-3] Features of an engine of C, and one run of one of its modules.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_call.hpp>
#include <genrender/attention/length_correction.hpp>
#include <genrender/c/engine.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace genrender::c {

/// An engine of C failed. Text: `engine: ` and what the engine said.
struct engine_error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A share in features of an engine, which are released with the last.
class engine_features {
public:
    /// Holds nothing.
    engine_features() = default;
    /// Takes `features` over. Throws engine_error for null, which the engine returns when `function` fails.
    engine_features(genrender_engine const& engine, genrender_features* features, char const* function) {
        if (features == nullptr) {
            throw engine_error(std::string("engine: ") + function + " returned no features");
        }
        held_ = std::shared_ptr<genrender_features>(
            features, [&engine](genrender_features* given) { engine.release(engine.context, given); });
    }
    /// Refers to features that stay the engine's and outlive every copy.
    explicit engine_features(genrender_features* lent) : held_(std::shared_ptr<void>(), lent) {}
    /// The engine's handle.
    genrender_features* get() const { return held_.get(); }

private:
    std::shared_ptr<genrender_features> held_;
};

/// Scales of logits as the engine takes them.
inline std::vector<float> scales_of(std::span<double const> scales) { return {scales.begin(), scales.end()}; }

/// Rows of each frame as the engine takes them.
inline std::vector<genrender_rows> rows_of(std::span<sparse_rows<float> const> rows) {
    std::vector<genrender_rows> plain;
    for (auto const& one : rows) {
        plain.push_back({one.offsets.data(), one.sources.data(), one.weights.data(), one.row_count()});
    }
    return plain;
}

/// Numbers of frames as the library counts them.
inline std::vector<frame_index> frames_of(std::uint32_t const* numbers, std::size_t count) {
    std::vector<frame_index> frames;
    for (std::size_t i = 0; i < count; ++i) {
        frames.push_back({numbers[i]});
    }
    return frames;
}

/// One run of a module of an engine of C: a model of attention_call. All operations throw engine_error if the engine
/// fails.
class engine_call {
public:
    using features_type = engine_features; ///< the engine's handle
    using real_type = float;               ///< type of the weights of mix

    static constexpr bool scales_logits = true; ///< scaling_attention_call, as far as the engine says so

    /// Refers to both.
    engine_call(genrender_engine const& engine, genrender_call const& call)
        : engine_(&engine), call_(&call), frames_(frames_of(call.frames, call.frame_count)) {}

    /// Which site, which guidance branch.
    attention_place place() const { return {{call_->place.site}, call_->place.branch}; }
    /// Which frame of the animation each entry of the frame axis is.
    std::span<frame_index const> frames() const { return frames_; }
    /// The input of the module.
    engine_features f() const { return engine_features(call_->f); }
    /// W^Q f.
    engine_features query(engine_features const& f) const { return made(engine_->query, "query", f.get()); }
    /// W^K f.
    engine_features key(engine_features const& f) const { return made(engine_->key, "key", f.get()); }
    /// W^V f.
    engine_features value(engine_features const& f) const { return made(engine_->value, "value", f.get()); }
    /// [GR eq. 1], each frame of the queries attending to its sources. Throws value_error if they are scaled and the
    /// engine has no `scales_logits`.
    engine_features attend(engine_features const& Q, attention_sources<engine_features> const& sources) const {
        if (sources.is_scaled() && engine_->scales_logits == 0) {
            throw value_error("engine_call: logits are scaled, expected a length_correction of 0 for an engine without "
                              "scales_logits");
        }
        auto const scales = scales_of(sources.scales());
        std::vector<genrender_block> blocks;
        std::vector<std::size_t> offsets{0};
        for (auto const& list : sources) {
            for (auto const& block : list) {
                blocks.push_back({block.K->get(), block.V->get(), block.frame});
            }
            offsets.push_back(blocks.size());
        }
        return made(
            engine_->attend, "attend", Q.get(),
            genrender_sources{blocks.data(), offsets.data(), sources.size(), scales.empty() ? nullptr : scales.data()});
    }
    /// F of eq. 6.
    engine_features mix(engine_features const& F_hat, engine_features const& F_KF,
                        std::span<sparse_rows<float> const> rows, float alpha) const {
        return made(engine_->mix, "mix", F_hat.get(), F_KF.get(), rows_of(rows).data(), alpha);
    }

private:
    template <class Function, class... Arguments>
    engine_features made(Function* function, char const* name, Arguments... arguments) const {
        if (function == nullptr) {
            throw engine_error(std::string("engine: ") + name +
                               " is null, expected a function of an engine that calls back");
        }
        return {*engine_, function(engine_->context, call_, arguments...), name};
    }

    genrender_engine const* engine_;
    genrender_call const* call_;
    std::vector<frame_index> frames_;
};

} // namespace genrender::c

#include <genrender/core/end_header.inl>
