# SPDX-License-Identifier: MIT
"""ONNX Runtime behind genrender: sessions of static graphs, one for each pass and number of frames."""

import numpy
import onnxruntime
from case import Case
from genrender import NoiseSchedule
from genrender.graphs import render
from network import Network

case = Case()
settings, network, sessions = case.settings, Network(case.weights), {}
options = onnxruntime.SessionOptions()
options.intra_op_num_threads = 1


def graph(name, frames, branch, inputs):
    session = sessions[name, len(frames)]
    inputs |= {"prompt": numpy.repeat(case.prompts[branch][None], len(frames), 0), "hint": case.hint[frames]}
    return dict(zip((one.name for one in session.get_outputs()), session.run(None, inputs)))


m, last = settings["keyframes"], len(case.hint) % settings["frames_per_call"]
for name, frames in (("keyframe", m), ("injected", settings["frames_per_call"]), ("injected", last)):
    file = network.exported(name, frames, m, (settings["channels"], *settings["grid"]), case.prompts[0].shape, case.hint.shape[1:],
                            scales_logits=settings["length_correction"] > 0)
    sessions[name, frames] = onnxruntime.InferenceSession(file, options, providers=["CPUExecutionProvider"])
scale = settings["guidance_scale"]
case.finish(lambda: render(
    case.maps, case.timed(graph), preset="plain", branch_weights=(1 - scale, scale),
    schedule=NoiseSchedule.scaled_linear(*settings["betas"]),
    **{name: settings[name] for name in ("channels", "grid", "steps", "seed", "keyframes", "frames_per_call", "prediction",
                                         "length_correction")}))
