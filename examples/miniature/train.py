# SPDX-License-Identifier: MIT
"""Trains the miniature Stable Diffusion from nothing: pictures, autoencoder, tokenizer, and text encoder, UNet and depth
ControlNet together.

    python3 train.py --out trained --make-pictures build/release/examples/make_pictures

A run that was stopped goes on where its last checkpoint was, and ends with the same weights.
"""

import argparse
import pathlib
import shutil
import subprocess

import torch

from autoencoder import train_autoencoder
from caption_tokenizer import write_tokenizer
from denoiser import train_denoiser
from pictures import Pictures
from training_run import keep_freed_memory

STAGES = ("data", "vae", "tokenizer", "denoiser")


def make_pictures(program, folder, count, seed, *more):
    """Pictures in a folder, unless they are there."""
    if not (folder / "pictures.json").exists():
        if program is None:
            raise SystemExit(f"train.py: {folder} holds no pictures, expected them or --make-pictures")
        subprocess.run([program, "--out", folder, "--count", str(count), "--seed", str(seed), *more], check=True)
    return Pictures(folder)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", required=True, type=pathlib.Path, help="folder of weights, pictures and checkpoints")
    parser.add_argument("--make-pictures", type=pathlib.Path, help="the program of that name")
    parser.add_argument("--until", choices=STAGES, default=STAGES[-1], help="the last stage to run")
    parser.add_argument("--pictures", type=int, default=32768)
    parser.add_argument("--vae-steps", type=int, default=4000)
    parser.add_argument("--steps", type=int, default=9000, help="of the denoiser")
    parser.add_argument("--batch", type=int, default=32, help="of the denoiser")
    parser.add_argument("--rate", type=float, default=1e-3, help="highest learning rate of the denoiser")
    parser.add_argument("--every", type=int, default=100, help="steps between two lines of progress")
    parser.add_argument("--begin", type=pathlib.Path, help="a pipeline whose denoiser is trained on, and whose autoencoder "
                        "and tokenizer are used")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=0, help="0 = all of the machine")
    parser.add_argument("--precision", choices=("bfloat16", "float32"), default="bfloat16", help="of products")
    parser.add_argument("--compile", action="store_true", help="faster where there is a C++ compiler")
    arguments = parser.parse_args()
    if arguments.threads:
        torch.set_num_threads(arguments.threads)
    out, last = arguments.out, STAGES.index(arguments.until)
    out.mkdir(parents=True, exist_ok=True)
    precision = getattr(torch, arguments.precision)
    keep_freed_memory()

    pictures = make_pictures(arguments.make_pictures, out / "pictures", arguments.pictures, arguments.seed + 1)
    held_out = make_pictures(arguments.make_pictures, out / "held_out", 1000, arguments.seed + 2, "--held-out",
                             "--full-captions")
    if arguments.begin is not None:
        for name in ("vae", "tokenizer"):
            if not (out / name).exists():
                shutil.copytree(arguments.begin / name, out / name)
    if last >= 1 and not (out / "vae" / "config.json").exists():
        train_autoencoder(pictures, held_out, out, arguments.vae_steps, arguments.seed, precision, arguments.compile)
    if last >= 2 and not (out / "tokenizer" / "vocab.json").exists():
        write_tokenizer(pictures.captions, out / "tokenizer")
    if last >= 3:
        train_denoiser(pictures, held_out, out, arguments.steps, arguments.seed, precision, arguments.compile,
                       arguments.batch, arguments.rate, arguments.every, arguments.begin)


if __name__ == "__main__":
    main()
