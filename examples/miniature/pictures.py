# SPDX-License-Identifier: MIT
"""The files of make_pictures, as every training reads them."""

import json
import pathlib

import numpy
import torch

NO_LABEL = 255  # what a picture without a ground, a wall or a second colour has in their places


class Pictures:
    """Pictures of the small world with their inverse depth, the pixels of their subjects, labels and captions."""

    def __init__(self, folder):
        folder = pathlib.Path(folder)
        self.description = json.loads((folder / "pictures.json").read_text())
        n, height, width = (self.description[name] for name in ("count", "height", "width"))
        self.patterns, self.colours = self.description["patterns"], self.description["colours"]
        self.lights = self.description["lights"]
        read = lambda name, kind, *shape: numpy.memmap(folder / name, kind, "r", shape=(n, *shape))
        self.images = read("images.u8", numpy.uint8, height, width, 3)
        self.inverse_depth = read("inverse_depth.u16", numpy.uint16, height, width)
        self.subjects = read("subjects.u8", numpy.uint8, height, width)
        labels = numpy.fromfile(folder / "labels.u8", numpy.uint8).reshape(n, -1).astype(numpy.int64)
        self.labels = {name: labels[:, i] for i, name in enumerate(self.description["labels"])}
        self.captions = (folder / "captions.txt").read_text().splitlines()
        if len(self.captions) != n:
            raise ValueError(f"{folder}: {len(self.captions)} captions of {n} pictures, expected one a picture")

    def __len__(self):
        return len(self.images)

    def colours_of(self, numbers):
        """Images [batch, 3, height, width] in [0, 1]."""
        return torch.from_numpy(self.images[numbers]).permute(0, 3, 1, 2).float() / 255

    def depth_of(self, numbers):
        """Inverse depth [batch, height, width] in [0, 1]."""
        return torch.from_numpy(self.inverse_depth[numbers].astype(numpy.float32)) / 65535


def contact_sheet(rows, path, scale=1):
    """Rows of images [n, 3, height, width] in [0, 1], one below the other."""
    from PIL import Image
    grid = torch.cat([torch.cat(list(row.float().clamp(0, 1)), -1) for row in rows], -2)
    sheet = Image.fromarray((grid.permute(1, 2, 0) * 255).round().byte().numpy())
    sheet.resize((scale * sheet.width, scale * sheet.height), Image.NEAREST).save(path)
