// SPDX-License-Identifier: MIT
// What is checked of the tiles of one target: what a lane gets is its own.

namespace genrender::testing::GENRENDER_TARGET {

using namespace genrender::detail;
using namespace genrender::detail::GENRENDER_TARGET_NAME;

template <class Real>
std::vector<Real> random_numbers(std::size_t count, std::uint64_t seed) {
    std::vector<Real> values(count);
    for (std::size_t i = 0; i < count; ++i) {
        values[i] = static_cast<Real>(normal_value(seed, random_stream::test, {static_cast<std::uint32_t>(i), 0, 0}));
    }
    return values;
}

/// Rows of `K` and as many of `V` that follow each other, once each.
template <class Real>
key_tile<Real> keys_of(std::vector<Real> const& K, std::vector<Real> const& V, std::size_t head_size) {
    key_tile<Real> tile;
    tile.keys = K.size() / head_size;
    tile.head_size = head_size;
    tile.is_far = false;
    for (std::size_t k = 0; k < tile.keys; ++k) {
        tile.K[k] = K.data() + k * head_size;
        tile.V[k] = V.data() + k * head_size;
        tile.counts[k] = 1;
    }
    tile.repeat_last();
    return tile;
}

/// The tile's memory after some tiles of keys, in which the query `at` is `Q` and all others are 0.
template <class Real, std::size_t Registers>
struct attended {
    using tile_type = query_tile<Real, Registers>;
    std::vector<Real> memory;
    std::size_t at;
    std::size_t head_size;

    attended(std::vector<Real> const& Q, std::size_t at_query, std::vector<std::vector<Real>> runs, std::vector<Real> V)
        : memory(tile_type::size(Q.size())), at(at_query), head_size(Q.size()) {
        tile_type const tile(memory.data(), head_size);
        for (std::size_t c = 0; c < head_size; ++c) {
            tile.Q[c * tile_type::queries + at] = Q[c];
        }
        std::vector<Real> weights((tile_keys + 1) * tile_type::queries);
        bool fresh = true;
        for (auto const& K : runs) {
            attend_to_tile(tile, keys_of(K, V, head_size), weights.data(), fresh);
            fresh = false;
        }
    }

    Real result(std::size_t c) {
        tile_type const tile(memory.data(), head_size);
        return tile.F[c * tile_type::queries + at] / tile.sum[at];
    }
};

template <class Real>
void check_weights_of_logits() {
    // Logits 2 (once) and 0 (11 times) weigh by 4 and 1.
    std::vector<Real> K(12);
    std::vector<Real> V(12);
    K[7] = 1;
    V[7] = 15;
    attended<Real, 1> tile({2}, 0, {K}, V);
    CHECK(tile.result(0) == doctest::Approx(4));
}

template <class Real>
void check_any_lane() {
    constexpr std::size_t head_size = 23;
    auto const Q = random_numbers<Real>(head_size, 1);
    auto const V = random_numbers<Real>(tile_keys * head_size, 2);
    std::vector<std::vector<Real>> const runs{random_numbers<Real>(tile_keys * head_size, 3),
                                              random_numbers<Real>(strip_rows * head_size, 4)};
    attended<Real, 1> first(Q, 0, runs, V);
    using full = attended<Real, tile_registers>;
    for (auto const at : {std::size_t{0}, std::size_t{1}, full::tile_type::queries - 1}) {
        full other(Q, at, runs, V);
        for (std::size_t c = 0; c < head_size; ++c) {
            CHECK(other.result(c) == first.result(c));
        }
    }
}

template <class Real>
void check_rescaling_of_a_neighbour() {
    // Query 0 sees a logit of 1000 in the second strip, query 1 never leaves its headroom.
    using tile_type = query_tile<Real, 1>;
    constexpr std::size_t keys = 2 * strip_rows;
    auto const result = [](Real scale) {
        if (tile_type::queries < 2) {
            return Real{0};
        }
        std::vector<Real> memory(tile_type::size(2));
        tile_type const tile(memory.data(), 2);
        tile.Q[0] = scale;
        tile.Q[tile_type::queries + 1] = 1;
        std::vector<Real> K(keys * 2);
        std::vector<Real> V(keys * 2);
        for (std::size_t k = 0; k < keys; ++k) {
            K[2 * k] = k == keys - 1 ? Real{1} : Real{0};
            K[2 * k + 1] = static_cast<Real>(k) / 3;
            V[2 * k] = static_cast<Real>(k) / 7;
        }
        std::vector<Real> weights((tile_keys + 1) * tile_type::queries);
        attend_to_tile(tile, keys_of(K, V, 2), weights.data(), true);
        if (scale > 0) {
            CHECK(tile.F[0] / tile.sum[0] == doctest::Approx((keys - 1) / 7.0));
        }
        return tile.F[1] / tile.sum[1];
    };
    CHECK(result(1000) == result(0));
}

template <class Real>
void check_far_rows() {
    using tile_type = query_tile<Real, tile_registers>;
    for (auto const keys : {std::size_t{1}, strip_rows + 2, tile_keys}) {
        for (auto const head_size : {std::size_t{1}, std::size_t{19}, std::size_t{40}}) {
            auto const K = random_numbers<Real>(keys * head_size, 1);
            auto const V = random_numbers<Real>(keys * head_size, 2);
            auto const Q = random_numbers<Real>(tile_type::queries * head_size, 3);
            stack<Real, 2> results({tile_type::queries, head_size});
            // What stood in F before the first keys must not matter, and results are asked for, not written.
            auto const attended_to = [&](key_tile<Real> const& tile, strided_view<Real, 2> const& ahead) {
                std::vector<Real> memory(tile_type::size(head_size), std::numeric_limits<Real>::quiet_NaN());
                tile_type const to(memory.data(), head_size);
                std::copy(Q.begin(), Q.end(), to.Q);
                std::fill_n(to.shift, tile_type::queries, Real{0});
                std::fill_n(to.sum, tile_type::queries, Real{0});
                std::vector<Real> weights((tile_keys + 1) * tile_type::queries);
                attend_to_tile(to, tile, weights.data(), true, ahead);
                attend_to_tile(to, tile, weights.data(), false, ahead);
                return memory;
            };
            auto const near = keys_of(K, V, head_size);
            auto far = near;
            far.is_far = true;
            std::vector<std::vector<Real>> rows;
            for (std::size_t k = 0; k < keys; ++k) {
                rows.emplace_back(near.K[k], near.K[k] + head_size);
                far.K[k] = rows.back().data();
                rows.emplace_back(near.V[k], near.V[k] + head_size);
                far.V[k] = rows.back().data();
            }
            far.repeat_last();
            CHECK(attended_to(far, results.view()) == attended_to(near, {}));
            CHECK(std::count(results.data(), results.data() + results.size(), Real{0}) ==
                  static_cast<std::ptrdiff_t>(results.size()));
        }
    }
}

} // namespace genrender::testing::GENRENDER_TARGET
