// SPDX-License-Identifier: MIT
// The parameters of one network by name: from files, or drawn from a seed as they are asked for.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/reference/lora_difference.hpp>
#include <genrender/reference/seeded_tensor.hpp>
#include <genrender/reference/tensor_place.hpp>
#include <genrender/reference/weight_storage.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace genrender::reference {

/// A store of named tensors from which layers take theirs while they are built. It remembers what was taken, so that a
/// tensor that nobody wanted is found too.
template <std::floating_point Real>
class weights {
public:
    /// Tensors wherever they lie. `path` is the file or folder to blame for what is in no file. Throws value_error if it
    /// is empty.
    static weights from_places(tensor_places places, std::string path) {
        require_value(!path.empty(), "weights", "path", "empty", "that of a file or a folder");
        weights result;
        result.places_ = std::move(places);
        result.path_ = std::move(path);
        return result;
    }

    /// Random tensors, made as they are taken (see seeded_tensor), equal for equal seeds whatever is taken and in what
    /// order. `network` sets networks with the same names for their tensors apart.
    static weights seeded(std::uint64_t seed, std::string network) {
        weights result;
        result.seed_ = seed;
        result.network_ = std::move(network);
        return result;
    }

    /// A store of nothing, which remembers what is asked for: whatever is taken is empty. A network can be built of it, in
    /// no time and memory, to learn its tensors' names and shapes, but not run. The error for more than `most` tensors
    /// blames `path`.
    static weights listing(std::size_t most, std::string path) {
        weights result;
        result.most_ = most;
        result.path_ = std::move(path);
        return result;
    }
    /// Whether whatever is taken is empty.
    bool is_listing() const { return most_ > 0; }

    /// Throws file_error unless the tensors of the files are those that a listing was asked for, naming all that are
    /// missing, have another shape, or have no place. Nothing can be wrong with random tensors.
    void require_those_of(weights const& listing) const {
        if (!is_of_files()) {
            return;
        }
        counted_names missing, misshapen, surplus;
        for (auto const& [name, shape] : listing.taken_) {
            auto const found = places_.find(name);
            if (found == places_.end()) {
                missing.add(name + " " + extents_text(shape));
            } else if (found->second.shape != shape) {
                misshapen.add(name + " is " + extents_text(found->second.shape) + " where " + extents_text(shape) +
                              " is asked for");
            }
        }
        for (auto const& [name, place] : places_) {
            if (!listing.taken_.contains(name) && !is_left(name) && !listing.is_left(name)) {
                surplus.add(name);
            }
        }
        std::string sentence;
        auto const tell = [&](counted_names const& names, char const* what) {
            if (names.count() > 0) {
                sentence += (sentence.empty() ? "" : "; ") + std::to_string(names.count()) + what + names.text();
            }
        };
        tell(missing, " tensors are missing: ");
        tell(misshapen, " tensors have another shape: ");
        tell(surplus, " tensors have no place in the network: ");
        if (!sentence.empty()) {
            throw file_error(path_ + ": " + sentence + ", expected none");
        }
    }

    /// Whether layers keep matrices and kernels that a file has in 16 bits (F16, BF16) in 16 bits: half the memory, and
    /// the same results to the bit, because products are in Real either way. Weights that a LoRA changes are rounded to
    /// the file's type. Not so by default.
    void keep_file_width(bool keep = true) { keeps_file_width_ = keep; }
    /// What layers keep a tensor in.
    weight_storage storage_of(std::string const& name) const {
        auto const found = places_.find(name);
        return keeps_file_width_ && found != places_.end()
                   ? storage_of_dtype(found->second.file->entry(found->second.stored).dtype)
                   : weight_storage::real;
    }

    /// How many tensors the files hold; 0 if they are random.
    std::size_t stored_count() const { return places_.size(); }
    /// Where the tensors of files lie; none if they are random.
    tensor_places const& places() const { return places_; }
    /// The file or folder to blame; empty if tensors are random.
    std::string const& path() const { return path_; }

    /// Adds what LoRAs change, `scale` times, to the tensors that are taken from now on (see add_lora). Throws value_error
    /// if the scale is not finite.
    void add_differences(lora_differences const& found, double scale = 1) {
        require_value(is_finite(scale), "weights", "scale", scale, "a finite number");
        for (auto [name, difference] : found) {
            difference.factor *= scale;
            differences_.emplace(name, std::move(difference));
        }
    }

