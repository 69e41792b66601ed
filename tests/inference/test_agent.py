"""The virtual agent: it looks at the past alone, decides, says what it saw and answers."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from models.folder import save_network
from models.motion_mlp import MotionMLP, MotionMLPConfig
from models.predictors import save_predictor
from models.recogniser import Recogniser, RecogniserConfig
from webdemo.formats import read
from webdemo.inference import Cancelled, CancelToken, ReactRequest, Result
from webdemo.inference.agent import Agent, Eye, Look
from webdemo.inference.engine import WEIGHTS, Engine
from webdemo.inference.predict import MotionPredictor
from webdemo.motion import InputError
from webdemo.motion.retarget import to_smpl
from webdemo.ui.examples import CLIPS

from .people import waver

LABELS = ("nothing", "wave", "bow")
SENTENCES = ("They wait.", "Two people wave.", "Two people bow.")


@pytest.fixture(scope="module")
def folder(weights: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("agent")
    shutil.copytree(weights / "intergen", made / "intergen")
    torch.manual_seed(0)
    network = MotionMLP(MotionMLPConfig(width=32, blocks=1))
    save_predictor(made / "motion-mlp", network, kind="mlp", fps=30.0)
    eye = Recogniser(
        RecogniserConfig(LABELS, SENTENCES, joint_width=4, latent_dim=16, ff_size=16, num_heads=2)
    )
    save_network(made / "agent", eye)
    return made


@pytest.fixture(scope="module")
def engine(folder: Path) -> Engine:
    return Engine(folder)


@pytest.fixture(scope="module")
def agent(engine: Engine) -> Agent:
    return engine._generator("agent")


REQUEST = ReactRequest(actor=waver(3.0), model="agent", steps=2, damping=0.0, seed=3)


def react(engine: Engine, **changed: object) -> Result:
    return next(e for e in engine.run(replace(REQUEST, **changed)) if isinstance(e, Result))


def look(frame: int, *chances: float) -> Look:
    return Look(frame, np.array(chances))


def test_a_look_depends_on_the_second_before_it_alone(agent: Agent) -> None:
    person = waver(3.0).positions
    looks = agent.eye.looks(person)
    assert [one.frame for one in looks] == [45, 60, 75, 90]
    assert all(abs(one.chances.sum() - 1) < 1e-6 for one in looks)
    changed = person.copy()
    changed[60:] += 1.0
    assert np.allclose(agent.eye.looks(changed)[1].chances, looks[1].chances, atol=1e-6)
    assert [one.frame for one in agent.eye.looks(person[:31])] == [31]


@pytest.mark.parametrize(
    ("looks", "decided"),
    [
        (
            [look(45, 0.02, 0.95, 0.03), look(60, 0.0, 0.9, 0.1), look(75, 0.0, 0.0, 1.0)],
            (60, 1),
        ),  # once sure
        ([look(45, 1.0, 0.0, 0.0), look(60, 0.9, 0.1, 0.0), look(75, 0.0, 0.01, 0.99)], (75, 2)),  # it waits
        ([look(45, 0.1, 0.5, 0.4), look(60, 0.1, 0.5, 0.4)], (60, 1)),  # never sure: the likeliest of all
        ([look(45, 0.8, 0.1, 0.1), look(60, 0.8, 0.2, 0.0)], (60, None)),
        ([look(45, 0.1, 0.2, 0.7)], (45, 2)),  # a short clip has one look
    ],
)
def test_all_looks_together_decide_as_soon_as_they_are_sure(
    agent: Agent, looks: list[Look], decided: tuple[int, int | None]
) -> None:
    found, place = agent.eye.decide(looks)
    assert (found.frame, place) == decided
    assert abs(found.chances.sum() - 1) < 1e-9


def test_it_says_what_it_saw_and_answers_with_the_gestures_sentence(
    engine: Engine, agent: Agent, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(agent.eye, "looks", lambda positions: [look(45, 0.0, 0.67, 0.33)] * 3)
    found = react(engine)
    assert found.notes[0].startswith("After 1.5 s the agent took it for “wave” (74%; “bow” 26%) and answers")
    assert "“Two people wave.”" in found.notes[0]
    told = react(engine, model="intergen", prompt="Two people wave.")
    assert found.duets[0].b.positions.tobytes() == told.duets[0].b.positions.tobytes()
    assert found.manifest["request"]["model"] == found.manifest["model"] == "agent"
    assert found.manifest["weights_sha256"] != told.manifest["weights_sha256"]
    assert "yours were not used" in react(engine, prompt="Two people hug.").notes[1]
    monkeypatch.setattr(agent.eye, "looks", lambda positions: [look(45, 0.9, 0.05, 0.05)] * 2)
    assert "saw no gesture" in react(engine).notes[0]


def test_the_actor_stays_and_the_same_request_gives_the_same_bytes(engine: Engine) -> None:
    one, other = react(engine), react(engine)
    np.testing.assert_array_equal(one.duets[0].a.positions, REQUEST.actor.positions)
    assert one.duets[0].b.positions.tobytes() == other.duets[0].b.positions.tobytes()
    assert one.notes == other.notes


def test_what_it_cannot_do_is_a_sentence(engine: Engine) -> None:
    with pytest.raises(InputError, match="choose role a"):
        replace(REQUEST, role="b")
    with pytest.raises(InputError, match="Mode 'online' is none of agent's"):
        replace(REQUEST, mode="online")
    cancel = CancelToken()
    cancel.cancel()
    with pytest.raises(Cancelled):
        list(engine.run(REQUEST, cancel))


@pytest.mark.parametrize(
    ("name", "gesture"), [("shake-hands", "shake hands"), ("wave", "wave"), ("push", "push")]
)
def test_the_shipped_agent_names_the_example_actors(name: str, gesture: str) -> None:
    person = to_smpl(read(CLIPS / f"{name}.npz").people[0])
    eye = Eye(WEIGHTS / "agent", MotionPredictor(WEIGHTS / "motion-mlp"))
    _, place = eye.decide(eye.looks(person.positions))
    assert place is not None and eye.recogniser.config.labels[place] == gesture
