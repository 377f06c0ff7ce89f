// SPDX-License-Identifier: MIT
// An embedder whose every answer can be told in advance: the mean colour of an image, the colour that a text names.
#pragma once

#include <genrender/core/error.hpp>
#include <genrender/core/strided_view.hpp>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace genrender::testing {

/// Vectors of three elements: red, green, blue. Texts are "red", "green", "blue" and "white".
template <class Real>
struct colour_embedder {
    using real_type = Real;
    std::size_t dimension() const { return 3; }
    std::vector<Real> embed_image(strided_view<Real const, 3> image) const {
        std::vector<Real> mean(image.extent(0));
        for (std::size_t c = 0; c < image.extent(0); ++c) {
            for (std::size_t row = 0; row < image.extent(1); ++row) {
                for (std::size_t column = 0; column < image.extent(2); ++column) {
                    mean[c] += image(c, row, column);
                }
            }
        }
        return mean;
    }
    std::vector<Real> embed_text(std::string_view text) const {
        require_value(text == "red" || text == "green" || text == "blue" || text == "white", "embed_text", "text",
                      std::string(text), "a colour");
        return {Real(text == "red" || text == "white"), Real(text == "green" || text == "white"),
                Real(text == "blue" || text == "white")};
    }
};

} // namespace genrender::testing
