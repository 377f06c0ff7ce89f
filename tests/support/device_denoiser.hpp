// SPDX-License-Identifier: MIT
// Denoisers whose latents lie in a memory of their own, which the host cannot read without a download.
#pragma once

#include <genrender/core/finite.hpp>
#include <genrender/core/linear_combination.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/keyframes/stoppable_denoiser.hpp>
#include <genrender/normalization/adain.hpp>
#include <genrender/sampling/latent_lender.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace genrender::testing {

/// A handle of latents on a device. Their memory holds the bits of the numbers turned around, so that who reads it as
/// numbers, as host code would, reads nonsense; it is overwritten when the last handle goes.
template <class Real>
class device_memory {
public:
    std::array<std::size_t, 4> const& extents() const { return extents_; }

    /// For code that runs on the device.
    static device_memory written(stack<Real, 4> const& values) {
        return device_memory(values.extents(), turned(values.data(), values.size()));
    }
    stack<Real, 4> read() const {
        auto values = stack<Real, 4>::uninitialized(extents_);
        auto const bytes = turned(reinterpret_cast<Real const*>(block_->bytes.data()), values.size());
        std::memcpy(values.data(), bytes.data(), bytes.size());
        return values;
    }
    /// Writes into the memory that all copies share, which no operation may.
    void spoil() const { std::fill(block_->bytes.begin(), block_->bytes.end(), std::uint8_t{0x3c}); }

private:
    using bytes_type = std::vector<std::uint8_t>;
    struct block {
        bytes_type bytes;
        explicit block(bytes_type given) : bytes(std::move(given)) {}
        block(block const&) = delete;
        ~block() { std::fill(bytes.begin(), bytes.end(), std::uint8_t{0}); }
    };

    device_memory(std::array<std::size_t, 4> const& extents, bytes_type bytes)
        : extents_(extents), block_(std::make_shared<block>(std::move(bytes))) {}

    static bytes_type turned(Real const* values, std::size_t count) {
        bytes_type bytes(count * sizeof(Real));
        std::memcpy(bytes.data(), values, bytes.size());
        for (auto& byte : bytes) {
            byte = static_cast<std::uint8_t>(~byte);
        }
        return bytes;
    }

    std::array<std::size_t, 4> extents_;
    std::shared_ptr<block> block_;
};

/// What was asked of a device; copies of a denoiser count together.
struct device_counts {
    std::atomic<std::size_t> uploads{0};
    std::atomic<std::size_t> downloads{0};
    std::atomic<std::size_t> calls{0};      ///< of the denoiser on handles
    std::atomic<std::size_t> host_calls{0}; ///< of the denoiser on views
    std::atomic<std::size_t> statistics{0};
    std::atomic<std::size_t> stopped{0}; ///< calls that ended early
    std::atomic<std::size_t> reused{0};  ///< calls that were lent what the keyframe pass had computed
};

/// A denoiser of host memory on a device.
template <class Host>
struct device_denoiser : Host {
    using Real = typename Host::real_type;
    using latents_type = device_memory<Real>;
    std::shared_ptr<device_counts> counts = std::make_shared<device_counts>();

    latents_type upload(strided_view<Real const, 4> z) const {
        if (!z.is_contiguous()) {
            throw std::invalid_argument("device: z has gaps");
        }
        ++counts->uploads;
        auto values = stack<Real, 4>::uninitialized(z.extents());
        copy(values.view(), in_view<Real, 4>(z));
        return latents_type::written(values);
    }
    void download(strided_view<Real, 4> to, latents_type const& z) const {
        if (!to.is_contiguous() || to.extents() != z.extents()) {
            throw std::invalid_argument("device: the view has gaps or other extents");
        }
        ++counts->downloads;
        copy(to, in_view<Real, 4>(z.read()));
    }
    latents_type frames_of(latents_type const& z, std::span<frame_index const> frames) const {
        auto const from = z.read();
        auto extents = z.extents();
        extents[0] = frames.size();
        auto values = stack<Real, 4>::uninitialized(extents);
        for (std::size_t i = 0; i < frames.size(); ++i) {
            copy(values.view()[i], in_view<Real, 3>(from.view()[frames[i].value]));
        }
        return latents_type::written(values);
    }
    latents_type joined(std::span<latents_type const> stacks) const {
        auto extents = stacks.front().extents();
        extents[0] = 0;
        for (auto const& stack : stacks) {
            extents[0] += stack.extents()[0];
        }
        auto values = stack<Real, 4>::uninitialized(extents);
        std::size_t first = 0;
        for (auto const& stack : stacks) {
            copy(values.view().slice(first, stack.extents()[0]), in_view<Real, 4>(stack.read()));
            first += stack.extents()[0];
        }
        return latents_type::written(values);
    }
    latents_type combination(std::span<Real const> factors, std::span<latents_type const> in) const {
        switch (in.size()) {
        case 2:
            return sum_of<2>(factors, in);
        case 3:
            return sum_of<3>(factors, in);
        case 4:
            return sum_of<4>(factors, in);
        default:
            return sum_of<1>(factors, in);
        }
    }
    bool all_finite(latents_type const& z) const {
        auto const values = z.read();
        return std::all_of(values.data(), values.data() + values.size(), [](Real x) { return is_finite(x); });
    }

