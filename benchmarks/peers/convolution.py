# SPDX-License-Identifier: MIT
"""Times PyTorch's convolution on the shapes of benchmarks/reference/conv2d.bench.cpp.

Needs PyTorch. The channels of a pixel lie side by side, as ours do, which is no slower for PyTorch than planes.
"""

import torch

from support.peer_times import peer_times, pytorch_name

KERNELS = ["convolution"]

CASES = [  # size, in, out, kernel, stride
    (64, 64, 64, 3, 1),
    (32, 32, 32, 3, 1),
    (32, 320, 320, 3, 1),
    (16, 640, 640, 3, 1),
    (64, 64, 64, 3, 2),
    (64, 320, 320, 1, 1),
]


@torch.inference_mode()
def main():
    times = peer_times(__doc__, KERNELS)
    torch.set_num_threads(1)
    for size, ins, outs, kernel, stride in CASES:
        name = f"convolution/size:{size}/in:{ins}/out:{outs}/kernel:{kernel}/stride:{stride}"
        if not times.wants(name):
            continue

        conv = torch.nn.Conv2d(ins, outs, kernel, stride, kernel // 2).to(memory_format=torch.channels_last)
        x = torch.randn(1, ins, size, size).to(memory_format=torch.channels_last)

        def convolve():
            conv(x)

        times.add(name, pytorch_name(convolve), convolve)
    times.print()


if __name__ == "__main__":
    main()
