# SPDX-License-Identifier: MIT
"""Trains the encoder of images and free texts that the metrics use, on the pictures of make_pictures.

    python3 train_embedder.py --pictures trained/pictures --held-out trained/held_out --tokenizer trained/tokenizer \\
        --work trained --out embedder

It learns which texts are true of which pictures of a batch (Radford et al. 2021), where several texts may be: captions,
patterns, colours, and patterns of colours. A run that was stopped goes on where its last checkpoint was. Writes
config.json, model.safetensors in half precision and the tokenizer's files, which the library's reference_clip reads, and
training.json with the settings and what is reached on held-out renders.
"""

import argparse
import itertools
import json
import math
import pathlib
import re
import shutil
import string
import time

import numpy
import torch
import torch.nn.functional as F
from safetensors.torch import save_file
from torch import nn
from transformers import CLIPTextConfig, CLIPTextModel, CLIPTokenizer

from caption_facts import ADJECTIVES, COLOURS, NOUNS, PATTERNS, ShortTexts, facts_of_pictures, of_no_paint, paints_of, truth
from pictures import Pictures
from training_run import TrainingRun, keep_freed_memory

CHANNELS, STRIDES = (24, 48, 48, 96, 96, 96), (2, 2, 1, 2, 1, 1)
GROUPS, HIDDEN, DIMENSION = 8, 128, 64
NORM_EPSILON = 1e-5
PAIRS = list(itertools.combinations(range(len(COLOURS)), 2))
SINGLES = [(colour,) for colour in range(len(COLOURS))]
PAINTS = [(0, c) for c in SINGLES] + [(p, pair) for p in range(1, len(PATTERNS)) for pair in PAIRS]


def wide(x):
    """At least single precision."""
    return x.float() if x.dtype == torch.bfloat16 else x


class Block(nn.Module):
    """Convolution, GroupNorm, SiLU; added to what came in where that has the same shape."""

    def __init__(self, inputs, outputs, stride, groups=GROUPS):
        super().__init__()
        self.conv = nn.Conv2d(inputs, outputs, 3, stride, 1)
        self.norm = nn.GroupNorm(groups, outputs, NORM_EPSILON)
        self.adds = stride == 1 and inputs == outputs

    def forward(self, x):
        y = F.silu(self.norm(self.conv(x)))
        return x + y if self.adds else y


class ImageEncoder(nn.Module):
    """Vectors [batch, dimension] of images [batch, 3, height, width] in [0, 1], features of places [batch, places,
    channels], and scores of where the subjects are [batch, rows, columns]."""

    def __init__(self, channels=CHANNELS, strides=STRIDES, groups=GROUPS, hidden=HIDDEN, dimension=DIMENSION):
        super().__init__()
        inputs = (3,) + tuple(channels[:-1])
        self.blocks = nn.ModuleList(Block(*shape, groups) for shape in zip(inputs, channels, strides))
        self.gate = nn.Linear(channels[-1], 1)
        self.hidden = nn.Linear(2 * channels[-1], hidden)
        self.projection = nn.Linear(hidden, dimension)

    def forward(self, images):
        x = 2 * images - 1
        for block in self.blocks:
            x = block(x)
        rows = x.flatten(2).transpose(1, 2)
        scores = self.gate(rows)
        share = torch.sigmoid(wide(scores))
        inside = ((share * rows).sum(1) / share.sum(1).clamp(min=1e-30)).to(x.dtype)
        means = torch.cat([inside, rows.mean(1)], 1)
        vectors = self.projection(F.silu(self.hidden(means)))
        return wide(vectors), rows, wide(scores[..., 0]).unflatten(1, x.shape[-2:])


