// SPDX-License-Identifier: MIT
// The vectors of one target: types, loads and stores, and what is done to a whole register at once.

namespace genrender::detail::GENRENDER_TARGET {

/// How many elements of type T a register holds; one where the compiler has no vectors.
template <class T>
inline constexpr std::size_t lane_count = GENRENDER_TARGET_BYTES > 0 ? GENRENDER_TARGET_BYTES / sizeof(T) : 1;

/// Whether the target has 32 vector registers rather than 16.
#if defined(__aarch64__)
inline constexpr bool many_vector_registers = true;
#else
inline constexpr bool many_vector_registers = GENRENDER_TARGET_AVX512;
#endif

#if defined(__GNUC__)
template <class T, std::size_t Count>
struct lanes_type {
    typedef T type __attribute__((vector_size(Count * sizeof(T))));
};
#else
template <class T, std::size_t Count>
struct lanes_type {
    static_assert(Count == 1, "vectors: this compiler has none");
    using type = T;
};
#endif

/// `Count` elements of type T side by side, a register of them unless told otherwise, that are added, multiplied and
/// compared at once.
template <class T, std::size_t Count = lane_count<T>>
using lanes = typename lanes_type<T, Count>::type;

/// The unsigned integer as wide as T.
template <class T>
using word_of = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;

/// Runs body(0) ... body(N - 1) with indices that are constants, so that arrays they index stay in registers.
template <std::size_t N, class Body>
GENRENDER_ALWAYS_INLINE inline void unrolled(Body&& body) {
    [&]<std::size_t... I>(std::index_sequence<I...>) GENRENDER_ALWAYS_INLINE {
        (body(std::integral_constant<std::size_t, I>{}), ...);
    }
    (std::make_index_sequence<N>{});
}

/// The same bits as another type.
template <class To, class From>
GENRENDER_ALWAYS_INLINE inline To bits_as(From const& from) {
    static_assert(sizeof(To) == sizeof(From));
    To to;
    std::memcpy(&to, &from, sizeof(to));
    return to;
}

/// `value`, of which -ffast-math must not know where it comes from: sums that round on purpose would be folded.
template <class Vector>
GENRENDER_ALWAYS_INLINE inline Vector as_written(Vector value) {
#if defined(__FAST_MATH__) && defined(__x86_64__)
    __asm__("" : "+v"(value));
#elif defined(__FAST_MATH__) && defined(__aarch64__)
    __asm__("" : "+w"(value));
#endif
    return value;
}

/// A `Vector` from as many elements at any address.
template <class Vector, class T>
GENRENDER_ALWAYS_INLINE inline Vector load_as(T const* from) {
    Vector value;
    std::memcpy(&value, from, sizeof(value));
    return value;
}

template <class T>
GENRENDER_ALWAYS_INLINE inline lanes<T> load(T const* from) {
    return load_as<lanes<T>>(from);
}

template <class T>
GENRENDER_ALWAYS_INLINE inline void store(T* to, std::type_identity_t<lanes<T>> v) {
    std::memcpy(to, &v, sizeof v);
}

/// x in every lane.
template <class T>
GENRENDER_ALWAYS_INLINE inline lanes<T> spread(T x) {
    return x - lanes<T>{}; // less 0 and not plus 0, which would take the sign from -0
}

/// The greater of both in each lane; b where either is not a number.
template <class T>
GENRENDER_ALWAYS_INLINE inline lanes<T> greater(std::type_identity_t<lanes<T>> a, std::type_identity_t<lanes<T>> b) {
    return a > b ? a : b;
}

/// Whether a > b in any lane.
template <class T>
GENRENDER_ALWAYS_INLINE inline bool any_greater(std::type_identity_t<lanes<T>> a, std::type_identity_t<lanes<T>> b) {
    auto const is = a > b;
    if constexpr (lane_count<T> == 1) {
        return is;
    } else {
        std::uint64_t words[sizeof is / sizeof(std::uint64_t)];
        std::memcpy(words, &is, sizeof is);
        std::uint64_t any = 0;
        unrolled<sizeof words / sizeof *words>([&](auto i) GENRENDER_ALWAYS_INLINE { any |= words[i]; });
        return any != 0;
    }
}

/// Asks for the cache line at an address to be in the second cache when it is read. Changes no value.
GENRENDER_ALWAYS_INLINE inline void prefetch_to_read([[maybe_unused]] void const* at) {
#if defined(__GNUC__)
    __builtin_prefetch(at, 0, 2);
#endif
}

/// The same for an address that will be written.
GENRENDER_ALWAYS_INLINE inline void prefetch_to_write([[maybe_unused]] void const* at) {
#if defined(__GNUC__)
    __builtin_prefetch(at, 1, 2);
#endif
}

/// Rows become columns of a square of lane_count x lane_count numbers.
template <class T>
GENRENDER_ALWAYS_INLINE inline void transpose(lanes<T> (&rows)[lane_count<T>]) {
    constexpr auto n = lane_count<T>;
    if constexpr (n > 1) {
#if defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define GENRENDER_HAS_SHUFFLE
#endif
#endif
#ifdef GENRENDER_HAS_SHUFFLE
        // Interleave the first half of the rows with the second, log2 n times.
        constexpr auto interleaved =
            []<std::size_t... I>(lanes<T> a, lanes<T> b, auto from, std::index_sequence<I...>) GENRENDER_ALWAYS_INLINE {
            return __builtin_shufflevector(a, b, ((I % 2) * n + I / 2 + from())...);
        };
        constexpr std::make_index_sequence<n> all;
        constexpr std::integral_constant<std::size_t, 0> low;
        constexpr std::integral_constant<std::size_t, n / 2> high;
        unrolled<n>([&](auto round) GENRENDER_ALWAYS_INLINE {
            if constexpr ((std::size_t{1} << round()) < n) {
                lanes<T> next[n];
                unrolled<n / 2>([&](auto i) GENRENDER_ALWAYS_INLINE {
                    next[2 * i] = interleaved(rows[i], rows[i + n / 2], low, all);
                    next[2 * i + 1] = interleaved(rows[i], rows[i + n / 2], high, all);
                });
                unrolled<n>([&](auto i) GENRENDER_ALWAYS_INLINE { rows[i] = next[i]; });
            }
        });
#undef GENRENDER_HAS_SHUFFLE
#else
        T from[n][n];
        T to[n][n];
        std::memcpy(from, rows, sizeof from);
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = 0; j < n; ++j) {
                to[j][i] = from[i][j];
            }
        }
        std::memcpy(rows, to, sizeof from);
#endif
    }
}

