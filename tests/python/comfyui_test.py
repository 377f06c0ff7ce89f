# SPDX-License-Identifier: MIT
"""The patches for ComfyUI, inside a stub that calls them as ComfyUI does, against `genrender.diffusers.render` on the same
network: comfyui_test.py MAPS_PROGRAM FOLDER. Finds the package by PYTHONPATH; exit code 77 where something is missing.
"""

import importlib.util
import pathlib
import shutil
import subprocess
import sys
import unittest
import warnings

missing = [name for name in ("genrender", "torch", "diffusers", "transformers") if importlib.util.find_spec(name) is None]
if missing:
    print("skipped: the Python", sys.executable, "lacks", ", ".join(missing))
    sys.exit(77)

warnings.filterwarnings("ignore")
import diffusers
import genrender
import torch
import transformers
from genrender import comfyui
from genrender.diffusers import attend, render
from stub_model import StubModel
from two_resolution_pipeline import write_pipeline

transformers.logging.set_verbosity_error()
transformers.logging.disable_progress_bar()
diffusers.logging.set_verbosity_error()
diffusers.logging.disable_progress_bar()
torch.set_num_threads(1)
MAPS_PROGRAM, FOLDER = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
PROMPT, SIZE, FRAMES, STEPS, SEED, GUIDANCE = "a red and white ball", 64, 5, 4, 5, 5.0


