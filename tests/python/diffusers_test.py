# SPDX-License-Identifier: MIT
"""Latents of diffusers' pipeline with our processors against those of the C++ program, over whole runs:
diffusers_test.py PROGRAM MAPS_PROGRAM FOLDER. Finds the package by PYTHONPATH; exit code 77 where something is missing.
"""

import importlib.util
import pathlib
import shutil
import subprocess
import sys
import time
import unittest
import warnings

missing = [name for name in ("genrender", "torch", "diffusers", "transformers") if importlib.util.find_spec(name) is None]
if missing:
    print("skipped: the Python", sys.executable, "lacks", ", ".join(missing))
    sys.exit(77)

warnings.filterwarnings("ignore")
import diffusers
import genrender
import numpy as np
import torch
import transformers
from genrender.diffusers import SelfAttention, pictures, render
from PIL import Image
from two_resolution_pipeline import write_pipeline

transformers.logging.set_verbosity_error()
transformers.logging.disable_progress_bar()
diffusers.logging.set_verbosity_error()
diffusers.logging.disable_progress_bar()
torch.backends.cudnn.allow_tf32 = False
torch.set_num_threads(1)  # tensors are small, and threads that wait for each other take longer than one
PROGRAM, MAPS_PROGRAM = (str(pathlib.Path(path).resolve()) for path in sys.argv[1:3])
FOLDER = pathlib.Path(sys.argv[3]).resolve()
PROMPT, SIZE, FRAMES, SEED, BOUND = "a red and white ball on a green ground", 64, 5, 5, 1e-3

# What is rendered: options of the program, and the same of `render`.
RUNS = {
    "vivid": (["--preset", "vivid"], {"preset": "vivid"}),
    "vivid, Heun's method, 3 sources, half a window": (
        ["--preset", "vivid", "--sampler", "heun", "--consensus-sources", "3", "--consensus-window", "0", "0.5"],
        {"preset": "vivid", "sampler": "heun", "consensus": {"sources": 3, "window_end": 0.5}}),
    "vivid, means normalised": (
        ["--preset", "vivid", "--normalization", "means"], {"preset": "vivid", "normalization": "mean"}),
    "ours": ([], {}),
    "frame by frame": (["--method", "per_frame"], {"keyframes": 0, "noise": "independent", "normalization": "none"}),
    "frame by frame, with a consensus": (
        ["--method", "per_frame", "--consensus"],
        {"keyframes": 0, "noise": "independent", "normalization": "none", "consensus": True}),
    "half of alpha at the latents' grid": (["--latents-grid-alpha", "0.5"], {"latents_grid_alpha": 0.5}),
    "Heun's method, 2 keyframes": (["--sampler", "heun", "--keyframes", "2"], {"sampler": "heun", "keyframes": 2}),
    "DPM++ 2M, 3 frames a call": (["--sampler", "dpmpp_2m"], {"sampler": "dpmpp_2m", "frames_per_call": 3}),
    "without pre-attention": (["--no-pre"], {"pre_attention": False}),
    "without post-attention": (["--no-post"], {"post_attention": False}),
    "alpha .3, plain average": (["--alpha", "0.3", "--average", "plain"], {"alpha": lambda step, name: 0.3, "average": "plain"}),
    "without normalisation, fixed noise": (["--no-adain", "--noise", "fixed"], {"normalization": "none", "noise": "fixed"}),
    "deviations normalised": (["--adain-deviations"], {"normalization": "mean_and_deviation"}),
    "no guidance": (["--guidance", "1"], {"guidance_scale": 1}),
    "negative prompt, half a ControlNet": (
        ["--negative-prompt", "grey", "--conditioning", "0.5"], {"negative_prompt": "grey", "conditioning_scale": 0.5}),
    "clip skip": (["--clip-skip", "1"], {"clip_skip": 1}),
    "points counted, temperature": (
        ["--count-points", "--temperature", "4"], {"counts_points": True, "length_correction": 4}),
    "points counted, vivid, 2 frames a call": (
        ["--preset", "vivid", "--count-points"], {"preset": "vivid", "counts_points": True, "frames_per_call": 2}),
    "total variance kept": (["--variance", "total"], {"variance": "total"}),
    "variance of sources kept, alpha .4, 3 frames a call": (
        ["--variance", "sources", "--alpha", "0.4"], {"variance": "sources", "alpha": 0.4, "frames_per_call": 3}),
    "length-corrected temperature to the power of 4": (["--temperature", "4"], {"length_correction": 4}),
}


