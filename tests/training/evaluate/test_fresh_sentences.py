"""The fresh sentences: none of the eighty, none in the corpus, and rules that a puppet shows to be fair."""

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

from .fresh_scripts import SCRIPTS
from .puppets import play

PATH = Path(training.evaluate.__file__).with_name("fresh_sentences.json")
SENTENCES = {sentence.id: sentence for sentence in read_sentences(PATH)}


@cache
def puppets(name: str) -> Motion:
    return Motion(play(SCRIPTS[name], SENTENCES[name].seconds))


def test_there_are_forty_eight_of_the_kinds_that_people_write() -> None:
    assert len(SENTENCES) == len({s.words.lower() for s in SENTENCES.values()}) == 48
    assert SENTENCES.keys() == SCRIPTS.keys()
    tags = [tag for sentence in SENTENCES.values() for tag in sentence.tags]
    assert 22 <= tags.count("locomotion") <= 26
    assert tags.count("two_beats") + tags.count("three_beats") >= 12
    for tag in ("at_once", "refuse", "stand", "turn", "jump", "sit", "kneel", "contact", "passive", "lines",
                "hold_and_move", "narrative", "while", "without"):  # fmt: skip
        assert tags.count(tag) >= 2, tag
    assert all(2 <= s.seconds <= 10 and s.rule for s in SENTENCES.values())
    assert sum(sentence.named for sentence in SENTENCES.values()) >= 15


def test_none_is_one_of_the_eighty() -> None:
    words = [sentence.words for sentence in SENTENCES.values()]
    assert without_sentences(words) == words
    assert not SENTENCES.keys() & {sentence.id for sentence in load_sentences()}


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


def test_a_rule_turns_most_other_scenes_away() -> None:
    names = list(SENTENCES)
    passed = [
        (name, other)
        for i, name in enumerate(names)
        for other in (names[(i + 5 * k) % len(names)] for k in range(1, 9))
        if SENTENCES[name].judge(puppets(other)).passed
    ]
    assert len(passed) < 0.03 * 8 * len(names), passed


# ---- not in the corpus -----------------------------------------------------------------------------------
def test_captions_that_repeat_one_are_found() -> None:
    for sentence in SENTENCES.values():
        assert kept_out(sentence.words.upper() + "!", PATH) == sentence.words
        assert without_sentences([sentence.words, "Two people shake hands."], PATH) == [
            "Two people shake hands."
        ]


@pytest.mark.parametrize("family", FAMILIES)
def test_no_caption_of_the_corpus_is_one(family: str) -> None:
    rng = np.random.default_rng(zlib.crc32(family.encode()))
    slots = {key: str(rng.choice(sorted(ACTIONS))) for key in ("act_a", "act_b", "first", "second")}
    captions = Phrasebook(family).sample(rng, slots, n=40)
    assert captions
    assert without_sentences(captions, PATH) == captions


def test_phrases_of_the_corpus_hold_none() -> None:
    people = {"{A}": "one person", "{B}": "the other"}
    for entry in ENTRIES.values():
        for pattern in (*entry.nouns, *entry.sentences, *entry.both, *entry.a, *entry.b):
            for text in expand(pattern):
                for mark, word in people.items():
                    text = text.replace(mark, word)
                assert kept_out(re.sub(r"\*|\{[^}]*\}", "", text), PATH) is None, text
