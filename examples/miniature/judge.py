# SPDX-License-Identifier: MIT
"""Says how good the miniature is on scenes and paints that training never showed, one picture at a time.

    python3 judge.py --data trained/pictures --held-out trained/held_out --weights weights --out judged

Prints the autoencoder's error, the share of renders and of samples whose pattern and whose colours a classifier
recognises, and the contrast inside subjects of both; writes a sheet for each pattern: renders above, samples for the same
depth and caption below. The samples are those of diffusers' own pipeline.
"""

import argparse
import pathlib
import time

import numpy
import torch
from diffusers import StableDiffusionControlNetPipeline
from PIL import Image

from autoencoder import peak_signal_to_noise, round_trip
from classifier import recognised, train_classifier
from pictures import Pictures, contact_sheet


def contrast(images, masks):
    """Standard deviation of the colours of the pixels that subjects fill, averaged over images."""
    deviations = []
    for image, mask in zip(images, masks):
        pixels = image[:, mask]
        if pixels.shape[1] >= 64:
            deviations.append(pixels.var(1, unbiased=False).mean().sqrt())
    return torch.stack(deviations).mean().item()


def samples_of(pipeline, pictures, numbers, steps, guidance, batch=16):
    """Images [pictures, 3, 128, 128] in [0, 1] for the depth and captions of the pictures, each with noise of its own."""
    found = []
    for part in numpy.array_split(numbers, max(1, len(numbers) // batch)):
        depth = [Image.fromarray(numpy.round(255 * d.numpy()).astype(numpy.uint8)).convert("RGB")
                 for d in pictures.depth_of(part)]
        images = pipeline([pictures.captions[n] for n in part], image=depth, num_inference_steps=steps,
                          guidance_scale=guidance, height=128, width=128, output_type="np",
                          generator=[torch.Generator().manual_seed(int(n)) for n in part]).images
        found.append(torch.from_numpy(images).permute(0, 3, 1, 2).float())
    return torch.cat(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", required=True, type=pathlib.Path, help="pictures to train the classifier on")
    parser.add_argument("--held-out", required=True, type=pathlib.Path, help="make_pictures --held-out --full-captions")
    parser.add_argument("--weights", required=True, type=pathlib.Path)
    parser.add_argument("--out", required=True, type=pathlib.Path, help="folder of the sheets and the classifier")
    parser.add_argument("--count", type=int, default=300, help="of held-out scenes")
    parser.add_argument("--steps", type=int, default=20)
    parser.add_argument("--guidance", type=float, default=3.0)
    parser.add_argument("--classifier-steps", type=int, default=2500)
    parser.add_argument("--threads", type=int, default=0, help="0 = all of the machine")
    arguments = parser.parse_args()
    if arguments.threads:
        torch.set_num_threads(arguments.threads)
    arguments.out.mkdir(parents=True, exist_ok=True)
    held_out = Pictures(arguments.held_out)
    classifier = train_classifier(Pictures(arguments.data), arguments.out / "classifier.pt", arguments.classifier_steps)
    pipeline = StableDiffusionControlNetPipeline.from_pretrained(arguments.weights, torch_dtype=torch.float32)
    pipeline.set_progress_bar_config(disable=True)

    numbers = numpy.arange(min(arguments.count, len(held_out)))
    images = held_out.colours_of(numbers)
    masks = torch.from_numpy(held_out.subjects[numbers] == 255)
    seen = torch.cat([round_trip(pipeline.vae, part) for part in images.split(32)])
    print(f"autoencoder: held-out PSNR {peak_signal_to_noise(images, seen):.2f} dB")
    contact_sheet([images[:8], seen[:8], images[8:16], seen[8:16]], arguments.out / "round_trips.png", 2)
    began = time.time()
    samples = samples_of(pipeline, held_out, numbers, arguments.steps, arguments.guidance)
    print(f"{(time.time() - began) / len(numbers):.2f} s a sample")

    kinds = held_out.labels["pattern"][numbers]
    for name, pictures in (("renders", images), ("round trips", seen), ("samples", samples)):
        pattern, colours = recognised(classifier, pictures, held_out, numbers)
        each = ", ".join(f"{p} {pattern[kinds == i].mean():.2f} / {colours[kinds == i].mean():.2f}"
                         for i, p in enumerate(held_out.patterns) if (kinds == i).any())
        print(f"{name}: pattern {pattern.mean():.3f}, colours {colours.mean():.3f} ({each}), "
              f"contrast {contrast(pictures, masks):.4f}")
    print(f"contrast of samples / renders {contrast(samples, masks) / contrast(images, masks):.3f}")
    for i, pattern in enumerate(held_out.patterns):
        chosen = numbers[kinds == i][:16]
        if len(chosen):
            rows = [part for k in range(0, len(chosen), 8) for part in (images[chosen[k:k + 8]], samples[chosen[k:k + 8]])]
            width = max(len(row) for row in rows)
            rows = [torch.cat([row, torch.ones(width - len(row), *row.shape[1:])]) for row in rows]
            contact_sheet(rows, arguments.out / f"sheet_{pattern}.png", 2)
            (arguments.out / f"sheet_{pattern}.txt").write_text("".join(held_out.captions[n] + "\n" for n in chosen))


if __name__ == "__main__":
    main()
