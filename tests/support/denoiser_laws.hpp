// SPDX-License-Identifier: MIT
// What every denoiser owes beyond its concept, as checks for the library's models and for users' own.
#pragma once

#include "random_stack.hpp"

#include <genrender/attention/plain_attention.hpp>
#include <genrender/sampling/denoiser.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

namespace genrender::testing {

/// Plain attention that counts the calls and the frames of each place.
struct counting_attention {
    std::map<attention_place, std::size_t>* calls;
    std::size_t frames;
    std::mutex* mutex;

    template <attention_call Call>
    typename Call::features_type operator()(Call& call) const {
        {
            std::lock_guard const lock(*mutex);
            ++(*calls)[call.place()];
            CHECK(call.frames().size() == frames);
        }
        return plain_attention{}(call);
    }
};

/// Checks the laws of denoiser at one noise level for the frames 0, 1 and 2 of its animation.
template <denoiser Phi>
void check_denoiser_laws(Phi const& phi, typename Phi::real_type sigma) {
    using Real = typename Phi::real_type;
    auto const grid = grid_extents(phi.latent_grid());
    std::array<std::size_t, 4> const extents{3, std::size_t(phi.latent_channels()), grid.height, grid.width};
    auto const z = random_stack<Real>(extents, 7);
    auto const before = z;
    std::vector<frame_index> const frames{{0}, {1}, {2}};
    plain_attention const plain;

    stack<Real, 4> together(extents);
    phi(together.view(), z.view(), sigma, frames, plain);
    for (std::size_t e = 0; e < z.size(); ++e) {
        REQUIRE(z.data()[e] == before.data()[e]); // z is not changed
        REQUIRE(std::isfinite(together.data()[e]));
    }

    // Equal arguments give equal results.
    {
        stack<Real, 4> again(extents);
        phi(again.view(), z.view(), sigma, frames, plain);
        for (std::size_t e = 0; e < z.size(); ++e) {
            REQUIRE(again.data()[e] == together.data()[e]);
        }
    }
    // With plain attention a frame does not depend on the others of the stack.
    {
        for (std::uint32_t i = 0; i < 3; ++i) {
            stack<Real, 4> alone({1, extents[1], extents[2], extents[3]});
            phi(alone.view(), z.view().slice(i, 1), sigma, std::array{frame_index{i}}, plain);
            for (std::size_t e = 0; e < alone.size(); ++e) {
                REQUIRE(alone.data()[e] == doctest::Approx(together.data()[i * alone.size() + e]).epsilon(1e-5));
            }
        }
    }
    // Every site is run once per branch, with all frames at once.
    {
        std::map<attention_place, std::size_t> calls;
        std::mutex mutex;
        counting_attention const counting{&calls, 3, &mutex};
        stack<Real, 4> counted(extents);
        phi(counted.view(), z.view(), sigma, frames, counting);
        CHECK(calls.size() == std::size(phi.sites()) * phi.branches());
        for (auto const& [place, count] : calls) {
            CHECK(place.site.value < std::size(phi.sites()));
            CHECK(place.branch < phi.branches());
            CHECK(count == 1);
        }
    }
}

} // namespace genrender::testing
