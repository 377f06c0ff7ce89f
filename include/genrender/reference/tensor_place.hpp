// SPDX-License-Identifier: MIT
// Where a tensor of a network lies: in which file, under which name there, and as which part of it.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/reference/tensor_file.hpp>

#include <concepts>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender::reference {

/// Elements of a tensor in a file that are a tensor of a network. A file may have it under another name, in another
/// shape, or as rows of a greater one.
struct tensor_place {
    std::shared_ptr<tensor_file const> file; ///< where it lies; never null
    std::string stored;                      ///< its name there
    std::vector<std::size_t> shape;          ///< of the network's tensor
    std::size_t first = 0;                   ///< element of the stored tensor that is its first

    /// Number of its elements.
    std::size_t count() const { return static_cast<std::size_t>(internal::checked_product(shape).value_or(0)); }

    /// Its elements, row-major. Throws file_error as tensor_file::read does.
    template <std::floating_point Real>
    std::vector<Real> read() const {
        return file->template read<Real>(stored, first, count());
    }
};

/// The tensors of a network by the names that it has for them.
using tensor_places = std::map<std::string, tensor_place>;

/// Every tensor of a file, as it lies.
inline tensor_places places_of(std::shared_ptr<tensor_file const> const& file) {
    tensor_places places;
    for (auto const& [name, entry] : file->entries()) {
        places.emplace(name, tensor_place{file, name, entry.shape, 0});
    }
    return places;
}

/// Adds tensors to those of other files. Throws file_error for one that is there already.
inline void add_places(tensor_places& places, tensor_places const& more) {
    for (auto const& [name, place] : more) {
        auto const [other, is_new] = places.emplace(name, place);
        if (!is_new) {
            throw file_error(place.file->path() + ": tensor " + name + " is in " + other->second.file->path() +
                             " too, expected each tensor once");
        }
    }
}

/// The first five of some names, `a, b, c, d, e, ...` if there are more, and how many there are.
class counted_names {
public:
    /// One more.
    void add(std::string_view name) {
        if (++count_ <= 5) {
            text_ += (count_ > 1 ? ", " : "") + std::string(name);
        }
    }
    /// How many.
    std::size_t count() const { return count_; }
    /// The first of them.
    std::string text() const { return count_ > 5 ? text_ + ", ..." : text_; }

private:
    std::size_t count_ = 0;
    std::string text_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
