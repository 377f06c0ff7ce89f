# SPDX-License-Identifier: MIT
"""Writes data/compvis_names.json: what the public package diffusers calls the tensors of single-file checkpoints.

Needs Python 3.10 or later with PyTorch (any recent version, CPU only), diffusers 0.42.1 and transformers:

    pip install torch numpy diffusers==0.42.1 transformers
    python3 tests/reference/make_compvis_golden.py

The tests read the file and never run Python. The names in CompVis' code are written down here from its layout, each
tensor gets a number of its own as its only value, and diffusers' own converters say where the number comes out. Both
sides are checked: every tensor of diffusers' models at the sizes of Stable Diffusion 1.5 and 2.1 comes out of one of a
checkpoint, in its shape, and no tensor of a checkpoint is left.

Names are of modules, the tensors in them a letter each: w(eight), b(ias).
"""

import json
import pathlib

import torch
from diffusers import AutoencoderKL, ControlNetModel, UNet2DConditionModel
from diffusers.loaders.single_file_utils import (
    convert_controlnet_checkpoint,
    convert_ldm_clip_checkpoint,
    convert_ldm_unet_checkpoint,
    convert_ldm_vae_checkpoint,
    convert_open_clip_checkpoint,
)
from transformers import CLIPTextConfig, CLIPTextModel

CHANNELS = [320, 640, 1280, 1280]
ATTENTION = [True, True, True, False]


def resnet(to, at, i, o):
    to.update({f"{at}.in_layers.0": ["wb", i], f"{at}.in_layers.2": ["wb", o, i, 3, 3]})
    to.update({f"{at}.emb_layers.1": ["wb", o, 1280], f"{at}.out_layers.0": ["wb", o]})
    to.update({f"{at}.out_layers.3": ["wb", o, o, 3, 3]})
    if i != o:
        to[f"{at}.skip_connection"] = ["wb", o, i, 1, 1]


def attention(to, at, c, context, linear):
    to.update({f"{at}.norm": ["wb", c]})
    for name in ("proj_in", "proj_out"):
        to[f"{at}.{name}"] = ["wb", c, c] if linear else ["wb", c, c, 1, 1]
    at += ".transformer_blocks.0"
    for name, width in (("attn1", c), ("attn2", context)):
        to.update({f"{at}.{name}.to_q": ["w", c, c], f"{at}.{name}.to_k": ["w", c, width]})
        to.update({f"{at}.{name}.to_v": ["w", c, width], f"{at}.{name}.to_out.0": ["wb", c, c]})
    to.update({f"{at}.ff.net.0.proj": ["wb", 8 * c, c], f"{at}.ff.net.2": ["wb", c, 4 * c]})
    to.update({f"{at}.norm{i}": ["wb", c] for i in (1, 2, 3)})


def unet(context, linear, control=False):
    """openaimodel.UNetModel, or cldm.ControlNet."""
    to = {"time_embed.0": ["wb", 1280, 320], "time_embed.2": ["wb", 1280, 1280], "input_blocks.0.0": ["wb", 320, 4, 3, 3]}
    c, n, skips = 320, 1, [320]
    for level, channels in enumerate(CHANNELS):
        for _ in range(2):
            resnet(to, f"input_blocks.{n}.0", c, channels)
            c = channels
            if ATTENTION[level]:
                attention(to, f"input_blocks.{n}.1", c, context, linear)
            skips.append(c)
            n += 1
        if level < 3:
            to[f"input_blocks.{n}.0.op"] = ["wb", c, c, 3, 3]
            skips.append(c)
            n += 1
    resnet(to, "middle_block.0", c, c)
    attention(to, "middle_block.1", c, context, linear)
    resnet(to, "middle_block.2", c, c)
    if control:
        to.update({f"zero_convs.{i}.0": ["wb", s, s, 1, 1] for i, s in enumerate(skips)})
        to["middle_block_out.0"] = ["wb", c, c, 1, 1]
        hint = [3, 16, 16, 32, 32, 96, 96, 256, 320]
        to.update({f"input_hint_block.{2 * i}": ["wb", hint[i + 1], hint[i], 3, 3] for i in range(8)})
        return to
    n = 0
    for level in (3, 2, 1, 0):
        for i in range(3):
            resnet(to, f"output_blocks.{n}.0", c + skips.pop(), CHANNELS[level])
            c = CHANNELS[level]
            if ATTENTION[level]:
                attention(to, f"output_blocks.{n}.1", c, context, linear)
            if level > 0 and i == 2:
                to[f"output_blocks.{n}.{2 if ATTENTION[level] else 1}.conv"] = ["wb", c, c, 3, 3]
            n += 1
    to.update({"out.0": ["wb", 320], "out.2": ["wb", 4, 320, 3, 3]})
    return to


