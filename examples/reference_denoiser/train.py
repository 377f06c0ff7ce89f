# SPDX-License-Identifier: MIT
"""Trains the reference denoiser on the pictures of make_renders: a UNet and a depth ControlNet of diffusers' classes.

    python3 train.py --data renders --out reference_denoiser

A run that was killed goes on where its last checkpoint was, and ends with the same weights.
"""

import argparse
import json
import math
import pathlib
import time

import numpy
import torch
from diffusers import ControlNetModel, UNet2DConditionModel
from diffusers.models.attention_processor import AttnProcessor
from safetensors.torch import save_file

from renders import UNKNOWN, Renders

# The network: Stable Diffusion 1.5 in miniature, with attention at 16 x 16 and 8 x 8 tokens.
TOKEN_CHANNELS = 48
SHAPE = dict(
    in_channels=12, block_out_channels=(32, 64, 56), layers_per_block=1, attention_head_dim=(1, 2, 2),
    cross_attention_dim=TOKEN_CHANNELS, norm_num_groups=8,
    down_block_types=("DownBlock2D", "CrossAttnDownBlock2D", "DownBlock2D"))


class Denoiser(torch.nn.Module):
    """v-prediction for noisy latents, a hint and a prompt."""

    def __init__(self, words):
        super().__init__()
        self.words = words
        self.unet = UNet2DConditionModel(
            sample_size=32, out_channels=12, up_block_types=("UpBlock2D", "CrossAttnUpBlock2D", "UpBlock2D"), **SHAPE)
        self.controlnet = ControlNetModel(conditioning_channels=4, conditioning_embedding_out_channels=(32,), **SHAPE)
        self.tokens = torch.nn.Embedding(1 + len(words), TOKEN_CHANNELS)
        # The usual attention is a matter of taste for 256 tokens; this one has the faster backward pass on a processor.
        self.unet.set_attn_processor(AttnProcessor())
        self.controlnet.set_attn_processor(AttnProcessor())
        # A ControlNet that joins a trained UNet begins at zero, so as not to disturb it. Here nothing is trained yet.
        for name, parameter in self.controlnet.named_parameters():
            if name.startswith(("controlnet_down_blocks", "controlnet_mid_block", "controlnet_cond_embedding.conv_out")):
                if parameter.dim() > 1:
                    torch.nn.init.kaiming_uniform_(parameter, a=math.sqrt(5))

    def forward(self, z, t, hint, rows):
        prompt = self.tokens(rows)
        down, middle = self.controlnet(z, t, prompt, hint, return_dict=False)
        return self.unet(z, t, prompt, down_block_additional_residuals=down,
                         mid_block_additional_residual=middle, return_dict=False)[0]


# What the library's Haar transform does (models/haar.hpp).
def haar_square(x):
    a, b, c, d = x[..., 0::2, 0::2], x[..., 0::2, 1::2], x[..., 1::2, 0::2], x[..., 1::2, 1::2]
    return (a + b + c + d) / 2, (a - b + c - d) / 2, (a + b - c - d) / 2, (a - b - c + d) / 2


def encode(images):
    """Latents [batch, 12, 32, 32] of images [batch, 3, 64, 64] in [0, 1]."""
    mean, *details = haar_square(2 * images - 1)
    return torch.cat([1.05 * (mean - 0.38)] + [4.5 * detail for detail in details], 1)


def decode(latents):
    """The inverse of encode."""
    mean, right, down, diagonal = latents.chunk(4, 1)
    mean, right, down, diagonal = mean / 1.05 + 0.38, right / 4.5, down / 4.5, diagonal / 4.5
    images = torch.empty(latents.shape[0], 3, 2 * latents.shape[2], 2 * latents.shape[3])
    images[..., 0::2, 0::2] = (mean + right + down + diagonal) / 2
    images[..., 0::2, 1::2] = (mean - right + down - diagonal) / 2
    images[..., 1::2, 0::2] = (mean + right - down - diagonal) / 2
    images[..., 1::2, 1::2] = (mean - right - down + diagonal) / 2
    return (images + 1) / 2


def hint_of(inverse_depth):
    """Hints [batch, 4, 32, 32] of inverse depth [batch, 64, 64] in [0, 1]."""
    mean, *details = haar_square(inverse_depth[:, None])
    return torch.cat([mean - 1] + [(12 * detail).clamp(-4, 4) for detail in details], 1)


class Schedule:
    """Stable Diffusion's noise levels as the library reads them: log sigma is linear between the 1000 steps."""

    def __init__(self):
        alphas = torch.cumprod(1 - torch.linspace(0.00085**0.5, 0.012**0.5, 1000, dtype=torch.float64) ** 2, 0)
        self.log_sigmas = 0.5 * torch.log((1 - alphas) / alphas)

    def time_of(self, sigma):
        log_sigma = sigma.double().log().clamp(self.log_sigmas[0], self.log_sigmas[-1])
        low = (torch.searchsorted(self.log_sigmas, log_sigma, right=True) - 1).clamp(0, 998)
        part = (log_sigma - self.log_sigmas[low]) / (self.log_sigmas[low + 1] - self.log_sigmas[low])
        return (low + part).float()


