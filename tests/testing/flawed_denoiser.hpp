// SPDX-License-Identifier: MIT
// The second engine with one thing wrong, a flaw for each law of denoisers and of their calls.
#pragma once

#include "second_denoiser.hpp"

#include <genrender/attention/feature_storage.hpp>
#include <genrender/attention/kept_variance.hpp>
#include <genrender/attention/plain_attention.hpp>
#include <genrender/attention/projected_features.hpp>
#include <genrender/blending/mix_rows_keeping_variance.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/keyframes/stoppable_denoiser.hpp>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <thread>
#include <vector>

namespace genrender::testing {

enum class flaw {
    none,
    // of a denoiser
    has_no_branch,
    has_site_without_channels,
    changes_z,
    leaves_a_frame_unwritten,
    counts_its_calls,
    lets_frames_meet,
    minds_the_thread,
    runs_a_site_twice,
    leaves_a_site_out,
    names_a_place_that_is_none,
    tells_other_frames,
    // of a stoppable one and of a lender
    stops_too_early,
    changes_z_when_stopped,
    lends_what_is_wrong,
    lends_to_any_z,
    // of a call
    adds_blocks_up,
    reads_the_first_block,
    reads_its_own_frame,
    reuses_memory_of_keys,
    projects_its_own_f,
    writes_into_F,
    swaps_alpha,
    clears_uncovered_rows,
    reads_the_last_entry,
    reads_the_first_frame_of_F_KF,
    keeps_too_much_of_F_hat,
    joins_what_is_left_out,
    projects_keys_twice,
    stores_zeros,
    stores_what_is_infinite,
    ignores_scales,
    scales_by_pattern_alone,
    keeps_variance_unasked,
    keeps_variance_without_bound,
    rescales_uncovered_rows
};

/// A call of the second engine with a flaw.
struct flawed_call {
    using features_type = second_engine::tensor;
    using real_type = float;
    static constexpr bool scales_logits = true;

    second_engine::attention_run const* run;
    flaw what;
    std::vector<frame_index> backwards;
    std::map<attention_place, features_type>* keys;

    attention_place place() const {
        return what == flaw::names_a_place_that_is_none ? attention_place{{7}, run->place().branch} : run->place();
    }
    std::span<frame_index const> frames() const {
        return what == flaw::tells_other_frames ? std::span<frame_index const>(backwards) : run->frames();
    }
    features_type f() const { return run->f(); }
    features_type query(features_type const& f) const { return run->query(f); }
    features_type key(features_type const& f) const {
        auto const K = run->key(what == flaw::projects_its_own_f ? run->f() : f);
        if (what != flaw::reuses_memory_of_keys) {
            return K;
        }
        auto& memory = (*keys)[run->place()];
        if (memory.elements == nullptr || memory.elements->size() != K.elements->size()) {
            memory = K.clone();
        }
        *memory.elements = *K.elements;
        return memory;
    }
    features_type value(features_type const& f) const { return run->value(f); }
    projected_features<features_type> project(features_type const& f) const {
        return {query(f), key(f), what == flaw::projects_keys_twice ? key(f) : value(f)};
    }

    /// The second engine knows no scales: queries take them.
    features_type scaled(features_type const& Q, attention_sources<features_type> const& sources) const {
        if (!sources.is_scaled() || what == flaw::ignores_scales ||
            (what == flaw::scales_by_pattern_alone && sources.pattern().meaning == attention_meaning::listed)) {
            return Q;
        }
        auto out = Q.clone();
        for (std::size_t i = 0; i < Q.frames; ++i) {
            for (std::size_t e = 0; e < Q.tokens * Q.channels; ++e) {
                out.row(i, 0)[e] *= static_cast<float>(sources.scale(i));
            }
        }
        return out;
    }

