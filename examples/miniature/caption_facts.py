# SPDX-License-Identifier: MIT
"""What captions and shorter texts say of a picture of the small world, and of which pictures that is true."""

import re

import numpy

PATTERNS = ("plain", "checker", "stripes", "dots", "bricks", "waves")
COLOURS = ("red", "yellow", "green", "blue", "white", "black")
UNEVEN = (3, 4)  # patterns whose first colour is the one below: dots and bricks
ADJECTIVES = (("plain",), ("checkered", "checked", "chequered"), ("striped", "stripy"),
              ("dotted", "spotted", "polka dot"), ("brick",), ("wavy",))
PARTS = (("paint",), ("checks", "squares", "checkers"), ("stripes", "bands"), ("dots", "spots"), ("bricks",),
         ("waves", "wavy lines"))
NOUNS = (("ball", "sphere"), ("egg",), ("vase",), ("box", "cube"), ("pillar", "column"), ("figure", "puppet", "person"),
         ("thing", "shape", "toy"))  # the last ones: things of several shapes
NUMBERS = ("a", "an", "two", "three", "four")
LIGHTS = ("clear sky|blue sky|sunny", "cloud", "sunset|evening", "night|moonlight", "mist|fog",
          "in daylight|bright room", "lamp light|warm light")
UNSAID, ABSENT = -1, 255  # ABSENT: what a picture without a ground, a wall or a second colour has in their places

# What a text says, one column each; `shape` and `number` are said by captions alone, the others are labels too.
LABELS = ("pattern", "material", "light", "ground_pattern", "ground_colour", "wall_pattern", "wall_colour")
COLUMNS = LABELS + ("first", "second", "shape", "number")

_PLACES = re.compile(r",? (?:on |in the air|floating|in a |under |with clouds|at |in (?:evening|moonlight|mist|fog|lamp|"
                     r"warm|daylight))")
_COLOUR = re.compile(rf"\b(?:{'|'.join(COLOURS)})\b")
_PATTERN_WORDS = [(re.compile(rf"\b{word}\b"), i) for i in range(1, 6) for word in ADJECTIVES[i] + PARTS[i]]
_PATTERN_WORDS.append((re.compile(r"\bplain\b"), 0))


def plural_of(noun):
    return "people" if noun == "person" else noun + ("es" if noun.endswith("x") else "s")


_NOUN_WORDS = {word: i for i, nouns in enumerate(NOUNS) for noun in nouns for word in (noun, plural_of(noun))}


def _pattern_in(words):
    for expression, pattern in _PATTERN_WORDS:
        if expression.search(words):
            return pattern
    return UNSAID


def _backdrop(words):
    """Pattern and colour of `green checkered floor`; a colour alone says nothing of the pattern."""
    colour = _COLOUR.search(words)
    return _pattern_in(words), COLOURS.index(colour.group()) if colour else UNSAID


def facts_of(caption):
    """What a caption says: a number for each of COLUMNS."""
    said = dict.fromkeys(COLUMNS, UNSAID)
    caption = re.sub("^a (picture|painting) of ", "", caption)
    cut = _PLACES.search(caption)
    things, rest = (caption[:cut.start()], caption[cut.start():]) if cut else (caption, "")
    said["pattern"] = _pattern_in(things)
    for name, colour in zip(("first", "second"), _COLOUR.findall(things)):
        said[name] = COLOURS.index(colour)
    for i, material in ((1, "wooden"), (2, "stone")):
        if material in things:
            said["material"] = i
    words = things.split(" ")
    said["shape"] = next((_NOUN_WORDS[word] for word in words if word in _NOUN_WORDS), UNSAID)
    # `some` says that there are several: 0.
    said["number"] = max(1, NUMBERS.index(words[0])) if words[0] in NUMBERS else 0
    for i, light in enumerate(LIGHTS):
        if re.search(light, rest):
            said["light"] = i
    ground = re.search(r"on (?:an? )?([a-z ]*?) ?(ground|floor)\b", rest)
    if ground:
        said["ground_pattern"], said["ground_colour"] = _backdrop(ground.group(1))
    for words, colour in (("on grass", 2), ("on sand", 1), ("on snow", 4)):
        if words in rest:
            said["ground_pattern"], said["ground_colour"] = 0, colour
    if "in the air" in rest or "in the sky" in rest and "floating" in rest:
        said["ground_pattern"] = said["ground_colour"] = ABSENT
    wall = re.search(r"in a room with ([a-z ]*?) walls", rest)
    if wall:
        said["wall_pattern"], said["wall_colour"] = _backdrop(wall.group(1))
    wall = re.search(r"in a (\w+) room", rest)
    if wall and wall.group(1) in COLOURS:
        said["wall_pattern"], said["wall_colour"] = 0, COLOURS.index(wall.group(1))
    return [said[name] for name in COLUMNS]


def facts_of_pictures(pictures):
    """Facts [pictures, columns] of pictures: labels, and of shapes and their number what the captions say."""
    facts = numpy.array([facts_of(caption) for caption in pictures.captions])
    said = facts.copy()
    for name in LABELS + ("first", "second"):
        facts[:, COLUMNS.index(name)] = pictures.labels[name]
    return facts, said


