"""Bodies whose poses are planned do not overlap: people begin, or step, as far apart as their acts need."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from acts import read
from acts.staging.beginnings import BODY, distance, roomy
from acts.staging.places import Standing
from acts.staging.poses import bending, posed, upright
from acts.staging.postures import postures
from acts.staging.score import Score
from acts.staging.stage import score_of
from motion import FPS, SMPL22, Duet
from webdemo.inference import SceneRequest
from webdemo.inference.story import Beat

from .followed import Follower, speeds

FEET = [SMPL22.index("left_foot"), SMPL22.index("right_foot"), SMPL22.index("left_ankle"), SMPL22.index("right_ankle")]


@pytest.fixture
def follower(monkeypatch: pytest.MonkeyPatch) -> Follower:
    return Follower(monkeypatch)


def score(*words: str) -> list[Score]:
    return [score_of(read(each).acts) for each in words]


def scene(follower: Follower, *words: str, **fields: Any) -> np.ndarray:
    beats = tuple(Beat(each, seconds=4.0) for each in words)
    duet = follower.scene(SceneRequest(beats=beats, **fields)).duets[0]
    assert isinstance(duet, Duet)
    return duet.positions.astype(np.float64)


def close(gap: float, seconds: float = 1.5) -> Duet:
    """Two people who stand before each other."""
    poses = np.stack([upright(np.zeros(2), 0.0), upright(np.array([0.0, gap]), np.pi)])
    return Duet.from_positions(np.repeat(poses[:, None], round(seconds * FPS), axis=1), fps=FPS)


def clear(made: np.ndarray, first: int = 0) -> float:
    """The least distance between the bones of two people."""
    return min(distance(made[0, t : t + 1], made[1, t : t + 1]) for t in range(first, made.shape[1], 3))


def test_two_sit_back_to_back_on_the_floor_and_not_in_each_other(follower: Follower) -> None:
    made = scene(follower, "Two people sit back to back on the floor.")
    assert (made[:, :, 0, 1] < 0.25).all(), "on the ground"
    assert 0.3 < np.linalg.norm(made[0, 60, 0] - made[1, 60, 0]) < 0.8
    assert clear(made) > 0.18, "from the spines to the backs it is about nine centimetres on either side"


@pytest.mark.parametrize(
    "words",
    [
        "They sit down back to back.",
        "Two people sit back to back.",
        "They sit side by side on the ground.",
        "They sit on the floor facing each other.",
        "Two people kneel side by side.",
        "They lie down side by side.",
        "Person A lies down and person B sits down.",
        "They lie on the floor.",
        "Both bow deeply.",
        "Person A kneels while person B is sitting.",
        "They crouch back to back.",
    ],
)
def test_two_poses_never_overlap(follower: Follower, words: str) -> None:
    assert clear(scene(follower, words)) >= BODY - 0.01


@pytest.mark.parametrize("words", ["They bow to each other.", "Person A bows.", "Both bow deeply.", "They kneel down."])
@pytest.mark.parametrize("gap", [0.45, 0.7])
def test_who_stands_too_close_steps_apart_first(follower: Follower, words: str, gap: float) -> None:
    made = scene(follower, words, motion=close(gap))
    assert speeds(made).max() < 2.5
    poses = {f for part in follower.settings[0].plan.parts for f in part.frames if hasattr(part, "joints")}
    assert clear(made[:, min(poses) - 3 :]) >= BODY - 0.03
    assert np.linalg.norm(made[0, -1, 0] - made[1, -1, 0]) > gap + 0.08


def test_the_heads_of_two_who_bow_are_counted_to_their_tops() -> None:
    places, headings = np.array([[0.0, 0.0], [0.0, 0.9]]), np.array([0.0, np.pi])
    poses = {person: [(30, bending(places[person], float(headings[person]), 0.9))] for person in (0, 1)}
    room = roomy(Standing(places, headings), poses, [], first=False)
    assert room.delay > 0 and 1.2 < room.stand.gap() < 1.8
    down = roomy(Standing(places, headings), poses, [1], first=False)
    np.testing.assert_array_equal(down.stand.places[1], places[1])
    assert down.stand.places[0, 1] < -0.3, "who is down stays, the other makes room"


def test_who_gets_up_sits_up_first_and_keeps_the_feet_low() -> None:
    stand = Standing(np.array([[0.0, 0.0], [0.0, 2.0]]), np.array([0.0, np.pi]))
    last = posed("lies", np.zeros(2), 0.0)
    poses = dict(postures(score("Person A falls over.", "Person A gets up."), 1, 0, 60, 180, stand, last))
    frames = sorted(poses)
    heights = [poses[f][0, 1] for f in frames]
    assert np.diff(heights).min() > -0.02 and heights[-1] > 0.9
    trunks = [poses[f][SMPL22.index("head"), 1] - poses[f][0, 1] for f in frames]
    assert np.diff(trunks).min() > -0.05, "the trunk rises as a whole"
    upright_from = next(i for i, trunk in enumerate(trunks) if trunk > 0.55)
    between = [f for f in frames[upright_from:] if poses[f][0, 1] < 0.6]
    assert len(between) >= 2, "sits up, then has the feet under the body"
    for frame in between:
        assert poses[frame][FEET, 1].max() < 0.12, "the feet stay on the floor"


def test_who_lies_down_sits_down_first_and_takes_longer_than_who_falls() -> None:
    stand, up = (Standing(np.array([[0.0, 0.0], [0.0, 2.0]]), np.array([0.0, np.pi])), upright(np.zeros(2), 0.0))
    flat = {}
    for words in ("lies down", "falls over"):
        poses = postures(score("They wave.", f"Person A {words}."), 1, 0, 60, 180, stand, up)
        heads = [pose[SMPL22.index("head"), 1] for _, pose in poses]
        assert np.diff(heads).max() < 0.02, "down all the way"
        assert any(0.4 < head < 0.75 for head in heads), "the trunk goes down between sitting and lying"
        flat[words] = next(frame for (frame, _), head in zip(poses, heads, strict=True) if head < 0.3)
        halfway = next(frame for (frame, _), head in zip(poses, heads, strict=True) if head < 1.2)
        assert halfway - 60 >= 15, "nobody drops at once"
    assert flat["lies down"] - flat["falls over"] > 30 and flat["lies down"] - 60 < 105
    hurried = postures(score("They wave.", "Person A lies down."), 1, 0, 60, 110, stand, up)
    assert hurried[-1][1][0, 1] < 0.2, "in a short beat as well"
