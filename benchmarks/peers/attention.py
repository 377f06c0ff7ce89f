# SPDX-License-Identifier: MIT
"""Times PyTorch's scaled_dot_product_attention on the shapes of benchmarks/attention/scaled_dot_product.bench.cpp.

Prints a list of {"name", "peer", "seconds"}. Needs PyTorch. Keys and values lie concatenated and by heads: that copy,
which the library does not need, is not timed.
"""

import argparse
import json
import re
import statistics
import time

import torch

CASES = [  # frames, tokens, heads, head_size
    (1, 4096, 1, 40),
    (1, 1024, 8, 80),
    (4, 256, 8, 160),
    (16, 64, 8, 160),
]


def median_seconds(body, at_least):
    """Runs `body` twice to warm up, then for `at_least` seconds and three times."""
    body(), body()
    times = []
    while len(times) < 3 or sum(times) < at_least:
        start = time.perf_counter()
        body()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


@torch.inference_mode()
def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=0.5, help="least time of a case")
    parser.add_argument("--filter", default="", help="a regular expression, as that of Google Benchmark")
    arguments = parser.parse_args()

    torch.set_num_threads(1)
    results = []
    for frames, tokens, heads, head_size in CASES:
        for keyframes in (0, 5, 8):
            shape = f"frames:{frames}/tokens:{tokens}/heads:{heads}/head_size:{head_size}/keyframes:{keyframes}"
            name = f"attention/{shape}"
            if not re.search(arguments.filter, name):
                continue
            q = torch.randn(frames, heads, tokens, head_size)
            k, v = torch.randn(2, frames, heads, (keyframes + 1) * tokens, head_size)
            seconds = median_seconds(
                lambda: torch.nn.functional.scaled_dot_product_attention(q, k, v), arguments.seconds
            )
            results.append({"name": name, "peer": f"PyTorch {torch.__version__.split('+')[0]}", "seconds": seconds})
    print(json.dumps(results, indent=2))


if __name__ == "__main__":
    main()
