# SPDX-License-Identifier: MIT
"""Generative Rendering (alg. 1) with static graphs, which call nobody back: those of ONNX Runtime and others.

The graphs have the inputs and outputs that genrender.add_feature_io adds; `render` gives the latents of an animation.
"""

import numpy as np

from . import NoiseSchedule, draw_keyframes, karras_schedule, sample, scalings
from .estimates import Estimates, require_length_correction, with_preset
from .rows import Rows


class Run:
    """What all evaluations of a run share; `D` is the clean estimate of the whole animation."""

    def __init__(self, maps, graph, grid, **settings):
        self.__dict__.update(settings)
        self.run_graph, self.rows = graph, Rows(maps, grid, self.average)
        self.estimates = Estimates(self.rows, self.steps, self.seed, self.consensus, self.normalization)

    def graph(self, name, frames, branch, inputs):
        """The outputs of a graph, which is given the power of the temperature where there is one."""
        if not self.length_correction:
            return self.run_graph(name, frames, branch, inputs)
        power = np.array([self.length_correction], np.float32)
        outputs = self.run_graph(name, frames, branch, inputs | {"genrender.length_correction": power})
        if "genrender.scales_logits" not in outputs:
            raise ValueError(f"render: length_correction is {self.length_correction}, expected 0 for a graph without the output "
                             f"genrender.scales_logits (add_feature_io --scales-logits)")
        return outputs

    def D(self, z, sigma, step):
        """The clean estimates of all frames of z [frames, channels, height, width]: the body of alg. 1's loop."""
        c_skip, c_out, c_in = scalings(self.prediction, sigma)
        t = np.array([self.schedule.t_of(sigma)], np.float32)
        keyframes = draw_keyframes(self.keyframes, len(z), step, self.seed)
        x = np.float32(c_in) * z
        recorded = [self.graph("keyframe", keyframes, branch, {"z": x[keyframes], "t": t})
                    for branch in range(len(self.branch_weights))]
        F = np.zeros_like(z)
        for first in range(0, len(z), self.frames_per_call):
            frames = list(range(first, min(first + self.frames_per_call, len(z))))
            for branch, weight in enumerate(self.branch_weights):
                inputs = {"z": x[frames], "t": t} | self.injected(recorded[branch], keyframes, frames)
                F[frames] += np.float32(weight) * self.graph("injected", frames, branch, inputs)["v"]
        x0 = np.float32(c_skip) * z + np.float32(c_out) * F
        self.estimates.finish(x0, step)
        return x0

    def injected(self, recorded, keyframes, frames):
        """The extra inputs of an injected graph: recorded features and the rows of these frames, for each module."""
        inputs = {}
        for name, f in recorded.items():
            if not name.startswith("genrender.") or not name.endswith(".f"):
                continue
            at, tokens = name.removesuffix("f"), f.shape[1]
            alpha = self.rows.alpha_at(tokens, self.alpha, self.latents_grid_alpha)
            index, weights, own = self.rows.rows(tokens, keyframes, frames, alpha, self.width)
            inputs |= {at + "f_KF": f, at + "F_KF": recorded[at + "F"], at + "index": index.reshape(-1, self.width),
                       at + "weights": weights.reshape(-1, 1, self.width), at + "own": own[..., None]}
        return inputs


def render(maps, graph, *, channels, grid, preset="vivid", steps=50, seed=0, keyframes=None, frames_per_call=1, alpha=0.7,
           latents_grid_alpha=None, branch_weights=(1,), prediction="epsilon", schedule=None, sampler="euler", consensus=None,
           normalization=None, average="quality", noise="uv", width=None, observer=None, length_correction=0.0):
    """Consistent clean latents of all frames [frames, channels, *grid], as a NumPy array of float32.

    `graph(name, frames, branch, inputs)` runs the graph `name`, "keyframe" or "injected", for these numbers of frames and a
    guidance branch, and returns its outputs by name, "v" among them. `inputs` are "z" [frames, channels, *grid], scaled, "t"
    [1], a time that may have a fraction, and what genrender.add_feature_io added; the function adds what else the network
    takes, and leaves out inputs that the graph does not have. It is called with `keyframes` frames or `frames_per_call`, the
    last time of a pass with what is left. Of `keyframes` None is 4, or all frames if these are fewer. `width` is that of the
    padded rows, `keyframes` where it is None. `branch_weights` are of the outputs of all branches: (1 - s, s) is guidance of
    scale s. `schedule` is a NoiseSchedule, of Stable Diffusion where it is None. `preset`, and `latents_grid_alpha`, `consensus`,
    `normalization` and `length_correction`, are those of genrender.diffusers.render; a `length_correction` above 0 takes graphs of
    add_feature_io's scales_logits. Raises ValueError for what does not fit.
    """
    keyframes = min(4, maps.frames) if keyframes is None else keyframes
    for name, value in (("keyframes", keyframes), ("frames_per_call", frames_per_call), ("branches", len(branch_weights))):
        if value < 1:
            raise ValueError(f"render: {name} is {value}, expected at least 1")
    require_length_correction(length_correction)
    schedule = NoiseSchedule.scaled_linear() if schedule is None else schedule
    of_preset = with_preset(preset, latents_grid_alpha=latents_grid_alpha, consensus=consensus, normalization=normalization)
    run = Run(maps, graph, grid, keyframes=keyframes, seed=seed, steps=steps, frames_per_call=frames_per_call, alpha=alpha,
              branch_weights=branch_weights, prediction=prediction, schedule=schedule, average=average,
              width=keyframes if width is None else width, length_correction=length_correction, **of_preset)
    sigmas = karras_schedule(steps, schedule.sigma_min, schedule.sigma_max)
    z = np.float32(sigmas[0]) * maps.initial_noise(channels, *grid, seed=seed, kind=noise)
    return sample(sampler, run.D, z, sigmas, observer)
