// SPDX-License-Identifier: MIT
// The parameters of a network from safetensors files, and into one.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/reference/safetensors.hpp>
#include <genrender/reference/tensor_place.hpp>
#include <genrender/reference/weights.hpp>

#include <concepts>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace genrender::reference {

/// The tensors of several safetensors files, converted as they are taken. Throws value_error if there is none, file_error
/// as safetensors_file does, and for a tensor that is in two of them.
template <std::floating_point Real>
weights<Real> read_weights(std::vector<std::string> const& paths) {
    require_value(!paths.empty(), "read_weights", "paths", "empty", "at least one");
    tensor_places places;
    for (auto const& path : paths) {
        add_places(places, places_of(std::make_shared<safetensors_file const>(path)));
    }
    return weights<Real>::from_places(std::move(places), paths.front());
}

/// Those of one. Throws file_error as safetensors_file does.
template <std::floating_point Real>
weights<Real> read_weights(std::string const& path) {
    return read_weights<Real>(std::vector{path});
}

/// Writes all tensors taken so far into a safetensors file, from which read_weights gives equal ones. Throws file_error
/// if the file cannot be written.
template <std::floating_point Real>
void write_weights(std::string const& path, weights<Real> const& source,
                   safetensors_storage storage = safetensors_storage::f32) {
    auto const tensors = source.values();
    std::map<std::string, safetensors_source> sources;
    for (auto const& [name, elements] : tensors) {
        sources[name] = {source.taken().at(name), elements};
    }
    write_safetensors(path, sources, storage);
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
