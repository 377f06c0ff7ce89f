// SPDX-License-Identifier: MIT
// [GR eq. 1] Softmax attention by hand, against a naive softmax, over blocks, through any strides.
#include <genrender/attention/scaled_dot_product.hpp>

#include <doctest/doctest.h>

#include "support/counted_memory.hpp"
#include <genrender/testing/random_stack.hpp>

#include <genrender/core/linalg.hpp>
#include <genrender/core/parallel.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

using namespace genrender;
using genrender::testing::random_stack;

TEST_SUITE("attention/scaled_dot_product") {
    namespace {

    template <class Real>
    using blocks_of = std::vector<key_value_view<Real>>;

    template <class Real>
    constexpr double tolerance = sizeof(Real) == 4 ? 2e-6 : 1e-14;

    /// Eq. 1 as it stands, in double precision: all logits of a query less the greatest, exponentials over their sum.
    template <class Real>
    stack<double, 2> naive(strided_view<Real const, 2> Q, blocks_of<Real> const& blocks, std::size_t heads) {
        stack<double, 2> F({Q.extent(0), Q.extent(1)});
        auto const d = Q.extent(1) / heads;
        for (std::size_t q = 0; q < Q.extent(0); ++q) {
            for (std::size_t h = 0; h < heads; ++h) {
                std::vector<double> logits;
                std::vector<double> counts;
                for (auto const& block : blocks) {
                    for (std::size_t k = 0; k < block.K.extent(0); ++k) {
                        counts.push_back(block.counts.extent(0) > 0 ? static_cast<double>(block.counts(k)) : 1);
                        double product = 0;
                        for (std::size_t c = h * d; c < (h + 1) * d; ++c) {
                            product += static_cast<double>(Q(q, c)) * static_cast<double>(block.K(k, c));
                        }
                        logits.push_back(product / std::sqrt(static_cast<double>(d)));
                    }
                }
                auto const greatest = *std::max_element(logits.begin(), logits.end());
                double sum = 0;
                for (std::size_t k = 0; k < logits.size(); ++k) {
                    logits[k] = counts[k] * std::exp(logits[k] - greatest);
                    sum += logits[k];
                }
                std::size_t at = 0;
                for (auto const& block : blocks) {
                    for (std::size_t k = 0; k < block.K.extent(0); ++k, ++at) {
                        for (std::size_t c = h * d; c < (h + 1) * d; ++c) {
                            F(q, c) += logits[at] / sum * static_cast<double>(block.V(k, c));
                        }
                    }
                }
            }
        }
        return F;
    }

    template <class A, class B>
    double largest_difference(A const& a, B const& b) {
        double largest = 0;
        for (std::size_t t = 0; t < a.extent(0); ++t) {
            for (std::size_t c = 0; c < a.extent(1); ++c) {
                auto const difference = std::abs(static_cast<double>(a(t, c)) - static_cast<double>(b(t, c)));
                // A NaN must not pass as small.
                largest =
                    std::isnan(difference) ? std::numeric_limits<double>::infinity() : std::max(largest, difference);
            }
        }
        return largest;
    }

    template <class Real>
    stack<Real, 2> attention(stack<Real, 2> const& Q, blocks_of<Real> const& blocks, std::size_t heads) {
        stack<Real, 2> F({Q.extent(0), Q.extent(1)});
        // What stood in F before must not matter.
        std::fill(F.data(), F.data() + F.size(), std::numeric_limits<Real>::quiet_NaN());
        scaled_dot_product(F.view(), Q, blocks, heads);
        return F;
    }

    } // namespace

    TEST_CASE_TEMPLATE("[GR eq. 1] two tokens by hand", Real, float, double) {
        // Logits ln 3 and 0 weigh V = 4 and 8 by 3/4 and 1/4; logits 0 and 0 by halves.
        stack<Real, 2> Q({2, 1});
        stack<Real, 2> K({2, 1});
        stack<Real, 2> V({2, 1});
        Q(0, 0) = std::log(Real{3});
        K(0, 0) = 1;
        V(0, 0) = 4;
        V(1, 0) = 8;
        auto const F = attention<Real>(Q, {{K, V}}, 1);
        CHECK(F(0, 0) == doctest::Approx(5).epsilon(1e-6));
        CHECK(F(1, 0) == doctest::Approx(6).epsilon(1e-6));
    }

    TEST_CASE_TEMPLATE("[GR eq. 1] logits are divided by the root of the channels of one head", Real, float, double) {
        // d = 4: the product 2 ln 3 becomes the logit ln 3. Head 1 attends by its own channels,
        // with weights 1/4 and 3/4.
        stack<Real, 2> Q({1, 8});
        stack<Real, 2> K({2, 8});
        stack<Real, 2> V({2, 8});
        Q(0, 0) = 2 * std::log(Real{3});
        K(0, 0) = 1;
        Q(0, 7) = 2 * std::log(Real{3});
        K(1, 7) = 1;
        for (std::size_t c = 0; c < 8; ++c) {
            V(0, c) = 4;
            V(1, c) = 8;
        }
        auto const F = attention<Real>(Q, {{K, V}}, 2);
        for (std::size_t c = 0; c < 4; ++c) {
            CHECK(F(0, c) == doctest::Approx(5).epsilon(1e-6));
            CHECK(F(0, c + 4) == doctest::Approx(7).epsilon(1e-6));
        }
    }

    TEST_CASE_TEMPLATE("[GR eq. 1] it agrees with a naive softmax in all shapes", Real, float, double) {
        struct shape {
            std::size_t queries;
            std::vector<std::size_t> keys;
            std::size_t channels;
            std::size_t heads;
        };
        std::vector<shape> const shapes{
            {1, {1}, 1, 1},                // the smallest
            {3, {5}, 7, 7},                // one channel a head
            {5, {1, 1, 1}, 6, 2},          // blocks of one token
            {63, {255}, 8, 1},             // one short of a tile
            {64, {256}, 8, 2},             // a tile
            {65, {257}, 8, 4},             // one over
            {130, {513}, 5, 1},            // several tiles and a rest
            {9, {300, 1, 17, 256}, 12, 3}, // ragged blocks
            {4, {0, 3, 0}, 4, 1},          // blocks without tokens
            {17, {40}, 40, 1},             // a head of SD's width
            {81, {97, 95}, 86, 2},         // either side of a tile of keys
            {3, {500}, 50, 1}              // less than a register of queries
        };
        std::uint64_t seed = 0;
        for (auto const& s : shapes) {
            CAPTURE(s.queries);
            CAPTURE(s.channels);
            auto const Q = random_stack<Real, 2>({s.queries, s.channels}, ++seed);
            std::vector<stack<Real, 2>> memory;
            for (auto const keys : s.keys) {
                memory.push_back(random_stack<Real, 2>({keys, s.channels}, ++seed));
                memory.push_back(random_stack<Real, 2>({keys, s.channels}, ++seed));
            }
            blocks_of<Real> blocks;
            for (std::size_t b = 0; b < s.keys.size(); ++b) {
                blocks.push_back({memory[2 * b], memory[2 * b + 1]});
            }
            CHECK(largest_difference(attention<Real>(Q, blocks, s.heads), naive<Real>(Q.view(), blocks, s.heads)) <
                  tolerance<Real>);
        }
    }

    TEST_CASE_TEMPLATE("logits of 10000 of either sign do not overflow", Real, float, double) {
        stack<Real, 2> Q({3, 1});
        stack<Real, 2> K({3, 1});
        stack<Real, 2> V({3, 1});
        Q(0, 0) = 1e4F;
        Q(1, 0) = -1e4F;
        Q(2, 0) = 0;
        K(0, 0) = 1;
        K(1, 0) = -1;
        K(2, 0) = 1;
        V(0, 0) = 2;
        V(1, 0) = 5;
        V(2, 0) = 4;
        auto const F = attention<Real>(Q, {{K, V}}, 1);
        CHECK(F(0, 0) == doctest::Approx(3));
        CHECK(F(1, 0) == doctest::Approx(5));
        CHECK(F(2, 0) == doctest::Approx(11.0 / 3));
        // All logits alike and far below 0, and a larger one that arrives in a later block.
        stack<Real, 2> low({2, 1});
        low(0, 0) = low(1, 0) = -1;
        stack<Real, 2> V_low({2, 1});
        V_low(0, 0) = 10;
        V_low(1, 0) = 20;
        CHECK(attention<Real>(Q, {{low, V_low}}, 1)(0, 0) == doctest::Approx(15));
        CHECK(attention<Real>(Q, {{low, V_low}, {K, V}}, 1)(0, 0) == doctest::Approx(3));
        CHECK(attention<Real>(Q, {{K, V}, {low, V_low}}, 1)(0, 0) == doctest::Approx(3));
    }

    TEST_CASE_TEMPLATE("keys that grow with every run rescale what was summed before", Real, float, double) {
        // 600 keys are three runs; the running maximum rises in each of them.
        stack<Real, 2> Q({2, 1});
        Q(0, 0) = 1;
        Q(1, 0) = -1;
        stack<Real, 2> K({600, 1});
        auto const V = random_stack<Real, 2>({600, 1}, 4);
        for (std::size_t k = 0; k < 600; ++k) {
            K(k, 0) = static_cast<Real>(k) / 50;
        }
        blocks_of<Real> const blocks{{K, V}};
        CHECK(largest_difference(attention<Real>(Q, blocks, 1), naive<Real>(Q.view(), blocks, 1)) < tolerance<Real>);
    }

    TEST_CASE_TEMPLATE("blocks stand for their concatenation and their order for rounding alone", Real, float, double) {
        auto const Q = random_stack<Real, 2>({19, 6}, 1);
        auto const K = random_stack<Real, 2>({300, 6}, 2);
        auto const V = random_stack<Real, 2>({300, 6}, 3);
        auto const part = [&](std::size_t begin, std::size_t count) {
            return key_value_view<Real>{K.view().slice(begin, count), V.view().slice(begin, count)};
        };
        auto const whole = attention<Real>(Q, {{K, V}}, 2);
        CHECK(largest_difference(attention<Real>(Q, {part(0, 7), part(7, 200), part(207, 93)}, 2), whole) <
              tolerance<Real>);
        CHECK(largest_difference(attention<Real>(Q, {part(207, 93), part(0, 7), part(7, 200)}, 2), whole) <
              tolerance<Real>);
        // A cut between two runs of keys changes nothing at all.
        CHECK(largest_difference(attention<Real>(Q, {part(0, 256), part(256, 44)}, 2), whole) == 0);
    }

    TEST_CASE_TEMPLATE("[GR eq. 1] many keys do not add up errors", Real, float, double) {
        // Values around 1, whose sums only grow. In double the sums of the plain reference are the worse ones.
        constexpr auto bound = sizeof(Real) == 4 ? tolerance<Real> : 1e-13;
        auto const Q = random_stack<Real, 2>({3, 40}, 1);
        auto const K = random_stack<Real, 2>({9 * 4096, 40}, 2);
        auto V = random_stack<Real, 2>({9 * 4096, 40}, 3);
        std::for_each(V.data(), V.data() + V.size(), [](Real& value) { value = 1 + value / 4; });
        blocks_of<Real> const blocks{{K, V}};
        CHECK(largest_difference(attention<Real>(Q, blocks, 1), naive<Real>(Q.view(), blocks, 1)) < bound);
    }

    TEST_CASE_TEMPLATE("logits within 10000 of either sign find the greatest key", Real, float, double) {
        // One query a sign; keys that rise, fall and jump by more than any headroom.
        for (auto const order : {0, 1, 2}) {
            stack<Real, 2> Q({2, 1});
            Q(0, 0) = 1;
            Q(1, 0) = -1;
            stack<Real, 2> K({401, 1});
            stack<Real, 2> V({401, 1});
            for (std::size_t k = 0; k < 401; ++k) {
                auto const at = order == 0 ? k : (order == 1 ? 400 - k : k * 178 % 401);
                K(k, 0) = static_cast<Real>(at) * 50 - Real{1e4};
                V(k, 0) = static_cast<Real>(at);
            }
            auto const F = attention<Real>(Q, {{K, V}}, 1);
            CHECK(F(0, 0) == doctest::Approx(400));
            CHECK(F(1, 0) == doctest::Approx(0));
        }
    }

    TEST_CASE_TEMPLATE("a query depends on no other and on no number of threads", Real, float, double) {
        auto const Q = random_stack<Real, 2>({1100, 6}, 1);
        auto const K = random_stack<Real, 2>({130, 6}, 2);
        auto const V = random_stack<Real, 2>({130, 6}, 3);
        blocks_of<Real> const blocks{{K, V}};
        auto const whole = attention<Real>(Q, blocks, 2);
        for (auto const count : std::vector<std::size_t>{1, 33, 64, 200}) {
            for (std::size_t first = 0; first < 200; first += count) {
                auto const part = std::min(count, 200 - first);
                stack<Real, 2> F({part, 6});
                scaled_dot_product(F.view(), Q.view().slice(first, part), blocks, 2);
                CHECK(largest_difference(F, whole.view().slice(first, part)) == 0);
            }
        }
        for (auto const threads : std::vector<std::size_t>{1, 2, 5}) {
            stack<Real, 2> F(Q.extents());
            scaled_dot_product(F.view(), Q, blocks, 2, threaded_loop(threads));
            CHECK(largest_difference(F, whole) == 0);
        }
    }

    TEST_CASE_TEMPLATE("queries of one tile read keys of ragged blocks where they lie", Real, float, double) {
        // The same queries among more than one tile have their keys copied.
        auto const Q = random_stack<Real, 2>({200, 38}, 1);
        auto const K = random_stack<Real, 2>({150, 76}, 2);
        auto const V = random_stack<Real, 2>({150, 76}, 3);
        auto const part = [](stack<Real, 2> const& rows, std::size_t begin, std::size_t count) {
            // Every other half of a row, so that neither rows nor blocks follow each other.
            return strided_view<Real const, 2>(rows.data() + 76 * begin + 38, {count, 38}, {76, 1});
        };
        blocks_of<Real> blocks;
        for (auto const& [begin, count] : std::vector<std::array<std::size_t, 2>>{{0, 1}, {1, 61}, {62, 0}, {62, 88}}) {
            blocks.push_back({part(K, begin, count), part(V, begin, count)});
        }
        auto const whole = attention<Real>(Q, blocks, 2);
        CHECK(largest_difference(whole, naive<Real>(Q.view(), blocks, 2)) < tolerance<Real>);
        for (auto const count : std::vector<std::size_t>{1, 8, 16, 17, 31, 64}) {
            stack<Real, 2> F({count, 38});
            scaled_dot_product(F.view(), Q.view().slice(7, count), blocks, 2);
            CHECK(largest_difference(F, whole.view().slice(7, count)) == 0);
        }
    }

    TEST_CASE_TEMPLATE("keys and values in 16 bits attend as the numbers they store", Real, float, double) {
        auto const Q = random_stack<Real, 2>({19, 14}, 1);
        auto const K = random_stack<Real, 2>({150, 14}, 2);
        auto const V = random_stack<Real, 2>({150, 14}, 3);
        auto const expect_equal = [&]<class Stored>(Stored) {
            stack<Stored, 2> K_stored(K.extents());
            stack<Stored, 2> V_stored(V.extents());
            stack<Real, 2> K_read(K.extents());
            stack<Real, 2> V_read(V.extents());
            for (std::size_t i = 0; i < K.size(); ++i) {
                K_stored.data()[i] = static_cast<Stored>(static_cast<float>(K.data()[i]));
                V_stored.data()[i] = static_cast<Stored>(static_cast<float>(V.data()[i]));
                K_read.data()[i] = static_cast<Real>(static_cast<float>(K_stored.data()[i]));
                V_read.data()[i] = static_cast<Real>(static_cast<float>(V_stored.data()[i]));
            }
            auto const expected = attention<Real>(Q, {{K_read, V_read}, {K, V}}, 2);
            CHECK(largest_difference(attention<Real>(Q, {{K_stored, V_stored}, {K, V}}, 2), expected) == 0);
            // Keys may be stored otherwise than values, and lie at any strides.
            std::vector<Stored> columns(14 * 150);
            strided_view<Stored, 2> const across(columns.data(), {150, 14}, {1, 150});
            copy(across, K_stored.view());
            CHECK(largest_difference(attention<Real>(Q, {{across, V_read}, {K, V}}, 2), expected) == 0);
        };
        expect_equal(float16{});
        expect_equal(bfloat16{});
    }

    TEST_CASE_TEMPLATE("a merged key that counts for equal ones weighs like all of them", Real, float, double) {
        auto const Q = random_stack<Real, 2>({70, 8}, 1);
        auto const K = random_stack<Real, 2>({60, 8}, 2);
        auto const V = random_stack<Real, 2>({60, 8}, 3);
        // Key k stands k % 4 + 1 times in the full sequence.
        std::vector<Real> counts;
        std::vector<std::size_t> rows;
        for (std::size_t k = 0; k < 60; ++k) {
            counts.push_back(static_cast<Real>(k % 4 + 1));
            rows.insert(rows.end(), k % 4 + 1, k);
        }
        stack<Real, 2> K_full({rows.size(), 8});
        stack<Real, 2> V_full({rows.size(), 8});
        for (std::size_t i = 0; i < rows.size(); ++i) {
            copy(K_full.view()[i], K.view()[rows[i]]);
            copy(V_full.view()[i], V.view()[rows[i]]);
        }
        auto const own = random_stack<Real, 2>({11, 8}, 4);
        blocks_of<Real> merged{{own, own}, {K, V}};
        merged[1].counts = {counts.data(), {60}};
        auto const F = attention<Real>(Q, merged, 2);
        CHECK(largest_difference(F, attention<Real>(Q, {{own, own}, {K_full, V_full}}, 2)) < tolerance<Real>);
        CHECK(largest_difference(F, naive<Real>(Q.view(), merged, 2)) < tolerance<Real>);
        // Counts of 1 are no counts, to the last bit.
        std::vector<Real> const ones(60, Real{1});
        merged[1].counts = {ones.data(), {60}};
        CHECK(largest_difference(attention<Real>(Q, merged, 2), attention<Real>(Q, {{own, own}, {K, V}}, 2)) == 0);
    }

    TEST_CASE_TEMPLATE("a key that is not a number makes none of it", Real, float, double) {
        auto const Q = random_stack<Real, 2>({2, 4}, 1);
        auto K = random_stack<Real, 2>({20, 4}, 2);
        auto const V = random_stack<Real, 2>({20, 4}, 3);
        K(13, 0) = std::numeric_limits<Real>::quiet_NaN();
        CHECK(std::isnan(attention<Real>(Q, {{K, V}}, 1)(1, 2)));
        CHECK_FALSE(std::isnan(attention<Real>(Q, {{K.view().slice(0, 13), V.view().slice(0, 13)}}, 1)(1, 2)));
    }

    TEST_CASE_TEMPLATE("the same block twice weighs like once", Real, float, double) {
        auto const Q = random_stack<Real, 2>({5, 4}, 1);
        auto const K = random_stack<Real, 2>({9, 4}, 2);
        auto const V = random_stack<Real, 2>({9, 4}, 3);
        CHECK(largest_difference(attention<Real>(Q, {{K, V}, {K, V}}, 1), attention<Real>(Q, {{K, V}}, 1)) <
              tolerance<Real>);
    }

    TEST_CASE("a result is a mean of values") {
        auto const Q = random_stack<double, 2>({33, 3}, 1);
        auto const K = random_stack<double, 2>({50, 3}, 2);
        auto const V = random_stack<double, 2>({50, 3}, 3);
        auto const F = attention<double>(Q, {{K, V}}, 3);
        for (std::size_t c = 0; c < 3; ++c) {
            double least = V(0, c);
            double greatest = V(0, c);
            for (std::size_t k = 0; k < 50; ++k) {
                least = std::min(least, V(k, c));
                greatest = std::max(greatest, V(k, c));
            }
            for (std::size_t t = 0; t < 33; ++t) {
                CHECK(F(t, c) > least);
                CHECK(F(t, c) < greatest);
            }
        }
    }

    TEST_CASE_TEMPLATE("views of any strides give what contiguous ones give", Real, float, double) {
        constexpr std::size_t tokens = 21;
        constexpr std::size_t channels = 6;
        auto const Q = random_stack<Real, 2>({tokens, channels}, 1);
        auto const K = random_stack<Real, 2>({tokens, channels}, 2);
        auto const V = random_stack<Real, 2>({tokens, channels}, 3);
        auto const expected = attention<Real>(Q, {{K, V}}, 2);
        auto const NaN = std::numeric_limits<Real>::quiet_NaN();
        auto const s_tokens = static_cast<std::ptrdiff_t>(tokens);

        struct layout {
            std::array<std::ptrdiff_t, 2> strides;
            std::ptrdiff_t begin;
            std::size_t size;
        };
        std::vector<layout> const layouts{
            {{1, s_tokens}, 0, tokens * channels},          // channel-major
            {{10, 1}, 3, tokens * 10 + 3},                  // rows of a wider block
            {{-10, 1}, 10 * (s_tokens - 1), tokens * 10},   // rows from the last to the first
            {{12, 2}, 1, tokens * 12 + 1},                  // every other element
            {{-6, -1}, s_tokens * 6 - 1, tokens * channels} // backwards
        };
        for (auto const& in : layouts) {
            for (auto const& out : layouts) {
                CAPTURE(in.strides[0]);
                CAPTURE(out.strides[0]);
                // What lies between the elements of a view is not ours to read or write.
                std::vector<std::vector<Real>> memory(4, std::vector<Real>(std::max(in.size, out.size), NaN));
                auto const placed = [&](std::size_t which, layout const& l, stack<Real, 2> const* values) {
                    strided_view<Real, 2> const view(memory[which].data() + l.begin, {tokens, channels}, l.strides);
                    if (values != nullptr) {
                        copy(view, *values);
                    }
                    return view;
                };
                auto const q = placed(0, in, &Q);
                blocks_of<Real> const blocks{{placed(1, in, &K), placed(2, in, &V)}};
                auto const F = placed(3, out, nullptr);
                scaled_dot_product(F, q, blocks, 2);
                CHECK(largest_difference(F, expected) < tolerance<Real>);
                auto const written =
                    std::count_if(memory[3].begin(), memory[3].end(), [](Real x) { return !std::isnan(x); });
                CHECK(written == static_cast<std::ptrdiff_t>(tokens * channels));
            }
        }
    }

    TEST_CASE("keys repeated with stride 0 weigh alike") {
        auto const Q = random_stack<double, 2>({3, 2}, 1);
        auto const V = random_stack<double, 2>({4, 2}, 3);
        std::vector<double> const key{0.3, -2};
        strided_view<double const, 2> const K(key.data(), {4, 2}, {0, 1});
        auto const F = attention<double>(Q, {{K, V}}, 1);
        CHECK(F(2, 0) == doctest::Approx((V(0, 0) + V(1, 0) + V(2, 0) + V(3, 0)) / 4));
    }

    TEST_CASE("a single channel may have any stride") {
        std::vector<double> const memory{1, 100, 0, 200};
        strided_view<double const, 2> const odd(memory.data(), {2, 1}, {2, 77});
        stack<double, 2> F({2, 1});
        blocks_of<double> const blocks{{odd, odd}};
        scaled_dot_product(F.view(), odd, blocks, 1);
        CHECK(F(1, 0) == doctest::Approx(0.5));
        CHECK(F(0, 0) == doctest::Approx(std::exp(1.0) / (std::exp(1.0) + 1)));
    }

    TEST_CASE("it holds less than 8 MB beside its arguments however many the tokens and blocks") {
        using genrender::testing::counted_memory;
        if (!counted_memory::is_counted) {
            MESSAGE("the heap is not counted here");
            return;
        }
        threaded_loop const two(2);
        two(2, [](std::size_t) {}); // Its threads are no scratch.
        for (std::size_t const head_size : {40U, 160U}) {
            auto const Q = random_stack<float, 2>({4096, head_size}, 1);
            auto const K = random_stack<float, 2>({16, head_size}, 2);
            stack<float, 2> F({4096, head_size});
            blocks_of<float> const blocks(9, key_value_view<float>{K, K});
            auto const bytes = counted_memory::peak_of([&] { scaled_dot_product(F.view(), Q, blocks, 1, two); });
            MESSAGE("head size ", head_size, ": ", bytes, " bytes");
            CHECK(bytes > 0);
            CHECK(bytes < std::size_t{8} << 20);
        }
    }

    TEST_CASE("no query is no work") {
        stack<float, 2> F({0, 4});
        CHECK_NOTHROW(scaled_dot_product(F.view(), stack<float, 2>({0, 4}), {}, 2));
    }

    TEST_CASE("shapes and heads that do not fit are refused with a sentence") {
        stack<float, 2> F({2, 4});
        stack<float, 2> const Q({2, 4});
        stack<float, 2> const narrow({3, 3});
        stack<float, 2> const K({3, 4});
        stack<float, 2> const empty({0, 4});
        blocks_of<float> const good{{K, K}};
        CHECK_THROWS_WITH_AS(scaled_dot_product(F.view(), K, good, 1),
                             "scaled_dot_product: F is [2, 4], expected [3, 4]", shape_error);
        CHECK_THROWS_WITH_AS(scaled_dot_product(F.view(), Q, good, 3),
                             "scaled_dot_product: heads is 3, expected a divisor of the 4 channels", value_error);
        CHECK_THROWS_WITH_AS(scaled_dot_product(F.view(), Q, good, 0),
                             "scaled_dot_product: heads is 0, expected a divisor of the 4 channels", value_error);
        blocks_of<float> const narrow_K{{K, K}, {narrow, narrow}};
        CHECK_THROWS_WITH_AS(scaled_dot_product(F.view(), Q, narrow_K, 1),
                             "scaled_dot_product: K is [3, 3], expected [3, 4]", shape_error);
        blocks_of<float> const short_V{{K, Q}};
        CHECK_THROWS_WITH_AS(scaled_dot_product(F.view(), Q, short_V, 1),
                             "scaled_dot_product: V is [2, 4], expected [3, 4]", shape_error);
        blocks_of<float> const no_key{{empty, empty}};
        CHECK_THROWS_WITH_AS(scaled_dot_product(F.view(), Q, no_key, 1),
                             "scaled_dot_product: blocks is empty, expected at least one key", value_error);
        CHECK_THROWS_WITH_AS(scaled_dot_product(F.view(), Q, {}, 1),
                             "scaled_dot_product: blocks is empty, expected at least one key", value_error);
        std::vector<float> counts{1, 2, 0};
        blocks_of<float> counted{{K, K}};
        counted[0].counts = {counts.data(), {3}};
        CHECK_THROWS_WITH_AS(scaled_dot_product(F.view(), Q, counted, 1),
                             "scaled_dot_product: counts is 0.000000, expected finite and above 0", value_error);
        counted[0].counts = {counts.data(), {2}};
        CHECK_THROWS_WITH_AS(scaled_dot_product(F.view(), Q, counted, 1),
                             "scaled_dot_product: counts is [2], expected [3]", shape_error);
    }
    TEST_CASE_TEMPLATE("a scale multiplies logits, and 1 changes no bit", Real, float, double) {
        auto const Q = random_stack<Real, 2>({21, 16}, 1);
        auto const K = random_stack<Real, 2>({37, 16}, 2);
        auto const V = random_stack<Real, 2>({37, 16}, 3);
        blocks_of<Real> const blocks{{K, V}};
        auto sharper = Q;
        std::for_each(sharper.data(), sharper.data() + sharper.size(), [](Real& q) { q *= Real(1.75); });
        stack<Real, 2> F({21, 16});
        scaled_dot_product(F.view(), Q, blocks, 2, {}, Real(1.75));
        CHECK(largest_difference(F, naive<Real>(std::as_const(sharper).view(), blocks, 2)) < tolerance<Real>);
        CHECK(largest_difference(F, attention(Q, blocks, 2)) > 1e-2);
        scaled_dot_product(F.view(), Q, blocks, 2, {}, Real(1));
        auto const unscaled = attention(Q, blocks, 2);
        CHECK(std::equal(F.data(), F.data() + F.size(), unscaled.data()));
        CHECK_THROWS_AS(scaled_dot_product(F.view(), Q, blocks, 2, {}, std::numeric_limits<Real>::infinity()),
                        value_error);
    }
}
