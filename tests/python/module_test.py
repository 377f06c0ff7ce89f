# SPDX-License-Identifier: MIT
"""The Python module on NumPy arrays: module_test.py. Finds the package by PYTHONPATH; exit code 77 where there is none."""

import importlib.util
import math
import sys
import unittest

missing = [name for name in ("genrender", "numpy") if importlib.util.find_spec(name) is None]
if missing:
    print("skipped: the Python", sys.executable, "lacks", ", ".join(missing))
    sys.exit(77)

import genrender
import numpy as np

FRAMES, TOKENS, CELL = 3, 8, 4
SIDE = TOKENS * CELL


def moving_square():
    """A square of 4 x 4 tokens on a background of depth 0, one token further to the right in each frame."""
    uv = np.zeros((FRAMES, SIDE, SIDE, 2), np.float32)
    coverage = np.zeros((FRAMES, SIDE, SIDE), np.uint8)
    side = 4 * CELL
    along = (np.arange(side, dtype=np.float32) + 0.5) / side
    for i in range(FRAMES):
        rows, columns = slice(2 * CELL, 2 * CELL + side), slice((1 + i) * CELL, (1 + i) * CELL + side)
        uv[i, rows, columns, 0] = along[None, :]
        uv[i, rows, columns, 1] = along[:, None]
        coverage[i, rows, columns] = 1
    depth = np.where(coverage, 2 + np.arange(FRAMES, dtype=np.float32)[:, None, None], 0).astype(np.float32)
    return genrender.Maps(uv, np.zeros(coverage.shape, np.uint32), coverage, depth)


