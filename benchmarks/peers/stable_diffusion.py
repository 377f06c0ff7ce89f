# SPDX-License-Identifier: MIT
"""Times PyTorch eager on the networks of benchmarks/reference/stable_diffusion.bench.cpp.

Needs PyTorch, diffusers and transformers, and 6 GB of memory. Weights are random; what they are does not matter for the time.
"""

import torch
from diffusers import AutoencoderKL, ControlNetModel, UNet2DConditionModel
from transformers import CLIPTextConfig, CLIPTextModel

from support.peer_times import peer_times, pytorch_name

KERNELS = ["stable_diffusion_text", "stable_diffusion_step", "stable_diffusion_picture"]
THREADS = 2


def text():
    model = CLIPTextModel(CLIPTextConfig(vocab_size=49408, hidden_size=768, intermediate_size=3072, num_hidden_layers=12,
                                         num_attention_heads=12)).eval()
    ids = torch.full((1, 77), 320)
    return lambda: model(ids)


def step():
    control = ControlNetModel(cross_attention_dim=768).eval()
    unet = UNet2DConditionModel(cross_attention_dim=768, sample_size=64).eval()
    z, prompt, hint = torch.randn(1, 4, 64, 64), torch.randn(1, 77, 768), torch.rand(1, 3, 512, 512)

    def forward():
        down, middle = control(z, 417, prompt, hint, return_dict=False)
        return unet(z, 417, prompt, down_block_additional_residuals=down, mid_block_additional_residual=middle)

    return forward


def picture():
    vae = AutoencoderKL(block_out_channels=(128, 256, 512, 512), layers_per_block=2, norm_num_groups=32, sample_size=512,
                        down_block_types=("DownEncoderBlock2D",) * 4, up_block_types=("UpDecoderBlock2D",) * 4).eval()
    del vae.encoder
    z = torch.randn(1, 4, 64, 64)
    return lambda: vae.decode(z)


@torch.inference_mode()
def main():
    times = peer_times(__doc__, KERNELS)
    torch.set_num_threads(THREADS)
    for name, make in (("text", text), ("step", step), ("picture", picture)):
        case = f"stable_diffusion_{name}/threads:{THREADS}"
        # As Google Benchmark names rows of a fixed number of runs.
        if name != "text":
            case = f"stable_diffusion_{name}/threads:{THREADS}/iterations:1/repeats:3"
        if times.wants(case):
            torch.manual_seed(0)
            times.add(case, pytorch_name(), make(), warm_ups=1)
    times.print()


if __name__ == "__main__":
    main()