    /// The elements of tensor `name`, row-major. Throws file_error `path: there is no tensor ...` or `path: tensor ...
    /// is [..], expected [..]`.
    std::vector<Real> take(std::string const& name, std::vector<std::size_t> const& shape) {
        taken_.insert_or_assign(name, shape);
        if (is_listing()) {
            if (taken_.size() > most_) {
                throw file_error(path_ + ": the config asks for more than " + std::to_string(most_) +
                                 " tensors, expected about as many as there are");
            }
            return {};
        }
        if (is_of_files()) {
            auto const& place = place_of(name, shape);
            if (place.shape != shape) {
                throw file_error(place.file->path() + ": tensor " + name + " is " + extents_text(place.shape) +
                                 ", expected " + extents_text(shape));
            }
            return read<Real>(name, place);
        }
        auto const values = seeded_tensor(seed_, network_, name, shape);
        return {values.begin(), values.end()};
    }

    /// Whether one of the files holds a tensor of this name. A seeded store, which makes what it is asked for, holds
    /// none.
    bool holds(std::string const& name) const { return places_.contains(name); }

    /// Lets tensors be left over whose names begin so: what a file holds beside the network that is built.
    void leave(std::string const& beginning) { left_.push_back(beginning); }

    /// Throws file_error naming the tensors of the files that nobody took or left.
    void require_all_taken() const {
        counted_names surplus;
        for (auto const& [name, place] : places_) {
            if (!taken_.contains(name) && !is_left(name)) {
                surplus.add(name);
            }
        }
        if (surplus.count() > 0) {
            throw file_error(path_ + ": " + std::to_string(surplus.count()) +
                             " tensors have no place in the network: " + surplus.text() + ", expected none");
        }
    }

    /// Shapes of all tensors taken so far, by name.
    std::map<std::string, std::vector<std::size_t>> const& taken() const { return taken_; }

    /// Number of scalars in all tensors taken so far.
    std::size_t parameter_count() const {
        std::size_t count = 0;
        for (auto const& [name, shape] : taken_) {
            count += static_cast<std::size_t>(internal::checked_product(shape).value_or(0));
        }
        return count;
    }

    /// All tensors taken so far by name. Seeded tensors are floats, whatever Real is, so that nothing is lost.
    std::map<std::string, std::vector<float>> values() const {
        std::map<std::string, std::vector<float>> result;
        for (auto const& [name, shape] : taken_) {
            result[name] =
                is_of_files() ? read<float>(name, place_of(name, shape)) : seeded_tensor(seed_, network_, name, shape);
        }
        return result;
    }

private:
    weights() = default;

    bool is_left(std::string const& name) const {
        return std::any_of(left_.begin(), left_.end(),
                           [&](auto const& beginning) { return name.starts_with(beginning); });
    }

    tensor_place const& place_of(std::string const& name, std::vector<std::size_t> const& shape) const {
        auto const found = places_.find(name);
        if (found == places_.end()) {
            throw file_error(path_ + ": there is no tensor " + name + ", expected one of shape " + extents_text(shape));
        }
        return found->second;
    }

    template <class Number>
    std::vector<Number> read(std::string const& name, tensor_place const& place) const {
        auto values = place.template read<Number>();
        auto const [first, last] = differences_.equal_range(name);
        for (auto it = first; it != last; ++it) {
            add_difference<Number>(values, it->second);
        }
        return values;
    }

    bool is_of_files() const { return !path_.empty() && !is_listing(); }

    tensor_places places_;
    lora_differences differences_;
    std::string path_; // none if tensors are random
    bool keeps_file_width_ = false;
    std::size_t most_ = 0; // above 0 if nothing is stored
    std::uint64_t seed_ = 0;
    std::string network_;
    std::map<std::string, std::vector<std::size_t>> taken_;
    std::vector<std::string> left_;
};

/// Throws file_error, naming all that is wrong at once, unless the tensors of `source` are those of a network, which
/// `build(listing)` builds of a store of nothing.
template <std::floating_point Real, class Build>
void require_tensors(weights<Real> const& source, Build const& build) {
    if (source.stored_count() == 0) {
        return;
    }
    // A config can ask for anything; what is listed stays of the order of what is stored.
    auto listing = weights<Real>::listing(2 * source.stored_count() + 1000, source.path());
    build(listing);
    source.require_those_of(listing);
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
