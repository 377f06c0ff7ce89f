// SPDX-License-Identifier: MIT
// A program that uses a little of everything and is compiled as hosts are: without run-time types, with their macros,
// with -ffast-math. `host FILE` writes its figures; `host FILE BOUND` compares them with those of another build.
#include <genrender/genrender.hpp>
#include <genrender/scene.hpp>

#if defined(GENRENDER_HOST_MACROS)
#if !defined(near) || !defined(far) || !defined(small) || !defined(I) || !defined(EPS) || max(1, 2) != 2 ||            \
    min(1, 2) != 1
#error "the host has lost its macros"
#endif
#undef min
#undef max
#undef near
#undef far
#undef small
#undef I
#undef EPS
#endif

#include <genrender/testing/analytic_denoiser.hpp>
#include "../support/slanted_maps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

namespace {

using namespace genrender;
using figures = std::vector<std::pair<std::string, std::vector<double>>>;

/// Numbers in [-1, 1] without a pattern, the same in every build.
std::vector<float> numbers(std::size_t count, std::uint32_t state) {
    std::vector<float> values;
    while (values.size() < count) {
        state = state * 1664525U + 1013904223U;
        values.push_back(static_cast<float>(state >> 8U) / 8388608.0F - 1);
    }
    return values;
}

std::vector<double> all(float const* values, std::size_t count) { return {values, values + count}; }

/// Ten tokens of eight channels attend to two blocks of keys and are mixed with keyframes.
void attend_and_mix(figures& found) {
    auto const Q = numbers(80, 1);
    auto const K = numbers(160, 2);
    auto const V = numbers(160, 3);
    std::vector<float> F(80);
    strided_view<float, 2> const out(F.data(), {10, 8});
    strided_view<float const, 3> const keys(K.data(), {2, 10, 8});
    strided_view<float const, 3> const values(V.data(), {2, 10, 8});
    std::array<key_value_view<float>, 2> const blocks{key_value_view<float>{keys[0], values[0]},
                                                      key_value_view<float>{keys[1], values[1]}};
    scaled_dot_product(out, strided_view<float const, 2>(Q.data(), {10, 8}), blocks, 2);
    found.emplace_back("attention", all(F.data(), F.size()));

    std::array<std::uint32_t, 11> offsets{};
    std::vector<std::uint32_t> sources;
    std::vector<float> weights;
    for (std::uint32_t t = 0; t < 10; ++t) {
        sources.push_back(t);
        sources.push_back(19 - t);
        weights.push_back(0.25F);
        weights.push_back(0.75F);
        offsets[t + 1] = 2 * (t + 1);
    }
    mix_rows(out, keys, {offsets, sources, weights}, 0.7F);
    found.emplace_back("mixing", all(F.data(), F.size()));
}

/// A box, drawn; a slanted surface, its noise, its correspondence and runs by every sampler.
void render_a_box(figures& found) {
    struct standing_box {
        std::shared_ptr<mesh const> box = std::make_shared<mesh const>(make_box({1, 1, 1}));
        std::size_t frame_count() const { return 3; }
        posed_scene frame(frame_index i) const {
            return {look_at({0.3F, 0.4F, 2.5F}, {0, 0, 0}, 0.8F), {pose({i.value % 2}, box, glm::mat4(1))}};
        }
    };
    auto const drawn = rasterize(standing_box{}, {32, 32});
    found.emplace_back("drawn depth", all(drawn.depth.depth.data(), drawn.depth.depth.size()));

    auto const maps = testing::slanted_maps(3);
    auto const UV = to_uv_view(maps);
    auto z = latents<float>::from_shape({3, 2, 16, 16});
    std::array<frame_index, 3> const frames{{{0}, {1}, {2}}};
    initial_noise(to_view(z), UV, frames, {.seed = 5});
    found.emplace_back("surface noise", all(z.data(), z.size()));

    footprint_map const map(UV, {16, 16});
    std::vector<double> tokens;
    for (std::uint32_t t = 0; t < 256; ++t) {
        auto const point = map.point_at({0}, {t});
        auto const token = point ? map.token_at({2}, *point) : std::nullopt;
        tokens.push_back(token ? token->value : -1.0);
    }
    found.emplace_back("tokens of footprints", tokens);

    testing::analytic_denoiser<float> const phi{.grid = {16, 16}, .attention = 0.5F};
    for (auto const method : {sampler_kind::euler, sampler_kind::heun, sampler_kind::dpmpp_2m}) {
        auto settings = render_settings<float>::plain(); // A consensus spreads values on a border over all frames.
        settings.steps = 4;
        settings.sampler = method;
        settings.keyframes.count = 2;
        auto const z_0 = render(phi, UV, {.settings = settings}).z;
        found.emplace_back("frames of sampler " + std::to_string(static_cast<int>(method)),
                           all(z_0.data(), z_0.size()));
    }
}

/// Whether `call` is refused with a text that holds `what`.
bool is_refused(char const* what, std::function<void()> const& call) {
    try {
        call();
    } catch (value_error const& refusal) {
        return std::string(refusal.what()).find(what) != std::string::npos;
    }
    std::cerr << "not refused: " << what << '\n';
    return false;
}

/// NaN and infinity, which a compiler that assumes finite numbers would not let a program write.
float from_bits(std::uint32_t bits) {
    float value = 0;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
}

/// What is not finite is refused, whatever the flags.
bool refuses_what_is_not_finite() {
    bool refused = true;
    for (auto const bits : {0x7FC00000U, 0x7F800000U, 0xFF800000U}) {
        auto maps = testing::slanted_maps(2);
        std::memcpy(&maps.uv(1, 30, 30, 0), &bits, sizeof(bits));
        testing::analytic_denoiser<float> const phi{.grid = {16, 16}};
        render_settings<float> settings;
        settings.steps = 2;
        settings.keyframes.count = 1;
        refused =
            refused &&
            is_refused("UV of frame 1 at row 30", [&] { render(phi, to_uv_view(maps), {.settings = settings}); }) &&
            is_refused("maps", [&] {
                footprint_map const map(to_uv_view(maps), {16, 16});
            });
        maps = testing::slanted_maps(2);
        settings.sigma_max = from_bits(bits);
        refused = refused && is_refused("sigma_max", [&] { render(phi, to_uv_view(maps), {.settings = settings}); });
        settings.sigma_max = 10;
        settings.alpha = [bits](std::size_t, attention_site const&) { return from_bits(bits); };
        refused = refused && is_refused("alpha", [&] { render(phi, to_uv_view(maps), {.settings = settings}); });
        refused = refused && is_refused("sigma", [&] { scalings_of(prediction::epsilon, from_bits(bits)); });
    }
    return refused;
}

/// Whether figures are those of the file: no more than a hundredth of each kind may differ by more than `bound` times
/// the greatest, which are places on a border that rounding moves to its other side.
bool compare(figures const& found, std::string const& path, double bound) {
    std::ifstream file(path);
    bool is_same = true;
    for (auto const& [name, values] : found) {
        std::vector<double> expected(values.size());
        double greatest = 0;
        for (auto& value : expected) {
            file >> value;
            greatest = std::max(greatest, std::abs(value));
        }
        std::size_t far_off = 0;
        for (std::size_t n = 0; n < values.size(); ++n) {
            far_off += !(std::abs(values[n] - expected[n]) <= bound * greatest);
        }
        std::cout << name << ": " << far_off << " of " << values.size() << " differ by more than " << bound
                  << " of the greatest\n";
        is_same = is_same && 100 * far_off <= values.size();
    }
    return is_same && static_cast<bool>(file);
}

} // namespace

int main(int argc, char** argv) {
    figures found;
    attend_and_mix(found);
    render_a_box(found);
    if (!refuses_what_is_not_finite()) {
        return 1;
    }
    if (argc == 3) {
        return compare(found, argv[1], std::stod(argv[2])) ? 0 : 1;
    }
    std::ofstream file(argv[1]);
    file.precision(17);
    for (auto const& [name, values] : found) {
        for (auto const value : values) {
            file << value << '\n';
        }
    }
    return file ? 0 : 1;
}
