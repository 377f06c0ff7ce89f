# SPDX-License-Identifier: MIT
"""Times PyTorch's scaled_dot_product_attention on the shapes of benchmarks/attention/scaled_dot_product.bench.cpp.

Needs PyTorch. Keys and values lie concatenated and by heads: that copy, which the library does not need, is not timed.
"""

import torch

from support.attention_cases import attention_cases
from support.peer_times import peer_times, pytorch_name

KERNELS = ["attention"]


@torch.inference_mode()
def main():
    times = peer_times(__doc__, KERNELS)
    torch.set_num_threads(1)
    for name, frames, tokens, heads, head_size, keyframes in attention_cases():
        if not times.wants(name):
            continue
        q = torch.randn(frames, heads, tokens, head_size)
        k, v = torch.randn(2, frames, heads, (keyframes + 1) * tokens, head_size)

        def attend():
            torch.nn.functional.scaled_dot_product_attention(q, k, v)

        times.add(name, pytorch_name(attend), attend)
    times.print()


if __name__ == "__main__":
    main()
