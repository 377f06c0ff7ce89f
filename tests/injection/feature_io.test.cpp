// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi as a static graph] Extra inputs and outputs say the same as the callback does.
#include <genrender/injection/feature_io.hpp>
#include "../support/plans_of.hpp"

#include <genrender/injection/host_attention_call.hpp>
#include <genrender/sampling/denoiser.hpp>

#include "dense_equations.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace genrender;
using namespace genrender::testing;

namespace foreign {

struct handle {};

/// A processor of a user's own, in a namespace of its own.
struct no_features {};
template <class Features, class Real>
genrender::feature_inputs<Features, Real> inputs_at(no_features const&, attention_place, std::span<frame_index const>) {
    return {};
}
template <class Features>
void record_features(no_features const&, attention_place, Features const&, Features const&) {}

struct without_inputs {};
void record_features(without_inputs const&, attention_place, handle const&, handle const&);

struct without_outputs {};
template <class Features, class Real>
genrender::feature_inputs<Features, Real> inputs_at(without_outputs const&, attention_place,
                                                    std::span<frame_index const>);

struct with_inputs_of_double : without_outputs {};
template <class Features, class Real>
genrender::feature_inputs<Features, double> inputs_at(with_inputs_of_double const&, attention_place,
                                                      std::span<frame_index const>);
void record_features(with_inputs_of_double const&, attention_place, handle const&, handle const&);

/// An engine that asks for a feature_io_processor.
struct graph_engine : denoiser_archetype<float, handle> {
    template <feature_io_processor<handle, float> Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor) const;
};

} // namespace foreign

