# SPDX-License-Identifier: MIT
"""Generative Rendering (alg. 1) with diffusers' StableDiffusionControlNetPipeline.

`render` gives the latents of an animation, `pictures` decodes them.
"""

import contextlib
import math

import torch
import torch.nn.functional as nn

from . import NoiseSchedule, draw_keyframes, karras_schedule, sample, scalings
from .blending import Blending, mix_keeping_variance
from .estimates import Estimates, require_length_correction, with_preset


class SelfAttention:
    """The attention processor of a self-attention module: keyframes are recorded, other frames are injected."""

    def __init__(self, run, name):
        self.run, self.name, self.kept = run, name, None

    def __call__(self, attn, hidden_states, encoder_hidden_states=None, attention_mask=None, temb=None, **_):
        run = self.run
        f = hidden_states.unflatten(0, (run.branches, len(run.frames)))  # [uncond; cond], then frames
        Q, K, V = attn.to_q(f), attn.to_k(f), attn.to_v(f)
        if run.is_recording:
            F = self.record(attn.heads, Q, K, V)
        else:
            F = self.inject(attn.heads, Q, K, V)
        return attn.to_out[1](attn.to_out[0](F)).flatten(0, 1)

    def record(self, heads, Q, K, V):
        """F of keyframes that attend to each other (eq. 3); keeps K_KF, V_KF, F_KF [branches, keyframes * tokens, ...]."""
        run = self.run
        if run.pre_attention:
            factor = temperature(K.shape[2], K.shape[1] * K.shape[2], run.length_correction)
            all_of_them = [x.flatten(1, 2) for x in (K, V)]
            if run.counts_points:
                counts = run.blending.counts(Q.shape[2], run.keyframes, None, Q.device)
                F = attend(heads, Q, *(x[:, None].expand(-1, Q.shape[1], -1, -1) for x in all_of_them), factor, counts)
            else:
                F = attend(heads, Q.flatten(1, 2), *all_of_them, factor).view_as(Q)
        else:
            F = attend(heads, Q, K, V)
        self.kept = [x.flatten(1, 2) for x in (K, V, F)]
        return F

    def inject(self, heads, Q, K, V):
        """F_out of frames that attend to themselves and the keyframes (eq. 5) and mix in their features (eq. 6)."""
        run = self.run
        if run.keyframe_count == 0:
            return attend(heads, Q, K, V)
        K_KF, V_KF, F_KF = self.kept
        if run.pre_attention:
            joined = [torch.cat([x, x_KF[:, None].expand(-1, x.shape[1], -1, -1)], 2) for x, x_KF in ((K, K_KF), (V, V_KF))]
            counts = run.blending.counts(Q.shape[2], run.keyframes, run.frames, Q.device) if run.counts_points else None
            F_hat = attend(heads, Q, *joined, temperature(K.shape[2], joined[0].shape[2], run.length_correction), counts)
        else:
            F_hat = attend(heads, Q, K, V)
        alpha = run.alpha(run.step, self.name) if callable(run.alpha) else run.alpha
        alpha = run.blending.alpha_at(Q.shape[2], alpha, run.latents_grid_alpha)
        if not run.post_attention or alpha == 0:
            return F_hat
        rows = run.blending.rows(Q.shape[2], run.keyframes, run.frames, alpha, Q.device)
        return mix_keeping_variance(F_hat, F_KF, rows, run.variance)


def temperature(own, keys, power):
    """What logits are multiplied by where a token attends to `keys` keys, `own` of them its frame's: (ln keys / ln own)^power."""
    return 1.0 if power == 0 or keys == own or own < 2 else (math.log(keys) / math.log(own)) ** power


def attend(heads, Q, K, V, factor=1.0, counts=None):
    """Attn(Q, K, V) (eq. 1) of [..., tokens, channels], logits times `factor`; fused kernels take exactly four axes.

    `counts` [frames, keys] are what keys count for, where Q is [branches, frames, tokens, channels].
    """
    q, k, v = (x.flatten(0, -3).unflatten(-1, (heads, -1)).transpose(1, 2) for x in (Q, K, V))
    scale = None if factor == 1.0 else factor / math.sqrt(q.shape[-1])
    mask = None if counts is None else counts.log().to(q.dtype).repeat(len(Q), 1)[:, None, None]
    return nn.scaled_dot_product_attention(q, k, v, mask, scale=scale).transpose(1, 2).reshape(Q.shape)


