// SPDX-License-Identifier: MIT
// Tests of the matrix product of all layers.
#include <genrender/reference/weight_panels.hpp>

#include "small_networks.hpp"

#include <genrender/core/parallel.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

namespace {

template <class Real>
weight_panels<Real> panels_of(stack<Real, 2> const& W) {
    return {W.extent(0), W.extent(1), [&](std::size_t i, std::size_t o) { return W(i, o); }};
}

template <class Real>
std::vector<Real> vector_of(std::size_t size, std::uint64_t seed) {
    auto const values = random_stack<Real, 1>({size}, seed);
    return {values.data(), values.data() + size};
}

} // namespace

TEST_SUITE("reference/weight_panels") {
    TEST_CASE_TEMPLATE("a product with bias and residual agrees with the definition at every size", Real, float,
                       double) {
        for (std::size_t const tokens : {1U, 3U, 4U, 6U, 11U, 12U, 13U, 31U}) {
            for (std::size_t const outputs : {1U, 2U, 5U, 8U, 15U, 16U, 17U, 32U, 33U, 56U}) {
                for (std::size_t const inputs : {1U, 2U, 9U, 40U}) {
                    auto const W = random_stack<Real, 2>({inputs, outputs}, 1);
                    auto const in = random_stack<Real, 2>({tokens, inputs}, 2);
                    auto const residual = random_stack<Real, 2>({tokens, outputs}, 3);
                    auto const bias = vector_of<Real>(outputs, 4);
                    auto const panels = panels_of(W);
                    CHECK(panels.inputs() == inputs);
                    CHECK(panels.outputs() == outputs);
                    stack<Real, 2> expected({tokens, outputs});
                    for (std::size_t t = 0; t < tokens; ++t) {
                        for (std::size_t o = 0; o < outputs; ++o) {
                            double sum = 0;
                            for (std::size_t i = 0; i < inputs; ++i) {
                                sum += static_cast<double>(in(t, i)) * static_cast<double>(W(i, o));
                            }
                            expected(t, o) = static_cast<Real>(sum);
                        }
                    }
                    stack<Real, 2> out({tokens, outputs});
                    panels.multiply(out.view(), token_inputs<Real>::rows_of(in.view()));
                    check_close<Real, 2>(out.view(), expected);
                    for (std::size_t t = 0; t < tokens; ++t) {
                        for (std::size_t o = 0; o < outputs; ++o) {
                            expected(t, o) += bias[o] + residual(t, o);
                        }
                    }
                    panels.multiply(out.view(), token_inputs<Real>::rows_of(in.view()), {bias, residual});
                    check_close<Real, 2>(out.view(), expected);
                    out = residual;
                    panels.multiply(out.view(), token_inputs<Real>::rows_of(in.view()), {bias, out});
                    check_close<Real, 2>(out.view(), expected);
                }
            }
        }
    }

    TEST_CASE_TEMPLATE("an output is the same to the bit whatever else is computed and on any number of threads", Real,
                       float, double) {
        std::size_t const tokens = 2500;
        auto const panels = panels_of(random_stack<Real, 2>({37, 45}, 1));
        auto const in = random_stack<Real, 2>({tokens, 37}, 2);
        stack<Real, 2> whole({tokens, 45});
        panels.multiply(whole.view(), token_inputs<Real>::rows_of(in.view()));
        stack<Real, 2> shared({tokens, 45});
        panels.multiply(shared.view(), token_inputs<Real>::rows_of(in.view()), {}, threaded_loop(3));
        CHECK(std::equal(whole.data(), whole.data() + whole.size(), shared.data()));
        for (auto const& [begin, count] : {std::pair<std::size_t, std::size_t>{0, 1}, {7, 5}, {1000, 23}, {2490, 10}}) {
            stack<Real, 2> part({count, 45});
            panels.multiply(part.view(), token_inputs<Real>::rows_of(in.view().slice(begin, count)));
            for (std::size_t t = 0; t < count; ++t) {
                for (std::size_t o = 0; o < 45; ++o) {
                    REQUIRE(part(t, o) == whole(begin + t, o));
                }
            }
        }
    }

    TEST_CASE_TEMPLATE("rows apart or in reverse order are read where they lie", Real, float, double) {
        auto const W = random_stack<Real, 2>({3, 5}, 1);
        auto const panels = panels_of(W);
        auto const memory = random_stack<Real, 2>({20, 7}, 2);
        strided_view<Real const, 2> const reversed(memory.data() + 19 * 7 + 2, {20, 3}, {-7, 1});
        stack<Real, 2> out({20, 5});
        panels.multiply(out.view(), token_inputs<Real>::rows_of(reversed));
        for (std::size_t t = 0; t < 20; ++t) {
            for (std::size_t o = 0; o < 5; ++o) {
                Real sum = 0;
                for (std::size_t i = 0; i < 3; ++i) {
                    sum += reversed(t, i) * W(i, o);
                }
                REQUIRE(out(t, o) == doctest::Approx(sum).epsilon(1e-4));
            }
        }
    }

    TEST_CASE("inputs of a token may lie in several runs") {
        // A map of 3 x 3 numbers and a kernel of 2 x 2 ones: four sums of four.
        std::vector<float> const map{1, 2, 3, 4, 5, 6, 7, 8, 9};
        weight_panels<float> const ones(4, 1, [](std::size_t, std::size_t) { return 1.0f; });
        stack<float, 2> out({4, 1});
        ones.multiply(out.view(), {map.data(), 2, 1, 3, 2, 2, 3});
        CHECK(out(0, 0) == 12);
        CHECK(out(1, 0) == 16);
        CHECK(out(2, 0) == 24);
        CHECK(out(3, 0) == 28);
    }

    TEST_CASE_TEMPLATE("weights in 16 bits give to the bit what their values give in full width", Real, float, double) {
        for (std::size_t const tokens : {1U, 5U, 12U, 31U}) {
            for (std::size_t const outputs : {1U, 8U, 15U, 33U, 70U}) {
                auto const W = random_stack<Real, 2>({40, outputs}, 1);
                auto const in = random_stack<Real, 2>({tokens, 40}, 2);
                auto const bias = vector_of<Real>(outputs, 4);
                for (auto const storage : {weight_storage::float16, weight_storage::bfloat16}) {
                    auto const rounded = [&](std::size_t i, std::size_t o) {
                        auto const weight = static_cast<float>(W(i, o));
                        return static_cast<Real>(storage == weight_storage::float16
                                                     ? float_of_half(half_of_float(weight))
                                                     : float_of_bfloat16(bfloat16_of_float(weight)));
                    };
                    weight_panels<Real> const narrow(
                        40, outputs, [&](auto i, auto o) { return W(i, o); }, storage);
                    weight_panels<Real> const wide(40, outputs, rounded);
                    auto const kept = std::is_same_v<Real, float> ? std::size_t{2} : sizeof(Real);
                    CHECK(narrow.bytes() * sizeof(Real) == wide.bytes() * kept);
                    stack<Real, 2> out({tokens, outputs});
                    stack<Real, 2> expected({tokens, outputs});
                    narrow.multiply(out.view(), token_inputs<Real>::rows_of(in.view()), {bias, {}});
                    wide.multiply(expected.view(), token_inputs<Real>::rows_of(in.view()), {bias, {}});
                    CHECK(std::equal(out.data(), out.data() + out.size(), expected.data()));
                }
            }
        }
    }

    TEST_CASE("the least and the greatest numbers of 16 bits are widened as they are") {
        std::vector<float> const weights{0x1p-24f, -0x1p-24f, 0x1.ff8p-15f, 65504.0f, -65504.0f, 0.0f};
        weight_panels<float> const panels(
            1, weights.size(), [&](auto, auto o) { return weights[o]; }, weight_storage::float16);
        stack<float, 2> in({13, 1});
        std::fill_n(in.data(), in.size(), 2.0f);
        stack<float, 2> out({13, weights.size()});
        panels.multiply(out.view(), token_inputs<float>::rows_of(in.view()));
        for (std::size_t t = 0; t < 13; ++t) {
            for (std::size_t o = 0; o < weights.size(); ++o) {
                CHECK(out(t, o) == 2 * weights[o]);
            }
        }
    }
}
