// SPDX-License-Identifier: MIT
// The transformer of the UNet: self-attention through the processor, attention to the prompt, a feed-forward layer.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/host_features.hpp>
#include <genrender/attention/scaled_dot_product.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/attention_matrices.hpp>
#include <genrender/reference/feature_maps.hpp>
#include <genrender/reference/feed_forward.hpp>
#include <genrender/reference/forward_pass.hpp>
#include <genrender/reference/layer_norm.hpp>
#include <genrender/reference/site_list.hpp>
#include <genrender/reference/unet_config.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

namespace genrender::reference {

namespace internal {

/// The view itself if its rows are contiguous, else a copy of it in `storage`.
template <class Real>
strided_view<Real const, 2> with_contiguous_rows(strided_view<Real const, 2> view, stack<Real, 2>& storage) {
    if (view.rows_are_contiguous()) {
        return view;
    }
    storage = stack<Real, 2>::uninitialized(view.extents());
    copy(storage.view(), view);
    return storage.view();
}

} // namespace internal

/// diffusers' BasicTransformerBlock: h += attn1(norm1(h)), h += attn2(norm2(h), prompt), h += ff(norm3(h)).
template <class Real>
class transformer_block {
public:
    /// Takes `name.norm1`, `.attn1`, `.norm2`, `.attn2`, `.norm3` and `.ff`, and enters `name.attn1` into the list of
    /// sites.
    transformer_block(unet_config const& config, weights<Real>& source, site_list& sites, std::string const& name,
                      std::size_t level, network_part part)
        : site_(sites.add(name + ".attn1", part, level, config.block_out_channels[level])),
          norm1_(source, name + ".norm1", config.block_out_channels[level]),
          attn1_(source, name + ".attn1", config.block_out_channels[level], config.block_out_channels[level],
                 config.attention_head_dim[level]),
          norm2_(source, name + ".norm2", config.block_out_channels[level]),
          attn2_(source, name + ".attn2", config.block_out_channels[level], config.cross_attention_dim,
                 config.attention_head_dim[level]),
          norm3_(source, name + ".norm3", config.block_out_channels[level]),
          ff_(source, name + ".ff", config.block_out_channels[level]) {}

    /// Runs the block in place of h [frames, tokens, channels]. Throws shape_error if the processor returns other
    /// extents.
    void operator()(forward_pass<Real> const& pass, feature_maps<Real>& h) const {
        attend_to_features(pass, h);
        if (pass.is_over) {
            return;
        }

        // The prompt is the same for all frames.
        stack<Real, 2> K({pass.prompt.extent(0), h.channels()});
        stack<Real, 2> V(K.extents());
        attn2_.key(K.view(), pass.prompt);
        attn2_.value(V.view(), pass.prompt);
        std::array const prompt{key_value_view<Real>{K.view(), V.view()}};
        pass.each_frame([&](std::size_t i) {
            // All that follows is a token's own affair, so tokens pass through all of it, some at a time.
            auto const tokens = h[i].extent(0);
            constexpr std::size_t block = 384;
            pass.tokens()((tokens + block - 1) / block, [&](std::size_t b) {
                auto const rows = h[i].slice(b * block, std::min(block, tokens - b * block));
                auto memory = stack<Real, 3>::uninitialized({2, rows.extent(0), rows.extent(1)});
                auto const normed = memory.view()[0];
                auto const Q = memory.view()[1];
                norm2_(normed, rows);
                attn2_.query(Q, normed);
                scaled_dot_product(normed, Q, prompt, attn2_.heads());
                attn2_.add_output(rows, normed);

                norm3_(normed, rows);
                ff_.add_to(rows, normed);
            });
        });
    }

private:
    void attend_to_features(forward_pass<Real> const& pass, feature_maps<Real>& h) const {
        // Memory of its own for every run: a processor may keep the handle of f.
        auto const f = host_features<Real>::allocate(h.view().extents());
        pass.each_frame([&](std::size_t i) { norm1_(f.view()[i], h[i]); });
        typename any_processor<Real>::call_type call({site_, pass.branch}, pass.frames, f, attn1_, pass.loop);
        auto const F = pass.processor(call);
        pass.is_over = pass.last_site == site_;
        require_extents("transformer_block", "F", F.extents(), f.extents());
        pass.each_frame([&](std::size_t i) {
            stack<Real, 2> storage;
            attn1_.add_output(h[i], internal::with_contiguous_rows<Real>(F.view()[i], storage), pass.tokens());
        });
    }

    site_index site_;
    layer_norm<Real> norm1_;
    attention_matrices<Real> attn1_;
    layer_norm<Real> norm2_;
    attention_matrices<Real> attn2_;
    layer_norm<Real> norm3_;
    feed_forward<Real> ff_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
