// SPDX-License-Identifier: MIT
// Sums of factors times latents of any type.
#include <genrender/sampling/latent_combination.hpp>

#include <genrender/core/linalg.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/sampling/karras_schedule.hpp>
#include <genrender/sampling/sampler.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace latents_of_others {

/// Numbers that only `combine` can add up, and that say how often it did.
struct numbers {
    double value = 0;
    std::size_t sums = 0;
};

inline void combine(numbers& out, std::span<double const> factors, std::span<numbers const* const> in) {
    double sum = 0;
    for (std::size_t n = 0; n < in.size(); ++n) {
        sum += factors[n] * in[n]->value;
    }
    out = {sum, out.sums + 1};
}

} // namespace latents_of_others

TEST_SUITE("sampling/latent_combination") {
    using namespace genrender;
    using latents_of_others::numbers;

    static_assert(combined_latents<numbers, double>);
    static_assert(!combined_latents<numbers, float>);
    static_assert(!combined_latents<double, double> && !combined_latents<latents<double>, double>);

    TEST_CASE("latents are added up by views, by their own function, or by their operators") {
        std::array const factors{2.0, -1.0, 0.5};
        double number = 0;
        detail::combine_latents<double>(number, factors, 3.0, 5.0, 8.0);
        CHECK(number == 5);

        numbers own;
        detail::combine_latents<double>(own, factors, numbers{3}, numbers{5}, numbers{8});
        CHECK(own.value == 5);
        CHECK(own.sums == 1);

        auto const viewed_of = [](double value) {
            return latents<double>(std::array<std::size_t, 4>{1, 2, 1, 2}, value);
        };
        auto viewed = viewed_of(0);
        detail::combine_latents<double>(viewed, factors, viewed_of(3), viewed_of(5), viewed_of(8));
        CHECK(viewed == viewed_of(5));

        Eigen::Array3d lazy = Eigen::Array3d::Constant(3); // its own first term
        detail::combine_latents<double>(lazy, {2.0, -1.0}, lazy, Eigen::Array3d(Eigen::Array3d::Constant(1)));
        CHECK((lazy == 5).all());
    }
    TEST_CASE("every sampler moves latents by their own function alone, once a step or twice") {
        auto const D = [](numbers const& z, double sigma) { return numbers{z.value / (1 + sigma)}; };
        auto const of_number = [](double z, double sigma) { return z / (1 + sigma); };
        auto const sigmas = karras_schedule<double>(5);
        for (auto const sampler : {sampler_kind::euler, sampler_kind::heun, sampler_kind::dpmpp_2m}) {
            auto const last = sample(sampler, D, numbers{9}, sigmas);
            CHECK(last.value == doctest::Approx(sample(sampler, of_number, 9.0, sigmas)).epsilon(1e-14));
            CHECK(last.sums == 5);
        }
    }
}
