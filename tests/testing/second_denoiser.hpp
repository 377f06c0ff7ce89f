// SPDX-License-Identifier: MIT
// A second model of denoiser, written from sampling/denoiser.hpp and what it includes alone: an engine with a tensor,
// projections, attention and mixing of its own, which shares nothing with host_features and its call. What could not be
// read there while it was written, and can now: that views of the library's calls have no gaps, that features_type and
// real_type are those of the calls, when an output projection and the residual are applied, that blocks may be rows of
// another call's stack with another number of frames, that heads are the engine's own affair, and that sites may be
// returned by value.
#pragma once

#include <genrender/sampling/denoiser.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

namespace second_engine {

/// A handle of elements [frames, tokens, channels]; copies share them.
struct tensor {
    std::size_t frames = 0;
    std::size_t tokens = 0;
    std::size_t channels = 0;
    std::shared_ptr<std::vector<float>> elements;

    tensor() = default;
    tensor(std::size_t frame_count, std::size_t token_count, std::size_t channel_count)
        : frames(frame_count), tokens(token_count), channels(channel_count),
          elements(std::make_shared<std::vector<float>>(frame_count * token_count * channel_count)) {}

    float* row(std::size_t frame, std::size_t token) const {
        return elements->data() + (frame * tokens + token) * channels;
    }
    tensor clone() const {
        tensor copied = *this;
        copied.elements = std::make_shared<std::vector<float>>(*elements);
        return copied;
    }
};

/// A matrix [channels, channels] of a fixed pattern, applied to every row.
struct matrix {
    float phase = 0;
    tensor operator()(tensor const& f) const {
        tensor out(f.frames, f.tokens, f.channels);
        for (std::size_t row = 0; row < f.frames * f.tokens; ++row) {
            for (std::size_t c = 0; c < f.channels; ++c) {
                float sum = 0;
                for (std::size_t k = 0; k < f.channels; ++k) {
                    sum += std::sin(phase + static_cast<float>(3 * c + 5 * k)) * f.row(0, row)[k];
                }
                out.row(0, row)[c] = sum;
            }
        }
        return out;
    }
};

/// A self-attention module of two heads.
struct module {
    matrix W_Q;
    matrix W_K;
    matrix W_V;
    matrix out;
};

/// One run of a module: the engine's operations on its own tensors.
struct attention_run {
    using features_type = tensor;
    using real_type = float;
    static constexpr std::size_t heads = 2;

    module const* weights;
    genrender::attention_place where;
    std::span<genrender::frame_index const> stack;
    tensor input;

    genrender::attention_place place() const { return where; }
    std::span<genrender::frame_index const> frames() const { return stack; }
    tensor f() const { return input; }
    tensor query(tensor const& f) const { return weights->W_Q(f); }
    tensor key(tensor const& f) const { return weights->W_K(f); }
    tensor value(tensor const& f) const { return weights->W_V(f); }

    tensor attend(tensor const& Q, genrender::attention_sources<tensor> const& sources) const {
        tensor F(Q.frames, Q.tokens, Q.channels);
        auto const width = Q.channels / heads;
        for (std::size_t i = 0; i < Q.frames; ++i) {
            for (std::size_t t = 0; t < Q.tokens; ++t) {
                for (std::size_t head = 0; head < heads; ++head) {
                    auto const* const q = Q.row(i, t) + head * width;
                    auto* const sum = F.row(i, t) + head * width;
                    float weight_sum = 0; // Scores are small, so their exponentials need no shift.
                    for (auto const& block : sources[i]) {
                        for (std::size_t s = 0; s < block.K->tokens; ++s) {
                            auto const* const k = block.K->row(block.frame, s) + head * width;
                            auto const* const v = block.V->row(block.frame, s) + head * width;
                            float score = 0;
                            for (std::size_t c = 0; c < width; ++c) {
                                score += q[c] * k[c];
                            }
                            auto const weight = std::exp(score / std::sqrt(static_cast<float>(width)));
                            weight_sum += weight;
                            for (std::size_t c = 0; c < width; ++c) {
                                sum[c] += weight * v[c];
                            }
                        }
                    }
                    for (std::size_t c = 0; c < width; ++c) {
                        sum[c] /= weight_sum;
                    }
                }
            }
        }
        return F;
    }