class StubAttention:
    """attn1 of ComfyUI's BasicTransformerBlock: patches before the projections and after to_out."""

    def __init__(self, network, block):
        self.network, self.block = network, block

    def __call__(self, attn, hidden_states, encoder_hidden_states=None, attention_mask=None, temb=None):
        n, context, value = hidden_states, None, None
        options = self.network.transformer_options
        extra_options = {**{name: x for name, x in options.items() if name != "patches"}, "block": self.block, "block_index": 0,
                         "n_heads": attn.heads, "dim_head": hidden_states.shape[-1] // attn.heads}
        for patch in options["patches"].get("attn1_patch", []):
            context = n if context is None else context
            value = context if value is None else value
            n, context, value = patch(n, context, value, extra_options)
        context = n if context is None else context
        value = context if value is None else value
        n = attn.to_out[0](attend(attn.heads, attn.to_q(n), attn.to_k(context), attn.to_v(value)))
        for patch in options["patches"].get("attn1_output_patch", []):
            n = patch(n, extra_options)
        return n


class StubNetwork:
    """diffusers' UNet behind ComfyUI's apply_model, and the calls of a sampler with classifier-free guidance."""

    def __init__(self, pipe, maps):
        self.pipe, self.transformer_options, self.calls = pipe, {}, []
        config = pipe.scheduler.config
        self.schedule = genrender.NoiseSchedule.scaled_linear(config.beta_start, config.beta_end, config.num_train_timesteps)
        text, negative = pipe.encode_prompt(PROMPT, "cpu", 1, True, "")
        self.conds = [text, negative]  # as ComfyUI numbers them: 0 conditional, 1 unconditional
        self.hint = torch.from_numpy(maps.inverse_depth(SIZE, SIZE))[:, None].repeat(1, 3, 1, 1)
        names = {"down_blocks": "input", "mid_block": "middle", "up_blocks": "output"}
        for number, (name, module) in enumerate(pipe.unet.named_modules()):
            if name.endswith(".attn1"):
                module.set_processor(StubAttention(self, (names[name.split(".")[0]], number)))

    def apply_model(self, x, t, c_concat=None, c_crossattn=None, control=None, transformer_options={}, **kwargs):
        self.transformer_options = {**transformer_options, "original_shape": list(x.shape)}
        self.calls.append(len(x))
        sigma = t.view(-1, 1, 1, 1)
        F = self.pipe.unet(x / (sigma ** 2 + 1) ** 0.5, self.schedule.t_of(float(t[0])), c_crossattn,
                           down_block_additional_residuals=control["input"],
                           mid_block_additional_residual=control["middle"][0]).sample
        return x - sigma * F

    def control(self, x, sigma, text):
        down, middle = self.pipe.controlnet(x / (sigma ** 2 + 1) ** 0.5, self.schedule.t_of(float(sigma)), text,
                                            self.hint.repeat(len(x) // FRAMES, 1, 1, 1), return_dict=False)
        return {"input": list(down), "middle": [middle]}

    def denoised(self, model, x, sigma, sigmas, groups):
        """One estimate; `groups` are the conds of each call, [[0, 1]] or [[0], [1]]."""
        estimates, options = {}, model.model_options
        for group in groups:
            input_x, timestep = torch.cat([x] * len(group)), sigma.repeat(len(x) * len(group))
            text = torch.cat([self.conds[one].repeat(len(x), 1, 1) for one in group])
            c = {"c_crossattn": text, "control": self.control(input_x, sigma, text), "transformer_options": {
                **options["transformer_options"], "cond_or_uncond": group, "sigmas": sigma[None], "sample_sigmas": sigmas}}
            if "model_function_wrapper" in options:
                out = options["model_function_wrapper"](self.apply_model, {
                    "input": input_x, "timestep": timestep, "c": c, "cond_or_uncond": group})
            else:
                out = self.apply_model(input_x, timestep, **c)
            estimates.update(zip(group, out.chunk(len(group))))
        denoised = estimates[1] + GUIDANCE * (estimates[0] - estimates[1])
        for function in options.get("sampler_post_cfg_function", []):
            denoised = function({"denoised": denoised, "cond_denoised": estimates[0], "uncond_denoised": estimates[1],
                                 "sigma": sigma[None], "model_options": options, "input": x})
        return denoised

    @torch.no_grad()
    def sample(self, model, noise, groups=((0, 1),)):
        """Euler's method over Karras' levels."""
        sigmas = torch.tensor(genrender.karras_schedule(STEPS, self.schedule.sigma_min, self.schedule.sigma_max))
        sigmas = sigmas.float()
        x = sigmas[0] * noise.generate_noise({"samples": torch.zeros(FRAMES, 4, SIZE // 4, SIZE // 4)})
        for sigma, following in zip(sigmas, sigmas[1:]):
            x0 = self.denoised(model, x, sigma, sigmas, [list(group) for group in groups])
            x = x0 + following / sigma * (x - x0)
        return x


class PatchesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(FOLDER / "epsilon", ignore_errors=True)
        write_pipeline(FOLDER / "epsilon")
        subprocess.run([MAPS_PROGRAM, "walking_figure", FOLDER / "maps", str(FRAMES), "128"], check=True,
                       stdout=subprocess.DEVNULL)
        cls.maps = genrender.load_exr(str(FOLDER / "maps"))

        def pipeline():
            return diffusers.StableDiffusionControlNetPipeline.from_pretrained(
                FOLDER / "epsilon", dtype=torch.float32, safety_checker=None)

        cls.expected = {(preset, keyframes): render(
            pipeline(), cls.maps, PROMPT, height=SIZE, width=SIZE, preset=preset, steps=STEPS, seed=SEED,
            guidance_scale=GUIDANCE, keyframes=keyframes) for preset, keyframes in (("vivid", 2), ("plain", 2), ("vivid", 4))}
        cls.network = StubNetwork(pipeline(), cls.maps)

    def difference(self, a, b):
        return float((a - b).abs().max() / (b.max() - b.min()))

    def test_a_patched_model_makes_the_latents_of_the_pipeline(self):
        noise = comfyui.UVNoise(self.maps, SEED)
        plain = self.network.sample(StubModel(), noise)
        for groups, preset, keyframes, frames_per_call in (([[0, 1]], "vivid", 4, 2), ([[1], [0]], "plain", 2, 5),
                                                           ([[0, 1]], "vivid", 2, 5)):
            model = comfyui.patched(StubModel(), self.maps, preset=preset, keyframes=keyframes, seed=SEED,
                                    frames_per_call=frames_per_call)
            self.network.calls.clear()
            found = self.network.sample(model, noise, groups)
            share = self.difference(found, self.expected[preset, keyframes])
            print(f"\ncalls of {groups}: {share:.1e} of the range; without patches {self.difference(plain, found):.1e}")
            self.assertLessEqual(share, 1e-3)
            self.assertGreater(self.difference(plain, found), 1e-2)
            counts = [keyframes] + [min(frames_per_call, FRAMES - i) for i in range(0, FRAMES, frames_per_call)]
            of_a_step = [count * len(group) for group in groups for count in counts]
            self.assertEqual(self.network.calls, of_a_step * STEPS)

    def test_patches_of_others_run_as_well(self):
        seen = set()

        def look(n, context_attn1, value_attn1, extra_options):
            seen.add((extra_options["block"][0], n.shape == context_attn1.shape))
            return n, context_attn1, value_attn1

        model = comfyui.patched(StubModel(), self.maps, keyframes=2, seed=SEED)
        model.set_model_attn1_patch(look)
        self.network.sample(model, comfyui.UVNoise(self.maps, SEED))
        # Keyframes and frames attend to more in the decoder; what is before it is left alone.
        self.assertEqual(seen, {("input", True), ("middle", True), ("output", False)})

    def test_the_model_that_was_patched_stays_as_it_was(self):
        model = StubModel()
        comfyui.patched(model, self.maps)
        self.assertEqual(model.model_options, {"transformer_options": {"patches": {}}})

    def test_a_batch_that_is_not_the_frames_is_refused(self):
        model = comfyui.patched(StubModel(), self.maps, keyframes=2)
        with self.assertRaisesRegex(ValueError, "the batch holds 3 latents, expected 5, one a frame of the maps"):
            model.model_options["model_function_wrapper"](self.network.apply_model, {
                "input": torch.zeros(6, 4, 16, 16), "timestep": torch.ones(6), "c": {}, "cond_or_uncond": [0, 1]})
        with self.assertRaisesRegex(ValueError, "expected 5"):
            comfyui.UVNoise(self.maps).generate_noise({"samples": torch.zeros(2, 4, 16, 16)})

    def test_a_noise_object_has_a_seed_and_makes_the_noise_of_its_frames(self):
        noise = comfyui.UVNoise(self.maps, 9)
        every = noise.generate_noise({"samples": torch.zeros(FRAMES, 4, 16, 16)})
        some = noise.generate_noise({"samples": torch.zeros(2, 4, 16, 16), "batch_index": [3, 1]})
        self.assertEqual(noise.seed, 9)
        self.assertTrue(torch.equal(some, every[[3, 1]]))
        self.assertLess(abs(float(every.std()) - 1), 0.1)

    def test_nodes_make_what_their_types_say(self):
        nodes = comfyui.NODE_CLASS_MAPPINGS

        def run(name, **inputs):
            node = nodes[name]
            self.assertEqual(set(inputs), set(node.INPUT_TYPES()["required"]))
            outputs = getattr(node(), node.FUNCTION)(**inputs)
            self.assertEqual(len(outputs), len(node.RETURN_TYPES))
            return outputs

        maps, depth, latent = run("GenrenderMaps", folder=str(FOLDER / "maps"), height=64, width=64)
        self.assertEqual((tuple(depth.shape), tuple(latent["samples"].shape)), ((FRAMES, 64, 64, 3), (FRAMES, 4, 8, 8)))
        (noise,) = run("GenrenderNoise", maps=maps, seed=3)
        self.assertEqual(noise.generate_noise(latent).shape, latent["samples"].shape)
        (model,) = run("GenrenderModel", model=StubModel(), maps=maps, preset="plain", keyframes=2, seed=3, alpha=0.5)
        self.assertEqual(set(model.model_options["transformer_options"]["patches"]), {"attn1_patch", "attn1_output_patch"})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
