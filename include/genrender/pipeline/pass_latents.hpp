// SPDX-License-Identifier: MIT
// [GR alg. 1: z] The latents of a run and what its passes do with them: in host memory, or lent by the denoiser's engine.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/strided_view.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/sampling/latent_lender.hpp>
#include <genrender/sampling/lent_latents.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace genrender {

namespace detail {

template <class Phi>
struct run_latents {
    using type = latents<typename Phi::real_type>;
};
template <latent_lender Phi>
struct run_latents<Phi> {
    using type = lent_latents<Phi>;
};

} // namespace detail

/// z and x0 of a run with a denoiser, [frames, channels, height, width]: latents in host memory, or lent_latents of one
/// that lends them.
template <denoiser Phi>
using run_latents = typename detail::run_latents<Phi>::type;

/// Lets `change(view)` read and write latents as strided_view<Real, 4> in host memory.
template <class Real, class Change>
void on_host(latents<Real>& z, Change const& change) {
    change(to_view(z));
}
/// The same of latents that are lent, which are downloaded and uploaded again.
template <latent_lender Phi, class Change>
void on_host(lent_latents<Phi>& z, Change const& change) {
    z.on_host(change);
}

/// Latents for estimates of z, to be written.
template <class Real>
latents<Real> estimates_for(latents<Real> const& z) {
    return latents<Real>::from_shape(z.shape());
}
/// The same of latents that are lent.
template <latent_lender Phi>
lent_latents<Phi> estimates_for(lent_latents<Phi> const& z) {
    return z; // A handle is replaced, not written.
}

/// z and x0 of one evaluation, read and written a stack of frames at a time. Both are referred to.
template <denoiser Phi>
class pass_latents {
public:
    using real_type = typename Phi::real_type; ///< scalar of the latents

    /// Reads z and writes x0.
    pass_latents(Phi const&, latents<real_type>& x0, latents<real_type> const& z) : x0_(&x0), z_(&z) {}

    /// Frames of the animation.
    std::size_t frame_count() const { return z_->shape()[0]; }

    /// Gives `run(z)` the entries of some frames as the denoiser takes them, for a call whose estimates nobody wants.
    template <class Run>
    void read(std::span<frame_index const> frames, Run const& run) const {
        auto const z = entries_of(frames);
        run(to_view(z));
    }
    /// The same with room for estimates that nobody wants: `run(x0, z)`.
    template <class Run>
    void read_and_drop(std::span<frame_index const> frames, Run const& run) const {
        auto const z = entries_of(frames);
        auto x0 = z;
        run(to_view(x0), to_view(z));
    }

    /// Begins a pass of so many calls.
    void begin(std::size_t /*calls*/) {}
    /// Gives `run(x0, z)` the entries of a call's frames, the first `own` of which follow one another, and keeps the
    /// estimates of these. Returns the seconds of `run`. Several calls may be written at the same time.
    template <class Run>
    double write(std::size_t /*call*/, std::span<frame_index const> frames, std::size_t own, Run const& run) {
        auto const x0 = to_view(*x0_).slice(frames.front().value, own);
        if (own == frames.size()) {
            auto const begin = clock::now();
            run(x0, to_view(*z_).slice(frames.front().value, own));
            return seconds_since(begin);
        }
        auto const filled_z = entries_of(frames);
        auto filled_x0 = filled_z;
        auto const begin = clock::now();
        run(to_view(filled_x0), to_view(filled_z));
        auto const seconds = seconds_since(begin);
        copy(x0, to_view(std::as_const(filled_x0)).slice(0, own));
        return seconds;
    }
    /// Ends a pass: all of x0 is written.
    void end() {}

private:
    using clock = std::chrono::steady_clock;

    static double seconds_since(clock::time_point start) {
        return std::chrono::duration<double>(clock::now() - start).count();
    }

    latents<real_type> entries_of(std::span<frame_index const> frames) const {
        auto const& shape = z_->shape();
        auto entries = latents<real_type>::from_shape({frames.size(), shape[1], shape[2], shape[3]});
        for (std::size_t i = 0; i < frames.size(); ++i) {
            copy(to_view(entries)[i], to_view(*z_)[frames[i].value]);
        }
        return entries;
    }

    latents<real_type>* x0_;
    latents<real_type> const* z_;
};

/// The same of latents that are lent: `run(z)` takes a handle and returns that of the estimates.
template <latent_lender Phi>
class pass_latents<Phi> {
public:
    using handle_type = typename Phi::latents_type; ///< the engine's handle

    /// Reads z and writes x0.
    pass_latents(Phi const& phi, lent_latents<Phi>& x0, lent_latents<Phi> const& z) : phi_(&phi), x0_(&x0), z_(&z) {}

    /// Frames of the animation.
    std::size_t frame_count() const { return z_->extents()[0]; }

    /// As above.
    template <class Run>
    void read(std::span<frame_index const> frames, Run const& run) const {
        run(handle_type(phi_->frames_of(z_->handle(), frames)));
    }
    /// As above, with `run(z)`.
    template <class Run>
    void read_and_drop(std::span<frame_index const> frames, Run const& run) const {
        read(frames, run);
    }

    /// Begins a pass of so many calls.
    void begin(std::size_t calls) {
        estimates_.assign(calls, std::nullopt);
        is_longer_ = false;
    }
    /// As above, with `run(z)`. The seconds are those until the engine returns, which a device may do before it has ended.
    template <class Run>
    double write(std::size_t call, std::span<frame_index const> frames, std::size_t own, Run const& run) {
        auto const begin = std::chrono::steady_clock::now();
        estimates_[call] = run(handle_type(phi_->frames_of(z_->handle(), frames)));
        if (own < frames.size()) {
            is_longer_ = true; // the last call alone, so that what is dropped stands at the end
        }
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }
    /// Ends a pass: x0 is joined of the estimates of its calls.
    void end() {
        std::vector<handle_type> stacks;
        stacks.reserve(estimates_.size());
        for (auto& estimate : estimates_) {
            stacks.push_back(std::move(*estimate));
        }
        estimates_.clear();
        handle_type all = phi_->joined(std::span<handle_type const>(stacks));
        if (is_longer_) {
            std::vector<frame_index> frames;
            for (std::uint32_t i = 0; i < frame_count(); ++i) {
                frames.push_back({i});
            }
            all = phi_->frames_of(all, std::span<frame_index const>(frames));
        }
        x0_->assign(std::move(all));
    }

private:
    Phi const* phi_;
    lent_latents<Phi>* x0_;
    lent_latents<Phi> const* z_;
    std::vector<std::optional<handle_type>> estimates_{}; // by call
    bool is_longer_ = false;                              // written by one call alone
};

} // namespace genrender

#include <genrender/core/end_header.inl>
