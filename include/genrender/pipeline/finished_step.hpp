// SPDX-License-Identifier: MIT
// A step of a run that is done, for who looks on: latents, clean estimates and a checkpoint, made when they are asked for.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/tensor.hpp>
#include <genrender/pipeline/checkpoint.hpp>

#include <cstddef>
#include <functional>
#include <utility>

namespace genrender {

/// What `after_step` of a run is told. Refers to the run: it may be used until after_step returns.
template <class Real>
class finished_step {
public:
    /// Step `number` of `count`, from 0, with the functions that read or make the rest.
    finished_step(std::size_t number, std::size_t count, std::function<latents<Real>()> z,
                  std::function<latents<Real>()> x0, std::function<checkpoint<Real>()> make_checkpoint)
        : number_(number), count_(count), z_(std::move(z)), x0_(std::move(x0)),
          make_checkpoint_(std::move(make_checkpoint)) {}

    /// Which step of the run, from 0.
    std::size_t number() const { return number_; }
    /// Steps of the run.
    std::size_t count() const { return count_; }
    /// z [frames, channels, height, width] after the step, downloaded from an engine that lends it.
    latents<Real> z() const { return z_(); }
    /// The clean estimates x0 of the step, of its last evaluation: what the frames look like as far as the run has come.
    /// Of the shape of z, and downloaded as z is.
    latents<Real> estimates() const { return x0_(); }
    /// What goes on from here. The first one of a run takes the fingerprint of settings, maps and model.
    checkpoint<Real> make_checkpoint() const { return make_checkpoint_(); }

private:
    std::size_t number_;
    std::size_t count_;
    std::function<latents<Real>()> z_;
    std::function<latents<Real>()> x0_;
    std::function<checkpoint<Real>()> make_checkpoint_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
