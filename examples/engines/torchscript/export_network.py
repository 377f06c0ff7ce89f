# SPDX-License-Identifier: MIT
"""Exports UNet and ControlNet of a diffusers folder as one TorchScript network, F(z, t, prompt, hint), whose self-attention
is the operator genrender::self_attention: whoever loads the file says what it does. It runs on the device that it was traced
on, cpu by default.

    python3 export_network.py FOLDER NETWORK.pt [DEVICE]

Exit code 77 where torch or diffusers is missing.
"""

import sys
import warnings

try:
    import diffusers
    import torch
except ImportError as missing:
    print("skipped:", missing)
    sys.exit(77)


# docs:begin torchscript_operator
@torch.library.custom_op("genrender::self_attention", mutates_args=())
def self_attention(f: torch.Tensor, query: torch.Tensor, key: torch.Tensor, value: torch.Tensor, heads: int,
                   site: str) -> torch.Tensor:
    """What the network did by itself: f [frames, tokens, channels] attends to its own tokens, by matrices."""
    q, k, v = (torch.nn.functional.linear(f, matrix).unflatten(2, (heads, -1)).transpose(1, 2) for matrix in (query, key, value))
    return torch.nn.functional.scaled_dot_product_attention(q, k, v).transpose(1, 2).flatten(2)


class SelfAttention:
    """Processor of diffusers for the module `site`."""

    def __init__(self, site):
        self.site = site

    def __call__(self, attn, f, encoder_hidden_states=None, attention_mask=None, temb=None):
        F = torch.ops.genrender.self_attention(f, attn.to_q.weight, attn.to_k.weight, attn.to_v.weight, attn.heads, self.site)
        return attn.to_out[0](F)


class Network(torch.nn.Module):
    def __init__(self, folder):
        super().__init__()
        self.unet = diffusers.UNet2DConditionModel.from_pretrained(folder, subfolder="unet", torch_dtype=torch.float32)
        self.control = diffusers.ControlNetModel.from_pretrained(folder, subfolder="controlnet", torch_dtype=torch.float32)

    def forward(self, z, t, prompt, hint):
        """z [frames, channels, height, width] times c_in, t of no axis, prompt [1, words, channels], hint of each frame."""
        words = prompt.expand(z.shape[0], -1, -1)
        down, middle = self.control(z, t, words, hint, return_dict=False)
        return self.unet(z, t, words, down_block_additional_residuals=down, mid_block_additional_residual=middle,
                         return_dict=False)[0]

    def replace_self_attention(self):
        for name, module in self.unet.named_modules():
            if name.endswith(".attn1"):
                module.set_processor(SelfAttention(name))
# docs:end


def inputs(network, frames, size, seed, device):
    """Random ones for latents of size x size."""
    torch.manual_seed(seed)
    unet, control = network.unet.config, network.control.config
    pixels = size * 2 ** (len(control.conditioning_embedding_out_channels) - 1)
    made = (torch.randn(frames, unet.in_channels, size, size), torch.tensor(437.5), torch.randn(1, 77, unet.cross_attention_dim),
            torch.rand(frames, control.conditioning_channels, pixels, pixels))
    return tuple(x.to(device) for x in made)


@torch.inference_mode()
def main():
    device = sys.argv[3] if len(sys.argv) > 3 else "cpu"
    network = Network(sys.argv[1]).eval().to(device)
    smallest = 2 ** len(network.unet.config.block_out_channels)
    others = inputs(network, 3, 2 * smallest, 2, device)  # neither the frames nor the grid of those that are traced
    expected = network(*others)
    network.replace_self_attention()
    traced = torch.jit.trace(network, inputs(network, 2, smallest, 1, device))
    apart = float((traced(*others) - expected).abs().max() / (expected.max() - expected.min()))
    if not apart < 1e-5:
        raise SystemExit(f"the exported network differs from diffusers' by {apart:g} of the range, expected at most 1e-5")
    traced.save(sys.argv[2])
    print(f"{sys.argv[2]}: differs from diffusers' network by {apart:.1e} of the range")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    diffusers.logging.set_verbosity_error()
    main()