class MapsTest(unittest.TestCase):
    def setUp(self):
        self.maps = moving_square()

    def test_maps_keep_what_they_are_given(self):
        self.assertEqual((self.maps.frames, self.maps.height, self.maps.width), (FRAMES, SIDE, SIDE))
        self.assertEqual(self.maps.uv.shape, (FRAMES, SIDE, SIDE, 2))
        self.assertEqual(self.maps.coverage.sum(), FRAMES * (4 * CELL) ** 2)

    def test_inverse_depth_is_1_at_the_nearest_and_0_at_the_farthest_of_all_frames(self):
        near = self.maps.inverse_depth(TOKENS, TOKENS)
        self.assertEqual(near.shape, (FRAMES, TOKENS, TOKENS))
        self.assertEqual([near[i].max() for i in (0, 2)], [1, 0])
        self.assertAlmostEqual(near[1].max(), (1 / 3 - 1 / 4) / (1 / 2 - 1 / 4), places=6)

    def test_background_is_what_no_object_touches(self):
        mask = self.maps.background(TOKENS, TOKENS)
        self.assertTrue((mask.sum((1, 2)) == TOKENS ** 2 - 16).all())
        self.assertEqual(mask[0, 2, 1], 0)

    def test_noise_moves_with_the_surface_and_stays_on_the_background(self):
        z = self.maps.initial_noise(4, TOKENS, TOKENS, seed=3)
        self.assertLess(np.abs(z[1, :, 2:6, 2:6] - z[0, :, 2:6, 1:5]).max(), 1e-5)
        self.assertTrue((z[1, :, 0] == z[0, :, 0]).all())
        self.assertTrue((z == self.maps.initial_noise(4, TOKENS, TOKENS, seed=3)).all())
        self.assertFalse((z == self.maps.initial_noise(4, TOKENS, TOKENS, seed=4)).any())
        self.assertTrue((self.maps.initial_noise(4, TOKENS, TOKENS, seed=3, frames=[2])[0] == z[2]).all())

    def test_tokens_of_the_surface_match_across_frames(self):
        tokens, is_shown = self.maps.correspondence(TOKENS, TOKENS).matches(0, 2)
        inside = np.zeros((TOKENS, TOKENS), bool)
        inside[2:6, 1:5] = True
        self.assertTrue((is_shown.reshape(TOKENS, TOKENS).astype(bool) == inside).all())
        self.assertTrue((tokens[inside.ravel()] == np.flatnonzero(inside) + 2).all())

    def test_padded_rows_sum_matched_tokens_of_keyframes_with_weights_that_leave_1_in_all(self):
        index, weights, own = self.maps.correspondence(TOKENS, TOKENS).padded_rows([2, 0], [0, 1], alpha=0.6)
        self.assertEqual((index.shape, own.shape), ((2, TOKENS ** 2, 2), (2, TOKENS ** 2)))
        self.assertEqual((index.dtype, weights.dtype, own.dtype), (np.int32, np.float32, np.float32))
        np.testing.assert_allclose(weights.sum(-1) + own, 1, atol=1e-6)
        token = 2 * TOKENS + 1  # the square's first in frame 0: two further to the right in keyframe 2, the first of the two
        self.assertEqual(list(index[0, token]), [token + 2, TOKENS ** 2 + token])
        self.assertAlmostEqual(own[0, token], 0.4, places=6)
        self.assertEqual((own[0, 0], weights[0, 0].sum()), (1, 0))

    def test_keys_of_one_point_count_together_for_one(self):
        counts = self.maps.correspondence(TOKENS, TOKENS).point_counts([2, 0], [0])
        inside = np.zeros((TOKENS, TOKENS), bool)
        inside[2:6, 1:5] = True
        in_second = np.roll(inside, 2, 1)
        expected = np.where([inside, in_second, inside], np.float32(1) / np.float32(3), np.float32(1)).reshape(1, -1)
        self.assertTrue((counts == expected).all())
        among = self.maps.correspondence(TOKENS, TOKENS).point_counts([2, 0])
        expected = np.where([in_second, inside], np.float32(0.5), np.float32(1)).reshape(-1)
        self.assertTrue((among == [expected, expected]).all())

    def test_rows_may_be_as_wide_as_a_graph_needs(self):
        rows = self.maps.correspondence(TOKENS, TOKENS).padded_rows([1], [0], width=5)
        self.assertEqual(rows[0].shape, (1, TOKENS ** 2, 5))
        self.assertEqual(rows[1][..., 1:].max(), 0)

    def test_a_frame_that_shows_nothing_keeps_its_own_features(self):
        nothing = genrender.Maps(self.maps.uv, self.maps.object, np.zeros_like(self.maps.coverage))
        index, weights, own = nothing.correspondence(TOKENS, TOKENS).padded_rows([1], [0, 2])
        self.assertEqual((index.shape, weights.shape), ((2, TOKENS ** 2, 0), (2, TOKENS ** 2, 0)))
        self.assertTrue((own == 1).all())

    def test_a_consensus_is_the_mean_along_the_surface_and_of_the_background_at_its_place(self):
        x0 = np.random.default_rng(2).standard_normal((FRAMES, 2, TOKENS, TOKENS)).astype(np.float32)
        before, square = x0.copy(), [(slice(None), slice(2, 6), slice(1 + i, 5 + i)) for i in range(FRAMES)]
        consensus = genrender.Consensus(self.maps.correspondence(TOKENS, TOKENS), 10, most_gain=1)
        self.assertEqual(consensus.reach(x0, 7), [])  # beyond the window
        np.testing.assert_allclose(x0, before, atol=1e-5)
        self.assertEqual(consensus.reach(x0, 6), [16] * FRAMES)
        for i in range(FRAMES):
            np.testing.assert_allclose(x0[i][square[i]], np.mean([before[k][square[k]] for k in range(FRAMES)], 0), atol=1e-5)
            x0[i][square[i]] = before[i][square[i]]
        np.testing.assert_allclose(x0, before, atol=1e-5)  # no two frames show open background at one place
        nothing = genrender.Maps(self.maps.uv, self.maps.object, np.zeros_like(self.maps.coverage))
        of_background = genrender.Consensus(nothing.correspondence(TOKENS, TOKENS), 10, seed=5)
        self.assertEqual(of_background.reach(x0, 9), [])
        np.testing.assert_allclose(x0, np.broadcast_to(before.mean(0), x0.shape), atol=1e-5)

    def test_a_consensus_draws_its_sources_by_the_seed_and_moves_by_its_strength(self):
        before = np.random.default_rng(3).standard_normal((FRAMES, 2, TOKENS, TOKENS)).astype(np.float32)

        def reached(**settings):
            x0 = before.copy()
            genrender.Consensus(self.maps.correspondence(TOKENS, TOKENS), 4, sources=1, **settings).reach(x0, 0)
            return x0

        draws = [reached(seed=seed) for seed in range(6)]
        self.assertTrue((draws[1] == reached(seed=1)).all())
        self.assertTrue(any((draws[0] != other).any() for other in draws))
        np.testing.assert_allclose(reached(strength=0.25), 0.75 * before + 0.25 * draws[0], atol=1e-5)

    def test_rest_positions_name_points_as_uv_do(self):
        uv, coverage = self.maps.uv, self.maps.coverage
        position = np.concatenate([uv, np.zeros_like(uv[..., :1])], -1)
        maps = genrender.Maps(uv, self.maps.object, coverage, position=position)
        found = maps.correspondence(TOKENS, TOKENS, canonical="position").matches(0, 1)
        expected = self.maps.correspondence(TOKENS, TOKENS).matches(0, 1)
        self.assertTrue(all((a == b).all() for a, b in zip(found, expected)))

    def test_what_does_not_fit_is_refused_in_a_sentence(self):
        uv, object_, coverage = self.maps.uv, self.maps.object, self.maps.coverage
        for wrong, expected in (
                (lambda: genrender.Maps(uv[:2], object_, coverage), "Maps: uv is .2, 32, 32, 2., expected .3, 32, 32, 2."),
                (lambda: genrender.Maps(uv, object_, coverage).inverse_depth(8, 8), "depth is not given"),
                (lambda: self.maps.correspondence(7, 8), "grid is .7, 8., expected extents that divide"),
                (lambda: self.maps.correspondence(8, 8, canonical="position"), "position is not given"),
                (lambda: self.maps.correspondence(8, 8, kind="pixels"), "kind is pixels, expected one of footprint, texels"),
                (lambda: self.maps.correspondence(8, 8).matches(0, 3), "expected"),
                (lambda: self.maps.initial_noise(4, 8, 8, frames=[3]), "frames is 3, expected frames of the UV maps"),
                (lambda: self.maps.correspondence(8, 8).padded_rows([], [0]), "keyframes is empty"),
                (lambda: self.maps.correspondence(8, 8).padded_rows([0], [0], math.nan), "alpha is nan"),
                (lambda: self.maps.correspondence(8, 8).padded_rows([0, 1], [0], width=1), "entries, expected at most the width 1"),
                (lambda: genrender.draw_keyframes(4, 3, 0), "count is 4, expected 1 to the animation's 3 frames"),
                (lambda: genrender.Consensus(self.maps.correspondence(8, 8), 0), "steps is 0, expected at least one step"),
                (lambda: genrender.Consensus(self.maps.correspondence(8, 8), 3, window_end=2), "window_end is 2"),
                (lambda: genrender.Consensus(self.maps.correspondence(8, 8), 3).reach(np.zeros((2, 4, 8, 8), np.float32), 0),
                 "Consensus.reach: x0 is .2, 4, 8, 8., expected .3, 4, 8, 8."),
                (lambda: genrender.Consensus(self.maps.correspondence(8, 8), 3).reach(np.zeros((3, 4, 8, 8), np.float32), 3),
                 "step is 3, expected a step of the run"),
                (lambda: genrender.sample("ddim", lambda z, sigma, step: z, 1.0, [1, 0]), "sampler is ddim"),
                (lambda: genrender.scalings("noise", 1.0), "prediction is noise")):
            with self.assertRaisesRegex(ValueError, expected):
                wrong()
        with self.assertRaises(genrender.FileError):
            genrender.load_exr("/no/such/folder")


