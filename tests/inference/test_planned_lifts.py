"""Lifts of the words are met by a network that has learned nothing."""

from __future__ import annotations

import numpy as np
import pytest

from motion import FPS, SMPL22
from motion.metrics.quality import standing_foot
from webdemo.inference import Engine, SceneRequest
from webdemo.inference.story import Beat, FloorPath, FloorPoint

from .followed import Follower, speeds
from .planned import QUICK, made
from .runs import positions, run

FEET = [SMPL22.index(f"{side}_{part}") for side in ("left", "right") for part in ("ankle", "foot")]


def low(motion: np.ndarray, person: int) -> np.ndarray:
    """(T,) metres of a person's lowest foot over the floor."""
    return motion[person][:, FEET, 1].min(axis=1)


def test_who_is_lifted_stands_leaves_the_floor_and_is_set_down_on_feet_that_stay(engine: Engine) -> None:
    found = made(engine, "He lifts her up.")
    feet = low(found, 1)
    assert feet[:10].max() < 0.08 and feet[50:90].min() > 0.15 and feet[-10:].max() < 0.1
    assert np.ptp(found[1, :10, FEET][..., [0, 2]], axis=1).max() < 0.03
    assert np.ptp(found[1, -8:, FEET][..., [0, 2]], axis=1).max() < 0.03
    assert low(found, 0).max() < 0.12
    assert low(made(engine, "He lifts her up.", planned=False), 1)[50:90].min() < 0.15


@pytest.mark.parametrize("how", ["on his back", "in his arms"])
def test_who_is_carried_is_set_down_before_they_do_something_else(engine: Engine, how: str) -> None:
    found = made(engine, f"A father carries his daughter {how}. Then they wave.", seconds=9.0)
    feet = low(found, 1)
    assert feet[10:60].min() > 0.15 and feet[-90:].max() < 0.15
    assert np.abs(np.diff(found[1, 20:, 0, 1])).max() * FPS < 2.2, "and not dropped"


def test_two_who_spin_in_a_lift_turn_all_the_way_round(engine: Engine) -> None:
    found = made(engine, "He picks her up and spins her around.")
    line = found[1, :, 0] - found[0, :, 0]
    angle = np.unwrap(np.arctan2(line[:, 0], line[:, 2]))
    assert abs(angle[-20] - angle[0]) > np.radians(300)
    up = np.flatnonzero(low(found, 1) > 0.15)
    assert abs(angle[up[0]] - angle[0]) < np.radians(30), "they turn once one is in the air"
    assert abs(angle[-1] - angle[up[-1]]) < np.radians(30), "and not while they are set down"
    assert np.degrees(np.abs(np.gradient(angle[up[0] : up[-1]])).max() * FPS) < 360
    for person in (0, 1):
        assert standing_foot(found[person].astype(float), FPS) < 3.0


def test_who_carries_takes_steps_as_long_as_a_walkers(engine: Engine) -> None:
    found = made(engine, "He carries her in his arms.")
    toe = found[0, 30:-20, SMPL22.index("left_foot")][:, [0, 2]]
    stands = np.linalg.norm(np.diff(toe, axis=0), axis=-1) * FPS < 0.2
    lands = int((stands[1:] & ~stands[:-1]).sum())
    assert 2 <= lands <= 1 + len(toe) / FPS / 0.7, "a step of a foot in 0.7 s or more"


@pytest.mark.parametrize(
    ("words", "carrier"),
    [
        ("He carries her in his arms.", 0),
        ("A father carries his daughter on his back.", 0),
        ("Person B carries person A away.", 1),
    ],
)
def test_who_carries_walks_one_foot_after_the_other(engine: Engine, words: str, carrier: int) -> None:
    found = made(engine, words)
    assert low(found, 1 - carrier)[10:].min() > 0.15
    pelvis = found[:, :, 0][..., [0, 2]]
    assert np.linalg.norm(pelvis[carrier, -1] - pelvis[carrier, 0]) > 1.5
    assert np.linalg.norm(pelvis[0] - pelvis[1], axis=-1).max() < 0.5
    toes = found[carrier][:, [SMPL22.index("left_foot"), SMPL22.index("right_foot")]][..., [0, 2]]
    speeds = np.linalg.norm(np.diff(toes[30:120], axis=0), axis=-1) * 30
    assert np.median(speeds.min(axis=1)) < 0.3 and np.median(speeds.max(axis=1)) > 0.8


def test_who_is_dragged_lies_and_is_pulled_along_by_the_feet(engine: Engine) -> None:
    found = made(engine, "Person A drags person B across the floor.")
    pelvis = found[:, :, 0]
    assert pelvis[1, 10:, 1].max() < 0.35 and pelvis[0, :, 1].min() > 0.6
    gone = pelvis[:, -1] - pelvis[:, 0]
    assert np.linalg.norm(gone, axis=-1).min() > 1.0 and np.linalg.norm(gone[0] - gone[1]) < 0.3
    wrists, ankles = ([SMPL22.index(f"{side}_{part}") for side in ("left", "right")] for part in ("wrist", "ankle"))
    apart = found[0][20:-20, wrists][:, :, None] - found[1][20:-20, ankles][:, None]
    assert np.median(np.linalg.norm(apart, axis=-1).min(axis=(1, 2))) < 0.25


def test_nobody_is_carried_by_somebody_who_is_sent_elsewhere(engine: Engine) -> None:
    beats = (Beat("A couple dances a waltz.", seconds=2.0), Beat("Person A carries person B away.", seconds=3.0))
    away = FloorPath("a", (FloorPoint(2.0, 0.0, 3.5), FloorPoint(3.0, 0.0, 4.9)))
    carried, left = (positions(run(engine, SceneRequest(beats=beats, paths=paths, **QUICK))) for paths in ((), (away,)))
    assert low(carried, 1)[100:].min() > 0.15 > low(left, 1)[100:].min()


@pytest.mark.parametrize(
    "words", ["My son runs to me and I lift him up.", "Person A runs to person B and person B lifts person A up."]
)
def test_who_runs_up_first_begins_apart_and_is_lifted_after_the_run(
    monkeypatch: pytest.MonkeyPatch, words: str
) -> None:
    found = positions(Follower(monkeypatch).scene(SceneRequest(beats=(Beat(words, seconds=4.0),))))
    gaps, feet = np.linalg.norm(found[0, :, 0] - found[1, :, 0], axis=-1), low(found, 0)
    assert gaps[0] > 2.5 and gaps[-1] < 0.5
    assert speeds(found)[0].max() > 1.8, "at a run"
    assert speeds(found)[1].max() < 0.3, "the other waits"
    assert (feet[gaps > 1.0] < 0.1).all() and feet[-9:].max() > 0.15, "lifted after the run"
