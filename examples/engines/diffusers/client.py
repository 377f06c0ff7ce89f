# SPDX-License-Identifier: MIT
"""diffusers behind genrender: its UNet and ControlNet with the weights of a folder."""

from types import SimpleNamespace

import torch
from case import Case
from diffusers import ControlNetModel, EulerDiscreteScheduler, UNet2DConditionModel
from genrender.diffusers import render

torch.set_num_threads(1)
case = Case()
settings = case.settings
empty, prompt = (torch.from_numpy(tokens)[None] for tokens in case.prompts)
# What `render` asks of a StableDiffusionControlNetPipeline, with prompts that are encoded already.
pipe = SimpleNamespace(
    unet=UNet2DConditionModel.from_pretrained(case.weights / "unet"),
    controlnet=ControlNetModel.from_pretrained(case.weights / "controlnet"),
    scheduler=EulerDiscreteScheduler.from_pretrained(case.weights / "scheduler"),
    vae_scale_factor=settings["height"] // settings["grid"][0], _execution_device=torch.device("cpu"),
    encode_prompt=lambda *_, **__: (prompt, empty))
for network in (pipe.unet, pipe.controlnet):
    network.forward = case.timed(network.forward)
names = ("height", "width", "steps", "seed", "keyframes", "frames_per_call", "guidance_scale", "length_correction")
case.finish(lambda: render(pipe, case.maps, "", hint=torch.from_numpy(case.hint), preset="plain",
                           **{name: settings[name] for name in names}).numpy())
