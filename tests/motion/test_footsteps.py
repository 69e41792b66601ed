"""Steps of bodies that glide."""

from __future__ import annotations

import numpy as np
import pytest

from motion import SMPL22
from motion.cleaning import foot_contacts, plant_feet
from motion.footsteps import pivoting, stepping, with_feet
from motion.kinematics import bone_lengths
from motion.metrics.quality import joint_speeds, naturalness
from motion.smoothing import minimum_jerk
from motion.transforms import facing, heading_matrix
from webdemo.inference.finish.cleanup import clean_person, on_constant_bones

from .bodies import FPS

FEET = [SMPL22.index(f"{side}_{part}") for side in ("left", "right") for part in ("ankle", "foot")]
LEGS = [*FEET, *(SMPL22.index(f"{side}_knee") for side in ("left", "right"))]


def gliding(speed: float, frames: int = 120) -> np.ndarray:
    """A person who stands for half a second, is moved over the floor, and stands again for half a second."""
    rest = np.repeat((SMPL22.rest_positions() + np.array([0, 0.92, 0]))[None], frames, axis=0)
    rest = plant_feet(rest, np.ones((frames, 4), dtype=bool))  # on bent knees
    time = np.clip(np.arange(frames) - 15, 0, frames - 30) / FPS
    return rest + speed * time[:, None, None] * np.array([0.6, 0, 0.8])


@pytest.mark.parametrize("speed", [0.4, 0.8, 1.3])
def test_a_body_that_glides_walks(speed: float) -> None:
    before = gliding(speed)
    after = stepping(before, FPS)
    walked = plant_feet(after, foot_contacts(after, FPS))
    assert naturalness(before, FPS).standing_foot > 60 * speed
    assert naturalness(walked, FPS).standing_foot < (3.0 if speed < 1.2 else 10.0), "legs reach less far in a run"
    swings = [(joint_speeds(walked, FPS)[:, toe] > 1.2 * speed) for toe in (FEET[1], FEET[3])]
    starts = [int((np.diff(swing.astype(int)) == 1).sum()) for swing in swings]
    assert min(starts) >= 2 and abs(starts[0] - starts[1]) <= 1
    assert joint_speeds(walked, FPS).max() < 4.5 * speed + 2.0
    others = [joint for joint in range(22) if joint not in LEGS]
    np.testing.assert_array_equal(after[:, others], before[:, others])


def test_a_body_that_glides_from_the_first_frame_on_kicks_no_foot_ahead() -> None:
    """One foot is far behind then, and the step that takes it ahead began before anybody looked."""
    motion, along, frame = gliding(0.0), np.array([0.6, 0, 0.8]), np.arange(120)
    motion += 1.6 * np.clip(frame, 0, 9)[:, None, None] / FPS * along
    motion[:, FEET[:2]] -= 0.6 * np.clip(1 - frame / 8, 0, 1)[:, None, None] * along
    motion = on_constant_bones(motion)
    after = stepping(motion, FPS)
    walked = plant_feet(after, foot_contacts(after, FPS))
    speeds = joint_speeds(walked, FPS)[:, FEET]
    assert speeds[:2].max() < 2.5
    assert speeds.max() < 6.0


ANKLES = [SMPL22.index("left_ankle"), SMPL22.index("right_ankle")]
TOES = [SMPL22.index("left_foot"), SMPL22.index("right_foot")]


def turned(angle: float, begins: int = 30, later: int = 6) -> np.ndarray:
    """A person (T, 22, 3) who turns over feet that stay, and are under the hips ``later`` frames after the turn."""
    rest = np.repeat((SMPL22.rest_positions() + np.array([0, 0.92, 0]))[None], 4, axis=0)
    stands = plant_feet(rest, np.ones((4, 4), dtype=bool))[0]  # on bent knees
    turns = heading_matrix(angle * minimum_jerk((np.arange(120) - begins) / 27))
    body = np.einsum("tij,nj->tni", turns, stands - stands[0] * [1, 0, 1])
    feet = np.stack([body[:, [ankle, toe]] for ankle, toe in zip(ANKLES, TOES, strict=True)], axis=1)
    feet[: begins + 27 + later] = feet[0]
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
    np.testing.assert_allclose(bone_lengths(found), bone_lengths(before), atol=1e-6)


def test_the_clean_up_uncrosses_the_legs_of_who_turns() -> None:
    person = turned(np.pi)
    assert apart(person).min() < -0.05 and apart(clean_person(person)).min() > 0.0


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


def test_a_body_that_surges_ahead_takes_no_giant_stride() -> None:
    frames, way = 60, 1.3
    rest = np.repeat((SMPL22.rest_positions() + np.array([0, 0.92, 0]))[None], frames, axis=0)
    rest = plant_feet(rest, np.ones((frames, 4), dtype=bool))
    share = np.clip((np.arange(frames) - 18) / 24, 0, 1)
    before = rest + way * (share * share * (3 - 2 * share))[:, None, None] * np.array([0, 0, 1.0])
    after = stepping(before, FPS)
    apart = np.linalg.norm((after[:, FEET[0]] - after[:, FEET[2]])[:, [0, 2]], axis=-1)
    assert 0.35 < apart.max() < 0.85
