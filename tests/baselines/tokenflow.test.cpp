// SPDX-License-Identifier: MIT
// [GR sec. 4: TokenFlow*] The baseline against a plain second writing of it, and whole runs.
#include <genrender/baselines/tokenflow.hpp>

#include "../reference/small_reference_network.hpp"
#include "../support/dense_texture.hpp"
#include <genrender/testing/sequence_method_laws.hpp>
#include "small_baseline_run.hpp"

#include <genrender/baselines/baseline_settings.hpp>
#include <genrender/reference/reference_network.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

namespace {

/// For a frame and grid, the token of another frame that shows what each token shows, found in dense textures.
class dense_matches {
public:
    dense_matches(uv_maps const& maps, std::size_t objects, std::size_t T) : maps_(&maps), objects_(objects), T_(T) {}

    /// The match of token t of frame i in frame k; background matches background at the same place.
    std::optional<std::size_t> operator()(grid_extents grid, std::size_t k, std::size_t i, std::size_t t) const {
        auto const texel = dense_texel_of(*maps_, i, grid, t, objects_, T_);
        if (!texel) {
            return dense_texel_of(*maps_, k, grid, t, objects_, T_) ? std::nullopt : std::optional(t);
        }
        stack<double, 2> numbers({grid.size(), 1});
        for (std::size_t n = 0; n < grid.size(); ++n) {
            numbers(n, std::size_t{0}) = static_cast<double>(n);
        }
        auto const texture = dense_unproject<double>(*maps_, k, numbers.view(), grid, objects_, T_);
        return texture.filled[*texel] != 0 ? std::optional(static_cast<std::size_t>(texture.values[*texel]))
                                           : std::nullopt;
    }

private:
    uv_maps const* maps_;
    std::size_t objects_;
    std::size_t T_;
};

/// All frames in lockstep: keyframes attend to all keyframes, others interpolate their outputs.
template <class Real>
stack<Real, 4> plain_tokenflow(small_baseline_run<Real> const& run, strided_view<Real const, 4> z, Real sigma,
                               std::vector<frame_index> const& KF) {
    dense_matches const match(run.maps, run.objects, run.T);
    std::vector<std::size_t> keyframes;
    for (auto const k : KF) {
        keyframes.push_back(k.value);
    }
    auto const rule = [&](attention_place place, host_features<Real> const& f, std::size_t i) {
        auto const output = [&](std::size_t k) {
            return dense_self_attention(run.phi.weights[place.site.value], joined_rows(f, {k}),
                                        joined_rows(f, keyframes));
        };
        std::optional<std::size_t> before;
        std::optional<std::size_t> after;
        for (auto const k : keyframes) {
            before = k <= i && (!before || k > *before) ? std::optional(k) : before;
            after = k >= i && (!after || k < *after) ? std::optional(k) : after;
        }
        if (before == after) {
            return output(i);
        }
        auto const weight_after = !before  ? 1.0
                                  : !after ? 0.0
                                           : static_cast<double>(i - *before) / static_cast<double>(*after - *before);
        auto const F_before = before ? output(*before) : token_rows{};
        auto const F_after = after ? output(*after) : token_rows{};
        token_rows F;
        for (std::size_t t = 0; t < f.extents()[1]; ++t) {
            auto const grid = run.phi.modules[place.site.value].grid;
            auto const b = before ? match(grid, *before, i, t) : std::nullopt;
            auto const a = after ? match(grid, *after, i, t) : std::nullopt;
            auto const share = b && a ? weight_after : a ? 1.0 : b ? 0.0 : weight_after > 0.5 ? 1.0 : 0.0;
            auto& row = F.emplace_back(run.phi.channels);
            for (std::size_t c = 0; c < row.size(); ++c) {
                row[c] = (share > 0 ? share * F_after[a.value_or(t)][c] : 0) +
                         (share < 1 ? (1 - share) * F_before[b.value_or(t)][c] : 0);
            }
        }
        return F;
    };
    return plain_evaluation<Real>(run.phi, z, sigma, rule);
}

/// A processor that counts its runs and is otherwise another one.
template <class Processor>
struct counting_processor {
    Processor* of;
    std::size_t* runs;

