# SPDX-License-Identifier: MIT
"""Loads the miniature's folder with diffusers' own pipeline and draws one picture in two steps.

    python3 check_folder.py weights

Ends with 0 if the folder is whole and at most 12 MB, with 77 where diffusers or transformers is missing.
"""

import pathlib
import sys

try:
    import numpy
    import torch
    from diffusers import StableDiffusionControlNetPipeline
    from PIL import Image
except ImportError as missing:
    print(missing)
    sys.exit(77)


def main():
    folder = pathlib.Path(sys.argv[1])
    size = sum(path.stat().st_size for path in folder.rglob("*.safetensors"))
    assert size <= 12_000_000, f"the weights are {size} bytes, expected at most 12,000,000"
    pipeline = StableDiffusionControlNetPipeline.from_pretrained(folder, torch_dtype=torch.float32)
    pipeline.set_progress_bar_config(disable=True)
    ramp = numpy.linspace(0, 255, 128).astype(numpy.uint8)
    depth = Image.fromarray(numpy.repeat(ramp[:, None], 128, 1)).convert("RGB")
    draw = lambda prompt: pipeline(prompt, image=depth, num_inference_steps=2, height=128, width=128, output_type="np",
                                   generator=torch.Generator().manual_seed(1)).images[0]
    ground = draw("green checkered ground under a clear sky")
    assert ground.shape == (128, 128, 3) and numpy.isfinite(ground).all(), "the picture is not whole"
    assert numpy.abs(ground - draw("red ground at night")).mean() > 0.01, "the prompt says nothing to the network"
    print(f"{size} bytes of weights; {type(pipeline).__name__} draws")


if __name__ == "__main__":
    main()
