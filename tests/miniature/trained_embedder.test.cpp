// SPDX-License-Identifier: MIT
// What the embedder that lies in examples/miniature/embedder knows of pictures and of paints that its training never
// showed.
#include <genrender/core/tensor.hpp>
#include <genrender/reference/reference_clip.hpp>

#include <examples/miniature/lit_picture.hpp>
#include <examples/miniature/world_scene.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

using namespace genrender;
using namespace genrender::examples;
using namespace genrender::examples::miniature;

TEST_SUITE("miniature/trained_embedder") {
    constexpr std::array pattern_texts{"plain", "checkered", "striped", "dotted", "brick", "wavy"};

    reference_clip<float> const& trained_embedder() {
        static auto const embedder = reference_clip<float>::from_folder(
            std::filesystem::path(GENRENDER_TEST_DATA) / ".." / ".." / "examples" / "miniature" / "embedder");
        return embedder;
    }

    /// Held-out pictures whose subjects have two colours, with what they show.
    struct seen_picture {
        world_description shows;
        std::vector<float> vector;
    };

    std::vector<seen_picture> const& seen_pictures() {
        static auto const pictures = [] {
            std::vector<seen_picture> seen;
            for (std::uint32_t number = 0; seen.size() < 30; ++number) {
                auto const drawn = draw_world(77, number, picture_set::held_out);
                if (drawn.description.pattern == surface_pattern::plain) {
                    continue;
                }
                auto const picture =
                    draw_lit(drawn.scene, drawn.paint, {128, 128}, 3, drawn.target, drawn.shadow_radius);
                seen.push_back({drawn.description, trained_embedder().embed_image(picture.image)});
            }
            return seen;
        }();
        return pictures;
    }

    double likeness(std::vector<float> const& one, std::vector<float> const& other) {
        double sum = 0;
        for (std::size_t d = 0; d < one.size(); ++d) {
            sum += double{one[d]} * double{other[d]};
        }
        return sum;
    }

    /// Which of the texts is nearest to the picture.
    std::size_t nearest_of(std::vector<std::vector<float>> const& texts, std::vector<float> const& picture) {
        auto const nearest = std::max_element(texts.begin(), texts.end(), [&](auto const& a, auto const& b) {
            return likeness(picture, a) < likeness(picture, b);
        });
        return static_cast<std::size_t>(nearest - texts.begin());
    }

    std::string colours_text(std::size_t first, std::size_t second) {
        return std::string(colour_words[first]) + " and " + std::string(colour_words[second]);
    }

    TEST_CASE("of the patterns the nearest text is true of nine pictures in ten") {
        std::vector<std::vector<float>> texts;
        for (auto const* pattern : pattern_texts) {
            texts.push_back(trained_embedder().embed_text(std::string("a ") + pattern + " ball"));
        }
        std::size_t right = 0;
        for (auto const& seen : seen_pictures()) {
            right += nearest_of(texts, seen.vector) == static_cast<std::size_t>(seen.shows.pattern);
        }
        CHECK(10 * right >= 9 * seen_pictures().size());
        MESSAGE(right, " of ", seen_pictures().size());
    }

    TEST_CASE("of all pairs of colours the nearest text is true of nine pictures in ten, in both orders of its words") {
        for (auto const swapped : {false, true}) {
            std::vector<std::array<std::size_t, 2>> pairs;
            std::vector<std::vector<float>> texts;
            for (std::size_t a = 0; a < colour_words.size(); ++a) {
                for (std::size_t b = a + 1; b < colour_words.size(); ++b) {
                    pairs.push_back({a, b});
                    auto const words = swapped ? colours_text(b, a) : colours_text(a, b);
                    texts.push_back(trained_embedder().embed_text("a " + words + " ball"));
                }
            }
            std::size_t right = 0;
            for (auto const& [shows, vector] : seen_pictures()) {
                auto const first = static_cast<std::size_t>(shows.first);
                auto const second = static_cast<std::size_t>(shows.second);
                right +=
                    pairs[nearest_of(texts, vector)] == std::array{std::min(first, second), std::max(first, second)};
            }
            CHECK(10 * right >= 9 * seen_pictures().size());
            MESSAGE(right, " of ", seen_pictures().size());
        }
    }

    TEST_CASE("a text that swaps the colours of subject and ground is farther than the true one") {
        std::size_t right = 0;
        std::size_t asked = 0;
        for (auto const& seen : seen_pictures()) {
            auto const& shows = seen.shows;
            auto const first = static_cast<std::size_t>(shows.first);
            auto const second = static_cast<std::size_t>(shows.second);
            auto const ground = static_cast<std::size_t>(shows.ground.colour);
            if (!shows.has_ground || ground == first || ground == second) {
                continue;
            }
            auto const text = [&](std::size_t subject, std::size_t below) {
                return trained_embedder().embed_text("a " + std::string(colour_words[subject]) + ' ' +
                                                     pattern_texts[static_cast<std::size_t>(shows.pattern)] +
                                                     " ball on " + std::string(colour_words[below]) + " ground");
            };
            ++asked;
            right += likeness(seen.vector, text(first, ground)) > likeness(seen.vector, text(ground, first));
        }
        REQUIRE(asked > 0);
        CHECK(10 * right >= 9 * asked);
        MESSAGE(right, " of ", asked);
    }
}
