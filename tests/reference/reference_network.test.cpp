// SPDX-License-Identifier: MIT
// Tests of the reference network as a whole.
#include <genrender/reference/reference_network.hpp>

#include <genrender/testing/denoiser_laws.hpp>
#include "../support/random_scene.hpp"
#include "small_reference_network.hpp"
#include "written_networks.hpp"

#include <genrender/keyframes/recorder.hpp>
#include <genrender/pipeline/render.hpp>
#include <genrender/reference/diffusers_folder.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

static_assert(denoiser<reference_network<float>>);
static_assert(denoiser<reference_network<double>>);
static_assert(residual_lender<reference_network<float>>);

namespace {

/// Inverse depth of three frames, 8 x 12 pixels: a slope, and a box that moves.
stack<float, 3> moving_box() {
    stack<float, 3> depth({3, 8, 12});
    for (std::size_t frame = 0; frame < 3; ++frame) {
        for (std::size_t row = 0; row < 8; ++row) {
            for (std::size_t column = 0; column < 12; ++column) {
                auto const in_box = row > 1 && row < 6 && column >= 2 * frame && column < 2 * frame + 5;
                depth(frame, row, column) = in_box ? 0.9f : 0.05f * static_cast<float>(row);
            }
        }
    }
    return depth;
}

template <class Real>
reference_network<Real> small_network(std::uint64_t prompt = 1, Real guidance = 2, any_loop loop = {}) {
    return seeded_network(small_conditioning<Real>(moving_box(), prompt, guidance), 1, std::move(loop));
}

template <class Network, class Real>
stack<Real, 4> estimate_of(Network const& network, stack<Real, 4> const& z, Real sigma) {
    std::array const frames{frame_index{0}, frame_index{1}, frame_index{2}};
    stack<Real, 4> x0(z.extents());
    plain_attention const plain;
    network(x0.view(), z.view(), sigma, frames, plain);
    return x0;
}

template <class Real>
double largest_difference(stack<Real, 4> const& a, stack<Real, 4> const& b) {
    double largest = 0;
    for (std::size_t e = 0; e < a.size(); ++e) {
        largest = std::max(largest, std::abs(static_cast<double>(a.data()[e] - b.data()[e])));
    }
    return largest;
}

/// Plain attention that writes down where and for whom it ran.
struct noting_attention {
    std::vector<attention_place>* places;
    std::vector<std::array<std::size_t, 3>>* extents;

    template <attention_call Call>
    typename Call::features_type operator()(Call& call) const {
        places->push_back(call.place());
        if constexpr (requires { call.f().extents(); }) {
            extents->push_back(call.f().extents());
        }
        return plain_attention{}(call);
    }
};

/// A network without its capabilities.
template <class Network>
struct bare_network {
    using real_type = typename Network::real_type;
    using features_type = typename Network::features_type;
    Network const* network;
    std::size_t latent_channels() const { return network->latent_channels(); }
    grid_extents latent_grid() const { return network->latent_grid(); }
    std::span<attention_site const> sites() const { return network->sites(); }
    std::size_t branches() const { return network->branches(); }
    template <class Processor>
    void operator()(strided_view<real_type, 4> x0, strided_view<real_type const, 4> z, real_type sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        (*network)(x0, z, sigma, frames, processor);
    }
};

} // namespace

