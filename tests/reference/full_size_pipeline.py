# SPDX-License-Identifier: MIT
"""A folder as large as Stable Diffusion 1.5 with a ControlNet, with random weights in half precision, to see that the program
takes it and what it needs: no picture of worth comes out.

Needs Python 3.10 or later with PyTorch, diffusers 0.42.1, transformers 5.24.0 and open_clip (for CLIP's vocabulary), 8 GB of
memory and 3 GB of disk:

    cmake --workflow --preset demo
    python3 tests/reference/full_size_pipeline.py FOLDER
    /usr/bin/time -v build/demo/examples/generative_rendering --pipeline FOLDER --scene camera_rotation --frames 1 --steps 2 \
        --prompt "any words" --out FOLDER/out
"""

import gc
import json
import pathlib
import sys

import torch
from clip_tokenizer_parity import clip_merges, clip_vocabulary
from diffusers import AutoencoderKL, ControlNetModel, UNet2DConditionModel
from transformers import CLIPTextConfig, CLIPTextModel


def write(model, folder):
    """In half precision, as most people have it."""
    model.half().save_pretrained(folder)
    gc.collect()


def main():
    folder = pathlib.Path(sys.argv[1])
    torch.manual_seed(0)
    control = ControlNetModel(cross_attention_dim=768)
    with torch.no_grad():
        for parameter in control.parameters():
            if not parameter.any():
                parameter.normal_(0, 0.02)  # 'zero convolutions' would add nothing
    write(control, folder / "controlnet")
    del control
    write(UNet2DConditionModel(cross_attention_dim=768, sample_size=64), folder / "unet")
    write(AutoencoderKL(block_out_channels=(128, 256, 512, 512), layers_per_block=2, norm_num_groups=32, sample_size=512,
                        down_block_types=("DownEncoderBlock2D",) * 4, up_block_types=("UpDecoderBlock2D",) * 4),
          folder / "vae")
    write(CLIPTextModel(CLIPTextConfig(vocab_size=49408, hidden_size=768, intermediate_size=3072, num_hidden_layers=12,
                                       num_attention_heads=12)), folder / "text_encoder")
    (folder / "scheduler").mkdir(exist_ok=True)
    (folder / "scheduler" / "scheduler_config.json").write_text(json.dumps({
        "_class_name": "PNDMScheduler", "beta_start": 0.00085, "beta_end": 0.012, "beta_schedule": "scaled_linear",
        "num_train_timesteps": 1000, "prediction_type": "epsilon"}))
    merges = clip_merges()
    tokenizer = folder / "tokenizer"
    tokenizer.mkdir(exist_ok=True)
    (tokenizer / "vocab.json").write_text(json.dumps(clip_vocabulary(merges)), encoding="utf-8")
    (tokenizer / "merges.txt").write_text("#version: 0.2\n" + "\n".join(merges) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
