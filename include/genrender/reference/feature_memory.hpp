// SPDX-License-Identifier: MIT
// Memory for features that somebody is about to write: it begins at a cache line and holds anything.
#pragma once

#include <genrender/core/begin_header.inl>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <utility>

namespace genrender::reference {

/// Owns `size` numbers that nobody has set. Copies copy all of them.
template <class Real>
class feature_memory {
public:
    feature_memory() = default;

    explicit feature_memory(std::size_t size)
        : numbers_(static_cast<Real*>(::operator new(size * sizeof(Real), line))), size_(size) {}

    feature_memory(feature_memory const& other) : feature_memory(other.size_) {
        std::copy_n(other.data(), size_, data());
    }
    feature_memory(feature_memory&& other) noexcept
        : numbers_(std::move(other.numbers_)), size_(std::exchange(other.size_, 0)) {}
    feature_memory& operator=(feature_memory other) noexcept {
        numbers_ = std::move(other.numbers_);
        size_ = other.size_;
        return *this;
    }
    ~feature_memory() = default;

    std::size_t size() const { return size_; }
    Real* data() { return numbers_.get(); }
    Real const* data() const { return numbers_.get(); }

private:
    static constexpr std::align_val_t line{64};
    struct release {
        void operator()(Real* numbers) const { ::operator delete(numbers, line); }
    };
    std::unique_ptr<Real, release> numbers_;
    std::size_t size_ = 0;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
