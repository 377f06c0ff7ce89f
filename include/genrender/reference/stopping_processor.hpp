// SPDX-License-Identifier: MIT
// Ends a network's call early: an attention processor that throws behind the last site that is wanted.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_site.hpp>
#include <genrender/attention/host_features.hpp>
#include <genrender/reference/forward_pass.hpp>

namespace genrender::reference {

namespace internal {

/// Ends a run of a network behind its last wanted site.
struct last_site_has_run {};

/// A processor that throws last_site_has_run after it ran at `last`. No layer needs to know that runs may end early.
template <class Real>
struct stopping_processor {
    any_processor<Real> processor;
    site_index last;

    host_features<Real> operator()(typename any_processor<Real>::call_type& call) const {
        auto F = processor(call);
        if (call.place().site == last) {
            throw last_site_has_run{};
        }
        return F;
    }
};

} // namespace internal

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
