// SPDX-License-Identifier: MIT
// [GR sec. 3.4] Normalisation where the latents are, against the library's own in host memory.
#include <genrender/normalization/latent_normalizer.hpp>

#include "../support/device_denoiser.hpp"

#include <genrender/testing/analytic_denoiser.hpp>
#include <genrender/testing/random_stack.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

TEST_SUITE("normalization/latent_normalizer") {
    using namespace genrender;
    using host_denoiser = testing::analytic_denoiser<float>;
    using on_device = testing::device_denoiser<host_denoiser>;
    using lends_all = testing::normalizing_device<host_denoiser>;

    namespace {

    /// Four frames of 2 x 3 x 4, with 12, 1, 0 and 6 pixels of background.
    struct small_latents {
        stack<float, 4> z = testing::random_stack<float>(std::array<std::size_t, 4>{4, 2, 3, 4}, 5);
        stack<std::uint8_t, 3> background{{4, 3, 4}};

        small_latents() {
            std::fill_n(background.data(), 12, std::uint8_t{1});
            background(1, 2, 1) = 1;
            std::fill_n(background.data() + 39, 6, std::uint8_t{9}); // any number but 0 is background
        }
        strided_view<std::uint8_t const, 3> mask() const { return background.view(); }
    };

    template <class Phi>
    void check_lender(Phi const& phi, adain_settings<float> const& settings) {
        small_latents given;
        lent_latents<Phi> z(phi, std::as_const(given.z).view());
        auto const skipped = latent_normalizer<Phi>(phi, given.mask())(z, settings);
        auto const before = given.z;
        auto const expected_skipped = normalize_latents(given.z.view(), given.mask(), settings);
        CHECK(skipped == expected_skipped);
        stack<float, 4> found(given.z.extents());
        z.download(found.view());
        CHECK(std::equal(found.data(), found.data() + found.size(), given.z.data()));
        CHECK(!std::equal(found.data(), found.data() + found.size(), before.data()));
    }

    } // namespace

    TEST_CASE("[GR sec. 3.4] lent latents are normalised as those in host memory, to the bit") {
        for (auto const statistics : {adain_statistics::mean, adain_statistics::mean_and_deviation}) {
            for (auto const fallback : {without_background::skip, without_background::all_pixels}) {
                for (std::size_t const least : {0U, 7U}) {
                    // Of the settings with 7 pixels and no fallback nothing would change.
                    adain_settings<float> const settings{
                        .statistics = statistics, .least_pixels = least, .fallback = fallback};
                    if (least == 7 && fallback == without_background::skip) {
                        continue;
                    }
                    check_lender(on_device{{.grid = {3, 4}, .channels = 2}}, settings);
                    check_lender(lends_all{{{.grid = {3, 4}, .channels = 2}}}, settings);
                }
            }
        }
    }
    TEST_CASE("latents in host memory are normalised in place") {
        small_latents given;
        auto expected = given.z;
        normalize_latents(expected.view(), given.mask());
        host_denoiser const phi{.grid = {3, 4}, .channels = 2};
        latent_normalizer<host_denoiser>(phi, given.mask())(given.z.view(), {});
        CHECK(std::equal(expected.data(), expected.data() + expected.size(), given.z.data()));
    }
    TEST_CASE("the background goes up once, and latents that do not change stay the same handle") {
        small_latents const given;
        lends_all const phi{{{.grid = {3, 4}, .channels = 2}}};
        lent_latents<lends_all> z(phi, given.z.view());
        latent_normalizer<lends_all> const normalize(phi, given.mask());
        CHECK(phi.counts->uploads == 1);
        normalize(z, {});
        normalize(z, {});
        CHECK(phi.counts->uploads == 2);
        CHECK(phi.counts->downloads == 0);
        // Too few pixels everywhere.
        CHECK(normalize(z, {.least_pixels = 100}) == std::vector<std::size_t>{0, 1, 2, 3});
    }
    TEST_CASE("a background of other extents is refused") {
        small_latents const given;
        lends_all const phi{{{.grid = {3, 4}, .channels = 2}}};
        lent_latents<lends_all> z(phi, given.z.view().slice(0, 3));
        CHECK_THROWS_WITH_AS(latent_normalizer<lends_all>(phi, given.mask())(z, {}),
                             "latent_normalizer: background is [4, 3, 4], expected [3, 3, 4]", shape_error);
    }
}
