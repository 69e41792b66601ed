"""A method is one thing: registered once, it is everywhere."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from motion import SMPL22, Duet, InputError
from motion.formats import read
from webdemo import cli
from webdemo.inference import Engine, GenerateRequest, PredictRequest, ReactRequest
from webdemo.inference import methods as registry
from webdemo.inference.methods import AUTOMATIC, automatic, label_of, method, methods, register, variants
from webdemo.inference.own.classes import method_of_class
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer
from webdemo.ui.api import GenerateEndpoint
from webdemo.ui.components.actors import react_choices
from webdemo.ui.tabs.generate import generate_choices
from webdemo.ui.text.words import method_label


class Toy:
    """Two people who sway."""

    digest = ""
    label, tasks, takes, defaults = "Toy twins", ("generate", "react"), ("words", "actor"), {"steps": 3}

    def run(self, request: GenerateRequest, cancel: CancelToken, timer: StageTimer) -> Iterator[Progress | Result]:
        rest = SMPL22.standing()
        sway = 0.1 * np.sin(np.arange(round(request.seconds * 30)) / 10)[:, None, None] * [1.0, 0.0, 0.0]
        pair = np.stack([rest + sway, rest + sway + [0.0, 0.0, 1.0]])
        yield timer.progress("sample", request.steps, request.steps)
        yield Result(duets=(Duet.from_positions(pair, fps=30.0, roles=("actor", "reactor")),), manifest={})


@pytest.fixture
def toy(monkeypatch: pytest.MonkeyPatch) -> None:
    """A method of somebody's own."""
    methods()
    monkeypatch.setattr(registry, "_registered", dict(registry._registered))
    register(method_of_class(Toy))


def test_a_method_is_everywhere(toy: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
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
        "Sway.", 3, progress=lambda *a, **k: None, seconds=2.0, model="toy"
    )
    assert answer["manifest"]["model"] == "toy"
    # in the history
    assert method_label({"kind": "generate", "model": "toy"}) == "Toy twins"
    assert method_label({"kind": "react", "model": "toy", "mode": "offline"}) == "Toy twins"


def test_without_it_the_toy_is_nowhere() -> None:
    assert "toy" not in variants("react") and label_of("toy") == "toy"
    with pytest.raises(InputError, match="no model 'toy': choose one of intergen"):
        GenerateRequest(prompt="Sway.", model="toy")


def test_a_name_is_taken_once(toy: None) -> None:
    with pytest.raises(InputError, match="choose another name"):
        register(method("toy"))


def test_the_defaults_of_the_requests_are_the_first_methods() -> None:
    assert methods("generate")[0].name == GenerateRequest.model
    assert ReactRequest.model == AUTOMATIC
    assert methods("predict")[0].name == PredictRequest.model


def test_automatic_is_the_best_of_the_table_for_what_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    assert automatic("They hug.", "a").name == methods("react")[0].name
    assert automatic("", "b").name == methods("react")[0].name, "the others answer; they do not act first"
    rows = [
        line.split("|")[1:3]
        for line in (Path(__file__).resolve().parents[2] / "docs/reactions.md").read_text().splitlines()
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
    root = Path(__file__).resolve().parents[2]
    listed = (root / "docs" / "README.md").read_text()
    for found in methods():
        if found.weights:
            assert f"| `{found.name}` |" in listed
            assert (root / "models" / "weights" / found.weights / "CARD.md").is_file()
