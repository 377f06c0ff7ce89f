# SPDX-License-Identifier: MIT
"""A small UNet of diffusers, exported and changed by add_feature_io.py and run by ONNX Runtime, beside the same UNet in PyTorch
with attention by eqs. 3, 5 and 6 written out, without a temperature and with one. Exits with 77 where a package is missing, 1 if
they differ."""
import importlib.util
import math
import sys
import tempfile
import warnings
from pathlib import Path

for package in ("torch", "diffusers", "onnx", "onnxruntime"):
    if importlib.util.find_spec(package) is None:
        print(f"skipped: the package {package} is missing")
        sys.exit(77)

import numpy
import onnx
import onnxruntime
import torch
from diffusers import UNet2DConditionModel

# By its path: the package's module in C++ is not needed, and its folder has a file called diffusers.py.
spec = importlib.util.spec_from_file_location(
    "add_feature_io", Path(__file__).resolve().parents[2] / "python" / "genrender" / "add_feature_io.py")
add_feature_io = importlib.util.module_from_spec(spec)
spec.loader.exec_module(add_feature_io)
add_feature_io = add_feature_io.add_feature_io

warnings.filterwarnings("ignore")  # torch.onnx warns of every constant of the traced network
m, frames, width, alpha = 3, 2, 3, 0.6
torch.manual_seed(15)
unet = UNet2DConditionModel(
    sample_size=8, block_out_channels=(16, 32), layers_per_block=1, norm_num_groups=4, attention_head_dim=4,
    cross_attention_dim=12, down_block_types=("CrossAttnDownBlock2D", "DownBlock2D"),
    up_block_types=("UpBlock2D", "CrossAttnUpBlock2D")).eval()
# One of the two modules has a bias, as no UNet of Stable Diffusion does and others may.
biased = unet.up_blocks[1].attentions[1].transformer_blocks[0].attn1.to_q
biased.bias = torch.nn.Parameter(torch.randn(biased.out_features))


class written_out:
    """Attention of one module by eqs. 1, 3, 5 and 6; `bank` and `plans` are by name."""
    def __init__(self, name, run):
        self.name, self.run = name, run

    def __call__(self, attn, hidden_states, encoder_hidden_states=None, **_):
        f, run = hidden_states, self.run
        takes_part = encoder_hidden_states is None and "up_blocks" in self.name and run["pass"] != "plain"
        results = []
        for i in range(f.shape[0]):
            tokens = f[i] if encoder_hidden_states is None else encoder_hidden_states[i]
            if takes_part and run["pass"] == "keyframe":
                tokens = f.reshape(-1, f.shape[2])
            elif takes_part:
                tokens = torch.cat([f[i], *run["bank"][self.name][0]])
            heads = lambda x: x.reshape(len(x), attn.heads, -1).transpose(0, 1)
            q, k, v = heads(attn.to_q(f[i])), heads(attn.to_k(tokens)), heads(attn.to_v(tokens))
            temperature = (math.log(len(tokens)) / math.log(len(f[i]))) ** run["power"] if takes_part else 1
            shares = torch.softmax(q @ k.transpose(1, 2) * attn.scale * temperature, dim=-1)
            results.append(attn.to_out[0]((shares @ v).transpose(0, 1).reshape(f.shape[1:])))
        F = torch.stack(results)
        if takes_part and run["pass"] == "keyframe":
            run["bank"][self.name] = (f, F)
        elif takes_part:
            index, weights, own = run["plans"][F.shape[1]]
            F_KF = run["bank"][self.name][1].reshape(-1, F.shape[2])
            F = own * F + (weights.reshape(-1, width, 1) * F_KF[index.long()]).sum(1).reshape(F.shape)
        return F


def plan(tokens):
    """Padded rows of random entries; every third token is not covered."""
    index = torch.randint(0, m * tokens, (frames * tokens, width), dtype=torch.int32)
    weights = torch.rand(frames * tokens, 1, width)
    weights = alpha * weights / weights.sum(-1, keepdim=True)
    weights[::3] = 0
    own = torch.full((frames * tokens, 1), 1 - alpha)
    own[::3] = 1
    return index, weights, own.reshape(frames, tokens, 1)


def inputs_of(count, seed):
    torch.manual_seed(seed)
    return torch.randn(count, 4, 8, 8), torch.tensor([500.0]), torch.randn(count, 5, 12)


def compare(files, run, power):
    """Greatest differences of the keyframe pass and the injected one from PyTorch, and of that from a plain pass, as shares of
    the range; with the injected output."""
    run |= {"pass": "plain", "bank": {}, "power": power}
    sessions = {}
    for pass_name, file in files.items():
        model = onnx.load(file)
        modules = add_feature_io(model, pass_name, m, width, scales_logits=power > 0)
        sessions[pass_name] = onnxruntime.InferenceSession(model.SerializeToString(), providers=["CPUExecutionProvider"])

    keyframe, injected = inputs_of(m, 1), inputs_of(frames, 2)
    plain = unet(*injected).sample
    run["pass"] = "keyframe"
    expected = unet(*keyframe).sample
    run["pass"] = "injected"
    expected_injected = unet(*injected).sample

    told = {"genrender.length_correction": numpy.array([power], numpy.float32)} if power > 0 else {}
    feeds = lambda given: dict(zip(("z", "t", "prompt"), (x.numpy() for x in given))) | told
    outputs = sessions["keyframe"].run(None, feeds(keyframe))
    recorded = dict(zip((o.name for o in sessions["keyframe"].get_outputs()), outputs))
    assert recorded.get("genrender.scales_logits", [0])[0] == power
    given = feeds(injected)
    for number, _ in modules:
        at = f"genrender.{number}."
        f, F = recorded[at + "f"], recorded[at + "F"]
        index, weights, own = run["plans"][f.shape[1]]
        given |= {at + "f_KF": f, at + "F_KF": F, at + "index": index.numpy(), at + "weights": weights.numpy(),
                  at + "own": own.numpy()}
    used = {i.name for i in sessions["injected"].get_inputs()}
    v = sessions["injected"].run(["v"], {name: x for name, x in given.items() if name in used})[0]
    span = float(expected_injected.max() - expected_injected.min())
    return (float(numpy.abs(recorded["v"] - expected.numpy()).max()) / span,
            float(numpy.abs(v - expected_injected.numpy()).max()) / span,
            float((plain - expected_injected).abs().max()) / span, v / span, len(modules))


run = {"plans": {64: plan(64)}}
with tempfile.TemporaryDirectory() as folder, torch.no_grad():
    files = {}
    for pass_name, count in (("keyframe", m), ("injected", frames)):
        files[pass_name] = str(Path(folder) / f"{pass_name}.onnx")
        torch.onnx.export(unet, inputs_of(count, 0), files[pass_name], dynamo=False, opset_version=17,
                          input_names=["z", "t", "prompt"], output_names=["v"])
    unet.set_attn_processor({name: written_out(name, run) for name in unet.attn_processors})
    *apart, effect, v, modules = compare(files, run, 0)
    *scaled_apart, _, scaled, _ = compare(files, run, 1)

moved = float(numpy.abs(scaled - v).max())
print(f"ONNX Runtime {onnxruntime.__version__}, {modules} modules: keyframe pass {apart[0]:.1e}, injected pass {apart[1]:.1e} of "
      f"the range; injection moves it by {effect:.2f}; with a temperature {scaled_apart[0]:.1e} and {scaled_apart[1]:.1e}, which "
      f"moves it by {moved:.1e}")
sys.exit(0 if max(*apart, *scaled_apart) <= 1e-5 and effect >= 1e-2 and moved >= 1e-4 else 1)
