# SPDX-License-Identifier: MIT
"""Generative Rendering (alg. 1) as patches of a model of ComfyUI: a latent batch holds the frames of the animation.

`patched` gives a model whose every call records keyframes and injects them into all frames; `UVNoise` is the noise to start
from. NODE_CLASS_MAPPINGS makes nodes of them.
"""

import torch

from . import draw_keyframes, load_exr
from .blending import Blending, mix
from .estimates import PRESETS, Estimates, with_preset


class UVNoise:
    """A noise object: N(0, 1) that moves with the surfaces, for latents whose batch holds the frames of `maps`."""

    def __init__(self, maps, seed=0):
        self.maps, self.seed = maps, seed

    def generate_noise(self, input_latent):
        """Noise of the shape of input_latent["samples"], of the frames in input_latent["batch_index"] if that is given."""
        samples = input_latent["samples"]
        frames = input_latent.get("batch_index")
        noise = self.maps.initial_noise(*samples.shape[1:], seed=self.seed, frames=None if frames is None else list(frames))
        require_frames("generate_noise", len(samples), len(noise))
        return torch.from_numpy(noise)


def require_frames(function, found, expected):
    """Raises ValueError unless a batch holds one latent a frame."""
    if found != expected:
        raise ValueError(f"{function}: the batch holds {found} latents, expected {expected}, one a frame of the maps")


