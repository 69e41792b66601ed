"""Rules of the judge's eighty sentences and of the ordinary ones pass where the words are done, and only there.

And the corpus repeats none of them.
"""

from __future__ import annotations

import zlib
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import training.evaluate
from motion.metrics.sentences import Sentence, kept_out, load_sentences, read_sentences
from motion.metrics.sentences.joints import Motion, longest, stretches
from motion.metrics.sentences.language import RuleError, check
from motion.transforms import mirrored
from tests.training.corpus.recorded import KINDS
from training.corpus import telling
from training.corpus.cues import Beat, label
from training.corpus.telling import Teller

from . import ordinary_scripts, sentence_scripts
from .puppets import play

PATH = Path(training.evaluate.__file__).with_name("ordinary_sentences.json")


class Puppets:
    """Sentences with their scripts (see :mod:`.puppets`), by the same ids, which puppets play."""

    def __init__(self, sentences: tuple[Sentence, ...], scripts: dict[str, str]) -> None:
        self.sentences, self.scripts = {sentence.id: sentence for sentence in sentences}, scripts
        self.motion = cache(self._motion)

    def _motion(self, name: str) -> Motion:
        return Motion(play(self.scripts[name], self.sentences[name].seconds))

    def assert_fair(self, name: str) -> None:
        """Asserts that a rule passes when its words are done, and fails on everything nearby.

        That is: two who only stand, the wrong person where people are named, the wrong order and the other hand.
        """
        sentence, motion = self.sentences[name], self.motion(name)
        found = sentence.judge(motion)
        assert found.passed, [rule for rule, fulfilled in found.parts if not fulfilled]
        for gap in (0.7, 1.5, 3.0):
            assert not sentence.judge(Motion(play(f"gap {gap}", sentence.seconds))).passed, f"{gap} m apart"
        assert sentence.judge(motion.swapped()).passed is not sentence.named, "people exchanged"
        if sentence.ordered:
            assert not sentence.judge(Motion(motion.positions[:, ::-1], motion.fps)).passed, "played backwards"
        if "side" in sentence.tags:
            assert not sentence.judge(Motion(mirrored(motion.positions))).passed, "the other hand"


CUES = [pair for kind in KINDS for pair in kind]
"""What A and B do in the beats that the corpus plays."""


def captions_of(acts: tuple[str, str], split: str = "train") -> list[str]:
    """Captions of a beat of the corpus; of another draw for each beat and split."""
    rng = np.random.default_rng(zlib.crc32(f"{acts} {split}".encode()))
    sides = ("left", None) if rng.random() < 0.5 else (None, None)
    teller = Teller(rng, label([Beat(acts, 0, 60, relation="while", sides=sides)], 60), split)
    return [*teller.tell(12), *teller.tell(4, "a")]


SETS = {
    "eighty": Puppets(load_sentences(), sentence_scripts.SCRIPTS),
    "ordinary": Puppets(read_sentences(PATH), ordinary_scripts.SCRIPTS),
}


@pytest.mark.parametrize(("name", "count"), [("eighty", 80), ("ordinary", 72)])
def test_each_sentence_is_another_and_has_a_rule_and_a_script(name: str, count: int) -> None:
    sentences, scripts = SETS[name].sentences, SETS[name].scripts
    assert len(sentences) == len({sentence.words.lower() for sentence in sentences.values()}) == count
    assert sentences.keys() == scripts.keys()
    assert all(2 <= sentence.seconds <= 10 and sentence.rule for sentence in sentences.values())


@pytest.mark.parametrize(("name", "sentence"), [(name, each) for name, own in SETS.items() for each in own.sentences])
def test_the_rule_fits_the_words(name: str, sentence: str) -> None:
    SETS[name].assert_fair(sentence)


@pytest.mark.parametrize("name", SETS)
def test_a_rule_turns_most_other_scenes_away(name: str) -> None:
    puppets, names, others = SETS[name], list(SETS[name].sentences), 8
    passed = [
        (one, other)
        for i, one in enumerate(names)
        for other in (names[(i + 9 * k) % len(names)] for k in range(1, others + 1))
        if one != other and puppets.sentences[one].judge(puppets.motion(other)).passed
    ]
    assert len(passed) < 0.03 * others * len(names), passed


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
    for sentence in load_sentences():
        assert kept_out(sentence.words) == sentence.words
        assert kept_out(sentence.words.upper().replace(",", "") + "!") == sentence.words
    assert kept_out("They shake hands and then they turn around and go their separate ways") is not None
    assert kept_out("Two people shake hands.") is None
    assert not any(kept_out(sentence.words) for sentence in read_sentences(PATH)), "none is one of the eighty"


@pytest.mark.parametrize("split", ["train", "test"])
def test_no_caption_of_the_corpus_is_a_sentence(split: str) -> None:
    for acts in CUES[::12]:
        captions = captions_of(acts, split)
        assert captions, acts
        assert [caption for caption in captions if kept_out(caption) or kept_out(caption, PATH)] == []


def test_the_corpus_writes_no_caption_that_is_kept_out(monkeypatch: pytest.MonkeyPatch) -> None:
    captions = captions_of(("hug", "hug"))
    monkeypatch.setattr(telling, "kept_out", lambda text: text in captions[:6] and text)
    assert not set(captions[:6]) & set(captions_of(("hug", "hug")))