    features_type attend(features_type const& unscaled, attention_sources<features_type> const& sources) const {
        auto const Q = scaled(unscaled, sources);
        auto changed = sources;
        if (auto const& all = sources.pattern();
            what == flaw::joins_what_is_left_out && all.meaning == attention_meaning::own_and_joined) {
            return run->attend(Q, attention_sources<features_type>::own_and_joined(
                                      *all.K, *all.V, *all.K_KF, *all.V_KF, all.joined,
                                      std::vector<std::optional<std::size_t>>(sources.size())));
        }
        if (what == flaw::adds_blocks_up) {
            features_type sum(Q.frames, Q.tokens, Q.channels);
            for (std::size_t b = 0; b < sources.front().size(); ++b) {
                for (std::size_t i = 0; i < sources.size(); ++i) {
                    changed[i] = {sources[i][std::min(b, sources[i].size() - 1)]};
                }
                auto const part = run->attend(Q, changed);
                for (std::size_t e = 0; e < sum.elements->size(); ++e) {
                    (*sum.elements)[e] += (*part.elements)[e];
                }
            }
            return sum;
        }
        for (std::size_t i = 0; i < changed.size(); ++i) {
            if (what == flaw::reads_the_first_block) {
                changed[i].resize(1);
            }
            for (auto& block : changed[i]) {
                block.frame = what == flaw::reads_its_own_frame ? i : block.frame;
            }
        }
        return run->attend(Q, changed);
    }

    features_type mix(features_type const& F_hat, features_type const& F_KF, std::span<sparse_rows<float> const> rows,
                      float alpha) const {
        if (what == flaw::swaps_alpha) {
            return run->mix(F_hat, F_KF, rows, 1 - alpha);
        }
        if (what == flaw::reads_the_first_frame_of_F_KF) {
            auto first = F_KF.clone();
            for (std::size_t i = 1; i < first.frames; ++i) {
                std::copy_n(F_KF.row(0, 0), F_KF.tokens * F_KF.channels, first.row(i, 0));
            }
            return run->mix(F_hat, first, rows, alpha);
        }
        auto F = run->mix(F_hat, F_KF, rows, alpha).clone();
        for (std::size_t i = 0; i < F.frames; ++i) {
            for (std::size_t t = 0; t < F.tokens; ++t) {
                for (std::size_t c = 0; c < F.channels; ++c) {
                    auto& x = F.row(i, t)[c];
                    if (!rows[i].is_covered(t)) {
                        x = what == flaw::clears_uncovered_rows ? 0 : x;
                    } else if (what == flaw::reads_the_last_entry) {
                        auto const e = rows[i].offsets[t + 1] - 1;
                        x = alpha * rows[i].weights[e] * F_KF.row(0, rows[i].sources[e])[c] +
                            (1 - alpha) * F_hat.row(i, t)[c];
                    } else if (what == flaw::keeps_too_much_of_F_hat) {
                        x += (alpha - alpha * alpha) * F_hat.row(i, t)[c];
                    }
                }
            }
        }
        return F;
    }

    features_type mix_keeping_variance(features_type const& F_hat, features_type const& F_KF,
                                       std::span<sparse_rows<float> const> rows, float alpha,
                                       kept_variance const& kept) const {
        auto told = kept;
        if (what == flaw::keeps_variance_unasked && told.target == variance_target::none) {
            told.target = variance_target::total;
        }
        told.most_gain = what == flaw::keeps_variance_without_bound ? 1e6 : told.most_gain;
        auto F = what == flaw::keeps_variance_unasked || kept.target != variance_target::none
                     ? F_hat.clone()
                     : mix(F_hat, F_KF, rows, alpha);
        for (std::size_t i = 0; i < F.frames && told.target != variance_target::none; ++i) {
            strided_view<float, 2> const out(F.row(i, 0), {F.tokens, F.channels});
            strided_view<float const, 3> const bank(F_KF.elements->data(), {F_KF.frames, F_KF.tokens, F_KF.channels});
            mix_rows_keeping_variance(out, bank, rows[i], alpha, told);
            if (what == flaw::rescales_uncovered_rows && rows[i].sources.empty()) {
                *out.data() *= 2;
            }
        }
        return F;
    }

