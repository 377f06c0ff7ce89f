// SPDX-License-Identifier: MIT
// [GR sec. 4: Pix2Video*] The processor against attention over frames that are really joined.
#include <genrender/baselines/previous_frame_attention.hpp>

#include "../injection/dense_equations.hpp"
#include <genrender/testing/attention_processor_laws.hpp>

#include <genrender/injection/host_attention_call.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("baselines/previous_frame_attention") {
    namespace {

    constexpr std::size_t tokens = 9;
    constexpr std::size_t channels = 8;
    constexpr attention_place place{{1}, 0};
    constexpr std::size_t sites = 3;

    bool everywhere(attention_place) { return true; }

    template <class Real>
    using call_of = host_attention_call<Real, matrix_module<Real>>;

    std::vector<frame_index> frames_from(std::uint32_t first, std::uint32_t count) {
        std::vector<frame_index> frames;
        for (std::uint32_t i = 0; i < count; ++i) {
            frames.push_back({first + i});
        }
        return frames;
    }

    /// F of one place for all frames of f, run in stacks of the given sizes.
    template <class Real>
    host_features<Real> chained(host_features<Real> const& f, matrix_module<Real> const& module,
                                std::vector<std::uint32_t> const& stacks) {
        auto const F = host_features<Real>::allocate(f.extents());
        earlier_frames<host_features<Real>> earlier;
        std::uint32_t first = 0;
        for (auto const count : stacks) {
            auto const frames = frames_from(first, count);
            feature_bank<host_features<Real>> kept(sites, 2);
            previous_frame_attention<host_features<Real>> const attend(earlier, kept, everywhere);
            call_of<Real> call(place, frames, host_features<Real>(f.view().slice(first, count)), module);
            copy(F.view().slice(first, count), in_view<Real, 3>(attend(call).view()));
            earlier.add(kept, count);
            first += count;
        }
        return F;
    }

    template <class Real>
    constexpr double tolerance = sizeof(Real) == 4 ? 1e-5 : 1e-13;

    } // namespace

    TEST_CASE("it is an attention processor") {
        CHECK(attention_processor<previous_frame_attention<int> const, attention_call_archetype<int, float>>);
        CHECK_FALSE(
            attention_processor<previous_frame_attention<int> const, attention_call_archetype<char const*, float>>);
    }
    TEST_CASE_TEMPLATE("it keeps the laws of attention processors", Real, float, double) {
        auto const frames = frames_from(0, 3);
        earlier_frames<host_features<Real>> earlier;
        feature_bank<host_features<Real>> first(sites, 2);
        previous_frame_attention<host_features<Real>> at_begin(earlier, first, everywhere);
        CHECK(check_attention_processor_laws<Real>(at_begin, frames, tokens, channels, sites).text() == "");
        earlier.add(first, 3);
        auto const later_frames = frames_from(3, 2);
        feature_bank<host_features<Real>> second(sites, 2);
        previous_frame_attention<host_features<Real>> later(earlier, second, everywhere);
        CHECK(check_attention_processor_laws<Real>(later, later_frames, tokens, channels, sites).text() == "");
    }
    TEST_CASE("[GR sec. 4: Pix2Video*] by hand: three frames of one token take values of anchor and previous frame") {
        // Q = 0, so that all keys weigh alike; V = f.
        matrix_module<double> module(1);
        module.W_V(0, 0) = 1;
        auto const f = host_features<double>::allocate({4, 1, 1});
        for (std::size_t i = 0; i < 4; ++i) {
            f.view()(i, 0, 0) = std::pow(10.0, i); // 1, 10, 100, 1000
        }
        auto const F = chained(f, module, {4});
        CHECK(F.view()(0, 0, 0) == 1);   // itself
        CHECK(F.view()(1, 0, 0) == 1);   // the anchor, which is the previous frame too
        CHECK(F.view()(2, 0, 0) == 5.5); // (1 + 10) / 2, without its own 100
        CHECK(F.view()(3, 0, 0) == 50.5);
    }
    TEST_CASE_TEMPLATE("frame i attends to frames 0 and i - 1 really joined and twice the anchor is the anchor once",
                       Real, float, double) {
        matrix_module<Real> const module(channels, 2, 11);
        auto const f = random_features<Real>({6, tokens, channels}, 12);
        auto const F = chained(f, module, {6});
        for (std::size_t i = 0; i < 6; ++i) {
            auto const joined = joined_rows(f, {0, i > 0 ? i - 1 : 0});
            CHECK(greatest_difference(F, i, dense_self_attention(module, joined_rows(f, {i}), joined)) <
                  tolerance<Real>);
        }
    }
    TEST_CASE_TEMPLATE("stacks of any sizes give the same bits", Real, float, double) {
        matrix_module<Real> const module(channels, 2, 11);
        auto const f = random_features<Real>({6, tokens, channels}, 12);
        auto const together = chained(f, module, {6});
        CHECK(equal_bits(together, chained(f, module, {1, 1, 1, 1, 1, 1})));
        CHECK(equal_bits(together, chained(f, module, {2, 2, 2})));
        CHECK(equal_bits(together, chained(f, module, {4, 2})));
        CHECK(equal_bits(together, chained(f, module, {1, 3, 2})));
    }
    TEST_CASE("keys and values are projected once a frame") {
        matrix_module<double> const module(channels, 2, 11);
        chained(random_features<double>({6, tokens, channels}, 12), module, {2, 2, 2});
        CHECK(module.keys == 6);
        CHECK(module.values == 6);
        CHECK(module.queries == 6);
    }
    TEST_CASE("places that the filter leaves out stay plain and keep nothing") {
        matrix_module<double> const module(channels, 2, 11);
        auto const f = random_features<double>({2, tokens, channels}, 12);
        auto const frames = frames_from(0, 2);
        earlier_frames<host_features<double>> const none;
        feature_bank<host_features<double>> kept(sites, 2);
        previous_frame_attention<host_features<double>> const attend(none, kept,
                                                                     [](attention_place at) { return at.branch == 1; });
        call_of<double> call(place, frames, f, module);
        CHECK(equal_bits(attend(call), plain_attention{}(call)));
        CHECK(kept.find(place) == nullptr);
    }
    TEST_CASE("each guidance branch keeps to itself") {
        matrix_module<double> const module(channels, 2, 11);
        auto const f = random_features<double>({2, tokens, channels}, 12);
        auto const other = random_features<double>({2, tokens, channels}, 13);
        earlier_frames<host_features<double>> earlier;
        feature_bank<host_features<double>> kept(sites, 2);
        auto const run = [&](std::uint32_t first, std::uint32_t branch, host_features<double> const& features,
                             feature_bank<host_features<double>>& bank) {
            auto const frames = frames_from(first, 2);
            previous_frame_attention<host_features<double>> const attend(earlier, bank, everywhere);
            call_of<double> call({{1}, branch}, frames, features, module);
            return attend(call);
        };
        run(0, 0, f, kept);
        run(0, 1, other, kept);
        earlier.add(kept, 2);
        feature_bank<host_features<double>> next(sites, 2);
        auto const F = run(2, 1, f, next);
        auto const expected =
            dense_self_attention(module, joined_rows(f, {0}), joined_rows(other, {0, 1})); // frame 2 to 0 and 1
        CHECK(greatest_difference(F, 0, expected) < 1e-13);
    }
    TEST_CASE("frames that do not come next are refused in a sentence") {
        matrix_module<double> const module(channels, 2, 11);
        auto const f = random_features<double>({2, tokens, channels}, 12);
        earlier_frames<host_features<double>> const none;
        feature_bank<host_features<double>> kept(sites, 2);
        previous_frame_attention<host_features<double>> const attend(none, kept, everywhere);
        std::vector<frame_index> const gap{{0}, {2}};
        call_of<double> with_gap(place, gap, f, module);
        CHECK_THROWS_WITH_AS(attend(with_gap),
                             "previous_frame_attention: frames is 2, expected 1, the frame that comes next",
                             value_error);
        auto const late = frames_from(4, 2);
        call_of<double> too_late(place, late, f, module);
        CHECK_THROWS_WITH_AS(attend(too_late),
                             "previous_frame_attention: frames is 4, expected 0, the frame that comes next",
                             value_error);
    }
    TEST_CASE("an engine that left out the place in a call before is refused in a sentence") {
        matrix_module<double> const module(channels, 2, 11);
        auto const f = random_features<double>({2, tokens, channels}, 12);
        earlier_frames<host_features<double>> earlier;
        earlier.add({sites, 2}, 1);
        feature_bank<host_features<double>> kept(sites, 2);
        previous_frame_attention<host_features<double>> const attend(earlier, kept, everywhere);
        auto const frames = frames_from(1, 2);
        call_of<double> call(place, frames, f, module);
        CHECK_THROWS_WITH_AS(attend(call),
                             "previous_frame_attention: K of the frames before is missing, expected the denoiser to "
                             "run its processor at every site in every call",
                             value_error);
    }
    TEST_CASE("logits are scaled where a frame attends to two others, and there alone") {
        matrix_module<double> const module(channels, 2, 11);
        matrix_module<double> sharper(channels, 2, 11);
        for (std::size_t e = 0; e < sharper.W_Q.size(); ++e) {
            sharper.W_Q.data()[e] *= 2;
        }
        auto const f = random_features<double>({4, tokens, channels}, 12);
        earlier_frames<host_features<double>> const earlier;
        feature_bank<host_features<double>> kept(sites, 2);
        previous_frame_attention<host_features<double>> const attend(
            earlier, kept, everywhere, [](site_index, std::size_t joined) { return static_cast<double>(joined); });
        auto const frames = frames_from(0, 4);
        call_of<double> call(place, frames, f, module);
        auto const F = attend(call);
        for (std::size_t i = 0; i < 4; ++i) {
            auto const joined = joined_rows(f, {0, i > 0 ? i - 1 : 0});
            auto const& weights = i > 1 ? sharper : module;
            CHECK(greatest_difference(F, i, dense_self_attention(weights, joined_rows(f, {i}), joined)) < 1e-12);
        }
    }
}
