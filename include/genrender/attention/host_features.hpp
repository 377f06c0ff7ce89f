// SPDX-License-Identifier: MIT
// The handle of features in host memory: a view, and a share in the memory where the library or the engine gave one.
#pragma once

#include <genrender/core/strided_view.hpp>

#include <array>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace genrender {

/// Features [frames, tokens, channels] in host memory. Copying copies the handle, never an element.
template <class Real>
class host_features {
public:
    using value_type = Real;

    host_features() = default;

    /// Borrows the memory of an engine, which must outlive every copy of the handle.
    explicit host_features(strided_view<Real, 3> view) : view_(view) {}

    /// Shares memory that `owner` keeps alive.
    host_features(strided_view<Real, 3> view, std::shared_ptr<void const> owner)
        : view_(view), owner_(std::move(owner)) {}

    /// Owns new zeros.
    static host_features allocate(std::array<std::size_t, 3> const& extents) {
        auto values = std::make_shared<std::vector<Real>>(extents[0] * extents[1] * extents[2]);
        auto const view = strided_view<Real, 3>(values->data(), extents);
        return {view, std::move(values)};
    }

    strided_view<Real, 3> view() const { return view_; }
    std::array<std::size_t, 3> const& extents() const { return view_.extents(); }
    bool is_borrowed() const { return owner_ == nullptr; }

    friend strided_view<Real, 3> to_view(host_features const& features) { return features.view_; }

private:
    strided_view<Real, 3> view_;
    std::shared_ptr<void const> owner_;
};

} // namespace genrender