class Patches:
    """What is called instead of the network, before and after each of its self-attention modules, and after guidance."""

    def __init__(self, maps, preset="vivid", keyframes=4, seed=0, alpha=0.7, latents_grid_alpha=None, pre_attention=True,
                 post_attention=True, consensus=None, normalization=None, frames_per_call=4):
        self.of_preset = with_preset(preset, latents_grid_alpha=latents_grid_alpha, consensus=consensus,
                                     normalization=normalization)
        self.maps, self.keyframe_count, self.seed, self.alpha = maps, min(keyframes, maps.frames), seed, alpha
        self.pre_attention, self.post_attention = pre_attention, post_attention
        self.frames_per_call, self.made_for, self.frames, self.kept = frames_per_call, None, None, {}

    def patch(self, model):
        """A copy of a ModelPatcher with these patches."""
        model = model.clone()
        model.set_model_unet_function_wrapper(self.unet_wrapper)
        model.set_model_attn1_patch(self.attn1_patch)
        model.set_model_attn1_output_patch(self.attn1_output_patch)
        model.set_model_sampler_post_cfg_function(self.post_cfg)
        return model

    def unet_wrapper(self, apply_model, args):
        """One call of the network becomes one of the keyframes and then one of every few frames."""
        x, c, count = args["input"], args["c"], self.maps.frames
        self.branches = len(args["cond_or_uncond"])
        require_frames("unet_wrapper", len(x) // self.branches, count)
        sigmas = c["transformer_options"]["sample_sigmas"]
        self.make_for(tuple(x.shape[-2:]), len(sigmas) - 1)
        self.step = int((sigmas[1:-1] >= args["timestep"][0].to(sigmas)).sum())
        self.kept, self.keyframes = {}, draw_keyframes(self.keyframe_count, count, self.step, self.seed)
        out = torch.empty_like(x)

        def run(frames, is_recording):
            self.frames, self.is_recording = frames, is_recording
            rows = [branch * count + i for branch in range(self.branches) for i in frames]
            return rows, apply_model(x[rows], args["timestep"][rows], **rows_of(c, rows, len(x)))

        try:
            run(self.keyframes, True)
            for first in range(0, count, self.frames_per_call):
                rows, of_frames = run(list(range(first, min(first + self.frames_per_call, count))), False)
                out[rows] = of_frames
        finally:
            self.frames, self.kept = None, {}
        return out

    def make_for(self, grid, steps):
        """Makes what a run of so many steps needs whose latents have this height and width, unless it is there."""
        if self.made_for != (grid, steps):
            self.blending = Blending(self.maps, grid)
            self.estimates = Estimates(self.blending, steps, self.seed, self.of_preset["consensus"],
                                       self.of_preset["normalization"])
            self.made_for = grid, steps

    def takes_part(self, extra_options):
        """Whether it is the decoder of a call of ours."""
        return self.frames is not None and extra_options["block"][0] == "output"

    def stacked(self, x):
        """[branches, frames, tokens, channels]."""
        return x.unflatten(0, (self.branches, len(self.frames)))

    def attn1_patch(self, n, context_attn1, value_attn1, extra_options):
        """What a module attends to: keyframes to all keyframes (eq. 3), frames to themselves and all keyframes (eq. 5)."""
        if not self.takes_part(extra_options) or not self.pre_attention:
            return n, context_attn1, value_attn1
        at = extra_options["block"], extra_options["block_index"]
        own = [self.stacked(n if x is None else x) for x in (context_attn1, value_attn1)]
        if self.is_recording:
            self.kept[at, "joined"] = [x.flatten(1, 2)[:, None] for x in own]
            joined = [x_KF.expand(-1, len(self.frames), -1, -1) for x_KF in self.kept[at, "joined"]]
        else:
            joined = [torch.cat([x, x_KF.expand(-1, len(self.frames), -1, -1)], 2)
                      for x, x_KF in zip(own, self.kept[at, "joined"])]
        return n, *(x.flatten(0, 1) for x in joined)

    def attn1_output_patch(self, n, extra_options):
        """What a module gives: frames mix in the features of keyframes (eq. 6); weights sum to 1, so it may follow to_out."""
        if not self.takes_part(extra_options) or not self.post_attention:
            return n
        at, F = (extra_options["block"], extra_options["block_index"]), self.stacked(n)
        if self.is_recording:
            self.kept[at, "F_KF"] = F.flatten(1, 2)
            return n
        alpha = self.blending.alpha_at(F.shape[2], self.alpha, self.of_preset["latents_grid_alpha"])
        if alpha == 0:
            return n
        rows = self.blending.rows(F.shape[2], self.keyframes, self.frames, alpha, n.device)
        return mix(F, self.kept[at, "F_KF"], rows).flatten(0, 1)

    def post_cfg(self, args):
        """The consensus and the normalisation of the clean estimates."""
        x0 = args["denoised"]
        if self.estimates.are_left:
            return x0
        on_host = x0.detach().float().cpu().contiguous().clone()
        self.estimates.finish(on_host.numpy(), self.step)
        return on_host.to(x0)


def rows_of(value, rows, batch):
    """The entries of a batch in whatever conditioning holds: tensors in dicts and lists."""
    if isinstance(value, dict):
        return {key: x if key == "transformer_options" else rows_of(x, rows, batch) for key, x in value.items()}
    if isinstance(value, list):
        return [rows_of(x, rows, batch) for x in value]
    return value[rows] if isinstance(value, torch.Tensor) and value.ndim > 0 and len(value) == batch else value


def patched(model, maps, **settings):
    """The model with Patches of these settings."""
    return Patches(maps, **settings).patch(model)


class MapsNode:
    """A folder of EXR files as maps, pictures of depth for a ControlNet, and empty latents, one a frame."""
    CATEGORY, FUNCTION, RETURN_TYPES = "genrender", "load", ("GENRENDER_MAPS", "IMAGE", "LATENT")

    @classmethod
    def INPUT_TYPES(cls):
        size = ("INT", {"default": 512, "min": 64, "max": 4096, "step": 8})
        return {"required": {"folder": ("STRING", {"default": ""}), "height": size, "width": size}}

    def load(self, folder, height, width):
        maps = load_exr(folder)
        depth = torch.from_numpy(maps.inverse_depth(height, width))[..., None].repeat(1, 1, 1, 3)
        return maps, depth, {"samples": torch.zeros(maps.frames, 4, height // 8, width // 8)}


class NoiseNode:
    """UVNoise of maps."""
    CATEGORY, FUNCTION, RETURN_TYPES = "genrender", "make", ("NOISE",)

    @classmethod
    def INPUT_TYPES(cls):
        return {"required": {"maps": ("GENRENDER_MAPS",), "seed": ("INT", {"default": 0, "min": 0, "max": 2 ** 64 - 1})}}

    def make(self, maps, seed):
        return (UVNoise(maps, seed),)


class ModelNode:
    """A model whose frames share the features of keyframes."""
    CATEGORY, FUNCTION, RETURN_TYPES = "genrender", "patch", ("MODEL",)

    @classmethod
    def INPUT_TYPES(cls):
        return {"required": {"model": ("MODEL",), "maps": ("GENRENDER_MAPS",), "preset": (list(PRESETS),),
                             "keyframes": ("INT", {"default": 4, "min": 1, "max": 64}),
                             "seed": ("INT", {"default": 0, "min": 0, "max": 2 ** 64 - 1}),
                             "alpha": ("FLOAT", {"default": 0.7, "min": 0.0, "max": 1.0, "step": 0.05})}}

    def patch(self, model, maps, preset, keyframes, seed, alpha):
        return (patched(model, maps, preset=preset, keyframes=keyframes, seed=seed, alpha=alpha),)


NODE_CLASS_MAPPINGS = {"GenrenderMaps": MapsNode, "GenrenderNoise": NoiseNode, "GenrenderModel": ModelNode}
