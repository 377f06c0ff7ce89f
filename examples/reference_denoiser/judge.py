# SPDX-License-Identifier: MIT
"""Says how good the reference denoiser is on scenes that training never showed, one image at a time.

    make_renders --out held_out --count 1000 --seed 2
    python3 judge.py --data held_out --weights weights --embedder embedder --sheet samples.png

Prints the share of renders and of samples whose style the embedder recognises among all styles, and the contrast inside
objects of both. The sheet has a row for each style: renders on the left, samples for the same depth on the right.
"""

import argparse
import json
import pathlib

import numpy
import torch
from safetensors.torch import load_file

import train
import train_embedder
from renders import Renders


def load_denoiser(folder):
    """The folder that train.py wrote."""
    words = json.loads((folder / "text_encoder" / "config.json").read_text())["words"]
    model = train.Denoiser(words)
    for name in ("unet", "controlnet"):
        getattr(model, name).load_state_dict(load_file(folder / name / "diffusion_pytorch_model.safetensors"))
    model.tokens.weight.data.copy_(load_file(folder / "text_encoder" / "model.safetensors")["token_embedding.weight"])
    return model.float().eval()


def load_embedder(folder):
    """The folder that train_embedder.py wrote."""
    words = json.loads((folder / "config.json").read_text())["words"]
    model = train_embedder.PromptEmbedder(len(words))
    missing = model.load_state_dict(load_file(folder / "model.safetensors"), strict=False)
    assert set(missing.missing_keys) <= {"log_scale"} and not missing.unexpected_keys, missing
    return model.float().eval()


def contrast(images, objects):
    """Standard deviation of the colours of the pixels that objects fill, averaged over images."""
    deviations = []
    for image, mask in zip(images, objects):
        pixels = image[:, mask]
        if pixels.shape[1] >= 16:
            deviations.append(pixels.var(1, unbiased=False).mean().sqrt())
    return torch.stack(deviations).mean().item()


@torch.no_grad()
def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", required=True, type=pathlib.Path)
    parser.add_argument("--weights", required=True, type=pathlib.Path)
    parser.add_argument("--embedder", required=True, type=pathlib.Path)
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--steps", type=int, default=20)
    parser.add_argument("--guidance", type=float, default=2.0)
    parser.add_argument("--sheet", type=pathlib.Path)
    arguments = parser.parse_args()

    renders = Renders(arguments.data)
    model, embedder = load_denoiser(arguments.weights), load_embedder(arguments.embedder)
    numbers = numpy.arange(min(arguments.count, len(renders)))
    images, inverse_depth = renders.pictures(numbers), renders.depths(numbers)
    rows = train.token_rows(renders, numbers, True, False)
    samples = torch.cat([
        train.decode(train.sample(model, train.hint_of(inverse_depth[part]), rows[part], arguments.guidance,
                                  arguments.steps, seed=int(part[0]))).clamp(0, 1)
        for part in numpy.array_split(numbers, max(1, len(numbers) // 50))])
    objects = torch.from_numpy(renders.objects[numbers] == 255)
    styles = renders.prompts[numbers, 0]

    texts = embedder.text([[0, 1 + i] for i in range(len(renders.styles))])
    for name, pictures in (("renders", images), ("samples", samples)):
        nearest = (embedder.image(pictures) @ texts.T).argmax(1).numpy()
        share = {style: f"{(nearest[styles == i] == i).mean():.2f}" for i, style in enumerate(renders.styles)}
        print(f"{name}: recognised {(nearest == styles).mean():.3f} {share}, contrast {contrast(pictures, objects):.4f}")
    print(f"contrast of samples / renders {contrast(samples, objects) / contrast(images, objects):.3f}")
    if arguments.sheet:
        chosen = [numbers[styles == i][:6] for i in range(len(renders.styles))]
        train.contact_sheet([torch.cat([images[c], samples[c]]) for c in chosen], arguments.sheet)


if __name__ == "__main__":
    main()
