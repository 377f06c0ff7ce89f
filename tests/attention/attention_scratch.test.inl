// SPDX-License-Identifier: MIT
// What is checked of what goes into tiles of one target and comes out of them.

namespace genrender::testing::GENRENDER_TARGET {

using namespace genrender::detail;
using namespace genrender::detail::GENRENDER_TARGET_NAME;

template <class Real>
void check_tiles_of_blocks() {
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
    for (auto const in_place : {false, true}) {
        CAPTURE(in_place);
        stack<Real, 1> memory({key_tiles<Real>::scratch(head_size)});
        key_tiles<Real> tiles(blocks, 1, head_size, memory.data(), in_place);
        std::size_t key = 0;
        while (tiles.next()) {
            auto const& tile = tiles.tile();
            CHECK(tile.is_far == in_place);
            CHECK(tiles.is_last() == (key + tile.keys == 200));
            for (std::size_t k = 0; k < tile.keys; ++k, ++key) {
                auto const count = key < 187 ? Real{1} : Real{0.5};
                CHECK(tile.counts[k] == count);
                for (std::size_t c = 0; c < head_size; ++c) {
                    CHECK(tile.K[k][c] == K(key, head_size + c));
                    CHECK(tile.V[k][c] == count * V(key, head_size + c));
                }
                // Copied only where they must be: values that count more or less than once.
                CHECK((tile.K[k] == &K(key, head_size)) == in_place);
                CHECK((tile.V[k] == &V(key, head_size)) == (in_place && key < 187));
            }
            for (auto k = tile.keys; k < tile_keys; ++k) {
                CHECK(tile.counts[k] == 0);
                CHECK(tile.K[k] == tile.K[tile.keys - 1]);
                CHECK(tile.V[k] == tile.V[tile.keys - 1]);
            }
        }
        CHECK(key == 200);
    }
}

inline void check_copies_of_keys() {
    auto const K = random_stack<float, 2>({4, 5}, 1);
    stack<bfloat16, 2> V({5, 4});
    V(2, 1) = static_cast<bfloat16>(3);
    std::vector<key_value_view<float>> const blocks{
        {strided_view<float const, 2>(K.data(), {5, 4}, {1, 5}), std::as_const(V).view()}};
    stack<float, 1> memory({key_tiles<float>::scratch(4)});
    key_tiles<float> tiles(blocks, 0, 4, memory.data(), true);
    REQUIRE(tiles.next());
    CHECK(tiles.tile().keys == 5);
    CHECK(tiles.tile().K[2][3] == K(3, 2));
    CHECK(tiles.tile().V[2][1] == 3);
    CHECK_FALSE(tiles.next());
}

template <class Real>
void check_queries_in_and_out() {
    constexpr auto registers = tile_registers;
    using tile_type = query_tile<Real, registers>;
    for (auto const channels : std::vector<std::size_t>{1, 5, 16, 17, 40}) {
        for (auto const count : {std::size_t{1}, tile_type::queries - 1, tile_type::queries}) {
            auto const Q = random_stack<Real, 2>({count, channels}, 1);
            std::vector<Real> memory(tile_type::size(channels), Real{7});
            tile_type const tile(memory.data(), channels);
            read_queries<Real>(tile, Q.view(), Real{2});
            for (std::size_t q = 0; q < tile_type::queries; ++q) {
                CHECK(tile.Q[(channels - 1) * tile_type::queries + q] ==
                      (q < count ? 2 * Q(q, channels - 1) : Real{0}));
                CHECK(tile.shift[q] == 0);
                CHECK(tile.sum[q] == 0);
                tile.sum[q] = 4;
            }
            std::copy_n(tile.Q, channels * tile_type::queries, tile.F);
            stack<Real, 2> F({count, channels});
            write_results(F.view(), tile);
            for (std::size_t q = 0; q < count; ++q) {
                for (std::size_t c = 0; c < channels; ++c) {
                    CHECK(F(q, c) == Q(q, c) / 2);
                }
            }
        }
    }
}

inline void check_half_rows() {
    stack<float16, 2> half({2, 37});
    stack<bfloat16, 2> brain({2, 37});
    for (std::size_t c = 0; c < 37; ++c) {
        half(1, c) = static_cast<float16>(0.37F * static_cast<float>(c) - 3);
        brain(1, c) = static_cast<bfloat16>(0.37F * static_cast<float>(c) - 3);
    }
    std::vector<float> row(37);
    read_rows(row.data(), to_bits_view(std::as_const(half).view()), 1, 1);
    for (std::size_t c = 0; c < 37; ++c) {
        CHECK(row[c] == static_cast<float>(half(1, c)));
    }
    std::vector<double> wide(37);
    read_rows(wide.data(), to_bits_view(std::as_const(brain).view()), 1, 1);
    for (std::size_t c = 0; c < 37; ++c) {
        CHECK(wide[c] == static_cast<double>(brain(1, c)));
    }
}

} // namespace genrender::testing::GENRENDER_TARGET
