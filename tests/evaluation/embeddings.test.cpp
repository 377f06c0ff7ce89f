// SPDX-License-Identifier: MIT
// Embeddings in rows, and cosines by hand.
#include <genrender/evaluation/embeddings.hpp>

#include <doctest/doctest.h>

#include "support/colour_embedder.hpp"
#include <genrender/testing/random_stack.hpp>

#include <cmath>
#include <string>
#include <vector>

using namespace genrender;
using genrender::testing::colour_embedder;
using genrender::testing::random_stack;

namespace {

struct of_wrong_length : colour_embedder<float> {
    std::vector<float> embed_image(strided_view<float const, 3>) const { return {1, 2}; }
};

} // namespace

TEST_SUITE("evaluation/embeddings") {
    TEST_CASE_TEMPLATE("row i is the embedding of frame i on any number of threads", Real, float, double) {
        auto const images = random_stack<Real, 4>({5, 3, 2, 4}, 1);
        colour_embedder<Real> const embedder;
        auto const rows = embed_frames(embedder, images);
        auto const on_threads = embed_frames(embedder, images, threaded_loop{3});
        REQUIRE(rows.extents() == std::array<std::size_t, 2>{5, 3});
        for (std::size_t i = 0; i < 5; ++i) {
            auto const alone = embedder.embed_image(images.view()[i]);
            for (std::size_t d = 0; d < 3; ++d) {
                CHECK(rows(i, d) == alone[d]);
                CHECK(on_threads(i, d) == alone[d]);
            }
        }
    }

    TEST_CASE_TEMPLATE("row i is the embedding of text i", Real, float, double) {
        std::vector<std::string> const texts{"blue", "white"};
        auto const rows = embed_texts(colour_embedder<Real>{}, texts);
        REQUIRE(rows.extents() == std::array<std::size_t, 2>{2, 3});
        CHECK(rows(0, 0) == 0);
        CHECK(rows(0, 2) == 1);
        CHECK(rows(1, 0) == 1);
    }

    TEST_CASE_TEMPLATE("[GR sec. 4] the cosine by hand", Real, float, double) {
        stack<Real, 2> vectors({4, 2});
        vectors(0, 0) = 3; // (3, 4), (4, 3), (-6, -8), (0, 0)
        vectors(0, 1) = 4;
        vectors(1, 0) = 4;
        vectors(1, 1) = 3;
        vectors(2, 0) = -6;
        vectors(2, 1) = -8;
        auto const v = vectors.view();
        CHECK(cosine_similarity(v[0], v[1]) == doctest::Approx(24.0 / 25));
        CHECK(cosine_similarity(v[1], v[0]) == cosine_similarity(v[0], v[1]));
        CHECK(cosine_similarity(v[0], v[0]) == doctest::Approx(1));
        CHECK(cosine_similarity(v[0], v[2]) == doctest::Approx(-1));
        CHECK(cosine_similarity(v[0], v[3]) == 0);
    }

    TEST_CASE("the cosine never leaves its range nor overflows") {
        auto const rows = random_stack<float, 2>({50, 7}, 3);
        for (std::size_t i = 0; i < 50; ++i) {
            CHECK(cosine_similarity(rows.view()[i], rows.view()[i]) <= 1.0);
        }
        stack<float, 2> huge({1, 2});
        huge(0, 0) = huge(0, 1) = 1e30F;
        CHECK(cosine_similarity(huge.view()[0], huge.view()[0]) == doctest::Approx(1));
    }

    TEST_CASE("vectors of a wrong length are refused with a sentence") {
        auto const images = random_stack<float, 4>({1, 3, 2, 2}, 1);
        CHECK_THROWS_WITH_AS(embed_frames(of_wrong_length{}, images), "embeddings: vector is [2], expected [3]",
                             shape_error);
        stack<float, 1> const a({2});
        stack<float, 1> const b({3});
        CHECK_THROWS_WITH_AS(cosine_similarity(a.view(), b), "cosine_similarity: b is [3], expected [2]", shape_error);
    }
}
