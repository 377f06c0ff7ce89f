// SPDX-License-Identifier: MIT
// Latents that a denoiser lends, as samplers move them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/sampling/latent_lender.hpp>

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace genrender {

/// Latents [frames, channels, height, width] in the engine's memory: a handle with the denoiser that knows what to do with
/// it, which must outlive it. A value as latents in host memory are one, and a model of combined_latents, but copies
/// share elements, which are never written.
template <latent_lender Phi>
class lent_latents {
public:
    using real_type = typename Phi::real_type;      ///< scalar of the latents
    using handle_type = typename Phi::latents_type; ///< the engine's handle

    /// Uploads the elements of a view, row-major without gaps.
    lent_latents(Phi const& phi, strided_view<real_type const, 4> z)
        : phi_(&phi), handle_(phi.upload(z)), extents_(z.extents()) {}

    /// Extent of every axis.
    std::array<std::size_t, 4> const& extents() const { return extents_; }
    /// The engine's handle.
    handle_type const& handle() const { return handle_; }
    /// Is a handle of the same extents from now on.
    void assign(handle_type handle) { handle_ = std::move(handle); }

    /// Writes the elements to a view of these extents, row-major without gaps. Throws shape_error for other extents.
    void download(strided_view<real_type, 4> to) const {
        require_shape("lent_latents", "to", to, extents_);
        phi_->download(to, handle_);
    }

    /// Downloads the elements, lets `change(view)` read and write them as strided_view<real_type, 4>, and uploads them:
    /// what an engine does not lend is done in this way.
    template <class Change>
    void on_host(Change const& change) {
        auto elements = stack<real_type, 4>::uninitialized(extents_);
        download(elements.view());
        change(elements.view());
        handle_ = phi_->upload(std::as_const(elements).view());
    }

    /// Becomes the sum of factors times latents of the same denoiser; what samplers call.
    friend void combine(lent_latents& out, std::span<real_type const> factors,
                        std::span<lent_latents const* const> in) {
        std::vector<handle_type> handles;
        handles.reserve(in.size());
        for (auto const* const term : in) {
            require_extents("sampler", "D(z, sigma)", term->extents_, out.extents_);
            handles.push_back(term->handle_);
        }
        out.handle_ = out.phi_->combination(factors, std::span<handle_type const>(handles));
    }

private:
    Phi const* phi_;
    handle_type handle_;
    std::array<std::size_t, 4> extents_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
