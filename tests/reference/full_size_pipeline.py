# SPDX-License-Identifier: MIT
"""A folder as large as Stable Diffusion 1.5 with a ControlNet, with random weights in half precision, to see that the program
takes it and what it needs: no picture of worth comes out.

Needs Python 3.10 or later with PyTorch, diffusers 0.42.1, transformers 5.24.0 and open_clip (for CLIP's vocabulary), 8 GB of
memory and 6 GB of disk:

    cmake --workflow --preset demo
    python3 tests/reference/full_size_pipeline.py FOLDER
    /usr/bin/time -v build/demo/examples/generative_rendering --pipeline FOLDER --scene camera_rotation --frames 1 --steps 2 \
        --prompt "any words" --out FOLDER/out

The same weights stand in FOLDER/model.safetensors and FOLDER/control.safetensors, as single files in the names of the original
releases, of which the program makes the same frames to the bit:

    build/demo/examples/generative_rendering --pipeline FOLDER/model.safetensors --controlnet FOLDER/control.safetensors \
        --tokenizer FOLDER/tokenizer --scene camera_rotation --frames 1 --steps 2 --prompt "any words" --out FOLDER/out_of_files
    cmp FOLDER/out/frames/0000.png FOLDER/out_of_files/frames/0000.png
"""

import gc
import json
import pathlib
import sys

import torch
from clip_tokenizer_parity import clip_merges, clip_vocabulary
from diffusers import AutoencoderKL, ControlNetModel, UNet2DConditionModel
from safetensors.torch import load_file, save_file
from transformers import CLIPTextConfig, CLIPTextModel


def write(model, folder):
    """In half precision, as most people have it."""
    model.half().save_pretrained(folder)
    gc.collect()


def stored_in_original_names(folder, part, stem, pairs):
    """The tensors of a network by their names in single files."""
    tensors = load_file(folder / part / f"{stem}.safetensors")
    if part == "text_encoder" and "text_model.final_layer_norm.weight" not in tensors:
        tensors = {f"text_model.{name}": tensor for name, tensor in tensors.items()}
    result = {}
    for original, name, kinds, _ in pairs:
        for kind in kinds:
            end = "bias" if kind == "b" else "weight"
            tensor = tensors[name + end]
            if kind == "m":
                tensor = tensor[:, :, None, None]  # the originals have 1 x 1 kernels for these matrices
            result[original + end] = tensor.contiguous()
    return result


def write_single_files(folder):
    names = json.loads((pathlib.Path(__file__).parent.parent / "data" / "compvis_names.json").read_text())
    model = {"alphas_cumprod": torch.zeros(1000)}  # left over from training, as in the originals
    for part, stem, key in (("unet", "diffusion_pytorch_model", "unet"), ("vae", "diffusion_pytorch_model", "vae"),
                            ("text_encoder", "model", "clip")):
        model.update(stored_in_original_names(folder, part, stem, names[key]["pairs"]))
    save_file(model, folder / "model.safetensors")
    control = stored_in_original_names(folder, "controlnet", "diffusion_pytorch_model", names["controlnet"]["pairs"])
    save_file(control, folder / "control.safetensors")


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
    write_single_files(folder)


if __name__ == "__main__":
    main()
