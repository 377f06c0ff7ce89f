// SPDX-License-Identifier: MIT
// The encoder against PyTorch, its laws, and the folders it refuses.
#include <genrender/reference/reference_clip.hpp>

#include "../support/golden_file.hpp"
#include "golden_network.hpp"

#include <genrender/testing/embedder_laws.hpp>

#include <genrender/evaluation/image_text_embedder.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/reference_clip") {
    /// The encoder of the golden file, written as train_embedder.py writes it; removed with the object.
    class clip_folder {
    public:
        explicit clip_folder(safetensors_storage storage = safetensors_storage::f32) : folder_("clip") {
            std::filesystem::create_directories(path());
            write_config(golden_file("reference_clip.json").at("config"));
            for (auto const* name : {"vocab.json", "merges.txt"}) {
                std::filesystem::copy_file(std::filesystem::path(GENRENDER_TEST_DATA) / "clip_tokenizer" / name,
                                           path() / name);
            }
            auto text = weights<float>::seeded(1, "");
            auto image = weights<float>::seeded(1, "");
            clip_text_config const text_config{814, 8, 16, 2, 2};
            reference_clip<float> const clip({{4, 8, 8, 12}, {2, 2, 1, 1}, 2, 1e-5, 6, 5}, load_clip_tokenizer(path()),
                                             clip_text_encoder<float>(text_config, text), image);
            shapes_ = text.taken();
            shapes_.insert(image.taken().begin(), image.taken().end());
            values_ = golden_tensors(shapes_, "");
            write_tensors(storage);
        }

        std::filesystem::path path() const { return folder_.path(); }
        std::string file(char const* name) const { return (path() / name).string(); }
        void write_config(nlohmann::json const& config) const { std::ofstream(path() / "config.json") << config; }
        void write_tensors(safetensors_storage storage = safetensors_storage::f32,
                           std::function<void(std::map<std::string, safetensors_source>&)> const& change = {}) const {
            std::map<std::string, safetensors_source> sources;
            for (auto const& [name, shape] : shapes_) {
                sources[name] = {shape, values_.at(name)};
            }
            if (change) {
                change(sources);
            }
            write_safetensors(file("model.safetensors"), sources, storage);
        }
        std::string refusal() const {
            try {
                reference_clip<float>::from_folder(path());
                return "accepted";
            } catch (std::exception const& refused) {
                return refused.what();
            }
        }

    private:
        temporary_file folder_;
        std::map<std::string, std::vector<std::size_t>> shapes_;
        std::map<std::string, std::vector<float>> values_;
    };

    /// Noise around grey.
    template <class Real>
    stack<Real, 3> golden_image(std::string const& name, std::size_t height, std::size_t width) {
        auto image = golden_stack<Real, 3>(name, {3, height, width});
        std::for_each(image.data(), image.data() + image.size(), [](Real& x) { x = Real(0.5) + Real(0.5) * x; });
        return image;
    }

    /// The largest difference of a vector's elements from numbers of the golden file.
    template <class Real>
    double difference_from(nlohmann::json const& expected, std::vector<Real> const& vector) {
        REQUIRE(vector.size() == expected.size());
        double greatest = 0;
        for (std::size_t d = 0; d < expected.size(); ++d) {
            greatest = std::max(greatest, std::abs(static_cast<double>(vector[d]) - expected[d].get<double>()));
        }
        return greatest;
    }

    /// That of all vectors of the golden file.
    template <class Real>
    double greatest_difference(reference_clip<Real> const& clip) {
        auto const golden = golden_file("reference_clip.json");
        auto const& images = golden.at("image_vectors");
        auto greatest =
            std::max(difference_from(images.at(0), clip.embed_image(golden_image<Real>("image", 19, 26).view())),
                     difference_from(images.at(1), clip.embed_image(golden_image<Real>("small image", 1, 2).view())));
        for (auto const& text : golden.at("texts")) {
            auto const vector = clip.embed_text(text.at("text").template get<std::string>());
            greatest = std::max(greatest, difference_from(text.at("vector"), vector));
        }
        return greatest;
    }

    TEST_CASE_TEMPLATE("[GR sec. 4] vectors of images and of texts are PyTorch's", Real, float, double) {
        clip_folder const folder;
        auto const clip = reference_clip<Real>::from_folder(folder.path());
        auto const difference = greatest_difference(clip);
        CHECK(difference < (sizeof(Real) == 8 ? 1e-12 : 1e-5));
        MESSAGE(difference, " at most");
    }

    TEST_CASE("half precision in the file costs three digits") {
        clip_folder const folder(safetensors_storage::f16);
        auto const difference = greatest_difference(reference_clip<float>::from_folder(folder.path()));
        CHECK(difference < 3e-3);
        CHECK(difference > 1e-6);
    }

    TEST_CASE_TEMPLATE("[GR sec. 4] it is an embedder and keeps the laws", Real, float, double) {
        static_assert(image_text_embedder<reference_clip<Real>>);
        clip_folder const folder;
        auto const clip = reference_clip<Real>::from_folder(folder.path());
        CHECK(clip.dimension() == 5);
        std::vector<std::string> const texts{"", "a striped ball", "Anything at all: \xc3\xa9\xe2\x82\xac"};
        CHECK(check_embedder_laws(clip, {3, 16, 12}, texts).text() == "");
        CHECK(check_embedder_laws(clip, {3, 1, 1}, texts).text() == "");
    }

    TEST_CASE("vectors have length 1, images of any strides have the same, and so has a text however long") {
        clip_folder const folder;
        auto const clip = reference_clip<double>::from_folder(folder.path());
        auto const image = golden_image<double>("image", 18, 25);
        stack<double, 3> last({18, 25, 3});
        strided_view<double, 3> const view(last.data(), {3, 18, 25}, {1, 75, 3});
        copy(view, image);
        auto const vector = clip.embed_image(image.view());
        CHECK(clip.embed_image(view) == vector);
        auto const length = [](std::vector<double> const& of) {
            double squares = 0;
            for (auto const x : of) {
                squares += x * x;
            }
            return std::sqrt(squares);
        };
        CHECK(length(vector) == doctest::Approx(1));
        std::string text = "striped";
        for (std::size_t i = 0; i < 100; ++i) {
            text += " and striped";
        }
        CHECK(length(clip.embed_text(text)) == doctest::Approx(1));
        CHECK(clip.embed_text(text) == clip.embed_text(text + " and red"));
        CHECK(clip.embed_text("striped") != clip.embed_text("dotted"));
        CHECK_THROWS_AS(clip.embed_text("\xff"), value_error);
    }

    TEST_CASE("a text ends where the first end token stands, as for transformers") {
        clip_folder const folder;
        auto const clip = reference_clip<double>::from_folder(folder.path());
        CHECK(clip.embed_text("striped<|endoftext|>ball") == clip.embed_text("striped"));
    }

    TEST_CASE("features of an image are those of the tower for each place") {
        clip_folder const folder;
        auto const clip = reference_clip<float>::from_folder(folder.path());
        // Strides 2, 2, 1, 1.
        auto const features = clip.image_features(golden_image<float>("image", 19, 26).view());
        CHECK(features.extents() == std::array<std::size_t, 3>{12, 5, 7});
        CHECK_THROWS_AS(clip.image_features(stack<float, 3>({1, 8, 8}).view()), shape_error);
    }

    TEST_CASE("images without three channels or without pixels are refused") {
        clip_folder const folder;
        auto const clip = reference_clip<float>::from_folder(folder.path());
        CHECK_THROWS_WITH_AS(clip.embed_image(stack<float, 3>({1, 8, 8}).view()),
                             "image_tower: image is [1, 8, 8], expected [3, 8, 8]", shape_error);
        CHECK_THROWS_WITH_AS(clip.embed_image(stack<float, 3>({3, 8, 0}).view()),
                             "image_tower: image is [3, 8, 0], expected [3, 8, 1]", shape_error);
    }

    TEST_CASE("a config of something else is refused with a sentence") {
        clip_folder const folder;
        auto const golden = golden_file("reference_clip.json").at("config");
        auto const refusal = [&](std::function<void(nlohmann::json&)> const& change) {
            auto config = golden;
            change(config);
            folder.write_config(config);
            return folder.refusal();
        };
        auto const config = folder.file("config.json");
        CHECK(refusal([](auto&) {}) == "accepted");
        CHECK(refusal([](auto& options) { options["_class_name"] = "CLIPModel"; }) ==
              config + ": option _class_name is \"CLIPModel\", expected \"ReferenceClip\"");
        CHECK(refusal([](auto& options) { options.erase("text_config"); }) ==
              config + ": option text_config is absent, expected an object of options");
        CHECK(refusal([](auto& options) { options["text_config"]["hidden_size"] = "8"; }) ==
              config + ", text_config: option hidden_size is \"8\", expected a whole number from 1 to 1000000");
        CHECK(refusal([](auto& options) {
                  options["strides"] = {2, 2};
              }) == config + ": option strides is [2,2], expected as many numbers as block_out_channels has");
        CHECK(refusal([](auto& options) { options["norm_num_groups"] = 3; }) ==
              config + ": option block_out_channels is [4,8,8,12], expected multiples of the 3 of norm_num_groups");
        CHECK(refusal([](auto& options) { options["norm_eps"] = 0; }) ==
              config + ": option norm_eps is 0, expected a number in (0, 1)");
        CHECK(refusal([](auto& options) { options["colours"] = 3; }) ==
              config + ": 1 options are unknown: colours, expected none");
        CHECK(refusal([](auto& options) { options["projection_dim"] = 7; }) ==
              folder.file("model.safetensors") + ": tensor image.projection.weight is [5, 6], expected [7, 6]");
        CHECK(refusal([](auto& options) {
                  options["text_config"]["num_hidden_layers"] = 1;
              }).find("tensors have no place in the network: text_model.encoder.layers.1.") != std::string::npos);
    }

    TEST_CASE("tensors and tokenizers of something else are refused with a sentence") {
        clip_folder const folder;
        auto const model = folder.file("model.safetensors");
        auto const storage = safetensors_storage::f32;
        folder.write_tensors(storage, [](auto& tensors) { tensors.erase("image.gate.bias"); });
        CHECK(folder.refusal() == model + ": there is no tensor image.gate.bias, expected one of shape [1]");
        folder.write_tensors(storage, [](auto& tensors) { tensors["logit_scale"] = tensors.at("image.gate.bias"); });
        CHECK(folder.refusal() == model + ": 1 tensors have no place in the network: logit_scale, expected none");
        folder.write_tensors();
        CHECK(folder.refusal() == "accepted");
        std::ofstream(folder.path() / "tokenizer_config.json") << R"({"model_max_length": 78})";
        CHECK(folder.refusal() == "reference_clip: context length of the tokenizer is 78, expected at most the 77 of "
                                  "max_position_embeddings");
        std::ofstream(folder.path() / "tokenizer_config.json") << R"({"additional_special_tokens": ["<new>"]})";
        CHECK(folder.refusal() ==
              "reference_clip: tokens of the tokenizer is 815, expected at most the 814 of vocab_size");
        std::filesystem::remove(folder.path() / "vocab.json");
        CHECK(folder.refusal() == folder.file("vocab.json") +
                                      ": there is no such file, expected vocab.json and merges.txt, or tokenizer.json");
    }
}
