"""Eyes turn to what is seen, and to nothing behind the head."""

from __future__ import annotations

import numpy as np
import pytest

from motion.body import load_body, skin
from motion.eyes import eye_zones
from motion.looks import LOOKS
from motion.skeleton import SMPL22

HEAD = SMPL22.index("head")
POSE = SMPL22.rest_positions()[None]
FACE = POSE[:, HEAD] + [0.0, 0.04, 0.0]


def irises(name: str, seen: np.ndarray | None) -> np.ndarray:
    """(2, 3) the middles of a person's left and right iris."""
    body = load_body(name)
    surface = skin(body, POSE, seen=seen)[0]
    used = np.unique(body.faces[body.face_zones == body.zones.index("eyes")])
    return np.stack([surface[used[side * body.vertices[used, 0] > 0]].mean(axis=0) for side in (1, -1)])


@pytest.mark.parametrize("name", LOOKS)
@pytest.mark.parametrize("small", [False, True])
def test_every_body_has_two_eyes_of_iris_and_white(name: str, small: bool) -> None:
    body = load_body(name, small=small)
    assert body.eyes is not None
    assert [int((body.eyes.sides == side).sum()) for side in (0, 1)] == [len(body.eyes.vertices) // 2] * 2
    assert {body.zones[zone] for zone in eye_zones(body.zones)} == {"eyes", "whites"}
    out = body.vertices[body.eyes.vertices] - body.eyes.middles[body.eyes.sides]
    assert (out[:, 2] > 0).all() and np.linalg.norm(out, axis=1).max() < 0.02


@pytest.mark.parametrize("name", LOOKS)
def test_eyes_turn_to_what_is_seen(name: str) -> None:
    ahead = irises(name, FACE + np.array([0.0, 0.0, 3.0]))
    np.testing.assert_allclose(ahead, irises(name, None), atol=0.002)
    for way, axis, sign in (((1.0, 0.0, 2.0), 0, 1), ((-1.0, 0.0, 2.0), 0, -1), ((0.0, -1.0, 2.0), 1, -1)):
        moved = irises(name, FACE + np.array(way)) - ahead
        least = 0.002 if axis == 0 else 0.0008
        assert (sign * moved[:, axis] > least).all() and np.abs(moved).max() < 0.008


def test_eyes_do_not_turn_to_what_is_behind() -> None:
    np.testing.assert_allclose(irises("girl", FACE + np.array([0.5, 0.0, -1.0])), irises("girl", None), atol=1e-6)


def test_only_eyes_move() -> None:
    body = load_body("woman")
    assert body.eyes is not None
    moved = np.abs(skin(body, POSE, seen=FACE + np.array([1.0, 0.0, 2.0])) - skin(body, POSE))[0].max(axis=1)
    assert set(np.flatnonzero(moved > 1e-6)) <= set(body.eyes.vertices.tolist())
    assert moved.max() > 0.002
