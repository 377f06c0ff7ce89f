// SPDX-License-Identifier: MIT
// An animation of surfaces by formula: a camera goes around balls on a floor. Real shapes for the kernels of
// correspondence, blending and noise, without a rasteriser.
#pragma once

#include <genrender/core/stack.hpp>
#include <genrender/maps/canonical_maps.hpp>
#include <genrender/maps/uv_maps_view.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>

namespace genrender::benchmarks {

/// UV maps and rest positions of a floor (object 0) and three balls under a sky, 512 x 512 pixels unless told.
class turning_world {
public:
    explicit turning_world(std::size_t frames, std::size_t side = 512)
        : uv_({frames, side, side, 2}), position_({frames, side, side, 3}), object_({frames, side, side}),
          coverage_({frames, side, side}) {
        for (std::size_t i = 0; i < frames; ++i) {
            draw(i, frames, side);
        }
    }

    uv_maps_view uv() const { return {uv_.view(), object_.view(), coverage_.view()}; }
    position_maps_view position() const { return {position_.view(), object_.view(), coverage_.view()}; }
    strided_view<std::uint8_t const, 3> coverage() const { return coverage_.view(); }

private:
    using point = std::array<double, 3>;

    static double dot(point const& a, point const& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
    static point along(point const& from, double way, point const& direction) {
        return {from[0] + way * direction[0], from[1] + way * direction[1], from[2] + way * direction[2]};
    }

    void draw(std::size_t i, std::size_t frames, std::size_t side) {
        auto const pi = std::numbers::pi;
        auto const angle = 0.5 * pi * static_cast<double>(i) / static_cast<double>(frames);
        point const eye{6 * std::sin(angle), 3, 6 * std::cos(angle)};
        point const right{std::cos(angle), 0, -std::sin(angle)};
        point const ahead{-0.92 * std::sin(angle), -0.392, -0.92 * std::cos(angle)};
        point const up{-0.392 * std::sin(angle), 0.92, -0.392 * std::cos(angle)};
        struct ball {
            point middle;
            double radius;
        };
        std::array<ball, 3> const balls{{{{0, 1, 0}, 1}, {{-1.9, 0.6, 0.6}, 0.6}, {{1.6, 0.8, 0.9}, 0.8}}};
        for (std::size_t row = 0; row < side; ++row) {
            for (std::size_t column = 0; column < side; ++column) {
                auto const x = ((static_cast<double>(column) + 0.5) / static_cast<double>(side) - 0.5) * 0.9;
                auto const y = (0.5 - (static_cast<double>(row) + 0.5) / static_cast<double>(side)) * 0.9;
                auto const ray = along(along(ahead, x, right), y, up);
                std::optional<double> nearest;
                if (auto const way = -eye[1] / ray[1]; ray[1] < 0 && way < 16) {
                    nearest = way;
                    auto const at = along(eye, way, ray);
                    paint(i, row, column, 0, {at[0] / 16 + 0.5, at[2] / 16 + 0.5}, at);
                }
                for (std::uint32_t b = 0; b < balls.size(); ++b) {
                    auto const& [middle, radius] = balls[b];
                    auto const to_eye = along(eye, -1, middle);
                    auto const half = dot(to_eye, ray) / dot(ray, ray);
                    auto const root = half * half - (dot(to_eye, to_eye) - radius * radius) / dot(ray, ray);
                    if (root <= 0 || (nearest && -half - std::sqrt(root) > *nearest)) {
                        continue;
                    }
                    nearest = -half - std::sqrt(root);
                    auto const at = along(along(eye, *nearest, ray), -1, middle);
                    paint(i, row, column, b + 1,
                          {std::atan2(at[0], at[2]) / (2 * pi) + 0.5, std::acos(at[1] / radius) / pi}, at);
                }
            }
        }
    }

    void paint(std::size_t i, std::size_t row, std::size_t column, std::uint32_t object,
               std::array<double, 2> const& uv, point const& at) {
        uv_(i, row, column, 0) = static_cast<float>(uv[0]);
        uv_(i, row, column, 1) = static_cast<float>(uv[1]);
        for (std::size_t d = 0; d < 3; ++d) {
            position_(i, row, column, d) = static_cast<float>(at[d]);
        }
        object_(i, row, column) = object;
        coverage_(i, row, column) = 1;
    }

    stack<float, 4> uv_;
    stack<float, 4> position_;
    stack<std::uint32_t, 3> object_;
    stack<std::uint8_t, 3> coverage_;
};

} // namespace genrender::benchmarks
