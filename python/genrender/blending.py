# SPDX-License-Identifier: MIT
"""Padded rows as tensors of PyTorch, and eq. 6 with them, on any device."""

import torch


class Blending:
    """The correspondence of an animation at every feature grid that a network turns out to have."""

    def __init__(self, maps, latent_grid, average="quality", first_fill_share=0.5):
        self.maps, self.latent_grid = maps, latent_grid
        self.average, self.first_fill_share = average, first_fill_share
        self._correspondences, self._rows = {}, {}

    def grid_of(self, tokens):
        """Height and width of a feature map of so many tokens: the latents', halved as often as it takes."""
        height, width = self.latent_grid
        while height * width > tokens and height % 2 == 0 and width % 2 == 0:
            height, width = height // 2, width // 2
        if height * width != tokens:
            raise ValueError(f"Blending: a feature map has {tokens} tokens, expected the latents' {self.latent_grid} "
                             "halved a number of times")
        return height, width

    def rows(self, tokens, keyframes, frames, alpha, device):
        """(index, weights, own) for feature maps of so many tokens; those of one set of frames are kept at a time."""
        frames_of = (tuple(keyframes), tuple(frames))
        if self._rows.get("of") != frames_of:
            self._rows = {"of": frames_of}
        if (tokens, alpha) not in self._rows:
            grid = self.grid_of(tokens)
            if grid not in self._correspondences:
                self._correspondences[grid] = self.maps.correspondence(*grid)
            made = self._correspondences[grid].padded_rows(keyframes, frames, alpha, self.first_fill_share, self.average)
            self._rows[tokens, alpha] = [torch.from_numpy(array).to(device) for array in made]
        return self._rows[tokens, alpha]


def mix(F_hat, F_KF, rows):
    """F_out = alpha F_bar + (1 - alpha) F_hat (eq. 6), or F_hat where no keyframe covers a token.

    F_hat is [branches, frames, tokens, channels], F_KF [branches, keyframes * tokens, channels].
    """
    index, weights, own = rows
    F_out = own.to(F_hat.dtype)[None, :, :, None] * F_hat
    for w in range(index.shape[-1]):
        F_out += weights[None, :, :, w, None].to(F_hat.dtype) * F_KF[:, index[..., w]]
    return F_out
