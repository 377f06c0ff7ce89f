# SPDX-License-Identifier: MIT
"""Padded rows of eq. 6 at the feature grids that a network turns out to have."""


class Rows:
    """The correspondence of an animation at every feature grid, and the rows of one set of frames at a time."""

    def __init__(self, maps, latent_grid, average="quality", first_fill_share=0.5):
        self.maps, self.latent_grid = maps, tuple(latent_grid)
        self.average, self.first_fill_share = average, first_fill_share
        self._correspondences, self._rows = {}, {}

    def grid_of(self, tokens):
        """Height and width of a feature map of so many tokens: the latents', halved as often as it takes."""
        height, width = self.latent_grid
        while height * width > tokens and height % 2 == 0 and width % 2 == 0:
            height, width = height // 2, width // 2
        if height * width != tokens:
            raise ValueError(f"Rows: a feature map has {tokens} tokens, expected the latents' {self.latent_grid} "
                             "halved a number of times")
        return height, width

    def alpha_at(self, tokens, alpha, latents_grid_alpha):
        """alpha of eq. 6 for feature maps of so many tokens, times `latents_grid_alpha` where these are as fine as the latents."""
        return alpha * latents_grid_alpha if tokens == self.latent_grid[0] * self.latent_grid[1] else alpha

    def correspondence(self, grid):
        """Which token of which frame shows which surface point, on a grid of this height and width; made once."""
        if grid not in self._correspondences:
            self._correspondences[grid] = self.maps.correspondence(*grid)
        return self._correspondences[grid]

    def rows(self, tokens, keyframes, frames, alpha, width=None, place=lambda array: array):
        """(index, weights [frames, tokens, W], own [frames, tokens]) for feature maps of so many tokens, each through `place`."""
        return self._made((tokens, alpha), keyframes, frames, lambda of: [place(array) for array in of.padded_rows(
            keyframes, frames, alpha, self.first_fill_share, self.average, width)])

    def counts(self, tokens, keyframes, frames, place=lambda array: array):
        """Correspondence.point_counts for feature maps of so many tokens, through `place`."""
        return self._made((tokens, "counts"), keyframes, frames or (), lambda of: place(of.point_counts(keyframes, frames)))

    def _made(self, key, keyframes, frames, make):
        """What `make` makes of the correspondence of key[0] tokens; kept for one set of frames at a time."""
        frames_of = (tuple(keyframes), tuple(frames))
        if self._rows.get("of") != frames_of:
            self._rows = {"of": frames_of}
        if key not in self._rows:
            self._rows[key] = make(self.correspondence(self.grid_of(key[0])))
        return self._rows[key]
