// SPDX-License-Identifier: MIT
// Animated WebP files, read back by the format's own decoder.
#include <examples/support/animation_file.hpp>

#include "../support/scratch_folder.hpp"

#include <doctest/doctest.h>
#include <webp/demux.h>

#include <fstream>
#include <memory>

using namespace genrender;
using namespace genrender::examples;
using genrender::tests::scratch_folder;

namespace {

std::vector<rgb8_image> moving_square(std::size_t count) {
    std::vector<rgb8_image> frames;
    for (std::size_t i = 0; i < count; ++i) {
        auto& frame = frames.emplace_back(grid_extents{12, 20}, rgb8{10, 20, 30});
        frame.set(3, 2 + i, {250, static_cast<std::uint8_t>(40 * i), 5});
        frame.set(4, 2 + i, {250, 0, 5});
    }
    return frames;
}

struct decoded_animation {
    WebPAnimInfo info{};
    std::vector<rgb8_image> frames;
    std::vector<int> end_times;
};

decoded_animation decode(std::filesystem::path const& path) {
    std::ifstream stream(path, std::ios::binary);
    std::string const bytes{std::istreambuf_iterator<char>(stream), {}};
    WebPData const data{reinterpret_cast<std::uint8_t const*>(bytes.data()), bytes.size()};
    std::unique_ptr<WebPAnimDecoder, void (*)(WebPAnimDecoder*)> const decoder(WebPAnimDecoderNew(&data, nullptr),
                                                                               WebPAnimDecoderDelete);
    REQUIRE(decoder != nullptr);
    decoded_animation result;
    REQUIRE(WebPAnimDecoderGetInfo(decoder.get(), &result.info) != 0);
    while (WebPAnimDecoderHasMoreFrames(decoder.get()) != 0) {
        std::uint8_t* pixels = nullptr;
        REQUIRE(WebPAnimDecoderGetNext(decoder.get(), &pixels, &result.end_times.emplace_back()) != 0);
        auto& frame =
            result.frames.emplace_back(grid_extents{result.info.canvas_height, result.info.canvas_width}, rgb8{});
        for (std::size_t i = 0; i < frame.grid().size(); ++i) {
            std::copy_n(pixels + 4 * i, 3, frame.bytes.begin() + static_cast<std::ptrdiff_t>(3 * i));
        }
    }
    return result;
}

} // namespace

TEST_SUITE("examples_support/animation_file") {
    TEST_CASE("an animation decodes to the same frames at their times and loops for ever") {
        scratch_folder const folder;
        auto const frames = moving_square(5);

        write_animation(folder / "animation.webp", frames, {.frames_per_second = 8});

        auto const decoded = decode(folder / "animation.webp");
        CHECK(decoded.info.loop_count == 0);
        CHECK(decoded.info.canvas_width == 20);
        CHECK(decoded.info.canvas_height == 12);
        CHECK(decoded.end_times == std::vector<int>{125, 250, 375, 500, 625});
        REQUIRE(decoded.frames.size() == 5);
        for (std::size_t i = 0; i < frames.size(); ++i) {
            CHECK(decoded.frames[i].bytes == frames[i].bytes);
        }
        CHECK(folder.entries() == 1);
    }

    TEST_CASE("times are rounded to milliseconds without drift") {
        scratch_folder const folder;
        write_animation(folder / "a.webp", moving_square(3), {.frames_per_second = 30});
        CHECK(decode(folder / "a.webp").end_times == std::vector<int>{33, 67, 100});
    }

    TEST_CASE("near-lossless frames stay near") {
        scratch_folder const folder;
        auto frames = moving_square(2);
        for (std::size_t i = 0; i < frames[0].bytes.size(); ++i) {
            frames[0].bytes[i] = static_cast<std::uint8_t>(i * i % 251);
        }
        write_animation(folder / "a.webp", frames, {.near_lossless = 60});
        auto const decoded = decode(folder / "a.webp");
        auto largest = 0;
        for (std::size_t i = 0; i < frames[0].bytes.size(); ++i) {
            largest = std::max(largest, std::abs(int{decoded.frames[0].bytes[i]} - int{frames[0].bytes[i]}));
        }
        CHECK(largest > 0);
        CHECK(largest <= 8);
    }

    TEST_CASE("one frame is an animation too") {
        scratch_folder const folder;
        write_animation(folder / "a.webp", moving_square(1));
        CHECK(decode(folder / "a.webp").frames.size() == 1);
    }

    TEST_CASE("impossible requests are refused and leave no file") {
        scratch_folder const folder;
        auto const path = folder / "a.webp";
        CHECK_THROWS_WITH_AS(write_animation(path, {}), "write_animation: frames is empty, expected at least one frame",
                             value_error);
        CHECK_THROWS_WITH_AS(write_animation(path, moving_square(1), {.frames_per_second = 0}),
                             "write_animation: frames_per_second is 0.000000, expected above 0 and at most 1000",
                             value_error);
        CHECK_THROWS_WITH_AS(write_animation(path, moving_square(1), {.near_lossless = 101}),
                             "write_animation: near_lossless is 101, expected 0 to 100", value_error);
        auto frames = moving_square(2);
        frames[1] = rgb8_image({3, 3}, {0, 0, 0});
        CHECK_THROWS_WITH_AS(write_animation(path, frames), "write_animation: frames is [3, 3], expected [12, 20]",
                             shape_error);
        CHECK_THROWS_WITH_AS(write_animation(path, std::vector{rgb8_image({1, 16384}, {0, 0, 0})}),
                             "write_animation: frames is [1, 16384], expected sides of at most 16383", shape_error);
        CHECK(folder.entries() == 0);
    }
}
