"""The measures of reactions made online."""

import math

import numpy as np
import pytest

from motion import SMPL22
from training.evaluate.online import Measures, means, measures

REST = SMPL22.rest_positions() + np.array([0.0, 0.98, 0.0])
FACING = REST * [-1.0, 1.0, -1.0]


def standing(gap: float, frames: int = 40) -> np.ndarray:
    """Two people who face each other, (2, frames, 22, 3)."""
    return np.stack([np.repeat(one[None], frames, 0) for one in (REST, FACING + np.array([0.0, 0.0, gap]))])


def test_someone_who_stands_in_the_actor_is_counted_and_someone_beside_is_not() -> None:
    scene = standing(2.0)
    apart = measures(scene, scene[1])
    assert (apart.touches, apart.due, apart.near, apart.jerk, apart.off) == (False, False, 0, 0, 0)
    assert apart.nearest == pytest.approx(2.0, abs=1e-6)
    reactor = scene[1].copy()
    reactor[30:] = REST + np.array([0.0, 0.0, 0.01])
    inside = measures(scene, reactor)
    assert inside.touches and not inside.due
    assert inside.near == pytest.approx(25)
    assert inside.nearest == pytest.approx(0.01, abs=1e-6)
    assert inside.off > 0.4
    assert inside.jerk > 1000


def test_touching_is_counted_where_it_is_due_and_where_it_is_not() -> None:
    one = Measures(touches=True, due=True, near=0, nearest=1, jerk=10, skate=1, off=0)
    found = means(
        [one, Measures(**(vars(one) | {"touches": False})), Measures(**(vars(one) | {"due": False}))]
    )
    assert (found["due"], found["undue"], found["jerk"]) == (50, 100, 10)
    assert math.isnan(means([one])["undue"])
