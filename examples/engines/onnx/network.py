# SPDX-License-Identifier: MIT
"""A folder's UNet and ControlNet as ONNX graphs of fixed shapes, by diffusers' classes."""

import pathlib
import tempfile
import warnings

import onnx
import torch
from diffusers import ControlNetModel, UNet2DConditionModel
from genrender.add_feature_io import add_feature_io


class Network(torch.nn.Module):
    """Both networks as one: v of scaled latents, a time, prompts and hints."""

    def __init__(self, folder):
        super().__init__()
        self.unet = UNet2DConditionModel.from_pretrained(folder / "unet")
        self.controlnet = ControlNetModel.from_pretrained(folder / "controlnet")

    def forward(self, z, t, prompt, hint):
        down, middle = self.controlnet(z, t, prompt, hint, return_dict=False)
        return self.unet(z, t, prompt, down_block_additional_residuals=down, mid_block_additional_residual=middle).sample

    def exported(self, pass_name, frames, keyframes, latent, prompt, hint, scales_logits):
        """The graph of a pass for so many frames, serialised; shapes are those of one frame."""
        given = [torch.zeros(frames, *shape) for shape in (latent, prompt, hint)]
        with tempfile.TemporaryDirectory() as folder, torch.no_grad(), warnings.catch_warnings(action="ignore"):
            file = str(pathlib.Path(folder) / "network.onnx")
            torch.onnx.export(self, (given[0], torch.zeros(1), *given[1:]), file, dynamo=False, opset_version=17,
                              input_names=["z", "t", "prompt", "hint"], output_names=["v"])
            model = onnx.load(file)
        add_feature_io(model, pass_name, keyframes, keyframes, scales_logits=scales_logits)
        return model.SerializeToString()
