// SPDX-License-Identifier: MIT
// [GR alg. 1] What a denoiser is told before a run is what it then sees.
#include <genrender/pipeline/shapes_of_run.hpp>

#include <genrender/baselines/pix2video.hpp>
#include <genrender/baselines/tokenflow.hpp>
#include <genrender/blending/padded_rows.hpp>
#include <genrender/pipeline/render.hpp>

#include <genrender/testing/analytic_denoiser.hpp>
#include "../support/random_scene.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

using namespace genrender;

TEST_SUITE("pipeline/shapes_of_run") {
    namespace {

    using features = host_features<double>;

    /// What a denoiser saw in a run.
    struct seen_shapes {
        std::optional<run_shapes> told;
        std::set<std::size_t> stacks;
        std::set<attention_meaning> meanings;
        std::set<attention_place> mixed;
        std::size_t left_out = 0;
        std::size_t widest = 0;
        std::size_t arrays = 0;                                        ///< plans that were handed over
        std::map<plan_key, std::vector<std::vector<double>>> by_key{}; ///< offsets, sources, weights
        std::size_t changed = 0;                                       ///< arrays that differ from those of their key
        std::size_t without_key = 0;
        std::mutex mutex{};
    };

    /// The analytic denoiser with two more sites and two branches, which notes what it is asked for.
    struct watching_denoiser : testing::analytic_denoiser<double> {
        seen_shapes* seen;

        explicit watching_denoiser(seen_shapes& all)
            : testing::analytic_denoiser<double>{.grid = {8, 8}, .attention = 0.5, .guidance_branches = 2}, seen(&all) {
            site_list.push_back({"decoder.attn2", network_kind::denoising, network_part::decoder, grid, channels});
        }

        void prepare(run_shapes const& shapes) const {
            CHECK(!seen->told);
            CHECK(seen->stacks.empty());
            seen->told = shapes;
        }

        template <class Processor>
        void operator()(strided_view<double, 4> x0, strided_view<double const, 4> z, double sigma,
                        std::span<frame_index const> frames, Processor& processor) const {
            {
                std::lock_guard const lock(seen->mutex);
                seen->stacks.insert(frames.size());
            }
            auto const watched = [&](auto& call) {
                watching_call<std::remove_cvref_t<decltype(call)>> watching{call, seen};
                return features(processor(watching));
            };
            testing::analytic_denoiser<double>::operator()(x0, z, sigma, frames, watched);
        }

        template <class Call>
        struct watching_call : Call {
            seen_shapes* seen;
            watching_call(Call const& call, seen_shapes* all) : Call(call), seen(all) {}

            features attend(features const& Q, attention_sources<features> const& sources) const {
                {
                    std::lock_guard const lock(seen->mutex);
                    seen->meanings.insert(sources.pattern().meaning);
                    seen->left_out += sources.pattern().left_out.size();
                }
                return Call::attend(Q, sources);
            }
            features mix(features const& F_hat, features const& F_KF, std::span<sparse_rows<double> const> rows,
                         double alpha) const {
                {
                    std::lock_guard const lock(seen->mutex);
                    seen->mixed.insert(this->place());
                    for (auto const& one : rows) {
                        seen->widest = std::max(seen->widest, row_width(one));
                        note(one);
                    }
                }
                return Call::mix(F_hat, F_KF, rows, alpha);
            }
            void note(sparse_rows<double> const& rows) const {
                ++seen->arrays;
                if (!rows.key) {
                    ++seen->without_key;
                    return;
                }
                std::vector<std::vector<double>> const values{{rows.offsets.begin(), rows.offsets.end()},
                                                              {rows.sources.begin(), rows.sources.end()},
                                                              {rows.weights.begin(), rows.weights.end()}};
                auto const found = seen->by_key.emplace(*rows.key, values).first;
                seen->changed += found->second == values ? 0U : 1U;
            }
        };
    };

    struct refusing : testing::analytic_denoiser<double> {
        void prepare(run_shapes const& shapes) const {
            throw value_error("refusing: keyframes is " + std::to_string(shapes.keyframes) + ", expected 4");
        }
        template <class Processor>
        void operator()(strided_view<double, 4>, strided_view<double const, 4>, double, std::span<frame_index const>,
                        Processor&) const {
            throw std::logic_error("refusing: was called");
        }
    };

    struct names_its_call : refusing {
        using call_type = attention_call_archetype<features, double>;
    };

    /// The paper's method without its word on shapes.
    struct untold {
        generative_rendering paper;
        std::vector<frame_index> keyframes(render_settings<double> const& settings, std::size_t frames,
                                           std::size_t step) const {
            return paper.keyframes(settings, frames, step);
        }
    };

    uv_maps const& scene() {
        static auto const maps = testing::random_scene(33, 5, {32, 32}, 3);
        return maps;
    }

    render_settings<double> few_steps() {
        render_settings<double> settings = render_settings<double>::plain();
        settings.steps = 3;
        settings.keyframes.count = 3;
        settings.frames_per_call = 2;
        return settings;
    }

    template <class Method = generative_rendering>
    void run(seen_shapes& seen, render_settings<double> const& settings, std::size_t threads = 1) {
        watching_denoiser const phi(seen);
        render<Method>(phi, to_uv_view(scene()), {.settings = settings, .loop = threaded_loop(threads)});
        REQUIRE(seen.told.has_value());
    }

    } // namespace

    TEST_CASE("the stacks, places and rows of a run are those that were told before its first call") {
        seen_shapes seen;
        run(seen, few_steps());
        auto const& told = *seen.told;
        CHECK(told.frames == 5);
        CHECK(told.keyframes == 3);
        CHECK(told.frames_per_call == 2);
        CHECK(told.last_call == 1);
        CHECK(seen.stacks == std::set<std::size_t>{1, 2, 3});
        CHECK(told.row_width == 3);
        CHECK(seen.widest == 3);
        CHECK(std::set<attention_place>(told.places.begin(), told.places.end()) == seen.mixed);
        CHECK(told.places == std::vector<attention_place>{{{2}, 0}, {{2}, 1}, {{3}, 0}, {{3}, 1}});
        CHECK(told.mixes_rows);
        CHECK(!told.leaves_out);
        CHECK(seen.left_out == 0);
        CHECK(!told.has_plain_steps);
        CHECK(told.banks == 1);
        CHECK(seen.meanings == std::set<attention_meaning>{attention_meaning::own, attention_meaning::stack,
                                                           attention_meaning::own_and_joined});
    }
    TEST_CASE("each switch of the method is told, and holds") {
        auto settings = few_steps();
        settings.injection.keeps_own_copy = false;
        settings.keyframe_storage = feature_storage::bf16;
        settings.window_end = 0.5;
        settings.calls_at_once = 2;
        seen_shapes masked;
        run(masked, settings);
        CHECK(masked.told->leaves_out);
        CHECK(masked.left_out > 0);
        CHECK(masked.told->has_plain_steps);
        CHECK(masked.told->storage == feature_storage::bf16);
        CHECK(masked.told->calls_at_once == 2);

        settings = few_steps();
        settings.injection.length_correction = 1;
        settings.injection.variance.target = variance_target::total;
        seen_shapes vivid;
        run(vivid, settings);
        CHECK(vivid.told->scales_logits);
        CHECK(vivid.told->keeps_variance);
        CHECK(!masked.told->scales_logits);
        CHECK(!masked.told->keeps_variance);
        seen_shapes unjoined;
        settings.injection.pre_attention = settings.injection.post_attention = false;
        run(unjoined, settings);
        CHECK(!unjoined.told->scales_logits);
        CHECK(!unjoined.told->keeps_variance);

        settings = few_steps();
        settings.injection.pre_attention = false;
        seen_shapes alone;
        run(alone, settings);
        CHECK(!alone.told->attends_to_stack);
        CHECK(!alone.told->joins_keyframes);
        CHECK(alone.meanings == std::set<attention_meaning>{attention_meaning::own});

        settings = few_steps();
        settings.injection.post_attention = false;
        seen_shapes unmixed;
        run(unmixed, settings);
        CHECK(!unmixed.told->mixes_rows);
        CHECK(unmixed.told->row_width == 0);
        CHECK(unmixed.arrays == 0);

        settings.window_end = 0;
        settings.keyframe_storage = feature_storage::f16;
        seen_shapes plain;
        run(plain, settings);
        CHECK(plain.told->keyframes == 0);
        CHECK(plain.told->banks == 0);
        CHECK(plain.told->storage == feature_storage::same); // nothing is kept
        CHECK(plain.stacks == std::set<std::size_t>{1, 2});
    }
    TEST_CASE("averaged texels are told with the bound of the compiled maps") {
        auto settings = few_steps();
        settings.correspondence.kind = correspondence_kind::texel_grid;
        settings.correspondence.texels.reading = texel_reading::average;
        settings.correspondence.texels.T = 3;
        seen_shapes seen;
        run(seen, settings);
        CHECK(seen.widest > 3);
        CHECK(seen.widest <= seen.told->row_width);
    }
    TEST_CASE("baselines tell their own shapes") {
        seen_shapes flow;
        run<tokenflow>(flow, few_steps());
        CHECK(flow.told->row_width == 2);
        CHECK(flow.widest == 2);
        CHECK(!flow.told->joins_keyframes);
        CHECK(flow.meanings.count(attention_meaning::own_and_joined) == 0);

        seen_shapes video;
        run<pix2video>(video, few_steps());
        CHECK(video.told->lists_sources);
        CHECK(video.meanings.count(attention_meaning::listed) == 1);
        CHECK(video.told->keyframes == 0);
        CHECK(!video.told->mixes_rows);
        CHECK(!video.told->has_plain_steps);
        CHECK(video.told->banks == 2);
        CHECK(!video.told->scales_logits);

        auto scaled = few_steps();
        scaled.injection.length_correction = 1;
        scaled.injection.variance.target = variance_target::total;
        seen_shapes scaled_flow;
        run<tokenflow>(scaled_flow, scaled);
        CHECK(scaled_flow.told->scales_logits);
        CHECK(!scaled_flow.told->keeps_variance); // it is not read
        seen_shapes scaled_video;
        run<pix2video>(scaled_video, scaled);
        CHECK(scaled_video.told->scales_logits);
        CHECK(!scaled_video.told->keeps_variance);
    }
    TEST_CASE("a method that does not tell may ask for everything") {
        correspondence_set<chosen_correspondence<2>> const maps;
        seen_shapes seen;
        auto const shapes = shapes_of_run(watching_denoiser(seen), few_steps(), 5, maps, untold{});
        CHECK(shapes.joins_keyframes);
        CHECK(shapes.leaves_out);
        CHECK(shapes.lists_sources);
        CHECK(shapes.row_width == 0); // of no maps
    }
    TEST_CASE("a denoiser that refuses ends the run before its first call") {
        refusing const phi{{.grid = {8, 8}}};
        CHECK_THROWS_WITH_AS(render(phi, to_uv_view(scene()), {.settings = few_steps()}),
                             "refusing: keyframes is 3, expected 4", value_error);
    }
    TEST_CASE("16 bits are refused before the first call of a denoiser that names calls without stored") {
        names_its_call const phi{{{.grid = {8, 8}}}};
        auto settings = few_steps();
        settings.keyframe_storage = feature_storage::f16;
        CHECK_THROWS_WITH_AS(render(phi, to_uv_view(scene()), {.settings = settings}),
                             "render: settings.keyframe_storage is of 16 bits, expected feature_storage::same for a "
                             "denoiser whose call_type has no `stored`",
                             value_error);
    }
    TEST_CASE("within a run equal keys mean equal arrays, one for each grid, frame and evaluation") {
        for (auto const sampler : {sampler_kind::euler, sampler_kind::heun}) {
            auto const evaluations = std::size_t{sampler == sampler_kind::euler ? 3U : 5U};
            auto settings = few_steps();
            settings.sampler = sampler;
            seen_shapes seen;
            run(seen, settings, 2);
            CHECK(seen.without_key == 0);
            CHECK(seen.changed == 0);
            CHECK(seen.by_key.size() == evaluations * 5); // one grid
            CHECK(seen.arrays == 4 * seen.by_key.size()); // two sites of two branches
            auto const first_of_run = seen.by_key.begin()->first.evaluation;
            seen_shapes again;
            run(again, settings, 2);
            CHECK(std::all_of(again.by_key.begin(), again.by_key.end(), [&](auto const& entry) {
                return entry.first.evaluation > first_of_run + evaluations - 1;
            }));
        }
    }
    TEST_CASE("static graphs see the keys too") {
        feature_bank<features> bank(1, 1);
        keyframe_features<features> kept;
        kept.f_KF = kept.F_KF = features::allocate({1, 4, 3});
        bank.put({{0}, 0}, kept);
        std::vector<frame_index> const KF{{0}};
        blend_plans<double> plans({{2, 2}}, 41);
        plans.add({2, 2}, {1}, {{0, 0, 0, 0, 0}, {}, {}});
        injector<features, double> const pass(bank, KF, plans);
        auto const rows = pass.rows_at({0}, std::vector<frame_index>{{1}, {1}});
        CHECK(rows[0].key == plan_key{{2, 2}, {1}, 41});
        CHECK(rows[1].key == rows[0].key);
        blend_plans<double> unnumbered({{2, 2}});
        unnumbered.add({2, 2}, {1}, {{0, 0, 0, 0, 0}, {}, {}});
        CHECK(!unnumbered.rows({0}, frame_index{1}).key);
    }
    TEST_CASE("a last call that is filled has the stack of the others, and the frames are the same to the bit") {
        auto settings = few_steps();
        testing::analytic_denoiser<double> const phi{.grid = {8, 8}, .attention = 0.5, .guidance_branches = 2};
        auto const expected = render(phi, to_uv_view(scene()), {.settings = settings});
        settings.fills_last_call = true;
        for (auto const frames_per_call : {std::size_t{2}, std::size_t{3}, std::size_t{5}, std::size_t{8}}) {
            settings.frames_per_call = frames_per_call;
            auto const filled = render(phi, to_uv_view(scene()), {.settings = settings});
            CHECK(std::equal(filled.z.begin(), filled.z.end(), expected.z.begin()));
            REQUIRE(filled.report.coverage.size() == expected.report.coverage.size());
            for (auto const& [grid, coverage] : expected.report.coverage) {
                CHECK(filled.report.coverage.at(grid).covered == coverage.covered);
            }
            seen_shapes seen;
            run(seen, settings, 2);
            CHECK(seen.stacks == std::set<std::size_t>{3, frames_per_call});
            CHECK(seen.told->last_call == frames_per_call);
            CHECK(seen.told->frames_per_call == frames_per_call);
        }
        settings.frames_per_call = 65537;
        CHECK_THROWS_WITH_AS(render(phi, to_uv_view(scene()), {.settings = settings}),
                             "render: settings.frames_per_call is 65537, expected at most 65536 frames where the last "
                             "call is filled",
                             value_error);
    }
}
