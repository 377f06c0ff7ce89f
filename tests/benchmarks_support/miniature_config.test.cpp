// SPDX-License-Identifier: MIT
// The architecture that is written down beside that of the files.
#include <benchmarks/support/miniature_config.hpp>

#include <genrender/reference/clip_text_config_file.hpp>
#include <genrender/reference/diffusers_config.hpp>
#include <genrender/reference/diffusers_folder.hpp>

#include <doctest/doctest.h>

#include <filesystem>

using namespace genrender;
using namespace genrender::benchmarks;

TEST_SUITE("benchmarks_support/miniature_config") {
    TEST_CASE("the architecture of the benchmarks is that of the miniature's files") {
        diffusers_folder const files(std::filesystem::path(GENRENDER_TEST_DATA) / "../../examples/miniature/weights");
        auto const config = files.config();
        CHECK(unet_json(miniature_config()) == unet_json(config));
        CHECK(controlnet_json(miniature_config()) == controlnet_json(config));
        CHECK(scheduler_json(miniature_config()) == scheduler_json(config));
        CHECK(miniature_prompt_tokens ==
              read_clip_text_config(files.options(model_part::text_encoder)).max_position_embeddings);
    }
}