    features_type stored(features_type const& x, feature_storage storage) const {
        auto kept = x.clone();
        if (what == flaw::stores_zeros && storage == feature_storage::same) {
            std::fill(kept.elements->begin(), kept.elements->end(), 0.0F);
        }
        if (what == flaw::stores_what_is_infinite && storage == feature_storage::f16) {
            std::fill(kept.elements->begin(), kept.elements->end(), std::numeric_limits<float>::infinity());
        }
        return kept;
    }
};

/// The second engine's denoiser, which can stop and lends its estimates, with a flaw.
struct flawed_denoiser {
    using real_type = float;
    using features_type = second_engine::tensor;
    struct residuals_type {
        std::vector<float> z;
        std::vector<float> x0;
    };

    flaw what = flaw::none;
    std::thread::id home = std::this_thread::get_id();
    mutable std::atomic<int> calls{0};
    mutable std::map<attention_place, features_type> keys{};
    second_engine::denoiser phi{};

    std::size_t latent_channels() const { return phi.latent_channels(); }
    grid_extents latent_grid() const { return phi.latent_grid(); }
    std::size_t branches() const { return what == flaw::has_no_branch ? 0 : phi.branches(); }
    std::vector<attention_site> sites() const {
        auto modules = phi.sites();
        modules[1].channels = what == flaw::has_site_without_channels ? 0 : modules[1].channels;
        return modules;
    }
    std::size_t residual_bytes() const { return 4 * 48; }

    template <class Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        ++calls;
        auto const ends = [&](auto& run) {
            flawed_call call{&run, what, {frames.rbegin(), frames.rend()}, &keys};
            if (what == flaw::leaves_a_site_out && run.place().site.value == 1) {
                return plain_attention{}(call);
            }
            if (what == flaw::runs_a_site_twice && run.place().site.value == 1) {
                processor(call);
            }
            features_type const F = processor(call);
            auto const used = F.clone();
            if (what == flaw::writes_into_F) {
                std::for_each(F.elements->begin(), F.elements->end(), [](float& x) { x += 1; });
            }
            return used;
        };
        phi(x0, z, sigma, frames, ends);
        auto const frame_size = x0.size() / frames.size();
        auto* const last = x0.data() + x0.size() - frame_size;
        switch (what) {
        case flaw::changes_z:
            const_cast<float*>(z.data())[5] += 1;
            break;
        case flaw::leaves_a_frame_unwritten:
            std::fill_n(last, frame_size, std::numeric_limits<float>::quiet_NaN());
            break;
        case flaw::counts_its_calls:
            last[0] += static_cast<float>(calls.load());
            break;
        case flaw::lets_frames_meet:
            last[1] += static_cast<float>(frames.size());
            break;
        case flaw::minds_the_thread:
            last[2] += std::this_thread::get_id() == home ? 0.0F : 1.0F;
            break;
        default:
            break;
        }
    }

    template <class Processor>
    void run_until(strided_view<float const, 4> z, float sigma, std::span<frame_index const> frames,
                   Processor& processor, std::span<std::optional<site_index> const> last,
                   residuals_type* lent = nullptr) const {
        auto const until_last = [&](auto& call) {
            auto const& end = last[call.place().branch];
            auto const site = call.place().site.value + (what == flaw::stops_too_early ? 1U : 0U);
            return end && site <= end->value ? processor(call) : plain_attention{}(call);
        };
        stack<float, 4> x0(z.extents());
        (*this)(x0.view(), z, sigma, frames, until_last);
        if (what == flaw::changes_z_when_stopped) {
            const_cast<float*>(z.data())[6] += 1;
        }
        if (lent != nullptr) {
            *lent = {{z.data(), z.data() + z.size()}, {x0.data(), x0.data() + x0.size()}};
        }
    }

    template <class Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor, residuals_type const& lent) const {
        if (what == flaw::lends_to_any_z || std::equal(z.data(), z.data() + z.size(), lent.z.begin(), lent.z.end())) {
            std::copy(lent.x0.begin(), lent.x0.end(), x0.data());
            x0.data()[0] += what == flaw::lends_what_is_wrong ? 1.0F : 0.0F;
        } else {
            (*this)(x0, z, sigma, frames, processor);
        }
    }
};

} // namespace genrender::testing