    template <attention_call Call>
    typename Call::features_type operator()(Call& call) const {
        ++*runs;
        return (*of)(call);
    }
    bool is_plain_at(attention_place place) const { return genrender::is_plain_at(*of, place); }
};

/// The reference network, counting the runs of its self-attention modules.
struct counting_network {
    using real_type = float;
    using features_type = reference_network<float>::features_type;
    using residuals_type = reference_network<float>::residuals_type;

    reference_network<float> const* network;
    std::size_t* runs;

    std::size_t latent_channels() const { return network->latent_channels(); }
    grid_extents latent_grid() const { return network->latent_grid(); }
    std::span<attention_site const> sites() const { return network->sites(); }
    std::size_t branches() const { return network->branches(); }
    std::size_t residual_bytes() const { return network->residual_bytes(); }

    template <class Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor, residuals_type const& lent = {}) const {
        counting_processor<Processor> const counting{&processor, runs};
        (*network)(x0, z, sigma, frames, counting, lent);
    }
    template <class Processor>
    void run_until(strided_view<float const, 4> z, float sigma, std::span<frame_index const> frames,
                   Processor& processor, std::span<std::optional<site_index> const> last,
                   residuals_type* lent = nullptr) const {
        counting_processor<Processor> const counting{&processor, runs};
        network->run_until(z, sigma, frames, counting, last, lent);
    }
};

std::vector<frame_index> frames_of(std::vector<std::uint32_t> const& numbers) {
    std::vector<frame_index> frames;
    for (auto const number : numbers) {
        frames.push_back({number});
    }
    return frames;
}

} // namespace

