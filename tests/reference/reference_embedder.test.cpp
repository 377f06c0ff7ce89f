// SPDX-License-Identifier: MIT
// The encoder against PyTorch, its laws, and the files it refuses.
#include <genrender/reference/reference_embedder.hpp>

#include "../support/golden_file.hpp"
#include "golden_network.hpp"

#include <genrender/testing/embedder_laws.hpp>

#include <genrender/evaluation/image_text_embedder.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <unistd.h>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

namespace {

std::vector<std::string> const three_words{"stripes", "dots", "red"};

/// A folder of an encoder for three words, removed with the object.
class embedder_folder {
public:
    explicit embedder_folder(std::string const& name, safetensors_storage storage = safetensors_storage::f32)
        : folder_(std::filesystem::temp_directory_path() /
                  (std::to_string(::getpid()) + "-genrender-embedder-" + name)) {
        std::filesystem::create_directories(folder_);
        write_config(R"({"_class_name": "PromptEmbedder", "words": ["stripes", "dots", "red"], "dimension": 64})");
        auto source = weights<float>::seeded(1, "embedder");
        reference_embedder<float> const embedder(source, three_words);
        std::map<std::string, std::vector<float>> values;
        std::map<std::string, safetensors_source> sources;
        for (auto const& [tensor, shape] : source.taken()) {
            std::size_t count = 1;
            for (auto const extent : shape) {
                count *= extent;
            }
            auto& x = values[tensor] = golden_values(tensor, count);
            auto const fan_in = static_cast<double>(count / shape[0]);
            auto const scale = static_cast<float>(std::exp2(std::floor(std::log2(std::sqrt(3 / fan_in)))));
            for (auto& value : x) {
                value = shape.size() > 1 ? scale * value : 0.25F * value + (tensor.ends_with("weight") ? 1.0F : 0.0F);
            }
            sources[tensor] = {shape, x};
        }
        write_safetensors((folder_ / "model.safetensors").string(), sources, storage);
    }
    embedder_folder(embedder_folder const&) = delete;
    embedder_folder& operator=(embedder_folder const&) = delete;
    ~embedder_folder() {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }

    std::filesystem::path const& path() const { return folder_; }
    void write_config(std::string const& text) const { std::ofstream(folder_ / "config.json") << text; }

private:
    std::filesystem::path folder_;
};

/// Noise around grey [3, 18, 25].
template <class Real>
stack<Real, 3> golden_image() {
    auto image = golden_stack<Real, 3>("image", {3, 18, 25});
    std::for_each(image.data(), image.data() + image.size(), [](Real& x) { x = Real(0.5) + Real(0.5) * x; });
    return image;
}

/// What PyTorch computes in double precision, see make_embedder_golden.py: `image_vector` of golden_image, `text_vector`
/// of the third and the first of three words.
std::array<double, 64> golden_vector(char const* name) {
    return golden_file("prompt_embedder.json").at(name).get<std::array<double, 64>>();
}

template <class Real>
double greatest_difference(std::vector<Real> const& vector, std::array<double, 64> const& expected) {
    REQUIRE(vector.size() == expected.size());
    double greatest = 0;
    for (std::size_t d = 0; d < expected.size(); ++d) {
        greatest = std::max(greatest, std::abs(static_cast<double>(vector[d]) - expected[d]));
    }
    return greatest;
}

} // namespace

