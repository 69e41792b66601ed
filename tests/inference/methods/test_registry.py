"""A method is one thing: registered once, it is everywhere."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from motion import InputError
from motion.formats import read
from webdemo import cli
from webdemo.inference import Engine, GenerateRequest, PredictRequest, ReactRequest
from webdemo.inference.methods import (
    AUTOMATIC,
    BUILT_IN,
    automatic,
    failed,
    label_of,
    method,
    methods,
    register,
    register_path,
    unregister,
    variants,
)
from webdemo.ui.api import GenerateEndpoint
from webdemo.ui.components.actors import react_choices
from webdemo.ui.components.notebook import method_label
from webdemo.ui.tabs.generate import generate_choices

TOY_METHOD = """
from webdemo.inference.method import Method


def load(folder):
    from toy_pipeline import Toy

    return Toy()


METHOD = Method(
    name="toy", label="Toy twins", summary="Two people who sway.", tasks=("generate", "react"),
    takes=frozenset({"words", "actor"}), defaults={"steps": 3}, load=load,
)
"""
TOY_PIPELINE = """

import numpy as np

from motion import SMPL22, Duet
from webdemo.inference import GenerateRequest, Result


class Toy:
    name, digest = "toy", ""

    def run(self, request, cancel, timer):
        generated = isinstance(request, GenerateRequest)
        frames = round(request.seconds * 30) if generated else request.actor.num_frames
        rest = SMPL22.rest_positions()
        rest = rest - [0, rest[:, 1].min(), 0]
        sway = 0.1 * np.sin(np.arange(frames) / 10)[:, None, None] * [1.0, 0.0, 0.0]
        pair = np.stack([rest + sway, rest + sway + [0.0, 0.0, 1.0]])
        yield timer.progress("sample", request.steps, request.steps)
        yield Result(duets=(Duet.from_positions(pair, fps=30.0, roles=("actor", "reactor")),), manifest={})
"""


@pytest.fixture
def toy(tmp_path: Path) -> Iterator[Path]:
    """Two files of somebody's own in a folder."""
    folder = tmp_path / "own"
    folder.mkdir()
    (folder / "toy.py").write_text(TOY_METHOD)
    (folder / "toy_pipeline.py").write_text(TOY_PIPELINE)
    register_path(folder)
    yield folder
    unregister("toy")
    sys.path.remove(str(folder))
    sys.modules.pop("toy_pipeline", None)


def test_a_method_of_two_files_is_everywhere(toy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    # on the page
    assert ("Toy twins", "toy") in generate_choices()
    assert ("Toy twins", "toy") in react_choices()
    # in the shell
    out = tmp_path / "toy.npz"
    assert cli.main(["generate", "--prompt", "Sway.", "--model", "toy", "--seconds", "2", "--out", str(out)]) == 0
    printed = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert printed["manifest"]["model"] == "toy" and printed["manifest"]["request"]["steps"] == 3
    assert read(out).num_frames == 60

    # in the API
    class Page:
        def __init__(self) -> None:
            self.runs, self.shelf = self, self

        def run(self, session: str, request: GenerateRequest) -> Iterator[object]:
            return Engine().run(request)

        def folder(self) -> Path:
            (tmp_path / "files").mkdir(exist_ok=True)
            return tmp_path / "files"

    answer, _ = GenerateEndpoint(Page()).generate(  # type: ignore[arg-type]
        "Sway.", 2.0, 0, 1, 4.3, 3, 0.0, "ddim", "toy", progress=lambda *a, **k: None
    )
    assert answer["manifest"]["model"] == "toy"
    # in the history
    assert method_label({"kind": "generate", "model": "toy"}) == "Toy twins"
    assert method_label({"kind": "react", "model": "toy", "mode": "offline"}) == "Toy twins"


def test_without_it_the_toy_is_nowhere() -> None:
    assert "toy" not in variants("react") and label_of("toy") == "toy"
    with pytest.raises(InputError, match="no model 'toy': choose one of intergen"):
        GenerateRequest(prompt="Sway.", model="toy")


def test_a_broken_method_fails_alone(tmp_path: Path, toy: Path) -> None:
    (tmp_path / "broken.py").write_text("METHOD = 1 / 0\n")
    register_path(tmp_path / "broken.py")
    register_path(tmp_path / "nowhere.py")
    register_path(toy / "toy.py")  # its name is taken by now
    reasons = failed()
    assert "division by zero" in reasons[str(tmp_path / "broken.py")]
    assert "no file or folder" in reasons[str(tmp_path / "nowhere.py")]
    assert "choose another name" in reasons[str(toy / "toy.py")]
    assert method("toy").label == "Toy twins" and method("intergen") is BUILT_IN[0]


def test_what_is_no_method_is_refused() -> None:
    with pytest.raises(InputError, match="METHOD is not a"):
        register("intergen")  # type: ignore[arg-type]


def test_the_defaults_of_the_requests_are_the_first_methods() -> None:
    assert methods("generate")[0].name == GenerateRequest.model
    assert ReactRequest.model == AUTOMATIC
    assert methods("predict")[0].name == PredictRequest.model


def test_automatic_is_the_best_of_the_table_for_what_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    assert automatic("They hug.", "a").name == methods("react")[0].name
    assert automatic("", "b").name == methods("react")[0].name, "the others answer; they do not act first"
    rows = [
        line.split("|")[1:3]
        for line in (Path(__file__).resolve().parents[3] / "docs/reactions.md").read_text().splitlines()
        if line.startswith("|") and "±" in line
    ]
    known = {"ReGenNet, offline": "regennet", "InterGen, person to person": "intergen", "Virtual agent": "agent"}
    scores: dict[str, float] = {}
    for label, accuracy in rows:  # the first two tables: SBU and K3HI
        scores.setdefault(known.get(label.strip(), ""), float(accuracy.split("±")[0]))
    assert automatic("  ", "a").name == max(set(known.values()), key=lambda name: scores[name])
    monkeypatch.setenv("PASDEDEUX_REACTIONS", "recorded")
    assert automatic("", "a").name == "nearest"
    assert "online" in automatic("", "a", "online").modes


def test_every_method_is_listed_in_the_documents_and_has_a_card() -> None:
    root = Path(__file__).resolve().parents[3]
    listed = (root / "docs" / "README.md").read_text()
    for found in methods():
        if found.weights:
            assert f"| `{found.name}` |" in listed
            assert (root / "models" / "weights" / found.weights / "CARD.md").is_file()
