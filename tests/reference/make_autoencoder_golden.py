# SPDX-License-Identifier: MIT
"""Writes data/autoencoder.json: what the public package diffusers computes for small autoencoders.

Needs Python 3.10 or later with PyTorch (any recent version, CPU only), numpy and diffusers 0.42.1:

    pip install torch numpy diffusers==0.42.1
    python3 tests/reference/make_autoencoder_golden.py

The tests read the file and never run Python. Weights and inputs are the numbers of golden_network.hpp. Each autoencoder
runs in single and in double precision; latents are in the diffusion's scale.
"""

import json
import math
import pathlib
import sys

import diffusers
import torch
from diffusers import AutoencoderKL

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "data"))
from golden_data import fill, numbers, tensor, write  # noqa: E402


def outputs(vae, z, picture):
    """The picture of a latent; mean and log variance of a picture's latent."""
    factor, shift = vae.config.scaling_factor, vae.config.shift_factor or 0
    moments = vae.encode(picture).latent_dist
    return (vae.decode(z / factor + shift).sample, (moments.mean - shift) * factor,
            moments.logvar + 2 * math.log(factor))


def case(name, *, grid, **config):
    levels = len(config["block_out_channels"])
    vae = AutoencoderKL(down_block_types=("DownEncoderBlock2D",) * levels,
                        up_block_types=("UpDecoderBlock2D",) * levels, **config).eval()
    scale = 2 ** (levels - 1)
    z = tensor(name + ".z", 1, config["latent_channels"], *grid)
    picture = tensor(name + ".picture", 1, 3, *(scale * extent for extent in grid))
    with torch.no_grad():
        fill(vae, name + ".")
        single = outputs(vae, z.float(), picture.float())
        double = outputs(vae.double(), z, picture)
    decoded, mean, log_variance = (numbers(*both) for both in zip(single, double))
    return {"name": name, "grid": grid, "config": json.loads(vae.to_json_string()),
            "decoded": decoded, "mean": mean, "log_variance": log_variance}


write("autoencoder.json", {
    "computed_by": f"diffusers {diffusers.__version__}",
    "written_by": "tests/reference/make_autoencoder_golden.py",
    "cases": [
        # All of Stable Diffusion 1.x but the number of channels.
        case("vae_sd1", grid=(5, 7), block_out_channels=(8, 16, 32, 32), layers_per_block=2, latent_channels=4,
             norm_num_groups=4, sample_size=64),
        # What others leave out or do otherwise.
        case("vae_bare", grid=(6, 4), block_out_channels=(12, 16, 20), layers_per_block=1, latent_channels=8,
             norm_num_groups=4, mid_block_add_attention=False, use_quant_conv=False, use_post_quant_conv=False,
             scaling_factor=0.625, shift_factor=0.125),
    ]})