def vae():
    """model.Encoder and model.Decoder of AutoencoderKL."""
    to = {"quant_conv": ["wb", 8, 8, 1, 1], "post_quant_conv": ["wb", 4, 4, 1, 1]}

    def block(at, i, o):
        to.update({f"{at}.norm1": ["wb", i], f"{at}.conv1": ["wb", o, i, 3, 3]})
        to.update({f"{at}.norm2": ["wb", o], f"{at}.conv2": ["wb", o, o, 3, 3]})
        if i != o:
            to[f"{at}.nin_shortcut"] = ["wb", o, i, 1, 1]

    channels = [128, 256, 512, 512]
    for side, first, last in (("encoder", 3, 8), ("decoder", 4, 3)):
        begin, end = (128, 512) if side == "encoder" else (512, 128)
        to[f"{side}.conv_in"] = ["wb", begin, first, 3, 3]
        for i in (1, 2):
            block(f"{side}.mid.block_{i}", 512, 512)
        to[f"{side}.mid.attn_1.norm"] = ["wb", 512]
        to.update({f"{side}.mid.attn_1.{x}": ["wb", 512, 512, 1, 1] for x in ("q", "k", "v", "proj_out")})
        to.update({f"{side}.norm_out": ["wb", end], f"{side}.conv_out": ["wb", last, end, 3, 3]})
    c = 128
    for level in range(4):
        for i in range(2):
            block(f"encoder.down.{level}.block.{i}", c, channels[level])
            c = channels[level]
        if level < 3:
            to[f"encoder.down.{level}.downsample.conv"] = ["wb", c, c, 3, 3]
    for level in (3, 2, 1, 0):
        for i in range(3):
            block(f"decoder.up.{level}.block.{i}", c, channels[level])
            c = channels[level]
        if level > 0:
            to[f"decoder.up.{level}.upsample.conv"] = ["wb", c, c, 3, 3]
    return to


def clip():
    to = {"embeddings.token_embedding": ["w", 49408, 768], "embeddings.position_embedding": ["w", 77, 768]}
    for i in range(12):
        at = f"encoder.layers.{i}"
        to.update({f"{at}.self_attn.{x}": ["wb", 768, 768] for x in ("q_proj", "k_proj", "v_proj", "out_proj")})
        to.update({f"{at}.layer_norm1": ["wb", 768], f"{at}.layer_norm2": ["wb", 768]})
        to.update({f"{at}.mlp.fc1": ["wb", 3072, 768], f"{at}.mlp.fc2": ["wb", 768, 3072]})
    return {f"text_model.{name}": value for name, value in (to | {"final_layer_norm": ["wb", 768]}).items()}


def open_clip():
    """open_clip's text tower of ViT-H-14: 24 layers, of which diffusers has all but the last."""
    to = {"token_embedding": ["w", 49408, 1024], "positional_embedding": ["", 77, 1024], "ln_final": ["wb", 1024]}
    to["text_projection"] = ["", 1024, 1024]
    for i in range(24):
        at = f"transformer.resblocks.{i}"
        to.update({f"{at}.attn.in_proj_": ["wb", 3072, 1024], f"{at}.attn.out_proj": ["wb", 1024, 1024]})
        to.update({f"{at}.ln_1": ["wb", 1024], f"{at}.ln_2": ["wb", 1024]})
        to.update({f"{at}.mlp.c_fc": ["wb", 4096, 1024], f"{at}.mlp.c_proj": ["wb", 1024, 4096]})
    return to


def tensors(prefix, modules):
    """Every tensor of a checkpoint, no two of the same value; a value takes one number of memory."""
    named = {}
    for module, (letters, *shape) in modules.items():
        for letter in letters or " ":
            suffix = {"w": "weight", "b": "bias", " ": ""}[letter]
            dot = "" if module.endswith("_") or not suffix else "."
            full = shape if letter != "b" else shape[:1]
            named[prefix + module + dot + suffix] = torch.full([1] * len(full), float(len(named))).expand(full)
    return named


def is_ours(name):
    return not name.endswith(("position_ids", "text_projection.weight"))


