"""Steps of bodies that turn: no legs are crossed, feet stand still, and who does not turn is left alone."""

from __future__ import annotations

import numpy as np
import pytest

from motion import SMPL22
from motion.cleaning import plant_feet
from motion.easing import minimum_jerk
from motion.footsteps import with_feet
from motion.pivots import pivoting
from motion.transforms import facing, heading_matrix

from .bodies import FPS

ANKLES = [SMPL22.index("left_ankle"), SMPL22.index("right_ankle")]
TOES = [SMPL22.index("left_foot"), SMPL22.index("right_foot")]


def turned(angle: float, begins: int = 30, takes: int = 27, frames: int = 120, later: int = 6) -> np.ndarray:
    """A person (T, 22, 3) who turns over feet that stay, and are under the hips ``later`` frames after the turn."""
    rest = np.repeat((SMPL22.rest_positions() + np.array([0, 0.92, 0]))[None], 4, axis=0)
    stands = plant_feet(rest, np.ones((4, 4), dtype=bool))[0]  # on bent knees
    time = np.arange(frames)
    turns = heading_matrix(angle * minimum_jerk((time - begins) / takes))
    body = np.einsum("tij,nj->tni", turns, stands - stands[0] * [1, 0, 1])
    feet = np.stack([body[:, [ankle, toe]] for ankle, toe in zip(ANKLES, TOES, strict=True)], axis=1)
    feet[: begins + takes + later] = feet[0]
    return with_feet(body, feet)


def apart(person: np.ndarray) -> np.ndarray:
    """(T,) metres by which the left ankle is to the left of the right one."""
    left = np.cross([0.0, 1.0, 0.0], facing(person))
    return np.asarray(np.sum((person[:, ANKLES[0]] - person[:, ANKLES[1]]) * left, axis=-1))


@pytest.mark.parametrize("angle", [np.pi, -np.pi, 1.9, -1.9])
def test_no_legs_are_crossed_in_a_turn(angle: float) -> None:
    before = turned(angle)
    found = pivoting(before, FPS)
    assert apart(before).min() < -0.05 and apart(found).min() > 0.0
    upper = [j for j in range(22) if not any(part in SMPL22.joint_names[j] for part in ("knee", "ankle", "foot"))]
    np.testing.assert_allclose(found[:, upper], before[:, upper])
    parents, children = np.array(SMPL22.bones).T
    lengths = [np.linalg.norm(each[:, children] - each[:, parents], axis=-1) for each in (before, found)]
    np.testing.assert_allclose(*lengths, atol=1e-6)


def test_one_foot_stands_while_the_other_steps_and_the_inner_one_goes_first() -> None:
    for angle, first in ((np.pi, 0), (-np.pi, 1)):
        found = pivoting(turned(angle), FPS)[:62]
        speed = np.linalg.norm(np.diff(found[:, TOES], axis=0), axis=-1) * FPS
        assert speed.min(axis=1).max() < 0.05, "one toe at least stands"
        leaves = [int(np.argmax(speed[:, side] > 0.2)) for side in (0, 1)]
        assert leaves[first] < leaves[1 - first]


def test_feet_that_a_turn_leaves_crossed_are_set_down_under_the_hips_until_they_leave() -> None:
    before = turned(np.pi, later=60)
    found = pivoting(before, FPS)
    assert (apart(before)[60:110] < 0).all() and (apart(found)[60:110] > 0.1).all()


def test_who_does_not_turn_is_left_alone() -> None:
    still = turned(0.5)
    np.testing.assert_array_equal(pivoting(still, FPS), still)
    crossed = np.repeat(turned(np.pi)[58:59], 60, axis=0)
    np.testing.assert_array_equal(pivoting(crossed, FPS), crossed)