def pipeline_of(folder, device="cpu", dtype=torch.float32):
    pipe = diffusers.StableDiffusionControlNetPipeline.from_pretrained(folder, dtype=dtype, safety_checker=None)
    return pipe.to(device)


def rendered_by_program(folder, name, options):
    """Latents of the program and its seconds."""
    out = FOLDER / "program" / name.replace(" ", "_").replace("'", "")
    begin = time.perf_counter()
    subprocess.run([PROGRAM, "--maps", FOLDER / "maps", "--pipeline", folder, "--prompt", PROMPT, "--size", str(SIZE), "--steps",
                    "4", "--seed", str(SEED), "--out", out, "--latents", "--quiet",
                    *([] if {"--method", "--preset"} & set(options) else ["--preset", "plain"]),
                    *([] if "--guidance" in options else ["--guidance", "5"]), *options], check=True, stdout=subprocess.DEVNULL)
    return np.load(out / "latents.npy"), time.perf_counter() - begin, out


def rendered_by_diffusers(pipe, **settings):
    """The same of our `render`."""
    begin = time.perf_counter()
    z = render(pipe, genrender.load_exr(str(FOLDER / "maps")), PROMPT, height=SIZE, width=SIZE, steps=4, seed=SEED,
               **{"preset": "plain", "guidance_scale": 5, **settings})
    return z.cpu().numpy(), time.perf_counter() - begin, z


def setUpModule():
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name, prediction_type in (("epsilon", "epsilon"), ("velocity", "v_prediction")):
        shutil.rmtree(FOLDER / name, ignore_errors=True)
        write_pipeline(FOLDER / name, prediction_type)
    subprocess.run([MAPS_PROGRAM, "walking_figure", FOLDER / "maps", str(FRAMES), "128"], check=True, stdout=subprocess.DEVNULL)


