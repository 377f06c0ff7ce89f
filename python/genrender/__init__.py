# SPDX-License-Identifier: MIT
"""Consistent frames from UV and depth maps and any 2D diffusion network: the parts that are not the network.

`genrender.diffusers` runs diffusers' StableDiffusionControlNetPipeline, `genrender.graphs` static graphs, `genrender.comfyui`
patches a model of ComfyUI, and `genrender.openvino_genai` is noise for the pipelines of OpenVINO GenAI.
"""

from ._genrender import (Consensus, Correspondence, FileError, Maps, NoiseSchedule, __version__, draw_keyframes,
                         karras_schedule, load_exr, normalize_latents, reads_exr, sample, scalings)

__all__ = ["Consensus", "Correspondence", "FileError", "Maps", "NoiseSchedule", "__version__", "draw_keyframes",
           "karras_schedule", "load_exr", "normalize_latents", "reads_exr", "sample", "scalings"]