def pairs(checkpoint, converted, model):
    """[stored module, diffusers' module, letters, change] for all, checked from both sides."""
    expected = {name: list(x.shape) for name, x in model.state_dict().items() if is_ours(name)}
    # What this version of transformers leaves out at the beginning of the names, files have.
    if "embeddings.token_embedding.weight" in expected:
        expected = {f"text_model.{name}": shape for name, shape in expected.items()}
    converted = {name: x for name, x in converted.items() if is_ours(name)}
    shapes = {name: list(x.shape) for name, x in converted.items()}
    assert shapes == expected, (set(shapes) ^ set(expected), [n for n in shapes if shapes[n] != expected.get(n)])
    stored = {float(x.flatten()[0]): (name, x) for name, x in checkpoint.items()}
    result, used, seen = {}, set(), {}
    for name, x in converted.items():
        from_name, from_tensor = stored[float(x.flatten()[0])]
        used.add(from_name)
        change = ""
        if from_tensor.shape[0] == 3 * x.shape[0] and from_name.split(".")[-1].startswith("in_proj"):
            change = "third " + str(["q_proj", "k_proj", "v_proj"].index(name.split(".")[-2]))
        elif from_tensor.dim() == 4 and x.dim() == 2:
            change = "matrix"
        elif from_tensor.shape != x.shape:
            raise AssertionError(name)
        from_module, letter = from_name, ""
        for suffix in ("weight", "bias"):
            if from_name.endswith(suffix):
                from_module, letter = from_name.removesuffix(suffix), suffix[0]
        module = name.removesuffix("weight").removesuffix("bias")
        if not letter:
            module, letter = name, "whole"
        # Matrices have a letter of their own, so that weight and bias of a module are one line.
        if change == "matrix":
            letter, change = "m", ""
        result.setdefault((from_module, module, change), []).append(letter)
    return [[*key[:2], "".join(sorted(letters, reverse=True)) if "whole" not in letters else "whole", key[2]]
            for key, letters in result.items()], sorted(set(checkpoint) - used)


def sd_unet(context, linear, heads):
    return UNet2DConditionModel(cross_attention_dim=context, use_linear_projection=linear, attention_head_dim=heads)


def main():
    with torch.device("meta"):
        models = {
            "unet": sd_unet(768, False, 8),
            "unet_2": sd_unet(1024, True, [5, 10, 20, 20]),
            "controlnet": ControlNetModel(cross_attention_dim=768, attention_head_dim=8),
            "vae": AutoencoderKL(block_out_channels=(128, 256, 512, 512), layers_per_block=2,
                                 down_block_types=["DownEncoderBlock2D"] * 4, up_block_types=["UpDecoderBlock2D"] * 4),
            "clip": CLIPTextModel(CLIPTextConfig(hidden_size=768, intermediate_size=3072, num_hidden_layers=12)),
            "open_clip": CLIPTextModel(CLIPTextConfig(hidden_size=1024, intermediate_size=4096, num_hidden_layers=23,
                                                      num_attention_heads=16, hidden_act="gelu")),
        }
    checkpoints = {
        "unet": tensors("model.diffusion_model.", unet(768, False)),
        "unet_2": tensors("model.diffusion_model.", unet(1024, True)),
        "controlnet": tensors("control_model.", unet(768, False, control=True)),
        "vae": tensors("first_stage_model.", vae()),
        "clip": tensors("cond_stage_model.transformer.", clip()),
        "open_clip": tensors("cond_stage_model.model.", open_clip()),
    }
    convert = {
        "unet": lambda x: convert_ldm_unet_checkpoint(x, {"layers_per_block": 2}),
        "unet_2": lambda x: convert_ldm_unet_checkpoint(x, {"layers_per_block": 2}),
        "controlnet": lambda x: convert_controlnet_checkpoint(x, {"layers_per_block": 2}),
        "vae": lambda x: convert_ldm_vae_checkpoint(
            x, {"down_block_types": [0] * 4, "up_block_types": [0] * 4}),
        "clip": convert_ldm_clip_checkpoint,
        "open_clip": lambda x: convert_open_clip_checkpoint(models["open_clip"], x),
    }
    golden = {}
    for name, checkpoint in checkpoints.items():
        lines, left = pairs(checkpoint, convert[name](dict(checkpoint)), models[name])
        golden[name] = {"pairs": lines, "left": left}
        assert all("text_projection" in x or "resblocks.23" in x for x in left), left
    # 2.x has the names of 1.x: it is enough to keep one list.
    assert golden.pop("unet_2") == golden["unet"]
    text = ",\n".join(
        f'"{name}": {{"left": {json.dumps(part["left"])}, "pairs": [\n'
        + ",\n".join(json.dumps(line, separators=(",", ":")) for line in part["pairs"]) + "\n]}"
        for name, part in golden.items())
    path = pathlib.Path(__file__).resolve().parents[1] / "data" / "compvis_names.json"
    path.write_text("{\n" + text + "\n}\n")
    print(path.stat().st_size, {name: len(part["pairs"]) for name, part in golden.items()})


if __name__ == "__main__":
    main()
