// SPDX-License-Identifier: MIT
// The rescaling of one channel, with the vectors of one target.

namespace genrender::detail::GENRENDER_TARGET {

/// Each value becomes (value - mean_from) * scale + mean_to.
template <class Real>
void rescale(Real* values, std::size_t count, Real mean_from, Real scale, Real mean_to) {
    each_register(values, values, count, [&](std::size_t, lanes<Real> const& value) GENRENDER_ALWAYS_INLINE {
        return (value - mean_from) * scale + mean_to;
    });
}

} // namespace genrender::detail::GENRENDER_TARGET