TEST_SUITE("reference/reference_network") {
    TEST_CASE_TEMPLATE("it keeps the laws of denoisers", Real, float, double) {
        CHECK(check_denoiser_laws(small_network<Real>(), Real(1.5)).text() == "");
    }

    TEST_CASE_TEMPLATE("a frame is the same to the bit alone and in company and on any number of threads", Real, float,
                       double) {
        auto const network = small_network<Real>();
        auto const z = random_stack<Real, 4>({3, 4, 4, 6}, 2);
        auto const together = estimate_of(network, z, Real(3));
        plain_attention const plain;
        for (std::uint32_t i = 0; i < 3; ++i) {
            stack<Real, 4> alone({1, 4, 4, 6});
            network(alone.view(), z.view().slice(i, 1), Real(3), std::array{frame_index{i}}, plain);
            for (std::size_t e = 0; e < alone.size(); ++e) {
                REQUIRE(alone.data()[e] == together.data()[i * alone.size() + e]);
            }
        }
        for (std::size_t const threads : {1U, 2U, 3U}) {
            auto const threaded = small_network<Real>(1, 2, threaded_loop(threads));
            CHECK(largest_difference(estimate_of(threaded, z, Real(3)), together) == 0);
        }
    }

    TEST_CASE("sites run in the order of their list once a branch with the tokens of their grid") {
        auto const network = small_network<float>();
        std::vector<attention_place> places;
        std::vector<std::array<std::size_t, 3>> extents;
        noting_attention const noting{&places, &extents};
        auto const z = random_stack<float, 4>({2, 4, 4, 6}, 2);
        stack<float, 4> x0(z.extents());
        network(x0.view(), z.view(), 1.0f, std::array{frame_index{2}, frame_index{0}}, noting);

        std::vector<std::string> const names{"down_blocks.0.attentions.0.transformer_blocks.0.attn1",
                                             "mid_block.attentions.0.transformer_blocks.0.attn1",
                                             "down_blocks.0.attentions.0.transformer_blocks.0.attn1",
                                             "mid_block.attentions.0.transformer_blocks.0.attn1",
                                             "up_blocks.1.attentions.0.transformer_blocks.0.attn1",
                                             "up_blocks.1.attentions.1.transformer_blocks.0.attn1"};
        auto const sites = network.sites();
        REQUIRE(sites.size() == names.size());
        for (std::size_t s = 0; s < names.size(); ++s) {
            CHECK(sites[s].name == names[s]);
            CHECK(sites[s].network == (s < 2 ? network_kind::control : network_kind::denoising));
        }
        CHECK(sites[0].part == network_part::encoder);
        CHECK(sites[1].part == network_part::middle);
        CHECK(sites[5].part == network_part::decoder);
        CHECK(sites[5].grid == grid_extents{4, 6});

        REQUIRE(places.size() == 2 * sites.size());
        for (std::uint32_t call = 0; call < places.size(); ++call) {
            auto const site = call % 6;
            CHECK(places[call] == attention_place{{site}, call / 6});
            CHECK(extents[call] == std::array<std::size_t, 3>{2, sites[site].grid.size(), sites[site].channels});
        }
    }

    TEST_CASE_TEMPLATE("guidance goes from the empty prompt past the prompt", Real, float, double) {
        auto const z = random_stack<Real, 4>({3, 4, 4, 6}, 2);
        auto const guided = small_network<Real>(2, 3);
        auto const cond = small_network<Real>(2, 1);
        auto const uncond = small_network<Real>(0, 1);
        CHECK(guided.branches() == 2);
        CHECK(cond.branches() == 1);
        auto const a = estimate_of(uncond, z, Real(1));
        auto const b = estimate_of(cond, z, Real(1));
        auto expected = a;
        for (std::size_t e = 0; e < a.size(); ++e) {
            expected.data()[e] += 3 * (b.data()[e] - a.data()[e]);
        }
        auto const found = estimate_of(guided, z, Real(1));
        check_close<Real const, 4>(found.view(), expected.view());
        CHECK(largest_difference(a, b) > 0.01);
    }

    TEST_CASE("the estimate answers to noise and depth and prompt and seed") {
        auto const z = random_stack<float, 4>({3, 4, 4, 6}, 2);
        auto const base = estimate_of(small_network<float>(), z, 1.0f);
        CHECK(largest_difference(
                  base, estimate_of(small_network<float>(), random_stack<float, 4>({3, 4, 4, 6}, 3), 1.0f)) > 0.05);
        CHECK(largest_difference(base, estimate_of(small_network<float>(3), z, 1.0f)) > 0.05);
        auto const flat = seeded_network(small_conditioning<float>(stack<float, 3>({3, 8, 12}), 1));
        CHECK(largest_difference(base, estimate_of(flat, z, 1.0f)) > 0.05);
        auto const other = seeded_network(small_conditioning<float>(moving_box(), 1), 2);
        CHECK(largest_difference(base, estimate_of(other, z, 1.0f)) > 0.05);
    }

    TEST_CASE_TEMPLATE("[EDM eq. 7] the output is read as the config says", Real, float, double) {
        auto const z = random_stack<Real, 4>({3, 4, 4, 6}, 2);
        auto config = small_config();
        auto const with = [&](prediction predicted) {
            config.prediction_type = predicted;
            return estimate_of(seeded_network(small_conditioning<Real>(moving_box(), 4, 1), 1, {}, config), z, Real(2));
        };
        auto const F = with(prediction::clean);
        auto const velocity = with(prediction::velocity);
        auto expected = F;
        for (std::size_t e = 0; e < F.size(); ++e) {
            expected.data()[e] = z.data()[e] / 5 - F.data()[e] * 2 / std::sqrt(Real(5));
        }
        check_close<Real const, 4>(velocity.view(), expected.view());
    }

    TEST_CASE("the network is told of time and noise as its config says of the training") {
        auto config = small_config();
        auto const z = random_stack<float, 4>({3, 4, 4, 6}, 2);
        auto const of_steps = [&](std::size_t steps) {
            config.num_train_timesteps = steps;
            return estimate_of(seeded_network(small_conditioning<float>(moving_box(), 2, 1), 1, {}, config), z, 1.0f);
        };
        auto const base = of_steps(1000);
        CHECK(largest_difference(base, of_steps(100)) > 1e-3);
        config.beta_end = 0.02;
        CHECK(largest_difference(base, of_steps(1000)) > 1e-3);
        config.beta_end = 2;
        CHECK_THROWS_AS(of_steps(1000), value_error);
    }

    TEST_CASE_TEMPLATE("networks of a folder give the estimate of those that were written", Real, float, double) {
        written_networks const written;
        auto const z = random_stack<Real, 4>({3, 4, 4, 6}, 2);
        auto const expected = estimate_of(seeded_network(small_conditioning<Real>(moving_box(), 5, 3), 3), z, Real(2));
        diffusers_folder const files(written.path());
        auto unet_weights = files.template unet<Real>();
        auto control_weights = files.template controlnet<Real>();
        reference_network<Real> const network(files.config(), unet_weights, control_weights,
                                              small_conditioning<Real>(moving_box(), 5, 3));
        CHECK(network.config().prediction_type == prediction::clean);
        CHECK(largest_difference(expected, estimate_of(network, z, Real(2))) == 0);
    }

    TEST_CASE("what does not fit is refused by name") {
        auto const network = small_network<float>();
        plain_attention const plain;
        stack<float, 4> z({1, 4, 4, 6});
        stack<float, 4> x0({1, 4, 4, 6});
        auto const run = [&](stack<float, 4> const& in, float sigma, std::uint32_t frame) {
            network(x0.view(), in.view(), sigma, std::array{frame_index{frame}}, plain);
        };
        CHECK_THROWS_WITH_AS(run(z, 1, 3), "reference_network: frames is 3, expected below 3", value_error);
        CHECK_THROWS_WITH_AS(run(stack<float, 4>({1, 4, 4, 4}), 1, 0),
                             "reference_network: z is [1, 4, 4, 4], expected [1, 4, 4, 6]", shape_error);
        CHECK_THROWS_AS(run(z, -1, 0), value_error);

        auto const build = [](std::size_t frames, std::size_t height, std::size_t width) {
            return seeded_network(small_conditioning<float>(stack<float, 3>({frames, height, width}), 0));
        };
        CHECK_THROWS_WITH_AS(build(1, 8, 9), "reference_network: width of hint is 9, expected a multiple of 2",
                             value_error);
        CHECK_THROWS_WITH_AS(build(1, 6, 8),
                             "unet_config: height of the latents is 3, expected a multiple of 2 above 0", value_error);
        CHECK_THROWS_WITH_AS(build(0, 8, 8), "reference_network: frames of hint is 0, expected at least 1",
                             value_error);

        auto conditioning = small_conditioning<float>(moving_box(), 0);
        conditioning.prompt = stack<float, 2>({2, 7});
        CHECK_THROWS_WITH_AS(seeded_network(conditioning), "reference_network: prompt is [2, 7], expected [2, 6]",
                             shape_error);
    }

    TEST_CASE("a call ends behind the last wanted site of each branch") {
        auto const network = small_network<float>();
        auto const z = random_stack<float, 4>({2, 4, 4, 6}, 2);
        std::array const frames{frame_index{2}, frame_index{0}};
        using last_type = std::array<std::optional<site_index>, 2>;
        auto const ran = [&](last_type const& last) {
            std::vector<attention_place> places;
            std::vector<std::array<std::size_t, 3>> extents;
            noting_attention const noting{&places, &extents};
            network.run_until(z.view(), 1.0f, frames, noting, last);
            std::array<std::size_t, 2> counts{};
            for (auto const place : places) {
                CHECK(place.site.value == counts[place.branch]++);
            }
            return counts;
        };
        CHECK(ran({site_index{5}, site_index{5}}) == std::array<std::size_t, 2>{6, 6});
        CHECK(ran({site_index{4}, site_index{1}}) == std::array<std::size_t, 2>{5, 2});
        CHECK(ran({std::nullopt, site_index{0}}) == std::array<std::size_t, 2>{0, 1});
        plain_attention const plain;
        std::array<std::optional<site_index>, 1> const one{};
        CHECK_THROWS_WITH_AS(network.run_until(z.view(), 1.0f, frames, plain, one),
                             "reference_network: last is [1], expected [2]", shape_error);
    }

    TEST_CASE_TEMPLATE("features recorded in a call that ends early are those of a whole one to the bit", Real, float,
                       double) {
        auto const network = small_network<Real>();
        auto const z = random_stack<Real, 4>({2, 4, 4, 6}, 2);
        std::array const frames{frame_index{2}, frame_index{0}};
        auto const takes_part = [](attention_place place) { return place.site.value == 4; };
        using bank_type = feature_bank<host_features<Real>>;
        bank_type whole(6, 2);
        bank_type early(6, 2);
        recorder<host_features<Real>> const to_whole(whole, takes_part);
        recorder<host_features<Real>> const to_early(early, takes_part);
        stack<Real, 4> x0(z.extents());
        network(x0.view(), z.view(), Real(2), frames, to_whole);
        network.run_until(z.view(), Real(2), frames, to_early, last_sites(network, takes_part));
        for (std::uint32_t branch = 0; branch < 2; ++branch) {
            auto const& a = *whole.find({{4}, branch});
            auto const& b = *early.find({{4}, branch});
            for (auto const& [x, y] : {std::pair(a.K_KF, b.K_KF), {a.V_KF, b.V_KF}, {a.F_KF, b.F_KF}}) {
                auto const size = x->view().size();
                CHECK(std::equal(x->view().data(), x->view().data() + size, y->view().data()));
            }
        }
    }

    TEST_CASE_TEMPLATE("what a call lends gives the same estimate to the bit and skips the way down", Real, float,
                       double) {
        auto const network = small_network<Real>();
        auto const z = random_stack<Real, 4>({3, 4, 4, 6}, 2);
        std::array const all{frame_index{0}, frame_index{1}, frame_index{2}};
        std::array const two{frame_index{1}, frame_index{2}};
        typename reference_network<Real>::residuals_type lent;
        plain_attention const plain;
        std::array<std::optional<site_index>, 2> const last{site_index{5}, site_index{5}};
        network.run_until(z.view(), Real(2), all, plain, last, &lent);
        stack<Real, 4> expected({2, 4, 4, 6});
        stack<Real, 4> found({2, 4, 4, 6});
        network(expected.view(), z.view().slice(1, 2), Real(2), two, plain);
        network(found.view(), z.view().slice(1, 2), Real(2), two, plain, lent);
        CHECK(largest_difference(expected, found) == 0);

        // Who does not say that he is plain gets it all computed; who does, the decoder's sites alone.
        std::vector<attention_place> places;
        std::vector<std::array<std::size_t, 3>> extents;
        noting_attention const noting{&places, &extents};
        network(found.view(), z.view().slice(1, 2), Real(2), two, noting, lent);
        CHECK(places.size() == 12);
        struct noting_plain : noting_attention {
            bool is_plain_at(attention_place) const { return true; }
        };
        places.clear();
        noting_plain const noting_and_plain{{&places, &extents}};
        network(found.view(), z.view().slice(1, 2), Real(2), two, noting_and_plain, lent);
        CHECK(places.size() == 4);
        CHECK(largest_difference(expected, found) == 0);

        // Another z is computed anew.
        auto const other = random_stack<Real, 4>({2, 4, 4, 6}, 3);
        network(expected.view(), other.view(), Real(2), two, plain);
        network(found.view(), other.view(), Real(2), two, plain, lent);
        CHECK(largest_difference(expected, found) == 0);
    }

    TEST_CASE("hints that are not kept give the same estimate to the bit") {
        auto const z = random_stack<float, 4>({3, 4, 4, 6}, 2);
        auto const with = [&](std::size_t hint_bytes) {
            auto unet_weights = weights<float>::seeded(1, "unet");
            auto control_weights = weights<float>::seeded(1, "controlnet");
            return estimate_of(reference_network<float>(small_config(), unet_weights, control_weights,
                                                        small_conditioning<float>(moving_box(), 1), {}, hint_bytes),
                               z, 1.0f);
        };
        CHECK(largest_difference(with(std::size_t{1} << 26), with(0)) == 0);
    }

    TEST_CASE("[GR alg. 1] a run that ends keyframe passes early and reuses keyframes is the same to the bit") {
        auto const network = small_network<float>();
        bare_network<reference_network<float>> const bare{&network};
        CHECK_FALSE(stoppable_denoiser<bare_network<reference_network<float>>>);
        auto const maps = random_scene(33, 3, {16, 24}, 2);
        auto const run = [&](auto const& phi, auto&& change) {
            render_settings<float> settings = render_settings<float>::plain();
            settings.steps = 3;
            settings.keyframes.count = 2;
            change(settings);
            return render(phi, to_uv_view(maps), {.settings = settings, .loop = threaded_loop(2)}).z;
        };
        auto const as_it_is = [](auto&) {};
        auto const expected = run(bare, as_it_is);
        CHECK(run(network, as_it_is) == expected);
        CHECK(run(network, [](auto& settings) { settings.reuses_keyframes = false; }) == expected);
        CHECK(run(network, [](auto& settings) { settings.frames_per_call = 2; }) == expected);
        auto const filled = [](auto& settings) {
            settings.frames_per_call = 2; // of 3 frames
            settings.fills_last_call = true;
            settings.calls_at_once = 1;
        };
        CHECK(run(network, filled) == expected);
        // Where the encoder takes part the way down of keyframes is another one, and nothing is reused.
        auto const everywhere = [](auto& settings) {
            settings.layers = [](attention_site const&, std::uint32_t) { return true; };
        };
        auto const all = run(bare, everywhere);
        CHECK(run(network, everywhere) == all);
        CHECK(all != expected);
        auto const one_branch = [](auto& settings) {
            settings.layers = [](attention_site const& site, std::uint32_t branch) {
                return is_in_decoder(site, branch) && branch == 1;
            };
        };
        CHECK(run(network, one_branch) == run(bare, one_branch));
    }
}
