# SPDX-License-Identifier: MIT
"""Times PyTorch eager on the networks of benchmarks/models/reference_network.bench.cpp.

Prints a list of {"name", "peer", "seconds", "cpu_seconds"}. Needs PyTorch and diffusers, and the weights that the
benchmark left in the folder GENRENDER_NETWORK_FOLDER: both run the same.
"""

import argparse
import json
import os
import pathlib
import re
import statistics
import time

import torch
from diffusers import ControlNetModel, UNet2DConditionModel

CASES = {  # block_out_channels[0], tokens of the prompt, [latents, frames, threads]
    "reference_network_tiny": ("32", 4, [(32, 1, 1), (64, 1, 1), (32, 8, 1), (32, 1, 2), (64, 1, 2), (32, 8, 2)]),
    "reference_network_mid": ("64", 77, [(32, 1, 1), (64, 1, 1), (32, 2, 1), (32, 1, 2), (64, 1, 2), (32, 2, 2)]),
}


def median_seconds(body, at_least):
    """Runs `body` once to warm up, then for `at_least` seconds and three times: on the wall, and of all cores."""
    body()
    walls, cpus = [], []
    while len(walls) < 3 or sum(walls) < at_least:
        wall, cpu = time.perf_counter(), time.process_time()
        body()
        walls.append(time.perf_counter() - wall)
        cpus.append(time.process_time() - cpu)
    return statistics.median(walls), statistics.median(cpus)


def numbers(*shape):
    """The numbers of the benchmark; what they are does not matter for the time."""
    count = int(torch.tensor(shape).prod())
    return ((torch.arange(count) * 7919 % 1009).float() / 504 - 1).reshape(shape)


@torch.inference_mode()
def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=pathlib.Path, default=os.environ.get("GENRENDER_NETWORK_FOLDER"))
    parser.add_argument("--seconds", type=float, default=0.5, help="least time of a case")
    parser.add_argument("--filter", default="", help="a regular expression, as that of Google Benchmark")
    arguments = parser.parse_args()
    if arguments.folder is None:
        parser.error("set GENRENDER_NETWORK_FOLDER to where the benchmark left its weights")

    results = []
    for function, (folder, tokens, cases) in CASES.items():
        unet = UNet2DConditionModel.from_pretrained(pathlib.Path(arguments.folder) / folder, subfolder="unet").eval()
        control = ControlNetModel.from_pretrained(pathlib.Path(arguments.folder) / folder, subfolder="controlnet").eval()
        scale = 2 ** (len(control.config.conditioning_embedding_out_channels) - 1)
        for latents, frames, threads in cases:
            name = f"{function}/latents:{latents}/frames:{frames}/threads:{threads}"
            if not re.search(arguments.filter, name):
                continue
            torch.set_num_threads(threads)
            z = numbers(frames, unet.config.in_channels, latents, latents)
            hint = numbers(frames, control.config.conditioning_channels, scale * latents, scale * latents)
            prompt = numbers(1, tokens, unet.config.cross_attention_dim).expand(frames, -1, -1)

            def forward():
                down, middle = control(z, 417, prompt, hint, return_dict=False)
                return unet(z, 417, prompt, down_block_additional_residuals=down, mid_block_additional_residual=middle)

            seconds, cpu_seconds = median_seconds(forward, arguments.seconds)
            peer = f"PyTorch {torch.__version__.split('+')[0]}"
            results.append({"name": name, "peer": peer, "seconds": seconds, "cpu_seconds": cpu_seconds})
    print(json.dumps(results, indent=2))


main()
