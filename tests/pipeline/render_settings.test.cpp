// SPDX-License-Identifier: MIT
// [GR sec. 4] The presets: the defaults, Alg. 1 alone, and the paper to the letter.
#include <genrender/pipeline/render_settings.hpp>

#include <doctest/doctest.h>

#include <cstddef>

using namespace genrender;

TEST_SUITE("pipeline/render_settings") {
    TEST_CASE_TEMPLATE("defaults follow the paper and the list of readings", Real, float, double) {
        render_settings<Real> const settings;
        CHECK(settings.steps == 50);
        CHECK(settings.sigma_max == Real(14.6146));
        CHECK(settings.sampler == sampler_kind::euler);
        CHECK(settings.noise.kind == noise_kind::uv);
        CHECK(settings.noise.background == background_noise::fixed);
        CHECK(settings.keyframes.drawing == keyframe_drawing::uniform);
        CHECK(settings.alpha(3, {}) == Real(paper_alpha));
        CHECK(settings.first_fill_share == Real(0.5));
        CHECK(settings.injection.keeps_own_copy);
        CHECK(!settings.normalization.on_noisy_latents);
        // What is not the paper's.
        CHECK(!settings.normalization.enabled);
        CHECK(settings.consensus.enabled);
        CHECK(settings.latents_grid_alpha == 0);
    }
    TEST_CASE("a window holds its first step and not its last") {
        CHECK(is_in_window(0, 4, 0.0, 1.0));
        CHECK(is_in_window(3, 4, 0.0, 1.0));
        CHECK(!is_in_window(2, 4, 0.0, 0.5));
        CHECK(is_in_window(2, 4, 0.5, 1.0));
        CHECK(!is_in_window(0, 4, 0.0, 0.0));
    }
    TEST_CASE("by default the decoder of the denoising network takes part and a ControlNet does not") {
        attention_site site;
        CHECK(is_in_decoder(site, 0));
        CHECK(is_in_decoder(site, 1));
        site.network = network_kind::control;
        CHECK(!is_in_decoder(site, 0));
        site.network = network_kind::denoising;
        site.part = network_part::encoder;
        CHECK(!is_in_decoder(site, 0));
        site.part = network_part::middle;
        CHECK(!is_in_decoder(site, 0));
    }
    TEST_CASE("the paper's settings are its text, and the defaults differ from it where the readings say") {
        auto const paper = render_settings<float>::paper();
        CHECK(paper.correspondence.kind == correspondence_kind::texel_grid);
        CHECK(!paper.correspondence.texels.T); // matched
        CHECK(paper.average == texel_average::plain);
        CHECK(paper.noise.kind == noise_kind::uv);
        CHECK(paper.noise.reading == noise_reading::nearest_texel);
        CHECK(!paper.noise.T);
        CHECK(paper.normalization.enabled);
        CHECK(paper.normalization.statistics == adain_statistics::mean_and_deviation);
        CHECK(paper.alpha(7, {}) == 0.7F);
        CHECK(paper.first_fill_share == 0.5F);
        CHECK(paper.injection.length_correction == 0);
        CHECK(paper.injection.variance.target == variance_target::none);
        CHECK(paper.quality.at(3, 10).are_plain());
        CHECK(!paper.consensus.enabled);
        CHECK(paper.latents_grid_alpha == 1);
        CHECK(paper.sampler == sampler_kind::euler);
    }
    TEST_CASE("vivid settings are the defaults, keep eq. 6 and ask no more of an engine than the paper does") {
        auto const vivid = render_settings<double>::vivid();
        CHECK(vivid.injection.post_attention);
        CHECK(vivid.injection.length_correction == 0);
        CHECK(vivid.injection.variance.target == variance_target::none);
        CHECK(!vivid.normalization.enabled);
        CHECK(vivid.correspondence.kind == correspondence_kind::footprint);
        CHECK(vivid.consensus.enabled);
        CHECK(vivid.latents_grid_alpha == 0);
    }
    TEST_CASE("plain settings are vivid ones without what is not the paper's") {
        auto const plain = render_settings<double>::plain();
        CHECK(!plain.consensus.enabled);
        CHECK(plain.latents_grid_alpha == 1);
        CHECK(plain.correspondence.kind == correspondence_kind::footprint);
        CHECK(plain.normalization.enabled);
        CHECK(plain.normalization.statistics == adain_statistics::mean);
    }
    TEST_CASE("alpha is shared out at the latents' own grid alone") {
        auto settings = render_settings<double>::plain();
        settings.alpha = [](std::size_t step, attention_site const&) { return 0.1 * static_cast<double>(step); };
        attention_site fine;
        fine.grid = {8, 6};
        attention_site coarse;
        coarse.grid = {4, 3};
        for (auto const share : {0.0, 0.25, 1.0}) {
            settings.latents_grid_alpha = share;
            CHECK(alpha_at(settings, 5, fine, {8, 6}) == doctest::Approx(0.5 * share));
            CHECK(alpha_at(settings, 5, coarse, {8, 6}) == doctest::Approx(0.5));
            CHECK(alpha_at(settings, 5, fine, {16, 12}) == doctest::Approx(0.5));
        }
    }
}
