// SPDX-License-Identifier: MIT
// An engine without tensors, for what adapters of static graphs share: features are numbers, and what is written is noted.
#pragma once

#include <genrender/adapters/graph_feature_io.hpp>
#include <genrender/attention/attention_site.hpp>
#include <genrender/core/sparse_rows.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace genrender::testing {

/// Features, as the number of their memory.
struct numbered_features {
    int memory = 0;
    friend bool operator==(numbered_features, numbered_features) = default;
};

struct numbered_bank {
    int f_KF;
    int F_KF;
};

/// Notes what it is given.
struct noted_plan {
    std::size_t frames;
    std::size_t tokens;
    std::vector<float> alphas{};
    std::vector<std::optional<std::size_t>> left_out{};
    void write_rows(std::span<sparse_rows<float> const>, float alpha) { alphas.push_back(alpha); }
    void write_mask(std::span<std::optional<std::size_t> const> of) { left_out.assign(of.begin(), of.end()); }
};

struct noted_scales {
    std::size_t frames;
    std::vector<double> values{};
    void write(std::span<double const> of) { values.assign(of.begin(), of.end()); }
};

/// Counts what it makes.
struct numbered_memory {
    using features_type = numbered_features;
    using bank_type = numbered_bank;
    using plan_type = noted_plan;
    using scales_type = noted_scales;
    int made = 0;
    numbered_bank bank(attention_site const&, run_shapes const&) {
        made += 2;
        return {made - 1, made};
    }
    noted_plan plan(std::size_t frames, std::size_t tokens, run_shapes const&) const { return {frames, tokens}; }
    noted_scales scales(std::size_t frames) const { return {frames}; }
};

using numbered_feature_io = adapters::graph_feature_io<numbered_memory>;

} // namespace genrender::testing