SCHEDULE = Schedule()


def clean_estimate(predict, z, sigma):
    """D(z, sigma) = z / (1 + sigma^2) - sigma / sqrt(1 + sigma^2) v."""
    s = sigma[:, None, None, None]
    v = predict(z / (1 + s**2).sqrt(), SCHEDULE.time_of(sigma)).float()
    return z / (1 + s**2) - v * s / (1 + s**2).sqrt()


@torch.no_grad()
def sample(model, hint, rows, guidance_scale=2.0, steps=20, seed=0, noise=None):
    """Latents by Euler steps over Karras' levels, each image alone."""
    generator = torch.Generator().manual_seed(seed)
    ramp = torch.linspace(0, 1, steps)
    sigmas = (14.6**(1 / 7) + ramp * (0.03**(1 / 7) - 14.6**(1 / 7)))**7
    sigmas = torch.cat([sigmas, torch.zeros(1)])
    z = sigmas[0] * (torch.randn(len(hint), 12, 32, 32, generator=generator) if noise is None else noise)
    empty = torch.zeros(len(hint), 1, dtype=torch.long)
    for sigma, following in zip(sigmas[:-1], sigmas[1:]):
        level = sigma.expand(len(hint))
        without = clean_estimate(lambda x, t: model(x, t, hint, empty), z, level)
        given = clean_estimate(lambda x, t: model(x, t, hint, rows), z, level)
        x0 = without + guidance_scale * (given - without)
        z = z + (z - x0) / sigma * (following - sigma)
    return z


def token_rows(renders, numbers, with_style, with_colour):
    """Rows of the token table [batch, words] for what the prompts of the pictures name."""
    return torch.tensor([renders.text(style if with_style else None, colour if with_colour else None)
                         for style, colour in renders.prompts[numbers]])


def draw_batch(renders, with_colour_numbers, batch, random):
    """Clean latents, hints and the token rows of one step; all prompts of a step have the same number of words."""
    kind = random.choice(4, p=[0.1, 0.5, 0.35, 0.05])
    with_style, with_colour = [(False, False), (True, False), (True, True), (False, True)][kind]
    numbers = random.choice(with_colour_numbers if with_colour else len(renders), batch, replace=False)
    numbers.sort()
    images, inverse_depth = renders.pictures(numbers), renders.depths(numbers)
    mirrored = torch.from_numpy(random.random(batch) < 0.5)
    images[mirrored] = images[mirrored].flip(-1)
    inverse_depth[mirrored] = inverse_depth[mirrored].flip(-1)
    # An animation's nearest point is seldom in this frame.
    inverse_depth = inverse_depth * torch.from_numpy(random.uniform(0.7, 1, (batch, 1, 1)).astype(numpy.float32))
    return encode(images), hint_of(inverse_depth), token_rows(renders, numbers, with_style, with_colour)


def draw_noise_levels(batch, random):
    """ln sigma ~ N(-0.2, 1.5), stratified over the batch."""
    place = torch.from_numpy((numpy.arange(batch) + random.random(batch)) / batch)
    normal = math.sqrt(2) * torch.erfinv((2 * place - 1).clamp(-0.9999, 0.9999))
    return torch.exp(-0.2 + 1.5 * normal).clamp(0.0292, 14.6146).float()


def learning_rate(step, steps, highest):
    """Warm up, stay for 40 %, fall as a cosine to 1 %."""
    if step < 200:
        return highest * (step + 1) / 200
    fall = max(0.0, (step / steps - 0.4) / 0.6)
    return highest * (0.01 + 0.99 * (0.5 + 0.5 * math.cos(math.pi * min(fall, 1.0))))


def contact_sheet(rows, path):
    """Rows of images [n, 3, 64, 64], one below the other."""
    from PIL import Image
    grid = torch.cat([torch.cat(list(row.clamp(0, 1)), -1) for row in rows], -2)
    Image.fromarray((grid.permute(1, 2, 0) * 255).round().byte().numpy()).resize(
        (2 * grid.shape[-1], 2 * grid.shape[-2]), Image.NEAREST).save(path)


def save_model(model, averages, out):
    """A folder in diffusers' layout with the averaged weights in half precision."""
    out.mkdir(parents=True, exist_ok=True)
    copy = Denoiser(model.words)
    copy.load_state_dict(averages)
    copy.half()
    copy.unet.save_pretrained(out / "unet")
    copy.controlnet.save_pretrained(out / "controlnet")
    (out / "scheduler").mkdir(exist_ok=True)
    (out / "scheduler" / "scheduler_config.json").write_text(json.dumps(dict(
        _class_name="EulerDiscreteScheduler", beta_start=0.00085, beta_end=0.012, beta_schedule="scaled_linear",
        num_train_timesteps=1000, prediction_type="v_prediction"), indent=2) + "\n")
    (out / "text_encoder").mkdir(exist_ok=True)
    (out / "text_encoder" / "config.json").write_text(json.dumps(dict(
        _class_name="PromptVocabulary", hidden_size=TOKEN_CHANNELS, words=model.words), indent=2) + "\n")
    save_file({"token_embedding.weight": copy.tokens.weight.detach()}, out / "text_encoder" / "model.safetensors")


