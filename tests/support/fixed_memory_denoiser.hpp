// SPDX-License-Identifier: MIT
// Engines that keep features of keyframes in memory which every keyframe pass uses again.
#pragma once

#include <genrender/injection/feature_io.hpp>
#include <genrender/injection/host_attention_call.hpp>
#include <genrender/sampling/run_shapes.hpp>
#include <genrender/testing/analytic_denoiser.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace genrender::testing {

/// Memory of a run's keyframes: so many stacks for each place that takes part, had once.
class fixed_memory {
public:
    using features = host_features<double>;

    /// Empty, of stacks of [m, tokens, channels].
    void reserve(run_shapes const& shapes, std::size_t tokens, std::size_t channels, std::size_t stacks) {
        stacks_.clear();
        for (auto const place : shapes.places) {
            for (std::size_t n = 0; n < stacks; ++n) {
                stacks_[place].push_back(features::allocate({shapes.keyframes, tokens, channels}));
            }
        }
        next_.clear();
    }

    /// The values of x in the next of the place's stacks, written over what was there; a handle that owns nothing.
    features keep(attention_place place, features const& x) {
        auto& stacks = stacks_.at(place);
        auto const& to = stacks.at(next_[place]++ % stacks.size());
        copy(to.view(), in_view<double, 3>(x.view()));
        ++kept;
        return features(to.view());
    }

    /// Makes all that is kept at a place unfit to be read.
    void spoil(attention_place place) {
        for (auto const& stack : stacks_.at(place)) {
            std::fill_n(stack.view().data(), stack.view().size(), std::numeric_limits<double>::quiet_NaN());
        }
    }

    std::size_t kept = 0; ///< features that were kept so far

private:
    std::map<attention_place, std::vector<features>> stacks_;
    std::map<attention_place, std::size_t> next_;
};

/// The analytic denoiser as a static graph, whose outputs lie in fixed memory or each in memory of its own.
struct graph_in_fixed_memory : analytic_denoiser<double> {
    bool is_fixed = true;
    mutable fixed_memory memory{};

    void prepare(run_shapes const& shapes) const {
        if (is_fixed) {
            memory.reserve(shapes, grid.size(), channels, 2); // f_KF and F_KF
        }
    }

    template <class Processor>
    void operator()(strided_view<double, 4> x0, strided_view<double const, 4> z, double sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        auto const graph = [&](auto& call) {
            auto const place = call.place();
            auto const in = inputs_at<features_type, double>(processor, place, frames);
            if (in.is_recorded && is_fixed) {
                memory.spoil(place); // The bank of the step before has ended.
            }
            auto const f = call.f();
            auto sources = in.attends_to_stack ? attention_sources<features_type>::stack(f, f, frames.size())
                                               : attention_sources<features_type>::own(f, f, frames.size());
            if (in.f_KF != nullptr) {
                sources = attention_sources<features_type>::own_and_joined(f, f, *in.f_KF, *in.f_KF,
                                                                           in.f_KF->extents()[0], in.left_out);
            }
            auto F = call.attend(f, sources);
            if (in.F_KF != nullptr) {
                F = call.mix(F, *in.F_KF, in.rows, in.alpha);
            }
            if (in.is_recorded) {
                record_features(processor, place, is_fixed ? memory.keep(place, f) : f,
                                is_fixed ? memory.keep(place, F) : F);
            }
            return F;
        };
        analytic_denoiser<double>::operator()(x0, z, sigma, frames, graph);
    }
};

/// The analytic denoiser with calls whose `stored` rounds into fixed memory, or into memory of its own.
struct calls_in_fixed_memory : analytic_denoiser<double> {
    bool is_fixed = true;
    mutable fixed_memory memory{};

    /// The library's call with another `stored`.
    struct call_type : host_attention_call<double, identity_projections> {
        calls_in_fixed_memory const* phi;

        call_type(host_attention_call<double, identity_projections> const& call, calls_in_fixed_memory const& engine)
            : host_attention_call<double, identity_projections>(call), phi(&engine) {}

        features_type stored(features_type const& x, feature_storage) const {
            auto const rounded = features_type::allocate(x.extents());
            for (std::size_t e = 0; e < x.view().size(); ++e) {
                rounded.view().data()[e] = static_cast<double>(static_cast<float16>(x.view().data()[e]));
            }
            return phi->is_fixed ? phi->memory.keep(place(), rounded) : rounded;
        }
    };

    void prepare(run_shapes const& shapes) const {
        if (is_fixed) {
            memory.reserve(shapes, grid.size(), channels, 3); // K_KF, V_KF and F_KF
        }
    }

    template <class Processor>
    void operator()(strided_view<double, 4> x0, strided_view<double const, 4> z, double sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        auto const in_fixed_memory = [&](auto& call) {
            call_type own(call, *this);
            return processor(own);
        };
        analytic_denoiser<double>::operator()(x0, z, sigma, frames, in_fixed_memory);
    }
};

} // namespace genrender::testing