    tensor mix(tensor const& F_hat, tensor const& F_KF, std::span<genrender::sparse_rows<float> const> rows,
               float alpha) const {
        auto F = F_hat.clone();
        for (std::size_t i = 0; i < F.frames; ++i) {
            for (std::size_t t = 0; t < F.tokens; ++t) {
                for (std::size_t c = 0; c < F.channels && rows[i].is_covered(t); ++c) {
                    float F_bar = 0;
                    for (auto e = rows[i].offsets[t]; e < rows[i].offsets[t + 1]; ++e) {
                        F_bar += rows[i].weights[e] * F_KF.row(0, rows[i].sources[e])[c];
                    }
                    F.row(i, t)[c] = alpha * F_bar + (1 - alpha) * F_hat.row(i, t)[c];
                }
            }
        }
        return F;
    }
};

/// D(z, sigma) of latents [2, 4, 6] by a network of one module on the latents' grid and one on half of it, guided by
/// two branches; what it knows of a frame is its number.
class denoiser {
public:
    using real_type = float;
    using features_type = tensor;

    std::size_t latent_channels() const { return 2; }
    genrender::grid_extents latent_grid() const { return {4, 6}; }
    std::size_t branches() const { return 2; }
    std::vector<genrender::attention_site> sites() const {
        using genrender::network_kind;
        using genrender::network_part;
        return {{"coarse", network_kind::denoising, network_part::middle, {2, 3}, 4},
                {"fine", network_kind::denoising, network_part::decoder, {4, 6}, 4}};
    }

    template <class Processor>
    void operator()(genrender::strided_view<float, 4> x0, genrender::strided_view<float const, 4> z, float sigma,
                    std::span<genrender::frame_index const> frames, Processor& processor) const {
        if (!x0.is_contiguous() || !z.is_contiguous()) {
            throw std::invalid_argument("second_engine: latents have gaps, expected none");
        }
        constexpr std::size_t pixels = 24;
        auto const scale = 1 / std::sqrt(1 + sigma * sigma);
        for (std::uint32_t branch = 0; branch < 2; ++branch) {
            tensor h(frames.size(), pixels, 4);
            for (std::size_t i = 0; i < frames.size(); ++i) {
                for (std::size_t p = 0; p < pixels; ++p) {
                    auto const a = scale * z.data()[(i * 2 + 0) * pixels + p];
                    auto const b = scale * z.data()[(i * 2 + 1) * pixels + p];
                    auto const of_frame = std::sin(static_cast<float>(frames[i].value));
                    auto const of_branch = static_cast<float>(branch);
                    std::array const values{a, b, a * of_frame + of_branch, b - of_frame};
                    std::copy(values.begin(), values.end(), h.row(i, p));
                }
            }
            for (std::uint32_t site = 0; site < 2; ++site) {
                run_site(h, {{site}, branch}, frames, processor);
            }
            for (std::size_t i = 0; i < frames.size(); ++i) {
                for (std::size_t p = 0; p < pixels; ++p) {
                    for (std::size_t c = 0; c < 2; ++c) {
                        auto& out = x0.data()[(i * 2 + c) * pixels + p];
                        auto const own = h.row(i, p)[c] + h.row(i, p)[c + 2];
                        out = branch == 0 ? own : 1.5F * own - 0.5F * out;
                    }
                }
            }
        }
    }

private:
    /// Pools h to the site's grid, norms it, and adds what the processor returns, projected, to h.
    template <class Processor>
    void run_site(tensor const& h, genrender::attention_place place, std::span<genrender::frame_index const> frames,
                  Processor& processor) const {
        std::size_t const cell = place.site.value == 0 ? 2 : 1;
        auto const token_of = [&](std::size_t p) { return p / 6 / cell * (6 / cell) + p % 6 / cell; };
        tensor f(h.frames, 24 / (cell * cell), 4);
        for (std::size_t i = 0; i < h.frames; ++i) {
            for (std::size_t p = 0; p < h.tokens; ++p) {
                for (std::size_t c = 0; c < 4; ++c) {
                    f.row(i, token_of(p))[c] += std::tanh(h.row(i, p)[c]) / static_cast<float>(cell * cell);
                }
            }
        }
        attention_run call{&modules[place.site.value], place, frames, f};
        tensor const F = processor(call);
        auto const out = modules[place.site.value].out(F);
        for (std::size_t i = 0; i < h.frames; ++i) {
            for (std::size_t p = 0; p < h.tokens; ++p) {
                for (std::size_t c = 0; c < 4; ++c) {
                    h.row(i, p)[c] = std::tanh(h.row(i, p)[c] + out.row(i, token_of(p))[c]);
                }
            }
        }
    }

    std::array<module, 2> modules{module{{0.1F}, {0.2F}, {0.3F}, {0.4F}}, module{{1.1F}, {1.2F}, {1.3F}, {1.4F}}};
};

static_assert(genrender::denoiser<denoiser> && genrender::attention_call<attention_run>);

} // namespace second_engine
