// SPDX-License-Identifier: MIT
// Keys and values that attention reads where they lie: any strides, stored as Real or in 16 bits.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/half_storage.hpp>
#include <genrender/core/strided_view.hpp>

#include <array>
#include <concepts>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <variant>

namespace genrender {

namespace detail {

/// The type of the elements of a view, or of what has a `to_view` of two axes.
template <class Source>
struct stored_element {};
template <class T>
struct stored_element<strided_view<T, 2>> {
    using type = T;
};
template <class Source>
    requires requires(Source&& source) { to_view(source); }
struct stored_element<Source> : stored_element<decltype(to_view(std::declval<Source&>()))> {};

/// Two axes of numbers of 16 bits.
template <class Source>
concept half_source = requires {
    typename stored_element<std::remove_cvref_t<Source>>::type;
}
&&half_storage<typename stored_element<std::remove_cvref_t<Source>>::type>;

} // namespace detail

/// A read-only view [tokens, channels] of features whose elements are read as Real and kept as Real or in 16 bits, of
/// any type that half_bits knows. Views and tensors of each of them convert to it.
template <class Real>
class stored_view {
public:
    /// The type that keys and values are computed in, however they are stored.
    using value_type = Real;

    stored_view() = default;

    /// Views elements [tokens, channels] of type Real or of a 16-bit type that half_bits knows; they are not owned.
    template <class Source>
        requires(!std::same_as<std::remove_cvref_t<Source>, stored_view> &&
                 (std::convertible_to<Source, strided_view<Real const, 2>> || detail::half_source<Source>))
    stored_view(Source&& source) {
        if constexpr (std::convertible_to<Source, strided_view<Real const, 2>>) {
            view_ = strided_view<Real const, 2>(std::forward<Source>(source));
        } else {
            using element = typename detail::stored_element<std::remove_cvref_t<Source>>::type;
            view_ = to_bits_view(strided_view<element const, 2>(std::forward<Source>(source)));
        }
    }

    /// What `visitor` returns for the view in its storage type: Real const, float16_bits const or bfloat16_bits const.
    template <class Visitor>
    decltype(auto) visit(Visitor&& visitor) const {
        return std::visit(std::forward<Visitor>(visitor), view_);
    }

    /// Extents of both axes: tokens, channels.
    std::array<std::size_t, 2> extents() const {
        return visit([](auto const& view) { return view.extents(); });
    }
    /// Extent of axis 0, tokens, or 1, channels.
    std::size_t extent(std::size_t axis) const { return extents()[axis]; }

    /// One element, converted.
    Real operator()(std::size_t token, std::size_t channel) const {
        return visit([&](auto const& view) { return static_cast<Real>(view(token, channel)); });
    }

    /// The view of `count` tokens from `begin` on.
    stored_view slice(std::size_t begin, std::size_t count) const {
        return visit([&](auto const& view) { return stored_view(view.slice(begin, count)); });
    }

private:
    std::variant<strided_view<Real const, 2>, strided_view<float16_bits const, 2>, strided_view<bfloat16_bits const, 2>>
        view_;
};

/// Keys and values of some tokens.
template <class Real>
struct key_value_view {
    stored_view<Real> K; ///< [tokens, channels]
    stored_view<Real> V; ///< [tokens, channels]

    /// [tokens] For how many equal tokens each one stands, whole or not, > 0: log(counts) is added to its logits, as if
    /// it were repeated so often (Bolya and Hoffman 2023, 'Token Merging for Fast Stable Diffusion', proportional
    /// attention). A view of nothing says once each.
    strided_view<Real const, 1> counts{nullptr, {0}, {1}};
};

} // namespace genrender

#include <genrender/core/end_header.inl>
