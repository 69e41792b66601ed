"""Bodies beside each other instead of in each other."""

from __future__ import annotations

import numpy as np
import pytest

from motion import SMPL22, Clip, Duet
from motion.kinematics import bone_lengths
from motion.metrics.quality import DEEP, jerk_percentile, limb_depth, standing_foot
from motion.touch.apart import CLEAR, bodies_apart, out_of_the_way
from motion.transforms import heading_matrix
from webdemo.inference import ReactRequest, Result
from webdemo.inference.finish.cleanup import standing_clear

J = SMPL22.index
FRAMES = 90
FEET = [J(f"{side}_{joint}") for side in ("left", "right") for joint in ("ankle", "foot")]


def _pair(gap: float, aside: float = 0.0, turned: float = np.pi) -> np.ndarray:
    """Two people with hanging arms, the second ``gap`` metres ahead and ``aside``: (2, T, 22, 3)."""
    rest = SMPL22.standing()
    for side in ("left", "right"):
        for joint, down in (("elbow", 0.26), ("wrist", 0.52)):
            rest[J(f"{side}_{joint}")] = rest[J(f"{side}_shoulder")] - [0.0, down, 0.0]
    other = rest @ heading_matrix(turned).T + np.array([aside, 0.0, gap])
    return np.stack([np.tile(one, (FRAMES, 1, 1)) for one in (rest, other)])


def _deepest(pair: np.ndarray) -> float:
    return float(max(limb_depth(pair[i], pair[1 - i]).max() for i in (0, 1)))


@pytest.mark.parametrize(
    ("gap", "aside", "turned"), [(0.16, 0.03, np.pi), (0.02, 0.36, 0.0)], ids=["face to face", "beside"]
)
def test_bodies_and_feet_move_apart_on_bones_as_long_as_before(gap: float, aside: float, turned: float) -> None:
    pair = _pair(gap, aside, turned)
    found = bodies_apart(pair, 30.0)
    assert _deepest(pair) > 2 * DEEP
    assert _deepest(found) < DEEP
    np.testing.assert_allclose(bone_lengths(found), bone_lengths(pair), atol=2e-3)


def test_feet_that_stand_do_not_slide_when_the_other_comes_for_a_while() -> None:
    pair = _pair(0.6)
    pair[1, :, :, 2] -= 0.44 * np.exp(-(((np.arange(FRAMES) - 45) / 12) ** 2))[:, None]
    found = bodies_apart(pair, 30.0)
    assert _deepest(pair) > 2 * DEEP > 2 * _deepest(found)
    assert np.abs(np.diff(found[0][:, FEET], axis=0)).max() < 1e-3
    assert standing_foot(found[0], 30.0) < 0.1
    assert jerk_percentile(found[0], 30.0) < 20


def test_a_kick_ends_at_the_other_body() -> None:
    pair = _pair(0.75)
    share = np.clip((12 - np.abs(np.arange(FRAMES) - 45)) / 8, 0.0, 1.0)[:, None]
    hip = pair[0, :, J("right_hip")]
    for joint, there in (("right_knee", [0.0, 0.12, 0.34]), ("right_ankle", [0.02, 0.2, 0.68])):
        pair[0, :, J(joint)] += share * (hip + np.array(there) - pair[0, :, J(joint)])
    toe = pair[0, :, J("right_ankle")] + np.array([0.0, 0.12, 0.04])
    pair[0, :, J("right_foot")] += share * (toe - pair[0, :, J("right_foot")])
    found = bodies_apart(pair, 30.0)
    assert limb_depth(pair[0], pair[1]).max() > 0.08
    assert limb_depth(found[0], found[1]).max() < DEEP
    assert found[0, 45, J("right_ankle"), 2] > 0.4, "it still goes as far as the body"


STANDING = SMPL22.standing()
WALK_FRAMES = 120


def puncher(metres: float, degrees: float = 0.0) -> np.ndarray:
    """Somebody who walks so far in three seconds and punches on the way, (T, 22, 3)."""
    person = np.repeat(STANDING[None], WALK_FRAMES, axis=0)
    for joint in ("right_wrist", "right_elbow"):
        person[:, SMPL22.index(joint)] += [0.2, 0.0, 0.3]
    gone = metres * np.clip(np.arange(WALK_FRAMES) / 90, 0, 1)
    angle = np.radians(degrees)
    person[:, :, 0] += np.sin(angle) * gone[:, None]
    person[:, :, 2] += np.cos(angle) * gone[:, None]
    return person


def stander(x: float, z: float) -> np.ndarray:
    """Somebody who stands there and looks back, (T, 22, 3)."""
    return np.repeat((STANDING * [-1.0, 1.0, -1.0] + [x, 0.0, z])[None], WALK_FRAMES, axis=0)


def apart(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.asarray(np.linalg.norm((one - other)[:, 0, [0, 2]], axis=-1))


@pytest.mark.parametrize(("metres", "degrees"), [(1.4, 0.0), (2.0, 0.0), (3.5, 5.0), (6.0, -3.0)])
@pytest.mark.parametrize("given", [False, True])
def test_nobody_stands_where_a_puncher_walks(metres: float, degrees: float, given: bool) -> None:
    actor, other = puncher(metres, degrees), stander(0.05, 1.5)
    assert apart(actor, other).min() < 0.3
    way = out_of_the_way(actor, other, 30.0, first_pose_given=given)
    assert way is not None and not way[:, 1].any() and not (given and way[0].any())
    assert apart(actor, other + way[:, None])[:88].min() >= CLEAR - 1e-6
    assert given or metres > 3 or abs(way[0, 2]) > abs(way[0, 0]), "who is walked up to stays in front"


@pytest.mark.parametrize("role", ["a", "b"])
def test_a_reaction_is_moved_as_a_whole_and_says_so(role: str) -> None:
    actor = Clip(puncher(2.5).astype(np.float32), 30.0)
    made = Clip(stander(0.0, 1.5).astype(np.float32), 30.0)
    people = (actor, made) if role == "a" else (made, actor)
    result = Result(duets=(Duet(*people),), manifest={}, readouts=({},))
    request = ReactRequest(actor=actor, model="intergen", role=role)
    moved = standing_clear(result, request)
    given, other = moved.duets[0].people if role == "a" else moved.duets[0].people[::-1]
    np.testing.assert_array_equal(given.positions, actor.positions)
    assert apart(given.positions, other.positions)[:88].min() > 0.5
    assert np.ptp((other.positions - made.positions).reshape(-1, 3), axis=0).max() < 1e-5
    assert f"Person {'B' if role == 'a' else 'A'} was placed" in moved.notes[0] and moved.readouts[0]["after"]
    left = standing_clear(result, ReactRequest(actor=actor, model="intergen", role=role, cleanup=False))
    assert left is result
