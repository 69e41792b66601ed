"""Scores of the eighty sentences: counts, tables, and motions that are kept from run to run."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from motion import Duet, InputError
from motion.metrics.sentences import Sentence, load_sentences
from motion.metrics.sentences.scores import score, share, table
from training.evaluate import sentences as command
from training.evaluate.judge import kept_motions as keeping
from training.evaluate.judge.draw import Sampling

from .puppets import play
from .sentence_scripts import SCRIPTS

SENTENCES = load_sentences()
SOME = [s for s in SENTENCES if s.id in ("deep-bow", "spin", "hop-joy", "stand-until")]


def duet(sentence: Sentence, script: str | None = None) -> Duet:
    directions = SCRIPTS[sentence.id] if script is None else script
    return Duet.from_positions(play(directions, sentence.seconds), fps=30.0)


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, int]]:
    """A generator that plays the puppets on even seeds and stands on odd ones; what it was asked for."""
    asked: list[tuple[str, int]] = []
    by_words = {s.words: s for s in SENTENCES}

    def draw(
        generator: Any, tasks: Sequence[Any], sampling: Sampling, seeds: Sequence[int]
    ) -> Iterator[tuple[int, Duet]]:
        for i, (task, seed) in enumerate(zip(tasks, seeds, strict=True)):
            sentence = by_words[task.caption]
            asked.append((sentence.id, seed))
            yield i, duet(sentence, "" if seed % 2 else None)

    monkeypatch.setattr(keeping, "draw", draw)
    monkeypatch.setattr(
        command, "InterGenPipeline", lambda folder: SimpleNamespace(digest="0123456789abcdef")
    )
    return asked


def test_shares_are_counted_by_tag() -> None:
    duets = [[duet(s), duet(s, "")] for s in SOME]
    found = score(SOME, duets)
    assert found["tags"]["all"] == [4, 8]
    assert found["tags"]["bow"] == [1, 2] and found["tags"]["turn"] == [1, 2]
    assert found["other"]["all"][1] == 8 and found["other"]["all"][0] <= 1
    row = next(r for r in found["sentences"] if r["id"] == "deep-bow")
    assert row["passed"] == [True, False]
    assert row["met"] == {"happens(bows(b, 0.25))": 1, "never(bows(a, 0.1))": 2}
    assert found["conditions"][1] == 2 * sum(len(s.rule) for s in SOME)
    assert found["conditions"][0] == sum(sum(r["met"].values()) for r in found["sentences"]) > 4
    json.dumps(found)


def test_a_share_has_its_wilson_interval() -> None:
    assert share(1, 2) == "50 % (1/2; 9–91 %)"
    assert share(0, 0) == "–"


def test_the_table_stands_beside_another() -> None:
    now = score(SOME, [[duet(s)] for s in SOME]) | {"about": "Now."}
    before = score(SOME, [[duet(s, "")] for s in SOME]) | {"about": "Before."}
    shown = table(now, before)
    assert "| all | 100 % (4/4; 51–100 %) | 0 % (0/4; 0–49 %) |" in shown
    assert "| jump | 100 % (1/1; 21–100 %) |" in shown and "| Before |" in shown
    assert "Before" not in table(now)


def test_what_was_drawn_is_kept_and_new_words_are_drawn_again(
    tmp_path: Path, drawn: list[tuple[str, int]]
) -> None:
    motions = keeping.motions_folder(tmp_path, "0123456789abcdef", Sampling(steps=25))
    assert motions.folder.name == "0123456789ab-ddim25-g4.3-d0.7"
    generator: Any = None
    assert keeping.draw_missing(generator, SOME, range(2), Sampling(), motions) == 0
    assert len(drawn) == 8 and set(drawn) == {(s.id, k) for s in SOME for k in range(2)}
    motions.path(SOME[0], 1).unlink()
    assert keeping.draw_missing(generator, SOME, range(2), Sampling(), motions) == 0
    assert drawn[8:] == [(SOME[0].id, 1)]
    kept = motions.read(SOME[1], 0)
    np.testing.assert_allclose(kept.positions, duet(SOME[1]).positions)
    assert kept.fps == 30.0 and kept.seconds == pytest.approx(SOME[1].seconds, abs=0.05)
    changed = replace(SOME[0], words=SOME[0].words + " Slowly.")
    with pytest.raises(InputError, match="draw the motions again"):
        motions.read(changed, 0)


def test_a_damaged_motion_is_said_to_be(tmp_path: Path) -> None:
    motions = keeping.Motions(tmp_path)
    motions.path(SOME[0], 0).write_bytes(b"nothing")
    with pytest.raises(InputError, match="missing or damaged"):
        motions.read(SOME[0], 0)


def test_the_command_draws_judges_and_writes(
    tmp_path: Path, drawn: list[tuple[str, int]], capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["--cache", str(tmp_path / "motions"), "--out", str(tmp_path / "s.json"), "--seeds", "2",
                 "--only", "jump", "deep-bow", "--table", str(tmp_path / "s.md")]  # fmt: skip
    assert command.main(arguments) == 0
    found = json.loads((tmp_path / "s.json").read_text())
    passed, count = found["tags"]["all"]
    assert passed == count // 2 and found["tags"]["bow"] == [1, 2]
    assert found["settings"]["weights_sha256"] == "0123456789abcdef"
    assert (tmp_path / "s.md").read_text().strip() == capsys.readouterr().out.strip()
    asked = len(drawn)
    assert command.main([*arguments, "--beside", str(tmp_path / "s.json")]) == 0
    assert len(drawn) == asked and "| Before |" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("more", "why"),
    [
        (["--only", "dragons"], "No sentence has the name or tag dragons"),
        (["--beside", "no.json"], "no scores"),
    ],
)
def test_the_command_says_what_is_wrong(
    more: list[str], why: str, tmp_path: Path, drawn: list[Any], capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["--cache", str(tmp_path), "--out", str(tmp_path / "s.json"), *more]
    assert command.main(arguments) == 2
    assert why in capsys.readouterr().err and not (tmp_path / "s.json").exists()
