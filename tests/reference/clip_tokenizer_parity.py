# SPDX-License-Identifier: MIT
"""CLIP's tokenizer against transformers' CLIPTokenizer, on the vocabulary of CLIP, with 10000 prompts for each of six folders.

Needs Python 3.10 or later with transformers 5 and open_clip, whose copy of CLIP's merges is read; neither PyTorch nor ftfy:

    cmake --build --preset test --target clip_tokenizer_parity
    python3 tests/reference/clip_tokenizer_parity.py build/test/tests/clip_tokenizer_parity

Prompts are random and adversarial, and drawn by seed: sentences, characters of all of Unicode, emoji, combining marks, control
characters, capitals, contractions, names of special tokens, and long ones. Left out are characters that only one side knows, of
Unicode versions that differ, and marks whose canonical order transformers does not know; how many is printed.
Exits with 0 if all ids are equal, 1 if not, and 77 if a package is missing.
"""

import gzip
import importlib.util
import json
import pathlib
import random
import subprocess
import sys
import tempfile
import unicodedata

try:
    from tokenizers import normalizers
    from transformers import CLIPTokenizer
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

START, END = "<|startoftext|>", "<|endoftext|>"


def clip_merges():
    """CLIP's 48894 merges as open_clip has them, without importing it: that would import PyTorch."""
    spec = importlib.util.find_spec("open_clip")
    if spec is None:
        print("skipped: No module named 'open_clip'")
        sys.exit(77)
    path = pathlib.Path(spec.submodule_search_locations[0]) / "bpe_simple_vocab_16e6.txt.gz"
    return gzip.decompress(path.read_bytes()).decode("utf-8").split("\n")[1:48895]


def clip_vocabulary(merges):
    """Bytes within and at the end of words, in the order of their letters; what merges make; the special tokens."""
    printable = [*range(0x21, 0x7F), *range(0xA1, 0xAD), *range(0xAE, 0x100)]
    letters = [chr(b) for b in printable] + [chr(0x100 + i) for i in range(256 - len(printable))]
    tokens = letters + [letter + "</w>" for letter in letters] + ["".join(m.split()) for m in merges] + [START, END]
    return {token: i for i, token in enumerate(tokens)}


def token(content, **flags):
    return {"content": content, "lstrip": False, "normalized": True, "rstrip": False, "single_word": False, **flags}


def write_folders(root):
    """Folders as people have them: Stable Diffusion 1 and 2, newer writers, tokenizer.json, and tokens learnt later."""
    merges = clip_merges()
    texts = {"vocab.json": json.dumps(clip_vocabulary(merges)), "merges.txt": "\n".join(["#version: 0.2", *merges, ""])}
    config = {"tokenizer_class": "CLIPTokenizer", "model_max_length": 77, "do_lower_case": True, "add_prefix_space": False,
              "pad_token": END, **{
                  name: {"__type": "AddedToken", **token(content)}
                  for name, content in (("bos_token", START), ("eos_token", END), ("unk_token", END))}}
    special = {"bos_token": token(START), "eos_token": token(END), "unk_token": token(END)}
    decoder = {"49406": token(START, special=True), "49407": token(END, special=True)}
    names = {"bos_token": START, "eos_token": END, "unk_token": END, "pad_token": END}
    folders = {
        "sd1": {"tokenizer_config.json": config, "special_tokens_map.json": {**special, "pad_token": END}},
        "sd2": {"tokenizer_config.json": config, "special_tokens_map.json": {**special, "pad_token": "!"}},
        "newer": {"tokenizer_config.json": {
            **names, "pad_token": "!", "model_max_length": 77, "tokenizer_class": "CLIPTokenizer",
            "added_tokens_decoder": {"0": token("!", normalized=False, special=True), **decoder}}},
        "learnt": {"tokenizer_config.json": {**config, "model_max_length": 50}, "special_tokens_map.json": special,
                   "added_tokens.json": {"<cat-toy>": 49408, "<Cat-Toy>x": 49409, "Straße": 49410, "e\u0301": 49411}},
        "bare": {},
    }
    for name, files in folders.items():
        folder = root / name
        folder.mkdir()
        for file, text in texts.items():
            (folder / file).write_text(text, encoding="utf-8")
        for file, content in files.items():
            (folder / file).write_text(json.dumps(content), encoding="utf-8")
    (root / "one_file").mkdir()
    CLIPTokenizer.from_pretrained(root / "sd1").backend_tokenizer.save(str(root / "one_file" / "tokenizer.json"))
    return [*folders, "one_file"]