    template <class Processor>
    void operator()(strided_view<Real, 4> x0, strided_view<Real const, 4> z, Real sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        ++counts->host_calls;
        Host::operator()(x0, z, sigma, frames, processor);
    }
    template <class Processor>
    latents_type operator()(latents_type const& z, Real sigma, std::span<frame_index const> frames,
                            Processor& processor) const {
        ++counts->calls;
        auto const from = z.read();
        stack<Real, 4> x0(from.extents());
        Host::operator()(x0.view(), from.view(), sigma, frames, processor);
        return latents_type::written(x0);
    }

private:
    template <std::size_t Terms>
    static latents_type sum_of(std::span<Real const> factors, std::span<latents_type const> in) {
        std::array<stack<Real, 4>, Terms> read;
        std::array<Real, Terms> by{};
        std::array<Real const*, Terms> from{};
        for (std::size_t n = 0; n < Terms; ++n) {
            read[n] = in[n].read();
            by[n] = factors[n];
            from[n] = read[n].data();
        }
        auto out = stack<Real, 4>::uninitialized(in.front().extents());
        linear_combination(out.data(), out.size(), by, from);
        return latents_type::written(out);
    }
};

/// A device that lends what latent normalisation takes.
template <class Host>
struct normalizing_device : device_denoiser<Host> {
    using Real = typename Host::real_type;
    using typename device_denoiser<Host>::latents_type;

    void channel_statistics(strided_view<Real, 2> means, strided_view<Real, 2> deviations, latents_type const& z,
                            latents_type const& w) const {
        ++this->counts->statistics;
        auto const values = z.read();
        auto const counting = w.read();
        std::vector<std::uint8_t> mask(values.extent(2) * values.extent(3));
        for (std::size_t i = 0; i < values.extent(0); ++i) {
            auto const of_frame = counting.view()[i];
            std::copy_n(of_frame.data(), mask.size(), mask.begin());
            auto const found = masked_statistics(
                values.view()[i],
                strided_view<std::uint8_t const, 2>(mask.data(), {values.extent(2), values.extent(3)}));
            for (std::size_t c = 0; c < values.extent(1); ++c) {
                means(i, c) = found.mean[c];
                deviations(i, c) = found.deviation[c];
            }
        }
    }
    latents_type rescaled(latents_type const& z, strided_view<Real const, 2> mean_from,
                          strided_view<Real const, 2> scale, strided_view<Real const, 2> mean_to) const {
        auto values = z.read();
        for (std::size_t i = 0; i < values.extent(0); ++i) {
            for (std::size_t c = 0; c < values.extent(1); ++c) {
                auto const channel = values.view()[i][c];
                for (std::size_t e = 0; e < channel.size(); ++e) {
                    channel.data()[e] = (channel.data()[e] - mean_from(i, c)) * scale(i, c) + mean_to(i, c);
                }
            }
        }
        return latents_type::written(values);
    }
};

/// A device whose denoiser ends calls early and lends what it has computed.
template <class Host>
struct stopping_device : normalizing_device<Host> {
    using Real = typename Host::real_type;
    using typename device_denoiser<Host>::latents_type;
    using device_denoiser<Host>::operator();
    struct residuals_type {
        std::vector<frame_index> frames;
    };

    std::size_t residual_bytes() const { return 4; }
    template <class Processor>
    void run_until(strided_view<Real const, 4> z, Real sigma, std::span<frame_index const> frames, Processor& processor,
                   std::span<std::optional<site_index> const>, residuals_type* lent = nullptr) const {
        stack<Real, 4> x0(z.extents());
        (*this)(x0.view(), z, sigma, frames, processor);
        keep(lent, frames);
    }
    template <class Processor>
    void operator()(strided_view<Real, 4> x0, strided_view<Real const, 4> z, Real sigma,
                    std::span<frame_index const> frames, Processor& processor, residuals_type const&) const {
        (*this)(x0, z, sigma, frames, processor);
    }
    template <class Processor>
    void run_until(latents_type const& z, Real sigma, std::span<frame_index const> frames, Processor& processor,
                   std::span<std::optional<site_index> const>, residuals_type* lent = nullptr) const {
        ++this->counts->stopped;
        (*this)(z, sigma, frames, processor);
        keep(lent, frames);
    }
    template <class Processor>
    latents_type operator()(latents_type const& z, Real sigma, std::span<frame_index const> frames,
                            Processor& processor, residuals_type const& lent) const {
        this->counts->reused += lent.frames.empty() ? 0 : 1;
        return (*this)(z, sigma, frames, processor);
    }

private:
    static void keep(residuals_type* lent, std::span<frame_index const> frames) {
        if (lent != nullptr) {
            lent->frames.assign(frames.begin(), frames.end());
        }
    }
};

} // namespace genrender::testing
