// SPDX-License-Identifier: MIT
// [GR sec. 4: CLIP] Every law of embedders can be broken, and is told by its sentence.
#include <genrender/testing/embedder_laws.hpp>

#include "broken_laws.hpp"

#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

TEST_SUITE("testing/embedder_laws") {
    using namespace genrender;
    using namespace genrender::testing;

    namespace {

    using names = std::vector<std::string>;

    enum class lapse { none, too_short, infinite, zero, changes_the_image, other_texts, other_images };

    struct corner_embedder {
        using real_type = double;
        lapse made = lapse::none;
        mutable std::atomic<int> asked{0};

        std::size_t dimension() const { return 3; }
        std::vector<double> embed_image(strided_view<double const, 3> image) const {
            std::vector<double> vector{image(0, 0, 0), 1, image(1, 0, 0)};
            if (made == lapse::changes_the_image) {
                const_cast<double&>(image(2, 0, 1)) = 7;
            }
            vector[0] += made == lapse::other_images ? ++asked : 0;
            vector[2] = made == lapse::infinite ? std::numeric_limits<double>::infinity() : vector[2];
            return vector;
        }
        std::vector<double> embed_text(std::string_view text) const {
            std::vector<double> vector{double(text.size()), 1, made == lapse::other_texts ? double(++asked) : 0};
            if (made == lapse::too_short) {
                vector.pop_back();
            }
            return made == lapse::zero ? std::vector<double>(3) : vector;
        }
    };

    std::array const two_texts{std::string("a ball"), std::string("a box")};
    law_report report_on(lapse made) { return check_embedder_laws(corner_embedder{made}, {3, 1, 2}, two_texts); }

    } // namespace

    TEST_CASE("an embedder that keeps the laws has none to tell") { CHECK(report_on(lapse::none).text() == ""); }
    TEST_CASE("vectors of another length, without a direction or not finite are refused") {
        auto const text_of = [](std::vector<float> const& vector, std::size_t dimension) {
            law_report report;
            genrender::testing::detail::require_embedding(report, vector, dimension, "it");
            return report.text();
        };
        CHECK(text_of({0, 1}, 2) == "");
        CHECK(text_of({0, 1}, 3).find("vectors have dimension() elements") != std::string::npos);
        CHECK(text_of({0, 0}, 2).find("vectors are not zero") != std::string::npos);
        CHECK(text_of({1, std::numeric_limits<float>::infinity()}, 2).find("vectors are finite") != std::string::npos);
    }
    TEST_CASE("each lapse is told by the law that it breaks") {
        CHECK(broken_laws(report_on(lapse::infinite)) == names{"image_text_embedder: vectors are finite"});
        CHECK(broken_laws(report_on(lapse::other_images)) ==
              names{"image_text_embedder: equal images give equal vectors, from any thread"});
        CHECK(report_on(lapse::too_short).text() ==
              "image_text_embedder: vectors have dimension() elements: found 2 of "
              "text 'a ball', expected 3\n");
        CHECK(report_on(lapse::zero).text() ==
              "image_text_embedder: vectors are not zero: found zeros alone of text 'a ball', expected a direction\n");
        CHECK(report_on(lapse::other_texts).text() ==
              "image_text_embedder: equal texts give equal vectors: found "
              "another vector of 'a ball' when asked again, expected the same\n");
        auto const report = report_on(lapse::changes_the_image);
        CHECK(broken_laws(report) == names{"image_text_embedder: the image is not changed"});
        CHECK(report.text().find("found image 0 [2, 0, 1] = 7, expected ") != std::string::npos);
    }
}
