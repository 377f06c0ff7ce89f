# SPDX-License-Identifier: MIT
"""The run that a client in Python is given by client.cpp, and the result that it gives back: `case.py` reads FOLDER/case.*,
which client.cpp has written, and writes FOLDER/result.*, which it reads."""

import json
import pathlib
import sys
import time

import genrender
from safetensors.numpy import load_file, save_file


class Case:
    """`maps`, `hint` [frames, channels, height, width], `prompts` (the negative one, the prompt) [tokens, channels], `weights`,
    the folder of the networks, and `settings`: height, width, channels, grid, steps, keyframes, frames_per_call, seed,
    guidance_scale, length_correction, prediction, betas (the first, the last, their number)."""

    def __init__(self):
        self.folder, self.weights = map(pathlib.Path, sys.argv[1:3])
        self.settings = json.loads((self.folder / "case.json").read_text())
        tensors = load_file(self.folder / "case.safetensors")
        self.maps = genrender.Maps(tensors["uv"], tensors["object"].astype("uint32"), tensors["coverage"].astype("uint8"))
        self.hint, self.prompts = tensors["hint"], (tensors["empty_prompt"], tensors["prompt"])
        self.denoiser_seconds = 0

    def timed(self, call):
        """The same function, whose seconds are the denoiser's."""
        def run(*given, **named):
            begin = time.perf_counter()
            try:
                return call(*given, **named)
            finally:
                self.denoiser_seconds += time.perf_counter() - begin
        return run

    def finish(self, render):
        """Calls `render`, which gives latents as a NumPy array, and writes them and what it took."""
        begin, begin_of_processor = time.perf_counter(), time.process_time()
        z = render()
        seconds = {"processor": time.process_time() - begin_of_processor, "denoiser": self.denoiser_seconds,
                   "library": time.perf_counter() - begin - self.denoiser_seconds}
        save_file({"z": z}, self.folder / "result.safetensors")
        (self.folder / "result.json").write_text(json.dumps(seconds))
