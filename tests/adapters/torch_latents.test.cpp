// SPDX-License-Identifier: MIT
// Latents that are at::Tensor: the laws, and a run against the same denoiser in host memory.
#include <genrender/adapters/torch_latents.hpp>

#include <genrender/adapters/torch.hpp>

#include "../support/random_scene.hpp"

#include <genrender/core/stack.hpp>
#include <genrender/pipeline/render.hpp>
#include <genrender/testing/latent_lender_laws.hpp>

#include <ATen/ATen.h>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

TEST_SUITE("adapters/torch_latents") {
    using namespace genrender;
    using namespace genrender::adapters;

    namespace {

    at::Tensor pattern(float phase) {
        auto const W = at::empty({3, 3});
        for (std::int64_t i = 0; i < W.numel(); ++i) {
            W.data_ptr<float>()[i] = std::sin(phase + 1.7f * static_cast<float>(i));
        }
        return W;
    }

    /// One self-attention module of three channels on 8 x 8 tokens, on tensors.
    struct attending_network {
        std::vector<attention_site> modules{{"up.attn1", network_kind::denoising, network_part::decoder, {8, 8}, 3}};
        torch_module module = torch_module::of_matrices(pattern(1), pattern(2), pattern(3), 1);
        torch_plans plans{};

        template <class Processor>
        at::Tensor estimate(at::Tensor const& z, float sigma, std::span<frame_index const> frames,
                            Processor& processor) const {
            auto const clean = z / (1 + sigma * sigma);
            torch_attention_call call({{0}, 0}, frames, clean.flatten(2).transpose(1, 2).contiguous(), module, plans);
            at::Tensor const F = processor(call);
            return (clean + F.transpose(1, 2).reshape(z.sizes())) / 2;
        }
    };

    /// It lends its latents.
    struct lending_denoiser : torch_latents {
        using real_type = float;
        using features_type = at::Tensor;
        attending_network network{};
        mutable std::size_t uploads = 0;
        mutable std::size_t downloads = 0;

        std::size_t latent_channels() const { return 3; }
        grid_extents latent_grid() const { return {8, 8}; }
        std::span<attention_site const> sites() const { return network.modules; }
        std::size_t branches() const { return 1; }
        at::Tensor upload(strided_view<float const, 4> z) const {
            ++uploads;
            return torch_latents::upload(z);
        }
        void download(strided_view<float, 4> to, at::Tensor const& z) const {
            ++downloads;
            torch_latents::download(to, z);
        }
        template <class Processor>
        at::Tensor operator()(at::Tensor const& z, float sigma, std::span<frame_index const> frames,
                              Processor& processor) const {
            c10::InferenceMode const no_gradients;
            return network.estimate(z, sigma, frames, processor);
        }
        template <class Processor>
        void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                        std::span<frame_index const> frames, Processor& processor) const {
            torch_latents::download(x0, (*this)(torch_latents::upload(z), sigma, frames, processor));
        }
    };

    /// The same without lending anything.
    struct viewing_denoiser {
        using real_type = float;
        using features_type = at::Tensor;
        attending_network network{};

        std::size_t latent_channels() const { return 3; }
        grid_extents latent_grid() const { return {8, 8}; }
        std::span<attention_site const> sites() const { return network.modules; }
        std::size_t branches() const { return 1; }
        template <class Processor>
        void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                        std::span<frame_index const> frames, Processor& processor) const {
            tensor_of(x0).copy_(network.estimate(tensor_of(z), sigma, frames, processor));
        }
    };

    static_assert(normalizing_lender<lending_denoiser> && !latent_lender<viewing_denoiser>);

    } // namespace

    TEST_CASE("tensors keep the laws of lent latents") {
        lending_denoiser const phi;
        CHECK(testing::check_latent_lender_laws(phi, 1.5f, {.threads = 1}).text() == "");
    }
    TEST_CASE("frames that follow one another are given without a copy, and others by one") {
        lending_denoiser const phi;
        stack<float, 4> const zeros({4, 3, 8, 8});
        auto const z = phi.upload(zeros.view());
        std::array<frame_index, 2> const next{{{1}, {2}}};
        std::array<frame_index, 2> const apart{{{2}, {0}}};
        CHECK(phi.frames_of(z, next).data_ptr<float>() == z[1].data_ptr<float>());
        CHECK(phi.frames_of(z, apart).data_ptr<float>() != z[2].data_ptr<float>());
    }
    TEST_CASE("a run on tensors gives the latents of the run in host memory, by one upload of them and one download") {
        auto const maps = testing::random_scene(33, 5, {32, 32}, 3);
        for (auto const sampler : {sampler_kind::euler, sampler_kind::heun, sampler_kind::dpmpp_2m}) {
            render_settings<float> settings = render_settings<float>::plain();
            settings.steps = 3;
            settings.sampler = sampler;
            settings.keyframes.count = 2;
            settings.frames_per_call = 2;
            settings.fills_last_call = true;
            settings.normalization.statistics = adain_statistics::mean_and_deviation;
            lending_denoiser const phi;
            auto const lent = render(phi, to_uv_view(maps), {.settings = settings}).z;
            auto const viewed = render(viewing_denoiser{}, to_uv_view(maps), {.settings = settings}).z;
            float worst = 0;
            float greatest = 0;
            for (std::size_t e = 0; e < viewed.size(); ++e) {
                worst = std::max(worst, std::abs(lent.data()[e] - viewed.data()[e]));
                greatest = std::max(greatest, std::abs(viewed.data()[e]));
            }
            MESSAGE("greatest difference ", worst, " of ", greatest);
            CHECK(worst <= 1e-4f * greatest); // deviations of few pixels are divided by
            CHECK(phi.uploads == 2);          // the latents, and the background
            CHECK(phi.downloads == 1);
        }
    }
}
