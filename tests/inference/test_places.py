"""Nobody is moved faster than people run, wherever a path or a pose begins and whatever the words say."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from acts.staging.poses import upright
from motion import FPS, Duet, InputError
from motion.metrics.sentences import load_sentences
from motion.transforms import heading
from webdemo.inference import Engine, SceneRequest
from webdemo.inference.story import Beat, FloorPath, FloorPoint, Pose

from .followed import Follower, speeds
from .runs import positions, run

FASTEST = 6.0
"""Metres a second: a fast run, which nobody in a planned scene needs to pass."""


@pytest.fixture
def follower(monkeypatch: pytest.MonkeyPatch) -> Follower:
    return Follower(monkeypatch)


def standing(seconds: float = 2.0) -> Duet:
    poses = np.stack([upright(np.zeros(2), 0.0), upright(np.array([0.0, 1.5]), np.pi)])
    return Duet.from_positions(np.repeat(poses[:, None], round(seconds * FPS), axis=1), fps=FPS)


def path(person: str, *points: tuple[float, float, float]) -> FloorPath:
    return FloorPath(person, tuple(FloorPoint(x, z, seconds) for seconds, x, z in points))


def place(made: np.ndarray, person: int, seconds: float) -> np.ndarray:
    return np.asarray(made[person, round(seconds * FPS), 0, [0, 2]])


WAVES = (Beat("They wave.", seconds=4.0),)


@pytest.mark.parametrize("person", ["a", "b"])
def test_a_path_that_begins_elsewhere_is_run_to(follower: Follower, person: str) -> None:
    drawn = path(person, (2.0, 1.4, 0.0), (5.5, 1.4, 3.0))
    found = follower.scene(SceneRequest(beats=WAVES, motion=standing(), paths=(drawn,), planned=False))
    made = found.duets[0].positions
    assert speeds(made).max() < 3.1
    np.testing.assert_allclose(place(made, "ab".index(person), 5.5), [1.4, 3.0], atol=0.02)
    (note,) = found.notes
    assert note.startswith(f"Person {person.upper()}'s path begins {1.4 if person == 'a' else 2.0} m from")
    assert "at 2.0 s: they run there and are on it from" in note


def test_a_path_that_nobody_gets_to_is_said_and_not_jumped_to(follower: Follower) -> None:
    drawn = path("a", (5.0, 8.0, -7.5), (5.9, 8.0, -8.0))
    found = follower.scene(SceneRequest(beats=WAVES, motion=standing(), paths=(drawn,), planned=False))
    assert speeds(found.duets[0].positions).max() < 3.1
    assert any("they cannot be on it in that time" in note for note in found.notes)


def test_a_path_that_begins_where_its_person_is_is_met_exactly_and_without_a_word(follower: Follower) -> None:
    drawn = path("a", (2.0, 0.0, 0.0), (4.0, 1.0, 1.0), (5.5, -0.5, 1.0))
    found = follower.scene(SceneRequest(beats=WAVES, motion=standing(), paths=(drawn,), planned=False))
    made = found.duets[0].positions
    for seconds, x, z in ((4.0, 1.0, 1.0), (5.5, -0.5, 1.0)):
        np.testing.assert_allclose(place(made, 0, seconds), [x, z], atol=1e-4)
    assert not found.notes
    assert len(follower.settings[0].plan.parts[0].frames) == 4, "its points and the end of the window"


@pytest.mark.parametrize("degrees", [0.0, 90.0, -135.0])
def test_one_whose_partner_has_a_path_begins_before_them_and_faces_them(follower: Follower, degrees: float) -> None:
    angle = np.radians(degrees)
    ahead = np.array([np.sin(angle), np.cos(angle)])
    end = np.array([2.0, 1.0]) + 1.2 * ahead
    drawn = path("b", (0.0, 2.0, 1.0), (2.0, float(end[0]), float(end[1])))
    made = follower.scene(SceneRequest(beats=WAVES, paths=(drawn,))).duets[0].positions
    np.testing.assert_allclose(place(made, 0, 0.0), np.array([2.0, 1.0]) + 1.5 * ahead, atol=0.06)
    off = heading(made[0, :1].astype(float))[0] - angle
    assert np.cos(off) < -0.99, "person a faces person b, who comes their way"


def test_a_pose_out_of_reach_is_refused_in_one_sentence(follower: Follower) -> None:
    def asked(x: float, seconds: float) -> SceneRequest:
        pose = Pose("a", seconds, upright(np.array([x, 0.0]), 0.0))
        return SceneRequest(beats=WAVES, motion=standing(), poses=(pose,), planned=False)

    with pytest.raises(InputError, match=r"Person A is 3.0 m away 0.2 s before .* at 2.2 s"):
        follower.scene(asked(3.0, 2.2))
    made = follower.scene(asked(3.0, 4.0)).duets[0].positions
    np.testing.assert_allclose(place(made, 0, 4.0), [3.0, 0.0], atol=0.05)


def test_random_paths_are_possible(follower: Follower) -> None:
    draw = np.random.default_rng(7)
    beats = (Beat("They shake hands.", seconds=2.0), Beat("They walk away.", seconds=3.0))
    tried = 0
    for _ in range(24):
        times = np.sort(draw.choice(np.arange(0, 49), 4, replace=False)) / 10
        steps = draw.uniform(-2.0, 2.0, (4, 2)) * np.diff(times, prepend=times[0] - 1)[:, None]
        points = draw.uniform(-3, 3, 2) + np.cumsum(steps, axis=0)
        motion, shift = (standing(), 2.0) if tried % 3 else (None, 0.0)
        drawn = path(
            "ab"[tried % 2], *((shift + t, float(x), float(z)) for t, (x, z) in zip(times, points, strict=True))
        )
        try:
            request = SceneRequest(beats=beats, paths=(drawn,), motion=motion)
        except InputError:
            continue
        tried += 1
        assert speeds(follower.scene(request).duets[0].positions).max() < FASTEST
    assert tried > 15


SENTENCES = [sentence.words for sentence in load_sentences()]
CARRIES = [
    "Person A carries person B away.",
    "My son runs to me and I lift him up.",
    "A drags B across the floor.",
    "Person B picks person A up and spins them round.",
    "They dance a waltz.",
    "A twirls B under the arm.",
]


@pytest.mark.parametrize("seed", range(2))
def test_what_words_plan_is_possible(follower: Follower, seed: int) -> None:
    draw = np.random.default_rng(seed)
    for _ in range(8):
        words = [*draw.choice(SENTENCES, 2), draw.choice(CARRIES)]
        draw.shuffle(words)
        made = follower.scene(SceneRequest(beats=tuple(map(Beat, words)), seed=seed)).duets[0].positions
        assert speeds(made).max() < FASTEST, words


def test_a_network_follows_the_way_to_a_path(engine: Engine) -> None:
    drawn = path("a", (2.0, 1.4, 0.0), (5.5, 1.4, 3.0))
    request: Any = SceneRequest(beats=WAVES, motion=standing(), paths=(drawn,), planned=False, steps=3)
    made = positions(run(engine, request))
    assert speeds(made)[0].max() < FASTEST + 2.0, "an untrained network sways"