class Run:
    """What all evaluations of a run share; `D` is the clean estimate of the whole animation."""

    def __init__(self, pipe, maps, prompt, negative_prompt, clip_skip, height, width, hint, **settings):
        self.__dict__.update(settings)
        self.pipe, self.device, config = pipe, pipe._execution_device, pipe.scheduler.config
        scale = pipe.vae_scale_factor
        if height % scale or width % scale:
            raise ValueError(f"render: height and width are {height} and {width}, expected multiples of {scale}")
        self.grid = height // scale, width // scale
        self.blending = Blending(maps, self.grid, self.average)
        self.estimates = Estimates(self.blending, self.steps, self.seed, self.consensus, self.normalization)
        if hint is None:
            hint = torch.from_numpy(maps.inverse_depth(height, width))[:, None].repeat(1, 3, 1, 1)
        self.hint = hint.to(self.device, pipe.controlnet.dtype)
        self.prediction = config.prediction_type
        if config.beta_schedule == "scaled_linear":
            self.schedule = NoiseSchedule.scaled_linear(config.beta_start, config.beta_end, config.num_train_timesteps)
        else:
            self.schedule = NoiseSchedule(pipe.scheduler.alphas_cumprod.double().tolist())
        self.branches = 1 if self.guidance_scale == 1 else 2
        text, negative = pipe.encode_prompt(prompt, self.device, 1, self.branches == 2, negative_prompt, clip_skip=clip_skip)
        self.text = (text if self.branches == 1 else torch.cat([negative, text])).to(pipe.unet.dtype)

    @contextlib.contextmanager
    def processors(self):
        """Puts the processors into the decoder of the UNet, and what was there back at the end."""
        sites = {name: module for name, module in self.pipe.unet.named_modules()
                 if name.startswith("up_blocks.") and name.endswith(".attn1")}
        if not sites:
            raise ValueError("render: the UNet's decoder has no self-attention, expected modules called attn1")
        for name, module in sites.items():
            if any(getattr(module, part, None) is not None for part in ("group_norm", "spatial_norm", "norm_q", "norm_k")):
                raise ValueError(f"render: {name} normalises features, expected self-attention of a transformer block")
        before = {name: module.processor for name, module in sites.items()}
        try:
            for name, module in sites.items():
                module.set_processor(SelfAttention(self, name))
            yield
        finally:
            for name, module in sites.items():
                module.set_processor(before[name])

    def D(self, z, sigma, step):
        """The clean estimates of all frames of z [frames, channels, height, width]: the body of alg. 1's loop."""
        self.step, self.control = step, {}
        if self.keyframe_count > 0:
            self.keyframes = draw_keyframes(self.keyframe_count, len(z), step, self.seed)
            self.estimate(z, sigma, self.keyframes, is_recording=True)
        parts = [self.estimate(z, sigma, list(range(i, min(i + self.frames_per_call, len(z)))), is_recording=False)
                 for i in range(0, len(z), self.frames_per_call)]
        x0 = torch.cat(parts)
        if self.estimates.are_left:
            return x0
        on_host = x0.cpu().contiguous()
        self.estimates.finish(on_host.numpy(), step)
        return on_host.to(x0.device)

    def estimate(self, z, sigma, frames, is_recording):
        """Clean estimates of some frames by UNet and ControlNet, [uncond; cond] stacked as diffusers does."""
        self.frames, self.is_recording = frames, is_recording
        z = z[frames]
        c_skip, c_out, c_in = scalings(self.prediction, sigma)
        x = (c_in * z).to(self.pipe.unet.dtype)
        t = torch.tensor(self.schedule.t_of(sigma), dtype=torch.float32, device=self.device)
        residuals = [self.residuals(x[k:k + 1], t, i) for k, i in enumerate(frames)]
        *down, middle = (torch.stack(level, 1).flatten(0, 1) for level in zip(*residuals))
        F = self.pipe.unet(x.repeat(self.branches, 1, 1, 1), t, self.text.repeat_interleave(len(frames), 0),
                           down_block_additional_residuals=down, mid_block_additional_residual=middle).sample.float()
        if self.branches == 2:
            uncond, cond = F.chunk(2)
            F = uncond + self.guidance_scale * (cond - uncond)
        return c_skip * z + c_out * F

    def residuals(self, x, t, i):
        """What the ControlNet adds to frame i, both branches; that of keyframes is kept for the evaluation."""
        if i not in self.control:
            down, middle = self.pipe.controlnet(
                x.repeat(self.branches, 1, 1, 1), t, self.text, self.hint[i:i + 1].repeat(self.branches, 1, 1, 1),
                self.conditioning_scale, return_dict=False)
            if not self.is_recording:
                return [*down, middle]
            self.control[i] = [*down, middle]
        return self.control[i]


