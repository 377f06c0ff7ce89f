// SPDX-License-Identifier: MIT
// Pieces of ggml graphs that go around the self-attention of an engine: eqs. 3, 5 and 6 as nodes.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/adapters/ggml_memory.hpp>
#include <genrender/adapters/graph_feature_io.hpp>
#include <genrender/attention/attention_site.hpp>
#include <genrender/injection/graph_pass.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <ggml.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace genrender::adapters {

/// One self-attention module of a graph under construction: what goes around the engine's own projections and attention.
/// Features are tensors of ne = {channels, tokens, frames}. At a place that takes no part, and in a plain pass, every
/// member gives back what it is given.
class ggml_site {
public:
    /// Of a pass. What pointers name outlives the graph: `bank` and `plan` are null where the module is left plain,
    /// `scales` where its logits are not scaled.
    ggml_site(graph_pass pass, run_shapes const& shapes, ggml_bank const* bank, ggml_plan const* plan,
              ggml_scales const* scales)
        : is_keyframe_(pass == graph_pass::keyframe && bank != nullptr),
          joins_(pass == graph_pass::injected && bank != nullptr && shapes.joins_keyframes),
          mixes_(pass == graph_pass::injected && bank != nullptr && shapes.mixes_rows),
          attends_to_stack_(is_keyframe_ && shapes.attends_to_stack), bank_(bank), plan_(plan), scales_(scales) {}

    /// The tokens that the module's queries are of: of f, or of its frames in a row (eq. 3: one long row of tokens that
    /// all attend to each other is the same). The module's residual and all behind it take f itself.
    ggml_tensor* queries(ggml_context* ctx, ggml_tensor* f) const {
        return attends_to_stack_ ? ggml_reshape_3d(ctx, contiguous(ctx, f), f->ne[0], f->ne[1] * f->ne[2], 1) : f;
    }

    /// What the module projected of `queries`, ne = {channels, .., ..}, times what the logits of each frame are multiplied by
    /// (the length-corrected temperature); Q itself where nothing is scaled. A network of which all modules take it says so
    /// (graph_network::scales_logits).
    ggml_tensor* scaled(ggml_context* ctx, ggml_tensor* Q) const {
        if (scales_ == nullptr) {
            return Q;
        }
        auto* const scale = scales_->tensor;
        auto const tokens = Q->ne[1] * Q->ne[2] / scale->ne[2];
        auto* const by_frame = ggml_reshape_3d(ctx, contiguous(ctx, Q), Q->ne[0], tokens, scale->ne[2]);
        return ggml_reshape_3d(ctx, ggml_mul(ctx, by_frame, scale), Q->ne[0], Q->ne[1], Q->ne[2]);
    }

    /// The tokens that keys and values are of: those of `queries`, or each frame's own and then the keyframes' (eq. 5),
    /// ne = {channels, tokens (1 + m), frames}.
    ggml_tensor* sources(ggml_context* ctx, ggml_tensor* f) const {
        return joins_ ? join(ctx, f, keyframes(ctx, f->type)) : queries(ctx, f);
    }

    /// f_KF in a row, ne = {channels, m tokens, 1}, for engines that project it once for all frames and `join` the
    /// products; null where nothing is joined.
    ggml_tensor* keyframes(ggml_context* ctx, ggml_type type) const {
        if (!joins_) {
            return nullptr;
        }
        auto* const f_KF = bank_->f_KF;
        auto* const row = ggml_reshape_3d(ctx, f_KF, f_KF->ne[0], f_KF->ne[1] * f_KF->ne[2], 1);
        return row->type == type ? row : ggml_cast(ctx, row, type);
    }

    /// Each frame's own tokens {channels, tokens, frames} and those of keyframes {channels, m tokens, 1} after them;
    /// `own` itself where `of_keyframes` is null.
    ggml_tensor* join(ggml_context* ctx, ggml_tensor* own, ggml_tensor* of_keyframes) const {
        if (of_keyframes == nullptr) {
            return own;
        }
        auto* const of_each = own->ne[2] == 1 ? of_keyframes
                                              : ggml_repeat_4d(ctx, of_keyframes, of_keyframes->ne[0],
                                                               of_keyframes->ne[1], own->ne[2], 1);
        return ggml_concat(ctx, own, of_each, 1);
    }

