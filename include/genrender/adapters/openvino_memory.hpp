// SPDX-License-Identifier: MIT
// Tensors of OpenVINO that models read and write in place: recorded features, and plans in padded rows.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_site.hpp>
#include <genrender/attention/feature_storage.hpp>
#include <genrender/blending/padded_rows.hpp>
#include <genrender/core/error.hpp>
#include <genrender/core/sparse_rows.hpp>
#include <genrender/injection/graph_pass.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <openvino/core/type/element_type.hpp>
#include <openvino/runtime/tensor.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

namespace genrender::adapters {

/// The element type that features are kept in: f32, or 16 bits.
inline ov::element::Type openvino_type_of(feature_storage storage) {
    switch (storage) {
    case feature_storage::f16:
        return ov::element::f16;
    case feature_storage::bf16:
        return ov::element::bf16;
    default:
        return ov::element::f32;
    }
}

/// Features of a place, as a handle to memory that an openvino_feature_io keeps.
struct openvino_features {
    ov::Tensor tensor; ///< [frames, tokens, channels]
    /// Whether both are the same memory.
    friend bool operator==(openvino_features const& a, openvino_features const& b) {
        return a.tensor && b.tensor ? a.tensor.data() == b.tensor.data() : !a.tensor && !b.tensor;
    }
    /// {frames, tokens, channels}; zeros of no tensor.
    std::array<std::size_t, 3> extents() const {
        std::array<std::size_t, 3> extents{};
        if (tensor) {
            auto const& shape = tensor.get_shape();
            std::copy_n(shape.begin(), std::min<std::size_t>(shape.size(), 3), extents.begin());
        }
        return extents;
    }
};

/// The same features: the model has written them in the storage that the run asked for. Throws value_error if they are of
/// another one.
inline openvino_features stored(openvino_features const& x, feature_storage storage) {
    require_value(storage == feature_storage::same ||
                      (x.tensor && x.tensor.get_element_type() == openvino_type_of(storage)),
                  "stored", "x", "features of another type", "those of memory that was made for this storage");
    return x;
}

/// f_KF and F_KF of a place [keyframes, tokens, channels]: written by the model of the keyframe pass, read by that of the
/// injected one, and written again in the next step.
struct openvino_bank {
    ov::Tensor f_KF; ///< eq. 5: inputs of the module
    ov::Tensor F_KF; ///< eq. 6: outputs of the module
};

/// The plans of a stack of frames at a site, and what the frames leave out.
class openvino_plan {
public:
    /// Allocates for stacks of `frames` frames of so many tokens, in a run of these shapes.
    openvino_plan(std::size_t frames, std::size_t tokens, run_shapes const& shapes)
        : index(ov::element::i32, {frames * tokens, std::max<std::size_t>(shapes.row_width, 1)}),
          weights(ov::element::f32, {frames * tokens, 1, std::max<std::size_t>(shapes.row_width, 1)}),
          own(ov::element::f32, {frames, tokens, 1}),
          mask(ov::element::f32, {frames, 1, 1, tokens * (1 + shapes.keyframes)}), frames_(frames), tokens_(tokens) {
        write_left_out<float>(mask_view(), {}, tokens_);
    }

    ov::Tensor index;   ///< i32 [frames tokens, W], rows of F_KF
    ov::Tensor weights; ///< f32 [frames tokens, 1, W], with alpha
    ov::Tensor own;     ///< f32 [frames, tokens, 1], the share of F_hat
    ov::Tensor mask;    ///< f32 [frames, 1, 1, tokens (1 + m)], added to the products of queries and keys

    /// Writes the rows of a call, unless they are those of the last one (plan_key). Throws as write_padded_rows does.
    void write_rows(std::span<sparse_rows<float> const> rows, float alpha) {
        if (last_.holds(rows, alpha)) {
            return;
        }
        last_ = {};
        auto const width = index.get_shape()[1];
        std::array const extents{frames_, tokens_, width};
        write_padded_rows<float>({{index.data<std::int32_t>(), extents},
                                  {weights.data<float>(), extents},
                                  {own.data<float>(), {frames_, tokens_}}},
                                 rows, alpha);
        last_.set(rows, alpha);
        ++writes_;
    }

    /// Writes what each frame leaves out. Throws as write_left_out does.
    void write_mask(std::span<std::optional<std::size_t> const> left_out) {
        write_left_out<float>(mask_view(), left_out, tokens_);
    }

    /// How often rows were written.
    std::size_t writes() const { return writes_; }

private:
    strided_view<float, 2> mask_view() { return {mask.data<float>(), {frames_, mask.get_shape()[3]}}; }

    std::size_t frames_;
    std::size_t tokens_;
    uploaded_rows<float> last_;
    std::size_t writes_ = 0;
};

/// What the logits of each frame of a stack are multiplied by.
struct openvino_scales {
    ov::Tensor tensor; ///< f32 [frames, 1, 1]
    /// Writes them, one a frame.
    void write(std::span<double const> scales) {
        std::transform(scales.begin(), scales.end(), tensor.data<float>(),
                       [](double scale) { return static_cast<float>(scale); });
    }
};

/// Makes the tensors of a graph_feature_io in host memory.
struct openvino_memory {
    using features_type = openvino_features; ///< a handle
    using bank_type = openvino_bank;         ///< f_KF and F_KF
    using plan_type = openvino_plan;         ///< rows and masks
    using scales_type = openvino_scales;     ///< of logits

    /// Features of the keyframes of a site.
    openvino_bank bank(attention_site const& site, run_shapes const& shapes) const {
        ov::Shape const shape{shapes.keyframes, site.grid.size(), site.channels};
        auto const type = openvino_type_of(shapes.storage);
        return {ov::Tensor(type, shape), ov::Tensor(type, shape)};
    }
    /// Plans of a stack of frames of so many tokens.
    openvino_plan plan(std::size_t frames, std::size_t tokens, run_shapes const& shapes) const {
        return {frames, tokens, shapes};
    }
    /// Scales of a stack of frames.
    openvino_scales scales(std::size_t frames) const { return {ov::Tensor(ov::element::f32, {frames, 1, 1})}; }
};

} // namespace genrender::adapters

#include <genrender/core/end_header.inl>
