// SPDX-License-Identifier: MIT
// The handle of features in host memory: a view, and a share in the memory where the library or the engine gave one.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/feature_storage.hpp>
#include <genrender/core/linalg.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>

#include <array>
#include <cassert>
#include <cstddef>
#include <memory>
#include <utility>
#include <variant>

namespace genrender {

/// Features [frames, tokens, channels] in host memory, as `Real` or kept in 16 bits. Copying copies the handle, never
/// an element.
template <class Real>
class host_features {
public:
    /// The type that the features are computed in, however they are stored.
    using value_type = Real;

    host_features() = default;

    /// Borrows the memory of an engine, which must outlive every copy of the handle.
    explicit host_features(strided_view<Real, 3> view) : view_(view) {}

    /// Shares memory that `owner` keeps alive.
    host_features(strided_view<Real, 3> view, std::shared_ptr<void const> owner)
        : view_(view), owner_(std::move(owner)) {}

    /// Owns new zeros.
    static host_features allocate(std::array<std::size_t, 3> const& extents) {
        host_features features;
        features.template own<Real>(stack<Real, 3>(extents));
        return features;
    }

    /// Owns the values of `from`, each rounded to the nearest of the format; of another handle's memory in any case.
    static host_features rounded(strided_view<Real const, 3> from, feature_storage storage) {
        host_features features;
        switch (storage) {
        case feature_storage::f16:
            features.template own_converted<float16>(from);
            break;
        case feature_storage::bf16:
            features.template own_converted<bfloat16>(from);
            break;
        default:
            copy(features.template own<Real>(stack<Real, 3>::uninitialized(from.extents())), from);
        }
        return features;
    }

    /// The features, which are kept as `Real`.
    strided_view<Real, 3> view() const {
        assert(storage() == feature_storage::same && "host_features: view() of features that are kept in 16 bits");
        return *std::get_if<strided_view<Real, 3>>(&view_);
    }

    /// What `use` makes of the view of the elements as they are kept: of Real, float16 or bfloat16.
    template <class Use>
    decltype(auto) visit(Use&& use) const {
        return std::visit(std::forward<Use>(use), view_);
    }

    /// Extents of the features: frames, tokens, channels.
    std::array<std::size_t, 3> const& extents() const {
        return visit([](auto const& view) -> std::array<std::size_t, 3> const& { return view.extents(); });
    }
    /// The format that the elements are kept in.
    feature_storage storage() const {
        return std::holds_alternative<strided_view<Real, 3>>(view_)      ? feature_storage::same
               : std::holds_alternative<strided_view<float16, 3>>(view_) ? feature_storage::f16
                                                                         : feature_storage::bf16;
    }
    /// Whether the memory is an engine's, which must outlive the handle.
    bool is_borrowed() const { return owner_ == nullptr; }

    /// The features, which are kept as Real.
    friend strided_view<Real, 3> to_view(host_features const& features) { return features.view(); }

    /// x kept in a format, as storable_features has it; of the other format of 16 bits by way of Real.
    friend host_features stored(host_features const& x, feature_storage storage) {
        if (storage == feature_storage::same || storage == x.storage()) {
            return x;
        }
        return x.storage() == feature_storage::same ? rounded(x.view(), storage) : rounded(x.widened().view(), storage);
    }

private:
    host_features widened() const {
        host_features features;
        visit([&](auto const& from) { features.template own_converted<Real>(from); });
        return features;
    }

    template <class T>
    strided_view<T, 3> own(stack<T, 3> values) {
        auto shared = std::make_shared<stack<T, 3>>(std::move(values));
        auto const view = shared->view();
        view_ = view;
        owner_ = std::move(shared);
        return view;
    }

    template <class T, class From>
    void own_converted(strided_view<From, 3> from) {
        auto const to = own<T>(stack<T, 3>::uninitialized(from.extents()));
        for (std::size_t i = 0; i < from.extent(0); ++i) {
            for (std::size_t t = 0; t < from.extent(1); ++t) {
                for (std::size_t c = 0; c < from.extent(2); ++c) {
                    to(i, t, c) = static_cast<T>(from(i, t, c));
                }
            }
        }
    }

    // In the order of feature_storage.
    std::variant<strided_view<Real, 3>, strided_view<float16, 3>, strided_view<bfloat16, 3>> view_;
    std::shared_ptr<void const> owner_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
