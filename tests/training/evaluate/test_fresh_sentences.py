"""The fresh and the unseen sentences: none of the eighty, none in the corpus, rules that a puppet shows to be fair."""

from __future__ import annotations

import re
import zlib
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import training.evaluate
from motion.metrics.sentences import kept_out, load_sentences, read_sentences, without_sentences
from motion.metrics.sentences.joints import Motion
from motion.transforms import mirrored
from training.corpus.captions import FAMILIES, Phrasebook
from training.corpus.grammar import expand
from training.corpus.phrases import ACTIONS, ENTRIES

from . import fresh_scripts, unseen_scripts
from .puppets import play

FRESH, UNSEEN = PATHS = [
    Path(training.evaluate.__file__).with_name(f"{name}_sentences.json") for name in ("fresh", "unseen")
]
SETS = {path: {sentence.id: sentence for sentence in read_sentences(path)} for path in PATHS}
SENTENCES = SETS[FRESH] | SETS[UNSEEN]
SCRIPTS = fresh_scripts.SCRIPTS | unseen_scripts.SCRIPTS
KINDS = ("at_once", "refuse", "stand", "turn", "jump", "sit", "contact", "passive", "lines", "narrative")

every_set = pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)


@cache
def puppets(name: str) -> Motion:
    return Motion(play(SCRIPTS[name], SENTENCES[name].seconds))


@pytest.mark.parametrize(
    ("path", "scripts", "count", "kinds"),
    [
        (FRESH, fresh_scripts.SCRIPTS, 48, (*KINDS, "kneel", "hold_and_move", "while", "without")),
        (UNSEEN, unseen_scripts.SCRIPTS, 40, (*KINDS, "bow", "stop")),
    ],
    ids=["fresh", "unseen"],
)
def test_they_are_of_the_kinds_that_people_write(
    path: Path, scripts: dict[str, str], count: int, kinds: tuple[str, ...]
) -> None:
    sentences = SETS[path]
    assert len(sentences) == len({s.words.lower() for s in sentences.values()}) == count
    assert sentences.keys() == scripts.keys()
    tags = [tag for sentence in sentences.values() for tag in sentence.tags]
    assert 0.45 * count <= tags.count("locomotion") <= 0.55 * count
    assert tags.count("two_beats") + tags.count("three_beats") >= count / 4
    for tag in kinds:
        assert tags.count(tag) >= 2, tag
    assert all(2 <= s.seconds <= 10 and s.rule for s in sentences.values())
    assert sum(sentence.named for sentence in sentences.values()) >= 15


@every_set
def test_none_is_one_of_the_eighty(path: Path) -> None:
    words = [sentence.words for sentence in SETS[path].values()]
    assert without_sentences(words) == words
    assert not SETS[path].keys() & {sentence.id for sentence in load_sentences()}


def test_none_of_the_unseen_is_a_fresh_one() -> None:
    words = [sentence.words for sentence in SETS[UNSEEN].values()]
    assert without_sentences(words, FRESH) == words
    assert not SETS[UNSEEN].keys() & SETS[FRESH].keys()


@pytest.mark.parametrize("name", SENTENCES)
def test_the_rule_fits_the_words(name: str) -> None:
    """Done, it passes; standing still, the wrong person, the wrong order and the other hand fail."""
    sentence, motion = SENTENCES[name], puppets(name)
    found = sentence.judge(motion)
    assert found.passed, [rule for rule, fulfilled in found.parts if not fulfilled]
    for gap in (0.7, 1.5, 3.0):
        assert not sentence.judge(Motion(play(f"gap {gap}", sentence.seconds))).passed, gap
    assert sentence.judge(motion.swapped()).passed is not sentence.named
    if sentence.ordered:
        assert not sentence.judge(motion.reversed()).passed
    if "side" in sentence.tags:
        assert not sentence.judge(Motion(mirrored(motion.positions))).passed


@every_set
def test_a_rule_turns_most_other_scenes_away(path: Path) -> None:
    names = list(SETS[path])
    passed = [
        (name, other)
        for i, name in enumerate(names)
        for other in (names[(i + 5 * k) % len(names)] for k in range(1, 8))
        if SENTENCES[name].judge(puppets(other)).passed
    ]
    assert len(passed) < 0.03 * 7 * len(names), passed


# ---- not in the corpus -----------------------------------------------------------------------------------
@every_set
def test_captions_that_repeat_one_are_found(path: Path) -> None:
    for sentence in SETS[path].values():
        assert kept_out(sentence.words.upper() + "!", path) == sentence.words
        assert without_sentences([sentence.words, "Two people shake hands."], path) == [
            "Two people shake hands."
        ]


@pytest.mark.parametrize("family", FAMILIES)
def test_no_caption_of_the_corpus_is_one(family: str) -> None:
    rng = np.random.default_rng(zlib.crc32(family.encode()))
    slots = {key: str(rng.choice(sorted(ACTIONS))) for key in ("act_a", "act_b", "first", "second")}
    captions = Phrasebook(family).sample(rng, slots, n=40)
    assert captions
    for path in PATHS:
        assert without_sentences(captions, path) == captions


def test_phrases_of_the_corpus_hold_none() -> None:
    people = {"{A}": "one person", "{B}": "the other"}
    for entry in ENTRIES.values():
        for pattern in (*entry.nouns, *entry.sentences, *entry.both, *entry.a, *entry.b):
            for text in expand(pattern):
                for mark, word in people.items():
                    text = text.replace(mark, word)
                text = re.sub(r"\*|\{[^}]*\}", "", text)
                assert not any(kept_out(text, path) for path in PATHS), text
