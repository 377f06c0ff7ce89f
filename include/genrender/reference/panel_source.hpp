// SPDX-License-Identifier: MIT
// From a tensor of a network to the panels that its products run on.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/weight_panels.hpp>
#include <genrender/reference/weights.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace genrender::reference {

/// The tensor `name` of a shape as a matrix [inputs, outputs], whose element (i, o) is the tensor's element
/// `index_of(i, o)`, row-major, kept in what `source` says. Of a listing (see weights) the matrix has extents alone. Throws as weights::take does.
template <class Real, class IndexOf>
weight_panels<Real> take_panels(weights<Real>& source, std::string const& name, std::vector<std::size_t> const& shape,
                                std::size_t inputs, std::size_t outputs, IndexOf const& index_of) {
    // Asked for before there is memory for it, so that a wrong config is told by name.
    auto const values = source.take(name, shape);
    if (source.is_listing()) {
        return weight_panels<Real>::of_extents(inputs, outputs);
    }
    return {inputs, outputs, [&](std::size_t i, std::size_t o) { return values[index_of(i, o)]; },
            source.storage_of(name)};
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
