// SPDX-License-Identifier: MIT
// Tensors of ggml that stay where they are between runs of a graph: recorded features, and plans in padded rows.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_site.hpp>
#include <genrender/attention/feature_storage.hpp>
#include <genrender/blending/padded_rows.hpp>
#include <genrender/core/error.hpp>
#include <genrender/core/sparse_rows.hpp>
#include <genrender/injection/graph_pass.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <ggml-backend.h>
#include <ggml-cpp.h>
#include <ggml.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <optional>
#include <span>
#include <vector>

namespace genrender::adapters {

/// Marks a tensor that is read after its graph has run. A reshape or view owns no memory: what it looks into is marked
/// too, or the allocator gives that memory to a later operation and the values read are others, without a word.
inline void keep_output(ggml_tensor* tensor) {
    for (; tensor != nullptr; tensor = tensor->view_src) {
        ggml_set_output(tensor);
    }
}

/// The type of ggml that features are kept in: F32, or 16 bits.
inline ggml_type ggml_type_of(feature_storage storage) {
    switch (storage) {
    case feature_storage::f16:
        return GGML_TYPE_F16;
    case feature_storage::bf16:
        return GGML_TYPE_BF16;
    default:
        return GGML_TYPE_F32;
    }
}

/// Features of a place, as a handle to memory that a ggml_feature_io keeps.
struct ggml_features {
    ggml_tensor* tensor = nullptr; ///< ne = {channels, tokens, frames}; not owned
    /// Whether both are the same tensor.
    friend bool operator==(ggml_features, ggml_features) = default;
    /// {frames, tokens, channels}; zeros of no tensor.
    std::array<std::size_t, 3> extents() const {
        if (tensor == nullptr) {
            return {};
        }
        return {static_cast<std::size_t>(tensor->ne[2]), static_cast<std::size_t>(tensor->ne[1]),
                static_cast<std::size_t>(tensor->ne[0])};
    }
};

/// The same features: the graph has written them in the storage that the run asked for. Throws value_error if they are of
/// another one.
inline ggml_features stored(ggml_features const& x, feature_storage storage) {
    require_value(storage == feature_storage::same || (x.tensor != nullptr && x.tensor->type == ggml_type_of(storage)),
                  "stored", "x", "features of another type", "those of memory that was made for this storage");
    return x;
}

/// Tensors that no graph's allocator touches, in a buffer of a backend.
class ggml_fixed_tensors {
public:
    /// Room for so many tensors, none yet.
    explicit ggml_fixed_tensors(std::size_t count)
        : context_(ggml_init({.mem_size = count * ggml_tensor_overhead(), .mem_buffer = nullptr, .no_alloc = true})) {
        if (!context_) {
            throw std::bad_alloc();
        }
    }

    /// One more tensor, before `allocate`.
    ggml_tensor* add(ggml_type type, std::array<std::size_t, 4> const& ne) {
        return ggml_new_tensor_4d(context_.get(), type, static_cast<std::int64_t>(ne[0]),
                                  static_cast<std::int64_t>(ne[1]), static_cast<std::int64_t>(ne[2]),
                                  static_cast<std::int64_t>(ne[3]));
    }

    /// Memory for all of them, zeros. Throws std::bad_alloc if the backend has none.
    void allocate(ggml_backend_t backend) {
        buffer_.reset(ggml_backend_alloc_ctx_tensors(context_.get(), backend));
        if (!buffer_) {
            throw std::bad_alloc();
        }
        ggml_backend_buffer_clear(buffer_.get(), 0);
    }

private:
    ggml_context_ptr context_;
    ggml_backend_buffer_ptr buffer_;
};

/// f_KF and F_KF of a place, ne = {channels, tokens, keyframes}: written by the graph of the keyframe pass, read by that of
/// the injected one, and written again in the next step.
struct ggml_bank {
    /// Allocates both.
    ggml_bank(ggml_backend_t backend, std::size_t channels, std::size_t tokens, std::size_t keyframes,
              feature_storage storage)
        : f_KF(memory_.add(ggml_type_of(storage), {channels, tokens, keyframes, 1})),
          F_KF(memory_.add(ggml_type_of(storage), {channels, tokens, keyframes, 1})) {
        memory_.allocate(backend);
    }

private:
    ggml_fixed_tensors memory_{2};

public:
    ggml_tensor* f_KF; ///< eq. 5: inputs of the module
    ggml_tensor* F_KF; ///< eq. 6: outputs of the module
};

/// The plans of a stack of frames at a site, and what the frames leave out.
class ggml_plan {
public:
    /// Allocates for stacks of `frames` frames of so many tokens, in a run of these shapes.
    ggml_plan(ggml_backend_t backend, std::size_t frames, std::size_t tokens, run_shapes const& shapes)
        : frames_(frames), tokens_(tokens), keyframes_(shapes.keyframes), width_(shapes.row_width) {
        auto const count = frames * tokens;
        if (shapes.mixes_rows) {
            index = memory_.add(GGML_TYPE_I32, {count, std::max<std::size_t>(width_, 1), 1, 1});
            weights = memory_.add(GGML_TYPE_F32, {1, count, std::max<std::size_t>(width_, 1), 1});
            own = memory_.add(GGML_TYPE_F32, {1, count, 1, 1});
        }
        if (shapes.joins_keyframes && shapes.leaves_out) {
            mask = memory_.add(GGML_TYPE_F32, {tokens * (1 + keyframes_), 1, 1, frames});
        }
        if (index != nullptr || mask != nullptr) {
            memory_.allocate(backend);
        }
    }

