// SPDX-License-Identifier: MIT
// Settings that change frames change their text; those that only change cost do not.
#include <examples/evaluation/settings_text.hpp>

#include <doctest/doctest.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

using namespace genrender;
using namespace genrender::examples;

TEST_SUITE("evaluation_program/settings_text") {
    std::string text_of_change(std::function<void(row_settings&)> const& change) {
        auto settings = vivid();
        settings.steps = 5;
        change(settings);
        attention_site decoder{"up", network_kind::denoising, network_part::decoder, {4, 4}, 8};
        attention_site encoder{"down", network_kind::denoising, network_part::encoder, {4, 4}, 8};
        return settings_text(settings, {decoder, encoder}, 2);
    }

    TEST_CASE("each change of what frames depend on is another text") {
        std::vector<std::function<void(row_settings&)>> const changes{
            [](auto&) {},
            [](auto& x) { x.steps = 6; },
            [](auto& x) { x.sampler = sampler_kind::heun; },
            [](auto& x) { x.sigma_max = 14; },
            [](auto& x) { x.noise.kind = noise_kind::fixed; },
            [](auto& x) { x.noise.seed = 1; },
            [](auto& x) { x.noise.T = 64; },
            [](auto& x) { x.noise.T = 65; },
            [](auto& x) { x.keyframes.seed = 1; },
            [](auto& x) { x.keyframes.frames = {{0}}; },
            [](auto& x) { x.correspondence.kind = correspondence_kind::texel_grid; },
            [](auto& x) { x.correspondence.texels.T = 64; },
            [](auto& x) { x.normalization.enabled = true; },
            [](auto& x) { x.normalization.window_end = 0.5F; },
            [](auto& x) { x.injection.keeps_own_copy = false; },
            [](auto& x) { x.window_begin = 0.1F; },
            [](auto& x) { x.latents_grid_alpha = 0.5F; },
            [](auto& x) { x.consensus.enabled = false; },
            [](auto& x) { x.consensus.agrees_on_background = false; },
            [](auto& x) { x.consensus.background_distance = 3; },
            [](auto& x) { x.consensus.quality.exponent_begin = 2; },
            [](auto& x) { x.consensus.quality.exponent_end = 2; },
            [](auto& x) { x.alpha = [](std::size_t step, attention_site const&) { return step == 4 ? 0.6F : 0.7F; }; },
            [](auto& x) {
                x.alpha = [](std::size_t, attention_site const& site) { return site.name == "up" ? 0.6F : 0.7F; };
            },
            [](auto& x) { x.layers = [](attention_site const&, std::uint32_t) { return true; }; },
            [](auto& x) { x.layers = [](attention_site const&, std::uint32_t branch) { return branch == 1; }; }};
        std::map<std::string, std::size_t> texts;
        for (std::size_t k = 0; k < changes.size(); ++k) {
            auto const place = texts.try_emplace(text_of_change(changes[k]), k);
            CHECK_MESSAGE(place.second, "changes " << k << " and " << place.first->second);
        }
    }

    TEST_CASE("changes of cost are the same text") {
        auto const text = text_of_change([](auto&) {});
        CHECK(text_of_change([](auto& x) { x.reuses_keyframes = false; }) == text);
        CHECK(text_of_change([](auto& x) { x.frames_per_call = 4; }) == text);
        CHECK(text_of_change([](auto& x) { x.calls_at_once = 1; }) == text);
    }
}
