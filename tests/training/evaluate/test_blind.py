"""Blind pairs: hidden names, choices that are final, and a key that opens last."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from motion import Duet, InputError
from motion.metrics.sentences import load_sentences
from motion.metrics.sentences.kept import Motions
from motion.transforms import turn
from training.corpus.duets import Take
from training.evaluate import blind
from training.evaluate.blind import recorded
from training.evaluate.blind.__main__ import main
from training.evaluate.blind.pages import aligned, pair_page
from webdemo.inference.requests import GenerateRequest, Result

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


def test_every_sentence_comes_once_before_one_comes_twice(
    tmp_path: Path, folders: tuple[Path, Path, Path]
) -> None:
    old, new, _ = folders
    for seed in range(4):
        blind.make(old, new, tmp_path / f"{seed}", count=3, seed=seed)
        key = json.loads((tmp_path / f"{seed}" / "key.json").read_text())
        assert len({entry["sentence"] for entry in key.values()}) == 3


def test_a_page_shows_bodies_from_the_same_side_wherever_the_motion_lies() -> None:
    from .puppets import play

    pair = Duet.from_positions(play("", 2), fps=30.0)
    moved = Duet.from_positions(turn(pair.positions, 2.0) + np.array([3.0, 0.0, 1.0]), fps=30.0)
    assert np.allclose(aligned(pair).positions, aligned(moved).positions, atol=1e-5)
    way = aligned(moved).positions[1, 0, 0] - aligned(moved).positions[0, 0, 0]
    assert way[2] > 0.3 and abs(way[0]) < 1e-6
    page = np.asarray(pair_page("1  Words", [pair, moved]), dtype=float)
    half = len(page) // 2 + 15
    assert np.abs(page[60:half] - page[60 + len(page) - half : len(page)]).mean() < 0.5
    blue = (page[..., 2] > 150) & (page[..., 0] < 80)
    assert blue.mean() > 0.003  # a shirt, not the lines of a skeleton


def test_recorded_duets_stand_beside_the_labs_motions_of_their_length(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from .puppets import play

    dance = play("", 10)
    dance[..., 0] += 0.5 * np.sin(np.arange(dance.shape[1]) / 4)[:, None]
    takes = [Take("cmu-salsa/01", dance), Take("cmu-handshake/18_01", play("", 2))]
    monkeypatch.setattr(recorded, "read_takes", lambda _: takes)
    made = []

    class Engine:
        def run(self, request: GenerateRequest) -> Iterator[Result]:
            made.append(request)
            longer = play("a up 0 2 both", request.seconds + 0.5)
            yield Result(duets=(Duet.from_positions(longer, fps=30.0),), manifest={})

    monkeypatch.setattr(recorded, "Engine", Engine)
    found = recorded.recorded_duets(tmp_path, 5, np.random.default_rng(0))
    assert [duet.family for duet in found] == ["handshake", "salsa", "salsa"]
    assert all(120 <= duet.people.shape[1] <= 180 for duet in found[1:])
    assert main(["recorded", "--data", str(tmp_path), "--out", str(tmp_path / "out"), "--count", "5"]) == 0
    key = json.loads((tmp_path / "out" / "key.json").read_text())
    assert all({entry["1"], entry["2"]} == {"new", "recorded"} for entry in key.values())
    assert {request.prompt for request in made} == {"Two people dance salsa.", "Two people shake hands."}
    blind.choose(tmp_path / "out", [f"{n}={'1' if e['1'] == 'recorded' else '2'}" for n, e in key.items()])
    result = blind.reveal(tmp_path / "out")
    assert (result["new"], result["recorded"]) == (0, 3)
    assert blind.verdict(result).startswith("The new model's motion was chosen in 0 % (0/3")


def test_a_folder_without_duets_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no duets"):
        recorded.make_recorded(tmp_path, tmp_path / "out")
    assert not (tmp_path / "out").exists()


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
    assert main(["make", *arguments]) == 0
    assert main(["make", *arguments]) == 2
    assert "already holds pairs" in capsys.readouterr().err
    assert main(["reveal", str(out)]) == 2
    assert main(["choose", str(out), "1=1", "2=2"]) == 0
    assert main(["reveal", str(out)]) == 0
    assert "chosen in" in capsys.readouterr().out
    assert len(json.loads((out / "result.json").read_text())["pairs"]) == 2


def test_folders_without_common_motions_are_refused(tmp_path: Path) -> None:
    for name in ("old", "new"):
        (tmp_path / name).mkdir()
    with pytest.raises(InputError, match="in common"):
        blind.make(tmp_path / "old", tmp_path / "new", tmp_path / "out")
    assert not (tmp_path / "out").exists()