def known_characters(program):
    """Characters that Python and the program assign, but for marks that transformers does not order as Unicode does."""
    nfc = normalizers.NFC()
    # A mark of each class, all of them as old as Unicode 3.2.
    old = unicodedata.ucd_3_2_0
    by_class = {old.combining(chr(c)): chr(c) for c in reversed(range(0x300, 0x3100)) if old.combining(chr(c))}
    characters, strange = [], []

    def is_ordered(c):
        probes = [c, f"a{c}\u0301", f"e\u0328{c}\u0301"]
        if unicodedata.category(c)[0] == "M":
            probes += [f"1{mark}{c}" for mark in by_class.values()] + [f"1{c}{mark}" for mark in by_class.values()]
        return all(nfc.normalize_str(probe) == unicodedata.normalize("NFC", probe) for probe in probes)

    for line in subprocess.run([program, "--assigned"], check=True, capture_output=True, text=True).stdout.splitlines():
        first, last = map(int, line.split())
        for point in range(first, last + 1):
            c = chr(point)
            if 0xD800 <= point < 0xE000 or unicodedata.category(c) == "Cn":
                continue
            (characters if is_ordered(c) else strange).append(c)
    print(f"characters: {len(characters)}; left out are {len(strange)} that transformers does not put in canonical order, "
          f"U+{ord(strange[0]):04X} to U+{ord(strange[-1]):04X}" if strange else "")
    return characters


WORDS = """a the of photo painting render woman man dog Cat castle Tokyo night HDR 8k 4K artstation trending very
highly-detailed portrait, sunset. (masterpiece:1.2) [bad] {x|y} red-and-white chequered ball on green ground it's don't
we're they've I'm she'll he'd DON'T IT'S 's 't x'y rock'n'roll naïve café Äpfel Straße İstanbul ΣΊΣΥΦΟΣ ΑΣ Ǆungla ﬁne
Å K Ω ﷺ 東京 カタカナ ｶﾞ 한국어 देवनागरी ไทย עִבְרִית العربية Русский ½ ² Ⅷ ١٢٣ १२३ ６ 123 4567 3.14 1,000 $5 50% #tag @you
C++ a_b http://x.y/z?q=1&r=2 :) <3 --- ... !! ?! “quoted” ‘single’ it’s «x» – — … • ™ © € 🙂 👩‍🚀 👨‍👩‍👧‍👦 🏳️‍🌈 🇩🇪 👍🏽 ❤️ 1️⃣
supercalifragilisticexpialidocious antidisestablishmentarianism zzzzzzzzzzzz aaaaaaaaaaaaaaaaaaaa""".split()
NAMES = [START, END, "<|STARTOFTEXT|>", "<|EndOfText|>", "<|endoftext|", "|endoftext|>", "<|endof", "text|>", "<|", "|>",
         "<", ">", "!", "!!", "<cat-toy>", "<CAT-TOY>", "<Cat-Toy>x", "<cat-toy>x", "Straße", "STRASSE", "straße", "é", "e",
         "\u0301", "</w>", "a</w>", "<unk>"]
CONTROLS = [*map(chr, range(0x21)), *map(chr, range(0x7F, 0xA1)), "\u1680", "\u2000", "\u200A", "\u2028", "\u2029", "\u202F",
            "\u205F", "\u3000", "\u180E", "\u200B", "\u200C", "\u200D", "\u2060", "\uFEFF", "\u00AD", "\u202E", "\u2066"]
ODD = ["\uFFFD", "\uFFFE", "\uFFFF", "\uFDD0", "\U0001FFFE", "\U0010FFFF", "\U0010FFFD", "\uE000", "\U000F0000",
       "\U000E0001", "\U000E0041", "\uFE0F", "\uFE0E", "\u20E3"]


