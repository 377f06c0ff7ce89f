# SPDX-License-Identifier: MIT
"""Padded rows as tensors of PyTorch, and eq. 6 with them, on any device."""

import torch

from .rows import Rows


class Blending(Rows):
    """Rows as tensors on a device."""

    def rows(self, tokens, keyframes, frames, alpha, device):
        """(index, weights, own) for feature maps of so many tokens; those of one set of frames are kept at a time."""
        return super().rows(tokens, keyframes, frames, alpha, place=lambda array: torch.from_numpy(array).to(device))


def mix(F_hat, F_KF, rows):
    """F_out = alpha F_bar + (1 - alpha) F_hat (eq. 6), or F_hat where no keyframe covers a token.

    F_hat is [branches, frames, tokens, channels], F_KF [branches, keyframes * tokens, channels].
    """
    index, weights, own = rows
    F_out = own.to(F_hat.dtype)[None, :, :, None] * F_hat
    for w in range(index.shape[-1]):
        F_out += weights[None, :, :, w, None].to(F_hat.dtype) * F_KF[:, index[..., w]]
    return F_out
