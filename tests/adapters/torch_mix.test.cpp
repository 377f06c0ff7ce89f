// SPDX-License-Identifier: MIT
// Eq. 6 on tensors against a calculation by hand, and kernels of devices.
#include <genrender/adapters/torch_mix.hpp>

#include <ATen/ATen.h>

#include <doctest/doctest.h>

using namespace genrender;
using namespace genrender::adapters;

TEST_SUITE("adapters/torch_mix") {
    namespace {

    /// Of one frame: token 0 is half its own and a quarter of rows 2 and 3 each, token 1 is not covered.
    torch_rows two_rows() {
        return {at::tensor({0, 2, 2}, at::kInt), at::tensor({2, 3}, at::kInt), at::tensor({0.25f, 0.25f}),
                at::tensor({0.5f, 1.0f}).unsqueeze(1)};
    }
    at::Tensor two_tokens() { return at::tensor({1.0f, 2.0f, 3.0f, 4.0f}).view({1, 2, 2}); }
    at::Tensor bank() { return at::tensor({9.f, 9.f, 9.f, 9.f, 10.f, 20.f, 30.f, 40.f}).view({2, 2, 2}); }

    at::Tensor minus_own(at::Tensor const& F_hat, at::Tensor const&, torch_rows const&) { return -F_hat; }
    at::Tensor unknown(at::Tensor const&, at::Tensor const&, torch_rows const&) { return {}; }

    /// Registers a kernel for the processor as long as it lives.
    struct registered {
        explicit registered(torch_mix_kernel kernel) { torch_mix_kernel_of(at::kCPU) = kernel; }
        registered(registered const&) = delete;
        registered& operator=(registered const&) = delete;
        ~registered() { torch_mix_kernel_of(at::kCPU) = nullptr; }
    };

    } // namespace

    TEST_CASE("[GR eq. 6] covered tokens mix in rows of the keyframes, others stay") {
        auto const F_hat = two_tokens();
        auto const F_out = mix_torch_rows(F_hat, bank(), two_rows());
        CHECK(at::equal(F_out, at::tensor({10.5f, 16.0f, 3.0f, 4.0f}).view({1, 2, 2})));
        CHECK(at::equal(F_hat, two_tokens()));
    }

    TEST_CASE("features of 16 bits are mixed in 32 bits, features of 64 bits in 64") {
        auto const half = mix_torch_rows(two_tokens().to(at::kHalf), bank().to(at::kBFloat16), two_rows());
        CHECK(bool(half.scalar_type() == at::kHalf));
        CHECK(half.to(at::kFloat)[0][0][0].item<float>() == 10.5f);
        auto F_hat = two_tokens().to(at::kDouble);
        F_hat[0][1][0] = 3 + 1e-12;
        CHECK(mix_torch_rows(F_hat, bank(), two_rows())[0][1][0].item<double>() == 3 + 1e-12);
    }

    TEST_CASE("a kernel of the device is used where it knows the scalars, and on no other device") {
        CHECK(bool(torch_mix_kernel_of(at::kCUDA).load() == nullptr));
        {
            registered const kernel(minus_own);
            CHECK(at::equal(mix_torch_rows(two_tokens(), bank(), two_rows()), -two_tokens()));
            CHECK(bool(torch_mix_kernel_of(at::kCUDA).load() == nullptr));
        }
        {
            registered const kernel(unknown);
            CHECK(mix_torch_rows(two_tokens(), bank(), two_rows())[0][0][0].item<float>() == 10.5f);
        }
        CHECK(mix_torch_rows(two_tokens(), bank(), two_rows())[0][0][0].item<float>() == 10.5f);
    }

    TEST_CASE("rows of other tokens are refused") {
        CHECK_THROWS_WITH(mix_torch_rows(two_tokens().expand({2, 2, 2}), bank(), two_rows()),
                          "mix_torch_rows: rows is [2], expected [4]");
    }
}
