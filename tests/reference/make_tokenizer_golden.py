# SPDX-License-Identifier: MIT
"""Writes data/clip_tokenizer/: a small vocabulary in the files of CLIP's tokenizer, trained here, and what transformers makes
of prompts with it, in golden.json.

Needs Python 3.10 or later with transformers 5 (neither PyTorch nor ftfy):

    pip install transformers
    python3 tests/reference/make_tokenizer_golden.py

The tests read the files and never run Python. Six folders are tried, whose files beside vocab.json and merges.txt, or
tokenizer.json, stand in golden.json.
"""

import collections
import json
import pathlib
import random
import tempfile
import unicodedata

from transformers import CLIPTokenizer

FOLDER = pathlib.Path(__file__).resolve().parents[1] / "data" / "clip_tokenizer"
START, END = "<|startoftext|>", "<|endoftext|>"
draw = random.Random(77)

PRINTABLE = [*range(0x21, 0x7F), *range(0xA1, 0xAD), *range(0xAE, 0x100)]
OTHERS = [b for b in range(256) if b not in PRINTABLE]
LETTERS = {b: chr(b) for b in PRINTABLE} | {b: chr(0x100 + i) for i, b in enumerate(OTHERS)}


def written_text():
    """Captions of a small world, in which words are as frequent as they happen to be."""
    materials = "plain striped checkered dotted marble wooden woven camouflage scaled brick".split()
    colours = "red green blue yellow purple white black orange golden brown".split()
    things = "ball cube man woman dog house chair table tree bottle".split()
    places = "on green ground|under a blue sky|in a dark room|by the sea|in morning light|at night, it's raining".split("|")
    names = ["".join(draw.choice("ba ke li mo nu ra se ti vo wu zan chor".split()) for _ in range(3)) for _ in range(150)]
    return " ".join(f"{draw.choice(names)}: a {draw.choice(colours)} and {draw.choice(colours)} {draw.choice(materials)} {draw.choice(things)} "
                    f"{draw.choice(places)}, the café's {draw.choice(things)} !!" for _ in range(400))


def trained(text, count):
    """The most frequent pair of neighbours becomes one token, `count` times; of equals the first in the alphabet."""
    words = collections.Counter(
        tuple(LETTERS[b] for b in word.encode()[:-1]) + (LETTERS[word.encode()[-1]] + "</w>",)
        for word in text.replace("'s", " 's").replace(",", " ,").split())
    merges = []
    for _ in range(count):
        pairs = collections.Counter()
        for word, times in words.items():
            for pair in zip(word, word[1:]):
                pairs[pair] += times
        if not pairs:
            break
        best = min(pairs, key=lambda pair: (-pairs[pair], pair))
        merges.append(best)
        merged = collections.Counter()
        for word, times in words.items():
            parts, i = [], 0
            while i < len(word):
                step = 2 if word[i:i + 2] == best else 1
                parts.append("".join(word[i:i + step]))
                i += step
            merged[tuple(parts)] += times
        words = merged
    return merges


def token(content, **flags):
    return {"content": content, "lstrip": False, "normalized": True, "rstrip": False, "single_word": False, **flags}


def random_prompts():
    """Prompts that mix words of the small world with whatever there is."""
    words = """red Green BLUE checkered ball camouflages it's IT'S don't we're they've I'm she'll he'd café CAFÉ cafe\u0301 naïve
        İstanbul ΣΑΣ Straße ẞ Ǆ ﬁ Å K 東京 한국 한 हिन्दी ไทย שָׁלוֹם ½ ² Ⅷ ١٢ 42 3.14 !! ?! ... ( ) [x] a_b x'y 's '
        🙂 👩‍🚀 🇩🇪 👍🏽 ❤️ <|startoftext|> <|ENDOFTEXT|> <|endoftext|> <|StartOfText|> <| |> <cat-toy> <CAT-TOY> Dogs""".split()
    odd = ["\0", "\t", "\n", "\u0085", "\u00A0", "\u00AD", "\u200B", "\u200D", "\u2028", "\u3000", "\uFEFF", "\uFFFD", "\uFFFE",
           "\U0010FFFF", "\uE000", "\u0301", "\u0323", "\u0307", "\u0345", "\u1112", "\u1161", "\u11AB", "\u180E", "'", "’"]
    # As old as Unicode 3.2, which every library knows.
    old = [chr(c) for c in range(0x21, 0x2FFF) if unicodedata.ucd_3_2_0.category(chr(c)) not in ("Cn", "Cs")]
    for i in range(45):
        yield draw.choice((" ", " ", "", ", ")).join(draw.choice(words) for _ in range(draw.randint(0, 9)))
        yield "".join(draw.choice(words + odd + [" "]) for _ in range(draw.randint(1, 7)))
        yield "".join(draw.choice(old) for _ in range(draw.randint(1, 10)))
        yield "".join(draw.choice(odd + list("aB1 ")) for _ in range(draw.randint(1, 10)))


