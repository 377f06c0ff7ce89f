# SPDX-License-Identifier: MIT
"""Text encoder, UNet and depth ControlNet of the miniature, trained together on the autoencoder's latents."""

import json
import math
import string

import numpy
import torch
from diffusers import AutoencoderKL, ControlNetModel, UNet2DConditionModel
from diffusers.models.attention_processor import AttnProcessor
from safetensors.torch import load_file
from transformers import CLIPTextConfig, CLIPTextModel, CLIPTokenizer

from autoencoder import LATENT_CHANNELS
from caption_tokenizer import LENGTH
from pictures import contact_sheet
from training_run import TrainingRun

TEXT_CHANNELS = 64
# How often scenes of each pattern are drawn: what is hard to draw oftener than the rest.
PATTERN_SHARES = dict(plain=0.08, stripes=0.10, bricks=0.15, checker=0.20, dots=0.23, waves=0.24)
SUBJECT_WEIGHT = 3  # of the loss where a subject fills all pixels of a latent's place, against 1 where none does
SHAPE = dict(
    in_channels=LATENT_CHANNELS, block_out_channels=(48, 96, 96), layers_per_block=1, attention_head_dim=(1, 3, 3),
    cross_attention_dim=TEXT_CHANNELS, norm_num_groups=8,
    # None at 32 x 32 on the way down: a third of the time, and the decoder's attention decides (Tumanyan et al. 2023).
    down_block_types=("DownBlock2D", "CrossAttnDownBlock2D", "DownBlock2D"))


class Denoiser(torch.nn.Module):
    """v-prediction for noisy latents, pictures of depth and tokens."""

    def __init__(self, tokenizer):
        super().__init__()
        self.text_encoder = CLIPTextModel(CLIPTextConfig(
            vocab_size=len(tokenizer), hidden_size=TEXT_CHANNELS, intermediate_size=4 * TEXT_CHANNELS,
            num_hidden_layers=2, num_attention_heads=4, max_position_embeddings=LENGTH, hidden_act="quick_gelu",
            projection_dim=TEXT_CHANNELS, bos_token_id=tokenizer.bos_token_id, eos_token_id=tokenizer.eos_token_id,
            pad_token_id=tokenizer.pad_token_id))
        self.unet = UNet2DConditionModel(
            sample_size=32, out_channels=LATENT_CHANNELS,
            up_block_types=("UpBlock2D", "CrossAttnUpBlock2D", "CrossAttnUpBlock2D"), **SHAPE)
        self.controlnet = ControlNetModel(
            conditioning_channels=3, conditioning_embedding_out_channels=(8, 16, 32), **SHAPE)
        # Scores of all pairs in memory: twice as fast on a processor, in bfloat16, as what goes through them in parts.
        self.unet.set_attn_processor(AttnProcessor())
        self.controlnet.set_attn_processor(AttnProcessor())
        # A ControlNet that joins a trained UNet begins at zero, so as not to disturb it. Here nothing is trained yet.
        for name, parameter in self.controlnet.named_parameters():
            if name.startswith(("controlnet_down_blocks", "controlnet_mid_block", "controlnet_cond_embedding.conv_out")):
                if parameter.dim() > 1:
                    torch.nn.init.kaiming_uniform_(parameter, a=math.sqrt(5))

    def forward(self, z, t, depth, tokens):
        """v [batch, 8, 32, 32] of z in the same shape, t [batch], depth [batch, 1, 128, 128], tokens [batch, 77]."""
        text = self.text_encoder(tokens).last_hidden_state
        picture = depth.expand(-1, 3, -1, -1)
        down, middle = self.controlnet(z, t, text, picture, return_dict=False)
        return self.unet(z, t, text, down_block_additional_residuals=down, mid_block_additional_residual=middle,
                         return_dict=False)[0]


class Schedule:
    """Stable Diffusion's noise levels: log sigma is linear between the 1000 steps."""

    def __init__(self):
        alphas = torch.cumprod(1 - torch.linspace(0.00085**0.5, 0.012**0.5, 1000, dtype=torch.float64) ** 2, 0)
        self.log_sigmas = 0.5 * torch.log((1 - alphas) / alphas)

    def time_of(self, sigma):
        log_sigma = sigma.double().log().clamp(self.log_sigmas[0], self.log_sigmas[-1])
        low = (torch.searchsorted(self.log_sigmas, log_sigma, right=True) - 1).clamp(0, 998)
        part = (log_sigma - self.log_sigmas[low]) / (self.log_sigmas[low + 1] - self.log_sigmas[low])
        return (low + part).float()


