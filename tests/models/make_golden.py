# SPDX-License-Identifier: MIT
"""Writes golden.hpp: what the public package diffusers computes in double precision for the network of the tests.

Needs Python 3.9 or later with PyTorch (any recent version, CPU only) and diffusers 0.21.4 or later:

    pip install torch diffusers
    python3 tests/models/make_golden.py

The tests compile the constants and never run Python. Weights and inputs are the numbers of `golden_values` in
unet.test.cpp: scrambled addresses, which need no random number generator on either side.
"""

import math
import pathlib

import diffusers
import torch
from diffusers.models.controlnet import ControlNetModel
from diffusers.models.unet_2d_condition import UNet2DConditionModel

MASK = (1 << 64) - 1


def values(name, count):
    """Numbers in [-1, 1): the scrambled sum of a hash of the name and the index."""
    begin = 0xCBF29CE484222325
    for byte in name.encode():
        begin = ((begin ^ byte) * 0x100000001B3) & MASK
    result = []
    for i in range(count):
        x = (begin + i * 0x9E3779B97F4A7C15) & MASK
        x = ((x ^ (x >> 30)) * 0xBF58476D1CE4E5B9) & MASK
        x = ((x ^ (x >> 27)) * 0x94D049BB133111EB) & MASK
        x ^= x >> 31
        result.append((x >> 40) * 2.0**-23 - 1)
    return result


def tensor(name, *shape):
    return torch.tensor(values(name, math.prod(shape)), dtype=torch.float64).reshape(shape)


def fill(model, prefix):
    for name, parameter in model.named_parameters():
        x = tensor(prefix + name, *parameter.shape)
        if parameter.dim() == 1:
            x = 0.25 * x + (1 if name.endswith("weight") else 0)
        else:
            # A power of two, so that the product is exact in float too.
            x = x * 2.0 ** math.floor(math.log2(math.sqrt(3 / parameter[0].numel())))
        parameter.copy_(x)


shape = dict(
    in_channels=4, block_out_channels=(8, 12, 16), layers_per_block=2, attention_head_dim=(2, 3, 4),
    cross_attention_dim=6, norm_num_groups=4,
    down_block_types=("CrossAttnDownBlock2D", "CrossAttnDownBlock2D", "DownBlock2D"))
unet = UNet2DConditionModel(
    out_channels=4, up_block_types=("UpBlock2D", "CrossAttnUpBlock2D", "CrossAttnUpBlock2D"), **shape).double().eval()
control = ControlNetModel(conditioning_embedding_out_channels=(4, 6), **shape).double().eval()

with torch.no_grad():
    fill(unet, "unet.")
    fill(control, "controlnet.")
    z, hint, prompt = tensor("z", 1, 4, 8, 12), tensor("hint", 1, 3, 16, 24), tensor("prompt", 1, 5, 6)
    alone = unet(z, 417.5, prompt).sample
    down, middle = control(z, 417.5, prompt, hint, conditioning_scale=0.75, return_dict=False)
    guided = unet(z, 417.5, prompt, down_block_additional_residuals=down, mid_block_additional_residual=middle).sample


def constants(name, comment, x):
    numbers = [repr(float(value)) for value in x.flatten()[::12]]
    lines = [", ".join(numbers[i:i + 5]) for i in range(0, len(numbers), 5)]
    return (f"/// {comment}\ninline constexpr std::array<double, {len(numbers)}> {name} = {{\n    "
            + ",\n    ".join(lines) + "};\n")


text = f"""// SPDX-License-Identifier: MIT
// What diffusers {diffusers.__version__} computes in double precision. Written by make_golden.py: change that, not this.
// clang-format off
#pragma once

#include <array>

namespace genrender::golden {{

{constants("unet_output", "Every twelfth element of UNet2DConditionModel's output [1, 4, 8, 12].", alone)}
{constants("controlled_output", "The same with what ControlNetModel adds, times 0.75.", guided)}
}} // namespace genrender::golden
"""
pathlib.Path(__file__).with_name("golden.hpp").write_text(text)
