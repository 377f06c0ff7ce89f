// SPDX-License-Identifier: MIT
// A small network in ATen behind torch_denoiser: what it estimates by hand, the laws, a run, and what is refused.
#include <genrender/adapters/torch_denoiser.hpp>

#include "../support/random_scene.hpp"

#include <genrender/attention/plain_attention.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/pipeline/render.hpp>
#include <genrender/sampling/storing_denoiser.hpp>
#include <genrender/testing/denoiser_laws.hpp>
#include <genrender/testing/latent_lender_laws.hpp>

#include <ATen/ATen.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

using namespace genrender;
using namespace genrender::adapters;

TEST_SUITE("adapters/torch_denoiser") {
    namespace {

    constexpr std::int64_t channels = 4;
    constexpr grid_extents grid{4, 8};

    at::Tensor matrix(double phase) { return at::arange(16.0).add(phase).sin().view({4, 4}).to(at::kFloat); }

    /// Self-attention of latents at half their resolution with a residual, and a prompt and hints that are added.
    at::Tensor small_network(at::Tensor const& z, double t, at::Tensor const& prompt, at::Tensor const& hints,
                             torch_self_attention const& run) {
        auto const f = at::avg_pool2d(z + prompt + hints, 2).flatten(2).transpose(1, 2);
        auto const F = run("up_blocks.0.attn1", f, matrix(1), matrix(2), matrix(3), 2);
        auto const coarse = F.transpose(1, 2).unflatten(2, {z.size(2) / 2, z.size(3) / 2});
        return z + 0.001 * t + at::upsample_nearest2d(coarse, {z.size(2), z.size(3)});
    }

    torch_conditioning told(std::size_t prompts = 2) {
        torch_conditioning result;
        result.hints = at::arange(5.0).view({5, 1, 1, 1}).to(at::kFloat).mul(0.3);
        result.prompts = {at::full({1, channels, 1, 1}, -0.5), at::full({1, channels, 1, 1}, 0.75)};
        result.prompts.resize(prompts);
        result.guidance_scale = 3;
        result.predicted = prediction::velocity;
        return result;
    }

    torch_denoiser denoiser(std::size_t prompts = 2) { return {small_network, told(prompts), channels, grid}; }

    std::string error_of(std::function<void()> const& work) {
        try {
            work();
        } catch (std::exception const& error) {
            return error.what();
        }
        return "nothing was thrown";
    }

    stack<float, 4> waves(std::size_t frames) {
        stack<float, 4> z({frames, channels, grid.height, grid.width});
        for (std::size_t i = 0; i < z.size(); ++i) {
            z.data()[i] = std::sin(0.7f * static_cast<float>(i));
        }
        return z;
    }

    /// The estimate of frames 1 and 3 with plain attention.
    at::Tensor estimate(torch_denoiser const& phi, float sigma) {
        std::array<frame_index, 2> const frames{{{1}, {3}}};
        auto const z = waves(2);
        auto x0 = waves(2);
        plain_attention const plain;
        phi(x0.view(), z.view(), sigma, frames, plain);
        return tensor_of(x0.view()).clone();
    }

    /// Counts what goes to the device and what comes back, but for calls on views.
    struct counting_denoiser : torch_denoiser {
        using torch_denoiser::torch_denoiser;
        mutable std::size_t uploads = 0;
        mutable std::size_t downloads = 0;

        at::Tensor upload(strided_view<float const, 4> z) const {
            ++uploads;
            return torch_denoiser::upload(z);
        }
        void download(strided_view<float, 4> to, at::Tensor const& z) const {
            ++downloads;
            torch_denoiser::download(to, z);
        }
    };

    /// The same denoiser without lending anything: a run calls it with views.
    struct viewing_denoiser {
        using real_type = float;
        using features_type = at::Tensor;
        torch_denoiser phi = denoiser();

        std::size_t latent_channels() const { return phi.latent_channels(); }
        grid_extents latent_grid() const { return phi.latent_grid(); }
        std::span<attention_site const> sites() const { return phi.sites(); }
        std::size_t branches() const { return phi.branches(); }
        template <class Processor>
        void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                        std::span<frame_index const> frames, Processor& processor) const {
            phi(x0, z, sigma, frames, processor);
        }
    };

    } // namespace

    TEST_CASE("a network tells its sites by running once") {
        static_assert(genrender::denoiser<torch_denoiser>);
        static_assert(call_naming_denoiser<torch_denoiser>);
        static_assert(normalizing_lender<torch_denoiser> && !latent_lender<viewing_denoiser>);
        auto const network = [](at::Tensor const& z, double, at::Tensor const&, at::Tensor const&,
                                torch_self_attention const& run) {
            auto const f = z.flatten(2).transpose(1, 2);
            auto const coarse = at::cat({f, f}, 2).slice(1, 0, 8);
            run("down_blocks.0.attn1", f, matrix(1), matrix(1), matrix(1), 1);
            auto const wide = at::eye(8);
            run("mid_block.attn1", coarse, wide, wide, wide, 2);
            run("up_blocks.2.attn1", f, matrix(1), matrix(1), matrix(1), 1);
            return z;
        };
        torch_denoiser const phi(network, told(), channels, grid);
        CHECK(phi.latent_channels() == 4);
        CHECK(phi.latent_grid() == grid);
        REQUIRE(phi.sites().size() == 3);
        CHECK(phi.sites()[0].name == "down_blocks.0.attn1");
        CHECK(bool(phi.sites()[0].part == network_part::encoder));
        CHECK(phi.sites()[0].grid == grid);
        CHECK(bool(phi.sites()[1].part == network_part::middle));
        CHECK(phi.sites()[1].grid == grid_extents{2, 4});
        CHECK(phi.sites()[1].channels == 8);
        CHECK(bool(phi.sites()[2].part == network_part::decoder));
        CHECK(bool(phi.sites()[2].network == network_kind::denoising));
    }

    TEST_CASE("an estimate is the network's own, guided and scaled") {
        constexpr float sigma = 1.5f;
        auto const by_itself = [](auto const&, at::Tensor const& f, at::Tensor const& Q, at::Tensor const& K,
                                  at::Tensor const& V, std::int64_t heads) {
            auto const parts = [&](at::Tensor const& W) {
                return at::linear(f, W).unflatten(2, {heads, -1}).transpose(1, 2);
            };
            return at::scaled_dot_product_attention(parts(Q), parts(K), parts(V)).transpose(1, 2).flatten(2);
        };
        auto const memory = waves(2);
        auto const z = tensor_of(memory.view());
        auto const in = told();
        auto const hints = at::stack({in.hints[1], in.hints[3]});
        auto const a = 1 / std::sqrt(1 + sigma * sigma);
        auto const t = in.schedule.t_of(double{sigma});
        auto const uncond = small_network(a * z, t, in.prompts[0], hints, by_itself);
        auto const cond = small_network(a * z, t, in.prompts[1], hints, by_itself);
        auto const F = uncond + 3 * (cond - uncond);
        CHECK(at::allclose(estimate(denoiser(), sigma), a * a * z - a * sigma * F, 1e-5, 1e-5));
        CHECK(denoiser().branches() == 2);
        // One prompt is not guided.
        CHECK(at::allclose(estimate(denoiser(1), sigma), a * a * z - a * sigma * uncond, 1e-5, 1e-5));
        CHECK(denoiser(1).branches() == 1);
        CHECK_FALSE(at::allclose(cond, uncond, 0, 1e-2));
    }

    TEST_CASE("the time of a rectified flow is a thousand times sigma / (1 + sigma)") {
        double seen = -1;
        auto const network = [&](at::Tensor const& z, double t, auto const&...) {
            seen = t;
            return z;
        };
        auto in = told(1);
        in.predicted = prediction::flow;
        estimate(torch_denoiser(network, in, channels, grid), 3);
        CHECK(seen == doctest::Approx(750));
    }

    TEST_CASE("any network of LibTorch keeps the laws of a denoiser") {
        auto const report = testing::check_denoiser_laws(denoiser(), 1.5f);
        CHECK_MESSAGE(report.empty(), report.text());
        CHECK(testing::check_latent_lender_laws(denoiser(), 1.5f, {.threads = 1}).text() == "");
    }

    TEST_CASE("a run uploads its latents once, downloads them once and gives the frames of calls on views") {
        auto const maps = testing::random_scene(33, 5, {16, 32}, 3);
        render_settings<float> settings = render_settings<float>::plain();
        settings.steps = 3;
        settings.keyframes.count = 2;
        settings.frames_per_call = 2;
        counting_denoiser const phi(small_network, told(), channels, grid);
        auto const lent = render(phi, to_uv_view(maps), {.settings = settings}).z;
        auto const viewed = render(viewing_denoiser{}, to_uv_view(maps), {.settings = settings}).z;
        REQUIRE(viewed.size() == 5 * 4 * 32);
        float apart = 0;
        float greatest = 0;
        for (std::size_t e = 0; e < viewed.size(); ++e) {
            apart = std::max(apart, std::abs(lent.data()[e] - viewed.data()[e]));
            greatest = std::max(greatest, std::abs(viewed.data()[e]));
        }
        CHECK(apart <= 1e-5f * greatest);
        CHECK(phi.uploads == 2); // the latents, and the background that normalisation asks for
        CHECK(phi.downloads == 1);
    }

    TEST_CASE("what does not fit a network is refused with a sentence") {
        CHECK(error_of([] { denoiser(0); }) ==
              "torch_denoiser: prompts is 0, expected 1, or 2 with classifier-free guidance");
        CHECK(error_of([] {
                  auto in = told();
                  in.hints = at::zeros({0, 1, 1, 1});
                  torch_denoiser(small_network, in, channels, grid);
              }) == "torch_denoiser: frames of hints is 0, expected at least 1");
        auto const phi = denoiser();
        auto const z = waves(1);
        auto x0 = waves(1);
        plain_attention const plain;
        std::array<frame_index, 1> const beyond{{{5}}};
        CHECK(error_of([&] { phi(x0.view(), z.view(), 1, beyond, plain); }) ==
              "torch_denoiser: frames is 5, expected below 5, the number of hints");
        auto const call = [](char const* name, std::int64_t tokens) -> torch_network {
            return [=](at::Tensor const& latents, double t, auto const&, auto const&, torch_self_attention const& run) {
                auto const f = latents.flatten(2).transpose(1, 2).slice(1, 0, tokens);
                run(t == 0 ? "first" : name, f, matrix(1), matrix(1), matrix(1), 1);
                run("last", f, matrix(1), matrix(1), matrix(1), 1);
                return latents.slice(2, 0, t == 0 ? 4 : 3);
            };
        };
        CHECK(error_of([&] { torch_denoiser(call("first", 5), told(), channels, grid); }) ==
              "torch_denoiser: tokens of first is 5, expected those of the latents' grid, halved a number of times");
        std::array<frame_index, 1> const first{{{0}}};
        torch_denoiser const other(call("another", 32), told(), channels, grid);
        CHECK(error_of([&] { other(x0.view(), z.view(), 1, first, plain); }).find("name of a module is another") !=
              std::string::npos);
        torch_denoiser const smaller(call("first", 32), told(), channels, grid);
        CHECK(error_of([&] { smaller(x0.view(), z.view(), 1, first, plain); }) ==
              "torch_denoiser: output of the network is [1, 4, 3, 8], expected [1, 4, 4, 8]");
        CHECK(error_of([&] {
                  torch_denoiser(
                      [](at::Tensor const& latents, double, auto const&, auto const&, torch_self_attention const& run) {
                          auto const f = latents.flatten(2).transpose(1, 2);
                          run("same", f, matrix(1), matrix(1), matrix(1), 1);
                          run("same", f, matrix(1), matrix(1), matrix(1), 1);
                          return latents;
                      },
                      told(), channels, grid);
              }) == "torch_denoiser: name of a module is same, expected one that no other module has");
    }
}
