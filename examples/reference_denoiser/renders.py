# SPDX-License-Identifier: MIT
"""The files of make_renders, as both trainings read them."""

import json
import pathlib

import numpy
import torch

UNKNOWN = 255  # number of the colour of pictures that are not of one


class Renders:
    """Pictures of invented scenes with their inverse depth, the pixels of patterned objects and their prompts."""

    def __init__(self, folder):
        folder = pathlib.Path(folder)
        description = json.loads((folder / "renders.json").read_text())
        n, height, width = description["count"], description["height"], description["width"]
        self.styles, self.colours = description["styles"], description["colours"]
        self.words = self.styles + self.colours
        read = lambda name, kind, *shape: numpy.memmap(folder / name, kind, "r", shape=(n, *shape))
        self.images = read("images.u8", numpy.uint8, height, width, 3)
        self.inverse_depth = read("inverse_depth.u16", numpy.uint16, height, width)
        self.objects = read("objects.u8", numpy.uint8, height, width)
        self.prompts = numpy.fromfile(folder / "prompts.u8", numpy.uint8).reshape(n, 2).astype(numpy.int64)

    def __len__(self):
        return len(self.images)

    def pictures(self, numbers):
        """Images [batch, 3, height, width] in [0, 1]."""
        return torch.from_numpy(self.images[numbers]).permute(0, 3, 1, 2).float() / 255

    def depths(self, numbers):
        """Inverse depth [batch, height, width] in [0, 1]."""
        return torch.from_numpy(self.inverse_depth[numbers].astype(numpy.float32)) / 65535

    def text(self, style, colour):
        """Rows of a token table for a text that names a style, a colour or both, after the start token's row 0; None
        leaves one out."""
        rows = [0] if style is None else [0, 1 + int(style)]
        return rows if colour is None else rows + [1 + len(self.styles) + int(colour)]
