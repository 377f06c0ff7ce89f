# SPDX-License-Identifier: MIT
"""Writes data/clip_text.json: what the public package transformers computes for small text encoders.

Needs Python 3.10 or later with PyTorch (any recent version, CPU only), numpy and transformers 5.24.0:

    pip install torch numpy transformers==5.24.0
    python3 tests/reference/make_text_encoder_golden.py

The tests read the file and never run Python. Weights are the numbers of golden_network.hpp. Each encoder runs in single
and in double precision.
"""

import json
import pathlib
import sys
import tempfile

import torch
import transformers
from transformers import CLIPTextConfig, CLIPTextModel

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "data"))
from golden_data import fill, numbers, values, write  # noqa: E402


def outputs(model, ids):
    """The last hidden state, and the last norm of the one before it."""
    result = model(ids, output_hidden_states=True)
    encoder = getattr(model, "text_model", model)  # where transformers 4 has the layers
    return result.last_hidden_state, encoder.final_layer_norm(result.hidden_states[-2])


def case(name, *, tokens, **config):
    # Tokens that end a text pick the pooled output, which is not asked for.
    model = CLIPTextModel(CLIPTextConfig(bos_token_id=0, eos_token_id=1, pad_token_id=1, **config)).eval()
    ids = [int((x + 1) / 2 * config["vocab_size"]) for x in values(name + ".ids", tokens)]
    with torch.no_grad():
        fill(getattr(model, "text_model", model), name + ".")
        single = outputs(model, torch.tensor([ids]))
        double = outputs(model.double(), torch.tensor([ids]))
    last, before = (numbers(*both) for both in zip(single, double))
    with tempfile.TemporaryDirectory() as folder:
        model.float().save_pretrained(folder)
        written = json.loads((pathlib.Path(folder) / "config.json").read_text())
    return {"name": name, "config": written, "ids": ids, "last": last, "before_last": before}


write("clip_text.json", {
    "computed_by": f"transformers {transformers.__version__}",
    "written_by": "tests/reference/make_text_encoder_golden.py",
    "cases": [
        # All of Stable Diffusion 1.x but the sizes.
        case("clip_sd1", tokens=77, vocab_size=120, hidden_size=24, intermediate_size=96, num_hidden_layers=3,
             num_attention_heads=3, max_position_embeddings=77, hidden_act="quick_gelu"),
        # What Stable Diffusion 2.x does otherwise; a text that is shorter than it may be.
        case("clip_sd2", tokens=15, vocab_size=50, hidden_size=20, intermediate_size=36, num_hidden_layers=2,
             num_attention_heads=4, max_position_embeddings=16, hidden_act="gelu", layer_norm_eps=1e-3),
    ]})
