# SPDX-License-Identifier: MIT
"""What the scripts that make golden numbers share: inputs that both sides can make, and the files that hold results."""

import json
import math
import pathlib
import re
import textwrap


def values(name, count):
    """Numbers in [-1, 1): the scrambled sum (splitmix64) of a hash of the name and the index."""
    import numpy

    begin = 0xCBF29CE484222325
    for byte in name.encode():
        begin = ((begin ^ byte) * 0x100000001B3) % 2**64
    x = numpy.uint64(begin) + numpy.arange(count, dtype=numpy.uint64) * numpy.uint64(0x9E3779B97F4A7C15)
    x = (x ^ (x >> numpy.uint64(30))) * numpy.uint64(0xBF58476D1CE4E5B9)
    x = (x ^ (x >> numpy.uint64(27))) * numpy.uint64(0x94D049BB133111EB)
    x ^= x >> numpy.uint64(31)
    return (x >> numpy.uint64(40)).astype(numpy.float64) * 2.0**-23 - 1


def tensor(name, *shape):
    import torch

    return torch.from_numpy(values(name, math.prod(shape))).reshape(shape)


def weight_scale(fan_in):
    """A power of two, so that the product is exact in float too."""
    return 2.0 ** math.floor(math.log2(math.sqrt(3 / fan_in)))


def fill(model, prefix):
    """Sets every parameter of a model to the numbers of its name."""
    for name, parameter in model.named_parameters():
        x = tensor(prefix + name, *parameter.shape)
        if parameter.dim() == 1:
            x = 0.25 * x + (1 if name.endswith("weight") else 0)
        else:
            x = x * weight_scale(parameter[0].numel())
        parameter.copy_(x)


def numbers(single, double, kept=96):
    """Evenly spaced elements of an output: one golden_output."""
    step = (double.numel() - 1) // kept | 1  # odd, so that rows are not met at one column
    single, precise = (x.double().flatten()[::step][:kept].tolist() for x in (single, double))
    return {"step": step, "range": float(double.max() - double.min()), "single": single, "precise": precise}


def write(name, data):
    """Writes tests/data/`name`: numbers with all their digits, lists of them in lines of at most 118 columns."""

    def in_lines(match):
        begin = match.group(1)
        text = " ".join(match.group(2).split())
        if len(begin) + len(text) <= 114:
            return f"{begin}[{text}]"
        margin = " " * (len(begin) - len(begin.lstrip()) + 2)
        lines = textwrap.wrap(text, 118, initial_indent=margin, subsequent_indent=margin)
        return begin + "[\n" + "\n".join(lines) + "\n" + margin[2:] + "]"

    text = json.dumps(data, indent=2)
    text = re.sub(r"^( *(?:\"\w+\": )?)\[\n([^][{}]*)\]", in_lines, text, flags=re.MULTILINE)
    pathlib.Path(__file__).with_name(name).write_text(text + "\n")