    /// What is added to the scaled products of queries and keys, F32 {tokens (1 + m), 1, 1, frames}: minus infinity for
    /// the keyframe that a frame leaves out, 0 else; null where nothing is left out.
    ggml_tensor* mask() const { return joins_ ? plan_->mask : nullptr; }

    /// The module's output {channels, tokens, frames} of what attention over `queries` and `sources` gave (behind the
    /// projection of the output, if there is one, and before the residual): recorded in a keyframe pass, mixed by eq. 6
    /// in an injected one. `f` is the module's input. Expands `graph` by what nobody else would ask for.
    ggml_tensor* output(ggml_context* ctx, ggml_cgraph* graph, ggml_tensor* f, ggml_tensor* F_hat) const {
        if (is_keyframe_) {
            auto* const F = ggml_reshape_3d(ctx, contiguous(ctx, F_hat), f->ne[0], f->ne[1], f->ne[2]);
            ggml_build_forward_expand(graph, ggml_cpy(ctx, f, bank_->f_KF));
            ggml_build_forward_expand(graph, ggml_cpy(ctx, F, bank_->F_KF));
            return F;
        }
        return mixes_ ? mixed(ctx, F_hat) : F_hat;
    }

private:
    static ggml_tensor* contiguous(ggml_context* ctx, ggml_tensor* t) {
        return ggml_is_contiguous(t) ? t : ggml_cont(ctx, t);
    }

    /// One gather a column of the padded rows: every backend has these operations.
    ggml_tensor* mixed(ggml_context* ctx, ggml_tensor* F_hat) const {
        auto* const F_KF = bank_->F_KF;
        auto* const rows = ggml_reshape_2d(ctx, F_KF, F_KF->ne[0], F_KF->ne[1] * F_KF->ne[2]);
        auto const count = plan_->own->ne[1];
        auto* F = ggml_mul(ctx, ggml_reshape_2d(ctx, contiguous(ctx, F_hat), F_hat->ne[0], count), plan_->own);
        for (std::int64_t w = 0; w < plan_->index->ne[1]; ++w) {
            auto const column = static_cast<std::size_t>(w);
            auto* const index = ggml_view_1d(ctx, plan_->index, count, column * plan_->index->nb[1]);
            auto* const weights =
                ggml_view_2d(ctx, plan_->weights, 1, count, plan_->weights->nb[1], column * plan_->weights->nb[2]);
            F = ggml_add(ctx, F, ggml_mul(ctx, ggml_get_rows(ctx, rows, index), weights));
        }
        return ggml_reshape_3d(ctx, F, F_hat->ne[0], F_hat->ne[1], F_hat->ne[2]);
    }

    bool is_keyframe_;
    bool joins_;
    bool mixes_;
    bool attends_to_stack_;
    ggml_bank const* bank_;
    ggml_plan const* plan_;
    ggml_scales const* scales_;
};

/// Feature I/O of ggml graphs: tensors in memory of its own on the backend, which no allocator of graphs reuses. Make one in
/// `prepare`; graphs must not outlive it.
class ggml_feature_io : public graph_feature_io<ggml_memory> {
public:
    /// For the shapes of a run and the denoiser's sites. The backend is the caller's and outlives it. Throws as
    /// graph_feature_io does; std::bad_alloc if the backend has no memory.
    ggml_feature_io(ggml_backend_t backend, run_shapes shapes, std::span<attention_site const> sites,
                    bool scales_logits = false)
        : graph_feature_io({backend}, std::move(shapes), sites, scales_logits) {}

    /// The module at a place, for building a graph of a pass with so many frames.
    ggml_site site(attention_place place, graph_pass pass, std::size_t frames) {
        auto const* const of_place = bank(place);
        auto const reads_plan = of_place != nullptr && pass == graph_pass::injected;
        return {pass, shapes(), of_place, reads_plan ? &plan(place.site, frames) : nullptr,
                scales(place, pass, frames)};
    }
};

} // namespace genrender::adapters

#include <genrender/core/end_header.inl>
