// SPDX-License-Identifier: MIT
// Tests of the parts of a pipeline.
#include <genrender/reference/model_part.hpp>

#include <doctest/doctest.h>

#include <string>

TEST_SUITE("reference/model_part") {
    TEST_CASE("each part has a name for sentences") {
        using genrender::reference::model_part;
        CHECK(std::string(name_of(model_part::unet)) == "UNet");
        CHECK(std::string(name_of(model_part::controlnet)) == "ControlNet");
        CHECK(std::string(name_of(model_part::vae)) == "VAE");
        CHECK(std::string(name_of(model_part::text_encoder)) == "text encoder");
    }
}
