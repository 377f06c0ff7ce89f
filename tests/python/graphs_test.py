# SPDX-License-Identifier: MIT
"""Alg. 1 over static graphs on NumPy arrays: graphs_test.py. Finds the package by PYTHONPATH; exit code 77 where there is none."""

import importlib.util
import sys
import unittest

missing = [name for name in ("genrender", "numpy") if importlib.util.find_spec(name) is None]
if missing:
    print("skipped: the Python", sys.executable, "lacks", ", ".join(missing))
    sys.exit(77)

import genrender
import numpy as np
from genrender.graphs import render
from genrender.rows import Rows

FRAMES, SIDE, M, ALPHA, WEIGHTS = 5, 8, 2, 0.6, (-0.5, 1.5)
GRID, COARSE, CHANNELS = (SIDE, SIDE), (SIDE // 2, SIDE // 2), 3


def maps():
    """A slanted square that moves a pixel to the right in each frame."""
    pixels = 4 * SIDE
    uv, coverage = np.zeros((FRAMES, pixels, pixels, 2), np.float32), np.zeros((FRAMES, pixels, pixels), np.uint8)
    rows, columns = np.mgrid[:16, :16]
    for i in range(FRAMES):
        uv[i, 8:24, i + 4:i + 20, 0] = (columns + 0.5 + 0.1 * rows) / 20
        uv[i, 8:24, i + 4:i + 20, 1] = (rows + 0.5) / 16
        coverage[i, 8:24, i + 4:i + 20] = 1
    return genrender.Maps(uv, np.zeros(coverage.shape, np.uint32), coverage)


def tokens_of(z, coarse):
    """Features [frames, tokens, channels] of latents, at half the resolution if `coarse`."""
    z = z.reshape(len(z), CHANNELS, SIDE // 2, 2, SIDE // 2, 2).mean((3, 5)) if coarse else z
    return z.reshape(len(z), CHANNELS, -1).transpose(0, 2, 1)


def latents_of(F, coarse):
    side = SIDE // 2 if coarse else SIDE
    F = F.transpose(0, 2, 1).reshape(len(F), CHANNELS, side, side)
    return F.repeat(2, 2).repeat(2, 3) if coarse else F


class Network:
    """F = tanh((1 + power) z t / 500 + branch) at both resolutions, mixed as it is told; v is the sum. Its modules are numbered 2
    and 5. The power is that of the temperature, which it takes unless it is told not to."""

    MODULES = {2: False, 5: True}

    def __init__(self, scales_logits=True):
        self.calls, self.scales_logits = [], scales_logits

    def __call__(self, name, frames, branch, inputs):
        self.calls.append((name, list(frames), branch))
        z, out = inputs["z"], {"v": 0}
        power = inputs.get("genrender.length_correction") if self.scales_logits else None
        if power is not None:
            out["genrender.scales_logits"] = power
        for number, coarse in self.MODULES.items():
            at = f"genrender.{number}."
            f = tokens_of(z, coarse)
            F = np.tanh(f * (inputs["t"] if power is None else inputs["t"] * (1 + power)) / 500 + branch)
            if name == "keyframe":
                out |= {at + "f": f, at + "F": F}
            else:
                rows = inputs[at + "F_KF"].reshape(-1, CHANNELS)
                F_bar = inputs[at + "weights"] @ rows[inputs[at + "index"]]
                # f_KF takes part too, so that it is told from nothing.
                F = inputs[at + "own"] * F + F_bar.reshape(F.shape) + 0.1 * inputs[at + "f_KF"].mean((0, 1))
            out["v"] = out["v"] + latents_of(F, coarse)
        return out


def written_out(steps, seed, normalization, consensus=False, latents_grid_alpha=1, power=0):
    """The same by loops over frames, without the package's graphs."""
    of, schedule = maps(), genrender.NoiseSchedule.scaled_linear()
    sigmas = genrender.karras_schedule(steps, schedule.sigma_min, schedule.sigma_max)
    correspondences = {coarse: of.correspondence(*(COARSE if coarse else GRID)) for coarse in (False, True)}

    agreed = genrender.Consensus(correspondences[False], steps, seed=seed)

    def D(z, sigma, step):
        c_skip, c_out, c_in = genrender.scalings("epsilon", sigma)
        t, KF, F_sum = schedule.t_of(sigma), genrender.draw_keyframes(M, FRAMES, step, seed), np.zeros(z.shape)
        for branch, weight in enumerate(WEIGHTS):
            for number, coarse in Network.MODULES.items():
                f = tokens_of(c_in * z, coarse)
                F = np.tanh(f * t * (1 + power) / 500 + branch)
                for i in range(FRAMES):
                    index, weights, own = correspondences[coarse].padded_rows(
                        KF, [i], ALPHA if coarse else ALPHA * latents_grid_alpha)
                    rows = F[KF].reshape(-1, CHANNELS)
                    F_bar = (weights[0, ..., None] * rows[index[0]]).sum(1)
                    mixed = own[0, :, None] * F[i] + F_bar + 0.1 * f[KF].mean((0, 1))
                    F_sum[i] += weight * latents_of(mixed[None], coarse)[0]
        x0 = (c_skip * z + c_out * F_sum).astype(np.float32)
        if consensus:
            agreed.reach(x0, step)
        if normalization != "none":
            genrender.normalize_latents(x0, of.background(*GRID), normalization)
        return x0

    z = np.float32(sigmas[0]) * of.initial_noise(CHANNELS, *GRID, seed=seed)
    return genrender.sample("euler", D, z, sigmas)


def rendered(network, **settings):
    return render(maps(), network, **{"channels": CHANNELS, "grid": GRID, "preset": "plain", "steps": 3, "seed": 4, "keyframes": M,
                                      "frames_per_call": 2, "alpha": ALPHA, "branch_weights": WEIGHTS, **settings})


class GraphsTest(unittest.TestCase):
    def test_latents_are_those_of_the_equations_written_out(self):
        for settings, told in ((("mean",), {}), (("none", True, 0), {"preset": "vivid"}),
                               (("mean", False, 1, 2), {"length_correction": 2}), (("none",), {"normalization": "none"})):
            expected, found = written_out(3, 4, *settings), rendered(Network(), **told)
            self.assertEqual(found.shape, (FRAMES, CHANNELS, *GRID))
            self.assertEqual(found.dtype, np.float32)
            self.assertLessEqual(np.abs(found - expected).max(), 1e-5 * (expected.max() - expected.min()))
        frame_by_frame = rendered(Network(), alpha=0)
        self.assertGreater(np.abs(frame_by_frame - expected).max(), 1e-2 * (expected.max() - expected.min()))

    def test_keyframes_come_first_in_every_step_and_the_last_call_has_what_is_left(self):
        network = Network()
        rendered(network, steps=2)
        self.assertEqual(len(network.calls), 2 * 2 * (1 + 3))
        for step in (0, 1):
            calls = network.calls[8 * step:8 * step + 8]
            self.assertEqual([name for name, _, _ in calls], ["keyframe"] * 2 + ["injected"] * 6)
            self.assertEqual([frames for _, frames, _ in calls[2::2]], [[0, 1], [2, 3], [4]])
            self.assertEqual([branch for _, _, branch in calls], [0, 1] * 4)
            self.assertEqual(calls[0][1], genrender.draw_keyframes(M, FRAMES, step, 4))

    def test_what_does_not_fit_is_refused_in_a_sentence(self):
        for settings, expected in (({"keyframes": 0}, "keyframes is 0, expected at least 1"),
                                   ({"frames_per_call": 0}, "frames_per_call is 0, expected at least 1"),
                                   ({"branch_weights": ()}, "branches is 0, expected at least 1"),
                                   ({"length_correction": -1}, "length_correction is -1, expected a finite number, 0 or more"),
                                   ({"length_correction": float("nan")}, "length_correction is nan, expected a finite number"),
                                   ({"keyframes": 9}, "count is 9, expected 1 to the animation's 5 frames")):
            with self.subTest(expected), self.assertRaisesRegex(ValueError, expected):
                rendered(Network(), **settings)

    def test_a_temperature_is_refused_by_graphs_that_do_not_say_they_scale(self):
        with self.assertRaisesRegex(ValueError, "length_correction is 1, expected 0 for a graph without the output "
                                                "genrender.scales_logits"):
            rendered(Network(scales_logits=False), length_correction=1)
        rendered(Network(scales_logits=False))

    def test_rows_of_a_grid_that_is_no_halved_one_are_refused(self):
        rows = Rows(maps(), GRID)
        self.assertEqual(rows.grid_of(16), (4, 4))
        with self.assertRaisesRegex(ValueError, "a feature map has 17 tokens"):
            rows.grid_of(17)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