class Embedder(nn.Module):
    """Both encoders, and what only training needs: the temperature, and a guess at the pattern from each place."""

    def __init__(self, text, **shape):
        super().__init__()
        self.image = ImageEncoder(**shape)
        self.text = CLIPTextModel(text)
        self.text_projection = nn.Linear(text.hidden_size, self.image.projection.out_features, bias=False)
        self.local = nn.Linear(self.image.gate.in_features, len(PATTERNS))
        self.log_scale = nn.Parameter(torch.tensor(math.log(10.0)))

    def image_vectors(self, images):
        return F.normalize(self.image(images)[0], dim=-1)

    def text_vectors(self, tokens):
        return F.normalize(wide(self.text_projection(self.text(tokens).pooler_output)), dim=-1)


def text_config(tokenizer):
    return CLIPTextConfig(
        vocab_size=len(tokenizer), hidden_size=64, intermediate_size=256, num_hidden_layers=2, num_attention_heads=4,
        max_position_embeddings=77, hidden_act="quick_gelu", bos_token_id=tokenizer.bos_token_id,
        eos_token_id=tokenizer.eos_token_id, pad_token_id=tokenizer.pad_token_id)


def tokens_of(tokenizer, texts):
    """Token numbers [texts, longest of them]."""
    return tokenizer(texts, padding=True, max_length=77, truncation=True, return_tensors="pt").input_ids


def augmented(images, random):
    """Brighter or darker, flatter or steeper, a little blurred and noisy: generated images are not crisp."""
    n = len(images)
    uniform = lambda low, high: torch.from_numpy(random.uniform(low, high, (n, 1, 1, 1)).astype(numpy.float32))
    # A part of each picture is its mean over 3 x 3 pixels, twice for some.
    padded = lambda x: F.pad(x, (1, 1, 1, 1), mode="replicate")
    blurred = F.avg_pool2d(padded(images), 3, 1)
    more = torch.from_numpy(random.random(n) < 0.3)
    blurred[more] = F.avg_pool2d(padded(blurred[more]), 3, 1)
    images = images.lerp_(blurred, uniform(-0.5, 1).clamp(min=0))
    contrast, mean = uniform(0.8, 1.2), images.mean((1, 2, 3), keepdim=True)
    images.mul_(contrast).add_(mean * (1 - contrast) + uniform(-0.08, 0.08))
    noisy = torch.from_numpy(random.random(n) < 0.6)
    noise = torch.from_numpy(random.standard_normal(images[noisy].shape, numpy.float32))
    images[noisy] += noise.mul_(uniform(0, 0.06)[noisy])
    return images.clamp_(0, 1)


def disturbed(text, random):
    """One text in twelve has a word that means nothing."""
    if random.random() < 0.08:
        words = text.split(" ")
        letters = random.choice(list(string.ascii_lowercase), random.integers(3, 9))
        words.insert(random.integers(0, len(words) + 1), "".join(letters))
        return " ".join(words)
    return text


class TextLists:
    """The texts that a batch is compared with besides its captions: patterns, colours, and patterns of colours. Within
    a list all name the same things, so that which is nearest is a matter of the paint alone."""

    said = [[(p, ()) for p in range(len(PATTERNS))], [(None, c) for c in SINGLES + PAIRS], PAINTS]

    def __init__(self, random, paints):
        """`paints` are places in PAINTS, the ones that this batch is compared with."""
        choice = lambda words: words[random.integers(len(words))]
        self.texts, self.facts, self.sizes = [], [], []
        for paints in (*self.said[:2], [PAINTS[paint] for paint in paints]):
            short = ShortTexts.drawn(random)
            self.texts += [short(pattern, colours, choice) for pattern, colours in paints]
            self.facts += [short.facts(pattern, colours) for pattern, colours in paints]
            self.sizes.append(len(paints))


def paint_targets(labels):
    """The place of each picture's paint in every list of TextLists, and which colours of the second are true of it
    besides [pictures, colours]."""
    sets = [tuple(sorted({a, b} - {255})) for a, b in zip(labels["first"], labels["second"])]
    colours = SINGLES + PAIRS
    patterns = labels["pattern"]
    besides = numpy.array([[len(c) == 1 and len(s) == 2 and c[0] in s for c in colours] for s in sets])
    return (patterns, numpy.array([colours.index(s) for s in sets]),
            numpy.array([PAINTS.index((p, s)) for p, s in zip(patterns, sets)])), besides


