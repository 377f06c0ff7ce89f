# SPDX-License-Identifier: MIT
"""The autoencoder of the miniature: diffusers' AutoencoderKL, 128 x 128 pixels as 32 x 32 latents of eight channels."""

import numpy
import torch
from diffusers import AutoencoderKL

from pictures import contact_sheet
from training_run import TrainingRun

LATENT_CHANNELS = 8
CROP = 64
PICTURES = 16384  # of those that there are, the first


def new_autoencoder():
    return AutoencoderKL(
        in_channels=3, out_channels=3, latent_channels=LATENT_CHANNELS, block_out_channels=(16, 32, 64),
        down_block_types=("DownEncoderBlock2D",) * 3, up_block_types=("UpDecoderBlock2D",) * 3, layers_per_block=1,
        norm_num_groups=8, mid_block_add_attention=False, sample_size=128, scaling_factor=1.0)


def round_trip_loss(autoencoder, images, noise, precision, kl_weight):
    """2 MSE + .3 L1 + .1 of the difference between neighbours + the divergence from N(0, 1), of images in [-1, 1]."""
    moments = autoencoder.quant_conv(autoencoder.encoder(images.to(precision)))
    mean, log_variance = moments.float().chunk(2, 1)
    log_variance = log_variance.clamp(-30, 20)
    latents = mean + torch.exp(0.5 * log_variance) * noise
    seen = autoencoder.decoder(autoencoder.post_quant_conv(latents.to(precision))).float()
    wrong = seen - images
    edges = wrong.diff(dim=-1).abs().mean() + wrong.diff(dim=-2).abs().mean()
    divergence = 0.5 * (mean**2 + log_variance.exp() - 1 - log_variance).mean()
    return 2 * (wrong**2).mean() + 0.3 * wrong.abs().mean() + 0.1 * edges + kl_weight * divergence


def peak_signal_to_noise(images, others):
    """dB of images in [0, 1], from the mean square over all of them."""
    return -10 * torch.log10(((images - others) ** 2).mean()).item()


@torch.no_grad()
def round_trip(autoencoder, images):
    """Images [batch, 3, height, width] in [0, 1] through the latents' means."""
    latents = autoencoder.encode(2 * images - 1).latent_dist.mode()
    return ((autoencoder.decode(latents).sample + 1) / 2).clamp(0, 1)


@torch.no_grad()
def centre_latents(autoencoder, images):
    """Folds the latents' means over these images into the 1 x 1 convolutions, and their deviation into the scaling
    factor, so that a diffusion model sees mean 0 and deviation 1."""
    latents = torch.cat([autoencoder.encode(2 * part - 1).latent_dist.mode() for part in images.split(64)])
    mean = latents.mean((0, 2, 3))
    autoencoder.post_quant_conv.bias += (autoencoder.post_quant_conv.weight[:, :, 0, 0] @ mean)
    autoencoder.quant_conv.bias[:LATENT_CHANNELS] -= mean
    deviation = (latents - mean[None, :, None, None]).pow(2).mean().sqrt().item()
    autoencoder.register_to_config(scaling_factor=1 / deviation)
    return latents.std((0, 2, 3))


def train_autoencoder(pictures, held_out, out, steps, seed, precision, compiled, batch=16, rate=1.5e-3,
                      kl_weight=3e-4):
    """Trains on crops and writes `out`/vae."""
    torch.manual_seed(seed)
    autoencoder = new_autoencoder()
    run = TrainingRun("vae", autoencoder, out / "vae_checkpoint.pt", steps, rate, seed, precision, weight_decay=1e-4)
    compute = torch.compile(round_trip_loss, dynamic=False) if compiled else round_trip_loss
    judged = held_out.colours_of(numpy.arange(min(64, len(held_out))))

    def loss_of(random, generator):
        numbers = numpy.sort(random.choice(min(PICTURES, len(pictures)), batch, replace=False))
        top, left = random.integers(0, 128 - CROP + 1, (2, batch))
        crops = numpy.stack([pictures.images[n, y:y + CROP, x:x + CROP] for n, y, x in zip(numbers, top, left)])
        images = torch.from_numpy(crops).permute(0, 3, 1, 2).float() / 127.5 - 1
        flipped = torch.from_numpy(random.random(batch) < 0.5)
        images[flipped] = images[flipped].flip(-1)
        noise = torch.randn(batch, LATENT_CHANNELS, CROP // 4, CROP // 4, generator=generator)
        return compute(autoencoder, images.contiguous(memory_format=torch.channels_last), noise, precision, kl_weight)

    def show(step):
        whole = run.averaged(new_autoencoder())
        seen = round_trip(whole, judged)
        print(f"vae: step {step}  held-out PSNR {peak_signal_to_noise(judged, seen):.2f} dB", flush=True)
        contact_sheet([judged[:8], seen[:8], judged[8:16], seen[8:16]], out / "vae_sheet.png", 2)

    run.train(loss_of, batch, show=show)
    whole = run.averaged(new_autoencoder())
    deviations = centre_latents(whole, pictures.colours_of(numpy.arange(512)))
    print("vae: deviations of the latents' channels", [round(d, 3) for d in deviations.tolist()], flush=True)
    whole.half().save_pretrained(out / "vae")