SCHEDULE = Schedule()


def tokens_of(tokenizer, captions):
    """Token numbers [captions, 77]."""
    return tokenizer(captions, padding="max_length", max_length=LENGTH, truncation=True, return_tensors="pt").input_ids


@torch.no_grad()
def sample(model, depth, tokens, no_tokens, guidance=3.0, steps=20, seed=0):
    """Latents by Euler steps over Karras' levels, each picture alone: of depth [batch, 1, 128, 128]."""
    generator = torch.Generator().manual_seed(seed)
    ramp = torch.linspace(0, 1, steps)
    sigmas = torch.cat([(14.6**(1 / 7) + ramp * (0.03**(1 / 7) - 14.6**(1 / 7)))**7, torch.zeros(1)])
    z = sigmas[0] * torch.randn(len(depth), LATENT_CHANNELS, 32, 32, generator=generator)
    no_tokens = no_tokens.expand(len(depth), -1)
    for sigma, following in zip(sigmas[:-1], sigmas[1:]):
        t = SCHEDULE.time_of(sigma).expand(len(depth))
        scaled = z / (1 + sigma**2).sqrt()
        without, given = (model(scaled, t, depth, words) for words in (no_tokens, tokens))
        v = without + guidance * (given - without)
        x0 = z / (1 + sigma**2) - v * sigma / (1 + sigma**2).sqrt()
        z = z + (z - x0) / sigma * (following - sigma)
    return z


