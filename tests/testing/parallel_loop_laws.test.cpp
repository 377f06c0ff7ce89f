// SPDX-License-Identifier: MIT
// Every law of parallel loops can be broken, and is told by its sentence.
#include <genrender/testing/parallel_loop_laws.hpp>

#include <genrender/core/parallel.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <exception>
#include <mutex>
#include <string>

TEST_SUITE("testing/parallel_loop_laws") {
    using namespace genrender;
    using namespace genrender::testing;

    namespace {

    enum class defect { none, forgets_the_last, goes_on, refuses_loops_inside, swallows_exceptions };

    struct defective_loop {
        defect made = defect::none;
        mutable int depth = 0;

        template <class Body>
        void operator()(std::size_t count, Body const& body) const {
            auto const end = made == defect::forgets_the_last && count > 0 ? count - 1
                             : made == defect::goes_on                     ? count + (count > 100 ? 1 : 0)
                                                                           : count;
            ++depth;
            for (std::size_t i = 0; i < end && !(made == defect::refuses_loops_inside && depth > 1); ++i) {
                try {
                    body(i);
                } catch (std::exception const&) {
                    if (made != defect::swallows_exceptions) {
                        --depth;
                        throw;
                    }
                }
            }
            --depth;
        }
    };

    std::string text_on(defect made) { return check_parallel_loop_laws(defective_loop{made}).text(); }

    } // namespace

    TEST_CASE("the library's loops keep the laws") {
        CHECK(check_parallel_loop_laws(sequential_loop{}).text() == "");
        CHECK(check_parallel_loop_laws(threaded_loop{3}).text() == "");
        CHECK(check_parallel_loop_laws(any_loop(threaded_loop{2})).text() == "");
        CHECK(text_on(defect::none) == "");
    }
    TEST_CASE("each defect is told by the law that it breaks") {
        CHECK(text_on(defect::forgets_the_last)
                  .find("parallel_loop: every index is visited once before the loop returns: found 0 visits of index 0 "
                        "of 1, expected 1\n") == 0);
        CHECK(text_on(defect::goes_on) == "parallel_loop: no other index is visited: found 1 visits of indices beyond "
                                          "1000, expected none\n");
        CHECK(text_on(defect::refuses_loops_inside) ==
              "parallel_loop: a body may run the loop: found 0 visits of index 0 inside index 0, expected 1\n");
        CHECK(text_on(defect::swallows_exceptions) ==
              "parallel_loop: an exception of the body reaches the caller: found no exception, expected that of the "
              "body\n");
    }
}
