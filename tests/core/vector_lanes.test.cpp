// SPDX-License-Identifier: MIT
// The register type: what goes in comes out, lane by lane.
#include <genrender/core/vector_lanes.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

using namespace genrender;

namespace {

template <class Real>
using numbers = std::array<Real, detail::lane_count<Real>>;

/// 1, 2, 3, ... from `first` on.
template <class Real>
numbers<Real> counted(Real first) {
    numbers<Real> values;
    for (auto& value : values) {
        value = first;
        first += 1;
    }
    return values;
}

} // namespace

TEST_SUITE("core/vector_lanes") {
    TEST_CASE_TEMPLATE("arithmetic is that of each lane", Real, float, double) {
        auto const a = counted<Real>(1);
        auto const b = counted<Real>(-2);
        numbers<Real> out;
        detail::store(out.data(), detail::load(a.data()) * detail::load(b.data()) + detail::spread(Real{0.5}));
        for (std::size_t i = 0; i < out.size(); ++i) {
            CHECK(out[i] == a[i] * b[i] + Real{0.5});
        }
    }

    TEST_CASE_TEMPLATE("a spread number keeps its sign even if it is 0", Real, float, double) {
        numbers<Real> out;
        detail::store(out.data(), detail::spread(-Real{0}));
        for (auto const x : out) {
            CHECK(x == 0);
            CHECK(std::signbit(x));
        }
    }

    TEST_CASE_TEMPLATE("the greater number of each lane and the second beside NaN", Real, float, double) {
        auto const NaN = std::numeric_limits<Real>::quiet_NaN();
        auto a = counted<Real>(0);
        numbers<Real> out;
        detail::store(out.data(), detail::greater<Real>(detail::load(a.data()), detail::spread(Real{1})));
        CHECK(out[0] == 1);
        CHECK(out.back() == std::max(a.back(), Real{1}));
        detail::store(out.data(), detail::greater<Real>(detail::load(a.data()), detail::spread(NaN)));
        CHECK(std::isnan(out[0]));
        CHECK(std::isnan(out.back()));
        a[0] = NaN;
        detail::store(out.data(), detail::greater<Real>(detail::load(a.data()), detail::spread(Real{3})));
        CHECK(out[0] == 3);
    }

    TEST_CASE_TEMPLATE("one lane is enough for any_greater", Real, float, double) {
        for (std::size_t i = 0; i < detail::lane_count<Real>; ++i) {
            numbers<Real> a{};
            CHECK_FALSE(detail::any_greater<Real>(detail::load(a.data()), detail::spread(Real{0})));
            a[i] = 1;
            CHECK(detail::any_greater<Real>(detail::load(a.data()), detail::spread(Real{0})));
        }
    }

    TEST_CASE_TEMPLATE("the transposed square has rows for columns", Real, float, double) {
        constexpr auto n = detail::lane_count<Real>;
        detail::lanes<Real> square[n];
        for (std::size_t row = 0; row < n; ++row) {
            square[row] = detail::load(counted<Real>(static_cast<Real>(100 * row)).data());
        }
        detail::transpose<Real>(square);
        for (std::size_t row = 0; row < n; ++row) {
            numbers<Real> out;
            detail::store(out.data(), square[row]);
            for (std::size_t column = 0; column < n; ++column) {
                CHECK(out[column] == static_cast<Real>(100 * column + row));
            }
        }
    }

    TEST_CASE("unrolled indices come in order") {
        std::array<std::size_t, 5> seen{};
        std::size_t at = 0;
        detail::unrolled<5>([&](auto i) { seen[at++] = i; });
        CHECK(seen == std::array<std::size_t, 5>{0, 1, 2, 3, 4});
    }

    TEST_CASE("any address may be asked for") {
        CHECK_NOTHROW(detail::prefetch_to_read(nullptr));
        CHECK_NOTHROW(detail::prefetch_to_write(nullptr));
    }
}
