# SPDX-License-Identifier: MIT
"""Writes data/lora.json: what the public packages diffusers and peft make of a UNet into which a LoRA is fused.

Needs Python 3.10 or later with PyTorch (any recent version, CPU only), diffusers 0.42.1 and peft 0.21.2:

    pip install torch numpy diffusers==0.42.1 transformers peft==0.21.2
    python3 tests/reference/make_lora_golden.py

The tests read the file and never run Python. Weights and factors are golden_values of their names. The same differences
come in the names of kohya (with an alpha), of PEFT and of diffusers' older versions (without).
"""

import pathlib
import sys

import torch
from diffusers import UNet2DConditionModel
from diffusers.loaders import StableDiffusionLoraLoaderMixin as Loader

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "data"))
from golden_data import tensor, write  # noqa: E402

SCALE = 0.7
ALPHA = 1.5
KEPT = 8
# Modules and their ranks: linear layers, a 1x1 convolution, 3x3 convolutions of stride 1 and 2.
MODULES = {
    "down_blocks.0.attentions.0.transformer_blocks.0.attn1.to_q": 2,
    "down_blocks.0.attentions.0.transformer_blocks.0.attn2.to_k": 3,
    "down_blocks.0.attentions.0.transformer_blocks.0.attn1.to_out.0": 2,
    "down_blocks.0.attentions.0.transformer_blocks.0.ff.net.0.proj": 2,
    "down_blocks.0.attentions.0.proj_in": 2,
    "down_blocks.0.resnets.0.conv1": 3,
    "down_blocks.0.downsamplers.0.conv": 1,
    "mid_block.attentions.0.transformer_blocks.0.attn2.to_v": 4,
}


def network():
    unet = UNet2DConditionModel(
        block_out_channels=(8, 12), layers_per_block=1, norm_num_groups=4, cross_attention_dim=6, attention_head_dim=2,
        down_block_types=("CrossAttnDownBlock2D", "DownBlock2D"), up_block_types=("UpBlock2D", "CrossAttnUpBlock2D"))
    with torch.no_grad():
        for name, parameter in unet.named_parameters():
            parameter.copy_(tensor("lora.base." + name, *parameter.shape))
    return unet


def factors(module, rank, weight):
    """The shapes and values of down and up."""
    down = [rank, weight.shape[1], *weight.shape[2:]]
    up = [weight.shape[0], rank] + [1] * (weight.dim() - 2)
    return tensor(f"lora.down.{module}", *down).float(), tensor(f"lora.up.{module}", *up).float()


def main():
    shapes = {name: list(x.shape) for name, x in network().named_parameters()}
    forms = {"kohya": {}, "peft": {}, "older": {}}
    for module, rank in MODULES.items():
        weight = torch.empty(shapes[module + ".weight"])
        down, up = factors(module, rank, weight)
        key = "lora_unet_" + module.replace(".", "_")
        forms["kohya"] |= {f"{key}.lora_down.weight": down, f"{key}.lora_up.weight": up,
                           f"{key}.alpha": torch.tensor(ALPHA)}
        forms["peft"] |= {f"unet.{module}.lora_A.weight": down, f"unet.{module}.lora_B.weight": up}
        forms["older"] |= {f"unet.{module}.lora.down.weight": down, f"unet.{module}.lora.up.weight": up}
    fused = {}
    for form, state in forms.items():
        unet = network()
        converted, alphas = Loader.lora_state_dict(dict(state))
        Loader.load_lora_into_unet(converted, alphas, unet)
        unet.fuse_lora(lora_scale=SCALE)
        weights = dict(unet.named_parameters())
        fused[form] = {}
        for module in MODULES:
            x = weights[module + ".base_layer.weight"].detach().flatten()
            step = max(1, x.numel() // KEPT)
            fused[form][module] = [float(value) for value in x[::step][:KEPT]]
    assert fused["peft"] == fused["older"] != fused["kohya"]
    del fused["older"]
    write("lora.json", {
        "scale": SCALE,
        "alpha": ALPHA,
        "modules": [{"name": module, "rank": rank, "shape": shapes[module + ".weight"]}
                    for module, rank in MODULES.items()],
        "fused": fused,
    })


if __name__ == "__main__":
    main()
