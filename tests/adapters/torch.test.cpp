// SPDX-License-Identifier: MIT
// The attention call of LibTorch against the library's own call of the same module.
#include <genrender/adapters/torch.hpp>

#include <genrender/attention/host_features.hpp>
#include <genrender/core/half_precision.hpp>
#include <genrender/injection/host_attention_call.hpp>

#include <ATen/ATen.h>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

using namespace genrender;
using namespace genrender::adapters;

TEST_SUITE("adapters/torch") {
    namespace {

    constexpr std::size_t frames = 4;
    constexpr std::size_t keyframes = 3;
    constexpr std::size_t tokens = 20;
    constexpr std::size_t channels = 12;
    constexpr std::size_t module_heads = 3;

    /// Any numbers, about as many above 0 as below.
    at::Tensor numbers(std::vector<std::int64_t> const& sizes, float phase) {
        auto const x = at::empty(sizes);
        for (std::int64_t i = 0; i < x.numel(); ++i) {
            x.data_ptr<float>()[i] = std::sin(phase + 1.7f * static_cast<float>(i));
        }
        return x;
    }

    at::Tensor features_of(std::size_t stack, float phase) {
        return numbers(
            {static_cast<std::int64_t>(stack), static_cast<std::int64_t>(tokens), static_cast<std::int64_t>(channels)},
            phase);
    }

    at::Tensor matrix(float phase) { return numbers({channels, channels}, phase) / 3; }

    /// The same matrices behind the library's own call.
    struct host_matrices {
        at::Tensor Q;
        at::Tensor K;
        at::Tensor V;
        static void apply(at::Tensor const& W, strided_view<float, 2> out, strided_view<float const, 2> f) {
            tensor_of(out).copy_(at::linear(tensor_of(f), W));
        }
        void query(strided_view<float, 2> out, strided_view<float const, 2> f) const { apply(Q, out, f); }
        void key(strided_view<float, 2> out, strided_view<float const, 2> f) const { apply(K, out, f); }
        void value(strided_view<float, 2> out, strided_view<float const, 2> f) const { apply(V, out, f); }
        std::size_t heads() const { return module_heads; }
    };

    host_features<float> host_of(at::Tensor const& x) {
        auto const host = host_features<float>::allocate({static_cast<std::size_t>(x.size(0)), tokens, channels});
        tensor_of(host.view()).copy_(x);
        return host;
    }

    float difference(at::Tensor const& x, host_features<float> const& host) {
        return (x.to(at::kFloat) - tensor_of(host.view())).abs().max().item<float>();
    }

    /// Both calls of the same module for the same features.
    struct both_calls {
        std::array<frame_index, frames> indices{{{4}, {5}, {6}, {7}}};
        at::Tensor f = features_of(frames, 0.3f);
        host_matrices matrices{matrix(1), matrix(2), matrix(3)};
        torch_module module = torch_module::of_matrices(matrices.Q, matrices.K, matrices.V, module_heads);
        torch_plans plans{};
        torch_attention_call call{{{1}, 1}, indices, f, module, plans};
        host_attention_call<float, host_matrices> host{{{1}, 1}, indices, host_of(f), matrices};

        /// The greatest difference of what both attend to.
        template <class Sources>
        float attend(Sources const& sources) {
            auto const own = call.project(f);
            auto const bank = features_of(keyframes, 5);
            auto const Q = host.query(host.f());
            auto const host_K = host.key(host.f());
            auto const host_V = host.value(host.f());
            auto const host_bank = host_of(bank);
            return difference(call.attend(own.Q, sources(own.K, own.V, bank)),
                              host.attend(Q, sources(host_K, host_V, host_bank)));
        }
    };

    /// Plans in which token t of every frame is the sum of two rows of the bank, every third token of none.
    struct some_plans {
        std::vector<std::uint32_t> offsets{0};
        std::vector<std::uint32_t> sources;
        std::vector<float> weights;
        explicit some_plans(std::uint32_t shift) {
            for (std::uint32_t t = 0; t < tokens; ++t) {
                if (t % 3 != 0) {
                    sources.insert(sources.end(), {(t + shift) % 60, (t * 7 + shift) % 60});
                    weights.insert(weights.end(), {0.75f, 0.25f});
                }
                offsets.push_back(static_cast<std::uint32_t>(sources.size()));
            }
        }
        sparse_rows<float> rows(std::optional<plan_key> key = std::nullopt) const {
            return {offsets, sources, weights, key};
        }
    };

    std::vector<sparse_rows<float>> rows_of(std::array<some_plans, frames> const& plans) {
        std::vector<sparse_rows<float>> rows;
        for (auto const& plan : plans) {
            rows.push_back(plan.rows());
        }
        return rows;
    }

    std::string error_of(auto const& work) {
        try {
            work();
        } catch (std::exception const& error) {
            return error.what();
        }
        return "nothing was thrown";
    }

    } // namespace

    TEST_CASE("the call of LibTorch is one, stores features and projects them at once") {
        static_assert(attention_call<torch_attention_call>);
        static_assert(storing_attention_call<torch_attention_call>);
        static_assert(projecting_attention_call<torch_attention_call>);
        both_calls both;
        CHECK(both.call.place() == attention_place{{1}, 1});
        CHECK(both.call.frames()[2] == frame_index{6});
        auto const at_once = both.call.project(both.f);
        CHECK(at::allclose(at_once.Q, both.call.query(both.f), 0, 1e-6));
        CHECK(at::allclose(at_once.K, both.call.key(both.f), 0, 1e-6));
        CHECK(at::allclose(at_once.V, both.call.value(both.f), 0, 1e-6));
        both.module.project = nullptr;
        CHECK(at::equal(both.call.project(both.f).K, both.call.key(both.f)));
    }

    TEST_CASE("LibTorch attends to a frame's own tokens as the library's call does") {
        both_calls both;
        CHECK(both.attend([](auto const& K, auto const& V, auto const&) {
            using features = std::remove_cvref_t<decltype(K)>;
            return attention_sources<features>::own(K, V, frames);
        }) < 2e-6f);
    }

    TEST_CASE("LibTorch attends to the whole stack as the library's call does") {
        both_calls both;
        CHECK(both.attend([](auto const& K, auto const& V, auto const&) {
            using features = std::remove_cvref_t<decltype(K)>;
            return attention_sources<features>::stack(K, V, frames);
        }) < 2e-6f);
    }

    TEST_CASE("LibTorch joins keyframes as the library's call does, whoever leaves one out") {
        both_calls both;
        using left_out = std::vector<std::optional<std::size_t>>;
        for (auto const& without :
             {left_out(frames), left_out{std::nullopt, 0, 0, 2}, left_out{1, std::nullopt, 2, 1}}) {
            CHECK(both.attend([&](auto const& K, auto const& V, auto const& bank) {
                using features = std::remove_cvref_t<decltype(K)>;
                return attention_sources<features>::own_and_joined(K, V, bank, bank, keyframes, without);
            }) < 2e-6f);
        }
        // A frame that leaves out another keyframe attends to other tokens.
        auto const own = both.call.project(both.f);
        auto const bank = features_of(keyframes, 5);
        auto const joined = [&](std::size_t k) {
            return both.call.attend(own.Q, attention_sources<at::Tensor>::own_and_joined(
                                               own.K, own.V, bank, bank, keyframes, left_out(frames, k)));
        };
        CHECK_FALSE(at::allclose(joined(0), joined(1), 0, 1e-3));
    }

    TEST_CASE("LibTorch attends to listed frames of several stacks as the library's call does") {
        both_calls both;
        CHECK(both.attend([](auto const& K, auto const& V, auto const& bank) {
            using features = std::remove_cvref_t<decltype(K)>;
            attention_sources<features> sources(frames);
            sources[0] = {{&K, &V, 3}};
            sources[1] = {{&bank, &bank, 2}, {&K, &V, 0}, {&K, &V, 1}};
            sources[2] = {{&K, &V, 2}, {&bank, &bank, 0}};
            sources[3] = {{&bank, &bank, 1}};
            return sources;
        }) < 2e-6f);
    }

    TEST_CASE("[GR eq. 6] LibTorch mixes the rows of plans as the library's call does") {
        both_calls both;
        std::array const plans{some_plans(1), some_plans(17), some_plans(30), some_plans(4)};
        auto const rows = rows_of(plans);
        auto const F = features_of(frames, 2);
        auto const bank = features_of(keyframes, 5);
        for (auto const alpha : {0.0f, 0.8f, 1.0f}) {
            auto const mixed = both.call.mix(F, bank, rows, alpha);
            CHECK(difference(mixed, both.host.mix(host_of(F), host_of(bank), rows, alpha)) < 1e-6f);
            CHECK(at::equal(mixed.select(1, 3), F.select(1, 3))); // no keyframe covers token 3
        }
        CHECK_FALSE(at::allclose(both.call.mix(F, bank, rows, 0.8f), F, 0, 0.1));
    }

    TEST_CASE("features of networks of 16 bits are mixed in 32 and rounded once") {
        both_calls both;
        std::array const plans{some_plans(1), some_plans(17), some_plans(30), some_plans(4)};
        auto const rows = rows_of(plans);
        for (auto const type : {at::kHalf, at::kBFloat16}) {
            auto const F = features_of(frames, 2).to(type);
            auto const bank = features_of(keyframes, 5).to(type);
            auto const exact = both.call.mix(F.to(at::kFloat), bank.to(at::kFloat), rows, 0.8f);
            auto const mixed = both.call.mix(F, bank, rows, 0.8f);
            CHECK(bool(mixed.scalar_type() == type));
            CHECK(at::equal(mixed, exact.to(type)));
        }
    }

    TEST_CASE("features are kept in 16 bits, and read with the scalars of the queries") {
        both_calls both;
        auto const x = features_of(keyframes, 5);
        CHECK(both.call.stored(x, feature_storage::same).is_same(x));
        for (auto const& [storage, type] :
             {std::pair(feature_storage::f16, at::kHalf), std::pair(feature_storage::bf16, at::kBFloat16)}) {
            auto const kept = both.call.stored(x, storage);
            CHECK(bool(kept.scalar_type() == type));
            auto const wide = kept.to(at::kFloat);
            for (std::int64_t i = 0; i < x.numel(); ++i) {
                auto const value = x.data_ptr<float>()[i];
                auto const nearest = storage == feature_storage::f16 ? float_of_half(half_of_float(value))
                                                                     : float_of_bfloat16(bfloat16_of_float(value));
                REQUIRE(wide.data_ptr<float>()[i] == nearest);
            }
            auto const own = both.call.project(both.f);
            auto const joined = [&](at::Tensor const& bank) {
                return both.call.attend(
                    own.Q, attention_sources<at::Tensor>::own_and_joined(
                               own.K, own.V, bank, bank, keyframes, std::vector<std::optional<std::size_t>>(frames)));
            };
            CHECK(bool(joined(kept).scalar_type() == at::kFloat));
            CHECK(at::equal(joined(kept), joined(kept.to(at::kFloat))));
        }
    }

    TEST_CASE("calls that do not fit are refused with a sentence") {
        both_calls both;
        CHECK(error_of([&] {
                  torch_attention_call({}, std::span(both.indices).first(3), both.f, both.module, both.plans);
              }) == "torch_attention_call: f is [4], expected [3]");
        both.module.heads = 5;
        CHECK(error_of([&] {
                  torch_attention_call({}, both.indices, both.f, both.module, both.plans);
              }).starts_with("torch_attention_call: module.heads is 5, expected a divisor"));
        both.module.heads = module_heads;
        std::vector const three(3, some_plans(1).rows());
        CHECK(error_of([&] { both.call.mix(both.f, both.f, three, 0.5f); }) ==
              "torch_attention_call: rows is [3], expected [4]");
        CHECK(error_of([&] { both.call.attend(both.f, attention_sources<at::Tensor>(2)); }) ==
              "torch_attention_call: sources is [2], expected [4]");
        std::array const of_fewer{sparse_rows<float>{}, sparse_rows<float>{}, sparse_rows<float>{},
                                  sparse_rows<float>{}};
        CHECK(error_of([&] { both.call.mix(both.f, both.f, of_fewer, 0.5f); }) ==
              "mix_torch_rows: rows is [0], expected [80]");
    }
    TEST_CASE("LibTorch scales logits as the library's call does, alike or a frame each") {
        static_assert(scaling_attention_call<torch_attention_call>);
        both_calls both;
        std::vector<std::optional<std::size_t>> const without{std::nullopt, 0, 0, 2};
        for (auto const& scales : {std::vector<double>(frames, 1.7), std::vector<double>{1, 1.5, 2, 2}}) {
            auto const scaled = [&scales](auto sources) {
                sources.set_scales(scales);
                return sources;
            };
            CHECK(both.attend([&](auto const& K, auto const& V, auto const&) {
                using features = std::remove_cvref_t<decltype(K)>;
                return scaled(attention_sources<features>::own(K, V, frames));
            }) < 4e-6f);
            CHECK(both.attend([&](auto const& K, auto const& V, auto const&) {
                using features = std::remove_cvref_t<decltype(K)>;
                return scaled(attention_sources<features>::stack(K, V, frames));
            }) < 4e-6f);
            CHECK(both.attend([&](auto const& K, auto const& V, auto const& bank) {
                using features = std::remove_cvref_t<decltype(K)>;
                return scaled(attention_sources<features>::own_and_joined(K, V, bank, bank, keyframes, without));
            }) < 4e-6f);
        }
        auto const own = both.call.project(both.f);
        auto sources = attention_sources<at::Tensor>::stack(own.K, own.V, frames);
        auto const unscaled = both.call.attend(own.Q, sources);
        sources.set_scales(std::vector<double>(frames, 1.7));
        CHECK_FALSE(at::allclose(both.call.attend(own.Q, sources), unscaled, 0, 1e-3));
    }

    TEST_CASE("LibTorch keeps variance as the library's call does") {
        static_assert(variance_keeping_call<torch_attention_call>);
        both_calls both;
        std::array<some_plans, frames> const plans{some_plans{0}, some_plans{7}, some_plans{20}, some_plans{41}};
        auto const rows = rows_of(plans);
        auto const F_hat = features_of(frames, 8) + 5;
        auto const F_KF = features_of(keyframes, 9) + 5;
        for (auto const alpha : {0.7f, 1.0f, 0.0f}) {
            for (auto const target : {variance_target::none, variance_target::total, variance_target::sources}) {
                for (auto const most : {2.0, 1.05}) {
                    kept_variance const kept{target, most};
                    auto const F = both.call.mix_keeping_variance(F_hat, F_KF, rows, alpha, kept);
                    CHECK(difference(F, both.host.mix_keeping_variance(host_of(F_hat), host_of(F_KF), rows, alpha,
                                                                       kept)) < 2e-5f);
                }
            }
        }
        CHECK_FALSE(at::allclose(both.call.mix_keeping_variance(F_hat, F_KF, rows, 0.7f, {variance_target::total}),
                                 both.call.mix(F_hat, F_KF, rows, 0.7f), 0, 1e-3));
        // Tokens that no keyframe covers stay to the bit.
        auto const kept = both.call.mix_keeping_variance(F_hat, F_KF, rows, 0.7f, {variance_target::total});
        CHECK(at::equal(kept.select(1, 0), F_hat.select(1, 0)));
    }
}
