# SPDX-License-Identifier: MIT
"""A Stable Diffusion in the layout that OpenVINO GenAI reads, of graphs that are next to nothing: the UNet estimates noise of 0."""

import json

import numpy as np
import openvino
import openvino.opset13 as ops

CHANNELS, SCALE, TOKENS, FEATURES = 4, 8, 4, 8


def write_genai_pipeline(folder):
    """Writes the folder. A picture is the latents' first three channels, each pixel 8 x 8 times."""

    def named(node, name):
        node.output(0).get_tensor().set_names({name})
        return node

    def parameter(name, shape, kind=np.float32):
        return named(ops.parameter(shape, kind), name)

    def save(part, parameters, outputs, config, file="openvino_model.xml"):
        (folder / part).mkdir(parents=True, exist_ok=True)
        openvino.save_model(openvino.Model(outputs, parameters), folder / part / file, compress_to_fp16=False)
        (folder / part / "config.json").write_text(json.dumps(config))

    text = parameter("text", [-1], openvino.Type.string)
    shape = ops.concat([ops.shape_of(text), ops.constant(np.array([TOKENS]))], 0)
    ones = [named(ops.broadcast(ops.constant(np.int64(1)), shape), name) for name in ("input_ids", "attention_mask")]
    save("tokenizer", [text], ones, {}, "openvino_tokenizer.xml")
    (folder / "tokenizer" / "special_tokens_map.json").write_text(json.dumps({"pad_token": "!"}))

    ids = parameter("input_ids", [-1, -1], np.int64)
    features = ops.unsqueeze(ops.convert(ids, "f32"), 2) * ops.constant(np.ones((1, 1, FEATURES), np.float32))
    save("text_encoder", [ids], [named(features, "last_hidden_state")],
         {"max_position_embeddings": TOKENS, "num_hidden_layers": 1})

    z, t = parameter("sample", [-1, CHANNELS, -1, -1]), parameter("timestep", [-1], np.int64)
    c = parameter("encoder_hidden_states", [-1, -1, FEATURES])
    unused = ops.reduce_mean(c, np.arange(3)) * ops.reduce_mean(ops.convert(t, "f32"), np.arange(1))
    save("unet", [z, t, c], [named((z + unused) * ops.constant(np.float32(0)), "out_sample")],
         {"in_channels": CHANNELS, "sample_size": 2, "time_cond_proj_dim": None})

    latent = parameter("latent_sample", [-1, CHANNELS, -1, -1])
    colours = ops.variadic_split(latent, 1, np.array([3, CHANNELS - 3])).output(0)
    picture = ops.interpolate(colours, np.array([SCALE, SCALE], np.float32), "nearest", "scales", axes=np.array([2, 3]))
    save("vae_decoder", [latent], [named(picture, "sample")],
         {"in_channels": 3, "latent_channels": CHANNELS, "out_channels": 3, "scaling_factor": 1.0, "block_out_channels": [8] * 4})

    (folder / "scheduler").mkdir(exist_ok=True)
    (folder / "scheduler" / "scheduler_config.json").write_text(json.dumps({
        "_class_name": "EulerDiscreteScheduler", "num_train_timesteps": 1000, "beta_start": 0.00085, "beta_end": 0.012,
        "beta_schedule": "scaled_linear", "prediction_type": "epsilon", "timestep_spacing": "leading", "steps_offset": 1}))
    (folder / "model_index.json").write_text(json.dumps({
        "_class_name": "StableDiffusionPipeline", "scheduler": ["diffusers", "EulerDiscreteScheduler"],
        "text_encoder": ["transformers", "CLIPTextModel"], "tokenizer": ["transformers", "CLIPTokenizer"],
        "unet": ["diffusers", "UNet2DConditionModel"], "vae": ["diffusers", "AutoencoderKL"]}))
