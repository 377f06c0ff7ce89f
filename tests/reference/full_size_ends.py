# SPDX-License-Identifier: MIT
"""Stable Diffusion 1.5's text encoder and VAE in full size against transformers and diffusers, with random weights.

Needs Python 3.10 or later with PyTorch, transformers 5.24.0, diffusers 0.42.1 and safetensors, 8 GB of memory and 1 GB
of disk:

    cmake --preset release
    cmake --build --preset release --target full_size_ends
    python3 tests/reference/full_size_ends.py FOLDER build/release/tests/full_size_ends

Writes FOLDER in diffusers' layout and what PyTorch makes of it to FOLDER/ends.safetensors. Then each of them runs alone,
PyTorch and the program one after the other on two threads: the fastest of three runs and the peak of memory, weights
included. At last the seams of diffusers' tiles on a latent of 96 x 96, to compare with.
"""

import pathlib
import re
import subprocess
import sys
import time

import torch
from diffusers import AutoencoderKL
from safetensors.torch import load_file, save_file
from transformers import CLIPTextConfig, CLIPTextModel

THREADS = 2
PARTS = "text", "encode", "decode64", "decode96"


def text_encoder(folder):
    return CLIPTextModel.from_pretrained(folder / "text_encoder").eval()


def autoencoder(folder):
    return AutoencoderKL.from_pretrained(folder / "vae").eval()


def write(folder):
    torch.manual_seed(0)
    config = CLIPTextConfig(vocab_size=49408, hidden_size=768, intermediate_size=3072, num_hidden_layers=12,
                            num_attention_heads=12)
    CLIPTextModel(config).save_pretrained(folder / "text_encoder")
    AutoencoderKL(block_out_channels=(128, 256, 512, 512), layers_per_block=2, norm_num_groups=32, sample_size=512,
                  down_block_types=("DownEncoderBlock2D",) * 4,
                  up_block_types=("UpDecoderBlock2D",) * 4).save_pretrained(folder / "vae")
    data = {"ids": torch.randint(0, 49408, (1, 77)), "picture": 2 * torch.rand(1, 3, 512, 512) - 1,
            "z_decode64": torch.randn(1, 4, 64, 64), "z_decode96": torch.randn(1, 4, 96, 96)}
    for part in PARTS:
        data.update(run(folder, part, data)[0])
    data["ids"] = data["ids"].float()
    save_file({name: x.contiguous() for name, x in data.items()}, folder / "ends.safetensors")


def run(folder, part, data, runs=1):
    """What a part gives, and the seconds of the fastest of some runs."""
    if part == "text":
        model = text_encoder(folder)
        body = lambda: {"text": model(data["ids"].long()).last_hidden_state}  # noqa: E731
    else:
        model = autoencoder(folder)
        factor = model.config.scaling_factor

        def encode():
            moments = model.encode(data["picture"]).latent_dist
            return {"mean": moments.mean * factor, "log_variance": moments.logvar + 2 * torch.tensor(factor).log()}

        if part == "encode":
            body = encode
        else:
            del model.encoder
            body = lambda: {part: model.decode(data["z_" + part] / factor).sample}  # noqa: E731
    least = float("inf")
    for _ in range(runs):
        begin = time.time()
        with torch.no_grad():
            result = body()
        least = min(least, time.time() - begin)
    return result, least


def seams(folder):
    """The largest and the mean difference that diffusers' tiles make."""
    data = load_file(folder / "ends.safetensors")
    vae = autoencoder(folder)
    vae.enable_tiling()
    with torch.no_grad():
        tiled = vae.decode(data["z_decode96"] / vae.config.scaling_factor).sample
    whole = data["decode96"]
    difference = (tiled - whole).abs() / (whole.max() - whole.min())
    print(f"diffusers' tiles at 96 x 96: largest difference {difference.max():.2g}, mean {difference.mean():.2g} of the range")


def main():
    folder = pathlib.Path(sys.argv[1])
    torch.set_num_threads(THREADS)
    if len(sys.argv) > 3 and sys.argv[2] == "part":
        part = sys.argv[3]
        _, seconds = run(folder, part, load_file(folder / "ends.safetensors"), 3)
        # Not getrusage, which counts the parent's memory too.
        peak = re.search(r"VmHWM:\s*(\d+)", pathlib.Path("/proc/self/status").read_text())
        print(f"{seconds:.4g} s, at most {int(peak[1]) // 1024} MB")
        return
    if not (folder / "ends.safetensors").exists():
        write(folder)
    is_equal = True
    for part in PARTS:
        print(f"{part}, PyTorch: ", end="", flush=True)
        subprocess.run([sys.executable, __file__, folder, "part", part], check=True)
        print(f"{part}, here: ", end="", flush=True)
        is_equal &= subprocess.run([sys.argv[2], part, folder, str(THREADS)]).returncode == 0
    seams(folder)
    sys.exit(0 if is_equal else 1)


main()
