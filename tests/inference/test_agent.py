"""The virtual agent: it looks at the past alone, decides, says what it saw and answers."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from models.agent.recogniser import Recogniser, RecogniserConfig
from models.motion_mlp import MotionMLP, MotionMLPConfig
from models.weights_io import save_network
from motion.transforms import MEDIAN_START_DISTANCE, facing
from webdemo.inference import ReactRequest, Result
from webdemo.inference.engine import Engine
from webdemo.inference.pipelines.agent import AgentPipeline, Look

from .people import waver

LABELS = ("nothing", "wave", "bow")
SENTENCES = ("They wait.", "Two people wave.", "Two people bow.")


@pytest.fixture(scope="module")
def folder(weights: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("agent")
    shutil.copytree(weights / "intergen", made / "intergen")
    torch.manual_seed(0)
    network = MotionMLP(MotionMLPConfig(width=32, blocks=1))
    save_network(made / "motion-mlp", network, kind="mlp", fps=30.0)
    eye = Recogniser(RecogniserConfig(LABELS, SENTENCES, joint_width=4, latent_dim=16, ff_size=16, num_heads=2))
    save_network(made / "agent", eye)
    return made


@pytest.fixture(scope="module")
def engine(folder: Path) -> Engine:
    return Engine(folder)


@pytest.fixture(scope="module")
def agent(engine: Engine) -> AgentPipeline:
    return engine.pipeline("agent")


REQUEST = ReactRequest(actor=waver(3.0), model="agent", steps=2, damping=0.0, seed=3)


def react(engine: Engine, **changed: object) -> Result:
    return next(e for e in engine.run(replace(REQUEST, **changed)) if isinstance(e, Result))


def look(frame: int, *chances: float) -> Look:
    return Look(frame, np.array(chances))


@pytest.mark.parametrize(
    ("looks", "decided"),
    [
        ([look(45, 0.02, 0.95, 0.03), look(60, 0.0, 0.9, 0.1), look(75, 0.0, 0.0, 1.0)], (60, 1, True)),  # once sure
        ([look(45, 1.0, 0.0, 0.0), look(60, 0.9, 0.1, 0.0), look(75, 0.0, 0.01, 0.99)], (75, 2, False)),
        ([look(45, 0.1, 0.5, 0.4), look(60, 0.1, 0.5, 0.4)], (60, 1, False)),  # the likeliest of all
        ([look(45, 0.8, 0.1, 0.1), look(60, 0.8, 0.2, 0.0)], (60, None, False)),
        ([look(45, 0.0, 0.0, 1.0)], (45, 2, False)),  # one look is not enough
    ],
)
def test_all_looks_together_decide_as_soon_as_they_are_sure(
    agent: AgentPipeline, looks: list[Look], decided: tuple[int, int | None, bool]
) -> None:
    found = agent.eye.decide(looks)
    assert (found.look.frame, found.place, found.sure) == decided
    assert abs(found.look.chances.sum() - 1) < 1e-9


def test_less_than_a_second_is_looked_at_as_if_it_had_been_held(
    agent: AgentPipeline, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen, predict = list[int](), agent.eye.predictor.predict
    monkeypatch.setattr(
        agent.eye.predictor, "predict", lambda past, n: (seen.append(past.shape[1]), predict(past, n))[1]
    )
    (only,) = agent.eye.looks(waver(3.0).positions[:29])
    assert (only.frame, seen) == (29, [30])


SEEN = [look(45, 0.0, 0.95, 0.05), look(60, 0.0, 0.95, 0.05), look(75, 0.0, 0.95, 0.05)]
"""Looks after which the agent is sure of a wave at frame 60."""


def test_it_says_what_it_saw_and_answers_with_the_gestures_sentence(
    engine: Engine, agent: AgentPipeline, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []
    conditioning = agent.answers.conditioning
    monkeypatch.setattr(
        agent.answers, "conditioning", lambda request: (asked.append(request.prompt), conditioning(request))[1]
    )
    monkeypatch.setattr(agent.eye, "looks", lambda positions: SEEN)
    found = react(engine)
    assert asked == ["They wait.", "Two people wave."]
    assert found.notes[0].startswith("After 2.0 s the agent took it for “wave” (95%; “bow” 5%) and answers")
    assert "“Two people wave.”" in found.notes[0]
    assert found.manifest["request"]["model"] == found.manifest["model"] == "agent"
    assert found.manifest["weights_sha256"] != react(engine, model="intergen").manifest["weights_sha256"]
    assert "yours were not used" in react(engine, prompt="Two people hug.").notes[1]


@pytest.mark.parametrize(
    ("looks", "said"),
    [
        ([look(45, 0.9, 0.05, 0.05)] * 2, "saw no gesture"),
        ([look(45, 0.0, 0.5, 0.5)] * 2, "was not sure of a gesture, so it stands and waits. The likeliest was “wave”"),
    ],
)
def test_who_is_not_sure_attends(
    engine: Engine, agent: AgentPipeline, monkeypatch: pytest.MonkeyPatch, looks: list[Look], said: str
) -> None:
    monkeypatch.setattr(agent.eye, "looks", lambda positions: looks)
    found = react(engine)
    assert said in found.notes[0]
    person, made = (p.positions for p in (found.duets[0].a, found.duets[0].b))
    towards = (person[0, 0] - made[:, 0])[:, [0, 2]]
    assert np.linalg.norm(towards, axis=-1) == pytest.approx(MEDIAN_START_DISTANCE, abs=0.1)
    forward = facing(made)[:, [0, 2]]
    cos = (forward * towards).sum(-1) / np.linalg.norm(forward, axis=-1) / np.linalg.norm(towards, axis=-1)
    assert cos.min() > 0.9


@pytest.mark.parametrize("cut", [59, 60])
def test_no_frame_depends_on_later_frames_of_the_actor(
    engine: Engine, agent: AgentPipeline, monkeypatch: pytest.MonkeyPatch, cut: int
) -> None:
    """The same person up to a frame, who then goes elsewhere with another arm: nothing before it changes."""
    monkeypatch.setattr(agent.eye, "looks", lambda positions: SEEN)
    other = np.array(REQUEST.actor.positions)
    other[cut:] = other[cut:] * np.float32([-1, 1, 1]) + np.float32([0.5, 0.1, 1.0])
    changed = replace(REQUEST.actor, positions=other)
    options = {"damping": 0.7, "cleanup": True}
    one, two = (react(engine, actor=actor, **options) for actor in (REQUEST.actor, changed))
    before, after = (np.asarray(result.duets[0].b.positions) for result in (one, two))
    assert before[:cut].tobytes() == after[:cut].tobytes()
    # Its answer is planned at frame 60 from what it had seen.
    assert (before.tobytes() == after.tobytes()) == (cut >= 60)


def test_the_answer_goes_on_from_the_waiting_without_a_jump(
    engine: Engine, agent: AgentPipeline, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(agent.eye, "looks", lambda positions: SEEN)
    answered = react(engine, samples=2)
    monkeypatch.setattr(agent.eye, "looks", lambda positions: [look(45, 1.0, 0.0, 0.0)] * 2)
    waited = react(engine).duets[0].b.positions
    for duet in answered.duets:
        assert duet.b.positions[:60].tobytes() == waited[:60].tobytes()
        assert np.linalg.norm(duet.b.positions[60] - duet.b.positions[59], axis=-1).max() < 0.15
    one, other = (duet.b.positions[-1] for duet in answered.duets)
    assert not np.allclose(one, other)
