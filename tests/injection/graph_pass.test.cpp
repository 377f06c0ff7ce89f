// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi as a static graph] Calls find their graphs, and graphs their arrays.
#include <genrender/injection/graph_pass.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <optional>
#include <vector>

using namespace genrender;

TEST_SUITE("injection/graph_pass") {
    namespace {

    /// A handle of features, of which nothing is read.
    struct graph_handle {};
    constexpr attention_place graph_place{{0}, 1};
    std::vector<frame_index> const graph_frames{{1}, {2}};

    run_shapes shapes_of_graphs() {
        run_shapes shapes;
        shapes.keyframes = 2;
        shapes.places = {graph_place};
        return shapes;
    }

    template <class Processor>
    graph_pass pass_of(Processor const& processor, run_shapes const& shapes) {
        return graph_pass_of<graph_handle, float>(processor, shapes, graph_frames);
    }

    template <class Processor>
    void check_inputs(Processor const& processor, graph_pass pass, run_shapes const& shapes) {
        require_inputs(inputs_at<graph_handle, float>(processor, graph_place, graph_frames), pass, shapes,
                       graph_frames);
    }

    } // namespace

    TEST_CASE("a call takes the graph of what its processor asks for") {
        auto shapes = shapes_of_graphs();
        feature_bank<graph_handle> bank(1, 2);
        recorder<graph_handle> const records(bank, [](attention_place) { return true; });
        CHECK(pass_of(plain_attention{}, shapes) == graph_pass::plain);
        CHECK(pass_of(records, shapes) == graph_pass::keyframe);
        check_inputs(records, graph_pass::keyframe, shapes);

        record_features(records, graph_place, graph_handle{}, graph_handle{});
        blend_plans<float> plans({{1, 1}});
        for (auto const frame : graph_frames) {
            plans.add({1, 1}, frame, {});
        }
        injector<graph_handle, float> const injects(bank, graph_frames, plans);
        CHECK(pass_of(injects, shapes) == graph_pass::injected);
        check_inputs(injects, graph_pass::injected, shapes);
        shapes.places.clear();
        CHECK(pass_of(injects, shapes) == graph_pass::plain);
    }

    TEST_CASE("inputs of another pass, other equations or another number of keyframes are refused") {
        auto shapes = shapes_of_graphs();
        feature_bank<graph_handle> bank(1, 2);
        recorder<graph_handle> const records(bank, [](attention_place) { return true; });
        CHECK_THROWS_WITH_AS(check_inputs(records, graph_pass::plain, shapes), doctest::Contains("of another pass"),
                             value_error);
        CHECK_THROWS_AS(check_inputs(plain_attention{}, graph_pass::injected, shapes), value_error);
        shapes.attends_to_stack = false;
        CHECK_THROWS_AS(check_inputs(records, graph_pass::keyframe, shapes), value_error);
        shapes.attends_to_stack = true;
        shapes.keyframes = 3;
        CHECK_THROWS_WITH_AS(check_inputs(records, graph_pass::keyframe, shapes),
                             doctest::Contains("as many keyframes in every step"), value_error);
        feature_inputs<graph_handle, float> in;
        in.scales = {2};
        CHECK_THROWS_WITH_AS(require_inputs(in, graph_pass::plain, shapes, graph_frames),
                             "require_inputs: in.scales.size() is 1, expected one for each frame", value_error);
    }

    TEST_CASE("[GR eq. 5] the keyframe that a frame leaves out has minus infinity, all else 0") {
        std::array<double, 12> memory{};
        memory.fill(7);
        strided_view<double, 2> const out(memory.data(), {2, 6}); // 2 tokens, 2 keyframes
        std::vector<std::optional<std::size_t>> const left_out{1, std::nullopt};
        write_left_out(out, left_out, 2);
        for (std::size_t e = 0; e < 12; ++e) {
            CHECK(memory[e] == (e == 4 || e == 5 ? -std::numeric_limits<double>::infinity() : 0.0));
        }
        write_left_out(out, {}, 2);
        CHECK(memory[4] == 0);
        std::vector<std::optional<std::size_t>> const beyond{2, std::nullopt};
        CHECK_THROWS_WITH_AS(write_left_out(out, beyond, 2), doctest::Contains("that are joined"), value_error);
    }

    TEST_CASE("rows are known again by their keys and alpha, and never without keys") {
        std::vector<sparse_rows<float>> rows(2);
        rows[0].key = plan_key{{1, 1}, {1}, 1};
        rows[1].key = plan_key{{1, 1}, {2}, 1};
        uploaded_rows<float> last;
        CHECK_FALSE(last.holds(rows, 0.5f));
        last.set(rows, 0.5f);
        CHECK(last.holds(rows, 0.5f));
        CHECK_FALSE(last.holds(rows, 0.25f));
        std::swap(rows[0], rows[1]);
        CHECK_FALSE(last.holds(rows, 0.5f));
        rows[0].key.reset();
        last.set(rows, 0.5f);
        CHECK_FALSE(last.holds(rows, 0.5f));
    }
}