@torch.no_grad()
def render(pipe, maps, prompt, *, height, width, preset="vivid", negative_prompt="", steps=50, seed=0, keyframes=None,
           guidance_scale=7.5, conditioning_scale=1.0, clip_skip=None, sampler="euler", alpha=0.7, latents_grid_alpha=None,
           pre_attention=True, post_attention=True, consensus=None, normalization=None, average="quality", noise="uv",
           frames_per_call=1, hint=None, observer=None, length_correction=0.0, counts_points=False,
           variance="none"):
    """Consistent clean latents of all frames [frames, channels, height / 8, width / 8], in float32 on the pipe's device.

    `maps` are genrender.Maps, with depth where `hint` is None. `hint` is what the ControlNet sees of each frame [frames,
    channels, height, width], as a tensor: the depth of the maps, repeated over three channels, where it is None. Of `keyframes`
    None is 4, or all frames if these are fewer; 0 injects nothing. `preset` is vivid or plain (alg. 1 alone); it decides on
    `latents_grid_alpha`, `consensus` and `normalization` where these are None. `alpha` is a number or a function of step and
    name of the module, multiplied by `latents_grid_alpha` where features are as fine as latents. `consensus` is True, False or
    a dict of arguments of genrender.Consensus. `normalization` is mean, mean_and_supported_deviation, low_band,
    mean_and_deviation (the paper's) or none. `length_correction` is the power of ln(keys) / ln(own keys) on the logits where
    frames attend to others: 1 is the length-corrected temperature. With `counts_points` keys that show one surface point count
    together for one. `variance` is that which eq. 6 keeps: none, total (of all that is averaged) or sources (of keyframes).
    Raises ValueError for what does not fit.
    """
    keyframes = min(4, maps.frames) if keyframes is None else keyframes
    for name, value, least in (("keyframes", keyframes, 0), ("frames_per_call", frames_per_call, 1)):
        if value < least:
            raise ValueError(f"render: {name} is {value}, expected at least {least}")
    require_length_correction(length_correction)
    if variance not in ("none", "total", "sources"):
        raise ValueError(f"render: variance is {variance}, expected one of none, total, sources")
    of_preset = with_preset(preset, latents_grid_alpha=latents_grid_alpha, consensus=consensus, normalization=normalization)
    run = Run(pipe, maps, prompt, negative_prompt, clip_skip, height, width, hint, keyframe_count=keyframes, seed=seed,
              steps=steps, guidance_scale=guidance_scale, conditioning_scale=conditioning_scale, alpha=alpha, average=average,
              pre_attention=pre_attention, post_attention=post_attention, frames_per_call=frames_per_call,
              length_correction=length_correction, counts_points=counts_points, variance=variance, **of_preset)
    sigmas = karras_schedule(steps, run.schedule.sigma_min, run.schedule.sigma_max)
    channels = pipe.unet.config.in_channels
    z = sigmas[0] * torch.from_numpy(maps.initial_noise(channels, *run.grid, seed=seed, kind=noise)).to(run.device)
    with run.processors():
        return sample(sampler, run.D, z, sigmas, observer)


@torch.no_grad()
def pictures(pipe, z):
    """Pictures of latents as PIL images, decoded one after the other."""
    made = []
    for frame in z.to(pipe.vae.dtype).split(1):
        decoded = pipe.vae.decode(frame / pipe.vae.config.scaling_factor).sample
        made += pipe.image_processor.postprocess(decoded)
    return made
