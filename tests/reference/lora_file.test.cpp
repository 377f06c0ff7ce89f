// SPDX-License-Identifier: MIT
// Tests of reading LoRA files.
#include <genrender/reference/lora_file.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <map>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using testing::temporary_file;

TEST_SUITE("reference/lora_file") {
    namespace {

    using shapes = std::map<std::string, std::vector<std::size_t>>;

    /// Writes tensors whose elements are all 1.5.
    void write(std::string const& path, shapes const& tensors) {
        std::vector<float> const values(64, 1.5f);
        std::map<std::string, safetensors_source> sources;
        for (auto const& [name, shape] : tensors) {
            std::size_t count = 1;
            for (auto const extent : shape) {
                count *= extent;
            }
            sources[name] = {shape, std::span(values).first(count)};
        }
        write_safetensors(path, sources);
    }

    std::string refusal(shapes const& tensors) {
        temporary_file const path("lora.safetensors");
        write(path.path(), tensors);
        try {
            lora_file const file(path.path());
        } catch (file_error const& error) {
            return std::string(error.what()).substr(path.path().size() + 2);
        }
        return "none";
    }

    /// A file as PEFT writes it, with options beside the tensors.
    std::string with_options(std::string const& options) {
        auto const header =
            nlohmann::json{
                {"__metadata__", {{"lora_adapter_metadata", options}}},
                {"unet.a.to_q.lora_A.weight", {{"dtype", "F32"}, {"shape", {2, 1}}, {"data_offsets", {0, 8}}}},
                {"unet.a.to_q.lora_B.weight", {{"dtype", "F32"}, {"shape", {1, 2}}, {"data_offsets", {8, 16}}}}}
                .dump();
        auto const bytes = std::uint64_t{header.size()};
        return std::string(reinterpret_cast<char const*>(&bytes), 8) + header + std::string(16, '\0');
    }

    } // namespace

    TEST_CASE("modules are found in the names of kohya, PEFT and older versions of diffusers") {
        struct form {
            char const* down;
            char const* up;
            model_part part;
            char const* name;
        };
        constexpr auto unet = model_part::unet;
        constexpr auto text = model_part::text_encoder;
        for (auto const& expected :
             {form{"lora_unet_a_to_q.lora_down.weight", "lora_unet_a_to_q.lora_up.weight", unet, "a_to_q"},
              form{"lora_te_text_model_q.lora_down.weight", "lora_te_text_model_q.lora_up.weight", text,
                   "text_model_q"},
              form{"unet.a.to_q.lora_A.weight", "unet.a.to_q.lora_B.weight", unet, "a.to_q"},
              form{"unet.a.to_q.lora_A.default.weight", "unet.a.to_q.lora_B.default.weight", unet, "a.to_q"},
              form{"base_model.model.a.to_q.lora_A.weight", "base_model.model.a.to_q.lora_B.weight", unet, "a.to_q"},
              form{"a.to_q.lora_A.weight", "a.to_q.lora_B.weight", unet, "a.to_q"},
              form{"unet.a.to_q.lora.down.weight", "unet.a.to_q.lora.up.weight", unet, "a.to_q"},
              form{"unet.a.processor.to_q_lora.down.weight", "unet.a.processor.to_q_lora.up.weight", unet, "a.to_q"},
              form{"unet.a.processor.to_out_lora.down.weight", "unet.a.processor.to_out_lora.up.weight", unet,
                   "a.to_out.0"},
              form{"text_encoder.text_model.q.lora_linear_layer.down.weight",
                   "text_encoder.text_model.q.lora_linear_layer.up.weight", text, "text_model.q"}}) {
            std::string const down = expected.down;
            CAPTURE(down);
            temporary_file const path("lora.safetensors");
            write(path.path(), {{down, {4, 3}}, {expected.up, {5, 4}}});
            lora_file const file(path.path());
            REQUIRE(file.modules().size() == 1);
            auto const& module = file.modules().front();
            CHECK(module.part == expected.part);
            CHECK(module.name == expected.name);
            CHECK(module.is_underscored == (down.starts_with("lora_unet_") || down.starts_with("lora_te_")));
            CHECK(module.difference.down.shape == std::vector<std::size_t>{4, 3});
            CHECK(module.difference.up.shape == std::vector<std::size_t>{5, 4});
            CHECK(module.difference.factor == 1);
        }
    }

    TEST_CASE("alpha is divided by the rank") {
        for (auto const& shape : {std::vector<std::size_t>{}, std::vector<std::size_t>{1}}) {
            temporary_file const path("lora.safetensors");
            write(path.path(), {{"lora_unet_a.lora_down.weight", {4, 3}},
                                {"lora_unet_a.lora_up.weight", {5, 4}},
                                {"lora_unet_a.alpha", shape}});
            CHECK(lora_file(path.path()).modules().front().difference.factor == 1.5 / 4);
        }
    }

    TEST_CASE("PEFT's alpha stands beside the tensors and a module's own wins") {
        temporary_file const path("lora.safetensors");
        auto const factor = [&](std::string const& options) {
            std::ofstream(path.path(), std::ios::binary) << with_options(options);
            return lora_file(path.path()).modules().front().difference.factor;
        };
        CHECK(factor("{}") == 1);
        CHECK(factor(R"({"unet.lora_alpha": 8, "unet.r": 2})") == 4);
        CHECK(factor(R"({"text_encoder.lora_alpha": 8})") == 1);
        CHECK(factor(R"({"unet.lora_alpha": 8, "unet.alpha_pattern": {"to_q": 6}})") == 3);
        CHECK(factor(R"({"unet.lora_alpha": 8, "unet.alpha_pattern": {"o_q": 6}})") == 4);
        CHECK_THROWS_WITH_AS(factor(R"({"unet.use_dora": true})"),
                             (path.path() + ": lora_adapter_metadata has unet.use_dora, expected false").c_str(),
                             file_error);
        CHECK_THROWS_AS(factor(R"({"unet.use_rslora": true})"), file_error);
        CHECK_THROWS_AS(factor("[]"), file_error);
        CHECK_THROWS_AS(factor("{"), file_error);
    }

    TEST_CASE("other kinds of difference are refused by name") {
        shapes const whole{{"lora_unet_a.lora_down.weight", {4, 3}}, {"lora_unet_a.lora_up.weight", {5, 4}}};
        auto const says = [&](char const* name, char const* kind) {
            auto tensors = whole;
            tensors[name] = {1};
            CHECK(refusal(tensors) == "file holds " + std::string(kind) + " (" + name +
                                          "), expected low-rank differences of Stable Diffusion 1.x or 2.x alone");
        };
        says("lora_unet_a.dora_scale", "DoRA");
        says("unet.a.lora_magnitude_vector", "DoRA");
        says("lora_unet_a.hada_w1_a", "LoHa");
        says("lora_unet_a.lokr_w1", "LoKr");
        says("lora_unet_a.lora_mid.weight", "LoCon in its Tucker form");
        says("lora_unet_a.diff_b", "differences of full rank");
        says("lora_te2_text_model_a.alpha", "a LoRA of Stable Diffusion XL, which has two text encoders,");
    }

    TEST_CASE("half a difference, unknown tensors and factors that do not fit are named") {
        CHECK(refusal({{"lora_unet_a.lora_down.weight", {4, 3}}, {"lora_unet_b.alpha", {}}}) ==
              "2 modules have half a difference: lora_unet_a, lora_unet_b, expected both factors of each");
        CHECK(refusal({{"lora_unet_a.lora_down.weight", {4, 3}}, {"x", {1}}, {"y", {1}}}) ==
              "2 tensors are unknown: x, y, expected lora_down, lora_up and alpha, or lora_A and lora_B, of modules");
        CHECK(refusal({}) == "file holds no difference, expected some");
        for (auto const& up : {std::vector<std::size_t>{5, 3}, {4}, {5, 4, 3, 1}}) {
            CHECK(refusal({{"unet.a.lora_A.weight", {4, 3}}, {"unet.a.lora_B.weight", up}}) ==
                  "factors of unet.a are [4, 3] and " + extents_text(up) +
                      ", expected [rank, in, ...] and [out, rank]");
        }
        CHECK(refusal({{"unet.a.lora_A.weight", {0, 3}}, {"unet.a.lora_B.weight", {5, 0}}}).find("[0, 3]") !=
              std::string::npos);
        CHECK(refusal({{"unet.a.lora_A.weight", {4, 3}}, {"unet.a.lora_B.weight", {5, 4}}, {"unet.a.alpha", {2}}}) ==
              "tensor unet.a.alpha is [2], expected one number");
        CHECK(refusal({{"a.lora_A.weight", {4, 3}}, {"a.lora_down.weight", {4, 3}}, {"a.lora_B.weight", {5, 4}}}) ==
              "tensors a.lora_A.weight and a.lora_down.weight are the same factor, expected one");
    }

    TEST_CASE("a pickle is refused") { CHECK_THROWS_AS(lora_file("some/lora.pt"), file_error); }
}