    ggml_tensor* index = nullptr;   ///< I32 {frames tokens, W}, rows of F_KF, a column after the other
    ggml_tensor* weights = nullptr; ///< F32 {1, frames tokens, W}, with alpha
    ggml_tensor* own = nullptr;     ///< F32 {1, frames tokens}, the share of F_hat
    ggml_tensor* mask = nullptr;    ///< F32 {tokens (1 + m), 1, 1, frames}; null where no frame leaves anything out

    /// Uploads the rows of a call, unless they are those of the last one (plan_key). Throws as write_padded_rows does.
    void write_rows(std::span<sparse_rows<float> const> rows, float alpha) {
        if (last_.holds(rows, alpha)) {
            return;
        }
        auto const count = frames_ * tokens_;
        auto const width = static_cast<std::size_t>(index->ne[1]);
        std::vector<std::int32_t> indices(count * width);
        std::vector<float> shares(count * width);
        std::vector<float> own_shares(count);
        std::array const extents{frames_, tokens_, width};
        std::array const strides{static_cast<std::ptrdiff_t>(tokens_), std::ptrdiff_t{1},
                                 static_cast<std::ptrdiff_t>(count)};
        write_padded_rows<float>({{indices.data(), extents, strides},
                                  {shares.data(), extents, strides},
                                  {own_shares.data(), {frames_, tokens_}}},
                                 rows, alpha);
        ggml_backend_tensor_set(index, indices.data(), 0, ggml_nbytes(index));
        ggml_backend_tensor_set(weights, shares.data(), 0, ggml_nbytes(weights));
        ggml_backend_tensor_set(own, own_shares.data(), 0, ggml_nbytes(own));
        last_.set(rows, alpha);
        ++uploads_;
    }

    /// Uploads what each frame leaves out, unless it is what the last call left out. Throws value_error if a frame leaves
    /// something out and the shapes said that none does.
    void write_mask(std::span<std::optional<std::size_t> const> left_out) {
        if (mask == nullptr) {
            auto const none = std::all_of(left_out.begin(), left_out.end(), [](auto const& k) { return !k; });
            require_value(none, "ggml_plan", "left_out", "a keyframe", "none, as shapes.leaves_out says");
            return;
        }
        if (std::equal(left_out.begin(), left_out.end(), left_out_.begin(), left_out_.end())) {
            return;
        }
        std::vector<float> added(frames_ * (1 + keyframes_) * tokens_);
        write_left_out<float>({added.data(), {frames_, (1 + keyframes_) * tokens_}}, left_out, tokens_);
        ggml_backend_tensor_set(mask, added.data(), 0, ggml_nbytes(mask));
        left_out_.assign(left_out.begin(), left_out.end());
    }

    /// How often rows were uploaded.
    std::size_t uploads() const { return uploads_; }

private:
    ggml_fixed_tensors memory_{4};
    std::size_t frames_;
    std::size_t tokens_;
    std::size_t keyframes_;
    std::size_t width_;
    uploaded_rows<float> last_;
    std::vector<std::optional<std::size_t>> left_out_;
    std::size_t uploads_ = 0;
};

/// What the logits of each frame of a stack are multiplied by.
class ggml_scales {
public:
    /// Allocates for so many frames.
    ggml_scales(ggml_backend_t backend, std::size_t frames) : tensor(memory_.add(GGML_TYPE_F32, {1, 1, frames, 1})) {
        memory_.allocate(backend);
    }
    /// Uploads them, one a frame.
    void write(std::span<double const> scales) {
        std::vector<float> const values(scales.begin(), scales.end());
        ggml_backend_tensor_set(tensor, values.data(), 0, ggml_nbytes(tensor));
    }

private:
    ggml_fixed_tensors memory_{1};

public:
    ggml_tensor* tensor; ///< F32 {1, 1, frames}
};

/// Makes the tensors of a graph_feature_io on a backend, which is the caller's and outlives them.
struct ggml_memory {
    using features_type = ggml_features; ///< a handle
    using bank_type = ggml_bank;         ///< f_KF and F_KF
    using plan_type = ggml_plan;         ///< rows and masks
    using scales_type = ggml_scales;     ///< of logits
    ggml_backend_t backend;              ///< whose memory it is

    /// Features of the keyframes of a site. Throws std::bad_alloc if the backend has no memory.
    ggml_bank bank(attention_site const& site, run_shapes const& shapes) const {
        return {backend, site.channels, site.grid.size(), shapes.keyframes, shapes.storage};
    }
    /// Plans of a stack of frames of so many tokens. Throws std::bad_alloc if the backend has no memory.
    ggml_plan plan(std::size_t frames, std::size_t tokens, run_shapes const& shapes) const {
        return {backend, frames, tokens, shapes};
    }
    /// Scales of a stack of frames. Throws std::bad_alloc if the backend has no memory.
    ggml_scales scales(std::size_t frames) const { return {backend, frames}; }
};

} // namespace genrender::adapters

#include <genrender/core/end_header.inl>
