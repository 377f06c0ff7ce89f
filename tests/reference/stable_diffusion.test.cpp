// SPDX-License-Identifier: MIT
// A whole pipeline: words and depth in, the pictures of diffusers out.
#include <genrender/reference/stable_diffusion.hpp>

#include "../support/golden_file.hpp"
#include "../support/scratch_folder.hpp"

#include <genrender/attention/plain_attention.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/sampling/karras_schedule.hpp>
#include <genrender/sampling/sampler.hpp>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

using namespace genrender;
using namespace genrender::reference;

namespace {

std::filesystem::path const tiny_pipeline = std::filesystem::path(GENRENDER_TEST_DATA) / "tiny_pipeline";

template <std::size_t Rank>
stack<float, Rank> stack_of(nlohmann::json const& values, nlohmann::json const& shape, float scale) {
    std::array<std::size_t, Rank> extents{};
    std::copy(shape.begin(), shape.end(), extents.begin());
    stack<float, Rank> result(extents);
    std::transform(values.begin(), values.end(), result.data(),
                   [&](nlohmann::json const& value) { return value.get<float>() * scale; });
    return result;
}

/// The pictures of the golden file's run, as bytes: all frames by themselves.
std::vector<int> rendered(nlohmann::json const& golden, sampler_kind sampler, stable_diffusion<float> const& pipeline,
                          std::string const& prompt) {
    auto const depth = stack_of<3>(golden["depth"], golden["depth_shape"], 1.0F / 255);
    diffusion_prompt const told{.text = prompt, .negative = golden["negative"], .guidance_scale = golden["guidance"]};
    auto const phi = pipeline.network(pipeline.conditioning(depth.view(), told));
    auto const levels = pipeline.schedule();
    auto const sigmas =
        karras_schedule<float>(golden["steps"].get<std::size_t>(), static_cast<float>(levels.sigma_min()),
                               static_cast<float>(levels.sigma_max()));
    auto const noise = stack_of<4>(golden["latents"], golden["latents_shape"], sigmas.front());
    auto const shape = noise.extents();
    auto z = latents<float>::from_shape({shape[0], shape[1], shape[2], shape[3]});
    copy(to_view(z), noise.view());
    std::vector<frame_index> const frames{{0}, {1}};
    plain_attention const plain;
    auto const D = [&](latents<float> const& noisy, float sigma) {
        auto x0 = latents<float>::from_shape(noisy.shape());
        phi(to_view(x0), to_view(noisy), sigma, frames, plain);
        return x0;
    };
    auto const clean = sample(sampler, D, z, sigmas);
    auto const pictures = pipeline.pictures(to_view(clean));
    std::vector<int> bytes(pictures.size());
    std::transform(pictures.data(), pictures.data() + pictures.size(), bytes.begin(),
                   [](float value) { return static_cast<int>(std::lround(value * 255)); });
    return bytes;
}

/// Greatest and mean difference of pictures.
std::pair<int, double> differences(std::vector<int> const& a, nlohmann::json const& b) {
    REQUIRE(a.size() == b.size());
    int greatest = 0;
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        auto const apart = std::abs(a[i] - b[i].get<int>());
        greatest = std::max(greatest, apart);
        sum += apart;
    }
    return {greatest, sum / static_cast<double>(a.size())};
}

} // namespace

TEST_SUITE("reference/stable_diffusion") {
    TEST_CASE("frames by themselves are the pictures of diffusers, by Euler and DPM++ 2M with Karras' levels") {
        auto const golden = testing::golden_file("pipeline.json");
        stable_diffusion<float> const pipeline{pipeline_files(tiny_pipeline)};
        std::pair<std::string, sampler_kind> const runs[]{{"euler", sampler_kind::euler},
                                                          {"dpmpp_2m", sampler_kind::dpmpp_2m}};
        for (auto const& one : runs) {
            auto const& name = one.first;
            auto const sampler = one.second;
            CAPTURE(name);
            auto const pictures = rendered(golden, sampler, pipeline, golden["prompt"]);
            auto const [greatest, mean] = differences(pictures, golden["pictures"][name]);
            MESSAGE(name << ": greatest " << greatest << " of 255, mean " << mean);
            CHECK(greatest <= 3);
            CHECK(mean <= 1);
            // Another prompt is another picture, so that the bounds above say something.
            auto const other = rendered(golden, sampler, pipeline, "a blue wall");
            CHECK(differences(other, golden["pictures"][name]).first > 20);
        }
    }

    TEST_CASE("it says what its pictures are and what of a prompt has no room") {
        stable_diffusion<float> const pipeline{pipeline_files(tiny_pipeline)};
        CHECK(pipeline.scale() == 4);
        CHECK(pipeline.usual_size() == 32);
        CHECK(pipeline.tokens("a ball").cut == 0);
        std::string text;
        for (int i = 0; i < 100; ++i) {
            text += "ball ";
        }
        CHECK(pipeline.tokens(text).cut > 0);
        CHECK(pipeline.schedule().sigma_max() == doctest::Approx(14.6146));
    }

    TEST_CASE("parts that are missing or do not fit are told before anything large is read") {
        tests::scratch_folder const scratch;
        auto const folder = scratch / "pipeline";
        auto const fresh = [&] {
            std::filesystem::remove_all(folder);
            std::filesystem::copy(tiny_pipeline, folder, std::filesystem::copy_options::recursive);
        };
        auto const refusal = [&] {
            try {
                stable_diffusion<float> const pipeline{pipeline_files(folder)};
            } catch (std::exception const& error) {
                return std::string(error.what());
            }
            return std::string("taken");
        };
        auto const change = [&](char const* file, char const* key, nlohmann::json const& value) {
            auto const path = folder / file;
            std::ifstream in(path);
            auto json = nlohmann::json::parse(in);
            json[key] = value;
            std::ofstream(path) << json;
        };
        fresh();
        CHECK(refusal() == "taken");
        std::filesystem::remove_all(folder / "tokenizer");
        CHECK(refusal().find("tokenizer") != std::string::npos);
        fresh();
        change("vae/config.json", "latent_channels", 8);
        CHECK(refusal().find("vae") != std::string::npos);
        fresh();
        change("text_encoder/config.json", "num_hidden_layers", 3);
        CHECK(refusal().find("text_encoder") != std::string::npos);
        CHECK(refusal().find("tensors are missing") != std::string::npos);
        fresh();
        change("unet/config.json", "layers_per_block", 2);
        change("controlnet/config.json", "layers_per_block", 2);
        CHECK(refusal().find("unet") != std::string::npos);
    }
}
