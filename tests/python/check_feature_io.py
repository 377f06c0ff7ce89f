# SPDX-License-Identifier: MIT
"""A small UNet of diffusers, exported and changed by add_feature_io.py and run by ONNX Runtime, beside the same UNet in PyTorch
with attention by eqs. 3, 5 and 6 written out. Exits with 77 where a package is missing, 1 if they differ."""
import importlib.util
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
            shares = torch.softmax(q @ k.transpose(1, 2) * attn.scale, dim=-1)
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


run = {"pass": "plain", "bank": {}, "plans": {64: plan(64)}}
names = list(unet.attn_processors)
with tempfile.TemporaryDirectory() as folder, torch.no_grad():
    sessions = {}
    for pass_name, count in (("keyframe", m), ("injected", frames)):
        file = str(Path(folder) / "unet.onnx")
        torch.onnx.export(unet, inputs_of(count, 0), file, dynamo=False, opset_version=17,
                          input_names=["z", "t", "prompt"], output_names=["v"])
        model = onnx.load(file)
        modules = add_feature_io(model, pass_name, m, width)
        sessions[pass_name] = onnxruntime.InferenceSession(model.SerializeToString(), providers=["CPUExecutionProvider"])

    unet.set_attn_processor({name: written_out(name, run) for name in names})
    keyframe, injected = inputs_of(m, 1), inputs_of(frames, 2)
    plain = unet(*injected).sample
    run["pass"] = "keyframe"
    expected = unet(*keyframe).sample
    run["pass"] = "injected"
    expected_injected = unet(*injected).sample

    feeds = lambda given: dict(zip(("z", "t", "prompt"), (x.numpy() for x in given)))
    outputs = sessions["keyframe"].run(None, feeds(keyframe))
    recorded = dict(zip((o.name for o in sessions["keyframe"].get_outputs()), outputs))
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
apart = [float(numpy.abs(recorded["v"] - expected.numpy()).max()) / span,
         float(numpy.abs(v - expected_injected.numpy()).max()) / span]
effect = float((plain - expected_injected).abs().max()) / span
print(f"ONNX Runtime {onnxruntime.__version__}, {len(modules)} modules: keyframe pass {apart[0]:.1e}, injected pass "
      f"{apart[1]:.1e} of the range; injection moves it by {effect:.2f}")
sys.exit(0 if max(apart) <= 1e-5 and effect >= 1e-2 else 1)
