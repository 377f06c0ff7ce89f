// SPDX-License-Identifier: MIT
// Tests of CLIP's text encoder against transformers.
#include <genrender/reference/clip_text_encoder.hpp>

#include "golden_network.hpp"
#include "small_networks.hpp"

#include <genrender/reference/clip_text_config_file.hpp>
#include <genrender/reference/safetensors_weights.hpp>

#include <genrender/core/parallel.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/clip_text_encoder") {
    using text_tensors = std::map<std::string, std::vector<float>>;

    /// An encoder of transformers: what it is, its tensors and their shapes by name.
    struct text_model {
        clip_text_config config;
        text_tensors values;
        std::map<std::string, safetensors_source> sources;
    };

    /// The encoder of a golden case, its names beginning with `prefix`.
    text_model model_of(nlohmann::json const& golden, std::string const& prefix) {
        temporary_file const file("config.json");
        std::ofstream(file.path()) << golden.at("config");
        text_model model{read_clip_text_config(config_file(file.path())), {}, {}};
        auto shapes = weights<float>::seeded(1, "");
        clip_text_encoder<float> const network(model.config, shapes);
        std::map<std::string, std::vector<std::size_t>> bare;
        for (auto const& [name, shape] : shapes.taken()) {
            bare[name.substr(std::string("text_model.").size())] = shape;
        }
        model.values = golden_tensors(bare, golden.at("name").get<std::string>() + ".");
        for (auto const& [name, shape] : bare) {
            model.sources[prefix + name] = {shape, model.values.at(name)};
        }
        return model;
    }

    /// Built from a file of these tensors.
    template <class Real>
    clip_text_encoder<Real> built(text_model const& model, std::string const& path) {
        write_safetensors(path, model.sources);
        auto source = read_weights<Real>(path);
        return {model.config, source};
    }

    template <class Real>
    std::vector<Real> numbers_of(stack<Real, 2> const& rows) {
        return {rows.data(), rows.data() + rows.size()};
    }

    TEST_CASE_TEMPLATE("hidden states equal those of transformers", Real, float, double) {
        auto const bound = std::is_same_v<Real, float> ? 1e-5 : 1e-12;
        auto const file = golden_file("clip_text.json");
        for (auto const& golden : file.at("cases")) {
            auto const ids = golden.at("ids").get<std::vector<std::uint32_t>>();
            for (auto const* prefix : {"text_model.", ""}) {
                temporary_file const weights_file("text.safetensors");
                auto const encoder = built<Real>(model_of(golden, prefix), weights_file.path());
                auto const last =
                    difference_share(numbers_of<Real>(encoder(ids)), read_golden_output(golden.at("last")));
                auto const before = difference_share(numbers_of<Real>(encoder(ids, {}, 1)),
                                                     read_golden_output(golden.at("before_last")));
                CHECK(last <= bound);
                CHECK(before <= bound);
                MESSAGE(golden.at("name").get<std::string>(), ": ", last, " of the range, without the last layer ",
                        before);
            }
        }
    }

    TEST_CASE_TEMPLATE("a row does not depend on the tokens after it, nor on threads", Real, float, double) {
        auto const golden = golden_file("clip_text.json").at("cases").at(0);
        temporary_file const file("text.safetensors");
        auto const encoder = built<Real>(model_of(golden, ""), file.path());
        auto const ids = golden.at("ids").get<std::vector<std::uint32_t>>();
        auto const all = encoder(ids);
        CHECK(numbers_of(all) == numbers_of(encoder(ids, threaded_loop(3))));
        auto changed = ids;
        changed[40] = (changed[40] + 1) % 120;
        auto const other = encoder(changed);
        auto const row = [&](stack<Real, 2> const& rows, std::size_t t) {
            auto const values = rows.view()[t].row();
            return std::vector<Real>(values.begin(), values.end());
        };
        for (std::size_t t = 0; t < ids.size(); ++t) {
            CHECK((row(all, t) == row(other, t)) == (t < 40));
        }
        // Of a shorter text too: products take other tiles, sums are the same.
        auto const shorter = encoder(std::span(ids).first(40));
        for (std::size_t t = 0; t < 40; ++t) {
            CHECK(row(all, t) == row(shorter, t));
        }
    }

    TEST_CASE("position_ids of old files may be left over and no other tensor") {
        auto const golden = golden_file("clip_text.json").at("cases").at(1);
        temporary_file const file("text.safetensors");
        std::vector<float> const one{1.0f};
        auto const build = [&](std::function<void(std::map<std::string, safetensors_source>&)> const& change) {
            auto model = model_of(golden, "text_model.");
            change(model.sources);
            built<float>(model, file.path());
        };
        auto const text = [&](std::string const& sentence) { return file.path() + ": " + sentence; };
        CHECK_NOTHROW(build([&](auto& tensors) { tensors["text_model.embeddings.position_ids"] = {{1, 1}, one}; }));
        CHECK_THROWS_WITH_AS(
            build([&](auto& tensors) {
                tensors["text_projection.weight"] = {{1, 1}, one};
            }),
            text("1 tensors have no place in the network: text_projection.weight, expected none").c_str(), file_error);
        std::string const fc1 = "text_model.encoder.layers.1.mlp.fc1.weight";
        CHECK_THROWS_WITH_AS(build([&](auto& tensors) { tensors.erase(fc1); }),
                             text("there is no tensor " + fc1 + ", expected one of shape [36, 20]").c_str(),
                             file_error);
        CHECK_THROWS_WITH_AS(build([&](auto& tensors) {
                                 tensors[fc1].shape = {20, 36};
                             }),
                             text("tensor " + fc1 + " is [20, 36], expected [36, 20]").c_str(), file_error);
    }

    TEST_CASE("what cannot be encoded is told") {
        auto const golden = golden_file("clip_text.json").at("cases").at(1);
        temporary_file const file("text.safetensors");
        auto const encoder = built<float>(model_of(golden, ""), file.path());
        CHECK(encoder.most_tokens() == 16);
        CHECK(encoder.channels() == 20);
        CHECK(encoder.config().vocab_size == 50);
        CHECK_THROWS_WITH_AS(encoder({}), "clip_text_encoder: tokens of ids is 0, expected from 1 to 16", value_error);
        CHECK_THROWS_WITH_AS(encoder(std::vector<std::uint32_t>(17, 1)),
                             "clip_text_encoder: tokens of ids is 17, expected from 1 to 16", value_error);
        CHECK_THROWS_WITH_AS(encoder(std::vector<std::uint32_t>{3, 50}),
                             "clip_text_encoder: ids is 50, expected below 50", value_error);
        CHECK_THROWS_WITH_AS(encoder(std::vector<std::uint32_t>{3}, {}, 2),
                             "clip_text_encoder: skipped is 2, expected below the 2 layers", value_error);
        auto config = encoder.config();
        config.num_attention_heads = 3;
        auto source = weights<float>::seeded(1, "text");
        CHECK_THROWS_WITH_AS(clip_text_encoder<float>(config, source),
                             "clip_text_config: num_attention_heads is 3, expected a divisor of hidden_size",
                             value_error);
    }
}