def prompts(characters, count):
    """Random prompts: of each kind as many as of the others."""
    draw = random.Random(14)
    marks = [c for c in characters if unicodedata.category(c)[0] == "M"]
    numbers = [c for c in characters if unicodedata.category(c)[0] == "N"]
    cased = [c for c in characters if unicodedata.category(c) in ("Lu", "Lt") or c.lower() != c]
    symbols = [c for c in characters if unicodedata.category(c) == "So" and ord(c) > 0x2000]
    jamo = [chr(c) for c in (*range(0x1100, 0x1200), *range(0xAC00, 0xAC80))]
    below = [c for c in characters if ord(c) < 0x3000]

    def some(pool, most, joint=""):
        return joint.join(draw.choice(pool) for _ in range(draw.randint(0, most)))

    def sentence(most=30):
        return some(WORDS, most, draw.choice((" ", " ", " ", ", ", "", "  ", "\n")))

    def block():
        begin = draw.randrange(len(characters))
        return some(characters[begin:begin + draw.choice((16, 128, 1024))], 60)

    def changed():
        text = list(sentence())
        for _ in range(draw.randint(0, 6)):
            at = draw.randint(0, len(text))
            text[at:at + draw.randint(0, 2)] = draw.choice((draw.choice(below), draw.choice(CONTROLS), draw.choice(marks), ""))
        return "".join(text)

    kinds = [
        sentence,
        changed,
        block,
        lambda: sentence().upper(),
        lambda: some(characters, 80),
        lambda: some(below, 80),
        lambda: some(cased, 40),
        lambda: some(numbers, 40, draw.choice(("", " ", ".", "a"))),
        lambda: some(symbols + ["\u200D", "\uFE0F", "🏽", "🇫", "🇷"], 40),
        lambda: "".join(draw.choice(below) + some(marks, 5) for _ in range(draw.randint(0, 12))),
        lambda: some(jamo, 40),
        lambda: some(CONTROLS + ["a", "B", "1", "'", "s"], 40),
        lambda: some(ODD + ["a", " ", "'"], 30),
        lambda: some(NAMES + ["a", " ", "'s", "B"], 20),
        lambda: some(NAMES + WORDS, 20, draw.choice(("", " "))),
        lambda: some(["'s", "'S", "'", "’", "'re", "'RE", "'ll", "'v", "e", "d", " ", "!", "'d1"], 30),
        lambda: some(list("abcdefghijklmnopqrstuvwxyz"), draw.choice((5, 40, 400))),
        lambda: sentence(draw.choice((70, 80, 100, 400))),
        lambda: draw.choice(characters) * draw.randint(1, 200),
        lambda: unicodedata.normalize(draw.choice(("NFD", "NFKD", "NFC")), sentence() + block()),
    ]
    return [kinds[i % len(kinds)]() for i in range(count)]


def main():
    program = sys.argv[1]
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 10000
    texts = prompts(known_characters(program), count)
    failed = False
    with tempfile.TemporaryDirectory() as temporary:
        root = pathlib.Path(temporary)
        (root / "prompts.json").write_text(json.dumps(texts), encoding="utf-8")
        for name in write_folders(root):
            tokenizer = CLIPTokenizer.from_pretrained(root / name)
            length = min(tokenizer.model_max_length, 77)
            run = subprocess.run([program, root / name, root / "prompts.json", root / "ids.txt"], check=True,
                                 capture_output=True, text=True)
            expected = tokenizer(texts, padding="max_length", truncation=True, max_length=length)["input_ids"]
            lengths = map(len, tokenizer(texts)["input_ids"])
            lines = (root / "ids.txt").read_text().splitlines()
            assert len(lines) == len(texts)
            equal = differing = 0
            for text, ids, whole, line in zip(texts, expected, lengths, lines):
                *found, cut = map(int, line.split())
                if found == ids and cut == max(0, whole - length):
                    equal += 1
                elif (differing := differing + 1) <= 3:
                    print(f"{text!a}: {found} and {cut} cut, expected {ids} and {max(0, whole - length)} cut")
            print(f"{name}: {equal} of {len(texts)} equal; {run.stdout.strip()}")
            failed = failed or equal != len(texts)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
