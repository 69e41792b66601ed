"""Ordinary sentences: none of the eighty, none in the corpus, rules that a puppet shows to be fair."""

from __future__ import annotations

from pathlib import Path

import pytest

import training.evaluate
from motion.metrics.sentences import kept_out, load_sentences, read_sentences, without_sentences

from .fairness import CUES, Puppets, captions_of, phrases
from .ordinary_scripts import SCRIPTS

PATH = Path(training.evaluate.__file__).with_name("ordinary_sentences.json")
SENTENCES = {sentence.id: sentence for sentence in read_sentences(PATH)}
PUPPETS = Puppets(SENTENCES, SCRIPTS)
KINDS = (
    "at_once",
    "refuse",
    "stand",
    "turn",
    "jump",
    "sit",
    "contact",
    "passive",
    "lines",
    "narrative",
    "kneel",
    "fall",
    "bow",
    "stop",
    "hold_and_move",
    "while",
    "until",
    "without",
)


def test_they_are_of_the_kinds_that_people_write() -> None:
    assert len(SENTENCES) == len({s.words.lower() for s in SENTENCES.values()}) == 72
    assert SENTENCES.keys() == SCRIPTS.keys()
    tags = [tag for sentence in SENTENCES.values() for tag in sentence.tags]
    assert all(tags.count(tag) >= 2 for tag in KINDS)
    assert all(2 <= s.seconds <= 10 and s.rule for s in SENTENCES.values())


def test_none_is_one_of_the_eighty() -> None:
    words = [sentence.words for sentence in SENTENCES.values()]
    assert without_sentences(words) == words
    assert not SENTENCES.keys() & {sentence.id for sentence in load_sentences()}


@pytest.mark.parametrize("name", SENTENCES)
def test_the_rule_fits_the_words(name: str) -> None:
    PUPPETS.assert_fair(name)


def test_a_rule_turns_most_other_scenes_away() -> None:
    passed = PUPPETS.passing_others(list(SENTENCES), others=7, stride=5)
    assert len(passed) < 0.03 * 7 * len(SENTENCES), passed


@pytest.mark.parametrize("number", range(8))
def test_no_caption_of_the_corpus_is_one(number: int) -> None:
    for acts in CUES[number::8]:
        captions = captions_of(acts)
        assert captions, acts
        assert without_sentences(captions, PATH) == captions


def test_phrases_of_the_corpus_hold_none() -> None:
    assert [text for text in phrases() if kept_out(text, PATH)] == []
