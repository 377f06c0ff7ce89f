# SPDX-License-Identifier: MIT
"""Padded rows as tensors of PyTorch, and eq. 6 with them, on any device."""

import torch

from .rows import Rows


class Blending(Rows):
    """Rows as tensors on a device."""

    def rows(self, tokens, keyframes, frames, alpha, device):
        """(index, weights, own) for feature maps of so many tokens; those of one set of frames are kept at a time."""
        return super().rows(tokens, keyframes, frames, alpha, place=lambda array: torch.from_numpy(array).to(device))

    def counts(self, tokens, keyframes, frames, device):
        """Correspondence.point_counts for feature maps of so many tokens, as a tensor."""
        return super().counts(tokens, keyframes, frames, place=lambda array: torch.from_numpy(array).to(device))


def mix(F_hat, F_KF, rows):
    """F_out = alpha F_bar + (1 - alpha) F_hat (eq. 6), or F_hat where no keyframe covers a token.

    F_hat is [branches, frames, tokens, channels], F_KF [branches, keyframes * tokens, channels].
    """
    index, weights, own = rows
    F_out = own.to(F_hat.dtype)[None, :, :, None] * F_hat
    for w in range(index.shape[-1]):
        F_out += weights[None, :, :, w, None].to(F_hat.dtype) * F_KF[:, index[..., w]]
    return F_out


def mix_keeping_variance(F_hat, F_KF, rows, variance, most_gain=2.0):
    """`mix`, after which the covered tokens of each frame get back the variance that averaging took, channel by channel.

    F_out becomes m + g (F_out - m), g = S / s in [1 / most_gain, most_gain], with m and s^2 the mean and variance of F_out over
    the covered tokens. S^2 is by `variance`: total, the mean square about m of all that is mixed, each by its share, or sources,
    the variance of the features of keyframes by their weights; none gives what `mix` gives.
    """
    F_out = mix(F_hat, F_KF, rows)
    if variance == "none":
        return F_out
    index, weights, own = rows
    is_covered = (weights.sum(-1) > 0)[None, :, :, None]
    count = is_covered.sum(2, keepdim=True).clamp(min=1)

    def mean_of(x):
        return torch.where(is_covered, x, 0).sum(2, keepdim=True) / count

    m = mean_of(F_out.float())
    apart, of_own = F_out.float() - m, F_hat.float() - m
    first, second = torch.zeros_like(apart), torch.zeros_like(apart)
    for w in range(index.shape[-1]):
        X = F_KF[:, index[..., w]].float() - m
        first += weights[None, :, :, w, None] * X
        second += weights[None, :, :, w, None] * X ** 2
    if variance == "total":
        to = mean_of(own[None, :, :, None] * of_own ** 2 + second)
    else:
        alpha = mean_of(weights.sum(-1)[None, :, :, None]).clamp(min=1e-12)
        to = mean_of(second) / alpha - (mean_of(first) / alpha) ** 2
    of = mean_of(apart ** 2)
    gain = torch.where((of > 0) & (to > 0) & (count > 1), (to / of).sqrt().clamp(1 / most_gain, most_gain), 1)
    return torch.where(is_covered, m + gain * apart, F_out.float()).to(F_out.dtype)
