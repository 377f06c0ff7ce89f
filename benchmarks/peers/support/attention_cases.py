# SPDX-License-Identifier: MIT
"""The cases `attention` of benchmarks/attention/scaled_dot_product.bench.cpp, for every peer of them."""

GRIDS = [  # frames, tokens, heads, head_size
    (1, 4096, 1, 40),
    (1, 1024, 8, 80),
    (4, 256, 8, 160),
    (16, 64, 8, 160),
]


def attention_cases():
    """Name, frames, tokens, heads, head size and keyframes of each."""
    for frames, tokens, heads, head_size in GRIDS:
        for keyframes in (0, 5, 8):
            shape = f"frames:{frames}/tokens:{tokens}/heads:{heads}/head_size:{head_size}/keyframes:{keyframes}"
            yield f"attention/{shape}", frames, tokens, heads, head_size, keyframes
