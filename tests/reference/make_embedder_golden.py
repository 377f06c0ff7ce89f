# SPDX-License-Identifier: MIT
"""Writes data/prompt_embedder.json: what PyTorch computes in double precision for the encoder that train_embedder.py
trains.

Needs Python 3.9 or later with PyTorch (any recent version, CPU only), numpy and safetensors:

    pip install torch numpy safetensors
    python3 tests/reference/make_embedder_golden.py

The tests read the file and never run Python. Weights and inputs are the numbers of golden_network.hpp.
"""

import pathlib
import sys

import torch

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "data"), str(ROOT / "examples" / "reference_denoiser")]
import train_embedder  # noqa: E402
from golden_data import tensor, weight_scale, write  # noqa: E402

model = train_embedder.PromptEmbedder(3).double().eval()
with torch.no_grad():
    for name, parameter in model.tensors().items():
        x = tensor(name, *parameter.shape)
        if parameter.dim() == 1:
            # Rounded as the file's single precision rounds it.
            x = (0.25 * x + (1 if name.endswith("weight") else 0)).float().double()
        else:
            x = x * weight_scale(parameter[0].numel())
        parameter.copy_(x)
    image = model.image(0.5 + 0.5 * tensor("image", 1, 3, 18, 25))[0]
    text = model.text([[0, 3, 1]])[0]

write("prompt_embedder.json",
      {"computed_by": "PyTorch in double precision", "written_by": "tests/reference/make_embedder_golden.py",
       "image_vector": image.tolist(), "text_vector": text.tolist()})
