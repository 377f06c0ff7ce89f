# SPDX-License-Identifier: MIT
"""Stable Diffusion 1.5's architecture in full size against diffusers, with random weights: 860 + 361 million of them.

Needs Python 3.10 or later with PyTorch, diffusers 0.42.1 and safetensors, 8 GB of memory and 5 GB of disk:

    python3 tests/reference/full_size_parity.py FOLDER
    cmake --preset release
    cmake --build --preset release --target full_size_parity
    build/release/tests/full_size_parity FOLDER

The first command writes FOLDER in diffusers' layout, runs diffusers once on the CPU in single precision and writes what
went in and what came out to FOLDER/parity.safetensors. The last loads the folder and prints how far it is from that.
"""

import gc
import json
import pathlib
import sys
import time

import torch
from diffusers import ControlNetModel, UNet2DConditionModel
from safetensors.torch import save_file

folder = pathlib.Path(sys.argv[1])
torch.manual_seed(0)
z = torch.randn(1, 4, 64, 64)
prompt = torch.randn(1, 77, 768)
hint = torch.rand(1, 1, 512, 512).repeat(1, 3, 1, 1)
t, scale = 417.5, 0.75

with torch.no_grad():
    # All other defaults of diffusers are Stable Diffusion 1.5.
    control = ControlNetModel(cross_attention_dim=768).eval()
    for parameter in control.parameters():
        if not parameter.any():
            parameter.normal_(0, 0.05)  # 'zero convolutions' would add nothing
    control.save_pretrained(folder / "controlnet")
    begin = time.time()
    down, middle = control(z, t, prompt, hint, conditioning_scale=scale, return_dict=False)
    seconds = time.time() - begin
    del control
    gc.collect()

    unet = UNet2DConditionModel(cross_attention_dim=768, sample_size=64).eval()
    unet.save_pretrained(folder / "unet")
    alone = unet(z, t, prompt).sample
    begin = time.time()
    controlled = unet(
        z, t, prompt, down_block_additional_residuals=down, mid_block_additional_residual=middle).sample
    seconds += time.time() - begin

(folder / "scheduler").mkdir(exist_ok=True)
(folder / "scheduler" / "scheduler_config.json").write_text(json.dumps({
    "_class_name": "PNDMScheduler", "beta_start": 0.00085, "beta_end": 0.012, "beta_schedule": "scaled_linear",
    "num_train_timesteps": 1000, "prediction_type": "epsilon"}))
save_file({
    "z": z, "t": torch.tensor([t]), "scale": torch.tensor([scale]), "prompt": prompt[0], "hint": hint.contiguous(),
    "alone": alone.contiguous(), "controlled": controlled.contiguous()}, folder / "parity.safetensors")
change = (controlled - alone).abs().max() / (alone.max() - alone.min())
print(f"diffusers: {seconds:.1f} s with {torch.get_num_threads()} threads; the ControlNet moves the output by {change:.3f} of its range")