/// Writes f(i, numbers from + i on, in one register) to `to` + i for all of `count` numbers. The last register overlaps
/// the one before it, so `f` must not ask where a number stands; `to` may be `from`. Fewer numbers than a register
/// holds are followed by zeros.
template <class Real, class Function>
GENRENDER_ALWAYS_INLINE inline void each_register(Real* to, Real const* from, std::size_t count, Function const& f) {
    constexpr auto n = lane_count<Real>;
    if (count < n) {
        Real part[n] = {};
        std::memcpy(part, from, count * sizeof(Real));
        store(part, f(std::size_t{0}, load(part)));
        std::memcpy(to, part, count * sizeof(Real));
        return;
    }
    // Read before anything is written, for where both are the same memory.
    auto const last = load(from + count - n);
    std::size_t i = 0;
    for (; i + n <= count; i += n) {
        store(to + i, f(i, load(from + i)));
    }
    if (i < count) {
        store(to + count - n, f(count - n, last));
    }
}

/// 2^x in each lane for x < 127 (double: 1023), within about an ulp; what lies below the least normal number's
/// exponent counts as if it lay just above it, and NaN stays NaN. A polynomial on half a unit either side of 0, and the
/// whole part put into the exponent.
template <class Real>
GENRENDER_ALWAYS_INLINE inline lanes<Real> exponential_2(std::type_identity_t<lanes<Real>> x) {
    constexpr auto mantissa = std::numeric_limits<Real>::digits - 1;
    constexpr auto least = static_cast<Real>(std::numeric_limits<Real>::min_exponent);
    // To a number of this size, half a unit is half of the last bit: adding it rounds x to whole numbers.
    constexpr auto rounder = static_cast<Real>(std::uint64_t{3} << (mantissa - 1));
    constexpr auto& c = exponential_coefficients<Real>;

    x = greater<Real>(spread(least), x);
    auto const whole = as_written(x + rounder);
    auto const rest = x - as_written(whole - rounder);
    constexpr auto degree = sizeof c / sizeof *c - 1;
    auto power = spread(c[degree]);
    unrolled<degree>([&](auto i) GENRENDER_ALWAYS_INLINE { power = power * rest + c[degree - 1 - i]; });

    // The whole part stands in the last bits of `whole`.
    using words = lanes<word_of<Real>>;
    return bits_as<lanes<Real>>(bits_as<words>(power) + (bits_as<words>(whole) << mantissa));
}

} // namespace genrender::detail::GENRENDER_TARGET
