// SPDX-License-Identifier: MIT
// A formula applied to every element, once over memory and a register at a time.
#pragma once

#include <genrender/core/register_vector.hpp>
#include <genrender/core/strided_view.hpp>

#include <cassert>
#include <cstddef>
#include <cstring>

namespace genrender {

/// out[e] = formula(in[e]...) for `count` neighbouring elements; `formula` takes and gives numbers or registers of
/// them, so it is made of +, -, * and /. `out` may be one of `in`.
template <class Real, class Formula, class... In>
void for_each_element(Real* out, std::size_t count, Formula const& formula, In const*... in) {
    std::size_t e = 0;
#if defined(__GNUC__)
    using lanes = detail::register_vector<Real>;
    for (; e + detail::register_lanes<Real> <= count; e += detail::register_lanes<Real>) {
        lanes const value = formula(detail::load_as<lanes>(in + e)...);
        std::memcpy(out + e, &value, sizeof(value));
    }
#endif
    for (; e < count; ++e) {
        out[e] = formula(in[e]...);
    }
}

/// The same for views of equal extents and any strides.
template <class Real, std::size_t Rank, class Formula, class... In>
void for_each_element(strided_view<Real, Rank> out, Formula const& formula, In const&... in) {
    assert(((in.extents() == out.extents()) && ...) && "for_each_element: views of other extents");
    if (out.is_contiguous() && (in.is_contiguous() && ...)) {
        for_each_element(out.data(), out.size(), formula, in.data()...);
    } else if constexpr (Rank == 1) {
        for (std::size_t e = 0; e < out.extent(0); ++e) {
            out(e) = formula(in(e)...);
        }
    } else {
        for (std::size_t i = 0; i < out.extent(0); ++i) {
            for_each_element(out[i], formula, in[i]...);
        }
    }
}

} // namespace genrender
