"""Sight: the thing that a face points to."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from motion import SMPL22
from motion.things import Thing, shape
from motion.things.sight import distance, looked_at

STANDING = SMPL22.rest_positions() - [0, SMPL22.rest_positions()[:, 1].min(), 0]
"""A person at the origin who faces +Z."""


def facing(yaw: float, place=(0.0, 0.0, 0.0)) -> np.ndarray:
    """(1, 22, 3) that person, turned by so many degrees towards +X."""
    angle = np.radians(yaw)
    turned = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    return (STANDING @ turned.T + place)[None]


def window(place, yaw: float = np.pi) -> Thing:
    return Thing.at_rest("window", shape("window"), np.array(place), yaw, 1)


FAR = facing(0, (30, 0, 0))
"""A person who is in nobody's way."""


def test_a_ray_meets_a_surface_as_far_as_it_is_and_only_ahead():
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.5)
    rng = np.random.default_rng(0)
    for _ in range(20):
        eye, ahead = rng.normal(size=3), rng.normal(size=3)
        eye, ahead = 2.0 * eye / np.linalg.norm(eye), ahead / np.linalg.norm(ahead)
        along, miss = (-eye @ ahead, 4.0 - (eye @ ahead) ** 2)  # squared distance of the ray's line from the middle
        if miss < 0.24 and along > 0:
            assert distance(ball, eye, ahead) == pytest.approx(along - np.sqrt(0.25 - miss), abs=0.02)
        elif miss > 0.25 or along < 0:
            assert distance(ball, eye, ahead) == np.inf
    assert distance(ball, np.array([0, 0, -2.0]), np.array([0, 0, 1.0])) == pytest.approx(1.5, abs=0.01)
    assert distance(ball, np.array([0, 0, 2.0]), np.array([0, 0, 1.0])) == np.inf, "it lies behind"


@pytest.mark.parametrize(("yaw", "seen"), [(0, 0), (20, 0), (60, -1), (180, -1)])
def test_who_faces_a_window_looks_at_it_though_it_is_open(yaw, seen):
    assert looked_at([window((0, 0, 2))], facing(yaw), FAR).tolist() == [seen]


def test_the_nearer_of_two_is_looked_at_and_a_person_is_in_the_way():
    far, near = window((0, 0, 3)), window((0, 0, 1.5))
    assert looked_at([far, near], facing(0), FAR).tolist() == [1]
    other = facing(180, (0, 0, 0.9))
    assert looked_at([far, near], facing(0), other).tolist() == [2]
    assert looked_at([window((0, 0, 9))], facing(0), FAR).tolist() == [-1], "it is too far off"
