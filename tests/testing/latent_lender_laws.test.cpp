// SPDX-License-Identifier: MIT
// [GR alg. 1: z] Every law of lenders can be broken, and is told by its sentence.
#include <genrender/testing/latent_lender_laws.hpp>

#include "broken_laws.hpp"
#include "../support/device_denoiser.hpp"

#include <genrender/testing/analytic_denoiser.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

TEST_SUITE("testing/latent_lender_laws") {
    using namespace genrender;
    using namespace genrender::testing;

    namespace {

    using small_host = analytic_denoiser<float>;
    using right_device = stopping_device<small_host>;

    enum class lender_flaw {
        none,
        forgets_the_last_element,
        shares_one_memory,
        sorts_frames,
        turns_stacks_around,
        leaves_out_the_last_term,
        writes_into_its_terms,
        adds_what_comes_twice_once,
        calls_infinity_finite,
        calls_nothing_finite,
        estimates_something_else,
        writes_into_z,
        reuses_estimates,
        stops_before_the_first_site,
        changes_what_it_lends,
        counts_all_pixels,
        biases_variances,
        adds_before_it_scales,
        rescales_in_place
    };

    /// A device with one thing wrong.
    struct flawed_device : right_device {
        using handle = right_device::latents_type;
        lender_flaw what = lender_flaw::none;
        mutable std::optional<handle> kept{};

        bool has(lender_flaw wrong) const { return what == wrong; }
        handle changed(handle const& z, std::function<void(stack<float, 4>&)> const& change) const {
            auto values = z.read();
            change(values);
            return handle::written(values);
        }

        handle upload(strided_view<float const, 4> z) const {
            auto const up = right_device::upload(z);
            if (has(lender_flaw::forgets_the_last_element)) {
                return changed(up, [](auto& values) { values.data()[values.size() - 1] = 0; });
            }
            if (has(lender_flaw::shares_one_memory)) {
                if (kept) {
                    kept->spoil();
                }
                kept = up;
            }
            return up;
        }
        handle frames_of(handle const& z, std::span<frame_index const> frames) const {
            std::vector<frame_index> order(frames.begin(), frames.end());
            if (has(lender_flaw::sorts_frames)) {
                std::sort(order.begin(), order.end());
            }
            return right_device::frames_of(z, order);
        }
        handle joined(std::span<handle const> stacks) const {
            std::vector<handle> order(stacks.begin(), stacks.end());
            if (has(lender_flaw::turns_stacks_around) && order.size() > 1) {
                std::swap(order[0], order[1]);
            }
            return right_device::joined(order);
        }
        handle combination(std::span<float const> factors, std::span<handle const> in) const {
            std::vector<float> by(factors.begin(), factors.end());
            if (has(lender_flaw::leaves_out_the_last_term)) {
                by.back() = 0;
            }
            if (has(lender_flaw::adds_what_comes_twice_once) && in.size() > 1 && &in[0] != &in[1]) {
                auto const a = in[0].read();
                auto const b = in[1].read();
                by[1] = std::equal(a.data(), a.data() + a.size(), b.data()) ? 0 : by[1];
            }
            auto const sum = right_device::combination(by, in);
            if (has(lender_flaw::writes_into_its_terms)) {
                in[0].spoil();
            }
            return sum;
        }
        bool all_finite(handle const& z) const {
            if (has(lender_flaw::calls_infinity_finite)) {
                auto const values = z.read();
                return std::none_of(values.data(), values.data() + values.size(), [](float x) { return x != x; });
            }
            return right_device::all_finite(z) && !has(lender_flaw::calls_nothing_finite);
        }

        using right_device::operator();
        template <class Processor>
        handle operator()(handle const& z, float sigma, std::span<frame_index const> frames,
                          Processor& processor) const {
            auto x0 = right_device::operator()(z, sigma, frames, processor);
            if (has(lender_flaw::estimates_something_else)) {
                x0 = changed(x0, [](auto& values) { values.data()[0] += 1; });
            }
            if (has(lender_flaw::writes_into_z)) {
                z.spoil();
            }
            if (has(lender_flaw::reuses_estimates)) {
                if (kept) {
                    kept->spoil();
                }
                kept = x0;
            }
            return x0;
        }
        using right_device::run_until;
        template <class Processor>
        void run_until(handle const& z, float sigma, std::span<frame_index const> frames, Processor& processor,
                       std::span<std::optional<site_index> const> last, residuals_type* lent = nullptr) const {
            if (!has(lender_flaw::stops_before_the_first_site)) {
                right_device::run_until(z, sigma, frames, processor, last, lent);
            }
        }
        template <class Processor>
        handle operator()(handle const& z, float sigma, std::span<frame_index const> frames, Processor& processor,
                          residuals_type const& lent) const {
            auto const x0 = right_device::operator()(z, sigma, frames, processor, lent);
            return has(lender_flaw::changes_what_it_lends) ? changed(x0, [](auto& values) { values.data()[1] += 1; })
                                                           : x0;
        }
        void channel_statistics(strided_view<float, 2> means, strided_view<float, 2> deviations, handle const& z,
                                handle const& w) const {
            auto const all = changed(w, [](auto& values) { std::fill_n(values.data(), values.size(), 1.0F); });
            right_device::channel_statistics(means, deviations, z, has(lender_flaw::counts_all_pixels) ? all : w);
            if (has(lender_flaw::biases_variances)) {
                deviations(0, 0) *= 0.95F;
            }
        }
        handle rescaled(handle const& z, strided_view<float const, 2> mean_from, strided_view<float const, 2> scale,
                        strided_view<float const, 2> mean_to) const {
            auto const by = has(lender_flaw::adds_before_it_scales)
                                ? right_device::rescaled(z, mean_to, scale, mean_from)
                                : right_device::rescaled(z, mean_from, scale, mean_to);
            if (has(lender_flaw::rescales_in_place)) {
                z.spoil();
            }
            return by;
        }
    };

    std::vector<std::string> broken(lender_flaw what) {
        flawed_device phi{{{{{.grid = {3, 4}, .attention = 0.5F, .guidance_branches = 2}}}}};
        phi.what = what;
        return broken_laws(check_latent_lender_laws(phi, 1.5F, {.frames = {{4}, {1}, {2}}, .threads = 1}));
    }

    using names = std::vector<std::string>;

    } // namespace

    static_assert(latent_lender<flawed_device> && normalizing_lender<flawed_device> && residual_lender<flawed_device>);
    static_assert(genrender::detail::lender_stops<flawed_device>);

    TEST_CASE("lenders that keep the laws are told nothing") {
        CHECK(broken(lender_flaw::none) == names{});
        device_denoiser<small_host> const lends_latents{{.grid = {2, 3}}};
        CHECK(check_latent_lender_laws(lends_latents, 0.7F).text() == "");
    }
    TEST_CASE("each law of a lender can be broken") {
        auto const check = [](lender_flaw what, std::string const& law) {
            auto const told = broken(what);
            CAPTURE(law);
            CHECK(std::find(told.begin(), told.end(), law) != told.end());
        };
        check(lender_flaw::forgets_the_last_element,
              "latent_lender: what is uploaded is downloaded to the bit, whatever becomes of the view");
        check(lender_flaw::shares_one_memory, "latent_lender: copies of a handle stand for the same latents");
        check(lender_flaw::sorts_frames, "latent_lender: frames_of gives the entries that are named, in their order");
        check(lender_flaw::turns_stacks_around,
              "latent_lender: joined gives the entries of all stacks, in their order");
        check(lender_flaw::leaves_out_the_last_term, "latent_lender: combination is the sum of factors times latents");
        check(lender_flaw::adds_what_comes_twice_once,
              "latent_lender: combination is the sum of factors times latents");
        check(lender_flaw::writes_into_its_terms, "latent_lender: combination does not change what it is given");
        check(lender_flaw::calls_infinity_finite, "latent_lender: all_finite tells what is not");
        check(lender_flaw::calls_nothing_finite, "latent_lender: all_finite tells what is finite");
        check(lender_flaw::estimates_something_else,
              "latent_lender: a call on handles estimates what one on views does");
        check(lender_flaw::writes_into_z, "latent_lender: a call does not change z");
        check(lender_flaw::reuses_estimates, "latent_lender: estimates are not written by another call");
        check(lender_flaw::stops_before_the_first_site,
              "latent_lender: every site is run once per branch and call, with all frames at once");
        check(lender_flaw::changes_what_it_lends, "latent_lender: what is lent changes no estimate");
        check(lender_flaw::counts_all_pixels, "normalizing_lender: means are of the elements where w is 1");
        check(lender_flaw::biases_variances,
              "normalizing_lender: deviations are sqrt(unbiased variance + 1e-5) where w is 1");
        check(lender_flaw::adds_before_it_scales, "normalizing_lender: rescaled is (z - mean_from) scale + mean_to");
        check(lender_flaw::rescales_in_place, "normalizing_lender: rescaled does not change z");
    }
    TEST_CASE("a trial of one frame is refused") {
        device_denoiser<small_host> const phi{{.grid = {2, 3}}};
        CHECK_THROWS_WITH_AS(check_latent_lender_laws(phi, 1.5F, {.frames = {{0}}}),
                             "check_latent_lender_laws: trial.frames.size() is 1, expected at least 2 frames",
                             value_error);
    }
}
