# SPDX-License-Identifier: MIT
"""Trains the encoder of images and prompts that the metrics use, on the pictures of make_renders.

    python3 train_embedder.py --data renders --out prompt_embedder

It learns which texts describe which pictures of a batch (Radford et al. 2021), where several texts may. A run that was
killed goes on where its last checkpoint was. Writes config.json, model.safetensors in half precision (which the
library's reference_embedder reads) and training.json with the settings and what the last hundredth of the pictures,
kept apart, says.
"""

import argparse
import json
import math
import pathlib
import time

import numpy
import torch
import torch.nn.functional as F
from safetensors.torch import save_file

from renders import UNKNOWN, Renders

CHANNELS = (24, 48, 96, 96)  # of the four blocks; all but the first halve height and width
GROUPS = 8
DIMENSION = 64
KEPT_APART = 100  # one picture in so many is not trained on


class Block(torch.nn.Module):
    """Convolution, GroupNorm, SiLU."""

    def __init__(self, inputs, outputs, stride):
        super().__init__()
        self.conv = torch.nn.Conv2d(inputs, outputs, 3, stride, 1)
        self.norm = torch.nn.GroupNorm(GROUPS, outputs)

    def forward(self, x):
        return F.silu(self.norm(self.conv(x)))


class ImageEncoder(torch.nn.Module):
    """Unit vectors [batch, dimension] of images [batch, 3, height, width] in [0, 1]."""

    def __init__(self):
        super().__init__()
        inputs = (3,) + CHANNELS[:-1]
        self.blocks = torch.nn.ModuleList(
            Block(inputs[i], outputs, 1 if i == 0 else 2) for i, outputs in enumerate(CHANNELS))
        self.projection = torch.nn.Linear(CHANNELS[-1], DIMENSION)

    def forward(self, images):
        x = 2 * images - 1
        for block in self.blocks:
            x = block(x)
        with torch.autocast("cpu", enabled=False):
            return F.normalize(self.projection(x.to(images.dtype).mean((2, 3))), dim=-1)


class TextEncoder(torch.nn.Module):
    """Unit vectors [texts, dimension] of texts, each a list of words' rows that begins with row 0."""

    def __init__(self, words):
        super().__init__()
        self.embedding = torch.nn.Embedding(1 + words, DIMENSION)
        self.projection = torch.nn.Linear(DIMENSION, DIMENSION)

    def forward(self, texts):
        means = torch.stack([self.embedding(torch.tensor(rows)).mean(0) for rows in texts])
        return F.normalize(self.projection(means), dim=-1)


class PromptEmbedder(torch.nn.Module):
    """Both encoders, and the temperature that only training needs."""

    def __init__(self, words):
        super().__init__()
        self.image = ImageEncoder()
        self.text = TextEncoder(words)
        self.log_scale = torch.nn.Parameter(torch.tensor(math.log(10.0)))

    def tensors(self):
        return {name: value.detach() for name, value in self.state_dict().items() if name != "log_scale"}


def augmented(images, random):
    """Mirrored, brighter or darker, flatter or steeper, a little blurred and noisy: generated images are not crisp."""
    n = len(images)
    uniform = lambda low, high: torch.from_numpy(random.uniform(low, high, (n, 1, 1, 1)).astype(numpy.float32))
    mirrored = torch.from_numpy(random.random(n) < 0.5)
    images[mirrored] = images[mirrored].flip(-1)
    # A part of each picture is its mean over 3 x 3 pixels, twice for some.
    padded = lambda x: F.pad(x, (1, 1, 1, 1), mode="replicate")
    blurred = F.avg_pool2d(padded(images), 3, 1)
    more = torch.from_numpy(random.random(n) < 0.3)
    blurred[more] = F.avg_pool2d(padded(blurred[more]), 3, 1)
    images = images + uniform(-0.5, 1).clamp(min=0) * (blurred - images)
    mean = images.mean((1, 2, 3), keepdim=True)
    images = mean + (images - mean) * uniform(0.7, 1.3) + uniform(-0.1, 0.1)
    noise = torch.from_numpy(random.standard_normal(images.shape, numpy.float32))
    return (images + uniform(-0.04, 0.06).clamp(min=0) * noise).clamp(0, 1)


def draw_texts(prompts, random):
    """For each picture the style and the colour that its text names, or -1: the style alone half of the time, seldom
    the colour alone."""
    style, colour = prompts[:, 0].copy(), numpy.where(prompts[:, 1] == UNKNOWN, -1, prompts[:, 1])
    drawn = random.random(len(prompts))
    style[(drawn < 0.15) & (colour >= 0)] = -1
    colour[drawn >= 0.5] = -1
    return numpy.stack([style, colour], 1)


def contrastive_loss(similarities, prompts, texts):
    """Cross-entropy in both directions between the softmax of similarities [pictures, texts] and the texts that are
    true of a picture, all of them alike. Whether a colour is true of a picture of many is not asked."""
    same_style = (texts[None, :, 0] == -1) | (texts[None, :, 0] == prompts[:, None, 0])
    same_colour = (texts[None, :, 1] == -1) | (texts[None, :, 1] == prompts[:, None, 1])
    is_unclear = (prompts[:, None, 1] == UNKNOWN) & (texts[None, :, 1] != -1) & same_style
    similarities = similarities.masked_fill(torch.from_numpy(is_unclear), -1e4)
    fits = torch.from_numpy((same_style & same_colour & ~is_unclear).astype(numpy.float32))
    loss = 0
    for axis in (0, 1):
        target = fits / fits.sum(axis, keepdim=True)  # a picture's own text fits, so no sum is 0
        loss = loss - (target * F.log_softmax(similarities, axis)).sum(axis).mean() / 2
    return loss


