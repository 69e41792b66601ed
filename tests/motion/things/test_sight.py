"""Sight: the thing that a face points to."""

from __future__ import annotations

import numpy as np
import pytest

from motion import SMPL22
from motion.things import Thing, shape
from motion.things.sight import distances, looked_at
from motion.vectors import unit

STANDING = SMPL22.standing()
"""A person at the origin who faces +Z."""


def facing(yaw: float, place=(0.0, 0.0, 0.0)) -> np.ndarray:
    """(1, 22, 3) that person, turned by so many degrees towards +X."""
    angle = np.radians(yaw)
    turned = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    return (STANDING @ turned.T + place)[None]


def window(place) -> Thing:
    return Thing.at_rest("window", shape("window"), np.array(place), np.pi, 1)


FAR = facing(0, (30, 0, 0))
"""A person who is in nobody's way."""


def test_a_ray_meets_a_box_as_far_as_it_is_and_only_ahead():
    rng = np.random.default_rng(0)
    high = np.array([0.5, 0.3, 0.4])
    eyes, ways = (unit(rng.normal(size=(200, 3))) for _ in range(2))
    far, along = distances(eyes, ways, -high, high), np.linspace(0, 4, 4001)
    inside = (np.abs(eyes[:, None] + along[:, None] * ways[:, None]) <= high).all(axis=-1)
    hit = inside.any(axis=1)
    assert 10 < hit.sum() < 190
    np.testing.assert_allclose(far[hit], along[inside.argmax(axis=1)][hit], atol=2e-3)
    assert np.isinf(far[~hit]).mean() > 0.98, "but for rays that graze an edge between two samples"
    ahead = np.array([[0.0, 0.0, 1.0]])
    assert distances(-2 * ahead, ahead, -high, high) == pytest.approx(1.6)
    assert distances(2 * ahead, ahead, -high, high) == np.inf, "it lies behind"


@pytest.mark.parametrize(("yaw", "seen"), [(0, 0), (20, 0), (60, -1), (180, -1)])
def test_who_faces_a_window_looks_at_it_though_it_is_open(yaw, seen):
    assert looked_at([window((0, 0, 2))], facing(yaw), FAR).tolist() == [seen]


def test_the_nearer_of_two_is_looked_at_and_a_person_is_in_the_way():
    far, near = window((0, 0, 3)), window((0, 0, 1.5))
    assert looked_at([far, near], facing(0), FAR).tolist() == [1]
    other = facing(180, (0, 0, 0.9))
    assert looked_at([far, near], facing(0), other).tolist() == [2]
    assert looked_at([window((0, 0, 9))], facing(0), FAR).tolist() == [-1], "it is too far off"
