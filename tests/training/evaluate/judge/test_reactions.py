"""Models that react, put to the judge: what is counted is person b, made for a person a as recorded."""

from typing import Any

import numpy as np
import pytest

from motion import SMPL22, Duet
from training.evaluate.judge.reactions import (
    METHODS,
    WITH_WORDS,
    installed,
    of_the_reactor,
    react,
    react_to_all,
)
from training.evaluate.judge.report import reactions_table, score
from training.evaluate.judge.rules import Task
from webdemo.inference import Engine, ReactRequest


@pytest.fixture(scope="module")
def engine() -> Engine:
    return Engine()


@pytest.fixture
def duet() -> Duet:
    person = (SMPL22.rest_positions() + np.array([0, 0.98, 0]))[None].repeat(45, axis=0)
    other = person * [-1, 1, -1] + [0, 0, 1.2]
    return Duet.from_positions(np.stack([person, other]), fps=30.0)


@pytest.mark.parametrize("method", [*WITH_WORDS, "ReGenNet, online, first pose given"])
def test_person_a_stays_as_recorded(engine: Engine, duet: Duet, method: str) -> None:
    chosen = {**METHODS, **WITH_WORDS}[method]
    if chosen["model"] == "intergen":
        chosen = {**chosen, "steps": 2}
    made = react(engine, duet, 3, chosen, prompt="One person waves and the other waves back.")
    np.testing.assert_allclose(made.a.positions, duet.a.positions, atol=1e-5)
    assert made.b.positions.shape == duet.b.positions.shape
    assert np.abs(np.asarray(made.b.positions) - duet.b.positions).max() > 1e-3


def test_words_and_the_first_pose_reach_only_methods_that_take_them(engine: Engine, duet: Duet) -> None:
    asked: list[ReactRequest] = []

    class Listening:
        def run(self, request: ReactRequest) -> Any:
            asked.append(request)
            return engine.run(request)

    react(Listening(), duet, 0, WITH_WORDS["InterFormer, first pose given, no words"], prompt="They hug.")
    react(Listening(), duet, 0, WITH_WORDS["ReGenNet, online"], prompt="They hug.")
    assert [request.prompt for request in asked] == ["", "They hug."]
    np.testing.assert_allclose(asked[0].first_pose, duet.b.positions[0])
    assert asked[1].first_pose is None


def test_what_the_recorded_person_settles_is_not_counted() -> None:
    caption = "One waves with the left hand and the other raises the right hand."
    events = {"side": {"a": "left", "b": "right"}, "facing": True, "order": ["wave", "raise-hand"]}
    assert of_the_reactor(Task(caption, "ordered", events)).events == events | {"side": {"b": "right"}}
    alone = Task(caption, "sequence", {"side": {"a": "left"}, "order": ["wave", "bow"]})
    assert of_the_reactor(alone).checks == ()
    assert alone.events["order"] == ["wave", "bow"]


def test_every_method_gets_a_row(engine: Engine, duet: Duet) -> None:
    tasks = [Task("One person waves.", "wave-back", {"distance": "keep"}, 45)] * 2
    made = list(react_to_all(engine, tasks, [duet, duet], 0, WITH_WORDS["ReGenNet, offline"]))
    assert np.abs(made[0].b.positions - made[1].b.positions).max() > 1e-3  # a seed each
    shown = reactions_table({"Recorded": score([duet, duet], tasks), "made": score(made, tasks)})
    rows = shown.splitlines()
    assert len(rows) == 4 and rows[2].startswith("| Recorded | – | – | 100 % (2/2) |")
    assert len({row.count("|") for row in rows}) == 1
    assert set(installed(WITH_WORDS)) == set(WITH_WORDS)