class LatentsTest(unittest.TestCase):
    def compare(self, title, a, b):
        """The greatest difference as a share of the range, printed."""
        self.assertEqual(a.shape, b.shape)
        span = float(a.max() - a.min())
        share = float(np.abs(a - b).max()) / span
        print(f"{title:60} {share:9.1e} of a range of {span:6.1f}")
        return share

    def check_all(self, device):
        pipe, earlier = pipeline_of(FOLDER / "epsilon", device), {}
        render(pipe, genrender.load_exr(str(FOLDER / "maps")), PROMPT, height=SIZE, width=SIZE, steps=1)  # warm
        print()
        for name, (options, settings) in RUNS.items():
            if "clip_skip" in settings and not hasattr(pipe.text_encoder, "text_model"):
                print(f"{name:60} skipped: this diffusers cannot, with this transformers")
                continue
            expected, of_program, _ = rendered_by_program(FOLDER / "epsilon", name, options)
            found, of_diffusers, _ = rendered_by_diffusers(pipe, **settings)
            with self.subTest(name):
                self.assertEqual(expected.shape, (FRAMES, 4, SIZE // 4, SIZE // 4))
                share = self.compare(f"{name} ({of_program:.2f} s, diffusers {of_diffusers:.2f} s)", expected, found)
                self.assertLessEqual(share, BOUND)
                for other, latents in earlier.items():  # that the bound says something
                    self.assertGreater(np.abs(latents - expected).max(), 10 * BOUND * (expected.max() - expected.min()), other)
                earlier[name] = expected

    def test_on_the_processor_they_are_those_of_the_program(self):
        self.check_all("cpu")

    @unittest.skipUnless(torch.cuda.is_available(), "skipped: no CUDA device")
    def test_on_a_cuda_device_they_are_those_of_the_program(self):
        self.check_all("cuda")

    def test_a_network_that_predicts_velocity_is_told_from_the_scheduler(self):
        expected, _, _ = rendered_by_program(FOLDER / "velocity", "velocity", [])
        found, _, _ = rendered_by_diffusers(pipeline_of(FOLDER / "velocity"))
        self.assertLessEqual(self.compare("velocity", expected, found), BOUND)

    def test_pictures_are_those_of_the_program(self):
        pipe = pipeline_of(FOLDER / "epsilon")
        _, _, out = rendered_by_program(FOLDER / "epsilon", "pictures", [])
        made = pictures(pipe, rendered_by_diffusers(pipe)[2])
        self.assertEqual(len(made), FRAMES)
        for i, picture in enumerate(made):
            expected = np.asarray(Image.open(out / "frames" / f"{i:04}.png").convert("RGB"), int)
            self.assertLessEqual(np.abs(expected - np.asarray(picture, int)).max(), 1)

    def test_every_frame_of_a_call_is_what_it_is_alone(self):
        pipe = pipeline_of(FOLDER / "epsilon")
        alone, together = (rendered_by_diffusers(pipe, frames_per_call=n)[0] for n in (1, FRAMES))
        self.assertLessEqual(self.compare("all frames in one call", alone, together), 1e-5)

    def test_weights_of_16_bits_are_computed_with(self):
        whole = rendered_by_diffusers(pipeline_of(FOLDER / "epsilon"))[0]
        half = rendered_by_diffusers(pipeline_of(FOLDER / "epsilon", dtype=torch.bfloat16))
        self.assertEqual(half[2].dtype, torch.float32)
        self.assertLessEqual(self.compare("bfloat16", whole, half[0]), 0.1)


class PipelineTest(unittest.TestCase):
    def setUp(self):
        self.pipe = pipeline_of(FOLDER / "epsilon")
        self.maps = genrender.load_exr(str(FOLDER / "maps"))

    def test_the_decoder_alone_is_changed_and_only_while_it_renders(self):
        before, during, steps = dict(self.pipe.unet.attn_processors), [], []

        def observe(step, z):
            during.append([name for name, one in self.pipe.unet.attn_processors.items() if isinstance(one, SelfAttention)])
            steps.append(step)
            if step == 1:
                raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt):
            render(self.pipe, self.maps, PROMPT, height=SIZE, width=SIZE, steps=3, observer=observe, sampler="heun")
        self.assertEqual(self.pipe.unet.attn_processors, before)
        self.assertEqual(steps, [0, 1])  # once a step, whatever the sampler asks
        self.assertEqual(len(during[0]), 4)
        self.assertTrue(all(name.startswith("up_blocks.") and ".attn1." in name for name in during[0]))

    def test_self_attention_is_at_two_resolutions(self):
        tokens = set()

        class Watched(SelfAttention):
            def __call__(self, attn, hidden_states, *rest, **named):
                tokens.add(hidden_states.shape[1])
                return super().__call__(attn, hidden_states, *rest, **named)

        import genrender.diffusers as module
        original, module.SelfAttention = module.SelfAttention, Watched
        try:
            render(self.pipe, self.maps, PROMPT, height=SIZE, width=SIZE, steps=1)
        finally:
            module.SelfAttention = original
        self.assertEqual(tokens, {8 * 8, 16 * 16})

    def test_what_does_not_fit_is_refused_in_a_sentence(self):
        for settings, expected in (({"height": 66}, "height and width are 66 and 64, expected multiples of 4"),
                                   ({"height": 48}, "expected extents that divide the maps"),
                                   ({"keyframes": 9}, "count is 9, expected 1 to the animation's 5 frames"),
                                   ({"keyframes": -1}, "keyframes is -1, expected at least 0"),
                                   ({"frames_per_call": 0}, "frames_per_call is 0, expected at least 1"),
                                   ({"length_correction": -1}, "length_correction is -1, expected a finite number, 0 or more"),
                                   ({"variance": "half"}, "variance is half, expected one of none, total, sources"),
                                   ({"sampler": "ddim"}, "sampler is ddim"),
                                   ({"preset": "paper"}, "preset is paper, expected one of vivid, plain"),
                                   ({"latents_grid_alpha": 2}, "latents_grid_alpha is 2, expected a share in .0, 1."),
                                   ({"consensus": {"sources": 0}}, "sources.count is 0, expected at least one frame"),
                                   ({"normalization": "median"}, "statistics is median")):
            with self.subTest(expected), self.assertRaisesRegex(ValueError, expected):
                render(self.pipe, self.maps, PROMPT, **{"height": SIZE, "width": SIZE, "steps": 1, **settings})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