def main():
    merges = trained(written_text(), 300)
    tokens = [*LETTERS.values(), *(letter + "</w>" for letter in LETTERS.values()), *map("".join, merges), START, END]
    assert len(set(tokens)) == len(tokens)
    vocabulary = {text: i for i, text in enumerate(tokens)}
    next_id = len(tokens)
    texts = {"vocab.json": json.dumps(vocabulary, ensure_ascii=False, separators=(",", ":")) + "\n",
             "merges.txt": "\n".join(["#version: 0.2", *map(" ".join, merges), ""])}

    # A tokenizer.json that lacks most bytes: whatever needs them is unknown.
    few = [t for t in tokens if t in map("".join, merges) or t in (START, END) or t.removesuffix("</w>") in "".join(
        map("".join, merges)).replace("</w>", "") or t.removesuffix("</w>") in "0123456789!?"]
    few_ids = {text: i for i, text in enumerate(few)}
    assert len(few) < len(tokens) / 2 + 150
    tokenizer_json = {
        "version": "1.0", "truncation": None, "padding": None,
        "added_tokens": [{"id": few_ids[START], **token(START, special=True)},
                         {"id": few_ids[END], **token(END, normalized=False, special=True)}],
        "model": {"type": "BPE", "dropout": None, "unk_token": END, "continuing_subword_prefix": "",
                  "end_of_word_suffix": "</w>", "fuse_unk": False, "vocab": few_ids,
                  "merges": [list(m) if i % 2 else " ".join(m) for i, m in enumerate(merges)]}}
    texts["tokenizer.json"] = json.dumps(tokenizer_json, ensure_ascii=False, separators=(",", ":")) + "\n"

    config = {"tokenizer_class": "CLIPTokenizer", "model_max_length": 77, "do_lower_case": True, "pad_token": END, **{
        name: {"__type": "AddedToken", **token(content)}
        for name, content in (("bos_token", START), ("eos_token", END), ("unk_token", END))}}
    special = {"bos_token": token(START), "eos_token": token(END), "unk_token": token(END), "pad_token": "!"}
    pair = ["vocab.json", "merges.txt"]
    folders = [
        ("Stable Diffusion 1", pair, {"tokenizer_config.json": config}),
        ("Stable Diffusion 2", pair, {"tokenizer_config.json": config, "special_tokens_map.json": special}),
        ("a newer writer", pair, {"tokenizer_config.json": {
            "bos_token": START, "eos_token": END, "unk_token": END, "pad_token": "!", "model_max_length": 20,
            "added_tokens_decoder": {"0": token("!", normalized=False, special=True),
                                     str(next_id - 2): token(START, special=True), str(next_id - 1): token(END, special=True)}}}),
        ("tokens learnt later", pair, {
            "tokenizer_config.json": {**config, "model_max_length": 12}, "special_tokens_map.json": special,
            "added_tokens.json": {"<cat-toy>": next_id, "Dogs": next_id + 1, "cafe\u0301": next_id + 2}}),
        ("no configuration", pair, {}),
        ("one file and unknown bytes", ["tokenizer.json"], {"tokenizer_config.json": {"model_max_length": 24}}),
    ]
    prompts = ["", " ", "a red and white checkered ball on green ground", "x" * 300, "a red ball " * 30, "!" * 100, "!! !",
               START + END, "İIıi", "e\u0323\u0302 e\u0302\u0323 ệ", "q\u0307\u0323 q\u0323\u0307", *random_prompts()]

    golden = {"computed_by": "transformers' CLIPTokenizer", "written_by": "tests/reference/make_tokenizer_golden.py",
              "prompts": prompts, "folders": []}
    for name, shared, files in folders:
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            for file in shared:
                (folder / file).write_text(texts[file], encoding="utf-8")
            for file, content in files.items():
                (folder / file).write_text(json.dumps(content), encoding="utf-8")
            tokenizer = CLIPTokenizer.from_pretrained(folder)
            length = min(tokenizer.model_max_length, 77)
            outputs = []
            for prompt in prompts:
                whole = tokenizer(prompt)["input_ids"]
                found = tokenizer(prompt, padding="max_length", truncation=True, max_length=length)
                ids, kept = found["input_ids"], sum(found["attention_mask"])
                assert len(ids) == length and all(i == tokenizer.pad_token_id for i in ids[kept:])
                outputs.append([max(0, len(whole) - length), *ids[:kept]])
        golden["folders"].append({"name": name, "shared": shared, "files": files, "context_length": length,
                                  "padding": tokenizer.pad_token_id, "cut_and_ids": outputs})

    FOLDER.mkdir(exist_ok=True)
    for file, text in texts.items():
        (FOLDER / file).write_text(text, encoding="utf-8")
    # A list of ids, and a prompt, a line.
    text = json.dumps(golden, separators=(",", ":"))
    text = text.replace('],[', '],\n[').replace('","', '",\n"').replace('},{"name"', '},\n{"name"')
    assert json.loads(text) == golden
    (FOLDER / "golden.json").write_text(text + "\n")


main()
