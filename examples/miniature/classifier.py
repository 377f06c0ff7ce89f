# SPDX-License-Identifier: MIT
"""Says which pattern and which colours the subjects of a picture have: the judge's eye, trained on renders alone."""

import numpy
import torch
from torch import nn

from training_run import TrainingRun


class Classifier(nn.Module):
    """Scores of patterns [batch, patterns] and of colours [batch, colours] for images with a mask of their subjects."""

    def __init__(self, patterns, colours):
        super().__init__()
        widths = (4, 24, 48, 96, 128)
        self.stages = nn.ModuleList()
        for i, (before, after) in enumerate(zip(widths, widths[1:])):
            self.stages.append(nn.Sequential(
                nn.Conv2d(before, after, 3, stride=1 if i == 0 else 2, padding=1), nn.GroupNorm(8, after), nn.SiLU(),
                nn.Conv2d(after, after, 3, stride=2 if i == 0 else 1, padding=1), nn.GroupNorm(8, after), nn.SiLU()))
        self.out = nn.Linear(2 * widths[-1], patterns + colours)
        self.patterns = patterns

    def forward(self, images, masks):
        x = torch.cat([2 * images - 1, masks[:, None]], 1)
        for stage in self.stages:
            x = stage(x)
        share = nn.functional.adaptive_avg_pool2d(masks[:, None], x.shape[-2:])
        inside = (x * share).sum((2, 3)) / share.sum((2, 3)).clamp(min=1e-3)
        scores = self.out(torch.cat([inside, x.mean((2, 3))], 1)).float()
        return scores[:, :self.patterns], scores[:, self.patterns:]


def colour_sets(pictures, numbers):
    """1 for each colour that the subjects have [batch, colours]."""
    sets = torch.zeros(len(numbers), len(pictures.colours))
    for row, n in enumerate(numbers):
        for name in ("first", "second"):
            if pictures.labels[name][n] < len(pictures.colours):
                sets[row, pictures.labels[name][n]] = 1
    return sets


def masks_of(pictures, numbers):
    return torch.from_numpy(pictures.subjects[numbers]).float() / 255


def train_classifier(pictures, path, steps=2500, batch=32, seed=0, precision=torch.bfloat16):
    """Trains on renders, or reads what an earlier run trained."""
    shape = (len(pictures.patterns), len(pictures.colours))
    model = Classifier(*shape)
    torch.manual_seed(seed)
    run = TrainingRun("classifier", model, path, steps, 1.5e-3, seed, precision)

    def loss_of(random, generator):
        numbers = numpy.sort(random.choice(len(pictures), batch, replace=False))
        images, masks = pictures.colours_of(numbers), masks_of(pictures, numbers)
        # Samples are a little softer or noisier than renders; neither is to be held against them.
        images = (images + 0.03 * random.random() * torch.randn(images.shape, generator=generator)).clamp(0, 1)
        mirrored = torch.from_numpy(random.random(batch) < 0.5)
        images[mirrored], masks[mirrored] = images[mirrored].flip(-1), masks[mirrored].flip(-1)
        patterns, colours = model(images.to(precision), masks.to(precision))
        wanted = torch.from_numpy(pictures.labels["pattern"][numbers])
        return (nn.functional.cross_entropy(patterns, wanted) +
                3 * nn.functional.binary_cross_entropy_with_logits(colours, colour_sets(pictures, numbers)))

    run.train(loss_of, batch)
    return run.averaged(Classifier(*shape))


@torch.no_grad()
def recognised(model, images, pictures, numbers):
    """Whether the pattern, and whether all colours and no other, are what the labels say [batch] each."""
    patterns, colours = [], []
    for part in numpy.array_split(numpy.arange(len(numbers)), max(1, len(numbers) // 64)):
        found = model(images[part], masks_of(pictures, numbers[part]))
        patterns.append(found[0])
        colours.append(found[1])
    patterns, colours = torch.cat(patterns), torch.cat(colours)
    wanted = colour_sets(pictures, numbers)
    ranks = colours.argsort(1, descending=True).argsort(1)
    right = ((ranks < wanted.sum(1, keepdim=True)) == (wanted == 1)).all(1)
    return (patterns.argmax(1).numpy() == pictures.labels["pattern"][numbers]), right.numpy()
