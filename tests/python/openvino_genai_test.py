# SPDX-License-Identifier: MIT
"""UV noise inside OpenVINO GenAI's own Text2ImagePipeline: openvino_genai_test.py PAGE FOLDER. Finds the package by PYTHONPATH;
exit code 77 where something is missing. Runs the blocks of Python of the page's section on GenAI, too.
"""

import importlib.util
import os
import pathlib
import re
import shutil
import sys
import unittest

missing = [name for name in ("genrender", "openvino_genai", "PIL") if importlib.util.find_spec(name) is None]
if missing:
    print("skipped: the Python", sys.executable, "lacks", ", ".join(missing))
    sys.exit(77)

import genrender
import numpy as np
import openvino
import openvino_genai
from genrender.openvino_genai import UVNoise
from tiny_genai_pipeline import write_genai_pipeline

PAGE, FOLDER = (pathlib.Path(path).resolve() for path in sys.argv[1:3])
FRAMES, SIDE, SEED = 3, 64, 7


def moving_square():
    """Maps of a square that moves 8 pixels, a cell of the latents, to the right in each frame."""
    uv, coverage = np.zeros((FRAMES, SIDE, SIDE, 2), np.float32), np.zeros((FRAMES, SIDE, SIDE), np.uint8)
    along = (np.arange(32, dtype=np.float32) + 0.5) / 32
    for i in range(FRAMES):
        shown = slice(16, 48), slice(8 + 8 * i, 40 + 8 * i)
        uv[i][shown], coverage[i][shown] = np.stack(np.meshgrid(along, along), -1), 1
    return genrender.Maps(uv, np.zeros(coverage.shape, np.uint32), coverage)


class Asked(UVNoise):
    """What the pipeline asked, and what it was given."""

    def __init__(self, *of):
        super().__init__(*of)
        self.given = []

    def randn_tensor(self, shape):
        self.given.append(super().randn_tensor(shape).data.copy())
        return openvino.Tensor(self.given[-1])


class UVNoiseTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(FOLDER, ignore_errors=True)
        write_genai_pipeline(FOLDER / "stable-diffusion-v1-5-ov")
        cls.pipe = openvino_genai.Text2ImagePipeline(FOLDER / "stable-diffusion-v1-5-ov", "CPU")
        cls.maps = moving_square()
        cls.noise = cls.maps.initial_noise(4, 8, 8, seed=SEED)

    def generate(self, generator, side=SIDE, pipe=None):
        return (pipe or self.pipe).generate(
            "a knight", height=side, width=side, num_inference_steps=2, guidance_scale=5.0, generator=generator,
            num_images_per_prompt=len(generator.frames)).data

    def test_a_pipeline_is_given_the_initial_noise_of_the_frame_and_asks_for_nothing_else(self):
        for i in range(FRAMES):
            generator = Asked(self.maps, [i], SEED)
            self.generate(generator)
            self.assertEqual([z.dtype for z in generator.given], [np.float32])
            self.assertTrue(np.array_equal(generator.given[0], self.noise[[i]]))

    def test_pictures_are_made_of_it(self):
        frames = [2, 0, 1]
        pictures = self.generate(UVNoise(self.maps, frames, SEED)).astype(int)
        self.assertEqual(pictures.shape, (FRAMES, SIDE, SIDE, 3))
        # This UNet leaves z as it is, so pictures move as the noise does.
        by_frame = [pictures[frames.index(i)] for i in range(FRAMES)]
        for i in (1, 2):
            self.assertLessEqual(np.abs(by_frame[i][16:48, 8 + 8 * i:40 + 8 * i] - by_frame[0][16:48, 8:40]).max(), 1)
        self.assertGreater(by_frame[0].std(), 10)

    def test_what_is_asked_for_later_is_white_and_of_the_seed_and_the_frame(self):
        pipe = openvino_genai.Text2ImagePipeline(FOLDER / "stable-diffusion-v1-5-ov", "CPU")
        pipe.set_scheduler(openvino_genai.Scheduler.from_config(
            FOLDER / "stable-diffusion-v1-5-ov" / "scheduler" / "scheduler_config.json",
            openvino_genai.Scheduler.Type.EULER_ANCESTRAL_DISCRETE))
        runs = [Asked(self.maps, [i], SEED) for i in (1, 1, 2)]
        for generator in runs:
            self.generate(generator, pipe=pipe)
            self.assertGreater(len(generator.given), 1)
            self.assertTrue(np.array_equal(generator.given[0], self.noise[generator.frames]))
        self.assertTrue(all(np.array_equal(a, b) for a, b in zip(runs[0].given, runs[1].given)))
        self.assertFalse(np.array_equal(runs[0].given[1], runs[2].given[1]))
        many = runs[0].randn_tensor(openvino.Shape([3, 20000])).data
        self.assertLess(abs(many.mean()) + abs(many.std() - 1), 0.05)
        self.assertIsInstance(runs[0].next(), float)

    def test_what_does_not_fit_is_refused_in_a_sentence(self):
        for asked, expected in (
                (lambda: UVNoise(self.maps, []), "frames is .., expected one or more of the maps' 3"),
                (lambda: UVNoise(self.maps, [3]), "frames is .3., expected one or more of the maps' 3"),
                (lambda: UVNoise(self.maps, [0]).randn_tensor(openvino.Shape([1, 16, 32])),
                 "asks for noise of shape .1, 16, 32., expected latents .1, channels, height, width. of frames .0."),
                (lambda: UVNoise(self.maps, [0, 1]).randn_tensor(openvino.Shape([1, 4, 8, 8])), "expected latents .2, channels"),
                (lambda: self.generate(UVNoise(self.maps, [0]), side=72), "expected extents that divide")):
            with self.subTest(expected), self.assertRaisesRegex(ValueError, expected):
                asked()

    def test_the_page_runs(self):
        section = re.search(r"^## OpenVINO GenAI\n(.*?)(?=^## |\Z)", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
        blocks = re.findall(r"^```python\n(.*?)^```$", section.group(1), re.DOTALL | re.MULTILINE)
        self.assertEqual(len(blocks), 1)
        before = os.getcwd()
        os.chdir(FOLDER)
        try:
            names = {"maps": self.maps}
            exec(compile(blocks[0], PAGE.name, "exec"), names)
        finally:
            os.chdir(before)
        self.assertTrue(all((FOLDER / f"{i:04}.png").exists() for i in range(FRAMES)))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
