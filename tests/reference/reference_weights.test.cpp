// SPDX-License-Identifier: MIT
// A folder holds the weights of all networks and how they are built.
#include <genrender/reference/reference_weights.hpp>

#include "small_networks.hpp"

#include <genrender/reference/controlnet.hpp>
#include <genrender/reference/unet.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

namespace {

/// Builds both networks, by which their tensors are taken.
template <class Real>
void build(reference_weights<Real>& source) {
    site_list sites({4, 4});
    controlnet<Real> const control(source.config, source.controlnet, sites);
    unet<Real> const network(source.config, source.unet, sites);
}

/// A folder with a small network, with half its precision if so wanted.
struct saved_network {
    temporary_file folder{"saved"};
    reference_weights<float> source = reference_weights<float>::seeded(3, small_config());

    explicit saved_network(safetensors_storage storage = safetensors_storage::f32) {
        build(source);
        source.save(folder.path(), storage);
    }
    std::filesystem::path path() const { return folder.path(); }
};

} // namespace

TEST_SUITE("reference/reference_weights") {
    TEST_CASE_TEMPLATE("what was saved is loaded to the bit", Real, float, double) {
        saved_network const saved;
        auto loaded = reference_weights<Real>::from_folder(saved.path());
        build(loaded);
        CHECK(loaded.unet.values() == saved.source.unet.values());
        CHECK(loaded.controlnet.values() == saved.source.controlnet.values());
        CHECK(loaded.unet.parameter_count() == saved.source.unet.parameter_count());
        CHECK(unet_json(loaded.config) == unet_json(small_config()));
        CHECK(controlnet_json(loaded.config) == controlnet_json(small_config()));
        CHECK(loaded.config.prediction_type == prediction::clean);
        REQUIRE(loaded.vocabulary);
        CHECK(loaded.vocabulary->words() == saved.source.vocabulary->words());
        for (std::size_t row = 0; row < 12; ++row) {
            for (std::size_t c = 0; c < 6; ++c) {
                CHECK(loaded.vocabulary->table()(row, c) ==
                      static_cast<Real>(saved.source.vocabulary->table()(row, c)));
            }
        }
    }

    TEST_CASE("half the precision is near") {
        saved_network const saved(safetensors_storage::f16);
        auto loaded = reference_weights<float>::from_folder(saved.path());
        auto const name = std::string("mid_block.resnets.0.conv1.weight");
        auto const found = loaded.unet.take(name, {12, 12, 3, 3});
        auto const expected = saved.source.unet.values().at(name);
        for (std::size_t i = 0; i < found.size(); ++i) {
            CHECK(found[i] == doctest::Approx(expected[i]).epsilon(1e-3));
        }
    }

    TEST_CASE("the ControlNet may lie in a folder of its own") {
        saved_network const saved;
        temporary_file const elsewhere("controlnet");
        std::filesystem::rename(saved.path() / "controlnet", elsewhere.path());
        CHECK_THROWS_WITH_AS(reference_weights<float>::from_folder(saved.path()),
                             ((saved.path() / "controlnet" / "config.json").string() +
                              ": file cannot be opened, expected a readable JSON file")
                                 .c_str(),
                             file_error);
        auto loaded = reference_weights<float>::from_folder(saved.path(), elsewhere.path());
        CHECK_NOTHROW(build(loaded));
    }

    TEST_CASE("without words a network can be built but told nothing in words") {
        saved_network const saved;
        std::filesystem::remove_all(saved.path() / "text_encoder");
        auto loaded = reference_weights<float>::from_folder(saved.path());
        CHECK_NOTHROW(build(loaded));
        CHECK_THROWS_WITH_AS(loaded.conditioning(stack<float, 3>({1, 8, 8}), "red"),
                             "reference_weights: text encoder is none or of another class, expected a PromptVocabulary "
                             "(or a network_conditioning with tokens of your own)",
                             value_error);
    }

    TEST_CASE("a folder that cannot be written is named") {
        temporary_file const file("not_a_folder");
        std::ofstream(file.path()) << "x";
        auto const source = reference_weights<float>::seeded(1, small_config());
        CHECK_THROWS_WITH_AS(source.save(file.path()),
                             ((std::filesystem::path(file.path()) / "scheduler" / "scheduler_config.json").string() +
                              ": file cannot be written, expected a writable place")
                                 .c_str(),
                             file_error);
    }
}
