# SPDX-License-Identifier: MIT
"""Settings of a run that all ways in share, and what happens to the clean estimates after the network has given them."""

import math

from . import Consensus, normalize_latents

PRESETS = {"vivid": {"consensus": True, "latents_grid_alpha": 0.0, "normalization": "none"},
           "plain": {"consensus": False, "latents_grid_alpha": 1.0, "normalization": "mean"}}


def with_preset(preset, **settings):
    """The settings of a preset, vivid or plain, where `settings` are None, else these.

    Raises ValueError for a preset of another name and for a latents_grid_alpha beyond [0, 1].
    """
    if preset not in PRESETS:
        raise ValueError(f"render: preset is {preset}, expected one of {', '.join(PRESETS)}")
    of = {name: of_preset if settings[name] is None else settings[name] for name, of_preset in PRESETS[preset].items()}
    if not 0 <= of["latents_grid_alpha"] <= 1:
        raise ValueError(f"render: latents_grid_alpha is {of['latents_grid_alpha']}, expected a share in [0, 1]")
    return of


def require_length_correction(power):
    """Raises ValueError, in the name of render, for a power that is negative or not finite."""
    if not (math.isfinite(power) and power >= 0):
        raise ValueError(f"render: length_correction is {power}, expected a finite number, 0 or more")


class Estimates:
    """The consensus and the normalisation of the clean estimates of a run, on arrays in host memory."""

    def __init__(self, rows, steps, seed, consensus, normalization):
        """`consensus` is True, False or a dict of arguments of genrender.Consensus, `normalization` that of `render`."""
        self.consensus, self.normalization = None, normalization
        if consensus is not False:
            told = {} if consensus is True else consensus
            self.consensus = Consensus(rows.correspondence(rows.latent_grid), steps, **{"seed": seed, **told})
        self.background = rows.maps.background(*rows.latent_grid)

    @property
    def are_left(self):
        """Whether nothing happens to them."""
        return self.consensus is None and self.normalization == "none"

    def finish(self, x0, step):
        """Changes x0 [frames, channels, height, width], float32, in place."""
        if self.consensus is not None:
            self.consensus.reach(x0, step)
        if self.normalization != "none":
            normalize_latents(x0, self.background, self.normalization)
