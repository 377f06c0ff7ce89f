// SPDX-License-Identifier: MIT
// The C++ that docs/ shows beside the examples' own: each region stands in a page, word for word.
#include <genrender/genrender.hpp>

#include <genrender/evaluation/contrast.hpp>
#include <genrender/evaluation/correspondence_error.hpp>
#include <genrender/evaluation/pixel_correspondence.hpp>
#include <genrender/inspection/preflight.hpp>

#include <genrender/testing/analytic_denoiser.hpp>
#include <genrender/testing/random_stack.hpp>
#include "../support/small_maps.hpp"

#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace {

// An engine's pool of threads, as far as the loop below needs one.
struct engine_pool {
    template <class Task>
    void run(std::size_t count, Task const& task) {
        for (std::size_t i = count; i-- > 0;) {
            task(i);
        }
    }
};

// docs:begin engine_loop
/// The parallel loop on the threads of your engine.
struct engine_loop {
    engine_pool* pool;

    template <class Body>
    void operator()(std::size_t count, Body&& body) const {
        pool->run(count, [&](std::size_t i) { body(i); });
    }
};
static_assert(genrender::parallel_loop<engine_loop>);
// docs:end

// A type of 16 bits of an engine.
struct engine_half {
    std::uint16_t bits;
};

} // namespace

// docs:begin half_bits
template <>
struct genrender::half_bits<engine_half> {
    using type = genrender::float16_bits; // or bfloat16_bits
};
// docs:end