@torch.no_grad()
def cached_latents(pictures, autoencoder, path):
    """Latents of every picture and of its mirror image [pictures, 2, 8, 32, 32] in half precision, in a file that is
    made once."""
    shape = (len(pictures), 2, LATENT_CHANNELS, 32, 32)
    if not path.exists():
        partial = path.with_suffix(".part")
        latents = numpy.memmap(partial, numpy.float16, "w+", shape=shape)
        scale = autoencoder.config.scaling_factor
        for numbers in numpy.array_split(numpy.arange(len(pictures)), max(1, len(pictures) // 64)):
            images = 2 * pictures.colours_of(numbers) - 1
            for side, seen in enumerate((images, images.flip(-1))):
                latents[numbers, side] = (scale * autoencoder.encode(seen).latent_dist.mode()).half().numpy()
        latents.flush()
        partial.replace(path)
    return numpy.memmap(path, numpy.float16, "r", shape=shape)


def pattern_probabilities(pictures):
    """How likely each picture is to be drawn [pictures]: PATTERN_SHARES, alike within a pattern."""
    patterns = pictures.labels["pattern"]
    shares = numpy.array([PATTERN_SHARES[name] for name in pictures.patterns])
    each = (shares / numpy.maximum(1, numpy.bincount(patterns, minlength=len(shares))))[patterns]
    return each / each.sum()


def draw_noise_levels(batch, random):
    """ln sigma ~ N(0, 1.5), stratified over the batch."""
    place = torch.from_numpy((numpy.arange(batch) + random.random(batch)) / batch)
    normal = math.sqrt(2) * torch.erfinv((2 * place - 1).clamp(-0.9999, 0.9999))
    return torch.exp(1.5 * normal).clamp(0.0292, 14.6146).float()


def disturbed(caption, random):
    """One caption in ten is empty, which guidance needs; one in twelve has a word that means nothing."""
    if random.random() < 0.1:
        return ""
    if random.random() < 0.08:
        words = caption.split(" ")
        letters = random.choice(list(string.ascii_lowercase), random.integers(3, 9))
        words.insert(random.integers(0, len(words) + 1), "".join(letters))
        return " ".join(words)
    return caption


def save_denoiser(model, out):
    """The folders of diffusers' pipeline, in half precision."""
    model.half()
    for name in ("text_encoder", "unet", "controlnet"):
        getattr(model, name).save_pretrained(out / name)
    (out / "scheduler").mkdir(exist_ok=True)
    (out / "scheduler" / "scheduler_config.json").write_text(json.dumps(dict(
        _class_name="EulerDiscreteScheduler", beta_start=0.00085, beta_end=0.012, beta_schedule="scaled_linear",
        num_train_timesteps=1000, prediction_type="v_prediction", use_karras_sigmas=True, timestep_spacing="linspace",
        steps_offset=0), indent=2) + "\n")
    (out / "model_index.json").write_text(json.dumps(dict(
        _class_name="StableDiffusionControlNetPipeline", controlnet=["diffusers", "ControlNetModel"],
        feature_extractor=[None, None], image_encoder=[None, None], requires_safety_checker=False,
        safety_checker=[None, None], scheduler=["diffusers", "EulerDiscreteScheduler"],
        text_encoder=["transformers", "CLIPTextModel"], tokenizer=["transformers", "CLIPTokenizer"],
        unet=["diffusers", "UNet2DConditionModel"], vae=["diffusers", "AutoencoderKL"]), indent=2) + "\n")


def load_denoiser(model, folder):
    """The weights of such folders, of whichever precision."""
    for name, file in (("text_encoder", "model"), ("unet", "diffusion_pytorch_model"),
                       ("controlnet", "diffusion_pytorch_model")):
        getattr(model, name).load_state_dict(load_file(folder / name / f"{file}.safetensors"))


def train_denoiser(pictures, held_out, out, steps, seed, precision, compiled, batch=32, rate=1e-3, every=100,
                   begin=None):
    """Trains on the latents of `out`/vae, from the weights of the folder `begin` if there is one, and writes the other
    folders of the pipeline."""
    torch.manual_seed(seed)
    autoencoder = AutoencoderKL.from_pretrained(out / "vae").float().eval()
    tokenizer = CLIPTokenizer.from_pretrained(out / "tokenizer")
    latents = cached_latents(pictures, autoencoder, out / "latents.f16")
    model = Denoiser(tokenizer)
    if begin is not None:
        load_denoiser(model, begin)
    print(f"denoiser: {sum(p.numel() for p in model.parameters())} parameters", flush=True)
    run = TrainingRun("denoiser", model, out / "denoiser_checkpoint.pt", steps, rate, seed, precision)
    predict = torch.compile(model, dynamic=False) if compiled else model
    nothing = tokens_of(tokenizer, [""])
    probabilities = pattern_probabilities(pictures)

    def loss_of(random, generator):
        numbers = numpy.sort(random.choice(len(pictures), batch, replace=False, p=probabilities))
        side = random.integers(0, 2, batch)
        x0 = torch.from_numpy(latents[numbers, side].astype(numpy.float32))
        # An animation's nearest point is seldom in this frame.
        depth = pictures.depth_of(numbers) * torch.from_numpy(random.uniform(0.7, 1, (batch, 1, 1)).astype("float32"))
        mirrored = torch.from_numpy(side == 1)
        subjects = torch.from_numpy((pictures.subjects[numbers] == 255).astype("float32"))
        depth[mirrored], subjects[mirrored] = depth[mirrored].flip(-1), subjects[mirrored].flip(-1)
        weights = 1 + (SUBJECT_WEIGHT - 1) * torch.nn.functional.avg_pool2d(subjects[:, None], 4)
        tokens = tokens_of(tokenizer, [disturbed(pictures.captions[n], random) for n in numbers])
        sigma = draw_noise_levels(batch, random)
        noise = torch.randn(x0.shape, generator=generator)
        s = sigma[:, None, None, None]
        scale = (1 + s**2).sqrt()
        z = ((x0 + s * noise) / scale).to(precision).contiguous(memory_format=torch.channels_last)
        v = predict(z, SCHEDULE.time_of(sigma), depth[:, None].to(precision), tokens)
        return (weights * (v.float() - (noise - s * x0) / scale) ** 2).mean() / weights.mean()

    shown = numpy.arange(min(24, len(held_out)))
    shown_depth = held_out.depth_of(shown)[:, None]
    shown_tokens = tokens_of(tokenizer, [held_out.captions[n] for n in shown])
    last_shown = [-10**9]

    def show(step):
        save_denoiser(run.averaged(Denoiser(tokenizer)), out)
        if step - last_shown[0] < 1000 and step != steps:
            return
        last_shown[0] = step
        z = sample(run.averaged(Denoiser(tokenizer)), shown_depth, shown_tokens, nothing)
        seen = (autoencoder.decode(z / autoencoder.config.scaling_factor).sample + 1) / 2
        real = held_out.colours_of(shown)
        contact_sheet([part for i in range(0, len(shown), 8) for part in (real[i:i + 8], seen[i:i + 8])],
                      out / f"samples_{step:06d}.png", 2)

    run.train(loss_of, batch, every=every, show=show)
    save_denoiser(run.averaged(Denoiser(tokenizer)), out)
