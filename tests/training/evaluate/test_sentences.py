"""The judge's eighty sentences: their rules pass where the words are done, and only there."""

from __future__ import annotations

import numpy as np
import pytest

from motion.metrics.sentences import kept_out, load_sentences, without_sentences
from motion.metrics.sentences.joints import Motion, longest, stretches
from motion.metrics.sentences.language import RuleError, check
from training.corpus import telling

from .fairness import CUES, Puppets, captions_of, phrases
from .puppets import play
from .sentence_scripts import SCRIPTS

SENTENCES = {sentence.id: sentence for sentence in load_sentences()}


PUPPETS = Puppets(SENTENCES, SCRIPTS)


@pytest.mark.parametrize("name", SENTENCES)
def test_the_rule_fits_the_words(name: str) -> None:
    PUPPETS.assert_fair(name)


def test_a_rule_turns_most_other_scenes_away() -> None:
    passed = PUPPETS.passing_others(list(SENTENCES), others=8, stride=9)
    assert len(passed) < 0.03 * 8 * len(SENTENCES), passed


def test_there_are_eighty_and_every_weakness_is_among_them() -> None:
    assert len(SENTENCES) == len(SCRIPTS) == len({s.words for s in SENTENCES.values()}) == 80
    tags = [tag for sentence in SENTENCES.values() for tag in sentence.tags]
    for tag in (
        "two_beats",
        "three_beats",
        "at_once",
        "refuse",
        "stand",
        "turn",
        "jump",
        "hold_and_move",
        "stop",
        "bow",
        "sit",
        "kneel",
        "fall",
        "lines",
        "side",
        "narrative",
        "passive",
        "while",
        "until",
        "without",
        "locomotion",
        "contact",
    ):
        assert tags.count(tag) >= 3, tag
    assert all(2 <= sentence.seconds <= 10 for sentence in SENTENCES.values())
    assert sum(sentence.named for sentence in SENTENCES.values()) >= 25


# ---- the language of the rules -------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("rule", "why"),
    [
        ("walks(a)", "must begin with"),
        ("happens(flies(a))", "'flies' is not known"),
        ("happens(walks(c))", "neither a person"),
        ("happens(hand_on(a, 'tail'))", "does not fit"),
        ("happens(walks(a)", "cannot be read"),
        ("happens(__import__('os').system('true'))", "not known"),
    ],
)
def test_a_rule_that_makes_no_sense_is_refused(rule: str, why: str) -> None:
    with pytest.raises(RuleError, match=why):
        check(rule, Motion(play("", 2)))


def test_beats_in_order_and_at_once() -> None:
    one_by_one = Motion(play("a bow 0.5 2; b bow 3 4.5", 5))
    at_once = Motion(play("a bow 1 3; b bow 1.2 3.2", 5))
    assert check("then(bows(a), bows(b))", one_by_one) and not check("then(bows(b), bows(a))", one_by_one)
    assert not check("then(bows(a), bows(b))", at_once)
    assert check("happens(both(bows(a), bows(b)), 0.5)", at_once)
    assert not check("happens(both(bows(a), bows(b)))", one_by_one)


def test_stretches_join_over_short_pauses() -> None:
    mask = np.array([1, 1, 0, 1, 0, 0, 0, 0, 1], dtype=bool)
    assert stretches(mask, 10.0) == [(0, 4), (8, 9)]
    assert longest(mask, 10.0) == pytest.approx(0.4)
    assert stretches(np.zeros(4, dtype=bool), 10.0) == []


# ---- kept out of training ------------------------------------------------------------------------------
def test_captions_that_repeat_a_sentence_are_refused() -> None:
    for sentence in SENTENCES.values():
        assert kept_out(sentence.words) == sentence.words
        assert kept_out(sentence.words.upper().replace(",", "") + "!") == sentence.words
    assert kept_out("They shake hands and then they turn around and go their separate ways") is not None
    assert without_sentences(["Two people shake hands.", "walk, shake hands"]) == ["Two people shake hands."]


@pytest.mark.parametrize("number", range(4))
@pytest.mark.parametrize("split", ["train", "test"])
def test_no_caption_of_the_corpus_is_a_sentence(number: int, split: str) -> None:
    for acts in CUES[number::4]:
        captions = captions_of(acts, split)
        assert captions, acts
        assert not [caption for caption in captions if kept_out(caption)]


def test_phrases_of_the_corpus_hold_no_sentence() -> None:
    """Every phrase of the entries that the corpus shows."""
    assert [text for text in phrases() if kept_out(text)] == []


def test_the_corpus_writes_no_caption_that_is_kept_out(monkeypatch: pytest.MonkeyPatch) -> None:
    captions = captions_of(("hug", "hug"))
    monkeypatch.setattr(telling, "kept_out", lambda text: text in captions[:6] and text)
    assert not set(captions[:6]) & set(captions_of(("hug", "hug")))
