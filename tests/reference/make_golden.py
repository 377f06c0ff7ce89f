# SPDX-License-Identifier: MIT
"""Writes data/diffusers.json: what the public package diffusers computes for the networks of the tests.

Needs Python 3.10 or later with PyTorch (any recent version, CPU only) and diffusers 0.42.1:

    pip install torch numpy diffusers==0.42.1
    python3 tests/reference/make_golden.py

The tests read the file and never run Python. Weights and inputs are the numbers of golden_network.hpp: scrambled
addresses, which need no random number generator on either side. Each network runs twice: in single precision
as diffusers is, and in double precision with the sinusoids of time in double too, which diffusers always makes in
single.
"""

import json
import math
import pathlib
import sys

import diffusers
import torch
from diffusers import ControlNetModel, UNet2DConditionModel

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "data"))
from golden_data import fill, numbers, tensor, write  # noqa: E402


class DoubleTimesteps(torch.nn.Module):
    """diffusers' Timesteps with flip_sin_to_cos and downscale_freq_shift = 0, in double precision."""

    def __init__(self, channels):
        super().__init__()
        half = channels // 2
        self.frequencies = torch.exp(-math.log(10000) * torch.arange(half, dtype=torch.float64) / half)

    def forward(self, timesteps):
        phase = timesteps.double()[:, None] * self.frequencies
        return torch.cat([phase.cos(), phase.sin()], dim=-1)


def outputs(unet, control, z, t, prompt, hint, scale):
    """The UNet alone and with the ControlNet."""
    alone = unet(z, t, prompt).sample
    down, middle = control(z, t, prompt, hint, conditioning_scale=scale, return_dict=False)
    return alone, unet(z, t, prompt, down_block_additional_residuals=down, mid_block_additional_residual=middle).sample


def case(name, *, grid, tokens, t, scale, embedding, out_channels, ups=None, unet=None, control=None, **shared):
    """One golden_case. The way up mirrors the way down unless `ups` says otherwise."""
    conditioning = {"conditioning_embedding_out_channels": embedding, **(control or {})}
    ups = ups or [kind.replace("Down", "Up") for kind in reversed(shared["down_block_types"])]
    unet = UNet2DConditionModel(out_channels=out_channels, up_block_types=ups, **shared, **(unet or {})).eval()
    control = ControlNetModel(**shared, **conditioning).eval()
    with torch.no_grad():
        for model, prefix in (unet, name + ".unet."), (control, name + ".controlnet."):
            fill(model, prefix)
        factor = 2 ** (len(embedding) - 1)
        inputs = (
            tensor(name + ".z", 1, shared["in_channels"], *grid), t,
            tensor(name + ".prompt", 1, tokens, shared["cross_attention_dim"]),
            tensor(name + ".hint", 1, control.config.conditioning_channels, *(factor * extent for extent in grid)),
            scale)
        single = outputs(unet, control, *(x.float() if torch.is_tensor(x) else x for x in inputs))
        for model in unet.double(), control.double():
            model.time_proj = DoubleTimesteps(shared["block_out_channels"][0])
        double = outputs(unet, control, *inputs)
    alone, controlled = (numbers(*both) for both in zip(single, double))
    return {"name": name, "grid": grid, "tokens": tokens, "t": t, "scale": scale,
            "unet": json.loads(unet.to_json_string()), "controlnet": json.loads(control.to_json_string()),
            "alone": alone, "controlled": controlled}


cases = [
    # Twelve channels, attention at one level and the bottom, a hint as large as the latents.
    case("tiny", grid=(16, 24), tokens=3, t=417.5, scale=1.0, embedding=(32,), in_channels=12, out_channels=12,
         block_out_channels=(32, 64, 56), layers_per_block=1, attention_head_dim=(1, 2, 2), cross_attention_dim=48,
         norm_num_groups=8, down_block_types=("DownBlock2D", "CrossAttnDownBlock2D", "DownBlock2D"),
         control={"conditioning_channels": 4}),
    # All of Stable Diffusion 1.5 but the number of channels.
    case("small_sd15", grid=(8, 16), tokens=7, t=981.0, scale=0.75, embedding=(4, 6, 8, 12), in_channels=4,
         out_channels=4, block_out_channels=(16, 24, 32, 32), layers_per_block=2, attention_head_dim=8,
         cross_attention_dim=20, norm_num_groups=8, down_block_types=("CrossAttnDownBlock2D",) * 3 + ("DownBlock2D",)),
    # What Stable Diffusion 2.x does otherwise, and more than one transformer block.
    case("small_sd2", grid=(8, 12), tokens=5, t=17.25, scale=1.5, embedding=(4, 6), in_channels=4, out_channels=4,
         block_out_channels=(8, 12, 16), layers_per_block=2, attention_head_dim=(2, 3, 4), cross_attention_dim=6,
         norm_num_groups=4, down_block_types=("CrossAttnDownBlock2D",) * 2 + ("DownBlock2D",),
         use_linear_projection=True, transformer_layers_per_block=2),
    # Attention at the finest level on the way up alone, and none at the coarsest but the middle's.
    case("uneven", grid=(8, 4), tokens=4, t=600.0, scale=1.0, embedding=(2, 4), in_channels=4, out_channels=4,
         block_out_channels=(8, 12), layers_per_block=1, attention_head_dim=(1, 3), cross_attention_dim=6,
         norm_num_groups=4, down_block_types=("DownBlock2D", "CrossAttnDownBlock2D"),
         ups=("UpBlock2D", "CrossAttnUpBlock2D")),
]
write("diffusers.json", {"computed_by": f"diffusers {diffusers.__version__}",
                         "written_by": "tests/reference/make_golden.py", "cases": cases})
