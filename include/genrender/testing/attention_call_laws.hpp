// SPDX-License-Identifier: MIT
// [GR eq. 1-6] The laws of attention_call, seen by what they do to the estimates of the denoiser that makes the calls.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/extended_attention.hpp>
#include <genrender/attention/feature_storage.hpp>
#include <genrender/attention/plain_attention.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/sparse_rows.hpp>
#include <genrender/testing/denoiser_laws.hpp>
#include <genrender/testing/law_report.hpp>
#include <genrender/testing/optional_call_laws.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace genrender::testing {

namespace detail {

/// Features of all frames that a call has handed out, kept when the call has ended.
template <class Features>
struct kept_handles {
    Features f;
    Features K;
    Features V;
    Features F;
};

} // namespace detail

/// Checks the laws of attention_call, and of storing_, projecting_ and scaling_attention_call and variance_keeping_call where
/// the calls are such, on the calls that `phi`
/// makes at noise level sigma for the frames of the trial. The library cannot look into an engine's features, so every
/// law is told by estimates that must be equal; a denoiser whose estimates do not depend on its attention passes
/// whatever its calls do. For denoisers that call their processor back; about 20 calls of all frames. Throws
/// value_error for a trial of fewer than 2 frames, and what the denoiser throws.
template <denoiser Phi>
law_report check_attention_call_laws(Phi const& phi, typename Phi::real_type sigma, denoiser_trial const& trial = {}) {
    using Real = typename Phi::real_type;
    using features = typename Phi::features_type;
    require_value(trial.frames.size() >= 2, "check_attention_call_laws", "trial.frames.size()", trial.frames.size(),
                  "at least 2 frames");
    law_report report;
    detail::denoiser_trials<Phi> const trials(phi, sigma, trial);
    auto const frames = trials.frames.size();
    auto const tokens = [&](attention_place place) {
        attention_site const site = phi.sites()[place.site.value];
        return site.grid.size();
    };
    std::mutex mutex;

    // What plain attention gives, and the handles of its calls, which have ended then.
    plain_attention const plain;
    auto const expected = trials.estimate(plain);
    std::map<attention_place, detail::kept_handles<features>> kept;
    auto const keep = [&](auto& call) {
        features const f = call.f();
        features const Q = call.query(f);
        features const K = call.key(f);
        features const V = call.value(f);
        features const F = call.attend(Q, own_attention_sources(K, V, frames));
        std::lock_guard const lock(mutex);
        kept.insert_or_assign(call.place(), detail::kept_handles<features>{f, K, V, F});
        return F;
    };
    trials.estimate(keep);
    auto const of = [&](attention_place place) {
        std::lock_guard const lock(mutex);
        return kept.at(place);
    };

    // -- attend
    auto const twice = [&](auto& call) {
        return detail::attend_to(call, [](features const& K, features const& V, std::size_t count) {
            auto sources = own_attention_sources(K, V, count);
            for (std::size_t i = 0; i < count; ++i) {
                sources[i].push_back(sources[i].front());
            }
            return sources;
        });
    };
    detail::require_same(report, "attention_call: the weights of attend sum to 1 over all blocks of a frame",
                         "with its own tokens twice, x0", trials.estimate(twice), expected, trial.tolerance);
    auto const in_order = [&](auto& call) {
        return detail::attend_to(call, [](features const& K, features const& V, std::size_t count) {
            return extended_attention_sources(K, V, count);
        });
    };
    auto const backwards = [&](auto& call) {
        return detail::attend_to(call, [](features const& K, features const& V, std::size_t count) {
            auto sources = extended_attention_sources(K, V, count);
            for (auto& blocks : sources) {
                std::reverse(blocks.begin(), blocks.end());
            }
            return sources;
        });
    };
    detail::require_same(report, "attention_call: attend depends on the order of blocks by rounding alone",
                         "with blocks reversed, x0", trials.estimate(backwards), trials.estimate(in_order),
                         trial.tolerance);

    // The same lists without a pattern, which writing to them forgets.
    auto const only_lists = [](attention_sources<features> sources) {
        for (auto& blocks : sources) {
            blocks.shrink_to_fit();
        }
        return sources;
    };
    auto const require_pattern = [&](char const* meaning, auto const& make_sources) {
        auto const by_pattern = [&](auto& call) { return detail::attend_to(call, make_sources); };
        auto const by_lists = [&](auto& call) {
            return detail::attend_to(call, [&](features const& K, features const& V, std::size_t count) {
                return only_lists(make_sources(K, V, count));
            });
        };
        detail::require_same(report, "attention_call: attend gives by sources.pattern() what it gives by the lists",
                             meaning, trials.estimate(by_pattern), trials.estimate(by_lists), trial.tolerance);
    };
    require_pattern("with own sources, x0", own_attention_sources<features>);
    require_pattern("with sources of the stack, x0", extended_attention_sources<features>);
    require_pattern("with joined sources, of which frames leave one out, x0",
                    [](features const& K, features const& V, std::size_t count) {
                        std::vector<std::optional<std::size_t>> left_out(count);
                        left_out.back() = 0;
                        return attention_sources<features>::own_and_joined(K, V, K, V, count, std::move(left_out));
                    });
    auto const one_by_one = [&](auto& call) { return detail::attend_to(call, own_attention_sources<features>); };
    detail::require_same(report, "projecting_attention_call: project gives what query, key and value give", "x0",
                         expected, trials.estimate(one_by_one), trial.tolerance);

    // -- handles that outlive their call, and the stack that they are of
    std::vector<frame_index> reversed(trials.frames.rbegin(), trials.frames.rend());
    auto other_stack = trials;
    other_stack.frames = reversed;
    auto expected_reversed = trials.unwritten(frames);
    for (std::size_t i = 0; i < frames; ++i) {
        copy(other_stack.z.view().slice(i, 1), in_view<Real, 4>(trials.z.view().slice(frames - 1 - i, 1)));
        copy(expected_reversed.view().slice(i, 1), in_view<Real, 4>(expected.view().slice(frames - 1 - i, 1)));
    }
    other_stack.estimate(plain); // Memory that calls share holds other values now.
    auto const from_kept = [&](auto const& of_block) {
        return [&, of_block](auto& call) {
            auto const handles = of(call.place());
            auto const blocks = of_block(call, handles);
            attention_sources<features> sources(frames);
            for (std::size_t i = 0; i < frames; ++i) {
                sources[i] = {{&blocks.K, &blocks.V, frames - 1 - i}};
            }
            features const f = call.f();
            return features(call.attend(call.query(f), sources));
        };
    };
    auto const kept_blocks = from_kept([](auto&, auto const& handles) { return handles; });
    detail::require_same(report,
                         "attention_call: keys and values stay what they were after their call, and a block's "
                         "frame counts in the stack that they are of",
                         "with K and V of an ended call, x0", other_stack.estimate(kept_blocks), expected_reversed,
                         trial.tolerance);
    auto const projected_again = from_kept([](auto& call, auto const& handles) {
        return detail::kept_handles<features>{handles.f, call.key(handles.f), call.value(handles.f), handles.F};
    });
    detail::require_same(report, "attention_call: key and value take any stack f, of an ended call too",
                         "with f of an ended call projected, x0", other_stack.estimate(projected_again),
                         expected_reversed, trial.tolerance);

    detail::check_scaling_laws(report, trials, expected, trial.tolerance);

    // -- mix
    std::vector<std::size_t> mirrored;
    for (std::size_t i = 0; i < frames; ++i) {
        mirrored.push_back(frames - 1 - i);
    }
    auto const mixed = [&](bool covers, Real alpha) {
        return [&, covers, alpha](auto& call) {
            features const F_hat = plain(call);
            detail::doubled_rows<Real> const plan(mirrored, tokens(call.place()));
            auto const rows = covers ? plan.covered() : plan.uncovered();
            return features(call.mix(F_hat, of(call.place()).F, rows, alpha));
        };
    };
    auto const none_of_it = mixed(true, Real(0));
    detail::require_same(report, "attention_call: mix with alpha = 0 returns F_hat", "x0", trials.estimate(none_of_it),
                         expected);
    auto const no_row = mixed(false, Real(1));
    detail::require_same(report, "attention_call: mix leaves rows that are not covered as they are", "x0",
                         trials.estimate(no_row), expected);
    auto const all_of_it = [&](auto& call) {
        detail::doubled_rows<Real> const plan(mirrored, tokens(call.place()));
        auto const rows = plan.covered();
        // A wrong F_hat, of which nothing may be left.
        features const f = call.f();
        return features(
            call.mix(call.attend(call.key(f), own_attention_sources(f, f, frames)), of(call.place()).F, rows, Real(1)));
    };
    detail::require_same(report,
                         "attention_call: mix with alpha = 1 gives covered rows the weighted sums of rows of "
                         "F_KF, read as [frames * tokens, channels], and F is what it was when its call ended",
                         "x0", other_stack.estimate(all_of_it), expected_reversed, trial.tolerance);
    auto const half_of_it = mixed(true, Real(0.5));
    detail::require_same(report, "attention_call: mix weighs F_bar by alpha and F_hat by 1 - alpha",
                         "with F_bar equal to F_hat, x0", other_stack.estimate(half_of_it), expected_reversed,
                         trial.tolerance);

    detail::check_variance_laws(report, trials, expected, trial.tolerance,
                                [&](attention_place place) { return of(place).F; });

    // -- storage in 16 bits
    bool is_stored = false;
    for (auto const storage : {feature_storage::same, feature_storage::f16, feature_storage::bf16}) {
        auto const stored_blocks = [&](auto& call) {
            using call_type = std::remove_cvref_t<decltype(call)>;
            features const f = call.f();
            features const Q = call.query(f);
            features K = call.key(f);
            features V = call.value(f);
            if constexpr (storing_attention_call<call_type>) {
                K = call.stored(K, storage);
                V = call.stored(V, storage);
                std::lock_guard const lock(mutex);
                is_stored = true;
            }
            features const F = call.attend(Q, own_attention_sources(K, V, frames));
            return F;
        };
        auto const x0 = trials.estimate(stored_blocks);
        if (!is_stored) {
            break;
        }
        if (storage == feature_storage::same) {
            detail::require_same(report, "storing_attention_call: feature_storage::same returns x", "x0", x0, expected);
        } else {
            for (std::size_t e = 0; e < x0.size(); ++e) {
                if (!is_finite(x0.data()[e])) {
                    report.add("storing_attention_call: attend takes keys and values of 16 bits",
                               "x0" + detail::address_text(x0.extents(), e) + " that is not finite", "a finite number");
                }
            }
        }
    }
    return report;
}

} // namespace genrender::testing

#include <genrender/core/end_header.inl>
