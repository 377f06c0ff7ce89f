// SPDX-License-Identifier: MIT
// A program of two units, whose kernels are in the other.
#include <genrender/attention/scaled_dot_product.hpp>

#include <array>

int main() {
    std::array<float, 2> f{1, 3};
    std::array<float, 2> F{};
    genrender::strided_view<float const, 2> const tokens(f.data(), {2, 1});
    genrender::key_value_view<float> const block{tokens, tokens};
    genrender::scaled_dot_product<float>({F.data(), {2, 1}}, tokens, {&block, 1}, 1);
    // A query attends to both values, more to the greater.
    return F[0] > 2 && F[1] > F[0] && F[1] < 3 ? 0 : 1;
}
