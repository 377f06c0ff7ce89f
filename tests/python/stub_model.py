# SPDX-License-Identifier: MIT
"""What nodes of ComfyUI call of a model, without ComfyUI."""


class StubModel:
    """A ModelPatcher's methods and options that custom nodes use."""

    def __init__(self, model_options=None):
        self.model_options = model_options or {"transformer_options": {"patches": {}}}

    def clone(self):
        options = {**self.model_options, "transformer_options": {
            "patches": {name: list(some) for name, some in self.model_options["transformer_options"]["patches"].items()}}}
        return StubModel(options)

    def set_model_patch(self, patch, name):
        self.model_options["transformer_options"]["patches"].setdefault(name, []).append(patch)

    def set_model_attn1_patch(self, patch):
        self.set_model_patch(patch, "attn1_patch")

    def set_model_attn1_output_patch(self, patch):
        self.set_model_patch(patch, "attn1_output_patch")

    def set_model_unet_function_wrapper(self, unet_wrapper_function):
        self.model_options["model_function_wrapper"] = unet_wrapper_function

    def set_model_sampler_post_cfg_function(self, post_cfg_function):
        before = self.model_options.get("sampler_post_cfg_function", [])
        self.model_options["sampler_post_cfg_function"] = before + [post_cfg_function]
