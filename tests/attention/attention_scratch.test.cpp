// SPDX-License-Identifier: MIT
// [GR eq. 1] Keys of blocks in a row of tiles, and queries in and out of the lanes.
#include <genrender/attention/attention_scratch.hpp>

#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include "support/random_stack.hpp"

#include <algorithm>
#include <vector>

using namespace genrender;
using genrender::testing::random_stack;

TEST_SUITE("attention/attention_scratch") {
    TEST_CASE_TEMPLATE("tiles hold the keys of all blocks in a row whatever their sizes", Real, float, double) {
        constexpr std::size_t head_size = 3;
        auto const K = random_stack<Real, 2>({200, 2 * head_size}, 1);
        auto const V = random_stack<Real, 2>({200, 2 * head_size}, 2);
        std::vector<Real> const halves(13, Real{0.5});
        std::vector<key_value_view<Real>> blocks;
        std::size_t begin = 0;
        for (auto const count : std::vector<std::size_t>{0, 1, 50, 0, 136, 13}) {
            blocks.push_back({K.view().slice(begin, count), V.view().slice(begin, count)});
            begin += count;
        }
        blocks.back().counts = {halves.data(), {13}};
        detail::scratch_memory<Real> memory(detail::key_tiles<Real>::scratch(head_size));
        detail::key_tiles<Real> tiles(blocks, 1, head_size, memory);
        std::size_t key = 0;
        while (tiles.next()) {
            auto const& tile = tiles.tile();
            CHECK(tile.keys % detail::strip_rows == 0);
            for (std::size_t k = 0; k < tile.keys; ++k, ++key) {
                for (std::size_t c = 0; c < head_size; ++c) {
                    auto const count = key < 187 ? Real{1} : (key < 200 ? Real{0.5} : Real{0});
                    CHECK(tile.counts[k] == count);
                    CHECK(tile.K[k * head_size + c] == K(std::min<std::size_t>(key, 199), head_size + c));
                    CHECK(tile.V[k * head_size + c] == (key < 200 ? count * V(key, head_size + c) : Real{0}));
                }
            }
        }
        CHECK(key == 204);
    }

    TEST_CASE_TEMPLATE("queries that go into a tile come out of it", Real, float, double) {
        constexpr auto registers = detail::tile_registers;
        using tile_type = detail::query_tile<Real, registers>;
        for (auto const channels : std::vector<std::size_t>{1, 5, 16, 17, 40}) {
            for (auto const count : {std::size_t{1}, tile_type::queries - 1, tile_type::queries}) {
                auto const Q = random_stack<Real, 2>({count, channels}, 1);
                std::vector<Real> memory(tile_type::size(channels), Real{7});
                tile_type const tile(memory.data(), channels);
                detail::read_queries<Real>(tile, Q.view(), Real{2});
                for (std::size_t q = 0; q < tile_type::queries; ++q) {
                    CHECK(tile.Q[(channels - 1) * tile_type::queries + q] ==
                          (q < count ? 2 * Q(q, channels - 1) : Real{0}));
                    CHECK(tile.shift[q] == 0);
                    CHECK(tile.sum[q] == 0);
                    CHECK(tile.F[q] == 0);
                    tile.sum[q] = 4;
                }
                std::copy_n(tile.Q, channels * tile_type::queries, tile.F);
                stack<Real, 2> F({count, channels});
                detail::write_results(F.view(), tile);
                for (std::size_t q = 0; q < count; ++q) {
                    for (std::size_t c = 0; c < channels; ++c) {
                        CHECK(F(q, c) == Q(q, c) / 2);
                    }
                }
            }
        }
    }

    TEST_CASE("16-bit rows are read as the numbers they store") {
        stack<float16, 2> half({2, 37});
        stack<bfloat16, 2> brain({2, 37});
        for (std::size_t c = 0; c < 37; ++c) {
            half(1, c) = static_cast<float16>(0.37F * static_cast<float>(c) - 3);
            brain(1, c) = static_cast<bfloat16>(0.37F * static_cast<float>(c) - 3);
        }
        std::vector<float> row(37);
        detail::read_rows(row.data(), strided_view<float16 const, 2>(half), 1, 1);
        for (std::size_t c = 0; c < 37; ++c) {
            CHECK(row[c] == static_cast<float>(half(1, c)));
        }
        std::vector<double> wide(37);
        detail::read_rows(wide.data(), strided_view<bfloat16 const, 2>(brain), 1, 1);
        for (std::size_t c = 0; c < 37; ++c) {
            CHECK(wide[c] == static_cast<double>(brain(1, c)));
        }
    }
}
