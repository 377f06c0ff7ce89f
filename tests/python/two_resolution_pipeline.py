# SPDX-License-Identifier: MIT
"""A pipeline in diffusers' layout with self-attention at two resolutions of its decoder, and random weights of a seed."""

import pathlib
import sys

import torch
from diffusers import (AutoencoderKL, ControlNetModel, EulerDiscreteScheduler, StableDiffusionControlNetPipeline,
                       UNet2DConditionModel)
from transformers import CLIPTextConfig, CLIPTextModel, CLIPTokenizer

TESTS = pathlib.Path(__file__).resolve().parent.parent
sys.path.append(str(TESTS / "reference"))
from make_pipeline_golden import SCHEDULE, draw_weights  # noqa: E402


def write_pipeline(target, prediction_type="epsilon", channels=(8, 16, 16), seed=23):
    """Writes the folder; pictures of 4 pixels a token, attention at a half and at all of the latents' grid."""
    torch.manual_seed(seed)
    tokenizer = CLIPTokenizer.from_pretrained(TESTS / "data" / "clip_tokenizer", model_max_length=77)
    shared = {"block_out_channels": channels, "layers_per_block": 1, "cross_attention_dim": 16, "attention_head_dim": 2,
              "norm_num_groups": 4, "in_channels": 4,
              "down_block_types": ("CrossAttnDownBlock2D", "CrossAttnDownBlock2D", "DownBlock2D")}
    unet = draw_weights(UNet2DConditionModel(
        sample_size=16, out_channels=4, up_block_types=("UpBlock2D", "CrossAttnUpBlock2D", "CrossAttnUpBlock2D"),
        **shared), 1)
    control = draw_weights(ControlNetModel(conditioning_embedding_out_channels=(4, 8, 8), **shared), 1)
    vae = draw_weights(AutoencoderKL(
        block_out_channels=(8, 8, 16), down_block_types=("DownEncoderBlock2D",) * 3,
        up_block_types=("UpDecoderBlock2D",) * 3, layers_per_block=1, latent_channels=4, norm_num_groups=4,
        scaling_factor=0.3), 1)
    text = draw_weights(CLIPTextModel(CLIPTextConfig(
        vocab_size=len(tokenizer), hidden_size=16, intermediate_size=32, num_hidden_layers=2, num_attention_heads=2,
        max_position_embeddings=77, hidden_act="quick_gelu", bos_token_id=tokenizer.bos_token_id,
        eos_token_id=tokenizer.eos_token_id, pad_token_id=tokenizer.pad_token_id)), 1)
    pipeline = StableDiffusionControlNetPipeline(
        vae=vae, text_encoder=text, tokenizer=tokenizer, unet=unet, controlnet=control,
        scheduler=EulerDiscreteScheduler(use_karras_sigmas=True, prediction_type=prediction_type, **SCHEDULE),
        safety_checker=None, feature_extractor=None, requires_safety_checker=False)
    pipeline.to(torch.float16).save_pretrained(target)


if __name__ == "__main__":
    write_pipeline(sys.argv[1])
