// SPDX-License-Identifier: MIT
// An engine's call behind one type gives processors what it gives them by itself.
#include <genrender/attention/any_attention_call.hpp>

#include <genrender/attention/plain_attention.hpp>
#include <genrender/injection/host_attention_call.hpp>
#include <genrender/testing/analytic_denoiser.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

using namespace genrender;

namespace {

using host_call = host_attention_call<float, testing::identity_projections>;
using host = host_features<float>;

bool is_same(host const& a, host const& b) {
    return a.extents() == b.extents() && std::vector<float>(a.view().data(), a.view().data() + a.view().size()) ==
                                             std::vector<float>(b.view().data(), b.view().data() + b.view().size());
}

struct held_world {
    std::array<frame_index, 2> frames{{{4}, {7}}};
    host f = host::allocate({2, 3, 4});
    testing::identity_projections module;
    host_call call;
    held_attention_call<host_call> held;
    any_attention_call<float>& any = held;

    held_world() : call({{2}, 1}, frames, filled(f), module), held(call) {}
    held_world(held_world const&) = delete;
    static host filled(host f) {
        for (std::size_t e = 0; e < f.view().size(); ++e) {
            f.view().data()[e] = static_cast<float>(e % 7) / 3;
        }
        return f;
    }
};

} // namespace

TEST_SUITE("attention/any_attention_call") {
    TEST_CASE("it is a storing attention call that tells place, frames and input of the engine's") {
        CHECK(storing_attention_call<any_attention_call<float>>);
        held_world world;
        CHECK(world.any.place() == attention_place{{2}, 1});
        CHECK(world.any.frames().data() == world.frames.data());
        CHECK(world.any.f().as<host>().view().data() == world.f.view().data());
    }
    TEST_CASE("plain attention gives the same features by it") {
        held_world world;
        plain_attention const plain;
        CHECK(is_same(plain(world.any).as<host>(), plain(world.call)));
    }
    TEST_CASE("what frames attend to keeps its meaning by it") {
        struct asking_call {
            using features_type = int;
            using real_type = float;
            attention_meaning* found;
            explicit asking_call(attention_meaning* where) : found(where) {}
            attention_place place() const { return {}; }
            std::span<frame_index const> frames() const { return {}; }
            int f() const { return 0; }
            int query(int x) const { return x; }
            int key(int x) const { return x; }
            int value(int x) const { return x; }
            int attend(int, attention_sources<int> const& sources) const {
                *found = sources.pattern().meaning;
                return *sources.pattern().K + *sources[1].front().V;
            }
            int mix(int F_hat, int, std::span<sparse_rows<float> const>, float) const { return F_hat; }
        };
        auto found = attention_meaning::listed;
        asking_call call(&found);
        held_attention_call<asking_call> const held(call);
        auto const K = any_features::of(3);
        auto const V = any_features::of(4);
        auto const F = held.attend(K, attention_sources<any_features>::stack(K, V, 2));
        CHECK(found == attention_meaning::stack);
        CHECK(F.as<int>() == 7);
        auto const all = held.project(any_features::of(5));
        CHECK(all.Q.as<int>() + all.K.as<int>() + all.V.as<int>() == 15);
    }
    TEST_CASE("mixing gives the same features by it") {
        held_world world;
        std::array<std::uint32_t, 4> const offsets{0, 2, 2, 3};
        std::array<std::uint32_t, 3> const sources{5, 0, 1};
        std::array<float, 3> const weights{0.25f, 0.75f, 1};
        std::vector<sparse_rows<float>> const rows(2, sparse_rows<float>{offsets, sources, weights});
        auto const copy = [&] { return host::rounded(in_view<float, 3>(world.f.view()), feature_storage::same); };
        auto const expected = world.call.mix(copy(), world.f, rows, 0.5f);
        auto const found = world.any.mix(any_features::of(copy()), any_features::of(world.f), rows, 0.5f);
        CHECK(is_same(found.as<host>(), expected));
        CHECK_FALSE(is_same(found.as<host>(), world.f));
    }
    TEST_CASE("features of another engine are refused") {
        held_world world;
        CHECK_THROWS_AS(world.any.query(any_features::of(3)), value_error);
    }
    TEST_CASE("it stores features as the engine's call does") {
        held_world world;
        auto const kept = world.any.stored(world.any.f(), feature_storage::f16);
        CHECK(kept.as<host>().storage() == feature_storage::f16);
    }
}
