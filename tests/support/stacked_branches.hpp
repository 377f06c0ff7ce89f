// SPDX-License-Identifier: MIT
// An engine that runs both branches of guidance at once: its features hold both, and it calls its processor once a site.
#pragma once

#include <genrender/injection/host_attention_call.hpp>
#include <genrender/testing/analytic_denoiser.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace genrender::testing {

/// Features of [uncond; cond]: a stack of its own for each, as if they stood one behind the other in one tensor.
struct stacked_features {
    std::array<host_features<float>, 2> of;
};

/// A call of both branches. What the processor hands over is the same for both: sources, rows and alpha.
class stacked_call {
public:
    using features_type = stacked_features;
    using real_type = float;

    /// `mixes_up`: lets both branches attend to the first.
    stacked_call(site_index site, std::span<frame_index const> frames, features_type const& f, bool mixes_up)
        : site_(site), frames_(frames), f_(&f), mixes_up_(mixes_up) {}

    attention_place place() const { return {site_, 0}; }
    std::span<frame_index const> frames() const { return frames_; }
    features_type f() const { return *f_; }
    features_type query(features_type const& f) const {
        return each([&](auto const& call, std::size_t b) { return call.query(f.of[b]); });
    }
    features_type key(features_type const& f) const {
        return each([&](auto const& call, std::size_t b) { return call.key(f.of[b]); });
    }
    features_type value(features_type const& f) const {
        return each([&](auto const& call, std::size_t b) { return call.value(f.of[b]); });
    }
    features_type attend(features_type const& Q, attention_sources<features_type> const& sources) const {
        return each([&](auto const& call, std::size_t b) {
            return call.attend(Q.of[b], sources.template of_features<host_features<float>>(
                                            [of = mixes_up_ ? 0 : b](features_type const& x) { return &x.of[of]; }));
        });
    }
    features_type mix(features_type const& F_hat, features_type const& F_KF, std::span<sparse_rows<float> const> rows,
                      float alpha) const {
        return each([&](auto const& call, std::size_t b) { return call.mix(F_hat.of[b], F_KF.of[b], rows, alpha); });
    }

private:
    template <class Operation>
    features_type each(Operation const& operation) const {
        features_type result;
        for (std::uint32_t b = 0; b < 2; ++b) {
            host_attention_call<float, identity_projections> const call({site_, b}, frames_, f_->of[b], module_);
            result.of[b] = operation(call, b);
        }
        return result;
    }

    site_index site_;
    std::span<frame_index const> frames_;
    features_type const* f_;
    bool mixes_up_;
    identity_projections module_;
};

/// The analytic denoiser of two branches, which tells of one.
struct stacked_denoiser : analytic_denoiser<float> {
    using features_type = stacked_features;
    bool mixes_up = false;

    std::size_t branches() const { return 1; }

    template <class Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        // The engine's own processor of each branch's sites: what the library's gave for both.
        stacked_features both;
        estimate_with(x0, z, sigma, frames, [&](auto& call) {
            both.of[call.place().branch] = call.f();
            return call.f();
        });
        std::vector<stacked_features> F;
        for (std::uint32_t site = 0; site < site_list.size(); ++site) {
            stacked_call call({site}, frames, both, mixes_up);
            F.push_back(processor(call));
        }
        estimate_with(x0, z, sigma, frames,
                      [&](auto& call) { return F[call.place().site.value].of[call.place().branch]; });
    }

private:
    template <class Run>
    void estimate_with(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                       std::span<frame_index const> frames, Run const& run) const {
        analytic_denoiser<float>::operator()(x0, z, sigma, frames, run);
    }
};

} // namespace genrender::testing
