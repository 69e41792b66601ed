"""Blind pairs: hidden names, choices that are final, and a key that opens last."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from motion import Duet, InputError
from motion.metrics.sentences import load_sentences
from motion.metrics.sentences.kept import Motions
from training.evaluate import blind

SENTENCES = load_sentences()[:3]


@pytest.fixture
def folders(tmp_path: Path) -> tuple[Path, Path, Path]:
    """Motions of two models: two seeds of three sentences, of which the new one lacks one motion."""
    from .puppets import play

    for name, script in (("old", ""), ("new", "a up 0 2 both")):
        (tmp_path / name).mkdir()
        for sentence in SENTENCES:
            for seed in range(2):
                pair = Duet.from_positions(play(script, 2), fps=30.0)
                Motions(tmp_path / name).write(sentence, seed, pair)
    Motions(tmp_path / "new").path(SENTENCES[2], 1).unlink()
    return tmp_path / "old", tmp_path / "new", tmp_path / "pairs"


def test_pairs_hide_their_names_and_the_key_tells_them(folders: tuple[Path, Path, Path]) -> None:
    old, new, out = folders
    assert blind.make(old, new, out, count=60, seed=1) == 5
    key = json.loads((out / "key.json").read_text())
    assert all({entry["1"], entry["2"]} == {"old", "new"} for entry in key.values())
    assert {entry["1"] for entry in key.values()} == {"old", "new"}  # the order is mixed
    assert (
        len({entry["sentence"] for entry in list(key.values())[:3]}) == 3
    )  # every sentence before any twice
    assert "old" not in (out / "pairs.json").read_text() + (out / "choices.json").read_text()
    for number, entry in key.items():
        page = np.asarray(Image.open(out / f"pair-{int(number):02d}.png").convert("L"), dtype=float)
        upper, lower = page[: len(page) // 2], page[len(page) // 2 :]
        assert np.abs(upper - lower).mean() > 0.1, entry  # two motions, not one twice


def test_choices_come_first_are_final_and_count(folders: tuple[Path, Path, Path]) -> None:
    old, new, out = folders
    blind.make(old, new, out, seed=1)
    with pytest.raises(InputError, match="5 pairs have no choice yet"):
        blind.reveal(out)
    key = json.loads((out / "key.json").read_text())
    picks = {n: next(p for p in ("1", "2") if entry[p] == "new") for n, entry in key.items()}
    assert blind.choose(out, [f"1={picks['1']}", f"2={picks['2']}", "3=tie"]) == 2
    with pytest.raises(InputError, match="final"):
        blind.choose(out, ["3=1"])
    wrong = {"1": "2", "2": "1"}[picks["5"]]
    assert blind.choose(out, [f"4={picks['4']}", f"5={wrong}"]) == 0
    found = blind.reveal(out)
    assert (found["new"], found["old"], found["tie"]) == (3, 1, 1)
    assert blind.verdict(found).startswith("The new model's motion was chosen in 75 % (3/4; 30–95 %)")


@pytest.mark.parametrize("pick", ["9=1", "1=3", "one", "1"])
def test_what_is_no_choice_is_refused(pick: str, folders: tuple[Path, Path, Path]) -> None:
    old, new, out = folders
    blind.make(old, new, out)
    with pytest.raises(InputError, match="is no choice"):
        blind.choose(out, [pick])
    assert json.loads((out / "choices.json").read_text()) == {}


def test_the_command_goes_through_the_steps(
    folders: tuple[Path, Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    old, new, out = folders
    arguments = ["--old", str(old), "--new", str(new), "--out", str(out), "--count", "2"]
    assert blind.main(["make", *arguments]) == 0
    assert blind.main(["make", *arguments]) == 2
    assert "already holds pairs" in capsys.readouterr().err
    assert blind.main(["reveal", str(out)]) == 2
    assert blind.main(["choose", str(out), "1=1", "2=2"]) == 0
    assert blind.main(["reveal", str(out)]) == 0
    assert "chosen in" in capsys.readouterr().out
    assert len(json.loads((out / "result.json").read_text())["pairs"]) == 2


def test_folders_without_common_motions_are_refused(tmp_path: Path) -> None:
    for name in ("old", "new"):
        (tmp_path / name).mkdir()
    with pytest.raises(InputError, match="in common"):
        blind.make(tmp_path / "old", tmp_path / "new", tmp_path / "out")
    assert not (tmp_path / "out").exists()