TEST_SUITE("reference/reference_embedder") {
    TEST_CASE_TEMPLATE("[GR sec. 4] its vectors are PyTorch's", Real, float, double) {
        embedder_folder const folder("golden");
        auto const embedder = reference_embedder<Real>::from_folder(folder.path());
        CHECK(embedder.words() == three_words);
        auto const bound = sizeof(Real) == 8 ? 1e-12 : 2e-6;
        CHECK(greatest_difference(embedder.embed_image(golden_image<Real>().view()), golden_vector("image_vector")) <
              bound);
        CHECK(greatest_difference(embedder.embed_text("red, STRIPES"), golden_vector("text_vector")) < bound);
    }

    TEST_CASE("half precision in the file costs three digits") {
        embedder_folder const folder("half", safetensors_storage::f16);
        auto const embedder = reference_embedder<float>::from_folder(folder.path());
        auto const difference =
            greatest_difference(embedder.embed_image(golden_image<float>().view()), golden_vector("image_vector"));
        CHECK(difference < 1e-3);
        CHECK(difference > 1e-6);
        CHECK(greatest_difference(embedder.embed_text("red stripes"), golden_vector("text_vector")) < 1e-3);
    }

    TEST_CASE_TEMPLATE("[GR sec. 4] it is an embedder and keeps the laws", Real, float, double) {
        static_assert(image_text_embedder<reference_embedder<Real>>);
        auto source = weights<Real>::seeded(3, "embedder");
        reference_embedder<Real> const embedder(source, three_words, 16);
        CHECK(embedder.dimension() == 16);
        std::vector<std::string> const texts{"", "dots", "Dots; red"};
        CHECK(check_embedder_laws(embedder, {3, 16, 12}, texts).text() == "");
        CHECK(check_embedder_laws(embedder, {3, 1, 1}, texts).text() == "");
    }

    TEST_CASE("vectors have length 1 and images of any strides have the same") {
        auto source = weights<double>::seeded(3, "embedder");
        reference_embedder<double> const embedder(source, three_words);
        auto const image = golden_image<double>();
        stack<double, 3> last({18, 25, 3});
        strided_view<double, 3> const view(last.data(), {3, 18, 25}, {1, 75, 3});
        copy(view, image);
        auto const vector = embedder.embed_image(image.view());
        CHECK(embedder.embed_image(view) == vector);
        double squares = 0;
        for (auto const x : vector) {
            squares += x * x;
        }
        CHECK(squares == doctest::Approx(1));
    }

    TEST_CASE("a word of another training is refused by name") {
        auto source = weights<float>::seeded(3, "embedder");
        reference_embedder<float> const embedder(source, three_words);
        CHECK_THROWS_WITH_AS(embedder.embed_text("marble stripes"),
                             "prompt_vocabulary: word is marble, expected one of stripes dots red", value_error);
    }

    TEST_CASE("images without three channels or without pixels are refused") {
        auto source = weights<float>::seeded(3, "embedder");
        reference_embedder<float> const embedder(source, three_words);
        CHECK_THROWS_WITH_AS(embedder.embed_image(stack<float, 3>({1, 8, 8}).view()),
                             "embed_image: image is [1, 8, 8], expected [3, 8, 8]", shape_error);
        CHECK_THROWS_WITH_AS(embedder.embed_image(stack<float, 3>({3, 0, 8}).view()),
                             "embed_image: image is [3, 0, 8], expected [3, 1, 8]", shape_error);
    }

    TEST_CASE("folders of something else are refused with a sentence") {
        embedder_folder const folder("refused");
        auto const config = (folder.path() / "config.json").string();
        auto const model = (folder.path() / "model.safetensors").string();
        auto const refusal = [&](std::string const& text) {
            folder.write_config(text);
            try {
                auto const embedder = reference_embedder<float>::from_folder(folder.path());
                return std::string("accepted ") + std::to_string(embedder.words().size());
            } catch (file_error const& error) {
                return std::string(error.what());
            }
        };
        CHECK(refusal(R"({"_class_name": "PromptEmbedder", "words": ["a", "b", "c"]})") == "accepted 3");
        CHECK(refusal(R"({"_class_name": "CLIPModel", "words": ["a"]})") ==
              config + ": option _class_name is \"CLIPModel\", expected \"PromptEmbedder\"");
        CHECK(refusal(R"({"_class_name": "PromptEmbedder"})") ==
              config + ": option words is absent, expected at least one");
        CHECK(refusal(R"({"_class_name": "PromptEmbedder", "words": ["a", "a"]})") ==
              config + ": option words is [\"a\",\"a\"], expected words of lower-case letters and digits, each once");
        CHECK(refusal(R"({"_class_name": "PromptEmbedder", "words": ["a"]})") ==
              model + ": tensor text.embedding.weight is [4, 64], expected [2, 64]");
        CHECK(refusal(R"({"_class_name": "PromptEmbedder", "words": ["a", "b", "c"], "colours": 3})") ==
              config + ": 1 options are unknown: colours, expected none");
    }
}
