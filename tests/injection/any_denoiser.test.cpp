// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi] A denoiser behind one type renders what it renders by itself.
#include <genrender/injection/any_denoiser.hpp>

#include <genrender/injection/feature_io.hpp>
#include <genrender/pipeline/render.hpp>
#include <genrender/testing/analytic_denoiser.hpp>
#include <genrender/testing/attention_call_laws.hpp>
#include <genrender/testing/denoiser_laws.hpp>
#include "../support/slanted_maps.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <span>
#include <vector>

using namespace genrender;

namespace {

using analytic = testing::analytic_denoiser<float>;

/// One site whose F is its own and the joined f_KF's mean, as a static graph would have it: it shows whether inputs and
/// outputs come through, not what attention is.
struct static_denoiser {
    using real_type = float;
    using features_type = host_features<float>;
    bool hands_over = true;
    std::vector<attention_site> site_list = {
        {"decoder.attn1", network_kind::denoising, network_part::decoder, {16, 16}, 3}};
    std::size_t latent_channels() const { return 3; }
    grid_extents latent_grid() const { return {16, 16}; }
    std::span<attention_site const> sites() const { return site_list; }
    std::size_t branches() const { return 1; }

    template <feature_io_processor<host_features<float>, float> Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float,
                    std::span<frame_index const> frames, Processor& processor) const {
        auto const in = inputs_at<features_type, float>(processor, {}, frames);
        auto const f = features_type::allocate({frames.size(), 256, 3});
        auto F = features_type::allocate({frames.size(), 256, 3});
        auto const each = [&](auto const& use) {
            for (std::size_t i = 0; i < frames.size(); ++i) {
                for (std::uint32_t t = 0; t < 256; ++t) {
                    for (std::size_t c = 0; c < 3; ++c) {
                        use(i, t, c);
                    }
                }
            }
        };
        each([&](std::size_t i, std::uint32_t t, std::size_t c) {
            f.view()(i, t, c) = z(i, c, t / 16, t % 16) / 20;
            auto joined = in.attends_to_stack ? 0.25f : 0.0f;
            if (in.f_KF != nullptr) {
                for (std::size_t k = 0; k < in.f_KF->extents()[0]; ++k) {
                    joined += k == in.left_out[i] ? 0 : in.f_KF->view()(k, t, c);
                }
            }
            F.view()(i, t, c) = f.view()(i, t, c) + joined / 10;
        });
        for (std::size_t i = 0; i < in.rows.size(); ++i) {
            post_attention(F.view()[i], *in.F_KF, in.rows[i], in.alpha);
        }
        each([&](std::size_t i, std::uint32_t t, std::size_t c) { x0(i, c, t / 16, t % 16) = F.view()(i, t, c); });
        if (in.is_recorded && hands_over) {
            record_features(processor, {}, f, F);
        }
    }
};

render_settings<float> three_steps() {
    render_settings<float> settings = render_settings<float>::plain();
    settings.steps = 3;
    settings.keyframes.count = 2;
    return settings;
}

template <class Phi>
bool renders_the_same(Phi const& phi, render_settings<float> const& settings) {
    auto const maps = testing::slanted_maps(4);
    auto const UV = to_uv_view(maps);
    auto const expected = render(phi, UV, {.settings = settings}).z;
    auto const found = render(any_denoiser<float>(phi), UV, {.settings = settings}).z;
    return std::equal(expected.begin(), expected.end(), found.begin(), found.end());
}

} // namespace

TEST_SUITE("injection/any_denoiser") {
    TEST_CASE("it renders the frames of a denoiser that calls back, to the bit") {
        analytic const phi{.grid = {16, 16}, .attention = 0.5f, .guidance_branches = 2};
        CHECK(renders_the_same(phi, three_steps()));
        auto in_16_bits = three_steps();
        in_16_bits.keyframe_storage = feature_storage::bf16;
        CHECK(renders_the_same(phi, in_16_bits));
        auto vivid = three_steps();
        vivid.injection.length_correction = 1;
        vivid.injection.variance.target = variance_target::total;
        CHECK(renders_the_same(phi, vivid));
    }
    TEST_CASE("it renders the frames of a static graph, to the bit") {
        CHECK(renders_the_same(static_denoiser{}, three_steps()));
        auto without = three_steps();
        without.injection.post_attention = false;
        CHECK(renders_the_same(static_denoiser{}, without));
        auto scaled = three_steps();
        scaled.injection.length_correction = 1;
        CHECK_THROWS_WITH_AS(renders_the_same(static_denoiser{}, scaled),
                             "inputs_at: logits are scaled, expected a length_correction of 0 for an engine whose "
                             "graph_abilities do not say scales_logits",
                             value_error);
    }
    TEST_CASE("it tells the denoiser the shapes of a run") {
        struct prepared : analytic {
            run_shapes* told = nullptr;
            void prepare(run_shapes const& shapes) const { *told = shapes; }
        };
        run_shapes told;
        prepared const phi{{.grid = {16, 16}}, &told};
        CHECK(renders_the_same(phi, three_steps()));
        told = {};
        auto const maps = testing::slanted_maps(4);
        render(any_denoiser<float>(phi), to_uv_view(maps), {.settings = three_steps()});
        CHECK(told.keyframes == 2);
        CHECK(told.row_width == 2);
    }
    TEST_CASE("it tells sites, branches and latents of the denoiser") {
        analytic const phi{.grid = {4, 8}, .channels = 5, .guidance_branches = 2};
        any_denoiser<float> const any(phi);
        CHECK(any.latent_channels() == 5);
        CHECK(any.latent_grid() == grid_extents{4, 8});
        CHECK(any.branches() == 2);
        REQUIRE(any.sites().size() == 3);
        CHECK(any.sites()[1].name == "control.attn1");
        CHECK(any.residual_bytes() == 0);
    }
    TEST_CASE("it keeps the laws of denoiser, of one that stops early and of one that lends") {
        any_denoiser<float> const any(analytic{.grid = {4, 4}, .attention = 0.5f, .guidance_branches = 2});
        CHECK(residual_lender<any_denoiser<float>>);
        CHECK(testing::check_denoiser_laws(any, 1.5f).text() == "");
    }
    TEST_CASE("a static graph that does not hand over features is told of record_features") {
        auto const maps = testing::slanted_maps(4);
        CHECK_THROWS_WITH_AS(
            render(static_denoiser{.hands_over = false}, to_uv_view(maps), {.settings = three_steps()}),
            "sequence_denoiser: features of keyframes at site decoder.attn1 of branch 0 are missing, "
            "expected the denoiser to call record_features(processor, place, f, F) after its graph "
            "has run, since inputs_at said is_recorded there",
            value_error);
    }
    TEST_CASE("a processor without inputs is refused by a static graph") {
        struct without_inputs {
            any_features operator()(any_attention_call<float>& call) const { return call.f(); }
        };
        any_denoiser<float> const any(static_denoiser{});
        stack<float, 4> z({1, 3, 16, 16});
        stack<float, 4> x0({1, 3, 16, 16});
        without_inputs const processor;
        std::array<frame_index, 1> const frames{{{0}}};
        CHECK_THROWS_WITH_AS(any(x0.view(), z.view(), 1.0f, frames, processor),
                             "any_denoiser: the processor has no inputs_at(processor, place, frames), expected a "
                             "feature_io_processor for a denoiser that is a static graph",
                             value_error);
    }
}
