// SPDX-License-Identifier: MIT
// One object of a program whose objects have different flags: GENRENDER_OBJECT is its name.
#include <genrender/attention/scaled_dot_product.hpp>
#include <genrender/blending/mix_rows.hpp>
#include <genrender/core/linear_combination.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/vectors.hpp>
#include <genrender/normalization/channel_statistics.hpp>

#include "object.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#define GENRENDER_KERNELS "mixed_flags/object.inl"
#include <genrender/core/each_target.inl>

using namespace genrender;

namespace {

/// Values in [-1, 1] that are the same everywhere.
stack<float, 2> filled(std::size_t rows, std::size_t columns, std::uint32_t state) {
    stack<float, 2> values({rows, columns});
    for (std::size_t i = 0; i < values.size(); ++i) {
        state = state * 1664525U + 1013904223U;
        values.data()[i] = static_cast<float>(state >> 8U) / 8388608.0F - 1;
    }
    return values;
}

/// A number for the bits of all values, in their order.
std::uint64_t checksum_of(stack<float, 2> const& values) {
    std::uint64_t sum = 0xCBF29CE484222325U;
    for (std::size_t i = 0; i < values.size(); ++i) {
        sum = (sum ^ std::bit_cast<std::uint32_t>(values.data()[i])) * 0x100000001B3U;
    }
    return sum;
}

/// How far F is from softmax attention of one head, written plainly.
double attention_error(stack<float, 2> const& F, stack<float, 2> const& Q, stack<float, 2> const& K,
                       stack<float, 2> const& V) {
    auto const channels = Q.extent(1);
    double worst = 0;
    std::vector<double> weights(K.extent(0));
    for (std::size_t q = 0; q < Q.extent(0); ++q) {
        double sum = 0;
        for (std::size_t k = 0; k < weights.size(); ++k) {
            double logit = 0;
            for (std::size_t c = 0; c < channels; ++c) {
                logit += double{Q(q, c)} * double{K(k, c)};
            }
            weights[k] = std::exp(logit / std::sqrt(static_cast<double>(channels)));
            sum += weights[k];
        }
        for (std::size_t c = 0; c < channels; ++c) {
            double value = 0;
            for (std::size_t k = 0; k < weights.size(); ++k) {
                value += weights[k] / sum * double{V(k, c)};
            }
            worst = std::max(worst, std::abs(value - double{F(q, c)}));
        }
    }
    return worst;
}

} // namespace

object_report GENRENDER_OBJECT() {
    object_report report{};
    report.target = name_of(chosen_vector_target());
    report.register_bytes = GENRENDER_KERNEL(detail, register_bytes_of_object)();

    auto const Q = filled(70, 40, 1);
    auto const K = filled(90, 40, 2);
    auto const V = filled(90, 40, 3);
    stack<float, 2> F({70, 40});
    std::array const blocks{key_value_view<float>{K.view(), V.view()}};
    scaled_dot_product<float>(F.view(), Q.view(), blocks, 1);
    report.error = attention_error(F, Q, K, V);

    // Rows of three sources, then statistics.
    std::vector<std::uint32_t> offsets{0};
    std::vector<std::uint32_t> sources;
    for (std::uint32_t t = 0; t < 70; ++t) {
        for (std::uint32_t n = 0; n < 3; ++n) {
            sources.push_back((7 * t + 11 * n) % 90);
        }
        offsets.push_back(static_cast<std::uint32_t>(sources.size()));
    }
    std::vector<float> const weights(sources.size(), 1.0F / 3);
    auto mixed = F;
    strided_view<float const, 3> const F_KF(V.data(), {1, 90, 40});
    mix_rows<float>(mixed.view(), F_KF, {offsets, sources, weights}, 0.7F);
    for (std::size_t t = 0; t < 70; ++t) {
        for (std::size_t c = 0; c < 40; ++c) {
            double blended = 0;
            for (std::size_t n = 0; n < 3; ++n) {
                blended += double{V(sources[3 * t + n], c)} / 3;
            }
            report.error =
                std::max(report.error, std::abs(0.3 * double{F(t, c)} + 0.7 * blended - double{mixed(t, c)}));
        }
    }
    std::vector<std::uint8_t> const everywhere(70 * 40, 1);
    auto const statistics = masked_statistics(strided_view<float const, 3>(mixed.data(), {1, 70, 40}),
                                              strided_view<std::uint8_t const, 2>(everywhere.data(), {70, 40}));
    double mean = 0;
    for (std::size_t i = 0; i < mixed.size(); ++i) {
        mean += double{mixed.data()[i]} / static_cast<double>(mixed.size());
    }
    report.error = std::max(report.error, std::abs(mean - double{statistics.mean[0]}));

    linear_combination<float, 2>(F.data(), F.size(), {0.3F, statistics.deviation[0]}, {F.data(), mixed.data()});
    report.checksum = checksum_of(F);
    return report;
}
