"""A made person is not where the given one walks."""

import numpy as np
import pytest

from motion import SMPL22, Clip, Duet
from motion.touch.clearance import CLEAR, out_of_the_way
from webdemo.inference import ReactRequest, Result
from webdemo.inference.finish.cleanup import standing_clear

STANDING = SMPL22.rest_positions() - [0.0, SMPL22.rest_positions()[:, 1].min(), 0.0]
FRAMES = 120


def puncher(metres: float, degrees: float = 0.0) -> np.ndarray:
    """Somebody who walks so far in three seconds and punches on the way, (T, 22, 3)."""
    person = np.repeat(STANDING[None], FRAMES, axis=0)
    for joint in ("right_wrist", "right_elbow"):
        person[:, SMPL22.index(joint)] += [0.2, 0.0, 0.3]
    gone = metres * np.clip(np.arange(FRAMES) / 90, 0, 1)
    angle = np.radians(degrees)
    person[:, :, 0] += np.sin(angle) * gone[:, None]
    person[:, :, 2] += np.cos(angle) * gone[:, None]
    return person


def stander(x: float, z: float) -> np.ndarray:
    """Somebody who stands there and looks back, (T, 22, 3)."""
    return np.repeat((STANDING * [-1.0, 1.0, -1.0] + [x, 0.0, z])[None], FRAMES, axis=0)


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


def test_people_who_only_come_close_stay_where_they_are() -> None:
    assert out_of_the_way(puncher(0.9), stander(0.0, 1.5), 30.0) is None
    assert out_of_the_way(puncher(4.0), stander(0.8, 1.5), 30.0) is None
    embraced = puncher(0.0) + np.array([0.0, 0.0, 1.22])
    assert out_of_the_way(embraced, stander(0.0, 1.5), 30.0) is None


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