class SamplingTest(unittest.TestCase):
    def test_the_schedule_is_that_of_karras(self):
        found = genrender.karras_schedule(5, 0.1, 10.0, 7.0)
        ramp = np.linspace(10 ** (1 / 7), 0.1 ** (1 / 7), 5) ** 7
        np.testing.assert_allclose(found, [*ramp, 0], rtol=1e-12)

    def test_the_noise_schedule_is_that_of_its_betas(self):
        schedule = genrender.NoiseSchedule.scaled_linear(0.00085, 0.012, 1000)
        alpha = np.cumprod(1 - np.linspace(0.00085 ** 0.5, 0.012 ** 0.5, 1000) ** 2)
        levels = np.sqrt((1 - alpha) / alpha)
        self.assertAlmostEqual(schedule.sigma_max, levels[-1], places=9)
        self.assertAlmostEqual(schedule.t_of(levels[123]), 123, places=6)
        other = genrender.NoiseSchedule(alpha.tolist())
        self.assertAlmostEqual(schedule.sigma_of(12.5), other.sigma_of(12.5), places=9)

    def test_keyframes_differ_by_step_and_not_by_call(self):
        draws = [tuple(genrender.draw_keyframes(3, 9, step, seed=1)) for step in range(6)]
        self.assertEqual(draws[2], tuple(genrender.draw_keyframes(3, 9, 2, seed=1)))
        self.assertGreater(len(set(draws)), 3)
        self.assertTrue(all(len(set(draw)) == 3 and max(draw) < 9 for draw in draws))

    def test_samplers_move_arrays_by_their_own_operators(self):
        rng = np.random.default_rng(0)
        z, clean = rng.standard_normal((2, 3)).astype(np.float32), rng.standard_normal((2, 3)).astype(np.float32)
        sigmas = [4.0, 1.0, 0.25, 0.0]
        for sampler in ("euler", "heun", "dpmpp_2m"):
            seen = []
            out = genrender.sample(sampler, lambda z, sigma, step: clean, z, sigmas, lambda step, z: seen.append(step))
            np.testing.assert_allclose(out, clean, atol=1e-6)
            self.assertEqual((out.dtype, seen), (np.float32, [0, 1, 2]))
        asked = []

        def half(z, sigma, step):
            asked.append((sigma, step))
            return 0.5 * z

        expected = z
        for a, b in zip(sigmas, sigmas[1:]):
            expected = expected + (b - a) * (expected - 0.5 * expected) / a
        np.testing.assert_allclose(genrender.sample("euler", half, z, sigmas), expected, rtol=1e-5)
        self.assertEqual(asked, [(4, 0), (1, 1), (0.25, 2)])

    def test_an_exception_of_the_denoiser_comes_through(self):
        def fails(z, sigma, step):
            raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            genrender.sample("euler", fails, np.zeros(2, np.float32), [1.0, 0.0])

    def test_scalings_invert_the_mixture(self):
        x0, n, sigma = 0.3, -1.2, 2.5
        z, a = x0 + sigma * n, 1 / math.hypot(1, sigma)
        for prediction, F in (("epsilon", n), ("v_prediction", a * n - a * sigma * x0), ("sample", x0)):
            c_skip, c_out, c_in = genrender.scalings(prediction, sigma)
            self.assertAlmostEqual(c_skip * z + c_out * F, x0, places=12)
            self.assertAlmostEqual(c_in, a, places=12)

    def test_normalisation_gives_backgrounds_the_mean_of_the_first_in_place(self):
        rng = np.random.default_rng(1)
        z = rng.standard_normal((3, 4, 5, 6)).astype(np.float32) + np.arange(3, dtype=np.float32)[:, None, None, None]
        background = np.zeros((3, 5, 6), np.uint8)
        background[:2, :3] = 1
        before = z.copy()
        self.assertEqual(genrender.normalize_latents(z, background), [2])
        mean = [z[i][:, background[i] != 0].mean(1) for i in range(2)]
        np.testing.assert_allclose(mean[1], mean[0], atol=1e-5)
        self.assertTrue((z[[0, 2]] == before[[0, 2]]).all())
        for refused in (before.astype(np.float64), before.transpose(0, 1, 3, 2)):
            with self.assertRaises(TypeError):  # what would be changed is a copy
                genrender.normalize_latents(refused, background)


