// SPDX-License-Identifier: MIT
// Views as multidimensional spans and back: std::mdspan of C++23, or another class with its members (Kokkos', CUDA's).
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/strided_view.hpp>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <version>

#if defined(__cpp_lib_mdspan)
#include <mdspan>
#endif

namespace genrender::adapters {

namespace detail {

/// A span over plain elements: what it is called with is an element itself, not a value that an accessor makes.
template <class Span>
concept plain_span = std::same_as<typename Span::reference, typename Span::element_type&> &&
    std::same_as<typename Span::data_handle_type, typename Span::element_type*>;

/// The greatest number of an index type that a size has.
template <class Index>
inline constexpr auto greatest_index = static_cast<std::size_t>(std::numeric_limits<Index>::max());

} // namespace detail

/// The view of a multidimensional span of at least one axis; copies nothing. Spans whose accessor computes elements do
/// not compile.
template <class Span>
    requires(Span::rank() >= 1)
auto to_view(Span const& span) {
    static_assert(detail::plain_span<Span>, "to_view: the span's accessor gives no references to plain elements");
    std::array<std::size_t, Span::rank()> extents{};
    std::array<std::ptrdiff_t, Span::rank()> strides{};
    for (std::size_t axis = 0; axis < Span::rank(); ++axis) {
        extents[axis] = static_cast<std::size_t>(span.extent(axis));
        strides[axis] = static_cast<std::ptrdiff_t>(span.stride(axis));
    }
    return strided_view<typename Span::element_type, Span::rank()>(span.data_handle(), extents, strides);
}

/// A view as a `Span` with a layout of strides, or one of layout_right if the view is contiguous; copies nothing. Throws
/// shape_error if a static extent differs; value_error if the view is not contiguous where the layout asks for it, an
/// extent or stride is beyond the span's index type, or a stride along several elements is not positive, which no layout
/// of spans has.
template <class Span, class T, std::size_t Rank>
Span to_mdspan(strided_view<T, Rank> const& view) {
    static_assert(Span::rank() == Rank, "to_mdspan: span and view differ in their number of axes");
    using extents_type = typename Span::extents_type;
    using mapping_type = typename Span::mapping_type;
    using index_type = typename Span::index_type;
    constexpr auto here = "to_mdspan";
    constexpr auto greatest = detail::greatest_index<index_type>;

    std::array<std::size_t, Rank> expected = view.extents();
    std::array<index_type, Rank> extents{};
    std::array<index_type, Rank> strides{};
    for (std::size_t axis = 0; axis < Rank; ++axis) {
        if (extents_type::static_extent(axis) != std::numeric_limits<std::size_t>::max()) {
            expected[axis] = extents_type::static_extent(axis);
        }
        auto const stride = view.extent(axis) > 1 ? view.stride(axis) : std::ptrdiff_t{1};
        require_value(stride > 0, here, "view.stride", stride, "more than 0 along several elements");
        require_value(view.extent(axis) <= greatest && static_cast<std::size_t>(stride) <= greatest, here,
                      "view.extent or view.stride", std::max(view.extent(axis), static_cast<std::size_t>(stride)),
                      "a number of the span's index type");
        extents[axis] = static_cast<index_type>(view.extent(axis));
        strides[axis] = static_cast<index_type>(stride);
    }
    require_extents(here, "view", view.extents(), expected);
    if constexpr (std::is_constructible_v<mapping_type, extents_type, std::array<index_type, Rank>>) {
        return Span(view.data(), mapping_type(extents_type(extents), strides));
    } else {
        require_value(view.is_contiguous(), here, "view", "with gaps", "contiguous rows for a span without strides");
        return Span(view.data(), mapping_type(extents_type(extents)));
    }
}

#if defined(__cpp_lib_mdspan)
/// A view as the std::mdspan with strides. Throws value_error if a stride along several elements is not positive.
template <class T, std::size_t Rank>
auto to_mdspan(strided_view<T, Rank> const& view) {
    return to_mdspan<std::mdspan<T, std::dextents<std::size_t, Rank>, std::layout_stride>>(view);
}
#endif

} // namespace genrender::adapters

#include <genrender/core/end_header.inl>
