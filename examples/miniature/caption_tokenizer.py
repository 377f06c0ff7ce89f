# SPDX-License-Identifier: MIT
"""A CLIP tokenizer for the small world's captions: byte-pair encoding whose merges are learnt from them."""

import collections
import json
import re

START, END = "<|startoftext|>", "<|endoftext|>"
LENGTH = 77


def byte_characters():
    """The character that stands for each byte: itself where it is printed, else one from 256 on."""
    printed = [*range(33, 127), *range(161, 173), *range(174, 256)]
    characters = {byte: chr(byte) for byte in printed}
    for byte in range(256):
        if byte not in characters:
            characters[byte] = chr(256 + len(characters) - len(printed))
    return characters


def learn_merges(captions):
    """Merges, the most frequent pair first, until every word of the captions is one token."""
    counts = collections.Counter(word for caption in captions for word in re.findall(r"[a-z]+|[^\sa-z]+", caption))
    words = {word: [*word[:-1], word[-1] + "</w>"] for word in counts}
    merges = []
    while True:
        pairs = collections.Counter()
        for word, parts in words.items():
            for pair in zip(parts, parts[1:]):
                pairs[pair] += counts[word]
        if not pairs:
            return merges
        # The first in the alphabet of those that are equally frequent, so that the result has one order.
        best = min(pairs, key=lambda pair: (-pairs[pair], pair))
        merges.append(best)
        for word, parts in words.items():
            i = 0
            while i + 1 < len(parts):
                if (parts[i], parts[i + 1]) == best:
                    parts[i:i + 2] = [parts[i] + parts[i + 1]]
                i += 1


def write_tokenizer(captions, folder):
    """The files of transformers' CLIPTokenizer."""
    folder.mkdir(parents=True, exist_ok=True)
    # Bytes in the order of CLIP: those that are printed, then the others.
    characters = byte_characters()
    alphabet = sorted(characters.values(), key=lambda c: (ord(c) >= 256, ord(c)))
    merges = learn_merges(captions)
    tokens = alphabet + [c + "</w>" for c in alphabet] + ["".join(pair) for pair in merges] + [START, END]
    if len(set(tokens)) != len(tokens):
        raise ValueError("two merges make one token: expected words of few letters")
    write = lambda name, text: (folder / name).write_text(text, encoding="utf-8")
    write("vocab.json", json.dumps({token: i for i, token in enumerate(tokens)}, ensure_ascii=False) + "\n")
    write("merges.txt", "#version: 0.2\n" + "".join(f"{left} {right}\n" for left, right in merges))
    special = dict(bos_token=START, eos_token=END, unk_token=END, pad_token=END)
    write("special_tokens_map.json", json.dumps(special, indent=2) + "\n")
    write("tokenizer_config.json", json.dumps(dict(
        tokenizer_class="CLIPTokenizer", model_max_length=LENGTH, add_prefix_space=False, do_lower_case=True,
        errors="replace", **special), indent=2) + "\n")
