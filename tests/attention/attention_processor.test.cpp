// SPDX-License-Identifier: MIT
// [GR sec. 3.1] Which types run in place of a self-attention module.
#include <genrender/attention/attention_processor.hpp>
#include <genrender/attention/plain_attention.hpp>
#include <genrender/injection/host_attention_call.hpp>
#include <genrender/injection/injector.hpp>
#include <genrender/keyframes/recorder.hpp>
#include "../support/plans_of.hpp"

#include <doctest/doctest.h>

#include <genrender/testing/attention_processor_laws.hpp>

using namespace genrender;

namespace {

struct some_features {};
using least_call = attention_call_archetype<some_features, float>;
using host_call = host_attention_call<float, genrender::testing::identity_projections>;

struct gives_nothing {
    template <class Call>
    void operator()(Call&) const {}
};
struct takes_nothing {
    some_features operator()() const;
};
struct changes_itself {
    int calls = 0;
    template <attention_call Call>
    typename Call::features_type operator()(Call& call) {
        ++calls;
        return call.f();
    }
};
struct knows_one_engine {
    host_features<float> operator()(host_call& call) const { return call.f(); }
};

} // namespace

TEST_SUITE("attention/attention_processor") {
    TEST_CASE("the library's processors are processors of the least call and of the host's") {
        CHECK(attention_processor<attention_processor_archetype, least_call>);
        CHECK(attention_processor<plain_attention, least_call>);
        CHECK(attention_processor<plain_attention const, least_call>);
        CHECK(attention_processor<recorder<some_features>, least_call>);
        CHECK(attention_processor<recorder<some_features> const, least_call>);
        CHECK(attention_processor<injector<some_features, float>, least_call>);
        CHECK(attention_processor<injector<some_features, float> const, least_call>);
        CHECK(attention_processor<plain_attention, host_call>);
        CHECK(attention_processor<recorder<host_features<float>>, host_call>);
        CHECK(attention_processor<injector<host_features<float>, float>, host_call>);
    }

    TEST_CASE("features of another engine are refused") {
        CHECK_FALSE(attention_processor<recorder<some_features>, host_call>);
        CHECK_FALSE(attention_processor<injector<host_features<double>, double>, host_call>);
        CHECK_FALSE(attention_processor<knows_one_engine, least_call>);
        CHECK(attention_processor<knows_one_engine, host_call>);
    }

    TEST_CASE("what returns nothing or takes no call is no processor") {
        CHECK_FALSE(attention_processor<gives_nothing, least_call>);
        CHECK_FALSE(attention_processor<takes_nothing, least_call>);
        CHECK_FALSE(attention_processor<some_features, least_call>);
        CHECK_FALSE(attention_processor<plain_attention, some_features>);
    }

    TEST_CASE("a processor may change itself") {
        CHECK(attention_processor<changes_itself, host_call>);
        CHECK_FALSE(attention_processor<changes_itself const, host_call>);
    }

    TEST_CASE_TEMPLATE("plain attention and the recorder and the injector keep the laws", Real, float, double) {
        using features = host_features<Real>;
        std::vector<frame_index> const KF{{2}, {0}};
        std::vector<frame_index> const frames{{0}, {1}, {2}};
        std::uint32_t const sites = 3;

        plain_attention const plain;
        CHECK(testing::check_attention_processor_laws<Real>(plain, frames, 5, 4, sites).text() == "");

        // Site 1 takes no part.
        feature_bank<features> bank(sites, 2);
        recorder<features> const record(bank, [](attention_place place) { return place.site.value != 1; });
        CHECK(testing::check_attention_processor_laws<Real>(record, KF, 5, 4, sites).text() == "");

        // Token t mixes both keyframes' tokens t, the last token nothing.
        std::vector<std::uint32_t> const offsets{0, 2, 4, 6, 8, 8};
        std::vector<std::uint32_t> const sources{0, 5, 1, 6, 2, 7, 3, 8};
        std::vector<Real> const weights{Real(0.75), Real(0.25), Real(0.75), Real(0.25),
                                        Real(0.75), Real(0.25), Real(0.75), Real(0.25)};
        injector<features, Real> const inject(bank, KF,
                                              testing::plans_of<Real>(sites, frames, [&](site_index, frame_index) {
                                                  return sparse_rows<Real>{offsets, sources, weights};
                                              }));
        CHECK(testing::check_attention_processor_laws<Real>(inject, frames, 5, 4, sites).text() == "");
    }

    TEST_CASE("a processor may say where it is plain and nothing is known of one that does not") {
        struct plain_at_one {
            bool is_plain_at(attention_place place) const { return place.site.value == 1; }
        };
        struct silent {};
        CHECK(partly_plain_processor<plain_at_one>);
        CHECK_FALSE(partly_plain_processor<silent>);
        CHECK(is_plain_at(plain_at_one{}, {{1}, 0}));
        CHECK_FALSE(is_plain_at(plain_at_one{}, {{2}, 0}));
        CHECK_FALSE(is_plain_at(silent{}, {{1}, 0}));
        CHECK(is_plain_at(plain_attention{}, {{2}, 1}));
    }
}
