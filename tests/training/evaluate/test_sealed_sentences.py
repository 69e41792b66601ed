"""The sealed sentences with clauses: well-formed, and fair by the motion of other sentences.

Sealed files' words must not appear in a test's output: parameters and messages name sentences by their ids.
"""

from __future__ import annotations

from pathlib import Path

import pytest

import training.evaluate
from motion.metrics.sentences import Sentence, kept_out, read_sentences
from motion.metrics.sentences.joints import Motion
from motion.metrics.sentences.language import check

from . import ordinary_scripts, sentence_scripts
from .puppets import play

FOLDER = Path(training.evaluate.__file__).parent
SECONDS = 8.0
OTHERS = 40
VOICES = ("caption", "visitor", "studio")


def sentences() -> tuple[Sentence, ...]:
    return read_sentences(FOLDER / "sealed_sentences.json")


def wrong(ids: list[str]) -> None:
    """Fails with ids alone: pytest would print the operands of an assert on words."""
    if ids:
        pytest.fail(f"not so for {', '.join(ids)}", pytrace=False)


def test_there_are_sixty_in_three_voices_and_each_clause_has_a_rule() -> None:
    found = sentences()
    assert len({s.words.lower() for s in found}) == len({s.id for s in found}) == 60
    assert [sum(voice in s.tags for s in found) for voice in VOICES] == [20, 20, 20]
    wrong([s.id for s in found if not s.rule or len(s.rule) != len(s.clauses) or not 4 <= s.seconds <= 8])
    wrong([s.id for s in found if not all(part and part in s.words for part in s.clauses)])
    assert all(s.sealed for s in found)


def test_none_is_in_an_older_set() -> None:
    ordinary = FOLDER / "ordinary_sentences.json"
    wrong([s.id for s in sentences() if kept_out(s.words) or kept_out(s.words, ordinary)])


def test_no_condition_is_met_by_more_than_a_third_of_other_motions() -> None:
    scripts = sorted({*ordinary_scripts.SCRIPTS.values(), *sentence_scripts.SCRIPTS.values()})
    others = [Motion(play(script, SECONDS)) for script in scripts[:: len(scripts) // OTHERS][:OTHERS]]
    assert len(others) == OTHERS

    def chance(sentence: Sentence, rule: str) -> float:
        casts = [lambda m: m] if sentence.named else [lambda m: m, Motion.swapped]
        return sum(any(check(rule, cast(m)) for cast in casts) for m in others) / OTHERS

    wrong([f"{s.id}: {i}" for s in sentences() for i, r in enumerate(s.rule) if chance(s, r) > 1 / 3])


def test_standing_still_does_not_do_a_sentence() -> None:
    for gap in (0.7, 1.5, 3.0):
        still = Motion(play(f"gap {gap}", SECONDS))
        wrong([s.id for s in sentences() if s.judge(still).passed])
