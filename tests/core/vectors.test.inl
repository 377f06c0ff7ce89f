// SPDX-License-Identifier: MIT
// What is checked of the vectors of one target.

namespace genrender::testing::GENRENDER_TARGET {

using namespace genrender::detail::GENRENDER_TARGET_NAME;

template <class Real>
using numbers = std::array<Real, lane_count<Real>>;

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

inline void check_lane_counts() {
    CHECK(lane_count<float> >= 1);
    if (lane_count < float >> 1) {
        CHECK(lane_count<float> == 2 * lane_count<double>);
        CHECK(lane_count<double> * sizeof(double) == sizeof(lanes<double>));
        CHECK(sizeof(lanes<double>) == sizeof(lanes<float>));
    }
    CHECK(lane_count<float> <= genrender::detail::most_lanes<float>);
}

inline void check_bits() {
    std::array<std::uint8_t, 9> const bytes{0, 1, 2, 3, 4, 5, 6, 7, 8};
    auto const number = load_as<std::uint64_t>(bytes.data() + 1);
    auto const back = bits_as<std::array<std::uint8_t, 8>>(number);
    CHECK(back == std::array<std::uint8_t, 8>{1, 2, 3, 4, 5, 6, 7, 8});
    CHECK(bits_as<std::uint32_t>(1.0F) == 0x3F800000U);
}

template <class Real>
void check_arithmetic() {
    auto const a = counted<Real>(1);
    auto const b = counted<Real>(-2);
    numbers<Real> out;
    store(out.data(), load(a.data()) * load(b.data()) + spread(Real{0.5}));
    for (std::size_t i = 0; i < out.size(); ++i) {
        CHECK(out[i] == a[i] * b[i] + Real{0.5});
    }
}

template <class Real>
void check_spread_sign() {
    numbers<Real> out;
    store(out.data(), spread(-Real{0}));
    for (auto const x : out) {
        CHECK(x == 0);
        CHECK(std::signbit(x));
    }
}

template <class Real>
void check_greater() {
    auto const NaN = std::numeric_limits<Real>::quiet_NaN();
    auto a = counted<Real>(0);
    numbers<Real> out;
    store(out.data(), greater<Real>(load(a.data()), spread(Real{1})));
    CHECK(out[0] == 1);
    CHECK(out.back() == std::max(a.back(), Real{1}));
    store(out.data(), greater<Real>(load(a.data()), spread(NaN)));
    CHECK(std::isnan(out[0]));
    CHECK(std::isnan(out.back()));
    a[0] = NaN;
    store(out.data(), greater<Real>(load(a.data()), spread(Real{3})));
    CHECK(out[0] == 3);
}

template <class Real>
void check_any_greater() {
    for (std::size_t i = 0; i < lane_count<Real>; ++i) {
        numbers<Real> a{};
        CHECK_FALSE(any_greater<Real>(load(a.data()), spread(Real{0})));
        a[i] = 1;
        CHECK(any_greater<Real>(load(a.data()), spread(Real{0})));
    }
}

template <class Real>
void check_transpose() {
    constexpr auto n = lane_count<Real>;
    lanes<Real> square[n];
    for (std::size_t row = 0; row < n; ++row) {
        square[row] = load(counted<Real>(static_cast<Real>(100 * row)).data());
    }
    transpose<Real>(square);
    for (std::size_t row = 0; row < n; ++row) {
        numbers<Real> out;
        store(out.data(), square[row]);
        for (std::size_t column = 0; column < n; ++column) {
            CHECK(out[column] == static_cast<Real>(100 * column + row));
        }
    }
}

inline void check_unrolled() {
    std::array<std::size_t, 5> seen{};
    std::size_t at = 0;
    unrolled<5>([&](auto i) { seen[at++] = i; });
    CHECK(seen == std::array<std::size_t, 5>{0, 1, 2, 3, 4});
}

inline void check_prefetch() {
    prefetch_to_read(nullptr);
    prefetch_to_write(nullptr);
}

/// Every count of numbers around the length of a register, in place and elsewhere.
template <class Real>
void check_each_register() {
    for (std::size_t count = 0; count < 3 * lane_count<Real> + 2; ++count) {
        std::vector<Real> from(count + 1, Real{3});
        for (std::size_t e = 0; e < count; ++e) {
            from[e] = static_cast<Real>(e);
        }
        auto const twice = [](std::size_t, auto const& x) GENRENDER_ALWAYS_INLINE { return x + x; };
        std::vector<Real> to(count + 1, Real{-1});
        each_register(to.data(), from.data(), count, twice);
        each_register(from.data(), from.data(), count, twice);
        for (std::size_t e = 0; e < count; ++e) {
            CHECK(to[e] == static_cast<Real>(2 * e));
            CHECK(from[e] == to[e]);
        }
        CHECK(to[count] == -1);
        CHECK(from[count] == 3);
    }
}

/// 2^x of one number, in every lane.
template <class Real>
Real power_of_2(Real x) {
    Real out[lane_count<Real>];
    store(out, exponential_2<Real>(spread(x)));
    CHECK((std::isnan(x) || std::equal(out + 1, out + lane_count<Real>, out)));
    return out[0];
}

/// The greatest relative error of 2^x over all of its range.
template <class Real>
void check_exponential_error() {
    auto const greatest = static_cast<Real>(std::numeric_limits<Real>::max_exponent - 1);
    auto const least = static_cast<Real>(std::numeric_limits<Real>::min_exponent);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        auto const x = least + (greatest - least) * static_cast<Real>(i) / Real{20000};
        auto const exact = std::exp2(static_cast<long double>(x));
        worst = std::max(worst, static_cast<double>(std::abs((power_of_2(x) - exact) / exact)));
    }
    CHECK(worst < 1.5 * static_cast<double>(std::numeric_limits<Real>::epsilon()));
}

