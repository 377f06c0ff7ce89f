// SPDX-License-Identifier: MIT
// The parameters of one network by name: from safetensors files, or drawn from a seed as they are asked for.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/reference/safetensors.hpp>
#include <genrender/reference/seeded_tensor.hpp>

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
    /// The tensors of a safetensors file, converted as they are taken. Throws file_error as safetensors_file does.
    static weights from_file(std::string const& path) { return from_files({path}); }

    /// The tensors of several safetensors files. Throws value_error if there is none, file_error as safetensors_file
    /// does, and for a tensor that is in two of them.
    static weights from_files(std::vector<std::string> const& paths) {
        require_value(!paths.empty(), "weights", "paths", "empty", "at least one");
        weights result;
        for (auto const& path : paths) {
            safetensors_file const& file = result.files_.emplace_back(path);
            for (auto const& [name, entry] : file.entries()) {
                auto const [other, is_new] = result.file_of_.emplace(name, result.files_.size() - 1);
                if (!is_new) {
                    throw file_error(path + ": tensor " + name + " is in " + result.files_[other->second].path() +
                                     " too, expected each tensor once");
                }
            }
        }
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

    /// The elements of tensor `name`, row-major. Throws file_error `path: there is no tensor ...` or `path: tensor ...
    /// is [..], expected [..]`.
    std::vector<Real> take(std::string const& name, std::vector<std::size_t> const& shape) {
        taken_.insert_or_assign(name, shape);
        if (!files_.empty()) {
            auto const& file = file_with(name);
            auto const found = file.entries().find(name);
            if (found == file.entries().end()) {
                throw file_error(file.path() + ": there is no tensor " + name + ", expected one of shape " +
                                 extents_text(shape));
            }
            if (found->second.shape != shape) {
                throw file_error(file.path() + ": tensor " + name + " is " + extents_text(found->second.shape) +
                                 ", expected " + extents_text(shape));
            }
            return file.template read<Real>(name);
        }
        auto const values = seeded_tensor(seed_, network_, name, shape);
        return {values.begin(), values.end()};
    }

    /// Whether one of the files holds a tensor of this name. A seeded store, which makes what it is asked for, holds
    /// none.
    bool holds(std::string const& name) const { return file_of_.contains(name); }

    /// Lets tensors be left over whose names begin so: what a file holds beside the network that is built.
    void leave(std::string const& beginning) { left_.push_back(beginning); }

    /// Throws file_error naming the tensors of the files that nobody took or left.
    void require_all_taken() const {
        std::string surplus;
        std::size_t count = 0;
        auto const is_left = [&](std::string const& name) {
            return std::any_of(left_.begin(), left_.end(),
                               [&](auto const& beginning) { return name.starts_with(beginning); });
        };
        for (auto const& [name, file] : file_of_) {
            if (!taken_.contains(name) && !is_left(name) && ++count <= 5) {
                surplus += (count > 1 ? ", " : "") + name;
            }
        }
        if (count > 0) {
            throw file_error(files_.front().path() + ": " + std::to_string(count) +
                             " tensors have no place in the network: " + surplus + (count > 5 ? ", ..." : "") +
                             ", expected none");
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
            result[name] = files_.empty() ? seeded_tensor(seed_, network_, name, shape)
                                          : file_with(name).template read<float>(name);
        }
        return result;
    }

    /// Writes all tensors taken so far into a safetensors file, from which from_file gives equal ones. Throws
    /// file_error if the file cannot be written.
    void save(std::string const& path, safetensors_storage storage = safetensors_storage::f32) const {
        auto const tensors = values();
        std::map<std::string, safetensors_source> sources;
        for (auto const& [name, elements] : tensors) {
            sources[name] = {taken_.at(name), elements};
        }
        write_safetensors(path, sources, storage);
    }

private:
    weights() = default;

    /// The file that holds a tensor, or, if none does, the one to blame.
    safetensors_file const& file_with(std::string const& name) const {
        auto const found = file_of_.find(name);
        return files_[found == file_of_.end() ? 0 : found->second];
    }

    std::vector<safetensors_file> files_;
    std::map<std::string, std::size_t> file_of_;
    std::uint64_t seed_ = 0;
    std::string network_;
    std::map<std::string, std::vector<std::size_t>> taken_;
    std::vector<std::string> left_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
