# SPDX-License-Identifier: MIT
"""diffusers behind genrender: its UNet and ControlNet with the weights of the reference denoiser."""

from types import SimpleNamespace

import torch
from case import Case
from diffusers import ControlNetModel, EulerDiscreteScheduler, UNet2DConditionModel
from genrender.diffusers import render

torch.set_num_threads(1)
case = Case()
settings = case.settings
empty, prompt = (torch.from_numpy(tokens)[None] for tokens in case.prompts)
# What `render` asks of a StableDiffusionControlNetPipeline: this folder has prompts of its own and no decoder.
pipe = SimpleNamespace(
    unet=UNet2DConditionModel.from_pretrained(case.weights / "unet"),
    controlnet=ControlNetModel.from_pretrained(case.weights / "controlnet"),
    scheduler=EulerDiscreteScheduler.from_pretrained(case.weights / "scheduler"),
    vae_scale_factor=2, _execution_device=torch.device("cpu"), encode_prompt=lambda *_, **__: (prompt, empty))
for network in (pipe.unet, pipe.controlnet):
    network.forward = case.timed(network.forward)
case.finish(lambda: render(
    pipe, case.maps, "red stripes", height=settings["size"], width=settings["size"], hint=torch.from_numpy(case.hint),
    **{name: settings[name] for name in ("steps", "seed", "keyframes", "frames_per_call", "guidance_scale")}).numpy())