TEST_SUITE("injection/feature_io") {
    namespace {

    constexpr std::size_t tokens = 11;
    constexpr std::size_t channels = 6;
    std::vector<frame_index> const KF{{5}, {2}, {0}};
    std::vector<frame_index> const frames{{1}, {2}};
    constexpr attention_place place{{0}, 1};

    template <class Real>
    using call_of = host_attention_call<Real, matrix_module<Real>>;

    /// One self-attention module of a static graph: it knows feature_inputs and nothing of processors.
    template <class Real>
    host_features<Real> run_graph(matrix_module<Real> const& module, host_features<Real> const& f,
                                  feature_inputs<host_features<Real>, Real> const& in) {
        auto const F = host_features<Real>::allocate(f.extents());
        for (std::size_t i = 0; i < f.extents()[0]; ++i) {
            auto const own = joined_rows(f, {i});
            auto joined = own;
            if (in.attends_to_stack) {
                joined.clear();
                for (std::size_t j = 0; j < f.extents()[0]; ++j) {
                    auto const rows = joined_rows(f, {j});
                    joined.insert(joined.end(), rows.begin(), rows.end());
                }
            }
            for (std::size_t k = 0; in.f_KF != nullptr && k < in.f_KF->extents()[0]; ++k) {
                if (k != in.left_out[i]) {
                    auto const rows = joined_rows(*in.f_KF, {k});
                    joined.insert(joined.end(), rows.begin(), rows.end());
                }
            }
            auto out = dense_self_attention(module, own, joined);
            if (in.F_KF != nullptr) {
                out = dense_mix(out, joined_rows(*in.F_KF, {0, 1, 2}), in.rows[i], in.alpha);
            }
            for (std::size_t t = 0; t < tokens; ++t) {
                for (std::size_t c = 0; c < channels; ++c) {
                    F.view()(i, t, c) = static_cast<Real>(out[t][c]);
                }
            }
        }
        return F;
    }

    /// The whole second way in, for one place.
    template <class Real, class Processor>
    host_features<Real> through_graph(matrix_module<Real> const& module, host_features<Real> const& f,
                                      std::span<frame_index const> stack, Processor const& processor) {
        auto const in = inputs_at<host_features<Real>, Real>(processor, place, stack);
        auto const F = run_graph(module, f, in);
        if (in.is_recorded) {
            record_features(processor, place, f, F);
        }
        return F;
    }

    template <class Real, class Processor>
    host_features<Real> through_callback(matrix_module<Real> const& module, host_features<Real> const& f,
                                         std::span<frame_index const> stack, Processor const& processor) {
        call_of<Real> call(place, stack, f, module);
        return processor(call);
    }

    template <class Real>
    bool are_close(host_features<Real> const& a, host_features<Real> const& b) {
        double greatest = 0;
        for (std::size_t i = 0; i < a.extents()[0]; ++i) {
            greatest = std::max(greatest, greatest_difference(a, i, joined_rows(b, {i})));
        }
        return greatest <= (sizeof(Real) == 4 ? 1e-6 : 1e-13);
    }

    /// The greatest difference of two handles' values, in whatever format each keeps them.
    template <class Real>
    double greatest_kept_difference(host_features<Real> const& a, host_features<Real> const& b) {
        REQUIRE(a.extents() == b.extents());
        double greatest = 0;
        a.visit([&](auto const& of_a) {
            b.visit([&](auto const& of_b) {
                for (std::size_t i = 0; i < a.extents()[0]; ++i) {
                    for (std::size_t t = 0; t < a.extents()[1]; ++t) {
                        for (std::size_t c = 0; c < a.extents()[2]; ++c) {
                            auto const difference =
                                static_cast<double>(of_a(i, t, c)) - static_cast<double>(of_b(i, t, c));
                            greatest = std::max(greatest, std::abs(difference));
                        }
                    }
                }
            });
        });
        return greatest;
    }

    bool always(attention_place) { return true; }
    bool never(attention_place) { return false; }

    } // namespace

    TEST_CASE("plain attention and recorder and injector can be driven by a static graph") {
        using foreign::handle;
        CHECK(feature_io_processor<plain_attention, handle, float>);
        CHECK(feature_io_processor<recorder<handle>, handle, float>);
        CHECK(feature_io_processor<injector<handle, float>, handle, float>);
        CHECK(feature_io_processor<injector<int, double> const, int, double>);
        CHECK(feature_io_processor<feature_io_processor_archetype, handle, float>);
        CHECK(feature_io_processor<foreign::no_features, handle, float>);
    }

    TEST_CASE("what lacks one of both functions or speaks of other features is no feature_io_processor") {
        using foreign::handle;
        CHECK_FALSE(feature_io_processor<handle, handle, float>);
        CHECK_FALSE(feature_io_processor<foreign::without_inputs, handle, float>);
        CHECK_FALSE(feature_io_processor<foreign::without_outputs, handle, float>);
        CHECK_FALSE(feature_io_processor<foreign::with_inputs_of_double, handle, float>);
        CHECK_FALSE(feature_io_processor<recorder<handle>, int, float>);
        CHECK_FALSE(feature_io_processor<injector<handle, double>, handle, float>);
    }

    TEST_CASE("an engine that asks for a feature_io_processor is a denoiser") {
        CHECK(denoiser<foreign::graph_engine>);
    }

    TEST_CASE("plain attention asks for nothing") {
        auto const in = inputs_at<int, float>(plain_attention{}, place, frames);
        CHECK_FALSE(in.attends_to_stack);
        CHECK_FALSE(in.is_recorded);
        CHECK(in.f_KF == nullptr);
        CHECK(in.F_KF == nullptr);
        CHECK(in.rows.empty());
    }

    TEST_CASE_TEMPLATE("[GR eq. 3] the recorder gives the same both ways", Real, float, double) {
        matrix_module<Real> const module(channels, 2, 1);
        auto const f = random_features<Real>({KF.size(), tokens, channels}, 2);
        for (auto const extended : {true, false}) {
            feature_bank<host_features<Real>> called_bank(1, 2);
            feature_bank<host_features<Real>> graph_bank(1, 2);
            recorder<host_features<Real>> const called(called_bank, always, extended);
            recorder<host_features<Real>> const graphed(graph_bank, always, extended);
            auto const F = through_callback(module, f, KF, called);
            CHECK(are_close(through_graph(module, f, KF, graphed), F));
            REQUIRE(graph_bank.find(place) != nullptr);
            CHECK(are_close(*graph_bank.find(place)->F_KF, *called_bank.find(place)->F_KF));
            // The graph's own handles are kept, not copies of what they hold.
            CHECK(graph_bank.find(place)->f_KF->view().data() == f.view().data());
        }
    }

    TEST_CASE_TEMPLATE("the recorder keeps the same 16 bits both ways", Real, float, double) {
        matrix_module<Real> const module(channels, 2, 1);
        auto const f = random_features<Real>({KF.size(), tokens, channels}, 2);
        for (auto const storage : {feature_storage::f16, feature_storage::bf16}) {
            feature_bank<host_features<Real>> called_bank(1, 2);
            feature_bank<host_features<Real>> graph_bank(1, 2);
            auto const F =
                through_callback(module, f, KF, recorder<host_features<Real>>(called_bank, always, true, storage));
            // A graph that puts out the F of the callback to the bit.
            record_features(recorder<host_features<Real>>(graph_bank, always, true, storage), place, f, F);
            auto const& called = *called_bank.find(place);
            auto const& graphed = *graph_bank.find(place);
            CHECK(graphed.F_KF->storage() == storage);
            CHECK(greatest_kept_difference(*graphed.F_KF, *called.F_KF) == 0);
            CHECK(greatest_kept_difference(*graphed.F_KF, F) > 0);
            CHECK(greatest_kept_difference(*graphed.f_KF, host_features<Real>::rounded(f.view(), storage)) == 0);

            // The injected pass mixes in the same.
            random_plan<Real> const plan(tokens, KF.size(), 4);
            injection_settings settings;
            settings.pre_attention = false;
            auto const plans = plans_of<Real>(1, frames, [&](site_index, frame_index) { return plan.rows(); });
            auto const stack = random_features<Real>({frames.size(), tokens, channels}, 3);
            injector<host_features<Real>, Real> const inject(called_bank, KF, plans, settings);
            injector<host_features<Real>, Real> const injected(graph_bank, KF, plans, settings);
            CHECK(greatest_kept_difference(through_callback(module, stack, frames, inject),
                                           through_callback(module, stack, frames, injected)) == 0);
        }
    }

    TEST_CASE("a graph whose features cannot be stored in 16 bits is refused when it asks for its inputs") {
        feature_bank<foreign::handle> bank(1, 2);
        recorder<foreign::handle> const pass(bank, always, true, feature_storage::f16);
        CHECK_THROWS_WITH_AS((inputs_at<foreign::handle, float>(pass, place, KF)),
                             "stored_features: storage is of 16 bits, expected feature_storage::same for features "
                             "without `stored`",
                             value_error);
    }

    TEST_CASE("where nothing takes part the recorder asks for nothing and keeps nothing") {
        matrix_module<double> const module(channels, 2, 1);
        auto const f = random_features<double>({KF.size(), tokens, channels}, 2);
        feature_bank<host_features<double>> bank(1, 2);
        recorder<host_features<double>> const pass(bank, never);
        CHECK(are_close(through_graph(module, f, KF, pass), through_callback(module, f, KF, plain_attention{})));
        record_features(pass, place, f, f);
        CHECK(bank.find(place) == nullptr);
    }

    TEST_CASE_TEMPLATE("[GR eq. 5-6] the injector gives the same both ways", Real, float, double) {
        matrix_module<Real> const module(channels, 3, 1);
        auto const f_KF = random_features<Real>({KF.size(), tokens, channels}, 2);
        auto const f = random_features<Real>({frames.size(), tokens, channels}, 3);
        feature_bank<host_features<Real>> called_bank(1, 2);
        feature_bank<host_features<Real>> graph_bank(1, 2);
        through_callback(module, f_KF, KF, recorder<host_features<Real>>(called_bank, always));
        through_graph(module, f_KF, KF, recorder<host_features<Real>>(graph_bank, always));
        std::vector<random_plan<Real>> const plan_of_frame{
            {tokens, KF.size(), 4}, {tokens, KF.size(), 5}, {tokens, KF.size(), 6}};
        auto const plans =
            plans_of<Real>(1, frames, [&](site_index, frame_index frame) { return plan_of_frame[frame.value].rows(); });
        auto const alpha = [](site_index) { return Real(0.6); };

        std::vector<host_features<Real>> results;
        for (auto const pre : {true, false}) {
            for (auto const post : {true, false}) {
                for (auto const keeps : {true, false}) {
                    injection_settings settings;
                    settings.pre_attention = pre;
                    settings.post_attention = post;
                    settings.keeps_own_copy = keeps;
                    injector<host_features<Real>, Real> const called(called_bank, KF, plans, settings, alpha);
                    injector<host_features<Real>, Real> const graphed(graph_bank, KF, plans, settings, alpha);
                    auto const F = through_callback(module, f, frames, called);
                    CHECK(are_close(through_graph(module, f, frames, graphed), F));
                    results.push_back(F);
                }
            }
        }
        // The settings matter: frame 2 is a keyframe, so all but the own copy without pre-attention differ.
        CHECK_FALSE(are_close(results[0], results[1]));
        CHECK_FALSE(are_close(results[0], results[2]));
        CHECK_FALSE(are_close(results[0], results[4]));
        CHECK(are_close(results[4], results[5]));
    }

    TEST_CASE("[GR eq. 5-6] the injector's inputs are what the bank holds and what the plan says") {
        auto const f_KF = random_features<double>({KF.size(), tokens, channels}, 2);
        auto const F_KF = random_features<double>({KF.size(), tokens, channels}, 3);
        feature_bank<host_features<double>> bank(2, 2);
        record_features(recorder<host_features<double>>(bank, always), place, f_KF, F_KF);
        random_plan<double> const plan(tokens, KF.size(), 4);
        injection_settings settings;
        settings.keeps_own_copy = false;
        injector<host_features<double>, double> const pass(
            bank, KF, plans_of<double>(1, frames, [&](site_index, frame_index) { return plan.rows(); }), settings);
        auto const in = inputs_at<host_features<double>, double>(pass, place, frames);
        REQUIRE(in.f_KF != nullptr);
        REQUIRE(in.F_KF != nullptr);
        CHECK(in.f_KF->view().data() == f_KF.view().data());
        CHECK(in.F_KF->view().data() == F_KF.view().data());
        CHECK(in.left_out == std::vector<std::optional<std::size_t>>{std::nullopt, 1});
        REQUIRE(in.rows.size() == 2);
        CHECK(in.rows[1].sources.data() == pass.rows_at(place.site, frames)[1].sources.data());
        CHECK(std::equal(plan.sources.begin(), plan.sources.end(), in.rows[1].sources.begin()));
        CHECK(in.alpha == 0.7);
        CHECK_FALSE(in.attends_to_stack);
        CHECK_FALSE(in.is_recorded);

        auto const elsewhere = inputs_at<host_features<double>, double>(pass, {{1}, 1}, frames);
        CHECK(elsewhere.f_KF == nullptr);
        CHECK(elsewhere.F_KF == nullptr);
        CHECK(elsewhere.rows.empty());
    }

    TEST_CASE("keyframes that were recorded by callbacks are refused in a sentence") {
        matrix_module<double> const module(channels, 1, 1);
        auto const f_KF = random_features<double>({KF.size(), tokens, channels}, 2);
        feature_bank<host_features<double>> bank(1, 2);
        through_callback(module, f_KF, KF, recorder<host_features<double>>(bank, always));
        injector<host_features<double>, double> const pass(bank, KF, {});
        CHECK_THROWS_WITH_AS((inputs_at<host_features<double>, double>(pass, place, frames)),
                             "injector: f_KF is missing, expected keyframes recorded by record_features", value_error);
    }
    TEST_CASE("scales of logits are the same both ways, and refused by an engine that does not say it scales") {
        matrix_module<double> const module(channels, 3, 1);
        auto const f_KF = random_features<double>({KF.size(), tokens, channels}, 2);
        auto const by_count = [](site_index, std::size_t joined) { return static_cast<double>(joined); };
        feature_bank<host_features<double>> bank(1, 2);
        recorder<host_features<double>> const record(bank, always, true, feature_storage::same, by_count);
        using features = host_features<double>;
        auto const scaled = inputs_at<features, double>(record, place, KF, graph_abilities{.scales_logits = true});
        CHECK(scaled.scales == std::vector<double>(3, 3.0));
        CHECK_THROWS_WITH_AS((inputs_at<features, double>(record, place, KF)),
                             "inputs_at: logits are scaled, expected a length_correction of 0 for an engine whose "
                             "graph_abilities do not say scales_logits",
                             value_error);
        record_features(record, place, f_KF, f_KF);
        injection_settings settings;
        settings.keeps_own_copy = false;
        random_plan<double> const plan(tokens, KF.size(), 4);
        auto const plans = plans_of<double>(1, frames, [&](site_index, frame_index) { return plan.rows(); });
        auto const alpha = [](site_index) { return 0.7; };
        injector<features, double> const inject(bank, KF, plans, settings, alpha, by_count);
        auto const in = inputs_for<features, double>(inject, place, frames, {.scales_logits = true});
        CHECK(in.scales == std::vector<double>{4, 3}); // the second frame is a keyframe
        CHECK_THROWS_AS((inputs_at<features, double>(inject, place, frames)), value_error);
        CHECK(demanding_feature_io_processor<injector<features, double>, features, double>);
        CHECK_FALSE(demanding_feature_io_processor<foreign::no_features, foreign::handle, float>);
        CHECK(inputs_for<foreign::handle, float>(foreign::no_features{}, place, frames, {}).scales.empty());
    }

    TEST_CASE("variance to be kept is told to an engine that keeps it, and refused by one that does not say so") {
        using features = host_features<double>;
        auto const f_KF = random_features<double>({KF.size(), tokens, channels}, 2);
        feature_bank<features> bank(1, 2);
        record_features(recorder<features>(bank, always), place, f_KF, f_KF);
        random_plan<double> const plan(tokens, KF.size(), 4);
        auto const plans = plans_of<double>(1, frames, [&](site_index, frame_index) { return plan.rows(); });
        injection_settings settings;
        settings.variance = {variance_target::sources, 1.5};
        injector<features, double> const inject(bank, KF, plans, settings);
        auto const in = inputs_at<features, double>(inject, place, frames, graph_abilities{.keeps_variance = true});
        CHECK(in.variance.target == variance_target::sources);
        CHECK(in.variance.most_gain == 1.5);
        CHECK_THROWS_WITH_AS((inputs_at<features, double>(inject, place, frames)),
                             "inputs_at: variance is to be kept, expected variance_target::none for an engine whose "
                             "graph_abilities do not say keeps_variance",
                             value_error);
        settings.post_attention = false; // Nothing is mixed.
        injector<features, double> const unmixed(bank, KF, plans, settings);
        CHECK_NOTHROW((inputs_at<features, double>(unmixed, place, frames)));
    }
    TEST_CASE("counts of keys are refused by a static graph") {
        using features = host_features<double>;
        feature_bank<features> bank(1, 2);
        auto const f_KF = random_features<double>({KF.size(), tokens, channels}, 2);
        auto const counts = [](site_index, frame_index) { return std::vector<float>(KF.size() * tokens, 0.5F); };
        recorder<features> const record(bank, always, true, feature_storage::same, {}, counts);
        auto const text = "inputs_at: keys are counted, expected counts_points to be false for a static graph";
        CHECK_THROWS_WITH_AS((inputs_at<features, double>(record, place, KF)), text, value_error);
        record_features(record, place, f_KF, f_KF);
        injection_settings settings;
        settings.counts_points = true;
        injector<features, double> const inject(bank, KF, {}, settings);
        CHECK_THROWS_WITH_AS((inputs_at<features, double>(inject, place, frames)), text, value_error);
    }
}
