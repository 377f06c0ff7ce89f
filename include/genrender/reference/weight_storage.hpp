// SPDX-License-Identifier: MIT
// The type that weights are kept in, which may be narrower than that of the products.
#pragma once

#include <genrender/core/begin_header.inl>

#include <string_view>

namespace genrender::reference {

/// What type weights are rounded to, and kept in where features are float: double keeps their values in full width.
/// Products are of the features' type in any case.
enum class weight_storage {
    real,    ///< that of the features
    float16, ///< IEEE binary16: half the memory of float
    bfloat16 ///< bfloat16: half the memory of float
};

/// The storage in which elements of a safetensors file stay as they are: float16 for `F16`, bfloat16 for `BF16`, else
/// real.
constexpr weight_storage storage_of_dtype(std::string_view dtype) {
    return dtype == "F16" ? weight_storage::float16 : dtype == "BF16" ? weight_storage::bfloat16 : weight_storage::real;
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
