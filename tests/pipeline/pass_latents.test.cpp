// SPDX-License-Identifier: MIT
// [GR alg. 1: z] Stacks of frames of latents in host memory and of latents that are lent.
#include <genrender/pipeline/pass_latents.hpp>

#include "../support/device_denoiser.hpp"

#include <genrender/testing/analytic_denoiser.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

TEST_SUITE("pipeline/pass_latents") {
    using namespace genrender;
    using host_denoiser = testing::analytic_denoiser<double>;
    using on_device = testing::device_denoiser<host_denoiser>;
    static_assert(std::is_same_v<run_latents<host_denoiser>, latents<double>>);
    static_assert(std::is_same_v<run_latents<on_device>, lent_latents<on_device>>);

    namespace {

    /// Five frames of one channel of 1 x 2, frame i full of i.
    latents<double> counted() {
        auto z = latents<double>::from_shape({5, 1, 1, 2});
        for (std::size_t e = 0; e < z.size(); ++e) {
            z.data()[e] = static_cast<double>(e / 2);
        }
        return z;
    }

    /// The first element of each frame.
    template <class View>
    std::vector<double> firsts(View const& z) {
        std::vector<double> values;
        for (std::size_t i = 0; i < z.extent(0); ++i) {
            values.push_back(z(i, 0, 0, 0));
        }
        return values;
    }
    std::vector<double> firsts_of(testing::device_memory<double> const& z) { return firsts(z.read().view()); }

    using numbers = std::vector<double>;

    } // namespace

    TEST_CASE("in host memory calls read frames of z and write their estimates into x0") {
        host_denoiser const phi{.grid = {1, 2}, .channels = 1};
        auto const z = counted();
        auto x0 = estimates_for(z);
        x0.fill(-1);
        pass_latents<host_denoiser> pass(phi, x0, z);
        CHECK(pass.frame_count() == 5);
        pass.read(std::array<frame_index, 3>{{{4}, {0}, {2}}}, [](auto const& of_call) {
            CHECK(firsts(of_call) == numbers{4, 0, 2});
        });
        pass.read_and_drop(std::array<frame_index, 2>{{{3}, {1}}}, [](auto const& dropped, auto const& of_call) {
            CHECK(firsts(of_call) == numbers{3, 1});
            dropped(0, 0, 0, 0) = 99;
        });
        auto const add_10 = [](auto const& to, auto const& of_call) {
            for (std::size_t i = 0; i < to.size(); ++i) {
                to.data()[i] = of_call.data()[i] + 10;
            }
        };
        pass.begin(2);
        pass.write(0, std::array<frame_index, 3>{{{0}, {1}, {2}}}, 3, add_10);
        pass.write(1, std::array<frame_index, 3>{{{3}, {4}, {4}}}, 2, add_10);
        pass.end();
        CHECK(firsts(to_view(x0)) == numbers{10, 11, 12, 13, 14});
        CHECK(firsts(to_view(z)) == numbers{0, 1, 2, 3, 4});
    }
    TEST_CASE("lent latents are read and written by handles, whatever the order of calls") {
        on_device const phi{{.grid = {1, 2}, .channels = 1}};
        auto const z = counted();
        lent_latents<on_device> const lent(phi, to_view(z));
        auto x0 = estimates_for(lent);
        pass_latents<on_device> pass(phi, x0, lent);
        CHECK(pass.frame_count() == 5);
        pass.read(std::array<frame_index, 3>{{{4}, {0}, {2}}}, [](auto const& of_call) {
            CHECK(firsts_of(of_call) == numbers{4, 0, 2});
        });
        pass.read_and_drop(std::array<frame_index, 2>{{{3}, {1}}}, [](auto const& of_call) {
            CHECK(firsts_of(of_call) == numbers{3, 1});
            return of_call;
        });
        auto const twice = [&](auto const& of_call) {
            return phi.combination(std::array{2.0}, std::span<testing::device_memory<double> const>(&of_call, 1));
        };
        for (auto const fills : {true, false}) {
            pass.begin(2);
            if (fills) {
                pass.write(1, std::array<frame_index, 3>{{{3}, {4}, {4}}}, 2, twice);
            } else {
                pass.write(1, std::array<frame_index, 2>{{{3}, {4}}}, 2, twice);
            }
            pass.write(0, std::array<frame_index, 3>{{{0}, {1}, {2}}}, 3, twice);
            pass.end();
            CHECK(firsts_of(x0.handle()) == numbers{0, 2, 4, 6, 8});
        }
        CHECK(firsts_of(lent.handle()) == numbers{0, 1, 2, 3, 4});
        CHECK(phi.counts->downloads == 0);
    }
    TEST_CASE("a change on the host reaches latents in host memory and lent ones") {
        on_device const phi{{.grid = {1, 2}, .channels = 1}};
        auto z = counted();
        lent_latents<on_device> lent(phi, to_view(std::as_const(z)));
        auto const change = [](strided_view<double, 4> view) { view(3, 0, 0, 0) = -3; };
        on_host(z, change);
        on_host(lent, change);
        CHECK(firsts(to_view(z)) == numbers{0, 1, 2, -3, 4});
        CHECK(firsts_of(lent.handle()) == numbers{0, 1, 2, -3, 4});
    }
}
