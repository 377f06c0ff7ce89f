# SPDX-License-Identifier: MIT
"""Writes data/reference_clip.json: what PyTorch computes in double precision for a small encoder of the kind that
examples/miniature/train_embedder.py trains.

Needs Python 3.10 or later with PyTorch (any recent version, CPU only), numpy, safetensors and transformers 5.24.0:

    pip install torch numpy safetensors transformers==5.24.0
    python3 tests/reference/make_clip_golden.py

The tests read the file and never run Python. Weights and inputs are the numbers of golden_network.hpp, the tokenizer is
that of data/clip_tokenizer.
"""

import pathlib
import sys

import torch
import transformers
from transformers import CLIPTextConfig, CLIPTokenizer

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "data"), str(ROOT / "examples" / "miniature")]
import train_embedder  # noqa: E402
from golden_data import tensor, weight_scale, write  # noqa: E402

TEXTS = ["", "a red and white checkered ball", "A Puppet, under the (cloudy) sky!",
         " ".join(["three striped vases in blue and black"] * 12)]

tokenizer = CLIPTokenizer(str(ROOT / "tests/data/clip_tokenizer/vocab.json"),
                          str(ROOT / "tests/data/clip_tokenizer/merges.txt"))
text = CLIPTextConfig(vocab_size=len(tokenizer), hidden_size=8, intermediate_size=16, num_hidden_layers=2,
                      num_attention_heads=2, max_position_embeddings=77, bos_token_id=tokenizer.bos_token_id,
                      eos_token_id=tokenizer.eos_token_id, pad_token_id=tokenizer.pad_token_id)
model = train_embedder.Embedder(text, channels=(4, 8, 8, 12), strides=(2, 2, 1, 1), groups=2, hidden=6,
                                dimension=5).double().eval()
with torch.no_grad():
    for name, parameter in train_embedder.tensors_of(model).items():
        x = tensor(name, *parameter.shape)
        if parameter.dim() == 1:
            # Rounded as the file's single precision rounds it.
            x = (0.25 * x + (1 if name.endswith("weight") else 0)).float().double()
        else:
            x = x * weight_scale(parameter[0].numel())
        parameter.copy_(x)
    images = [model.image_vectors(0.5 + 0.5 * tensor(name, 1, 3, *shape))[0].tolist()
              for name, shape in (("image", (19, 26)), ("small image", (1, 2)))]
    texts = [model.text_vectors(train_embedder.tokens_of(tokenizer, [words]))[0].tolist() for words in TEXTS]

write("reference_clip.json",
      {"computed_by": f"PyTorch in double precision, transformers {transformers.__version__}",
       "written_by": "tests/reference/make_clip_golden.py", "config": train_embedder.config_of(model),
       "image_vectors": images, "texts": [dict(text=t, vector=v) for t, v in zip(TEXTS, texts)]})
