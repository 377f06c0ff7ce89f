// SPDX-License-Identifier: MIT
// [GR sec. 3.1] The laws of attention_processor, as a check of a model on features in host memory.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_processor.hpp>
#include <genrender/attention/host_features.hpp>
#include <genrender/attention/plain_attention.hpp>
#include <genrender/injection/host_attention_call.hpp>
#include <genrender/testing/analytic_denoiser.hpp>
#include <genrender/testing/at_once.hpp>
#include <genrender/testing/law_report.hpp>
#include <genrender/testing/random_stack.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace genrender::testing {

/// Checks the laws of attention_processor on random features [frames, tokens, channels] of the given frames, at the
/// sites 0 .. sites - 1 of both of two guidance branches, where Q = K = V = f. Calls end before their results are read
/// and features are freed with them, so a processor that keeps a reference to either is found by an address sanitizer.
/// Throws what the processor throws.
template <class Real, class Processor>
law_report check_attention_processor_laws(Processor& processor, std::span<frame_index const> frames, std::size_t tokens,
                                          std::size_t channels, std::uint32_t sites) {
    using call_type = host_attention_call<Real, identity_projections>;
    static_assert(attention_processor<Processor, call_type>,
                  "check_attention_processor_laws: the processor does not run host_attention_call<Real, "
                  "identity_projections>, whose features are host_features<Real>");
    law_report report;
    identity_projections const module;
    std::size_t const places = 2 * std::size_t{sites};
    std::vector<stack<Real, 3>> inputs;
    auto const place = [](std::size_t p) {
        return attention_place{{static_cast<std::uint32_t>(p / 2)}, static_cast<std::uint32_t>(p % 2)};
    };
    auto const place_text = [&](std::size_t p) {
        return "site " + std::to_string(p / 2) + " of branch " + std::to_string(p % 2);
    };
    auto const run_with = [&](auto& any, std::size_t p) -> host_features<Real> {
        call_type call(place(p), frames, host_features<Real>(inputs[p].view()), module);
        return any(call);
    };
    auto const values = [](host_features<Real> const& F) {
        stack<Real, 3> copied(F.extents());
        copy(copied.view(), in_view<Real, 3>(F));
        return copied;
    };
    std::vector<stack<Real, 3>> outputs;
    for (std::size_t p = 0; p < places; ++p) {
        inputs.push_back(random_stack<Real, 3>({frames.size(), tokens, channels}, p));
        auto const before = inputs.back();
        auto const F = run_with(processor, p);
        report.require(F.extents() == before.extents(), "attention_processor: F has the extents of f",
                       extents_text(F.extents()) + " at " + place_text(p), extents_text(before.extents()));
        if (!report.empty()) {
            return report;
        }
        outputs.push_back(values(F));
        detail::require_same(report, "attention_processor: f is not changed", "f of " + place_text(p) + ", f",
                             inputs.back(), before);
    }
    for (std::size_t p = 0; p < places; ++p) {
        if (is_plain_at(processor, place(p))) {
            plain_attention const plain;
            detail::require_same(report,
                                 "partly_plain_processor: is_plain_at tells where it does what plain_attention does",
                                 "F of " + place_text(p) + ", F", outputs[p], values(run_with(plain, p)));
        }
    }
    // Places may run at the same time, and give what they gave one after the other.
    std::vector<host_features<Real>> again(places);
    at_once(2, places, [&](std::size_t p) { again[p] = run_with(processor, p); });
    for (std::size_t p = 0; p < places; ++p) {
        detail::require_same(report, "attention_processor: places may run at the same time, and again",
                             "F of " + place_text(p) + ", F", values(again[p]), outputs[p]);
    }
    return report;
}

} // namespace genrender::testing

#include <genrender/core/end_header.inl>