TEST_SUITE("documentation/answers") {
    using genrender::testing::analytic_denoiser;

    // Four frames of a strip that moves by a token, and a denoiser of 4 x 4 latents.
    genrender::uv_maps const strip =
        genrender::testing::drawn_maps({"aaaa.... aaaa.... aaaa.... aaaa.... ........ ........ ........ ........",
                                        ".aaaa... .aaaa... .aaaa... .aaaa... ........ ........ ........ ........",
                                        "..aaaa.. ..aaaa.. ..aaaa.. ..aaaa.. ........ ........ ........ ........",
                                        "...aaaa. ...aaaa. ...aaaa. ...aaaa. ........ ........ ........ ........"});

    genrender::render_settings<float> small_settings() {
        genrender::render_settings<float> settings;
        settings.steps = 3;
        settings.keyframes.count = 2;
        return settings;
    }

    TEST_CASE("a run that is cancelled keeps its latents and its report") {
        analytic_denoiser<float> const phi{{4, 4}};
        auto const UV = to_uv_view(strip);
        auto const settings = small_settings();
        std::atomic<bool> stop{false};
        // docs:begin cancel
        auto const ask = [&](genrender::progress const& now) {
            stop = stop || now.step == 1;
            return !stop; // false ends the run after the call of the denoiser that is done
        };
        auto const result = genrender::render(phi, UV, {.settings = settings, .observer = ask});
        // result.z is as far as the run has come; result.report and result.is_cancelled tell of it.
        // docs:end
        CHECK(result.is_cancelled);
        CHECK(result.z.shape()[0] == 4);
    }

    TEST_CASE("a run that was killed goes on to the same frames") {
        analytic_denoiser<float> const phi{{4, 4}};
        auto const UV = to_uv_view(strip);
        auto const settings = small_settings();
        auto const ask = [](genrender::progress const& now) { return now.step < 2; };
        std::string kept;
        // docs:begin resume
        auto const keep = [&](genrender::finished_step<float> const& step) {
            std::ostringstream stream;
            genrender::write_checkpoint(stream, step.make_checkpoint()); // step.estimates() shows how it looks so far
            kept = stream.str();
        };
        genrender::render(phi, UV,
                          {.settings = settings, .observer = ask, .after_step = keep, .model_key = "a red ball"});
        // Later, in another process:
        std::istringstream stream(kept);
        auto const left = genrender::read_checkpoint<float>(stream);
        auto const result =
            genrender::render(phi, UV, {.settings = settings, .resume = &left, .model_key = "a red ball"});
        // docs:end
        CHECK(left.steps == 2);
        CHECK(result.z == genrender::render(phi, UV, {.settings = settings}).z);
    }

    TEST_CASE("results do not depend on the loop") {
        analytic_denoiser<float> const phi{{4, 4}};
        auto const UV = to_uv_view(strip);
        auto const settings = small_settings();
        engine_pool pool;
        // docs:begin loops
        auto const alone = genrender::render(phi, UV, {.settings = settings});
        auto const own = genrender::render(phi, UV, {.settings = settings, .loop = engine_loop{&pool}});
        auto const four = genrender::render(phi, UV, {.settings = settings, .loop = genrender::threaded_loop{4}});
        // docs:end
        CHECK(alone.z == own.z);
        CHECK(alone.z == four.z);
    }

    TEST_CASE("a baseline is another method with its settings") {
        analytic_denoiser<float> const phi{{4, 4}};
        auto const UV = to_uv_view(strip);
        auto const settings = small_settings();
        // docs:begin baseline
        auto const carried =
            genrender::render<genrender::tokenflow>(phi, UV, {.settings = genrender::baseline_settings(settings)});
        auto const frame_by_frame = genrender::render(phi, UV, {.settings = genrender::per_frame(settings)});
        // docs:end
        CHECK(carried.z.shape() == frame_by_frame.z.shape());
    }

    TEST_CASE("the paper to the letter is settings") {
        auto settings = small_settings();
        // docs:begin literal
        settings = genrender::render_settings<float>::plain(); // Alg. 1 alone
        settings.normalization.statistics = genrender::adain_statistics::mean_and_deviation;
        settings.correspondence.kind = genrender::correspondence_kind::texel_grid;
        settings.correspondence.texels.T = 1024;
        settings.average = genrender::texel_average::plain;
        settings.noise.reading = genrender::noise_reading::nearest_texel;
        settings.noise.T = 512;
        // docs:end
        CHECK(!settings.consensus.enabled);
        CHECK(settings.noise.T == 512);
    }

    TEST_CASE("latent normalisation as in 0.1 is a setting") {
        auto settings = small_settings();
        // docs:begin as_in_zero_one
        settings = genrender::render_settings<float>::plain(); // no consensus, and eq. 6 at every site
        settings.normalization.statistics = genrender::adain_statistics::mean_and_deviation;
        // docs:end
        CHECK(settings.normalization.enabled);
    }

    TEST_CASE("maps are looked at and memory is planned before a run") {
        analytic_denoiser<float> const phi{{4, 4}};
        auto const UV = to_uv_view(strip);
        auto const settings = small_settings();
        // docs:begin before_a_run
        std::vector<genrender::grid_extents> grids;
        for (auto const& site : phi.sites()) {
            grids.push_back(site.grid);
        }
        auto const found = genrender::preflight(UV, grids, settings);
        for (auto const& one : found.recommendations) {
            std::cout << one.name() << " " << one.figure << "\n"; // and the object, grid and frames that it is about
        }
        auto const threads = 4;
        auto const plan = genrender::plan_memory(genrender::describe_run(phi, UV, threads), settings);
        auto const runs = found.allows_run() && plan.bytes.peak < (std::size_t{8} << 30);
        // docs:end
        CHECK(runs);
    }

    TEST_CASE("images are measured along the surfaces") {
        auto const UV = to_uv_view(strip);
        auto const images = genrender::testing::random_stack<float>(std::array<std::size_t, 4>{4, 3, 8, 8}, 1);
        // docs:begin measure
        // images [frames, channels, height, width], decoded
        genrender::pixel_correspondence const map(UV, {images.extents()[2], images.extents()[3]});
        auto const error = genrender::correspondence_error(images.view(), map, 1); // frames apart
        auto const contrast = genrender::contrast(images.view(), map.objects());
        if (error && contrast) { // there are pairs of pixels, and objects
            std::cout << "RMSE " << *error << ", divided by contrast " << *error / *contrast << "\n";
        }
        // docs:end
        CHECK(error);
    }
}
