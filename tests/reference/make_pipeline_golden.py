# SPDX-License-Identifier: MIT
"""A pipeline of Stable Diffusion so small that tests can carry it, and the pictures that diffusers makes with it.

Needs Python 3.10 or later with PyTorch, diffusers 0.42.1 and transformers 5.24.0:

    python3 tests/reference/make_pipeline_golden.py tests/data

Writes tiny_pipeline/, a folder in diffusers' layout with random weights in half precision and the tokenizer of
clip_tokenizer/, and pipeline.json: noisy latents, depth pictures, prompts, and what StableDiffusionControlNetPipeline makes
of them by two samplers. Its numbers are computed in single precision, from the same latents at the highest noise level.
"""

import json
import pathlib
import shutil
import sys

import numpy as np
import torch
from diffusers import (AutoencoderKL, ControlNetModel, DPMSolverMultistepScheduler, EulerDiscreteScheduler,
                       StableDiffusionControlNetPipeline, UNet2DConditionModel)
from transformers import CLIPTextConfig, CLIPTextModel, CLIPTokenizer

WIDTH = 32
HEIGHT = 48
STEPS = 4
SCHEDULE = {"beta_start": 0.00085, "beta_end": 0.012, "beta_schedule": "scaled_linear", "num_train_timesteps": 1000,
            "timestep_spacing": "linspace"}
PROMPT = "a red and white ball on a green ground"
NEGATIVE = "grey"


def draw_weights(model, scale):
    """Random weights that neither die nor burst on the way through all layers."""
    with torch.no_grad():
        for name, parameter in model.named_parameters():
            if parameter.dim() > 1:
                fan = parameter[0].numel()
                parameter.copy_(torch.randn_like(parameter) * scale / fan ** 0.5)
            elif "norm" in name and name.endswith("weight"):
                parameter.copy_(1 + 0.1 * torch.randn_like(parameter))
            else:
                parameter.copy_(0.1 * torch.randn_like(parameter))
            parameter.copy_(parameter.half().float())
    return model.eval()


def networks(folder):
    """The four networks and the tokenizer of the pipeline."""
    torch.manual_seed(11)
    tokenizer = CLIPTokenizer.from_pretrained(folder / "clip_tokenizer", model_max_length=77)
    shared = {"block_out_channels": (8, 16), "down_block_types": ("CrossAttnDownBlock2D", "DownBlock2D"),
              "layers_per_block": 1, "cross_attention_dim": 16, "attention_head_dim": 2, "norm_num_groups": 4,
              "in_channels": 4}
    unet = draw_weights(UNet2DConditionModel(
        sample_size=8, out_channels=4, up_block_types=("UpBlock2D", "CrossAttnUpBlock2D"), **shared), 1)
    control = draw_weights(ControlNetModel(conditioning_embedding_out_channels=(4, 8, 8), **shared), 1)
    vae = draw_weights(AutoencoderKL(
        block_out_channels=(8, 8, 16), down_block_types=("DownEncoderBlock2D",) * 3,
        up_block_types=("UpDecoderBlock2D",) * 3, layers_per_block=1, latent_channels=4, norm_num_groups=4,
        scaling_factor=0.3), 1)
    text = draw_weights(CLIPTextModel(CLIPTextConfig(
        vocab_size=len(tokenizer), hidden_size=16, intermediate_size=32, num_hidden_layers=2, num_attention_heads=2,
        max_position_embeddings=77, hidden_act="quick_gelu", bos_token_id=tokenizer.bos_token_id,
        eos_token_id=tokenizer.eos_token_id, pad_token_id=tokenizer.pad_token_id)), 1)
    return tokenizer, unet, control, vae, text


def main():
    folder = pathlib.Path(sys.argv[1])
    tokenizer, unet, control, vae, text = networks(folder)
    pipeline = StableDiffusionControlNetPipeline(
        vae=vae, text_encoder=text, tokenizer=tokenizer, unet=unet, controlnet=control,
        scheduler=EulerDiscreteScheduler(use_karras_sigmas=True, **SCHEDULE), safety_checker=None,
        feature_extractor=None, requires_safety_checker=False)
    target = folder / "tiny_pipeline"
    shutil.rmtree(target, ignore_errors=True)
    pipeline.to(torch.float16).save_pretrained(target)
    pipeline.to(torch.float32)
    pipeline.set_progress_bar_config(disable=True)

    generator = np.random.default_rng(5)
    latents = generator.standard_normal((2, 4, HEIGHT // 4, WIDTH // 4)).astype(np.float32)
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH]
    depth = np.stack([np.clip(255 - 6 * np.hypot(rows - HEIGHT / 2, columns - 12 - 8 * i), 0, 255) for i in range(2)])
    depth = depth.astype(np.uint8)
    result = {"prompt": PROMPT, "negative": NEGATIVE, "steps": STEPS, "guidance": 5.0,
              "latents": [float(x) for x in latents.ravel()], "latents_shape": list(latents.shape),
              "depth": depth.ravel().tolist(), "depth_shape": list(depth.shape), "pictures": {}}
    euler = EulerDiscreteScheduler(use_karras_sigmas=True, **SCHEDULE)
    dpmpp_2m = DPMSolverMultistepScheduler(use_karras_sigmas=True, algorithm_type="dpmsolver++", solver_order=2, **SCHEDULE)
    for name, scheduler in (("euler", euler), ("dpmpp_2m", dpmpp_2m)):
        pipeline.scheduler = scheduler
        scheduler.set_timesteps(STEPS)
        sigma = float(scheduler.sigmas[0])
        # z = sigma n; a pipeline scales what it is given by init_noise_sigma, DPM-Solver's latents are divided by the
        # deviation of noised data.
        given = latents if scheduler is euler else latents * sigma / (sigma ** 2 + 1) ** 0.5
        pictures = []
        for i in range(2):
            image = torch.from_numpy(depth[i]).float()[None, None].repeat(1, 3, 1, 1) / 255
            out = pipeline(prompt=PROMPT, negative_prompt=NEGATIVE, image=image, height=HEIGHT, width=WIDTH,
                           num_inference_steps=STEPS, guidance_scale=5.0,
                           latents=torch.from_numpy(given[i:i + 1]), output_type="np").images[0]
            pictures.append(np.round(out.transpose(2, 0, 1) * 255).astype(int))
        pictures = np.stack(pictures)
        print(name, "sigma", sigma, "mean", pictures.mean(), "deviation", pictures.std())
        result["pictures"][name] = pictures.ravel().tolist()
    with open(folder / "pipeline.json", "w", encoding="utf-8") as file:
        json.dump(result, file, separators=(",", ":"))
        file.write("\n")


if __name__ == "__main__":
    main()