def truth(facts, said):
    """Of every picture and every text [pictures, texts]: whether the text is true of it, and whether that is not known."""
    column = lambda values, name: values[:, COLUMNS.index(name)]
    picture = {name: column(facts, name)[:, None] for name in COLUMNS}
    text = {name: column(said, name)[None] for name in COLUMNS}
    wrong = numpy.zeros((len(facts), len(said)), bool)
    unclear = wrong.copy()
    for name in LABELS:
        wrong |= (text[name] != UNSAID) & (text[name] != picture[name])
    # Colours are said in either order, and one of the two may be left out.
    for name in ("first", "second"):
        wrong |= (text[name] != UNSAID) & (text[name] != picture["first"]) & (text[name] != picture["second"])
    uneven = (picture["pattern"] == UNEVEN[0]) | (picture["pattern"] == UNEVEN[1])
    unclear |= uneven & (text["first"] != UNSAID) & (text["first"] != picture["first"])
    # Balls are things too, if there are several.
    said_shape, mixed = text["shape"] != UNSAID, len(NOUNS) - 1
    several = picture["number"] != 1
    unclear |= (text["shape"] == mixed) & (picture["shape"] != mixed) & several
    wrong |= said_shape & (text["shape"] != picture["shape"]) & ~((text["shape"] == mixed) & several)
    said_number = text["number"] != UNSAID
    both = (text["number"] > 0) & (picture["number"] > 0)
    wrong |= said_number & both & (text["number"] != picture["number"])
    wrong |= said_number & ((text["number"] == 1) != (picture["number"] == 1))
    unclear |= said_number & (text["number"] > 1) & (picture["number"] == 0)
    return ~wrong & ~unclear, unclear & ~wrong


def paints_of(labels):
    """Which patterns there are of which pairs of colours, in either order [patterns, 7, 7]: 6 where there is no second
    colour, which says nothing."""
    known = numpy.zeros((len(PATTERNS), len(COLOURS) + 1, len(COLOURS) + 1), bool)
    first, second = (numpy.minimum(labels[name], len(COLOURS)) for name in ("first", "second"))
    known[labels["pattern"], first, second] = True
    known |= known.transpose(0, 2, 1)
    known[0] = known[:, len(COLOURS)] = known[:, :, len(COLOURS)] = True
    return known


def of_no_paint(facts, said, known):
    """Of every picture and every text [pictures, texts]: whether what the text says of the paint, and for the rest the
    picture's own, make a paint that is not `known`. That the text is not true of the picture then teaches nothing but
    that such paints are never shown."""
    column = lambda values, name: values[:, COLUMNS.index(name)]
    pattern = numpy.where(column(said, "pattern")[None] != UNSAID, column(said, "pattern")[None],
                          column(facts, "pattern")[:, None])
    has_pair = (column(said, "second") != UNSAID)[None]
    first, second = (numpy.minimum(numpy.where(has_pair, column(said, name)[None], column(facts, name)[:, None]),
                                   len(COLOURS)) for name in ("first", "second"))
    return ~known[pattern, first, second]


class ShortTexts:
    """Texts that say a pattern, colours or both, of a noun or of none."""

    def __init__(self, noun=None, several=False):
        self.noun = noun
        if noun:
            self.noun = plural_of(noun) if several else noun
        self.several = several

    @classmethod
    def drawn(cls, random):
        """Half of them with a noun."""
        nouns = NOUNS[random.integers(len(NOUNS))]
        return cls(nouns[random.integers(len(nouns))] if random.random() < 0.5 else None, random.random() < 0.3)

    def facts(self, pattern, colours):
        said = dict.fromkeys(COLUMNS, UNSAID)
        if pattern is not None:
            said["pattern"] = pattern
        for name, colour in zip(("first", "second"), colours):
            said[name] = colour
        if self.noun:
            said["shape"] = _NOUN_WORDS[self.noun]
            said["number"] = 0 if self.several else 1
        return [said[name] for name in COLUMNS]

    def __call__(self, pattern, colours, choice=lambda words: words[0]):
        """`choice` takes one of several words or orders."""
        colours = " and ".join(COLOURS[colour] for colour in choice((colours, colours[::-1])))
        if self.noun is None:
            named = () if pattern is None else ADJECTIVES[pattern] + (PARTS[pattern] if pattern > 0 else ())
            return " ".join(part for part in (colours, choice(named) if named else "") if part)
        adjective = "" if pattern is None else choice(ADJECTIVES[pattern])
        part = choice(PARTS[pattern]) if pattern else ""
        after = ""
        if colours and choice((False, True, False)):
            after = " in " + colours if pattern is None or choice((True, False)) or not pattern else f" with {colours} {part}"
            adjective = "" if " with " in after else adjective
            colours = ""
        elif part and not colours and choice((False, False, True)):
            after, adjective = " with " + part, ""
        # A plain thing has its colour behind `plain`.
        words = (adjective, colours) if pattern == 0 else (colours, adjective)
        words = " ".join([word for word in words if word] + [self.noun])
        article = "some" if self.several else "an" if words[0] in "aeiou" else "a"
        return f"{article} {words}{after}"
