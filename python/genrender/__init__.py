# SPDX-License-Identifier: MIT
"""Consistent frames from UV and depth maps and any 2D diffusion network: the parts that are not the network.

`genrender.diffusers` runs diffusers' StableDiffusionControlNetPipeline, `genrender.graphs` static graphs, and
`genrender.comfyui` patches a model of ComfyUI.
"""

from ._genrender import (Consensus, Correspondence, FileError, Maps, NoiseSchedule, __version__, draw_keyframes,
                         karras_schedule, load_exr, normalize_latents, reads_exr, sample, scalings)

__all__ = ["Consensus", "Correspondence", "FileError", "Maps", "NoiseSchedule", "__version__", "draw_keyframes",
           "karras_schedule", "load_exr", "normalize_latents", "reads_exr", "sample", "scalings"]
