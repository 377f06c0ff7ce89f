# SPDX-License-Identifier: MIT
"""Times PyTorch eager on the networks of benchmarks/reference/reference_network.bench.cpp.

Needs PyTorch and diffusers, and the weights that the benchmark left in the folder GENRENDER_NETWORK_FOLDER: both run
the same.
"""

import os
import pathlib
import sys

import torch
from diffusers import ControlNetModel, UNet2DConditionModel

from support.peer_times import peer_times, pytorch_name

KERNELS = ["reference_network_miniature", "reference_network_mid"]

CASES = {  # block_out_channels[0], tokens of the prompt, [latents, frames, threads]
    "reference_network_miniature": ("48", 77, [(32, 1, 1), (64, 1, 1), (32, 8, 1), (32, 1, 2), (64, 1, 2), (32, 8, 2)]),
    "reference_network_mid": ("64", 77, [(32, 1, 1), (64, 1, 1), (32, 2, 1), (32, 1, 2), (64, 1, 2), (32, 2, 2)]),
}


def numbers(*shape):
    """The numbers of the benchmark; what they are does not matter for the time."""
    count = int(torch.tensor(shape).prod())
    return ((torch.arange(count) * 7919 % 1009).float() / 504 - 1).reshape(shape)


@torch.inference_mode()
def main():
    times = peer_times(__doc__, KERNELS)
    if "GENRENDER_NETWORK_FOLDER" not in os.environ:
        sys.exit("set GENRENDER_NETWORK_FOLDER to where the benchmark left its weights")
    networks = pathlib.Path(os.environ["GENRENDER_NETWORK_FOLDER"])

    for function, (folder, tokens, cases) in CASES.items():
        wanted = [(f"{function}/latents:{latents}/frames:{frames}/threads:{threads}", latents, frames, threads)
                  for latents, frames, threads in cases]
        wanted = [case for case in wanted if times.wants(case[0])]
        if not wanted:
            continue
        unet = UNet2DConditionModel.from_pretrained(networks / folder, subfolder="unet").eval()
        control = ControlNetModel.from_pretrained(networks / folder, subfolder="controlnet").eval()
        scale = 2 ** (len(control.config.conditioning_embedding_out_channels) - 1)
        for name, latents, frames, threads in wanted:
            torch.set_num_threads(threads)
            z = numbers(frames, unet.config.in_channels, latents, latents)
            hint = numbers(frames, control.config.conditioning_channels, scale * latents, scale * latents)
            prompt = numbers(1, tokens, unet.config.cross_attention_dim).expand(frames, -1, -1)

            def forward():
                down, middle = control(z, 417, prompt, hint, return_dict=False)
                return unet(z, 417, prompt, down_block_additional_residuals=down, mid_block_additional_residual=middle)

            # The profile warms up.
            times.add(name, pytorch_name(forward), forward, warm_ups=0)
    times.print()


if __name__ == "__main__":
    main()
