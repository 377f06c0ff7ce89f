// SPDX-License-Identifier: MIT
// What LibTorch lends a run so that its latents stay on their device: at::Tensor as latents.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/adapters/torch_plans.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/strided_view.hpp>

#include <ATen/core/Tensor.h>
#include <ATen/ops/cat.h>
#include <ATen/ops/isfinite.h>
#include <ATen/ops/mul.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace genrender::adapters {

/// All that latent_lender and normalizing_lender ask for but the call itself; a denoiser derives from it. Latents are
/// float32 tensors [frames, channels, height, width] on `latents_device`, whose memory is never written again: the handles
/// that are given out may share it. The call on handles is the denoiser's:
///
///     struct my_denoiser : torch_latents {
///         template <class Processor>
///         at::Tensor operator()(at::Tensor const& z, float sigma, std::span<frame_index const> frames,
///                               Processor& processor) const;
class torch_latents {
public:
    using latents_type = at::Tensor; ///< latents on their device

    /// On this device, the processor's if none is named.
    explicit torch_latents(at::Device device = at::Device(at::kCPU)) : latents_device_(device) {}

    /// Where the latents are.
    at::Device latents_device() const { return latents_device_; }

    /// A copy of the elements of a view on the device.
    at::Tensor upload(strided_view<float const, 4> z) const {
        constexpr bool at_once = false;
        constexpr bool copies = true;
        return tensor_of(z).to(at::TensorOptions(latents_device_), at_once, copies);
    }

    /// Writes the elements to a view. Waits for the device.
    void download(strided_view<float, 4> to, at::Tensor const& z) const { tensor_of(to).copy_(z); }

    /// The entries of z that are named; those that follow one another share its memory.
    at::Tensor frames_of(at::Tensor const& z, std::span<frame_index const> frames) const {
        std::vector<at::Tensor> stacks;
        for (std::size_t first = 0, count = 1; first < frames.size(); first += count, count = 1) {
            while (first + count < frames.size() && frames[first + count].value == frames[first].value + count) {
                ++count;
            }
            stacks.push_back(z.narrow(0, frames[first].value, static_cast<std::int64_t>(count)));
        }
        return joined(stacks);
    }

    /// All stacks, one after the other.
    at::Tensor joined(std::span<at::Tensor const> stacks) const {
        return stacks.size() == 1 ? stacks.front() : at::cat(at::TensorList(stacks.data(), stacks.size()));
    }

    /// The sum of factors times latents, in memory of its own.
    at::Tensor combination(std::span<float const> factors, std::span<at::Tensor const> in) const {
        auto sum = at::mul(in[0], factors[0]);
        for (std::size_t n = 1; n < in.size(); ++n) {
            sum.add_(in[n], factors[n]);
        }
        return sum;
    }

    /// Whether all elements are finite. Waits for the device.
    bool all_finite(at::Tensor const& z) const { return at::isfinite(z).all().item<bool>(); }

    /// Means and deviations as normalizing_lender has them, computed in float64. Waits for the device.
    void channel_statistics(strided_view<float, 2> mean, strided_view<float, 2> deviation, at::Tensor const& z,
                            at::Tensor const& w) const {
        auto const values = z.to(at::kDouble);
        auto const counted = w.to(at::kDouble);
        auto const over_pixels = [](at::Tensor const& x) { return x.sum(at::IntArrayRef({2, 3}), true); };
        auto const pixels = over_pixels(counted);
        auto const means = over_pixels(values.mul(counted)).div(pixels.clamp_min(1));
        auto const squares = over_pixels(values.sub(means).square().mul(counted));
        auto const deviations = squares.div(pixels.sub(1).clamp_min(1)).add(1e-5).sqrt();
        auto const both = at::cat({means, deviations}, 2).squeeze(3).to(at::kCPU, at::kFloat);
        tensor_of(mean).copy_(both.select(2, 0));
        tensor_of(deviation).copy_(both.select(2, 1));
    }

    /// (z - mean_from) scale + mean_to by frame and channel.
    at::Tensor rescaled(at::Tensor const& z, strided_view<float const, 2> mean_from, strided_view<float const, 2> scale,
                        strided_view<float const, 2> mean_to) const {
        constexpr bool at_once = false;
        constexpr bool copies = true;
        auto const by_channel = [&](strided_view<float const, 2> view) {
            return tensor_of(view).to(at::TensorOptions(latents_device_), at_once, copies).unsqueeze(2).unsqueeze(3);
        };
        return z.sub(by_channel(mean_from)).mul(by_channel(scale)).add(by_channel(mean_to));
    }

private:
    at::Device latents_device_;
};

} // namespace genrender::adapters

#include <genrender/core/end_header.inl>