@torch.no_grad()
def accuracy(model, renders, numbers):
    """Shares of pictures whose nearest text among the styles, and among the colours, is true of them."""
    model.eval()
    found = torch.cat([model.image(renders.pictures(numbers[i:i + 256])) for i in range(0, len(numbers), 256)])
    prompts = torch.from_numpy(renders.prompts[numbers])
    styles = model.text([renders.text(style, None) for style in range(len(renders.styles))])
    colours = model.text([renders.text(None, colour) for colour in range(len(renders.colours))])
    model.train()
    has_colour = prompts[:, 1] != UNKNOWN
    rate = lambda right: right.float().mean().item() if len(right) else None
    style_is_right = (found @ styles.T).argmax(1) == prompts[:, 0]
    colour_is_right = ((found @ colours.T).argmax(1) == prompts[:, 1])[has_colour]
    return dict(style=rate(style_is_right), colour=rate(colour_is_right),
                by_style={name: rate(style_is_right[prompts[:, 0] == i]) for i, name in enumerate(renders.styles)})


def learning_rate(progress, highest):
    """Warm up over a fiftieth of the run, then fall as a cosine to 1 %."""
    warm = min(1.0, progress / 0.02)
    return highest * max(warm * (0.505 + 0.495 * math.cos(math.pi * min(progress, 1.0))), 0.01)


def save_model(model, renders, out):
    (out / "config.json").write_text(json.dumps(
        dict(_class_name="PromptEmbedder", words=renders.words, dimension=DIMENSION), indent=2) + "\n")
    path = out / "model.safetensors"
    save_file({name: value.half().contiguous() for name, value in model.tensors().items()}, path)
    path.chmod(0o644)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", required=True, type=pathlib.Path, help="folder of make_renders")
    parser.add_argument("--out", required=True, type=pathlib.Path, help="folder of the weights and the checkpoint")
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--batch", type=int, default=128)
    parser.add_argument("--rate", type=float, default=2e-3, help="highest learning rate")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--minutes", type=float, default=math.inf, help="end after this time if steps are left")
    parser.add_argument("--threads", type=int, default=0, help="0 = all of the machine")
    arguments = parser.parse_args()
    if arguments.threads:
        torch.set_num_threads(arguments.threads)
    torch.manual_seed(arguments.seed)
    arguments.out.mkdir(parents=True, exist_ok=True)

    renders = Renders(arguments.data)
    trained_on = len(renders) - max(1, len(renders) // KEPT_APART)
    batch = min(arguments.batch, trained_on)
    held_out = numpy.arange(trained_on, len(renders))
    model = PromptEmbedder(len(renders.words))
    matrices = [p for p in model.parameters() if p.dim() > 1]
    others = [p for p in model.parameters() if p.dim() <= 1]
    optimizer = torch.optim.AdamW([dict(params=matrices, weight_decay=1e-3), dict(params=others, weight_decay=0)],
                                  lr=arguments.rate, betas=(0.9, 0.99))
    step, losses, seconds_before = 0, [], 0.0
    checkpoint = arguments.out / "checkpoint.pt"
    if checkpoint.exists():
        saved = torch.load(checkpoint)
        model.load_state_dict(saved["model"])
        optimizer.load_state_dict(saved["optimizer"])
        step, losses, seconds_before = saved["step"], saved["losses"], saved["seconds"]
        print(f"going on at step {step}", flush=True)

    start = time.time()
    seconds = lambda: seconds_before + time.time() - start
    progress = lambda: max(step / arguments.steps, seconds() / 60 / arguments.minutes)
    while progress() < 1:
        # Each step draws from its own seed, so that a run that goes on draws what an unbroken one would.
        random = numpy.random.default_rng([arguments.seed, step])
        numbers = numpy.sort(random.choice(trained_on, batch, replace=False))
        prompts = renders.prompts[numbers]
        texts = draw_texts(prompts, random)
        rows = [renders.text(*(None if word < 0 else word for word in text)) for text in texts]
        images = augmented(renders.pictures(numbers), random)
        with torch.autocast("cpu", torch.bfloat16):
            vectors = model.image(images)
        similarities = model.log_scale.exp().clamp(max=100) * vectors @ model.text(rows).T
        loss = contrastive_loss(similarities, prompts, texts)
        optimizer.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        for group in optimizer.param_groups:
            group["lr"] = learning_rate(progress(), arguments.rate)
        optimizer.step()
        losses.append(loss.item())
        step += 1
        if step % 50 == 0:
            print(f"step {step} loss {numpy.mean(losses[-50:]):.4f}  {seconds() / step:.2f} s a step", flush=True)
        if step % 250 == 0 or progress() >= 1:
            partial = checkpoint.with_suffix(".part")
            torch.save(dict(model=model.state_dict(), optimizer=optimizer.state_dict(), step=step, losses=losses,
                            seconds=seconds()), partial)
            partial.replace(checkpoint)
            save_model(model, renders, arguments.out)
            right = accuracy(model, renders, held_out)
            print(f"step {step} held out: style {right['style']:.3f}, colour "
                  + (f"{right['colour']:.3f}" if right["colour"] is not None else "unknown"), flush=True)

    right = accuracy(model, renders, held_out)
    (arguments.out / "training.json").write_text(json.dumps(dict(
        pictures=trained_on, held_out=len(held_out), steps=step, batch=batch, rate=arguments.rate, seed=arguments.seed,
        seconds=round(seconds()), parameters=sum(value.numel() for value in model.tensors().values()),
        loss=float(numpy.mean(losses[-50:])), temperature=1 / min(100.0, model.log_scale.exp().item()),
        held_out_accuracy=right), indent=2) + "\n")
    print(json.dumps(right))


if __name__ == "__main__":
    main()