template <class Real>
void check_exponential_of_whole_numbers() {
    for (int n = -100; n <= 100; ++n) {
        CHECK(power_of_2(static_cast<Real>(n)) == std::ldexp(Real{1}, n));
    }
}

template <class Real>
void check_exponential_far_below() {
    auto const infinity = std::numeric_limits<Real>::infinity();
    for (auto const x : {Real{-1e4}, std::numeric_limits<Real>::lowest(), -infinity}) {
        CHECK(power_of_2(x) > 0);
        CHECK(power_of_2(x) < 3 * std::numeric_limits<Real>::min());
    }
}

template <class Real>
void check_exponential_of_nan() {
    CHECK(std::isnan(power_of_2(std::numeric_limits<Real>::quiet_NaN())));
}

/// How many of all 65536 numbers of 16 bits do not come out as Eigen says.
template <class Real, class Stored>
void check_widening() {
    using bits = typename half_bits<Stored>::type;
    constexpr auto count = lane_count<Real>;
    std::size_t differing = 0;
    for (std::uint32_t first = 0; first < 65536; first += static_cast<std::uint32_t>(count)) {
        std::array<bits, count> stored;
        for (std::size_t n = 0; n < count; ++n) {
            stored[n].bits = static_cast<std::uint16_t>(first + n);
        }
        std::array<Real, count> wide;
        store(wide.data(), load_widened<Real>(stored.data()));
        for (std::size_t n = 0; n < count; ++n) {
            Stored number;
            std::memcpy(static_cast<void*>(&number), &stored[n], sizeof(number));
            auto const expected = static_cast<Real>(static_cast<float>(number));
            auto const is_same = std::isnan(expected)
                                     ? std::isnan(wide[n])
                                     : wide[n] == expected && std::signbit(wide[n]) == std::signbit(expected);
            differing += is_same ? 0U : 1U;
        }
    }
    CHECK(differing == 0);
}

} // namespace genrender::testing::GENRENDER_TARGET