TEST_SUITE("baselines/tokenflow") {
    TEST_CASE_TEMPLATE("[GR sec. 4: TokenFlow*] an evaluation equals the plainly written method", Real, float, double) {
        small_baseline_run<Real> run;
        auto const z = run.noise();
        for (std::size_t step = 0; step < 3; ++step) {
            auto const KF = draw_keyframes(run.settings.keyframes, run.frames, step);
            auto const x0 = run.estimate(tokenflow{}, z, run.sigmas[step]);
            auto const expected = plain_tokenflow<Real>(run, to_view(z), run.sigmas[step], KF);
            for (std::size_t i = 0; i < run.frames; ++i) {
                CHECK(frame_difference<Real>(x0, expected.view(), i) < layered_tolerance<Real>);
            }
        }
    }
    TEST_CASE("any keyframes in any order equal the plainly written method") {
        small_baseline_run<double> run;
        auto const z = run.noise();
        run.settings.keyframes.drawing = keyframe_drawing::fixed;
        for (auto const& KF : {frames_of({0}), frames_of({5}), frames_of({2}), frames_of({5, 0}), frames_of({0, 4}),
                               frames_of({4, 1}), frames_of({3, 5, 0, 1, 4, 2})}) {
            run.settings.keyframes.frames = KF;
            auto const x0 = run.estimate(tokenflow{}, z, 3);
            auto const expected = plain_tokenflow<double>(run, to_view(z), 3, KF);
            for (std::size_t i = 0; i < run.frames; ++i) {
                CHECK(frame_difference<double>(x0, expected.view(), i) < layered_tolerance<double>);
            }
        }
    }
    TEST_CASE("animations of one and two frames equal the plainly written method") {
        for (auto const frames : {1, 2}) {
            small_baseline_run<double> run(static_cast<std::size_t>(frames));
            auto const z = run.noise();
            for (std::size_t count = 1; count <= run.frames; ++count) {
                run.settings.keyframes.count = count;
                auto const KF = draw_keyframes(run.settings.keyframes, run.frames, 1);
                auto const x0 = run.estimate(tokenflow{}, z, 3);
                auto const expected = plain_tokenflow<double>(run, to_view(z), 3, KF);
                for (std::size_t i = 0; i < run.frames; ++i) {
                    CHECK(frame_difference<double>(x0, expected.view(), i) < layered_tolerance<double>);
                }
            }
        }
    }
    TEST_CASE("with the temperature keyframes attend to each other as sharper queries do, and single ones as without") {
        small_baseline_run<double> run;
        auto const z = run.noise();
        auto const difference = [&](double power) {
            run.settings.injection.length_correction = power;
            return run.estimate(tokenflow{}, z, 3);
        };
        auto const without = difference(0);
        auto const with = difference(1);
        CHECK(frame_difference<double>(with, to_view(without), 0) > 1e-3);
        run.settings.keyframes.count = 1;
        auto const alone = difference(0);
        CHECK(frame_difference<double>(difference(1), to_view(alone), 0) == 0);
    }
    TEST_CASE("a keyframe keeps the estimate of the keyframes' own pass") {
        small_baseline_run<double> run;
        auto const z = run.noise();
        auto const KF = draw_keyframes(run.settings.keyframes, run.frames, 1);
        auto const x0 = run.estimate(tokenflow{}, z, 3);
        auto z_KF = latents<double>::from_shape({KF.size(), 3, 8, 8});
        auto x0_KF = z_KF;
        for (std::size_t k = 0; k < KF.size(); ++k) {
            copy(to_view(z_KF)[k], to_view(z)[KF[k].value]);
        }
        feature_bank<host_features<double>> bank(4, 2);
        recorder<host_features<double>> const record(bank, [](attention_place place) { return place.site.value > 0; });
        run.phi(to_view(x0_KF), to_view(std::as_const(z_KF)), 3, KF, record);
        for (std::size_t k = 0; k < KF.size(); ++k) {
            for (std::size_t e = 0; e < 3 * 64; ++e) {
                CHECK(x0.data()[KF[k].value * 3 * 64 + e] == x0_KF.data()[k * 3 * 64 + e]);
            }
        }
    }
    TEST_CASE("an animation of one frame is denoised as by itself") {
        small_baseline_run<double> run(1);
        auto const z = run.noise();
        auto const x0 = run.estimate(tokenflow{}, z, 3);
        run.settings.window_end = 0;
        auto const alone = run.estimate(tokenflow{}, z, 3);
        CHECK(frame_difference<double>(x0, to_view(alone), 0) < 1e-13);
    }
    TEST_CASE("identical frames give identical estimates") {
        small_baseline_run<double> run;
        run.phi.conditioning = 0;
        // The first frame's maps and latents for all frames.
        for (std::size_t i = 1; i < run.frames; ++i) {
            for (std::size_t p = 0; p < 32 * 32; ++p) {
                run.maps.uv(i, p / 32, p % 32, 0) = run.maps.uv(0, p / 32, p % 32, 0);
                run.maps.uv(i, p / 32, p % 32, 1) = run.maps.uv(0, p / 32, p % 32, 1);
                run.maps.object(i, p / 32, p % 32) = run.maps.object(0, p / 32, p % 32);
                run.maps.coverage(i, p / 32, p % 32) = run.maps.coverage(0, p / 32, p % 32);
            }
        }
        // So many texels that no two tokens share one.
        run.grids = {};
        for (auto const grid : {run.phi.grid, run.phi.coarse}) {
            run.grids.add(grid, [&](grid_extents g) { return texel_grid(to_uv_view(run.maps), g, {.T = 256}); });
        }
        auto z = run.noise();
        for (std::size_t i = 1; i < run.frames; ++i) {
            copy(to_view(z)[i], in_view<double, 3>(to_view(z)[0]));
        }
        auto const x0 = run.estimate(tokenflow{}, z, 3);
        for (std::size_t i = 1; i < run.frames; ++i) {
            for (std::size_t e = 0; e < 3 * 64; ++e) {
                CHECK(x0.data()[i * 3 * 64 + e] == doctest::Approx(x0.data()[e]).epsilon(1e-12));
            }
        }
    }
    TEST_CASE("layers decide who takes part and outside the window every frame is by itself") {
        small_baseline_run<double> run;
        auto const z = run.noise();
        auto const x0 = run.estimate(tokenflow{}, z, 3);
        run.settings.layers = [](attention_site const& site, std::uint32_t branch) {
            return is_in_decoder(site, branch) && branch == 1;
        };
        auto const conditional = run.estimate(tokenflow{}, z, 3);
        run.settings.layers = [](attention_site const&, std::uint32_t) { return false; };
        auto const nobody = run.estimate(tokenflow{}, z, 3);
        CHECK(frame_difference<double>(x0, to_view(conditional), 3) > 1e-3);
        CHECK(frame_difference<double>(conditional, to_view(nobody), 3) > 1e-3);
        run.settings.layers = is_in_decoder;
        run.settings.window_end = 0.3; // Sigma 3 belongs to the second of three steps.
        auto const outside = run.estimate(tokenflow{}, z, 3);
        for (std::size_t i = 0; i < run.frames; ++i) {
            CHECK(frame_difference<double>(outside, to_view(nobody), i) == 0);
        }
    }
    TEST_CASE("the way down of keyframes is not run again and the result is the same to the bit") {
        stack<float, 3> depth({3, 8, 12});
        for (std::size_t e = 0; e < depth.size(); ++e) {
            depth.data()[e] = static_cast<float>(e % 7) / 7;
        }
        auto const network = seeded_network(small_conditioning<float>(depth, 1));
        auto const maps = random_scene(33, 3, {16, 24}, 2);
        std::size_t runs = 0;
        counting_network const phi{&network, &runs};
        static_assert(residual_lender<counting_network>);
        auto const run = [&](bool reuses) {
            render_settings<float> settings = render_settings<float>::plain();
            settings.steps = 3;
            settings.keyframes.count = 2;
            settings.reuses_keyframes = reuses;
            runs = 0;
            return render<tokenflow>(phi, to_uv_view(maps), {.settings = settings}).z;
        };
        // Two branches of six sites, of which the decoder has two: one pass of the keyframes and one of each frame.
        auto const expected = run(false);
        CHECK(runs == 3 * 2 * (6 + 3 * 6));
        CHECK(run(true) == expected);
        CHECK(runs == 3 * 2 * (6 + 6 + 2 * 2));
    }
    TEST_CASE_TEMPLATE("it keeps the laws of sequence methods with every sampler", Real, float, double) {
        auto const maps = random_scene(33, 5, {32, 32}, 3);
        layered_denoiser<Real> const phi;
        render_settings<Real> settings = render_settings<Real>::plain();
        settings.steps = 3;
        settings.keyframes.count = 2;
        settings.window_end = Real(0.7);
        for (auto const method : {sampler_kind::euler, sampler_kind::heun, sampler_kind::dpmpp_2m}) {
            settings.sampler = method;
            CHECK(check_sequence_method_laws(tokenflow{}, phi, to_uv_view(maps), settings).text() == "");
        }
    }
    TEST_CASE("the report tells how many tokens on objects found a match") {
        auto const maps = random_scene(33, 5, {32, 32}, 3);
        layered_denoiser<double> const phi;
        auto settings = few_steps();
        settings.keyframes.count = 5;
        auto const report = render<tokenflow>(phi, to_uv_view(maps), {.settings = settings}).report;
        CHECK(report.coverage.at({8, 8}).share() == 1); // keyframes all
        settings.keyframes.count = 1;
        auto const few = render<tokenflow>(phi, to_uv_view(maps), {.settings = settings}).report;
        CHECK(few.coverage.at({8, 8}).on_objects == report.coverage.at({8, 8}).on_objects);
        CHECK(few.coverage.at({8, 8}).share() > 0.3);
        CHECK(few.coverage.at({8, 8}).share() < 1);
    }
    TEST_CASE("keyframes that cannot be drawn are refused before anything runs") {
        auto const maps = random_scene(33, 3, {32, 32}, 3);
        layered_denoiser<double> const phi;
        auto settings = baseline_settings(few_steps());
        settings.keyframes.count = 4;
        CHECK_THROWS_WITH_AS(render<tokenflow>(phi, to_uv_view(maps), {.settings = settings}),
                             "draw_keyframes: count is 4, expected 1 to the animation's 3 frames", value_error);
        CHECK(phi.weights[0].queries == 0);
    }
}
