// SPDX-License-Identifier: MIT
// What every attention_processor owes beyond its concept, as checks for the library's models and for users' own.
#pragma once

#include "analytic_denoiser.hpp"
#include "random_stack.hpp"

#include <genrender/attention/attention_processor.hpp>
#include <genrender/core/parallel.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace genrender::testing {

/// Checks the laws of attention_processor on features [frames, tokens, channels] of the given frames, at the sites
/// 0 .. sites - 1 and both of two guidance branches.
template <class Real, class Processor>
void check_attention_processor_laws(Processor& processor, std::span<frame_index const> frames, std::size_t tokens,
                                    std::size_t channels, std::uint32_t sites) {
    using call_type = host_attention_call<Real, identity_projections>;
    static_assert(attention_processor<Processor, call_type>);
    identity_projections const module;
    std::size_t const places = 2 * sites;
    std::vector<stack<Real, 3>> inputs;
    std::vector<stack<Real, 3>> outputs;
    auto const run = [&](std::size_t p) {
        // The call ends here: a processor that kept a reference to it would be found by the address sanitizer.
        call_type call({{static_cast<std::uint32_t>(p / 2)}, static_cast<std::uint32_t>(p % 2)}, frames,
                       host_features<Real>(inputs[p].view()), module);
        return processor(call);
    };
    for (std::size_t p = 0; p < places; ++p) {
        inputs.push_back(random_stack<Real, 3>({frames.size(), tokens, channels}, p));
        auto const before = inputs.back();
        auto const F = run(p);
        REQUIRE(F.extents() == before.extents());
        outputs.emplace_back(before.extents());
        copy(outputs.back().view(), in_view<Real, 3>(F));
        for (std::size_t e = 0; e < before.size(); ++e) {
            REQUIRE(inputs.back().data()[e] == before.data()[e]); // f is not changed
        }
    }
    // Places may run at the same time, and give what they gave one after the other.
    std::vector<host_features<Real>> again(places);
    threaded_loop(2)(places, [&](std::size_t p) { again[p] = run(p); });
    for (std::size_t p = 0; p < places; ++p) {
        for (std::size_t e = 0; e < outputs[p].size(); ++e) {
            REQUIRE(again[p].view().data()[e] == outputs[p].data()[e]);
        }
    }
}

} // namespace genrender::testing
