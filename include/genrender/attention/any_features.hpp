// SPDX-License-Identifier: MIT
// Features of any engine behind one type, so that what is compiled of them needs no engine.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/feature_storage.hpp>
#include <genrender/core/error.hpp>

#include <memory>
#include <string>
#include <utility>

namespace genrender {

/// A handle of any engine's handle of features. Copies share what it holds, never an element.
class any_features {
public:
    /// Holds nothing.
    any_features() = default;

    /// Holds the features of an engine.
    template <class Features>
    static any_features of(Features features) {
        any_features held;
        held.features_ = std::make_shared<Features const>(std::move(features));
        held.kind_ = &kind_of<Features>;
        return held;
    }

    /// The engine's features. Throws value_error if it holds none of this type.
    template <class Features>
    Features const& as() const {
        if (kind_ != &kind_of<Features>) {
            throw value_error(std::string("any_features: the handle holds ") +
                              (kind_ == nullptr ? "nothing" : "features of another engine") +
                              ", expected those of the engine that asks");
        }
        return *static_cast<Features const*>(features_.get());
    }

    /// x kept in a format, as storable_features has it. Throws value_error if the engine's features have no `stored`.
    friend any_features stored(any_features const& x, feature_storage storage) {
        return x.kind_ == nullptr || storage == feature_storage::same ? x : x.kind_->stored(x, storage);
    }

private:
    // Its address tells the types apart, where a program has no run-time types.
    struct kind {
        any_features (*stored)(any_features const&, feature_storage);
    };
    template <class Features>
    static any_features stored_as(any_features const& x, feature_storage storage) {
        return of<Features>(stored_features(x.as<Features>(), storage));
    }
    template <class Features>
    static constexpr kind kind_of{&stored_as<Features>};

    std::shared_ptr<void const> features_;
    kind const* kind_ = nullptr;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