def write_losses(path, losses):
    """The mean loss of every 50 steps."""
    lines = [f"{last},{numpy.mean(losses[last - 50:last]):.5f}" for last in range(50, len(losses) + 1, 50)]
    path.write_text("step,loss\n" + "\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", required=True, type=pathlib.Path, help="folder of make_renders")
    parser.add_argument("--out", required=True, type=pathlib.Path, help="folder of the weights and the checkpoint")
    parser.add_argument("--steps", type=int, default=4700)
    parser.add_argument("--batch", type=int, default=64)
    parser.add_argument("--rate", type=float, default=1.5e-3, help="highest learning rate")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=0, help="0 = all of the machine")
    parser.add_argument("--compile", action="store_true", help="a quarter faster where there is a C++ compiler")
    arguments = parser.parse_args()

    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
    if arguments.threads:
        torch.set_num_threads(arguments.threads)
    torch.manual_seed(arguments.seed)
    arguments.out.mkdir(parents=True, exist_ok=True)
    renders = Renders(arguments.data)
    with_colour = numpy.flatnonzero(renders.prompts[:, 1] != UNKNOWN)

    # Products run in bfloat16; the weights that the optimiser moves are single precision copies.
    model = Denoiser(renders.words)
    masters = {name: parameter.detach().clone().to(device) for name, parameter in model.named_parameters()}
    averages = {name: value.clone() for name, value in masters.items()}
    model = model.to(device, torch.bfloat16).to(memory_format=torch.channels_last)
    parameters = dict(model.named_parameters())
    predict = torch.compile(model, dynamic=False) if arguments.compile else model
    decayed = [value for value in masters.values() if value.dim() > 1]
    others = [value for value in masters.values() if value.dim() <= 1]
    optimizer = torch.optim.AdamW([dict(params=decayed, weight_decay=1e-3), dict(params=others, weight_decay=0)],
                                  lr=arguments.rate, betas=(0.9, 0.99))
    step, losses = 0, []
    checkpoint = arguments.out / "checkpoint.pt"
    if checkpoint.exists():
        saved = torch.load(checkpoint, map_location=device)
        for name, value in masters.items():
            value.copy_(saved["masters"][name])
        averages = saved["averages"]
        optimizer.load_state_dict(saved["optimizer"])
        step, losses = saved["step"], saved["losses"]
        print(f"going on at step {step}", flush=True)

    start, first_step = time.time(), step
    if step >= arguments.steps:
        write_losses(arguments.out / "loss.csv", losses)
        save_model(model, {name: value.cpu() for name, value in averages.items()}, arguments.out)
    while step < arguments.steps:
        # Each step draws from its own seed, so that a run that goes on draws what an unbroken one would.
        random = numpy.random.default_rng([arguments.seed, step])
        latents, hint, rows = (x.to(device) for x in draw_batch(renders, with_colour, arguments.batch, random))
        sigma = draw_noise_levels(arguments.batch, random).to(device)
        generator = torch.Generator().manual_seed(arguments.seed * 1_000_003 + step)
        noise = torch.randn(latents.shape, generator=generator).to(device)
        s = sigma[:, None, None, None]
        scale = (1 + s**2).sqrt()
        with torch.no_grad():
            for name, parameter in parameters.items():
                parameter.copy_(masters[name])
        z = ((latents + s * noise) / scale).to(torch.bfloat16, memory_format=torch.channels_last)
        v = predict(z, SCHEDULE.time_of(sigma.cpu()).to(device), hint.to(torch.bfloat16), rows)
        loss = ((v.float() - (noise - s * latents) / scale) ** 2).mean()
        model.zero_grad(set_to_none=True)
        loss.backward()
        for name, parameter in parameters.items():
            masters[name].grad = parameter.grad.float()
        torch.nn.utils.clip_grad_norm_(list(masters.values()), 1.0)
        for group in optimizer.param_groups:
            group["lr"] = learning_rate(step, arguments.steps, arguments.rate)
        optimizer.step()
        keep = min(0.998, (1 + step) / (10 + step))
        with torch.no_grad():
            for name, value in masters.items():
                averages[name].lerp_(value, 1 - keep)
        losses.append(loss.item())
        step += 1
        if step % 50 == 0:
            seconds = (time.time() - start) / (step - first_step)
            print(f"step {step} loss {numpy.mean(losses[-50:]):.4f}  {seconds:.2f} s a step", flush=True)
        if step % 250 == 0 or step == arguments.steps:
            partial = checkpoint.with_suffix(".part")
            torch.save(dict(masters=masters, averages=averages, optimizer=optimizer.state_dict(), step=step,
                            losses=losses), partial)
            partial.replace(checkpoint)
            write_losses(arguments.out / "loss.csv", losses)
            save_model(model, {name: value.cpu() for name, value in averages.items()}, arguments.out)


if __name__ == "__main__":
    main()
