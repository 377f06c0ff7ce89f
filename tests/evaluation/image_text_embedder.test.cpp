// SPDX-License-Identifier: MIT
// The concept takes its archetype and the embedder of the tests, and nothing less.
#include <genrender/evaluation/image_text_embedder.hpp>

#include <doctest/doctest.h>

#include "support/colour_embedder.hpp"
#include <genrender/testing/embedder_laws.hpp>

#include <string>
#include <vector>

using namespace genrender;
using genrender::testing::check_embedder_laws;
using genrender::testing::colour_embedder;

namespace {

struct without_texts : image_text_embedder_archetype<float> {
    std::vector<float> embed_text(std::string_view) const = delete;
};
struct of_another_scalar : image_text_embedder_archetype<float> {
    std::vector<double> embed_image(strided_view<float const, 3>) const;
};

static_assert(image_text_embedder<image_text_embedder_archetype<float>>);
static_assert(image_text_embedder<image_text_embedder_archetype<double>>);
static_assert(!image_text_embedder<without_texts>);
static_assert(!image_text_embedder<of_another_scalar>);
static_assert(!image_text_embedder<int>);

} // namespace

TEST_SUITE("evaluation/image_text_embedder") {
    TEST_CASE_TEMPLATE("[GR sec. 4] an embedder keeps the laws", Real, float, double) {
        static_assert(image_text_embedder<colour_embedder<Real>>);
        std::vector<std::string> const texts{"red", "white"};
        CHECK(check_embedder_laws(colour_embedder<Real>{}, {3, 5, 4}, texts).text() == "");
    }
}
