// SPDX-License-Identifier: MIT
// [GR sec. 3.1] Which types run in place of a self-attention module.
#include <genrender/attention/attention_processor.hpp>
#include <genrender/attention/plain_attention.hpp>
#include <genrender/injection/host_attention_call.hpp>
#include <genrender/injection/injector.hpp>
#include <genrender/keyframes/recorder.hpp>

#include <doctest/doctest.h>

#include "support/analytic_denoiser.hpp"

using namespace genrender;

namespace {

struct handle {};
using least = attention_call_archetype<handle, float>;
using host_call = host_attention_call<float, genrender::testing::identity_projections>;

struct gives_nothing {
    template <class Call>
    void operator()(Call&) const {}
};
struct takes_nothing {
    handle operator()() const;
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
        CHECK(attention_processor<attention_processor_archetype, least>);
        CHECK(attention_processor<plain_attention, least>);
        CHECK(attention_processor<plain_attention const, least>);
        CHECK(attention_processor<recorder<handle>, least>);
        CHECK(attention_processor<recorder<handle> const, least>);
        CHECK(attention_processor<injector<handle, float>, least>);
        CHECK(attention_processor<injector<handle, float> const, least>);
        CHECK(attention_processor<plain_attention, host_call>);
        CHECK(attention_processor<recorder<host_features<float>>, host_call>);
        CHECK(attention_processor<injector<host_features<float>, float>, host_call>);
    }

    TEST_CASE("features of another engine are refused") {
        CHECK_FALSE(attention_processor<recorder<handle>, host_call>);
        CHECK_FALSE(attention_processor<injector<host_features<double>, double>, host_call>);
        CHECK_FALSE(attention_processor<knows_one_engine, least>);
        CHECK(attention_processor<knows_one_engine, host_call>);
    }

    TEST_CASE("what returns nothing or takes no call is no processor") {
        CHECK_FALSE(attention_processor<gives_nothing, least>);
        CHECK_FALSE(attention_processor<takes_nothing, least>);
        CHECK_FALSE(attention_processor<handle, least>);
        CHECK_FALSE(attention_processor<plain_attention, handle>);
    }

    TEST_CASE("a processor may change itself") {
        CHECK(attention_processor<changes_itself, host_call>);
        CHECK_FALSE(attention_processor<changes_itself const, host_call>);
    }
}
