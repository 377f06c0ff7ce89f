// SPDX-License-Identifier: MIT
// Philox against its published vectors, and the distributions made of it within stated bounds.
#include <genrender/core/random.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

using namespace genrender;

TEST_SUITE("core/random") {
    namespace {

    using block = std::array<std::uint32_t, 4>;

    constexpr std::uint32_t ones = 0xFFFFFFFFU;

    /// Mean, variance, and the third and fourth standardised moments of normal values along one coordinate of the address.
    struct moments {
        double mean = 0;
        double variance = 0;
        double skewness = 0;
        double kurtosis = 0;
    };

    template <class Value>
    moments moments_of(std::uint32_t count, Value const& value) {
        moments m;
        for (std::uint32_t i = 0; i < count; ++i) {
            m.mean += value(i) / count;
        }
        for (std::uint32_t i = 0; i < count; ++i) {
            auto const d = value(i) - m.mean;
            m.variance += d * d / count;
            m.skewness += d * d * d / count;
            m.kurtosis += d * d * d * d / count;
        }
        m.skewness /= std::pow(m.variance, 1.5);
        m.kurtosis /= m.variance * m.variance;
        return m;
    }

    template <class First, class Second>
    double correlation(std::uint32_t count, First const& first, Second const& second) {
        double product = 0;
        double squares_1 = 0;
        double squares_2 = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            product += first(i) * second(i);
            squares_1 += first(i) * first(i);
            squares_2 += second(i) * second(i);
        }
        return product / std::sqrt(squares_1 * squares_2);
    }

    /// What both the header and this test should make of bits by the textbook: 53 bits of a fraction and Box-Muller.
    double box_muller(block const& bits) {
        auto const fraction = std::ldexp(static_cast<double>(bits[0]), -32) +
                              std::ldexp(static_cast<double>(bits[1] >> 11), -53) + std::ldexp(1.0, -54);
        auto const turn = std::ldexp(static_cast<double>(bits[2]) + 0.5, -32);
        return std::sqrt(-2 * std::log(fraction)) * std::cos(2 * std::numbers::pi * turn);
    }

    } // namespace

    TEST_CASE("Philox4x32-10 gives the known answers that its authors publish") {
        CHECK(philox({0, 0, 0, 0}, {0, 0}) == block{0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8});
        CHECK(philox({ones, ones, ones, ones}, {ones, ones}) == block{0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD});
        CHECK(philox({0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344}, {0xA4093822, 0x299F31D0}) ==
              block{0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1});
    }

    TEST_CASE("random_bits is Philox with the address and the stream as counter and the seed as key") {
        // Known answers computed with the authors' own implementation.
        CHECK(random_bits(42, random_stream::frame_noise, {0, 0, 0}) ==
              block{0xA5055879, 0x8479534B, 0x4EF872E4, 0xEF7F8FE9});
        CHECK(random_bits(0x0123456789ABCDEF, random_stream::texture_noise, {1, 2, 3}) ==
              block{0x4313B35C, 0xF94A4C5C, 0x4EBC73D4, 0x0DB30AD0});
        CHECK(random_bits(5, random_stream::test, {7, 11, 13}) ==
              block{0x06EBFD53, 0x02378E48, 0x6C7D996A, 0xD69DA16D});
        CHECK(random_bits(1, random_stream::keyframes, {ones, 0, 0}) ==
              block{0xAEC914F1, 0x556C42B9, 0x3AAABAFA, 0x910D9EF1});
    }

    TEST_CASE("a run of last year repeats: values of fixed addresses are pinned") {
        CHECK(uniform_value(42, random_stream::frame_noise, {0, 0, 0}) == 0.64461281744704491);
        CHECK(uniform_value(5, random_stream::test, {7, 11, 13}) == 0.027038414731775373);
        CHECK(normal_value(42, random_stream::frame_noise, {0, 0, 0}) ==
              doctest::Approx(-0.33663501897350584).epsilon(1e-14));
        CHECK(normal_value(5, random_stream::test, {7, 11, 13}) == doctest::Approx(-2.3849719364374691).epsilon(1e-14));
        // floor(0.64461... * 10)
        CHECK(uniform_below(10, 42, random_stream::frame_noise, {0, 0, 0}) == 6);
    }

    TEST_CASE("philox works in constant expressions and differs in every bit of counter and key") {
        constexpr auto reference = philox({1, 2, 3, 4}, {5, 6});
        for (std::size_t word = 0; word < 6; ++word) {
            for (int bit = 0; bit < 32; ++bit) {
                block counter{1, 2, 3, 4};
                std::array<std::uint32_t, 2> key{5, 6};
                (word < 4 ? counter[word] : key[word - 4]) ^= std::uint32_t{1} << bit;
                auto const other = philox(counter, key);
                int flipped = 0;
                for (std::size_t i = 0; i < 4; ++i) {
                    for (auto difference = other[i] ^ reference[i]; difference != 0; difference &= difference - 1) {
                        ++flipped;
                    }
                }
                // 64 of 128 on average with deviation 5.7: seven deviations.
                CHECK(std::abs(flipped - 64) < 40);
            }
        }
    }

    TEST_CASE("uniform values fill [0 and 1) evenly") {
        constexpr std::uint32_t n = 100000;
        std::array<int, 20> bins{};
        auto const value = [](std::uint32_t i) { return uniform_value(1, random_stream::test, {i, 0, 0}); };
        double least = 1;
        double greatest = 0;
        for (std::uint32_t i = 0; i < n; ++i) {
            least = std::min(least, value(i));
            greatest = std::max(greatest, value(i));
            ++bins.at(static_cast<std::size_t>(value(i) * 20));
        }
        CHECK(least >= 0);
        CHECK(least < 1e-3);
        CHECK(greatest < 1);
        CHECK(greatest > 1 - 1e-3);
        double chi_squared = 0;
        for (auto const bin : bins) {
            chi_squared += (bin - n / 20.0) * (bin - n / 20.0) / (n / 20.0);
        }
        // 19 degrees of freedom: 43.8 is exceeded once in a thousand seeds, 4.9 fallen short of.
        CHECK(chi_squared < 43.8);
        CHECK(chi_squared > 4.9);
        auto const m = moments_of(n, value);
        CHECK(std::abs(m.mean - 0.5) < 0.004);
        CHECK(std::abs(m.variance - 1.0 / 12) < 0.001);
    }

    TEST_CASE("normal values have the moments of N(0; 1) along every coordinate of the address") {
        constexpr std::uint32_t n = 100000;
        for (std::size_t coordinate = 0; coordinate < 3; ++coordinate) {
            CAPTURE(coordinate);
            auto const m = moments_of(n, [coordinate](std::uint32_t i) {
                random_address address{3, 4, 5};
                address[coordinate] = i;
                return normal_value(7, random_stream::test, address);
            });
            // Standard errors 0.0032, 0.0045, 0.0077 and 0.0155: four of each.
            CHECK(std::abs(m.mean) < 0.013);
            CHECK(std::abs(m.variance - 1) < 0.018);
            CHECK(std::abs(m.skewness) < 0.031);
            CHECK(std::abs(m.kurtosis - 3) < 0.062);
        }
    }

    TEST_CASE("normal values are the Box-Muller transform of the bits") {
        for (std::uint32_t i = 0; i < 1000; ++i) {
            auto const bits = random_bits(11, random_stream::test, {i, 0, 0});
            CHECK(normal_value(11, random_stream::test, {i, 0, 0}) == doctest::Approx(box_muller(bits)).epsilon(1e-9));
        }
    }

    TEST_CASE("normal values are finite and as large as chance wants and never larger than 8.66") {
        double greatest = 0;
        int infinite = 0;
        for (std::uint32_t i = 0; i < 1000000; ++i) {
            auto const value = std::abs(normal_value(13, random_stream::test, {i, 1, 2}));
            infinite += std::isfinite(value) ? 0 : 1;
            greatest = std::max(greatest, value);
        }
        CHECK(infinite == 0);
        // The greatest of a million: between 4.2 and 6.5 but once in ten thousand seeds.
        CHECK(greatest > 4.2);
        CHECK(greatest < 6.5);
        // The extremes of the bits, which no seed need ever reach.
        CHECK(box_muller({0, 0, 0, 0}) == doctest::Approx(8.652).epsilon(1e-3));
        CHECK(std::isfinite(box_muller({ones, ones, 0, 0})));
        CHECK(std::abs(box_muller({ones, ones, 0, 0})) < 1e-7);
    }

    TEST_CASE("neighbouring addresses and streams and seeds are uncorrelated") {
        constexpr std::uint32_t n = 40000;
        auto const base = [](std::uint32_t i) { return normal_value(3, random_stream::test, {i, 0, 0}); };
        auto const bound = 4 / std::sqrt(static_cast<double>(n));
        CHECK(std::abs(correlation(n, base, [](std::uint32_t i) {
                  return normal_value(3, random_stream::test, {i + 1, 0, 0});
              })) < bound);
        CHECK(std::abs(correlation(n, base, [](std::uint32_t i) {
                  return normal_value(3, random_stream::test, {i, 1, 0});
              })) < bound);
        CHECK(std::abs(correlation(n, base, [](std::uint32_t i) {
                  return normal_value(3, random_stream::test, {i, 0, 1});
              })) < bound);
        CHECK(std::abs(correlation(n, base, [](std::uint32_t i) {
                  return normal_value(4, random_stream::test, {i, 0, 0});
              })) < bound);
        CHECK(std::abs(correlation(n, base, [](std::uint32_t i) {
                  return normal_value(3 + (std::uint64_t{1} << 32), random_stream::test, {i, 0, 0});
              })) < bound);
        for (auto const stream : {random_stream::texture_noise, random_stream::background_noise,
                                  random_stream::frame_noise, random_stream::keyframes, random_stream::weights}) {
            CHECK(std::abs(correlation(n, base, [stream](std::uint32_t i) {
                      return normal_value(3, stream, {i, 0, 0});
                  })) < bound);
        }
        CHECK(correlation(n, base, base) == doctest::Approx(1));
    }

    TEST_CASE("the same address gives the same value in any order") {
        std::vector<double> forward;
        for (std::uint32_t i = 0; i < 50; ++i) {
            forward.push_back(normal_value(2, random_stream::test, {i, 0, 0}));
        }
        for (std::uint32_t i = 50; i-- > 0;) {
            CHECK(normal_value(2, random_stream::test, {i, 0, 0}) == forward[i]);
        }
    }

    TEST_CASE("whole numbers stay below their bound and are alike likely") {
        for (std::uint32_t const bound : {1U, 2U, 3U, 7U, 10U, 1000U, 0x80000001U, ones}) {
            CAPTURE(bound);
            std::uint32_t greatest = 0;
            for (std::uint32_t i = 0; i < 2000; ++i) {
                greatest = std::max(greatest, uniform_below(bound, 17, random_stream::test, {i, 0, 0}));
            }
            CHECK(greatest < bound);
            CHECK(greatest >= bound - 1 - bound / 100);
        }
        constexpr int n = 70000;
        std::array<int, 7> counts{};
        for (std::uint32_t i = 0; i < n; ++i) {
            ++counts.at(uniform_below(7, 19, random_stream::test, {i, 0, 0}));
        }
        double chi_squared = 0;
        for (auto const count : counts) {
            chi_squared += (count - n / 7.0) * (count - n / 7.0) / (n / 7.0);
        }
        // 6 degrees of freedom: 22.5 is exceeded once in a thousand seeds.
        CHECK(chi_squared < 22.5);
    }

    TEST_CASE("large bounds use all their range") {
        // 2^32 bits over 3/4 of as many numbers: 32 random bits alone would hit every third number twice as often, and
        // a remainder the lowest third of them.
        constexpr std::uint32_t bound = 0xC0000000U;
        constexpr int n = 30000;
        int low = 0;
        int every_third = 0;
        for (std::uint32_t i = 0; i < n; ++i) {
            auto const value = uniform_below(bound, 23, random_stream::test, {i, 0, 0});
            low += value < bound / 3 ? 1 : 0;
            every_third += value % 3 == 0 ? 1 : 0;
        }
        auto const four_deviations = 4 * std::sqrt(n * 2.0 / 9);
        CHECK(std::abs(low - n / 3) < four_deviations);
        CHECK(std::abs(every_third - n / 3) < four_deviations);
        CHECK(uniform_below(1, 23, random_stream::test, {0, 0, 0}) == 0);
    }

    TEST_CASE("four values of one draw are normal and independent") {
        constexpr std::uint32_t draws = 40000;
        std::array<double, 4> means{};
        std::array<std::array<double, 4>, 4> products{};
        for (std::uint32_t n = 0; n < draws; ++n) {
            auto const values = four_normals_of(random_bits(9, random_stream::test, {n, 0, 0}));
            for (std::size_t a = 0; a < 4; ++a) {
                means[a] += values[a] / draws;
                for (std::size_t b = 0; b < 4; ++b) {
                    products[a][b] += values[a] * values[b] / draws;
                }
            }
        }
        for (std::size_t a = 0; a < 4; ++a) {
            CHECK(std::abs(means[a]) < 4 / std::sqrt(double{draws}));
            for (std::size_t b = 0; b < 4; ++b) {
                CHECK(std::abs(products[a][b] - (a == b ? 1 : 0)) < 4 * std::sqrt((a == b ? 2.0 : 1.0) / draws));
            }
        }
        // The ends of the bits are finite.
        CHECK(std::abs(four_normals_of({0, 0, 0xFFFFFFFFU, 0xFFFFFFFFU})[0]) < 6.8);
    }
}