@unittest.skipIf(importlib.util.find_spec("torch") is None, "this Python lacks torch")
class TensorTest(unittest.TestCase):
    def setUp(self):
        import torch
        self.torch = torch

    def test_tensors_are_taken_by_dlpack_and_samplers_keep_them(self):
        z = self.torch.randn(2, 4, 3, 3, generator=self.torch.Generator().manual_seed(0))
        z[1] += 5
        genrender.normalize_latents(z, self.torch.ones(2, 3, 3, dtype=self.torch.uint8))
        self.assertLess((z[1].mean((1, 2)) - z[0].mean((1, 2))).abs().max(), 1e-5)
        out = genrender.sample("heun", lambda z, sigma, step: z / 2, z, [2.0, 1.0, 0.0])
        self.assertIsInstance(out, self.torch.Tensor)

    def test_mixing_by_padded_rows_is_eq_6_written_plainly(self):
        from genrender.blending import Blending, mix
        torch, alpha, keyframes, frames = self.torch, 0.7, [2, 0], [1, 2]
        maps = moving_square()
        blending = Blending(maps, (2 * TOKENS, 2 * TOKENS))
        F_hat, F_KF = torch.randn(2, 2, TOKENS ** 2, 5), torch.randn(2, 2 * TOKENS ** 2, 5)
        found = mix(F_hat, F_KF, blending.rows(TOKENS ** 2, keyframes, frames, alpha, "cpu"))
        expected = F_hat.clone()
        correspondence = maps.correspondence(TOKENS, TOKENS)
        for k, i in enumerate(frames):
            index, weights, _ = correspondence.padded_rows(keyframes, [i], 1.0)
            matched = [correspondence.matches(i, keyframe) for keyframe in keyframes]
            for token in range(TOKENS ** 2):
                seen = [n * TOKENS ** 2 + tokens[token] for n, (tokens, is_shown) in enumerate(matched) if is_shown[token]]
                self.assertEqual([int(e) for e in index[0, token, :len(seen)]], seen)
                if seen:
                    F_bar = sum(float(weights[0, token, e]) * F_KF[:, source] for e, source in enumerate(seen))
                    expected[:, k, token] = alpha * F_bar + (1 - alpha) * F_hat[:, k, token]
        self.assertLess((found - expected).abs().max(), 1e-5)
        self.assertGreater((found - F_hat).abs().max(), 0.1)
        with self.assertRaisesRegex(ValueError, "60 tokens, expected the latents'"):
            blending.rows(60, keyframes, frames, alpha, "cpu")


if __name__ == "__main__":
    unittest.main(verbosity=2)
