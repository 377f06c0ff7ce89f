// SPDX-License-Identifier: MIT
// A program of somebody who uses the library: includes all of the core and calls a little.
#include <genrender/genrender.hpp>

#include <iostream>

int main() {
    auto z = genrender::latents<float>::from_shape({2, 4, 8, 8});
    z.fill(0.5f);
    genrender::strided_view<float const, 4> const view = to_view(z);
    std::cout << "latents " << genrender::extents_text(view.extents()) << '\n';
    return view(1, 3, 7, 7) == 0.5f ? 0 : 1;
}
