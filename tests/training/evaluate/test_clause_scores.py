"""A set that is sealed gives numbers only."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from motion import Duet, InputError
from motion.metrics.sentences import read_sentences
from motion.metrics.sentences.catalogue import score, table

from .puppets import play

CLAUSES = [["They zigzag", "happens(walks(a))"], ["they hug", "then(walks(a), hugs()) and never(low(a))"]]


def read(folder: Path, sealed: bool, old: str = "", new: str = "") -> tuple:
    row = {"words": "They zigzag, then they hug.", "clauses": CLAUSES, "sealed": sealed}
    path = folder / "set.json"
    path.write_text(json.dumps([row]).replace(old, new))
    return read_sentences(path)


def test_clauses_are_the_conditions_and_sealed_scores_hold_no_words(tmp_path: Path) -> None:
    motion = Duet.from_positions(play("gap 2; a go 1 2.5 0 1.6; hug 2.5 4.5", 5.0), fps=30.0)
    for sealed in (False, True):
        (sentence,) = read(tmp_path, sealed)
        assert sentence.clauses == ("They zigzag", "they hug") and len(sentence.rule) == 2
        found = score([sentence], [[motion, motion]])
        assert found["tags"]["all"] == [2, 2] and found["conditions"] == [4, 4] and found["any"] == [1, 1]
        shown = json.dumps(found) + table(found | {"about": ""})
        assert ("zigzag" in shown) is ("walks" in shown) is not sealed


@pytest.mark.parametrize(("old", "new"), [("hugs()", "embraces()"), ('"they hug"', '"they kiss"')])
def test_a_sealed_sentence_that_cannot_be_used_is_not_quoted(tmp_path: Path, old: str, new: str) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, True, old, new)
    assert "Sentence 1 of set.json" in str(caught.value)
    assert "embraces" not in str(caught.value) and "kiss" not in str(caught.value)
