"""More sentences than the eighty: none in the corpus or in an older set, rules that a puppet shows to be fair."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest

import training.evaluate
from motion.metrics.sentences import kept_out, load_sentences, read_sentences, without_sentences

from . import fresh_scripts, hidden_scripts, ordinary_scripts, unseen_scripts, varied_scripts
from .fairness import CUES, Puppets, captions_of, phrases

FRESH, UNSEEN, VARIED, HIDDEN, ORDINARY = PATHS = [
    Path(training.evaluate.__file__).with_name(f"{name}_sentences.json")
    for name in ("fresh", "unseen", "varied", "hidden", "ordinary")
]
SETS = {path: {sentence.id: sentence for sentence in read_sentences(path)} for path in PATHS}
SENTENCES = {id: sentence for listed in SETS.values() for id, sentence in listed.items()}
MODULES = (fresh_scripts, unseen_scripts, varied_scripts, hidden_scripts, ordinary_scripts)
SCRIPTS = {id: script for module in MODULES for id, script in module.SCRIPTS.items()}
PUPPETS = Puppets(SENTENCES, SCRIPTS)
KINDS = ("at_once", "refuse", "stand", "turn", "jump", "sit", "contact", "passive", "lines", "narrative")

every_set = pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)


@pytest.mark.parametrize(
    ("path", "scripts", "count", "kinds"),
    [
        (FRESH, fresh_scripts.SCRIPTS, 48, (*KINDS, "kneel", "hold_and_move", "while", "without")),
        (UNSEEN, unseen_scripts.SCRIPTS, 40, (*KINDS, "bow", "stop")),
        (
            VARIED,
            varied_scripts.SCRIPTS,
            71,
            (*KINDS, "kneel", "fall", "bow", "hold_and_move", "while", "until", "without"),
        ),
        (
            HIDDEN,
            hidden_scripts.SCRIPTS,
            60,
            (*KINDS, "bow", "stop", "kneel", "fall", "while", "until", "without"),
        ),
        (
            ORDINARY,
            ordinary_scripts.SCRIPTS,
            72,
            (*KINDS, "kneel", "fall", "bow", "stop", "hold_and_move", "while", "until", "without"),
        ),
    ],
    ids=["fresh", "unseen", "varied", "hidden", "ordinary"],
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


@pytest.mark.parametrize(("older", "path"), list(itertools.combinations(PATHS, 2)))
def test_none_is_in_an_older_set(path: Path, older: Path) -> None:
    words = [sentence.words for sentence in SETS[path].values()]
    assert without_sentences(words, older) == words
    assert not SETS[path].keys() & SETS[older].keys()


@pytest.mark.parametrize("name", SENTENCES)
def test_the_rule_fits_the_words(name: str) -> None:
    PUPPETS.assert_fair(name)


@every_set
def test_a_rule_turns_most_other_scenes_away(path: Path) -> None:
    passed = PUPPETS.passing_others(list(SETS[path]), others=7, stride=5)
    assert len(passed) < 0.03 * 7 * len(SETS[path]), passed


# ---- not in the corpus -----------------------------------------------------------------------------------
@every_set
def test_captions_that_repeat_one_are_found(path: Path) -> None:
    for sentence in SETS[path].values():
        assert kept_out(sentence.words.upper() + "!", path) == sentence.words
        assert without_sentences([sentence.words, "Two people shake hands."], path) == [
            "Two people shake hands."
        ]


@pytest.mark.parametrize("number", range(8))
def test_no_caption_of_the_corpus_is_one(number: int) -> None:
    for acts in CUES[number::8]:
        captions = captions_of(acts)
        assert captions, acts
        for path in PATHS:
            assert without_sentences(captions, path) == captions


def test_phrases_of_the_corpus_hold_none() -> None:
    assert [text for text in phrases() if any(kept_out(text, path) for path in PATHS)] == []