def contrastive_loss(similarities, fits, unclear, captions):
    """Cross-entropy of pictures over all texts and of captions over pictures, between the softmax of similarities
    [pictures, texts] and the texts that are true of a picture, all of them alike."""
    similarities = similarities.masked_fill(torch.from_numpy(unclear), -1e4)
    fits = torch.from_numpy(fits.astype(numpy.float32))
    loss = 0
    for axis, values, wanted in ((1, similarities, fits), (0, similarities[:, :captions], fits[:, :captions])):
        target = wanted / wanted.sum(axis, keepdim=True).clamp(min=1)
        loss = loss - (target * F.log_softmax(values, axis)).sum(axis).mean() / 2
    return loss


@torch.no_grad()
def image_vectors_of(model, pictures):
    parts = numpy.array_split(numpy.arange(len(pictures)), max(1, len(pictures) // 50))
    return torch.cat([model.image_vectors(pictures.colours_of(part)) for part in parts])


@torch.no_grad()
def accuracy(model, tokenizer, pictures, vectors=None):
    """Shares of pictures whose nearest text is true of them: of the six patterns, of the pairs of two colours (of the
    single colours, for plain subjects) and of all patterns of colours. `one` compares with one text each (`a striped
    ball`), `mean` with the mean of the vectors of all words for pattern and things."""
    vectors = image_vectors_of(model, pictures) if vectors is None else vectors
    (patterns, colours, paints), besides = paint_targets(pictures.labels)
    plain = patterns == 0
    encode = lambda texts: model.text_vectors(tokens_of(tokenizer, texts))

    def mean_of(paint):
        texts = []
        for noun in (nouns[0] for nouns in NOUNS[:-1]):
            for adjective in range(1 if paint[0] is None else len(ADJECTIVES[paint[0]])):
                choice = lambda words: words[adjective % len(words)] if isinstance(words[0], str) else words[0]
                texts.append(ShortTexts(noun)(*paint, choice))
        return F.normalize(encode(texts).mean(0), dim=0)

    said = dict(pattern=patterns, colours=colours, pattern_and_colours=paints)
    result = {}
    for way in ("one", "mean"):
        found = {}
        for (name, wanted), paints_said in zip(said.items(), TextLists.said):
            texts = encode([ShortTexts("ball")(*paint) for paint in paints_said]) if way == "one" else torch.stack(
                [mean_of(paint) for paint in paints_said])
            scores = vectors @ texts.T
            if name == "colours":
                scores = scores.masked_fill(torch.from_numpy(besides), -2)
                # Pairs for what has two colours, single colours for what is plain.
                is_single = torch.tensor([len(c) == 1 for _, c in paints_said])
                scores = scores.masked_fill(torch.from_numpy(plain)[:, None] != is_single[None], -2)
            found[name] = scores.argmax(1).numpy() == wanted
        rate = lambda right: round(float(right.mean()), 4)
        result[way] = {name: rate(right) for name, right in found.items()}
        result[way]["colour_pairs"] = rate(found["colours"][~plain])
        result[way]["mean_over_patterns"] = {name: rate(numpy.array([right[patterns == i].mean() for i in set(patterns)]))
                                             for name, right in found.items()}
        result[way]["by_pattern"] = {p: {name: rate(right[patterns == i]) for name, right in found.items()}
                                     for i, p in enumerate(PATTERNS) if (patterns == i).any()}
    return result


@torch.no_grad()
def retrieval(model, tokenizer, pictures, vectors):
    """Share of pictures that are nearer to their own caption than to any other's that is not true of them."""
    texts = torch.cat([model.text_vectors(tokens_of(tokenizer, pictures.captions[i:i + 100]))
                       for i in range(0, len(pictures), 100)])
    scores = vectors @ texts.T
    fits, unclear = truth(*facts_of_pictures(pictures))
    others = scores.masked_fill(torch.from_numpy(fits | unclear), -2).max(1).values
    return round(float((scores.diagonal() > others).float().mean()), 4)


def config_of(model):
    """What the library's reference_clip is built from."""
    image, text = model.image, model.text.config
    return dict(
        _class_name="ReferenceClip", block_out_channels=[block.conv.out_channels for block in image.blocks],
        strides=[block.conv.stride[0] for block in image.blocks], norm_num_groups=image.blocks[0].norm.num_groups,
        norm_eps=NORM_EPSILON, hidden_size=image.hidden.out_features, projection_dim=image.projection.out_features,
        text_config={name: getattr(text, name) for name in (
            "vocab_size", "hidden_size", "intermediate_size", "num_hidden_layers", "num_attention_heads",
            "max_position_embeddings", "hidden_act", "layer_norm_eps")})


def tensors_of(model):
    """All tensors by their names in the file, in which the text encoder is `text_model`, as in CLIP's own files."""
    named = {}
    for name, value in model.state_dict().items():
        if not name.startswith(("log_scale", "local.")) and not name.endswith("position_ids"):
            # What transformers 4 calls text_model.x is x in transformers 5.
            named[re.sub(r"^text\.(text_model\.)?", "text_model.", name)] = value
    return named


def save_model(model, tokenizer_folder, out):
    out.mkdir(parents=True, exist_ok=True)
    (out / "config.json").write_text(json.dumps(config_of(model), indent=2) + "\n")
    tensors = tensors_of(model)
    save_file({name: value.half().contiguous() for name, value in tensors.items()}, out / "model.safetensors")
    (out / "model.safetensors").chmod(0o644)
    for name in ("vocab.json", "merges.txt", "tokenizer_config.json", "special_tokens_map.json"):
        if tokenizer_folder != out:
            shutil.copyfile(tokenizer_folder / name, out / name)
    return sum(value.numel() for value in tensors.values())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pictures", required=True, type=pathlib.Path, help="folder of make_pictures")
    parser.add_argument("--held-out", required=True, type=pathlib.Path, help="make_pictures --held-out --full-captions")
    parser.add_argument("--tokenizer", required=True, type=pathlib.Path, help="folder that train.py wrote")
    parser.add_argument("--work", required=True, type=pathlib.Path, help="folder of the checkpoint")
    parser.add_argument("--out", required=True, type=pathlib.Path, help="folder of the weights")
    parser.add_argument("--steps", type=int, default=2000)
    parser.add_argument("--batch", type=int, default=32)
    parser.add_argument("--rate", type=float, default=1.5e-3, help="highest learning rate")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=0, help="0 = all of the machine")
    parser.add_argument("--precision", choices=("bfloat16", "float32"), default="bfloat16", help="of products")
    arguments = parser.parse_args()
    if arguments.threads:
        torch.set_num_threads(arguments.threads)
    torch.manual_seed(arguments.seed)
    keep_freed_memory()
    precision = getattr(torch, arguments.precision)
    arguments.work.mkdir(parents=True, exist_ok=True)

    pictures, held_out = Pictures(arguments.pictures), Pictures(arguments.held_out)
    tokenizer = CLIPTokenizer.from_pretrained(arguments.tokenizer)
    facts, said = facts_of_pictures(pictures)
    targets, besides = paint_targets(pictures.labels)
    model = Embedder(text_config(tokenizer))
    run = TrainingRun("embedder", model, arguments.work / "embedder_checkpoint.pt", arguments.steps, arguments.rate,
                      arguments.seed, precision, minutes=3)
    timer = arguments.work / "embedder_seconds.json"
    seconds_before = json.loads(timer.read_text()) if timer.exists() and run.step else 0.0
    seconds = lambda: seconds_before + time.process_time()

    known = paints_of(pictures.labels)
    shown = numpy.unique(targets[2])

    def loss_of(random, generator):
        numbers = numpy.sort(random.choice(len(pictures), arguments.batch, replace=False))
        images, masks = pictures.colours_of(numbers), torch.from_numpy(pictures.subjects[numbers]).float() / 255
        mirrored = torch.from_numpy(random.random(len(numbers)) < 0.5)
        images[mirrored], masks[mirrored] = images[mirrored].flip(-1), masks[mirrored].flip(-1)
        images = augmented(images, random).to(precision).contiguous(memory_format=torch.channels_last)
        # The paints of the batch, and a few others; never one that no picture has.
        paints = numpy.union1d(targets[2][numbers], random.choice(shown, min(16, len(shown)), replace=False))
        lists = TextLists(random, paints)
        captions = [disturbed(pictures.captions[n], random) for n in numbers]
        vectors, rows, scores = model.image(images)
        # Captions are several times as long as the others.
        words = torch.cat([model.text_vectors(tokens_of(tokenizer, texts)) for texts in (captions, lists.texts)])
        similarities = model.log_scale.float().exp().clamp(max=100) * F.normalize(vectors, dim=-1) @ words.T
        said_here = numpy.concatenate([said[numbers], numpy.array(lists.facts)])
        fits, unclear = truth(facts[numbers], said_here)
        unknown = of_no_paint(facts[numbers], said_here, known)
        loss = contrastive_loss(similarities, fits, unclear | (unknown & ~fits), len(numbers))
        at = len(numbers)
        wanted = targets[0][numbers], targets[1][numbers], numpy.searchsorted(paints, targets[2][numbers])
        for i, size in enumerate(lists.sizes):
            left_out = unknown[:, at:at + size]
            if i == 1:
                left_out = left_out | besides[numbers]
            part = similarities[:, at:at + size].masked_fill(torch.from_numpy(left_out), -1e4)
            loss = loss + F.cross_entropy(part, torch.from_numpy(wanted[i]))
            at += size
        # What the places say by themselves: whether they are a subject's, and if so of which pattern.
        share = F.adaptive_avg_pool2d(masks[:, None], scores.shape[-2:])[:, 0]
        guesses = model.local(rows).float().transpose(1, 2)
        pattern = torch.from_numpy(targets[0][numbers])[:, None].expand(-1, guesses.shape[-1])
        weights = share.flatten(1)
        local = (weights * F.cross_entropy(guesses, pattern, reduction="none")).sum() / weights.sum().clamp(min=1)
        return loss + local + F.binary_cross_entropy_with_logits(scores, share)

    def trained():
        """The weights as they are: their running mean lags behind a run as short as this."""
        copy = Embedder(text_config(tokenizer))
        copy.load_state_dict(run.masters)
        return copy.float().eval()

    def show(step):
        timer.write_text(json.dumps(seconds()))
        now = trained()
        save_model(now, arguments.tokenizer, arguments.out)
        right = accuracy(now, tokenizer, held_out)
        print(f"embedder: step {step} held out, one text: {right['one']}\n"
              f"embedder: step {step} held out, mean of texts: {right['mean']}", flush=True)

    run.train(loss_of, arguments.batch, show=show)

    # What is judged has the numbers of the file.
    model = trained().half().float()
    parameters = save_model(model, arguments.tokenizer, arguments.out)
    vectors = image_vectors_of(model, held_out)
    (arguments.out / "training.json").write_text(json.dumps(dict(
        pictures=len(pictures), held_out=len(held_out), steps=run.step, batch=arguments.batch, rate=arguments.rate,
        seed=arguments.seed, processor_seconds=round(seconds()), parameters=parameters,
        loss=round(float(numpy.mean(run.losses[-100:])), 4),
        temperature=round(1 / min(100.0, model.log_scale.exp().item()), 5),
        held_out_accuracy=dict(accuracy(model, tokenizer, held_out, vectors),
                               captions=retrieval(model, tokenizer, held_out, vectors))), indent=2) + "\n")
    print((arguments.out / "training.json").read_text())


if __name__ == "__main__":
    main()
