# SPDX-License-Identifier: MIT
"""Times PyTorch and NumPy on what benchmarks/blending and benchmarks/normalization time.

Needs PyTorch and NumPy. Blending is done twice: by gathering the sources of each token, which is the library's plan,
and by way of a dense texture as the paper describes it.
"""

import numpy
import torch

from support.peer_times import peer_times, pytorch_name

KERNELS = ["mix<float>", "mix<float16>", "mix<bfloat16>", "dense_texture", "normalize"]

KEYFRAMES = 5
SOURCES = 4  # of a token, about as many as in the benchmark's scene
ALPHA = 0.7


def mix(tokens, channels, stored):
    """F = (1 - alpha) F + alpha sum of weighted sources."""
    F = torch.randn(tokens, channels)
    F_KF = torch.randn(KEYFRAMES * tokens, channels).to(stored)
    near = (torch.arange(tokens)[:, None] + torch.randint(0, 5, (tokens, SOURCES))) % tokens
    sources = (near + tokens * torch.arange(SOURCES)).reshape(-1)
    weights = torch.full((tokens, SOURCES, 1), ALPHA / SOURCES)

    def body():
        rows = torch.index_select(F_KF, 0, sources).reshape(tokens, SOURCES, channels).float()
        F.mul_(1 - ALPHA).add_((rows * weights).sum(1))

    return body


def dense_texture(tokens, channels, texels):
    """Keyframes written to the texels of their tokens' squares, mean and first fill, a frame's tokens read."""
    side = int(round(tokens**0.5))
    F = torch.randn(tokens, channels)
    F_KF = torch.randn(KEYFRAMES, tokens, channels)
    rows = torch.arange(texels) * side // texels
    token_of = (rows[:, None] * side + rows[None, :]).reshape(-1)
    texel = torch.arange(texels * texels)
    middle = (torch.arange(side) * texels + texels // 2) // side
    read = (middle[:, None] * texels + middle[None, :]).reshape(-1)

    def body():
        total = torch.zeros(texels * texels, channels)
        first = torch.zeros(texels * texels, channels)
        seen = torch.zeros(texels * texels, 1)
        for k in range(KEYFRAMES):
            values = F_KF[k][token_of]
            total.index_put_((texel,), values, accumulate=True)
            seen.index_put_((texel,), torch.ones(texels * texels, 1), accumulate=True)
            if k == 0:
                first.index_put_((texel,), values)
        texture = (first + total / seen) / 2
        F.mul_(1 - ALPHA).add_(texture[read], alpha=ALPHA)

    return body


def normalize(frames, latents):
    """Every frame's background gets the means and deviations of the first frame's."""
    z = numpy.random.default_rng(1).standard_normal((frames, 4, latents, latents), dtype=numpy.float32)
    background = numpy.zeros((frames, latents, latents), dtype=bool)
    background[:, :, : latents // 3] = True

    def statistics_of(i):
        values = z[i][:, background[i]].astype(numpy.float64)
        return values.mean(1), numpy.sqrt(values.var(1, ddof=1) + 1e-5)

    def body():
        mean_to, deviation_to = statistics_of(0)
        for i in range(1, frames):
            mean, deviation = statistics_of(i)
            z[i] = (z[i] - mean[:, None, None]) * (deviation_to / deviation)[:, None, None] + mean_to[:, None, None]

    return body


@torch.inference_mode()
def main():
    times = peer_times(__doc__, KERNELS)
    torch.set_num_threads(1)

    def measure(name, peer, make, warm_ups=2):
        if times.wants(name):
            times.add(name, peer, make(), warm_ups=warm_ups)

    for tokens, channels in ((4096, 320), (1024, 640), (256, 1280), (64, 1280)):
        for kind, stored in (("float", torch.float32), ("float16", torch.float16), ("bfloat16", torch.bfloat16)):
            shape = f"tokens:{tokens}/channels:{channels}"
            measure(f"mix<{kind}>/{shape}", pytorch_name(), lambda: mix(tokens, channels, stored))
    measure("dense_texture/tokens:4096/channels:320/texels:256/iterations:1/repeats:2", pytorch_name(),
            lambda: dense_texture(4096, 320, 256), warm_ups=0)
    for frames in (24, 1000):
        measure(f"normalize/frames:{frames}/latents:64", f"NumPy {numpy.__version__}", lambda: normalize(frames, 64))
    times.print()


if __name__ == "__main__":
    main()
