// SPDX-License-Identifier: MIT
// Tests of finding the files of a network's weights.
#include <genrender/reference/weight_files.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using testing::temporary_file;

TEST_SUITE("reference/weight_files") {
    namespace {

    /// A folder of weights.
    struct weight_folder {
        temporary_file file{"weights"};
        std::filesystem::path path = file.path();

        weight_folder() { std::filesystem::create_directories(path); }

        void write(std::string const& name, std::string const& text) const { std::ofstream(path / name) << text; }
        /// A file with some tensors, all of one element.
        void write_tensors(std::string const& name, std::vector<std::string> const& tensors, float value = 1) const {
            std::vector<float> const one{value};
            std::map<std::string, safetensors_source> sources;
            for (auto const& tensor : tensors) {
                sources[tensor] = {{1}, one};
            }
            write_safetensors((path / name).string(), sources);
        }
        float value_of(std::string const& variant = {}) const {
            return find_weights(path, "model", variant).at("a").read<float>().at(0);
        }
        std::string refusal(std::string const& variant = {}) const {
            try {
                find_weights(path, "model", variant);
            } catch (file_error const& error) {
                return error.what();
            }
            return "none";
        }
    };

    } // namespace

    TEST_CASE("weights are found whole or in shards and in full precision before half") {
        weight_folder const folder;
        CHECK(folder.refusal() == folder.path.string() + ": there is no model.safetensors, expected one, or its .fp16 "
                                                         "or .bf16, or an index of its shards");
        folder.write_tensors("s1", {"a"}, 1);
        folder.write("model.safetensors.index.fp16.json", R"({"weight_map": {"a": "s1"}})");
        CHECK(folder.value_of() == 1);
        folder.write_tensors("model.fp16.safetensors", {"a"}, 2);
        CHECK(folder.value_of() == 2);
        folder.write_tensors("s3", {"a"}, 3);
        folder.write("model.safetensors.index.json", R"({"metadata": {"total_size": 9}, "weight_map": {"a": "s3"}})");
        CHECK(folder.value_of() == 3);
        folder.write_tensors("model.safetensors", {"a"}, 4);
        CHECK(folder.value_of() == 4);
        CHECK(folder.value_of("fp16") == 2);
        CHECK(folder.refusal("non_ema") == folder.path.string() + ": there is no model.non_ema.safetensors, expected "
                                                                  "one, or an index of its shards");
        folder.write_tensors("model.non_ema.safetensors", {"a"}, 5);
        CHECK(folder.value_of("non_ema") == 5);
        CHECK(folder.value_of() == 4);
    }

    TEST_CASE("bfloat16 is found where there is nothing else") {
        weight_folder const folder;
        folder.write_tensors("model.bf16.safetensors", {"a"}, 7);
        CHECK(folder.value_of() == 7);
    }

    TEST_CASE("the index of a variant's shards is found wherever its name stands") {
        for (auto const* index : {"model.safetensors.index.fp16.json", "model.fp16.safetensors.index.json"}) {
            CAPTURE(index);
            weight_folder const folder;
            folder.write_tensors("x-1.safetensors", {"a", "b"});
            folder.write_tensors("x-2.safetensors", {"c"});
            folder.write(index, R"({"weight_map":
                {"a": "x-1.safetensors", "b": "x-1.safetensors", "c": "x-2.safetensors"}})");
            CHECK(find_weights(folder.path, "model", "fp16").size() == 3);
            CHECK(find_weights(folder.path, "model").size() == 3);
        }
    }

    TEST_CASE("an index that is none or points elsewhere is refused") {
        for (auto const* map :
             {"null", "{}", "[\"a\"]", R"({"a": 1})", R"({"a": "../b"})", R"({"a": "/etc/b"})", R"({"a": ".."})",
              R"({"a": ""})", R"({"a": "c:b"})", R"({"a": "d\\b"})", R"({"a": "b\u0000c"})"}) {
            weight_folder const folder;
            folder.write_tensors("b", {"a"});
            folder.write("model.safetensors.index.json", std::string(R"({"weight_map": )") + map + "}");
            CAPTURE(map);
            CHECK(
                folder.refusal().find("expected an object with the name of a file beside the index for each tensor") !=
                std::string::npos);
        }
    }

    TEST_CASE("a missing shard and tensors that a shard does not hold are named") {
        weight_folder const folder;
        folder.write("model.safetensors.index.json", R"({"weight_map": {"a": "s1", "b": "s2", "c": "s2", "d": "s2"}})");
        folder.write_tensors("s1", {"a"});
        auto const index = (folder.path / "model.safetensors.index.json").string();
        CHECK(folder.refusal() ==
              index + ": shard s2 of 3 tensors is not beside it, expected all files of its weight_map");
        folder.write_tensors("s2", {"b"});
        CHECK(folder.refusal() ==
              (folder.path / "s2").string() + ": 2 tensors are missing that the index has here: c, d, expected all 3");
        folder.write_tensors("s2", {"a", "b", "c", "d"});
        CHECK(folder.refusal() == (folder.path / "s2").string() + ": tensor a is in " + (folder.path / "s1").string() +
                                      " too, expected each tensor once");
    }

    TEST_CASE("a folder of pickles alone is refused with the reason and the command that converts them") {
        weight_folder const folder;
        folder.write("pytorch_model.bin", "PK\3\4");
        auto const refusal = folder.refusal();
        CHECK(refusal.starts_with((folder.path / "pytorch_model.bin").string() + ": file is a Python pickle"));
        CHECK(refusal.find("weights_only=True") != std::string::npos);
        CHECK(refusal.ends_with("'" + (folder.path / "pytorch_model.safetensors").string() + "'"));
        folder.write_tensors("model.safetensors", {"a"});
        CHECK(folder.value_of() == 1);
    }

    TEST_CASE("a shard that is a pickle is refused") {
        weight_folder const folder;
        folder.write("s1", "PK\3\4 and more");
        folder.write("model.safetensors.index.json", R"({"weight_map": {"a": "s1"}})");
        CHECK(folder.refusal().find("is a Python pickle") != std::string::npos);
    }
}
