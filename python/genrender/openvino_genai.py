# SPDX-License-Identifier: MIT
"""UV noise for the pipelines of OpenVINO GenAI, which ask a Generator for the latents to start from."""

import numpy as np
import openvino
import openvino_genai


class UVNoise(openvino_genai.Generator):
    """A generator that gives the initial noise of frames of `maps` first, and normal numbers of a seed afterwards.

    One object is for one call of `generate`, with as many images per prompt as there are frames.
    """

    def __init__(self, maps, frames, seed=0):
        """`frames` are numbers of frames, in the order of the pictures. Runs that are to agree have one seed.

        Raises ValueError for no frames and for those that the maps lack.
        """
        super().__init__()
        self.maps, self.frames, self.seed = maps, [int(i) for i in frames], seed
        if not self.frames or not all(0 <= i < maps.frames for i in self.frames):
            raise ValueError(f"UVNoise: frames is {self.frames}, expected one or more of the maps' {maps.frames}")
        self._others, self._is_drawn = np.random.default_rng([seed, *self.frames]), False

    def next(self):
        """A number of N(0, 1) that has to do with no surface."""
        return float(self._others.standard_normal())

    def randn_tensor(self, shape):
        """The first time Maps.initial_noise [frames, channels, height, width] of the latents, then N(0, 1) of any shape.

        As float32. Raises ValueError if the first shape is not that of latents of these frames.
        """
        shape = list(shape)
        if self._is_drawn:
            return openvino.Tensor(self._others.standard_normal(shape, np.float32))
        if len(shape) != 4 or shape[0] != len(self.frames):
            raise ValueError(f"UVNoise: the pipeline asks for noise of shape {shape}, expected latents "
                             f"[{len(self.frames)}, channels, height, width] of frames {self.frames}")
        self._is_drawn = True
        return openvino.Tensor(self.maps.initial_noise(*shape[1:], seed=self.seed, frames=self.frames))
