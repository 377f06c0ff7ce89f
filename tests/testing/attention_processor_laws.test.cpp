// SPDX-License-Identifier: MIT
// [GR sec. 3.1] Every law of attention processors can be broken, and is told by its sentence.
#include <genrender/testing/attention_processor_laws.hpp>

#include "broken_laws.hpp"

#include <genrender/attention/plain_attention.hpp>

#include <doctest/doctest.h>

#include <atomic>
#include <cstddef>
#include <string>
#include <vector>

TEST_SUITE("testing/attention_processor_laws") {
    using namespace genrender;
    using namespace genrender::testing;

    namespace {

    using names = std::vector<std::string>;
    std::vector<frame_index> const two_frames{{3}, {0}};

    template <class Processor>
    law_report report_of(Processor const& processor) {
        return check_attention_processor_laws<double>(processor, two_frames, 3, 2, 2);
    }

    struct drops_a_token {
        template <attention_call Call>
        typename Call::features_type operator()(Call& call) const {
            auto extents = call.f().extents();
            --extents[1];
            return Call::features_type::allocate(extents);
        }
    };
    struct writes_into_f {
        template <attention_call Call>
        typename Call::features_type operator()(Call& call) const {
            auto const F = plain_attention{}(call);
            call.f().view()(1, 2, 0) = 5;
            return F;
        }
    };
    struct counts_calls {
        mutable std::atomic<int> calls{0};
        template <attention_call Call>
        typename Call::features_type operator()(Call& call) const {
            auto const F = plain_attention{}(call);
            F.view()(0, 0, 1) += ++calls;
            return F;
        }
    };
    struct returns_f {
        bool says_plain = false;
        template <attention_call Call>
        typename Call::features_type operator()(Call& call) const {
            return call.place().site.value == 0 ? plain_attention{}(call) : call.f();
        }
        bool is_plain_at(attention_place place) const { return says_plain || place.site.value == 0; }
    };

    } // namespace

    TEST_CASE("plain attention keeps the laws, and so does a processor that says where it is plain") {
        CHECK(report_of(plain_attention{}).text() == "");
        CHECK(report_of(returns_f{}).text() == "");
    }
    TEST_CASE("each mistake is told by the law that it breaks") {
        CHECK(report_of(drops_a_token{}).text() == "attention_processor: F has the extents of f: found [2, 2, 2] at "
                                                   "site 0 of branch 0, expected [2, 3, 2]\n");
        auto const report = report_of(writes_into_f{});
        CHECK(broken_laws(report).front() == "attention_processor: f is not changed");
        CHECK(report.violations.front().find("found f of site 0 of branch 0, f[1, 2, 0] = 5, expected ") !=
              std::string::npos);
        CHECK(broken_laws(report_of(counts_calls{})) ==
              names{"attention_processor: places may run at the same time, and again"});
        CHECK(broken_laws(report_of(returns_f{true})) ==
              names{"partly_plain_processor: is_plain_at tells where it does what plain_attention does"});
    }
}
