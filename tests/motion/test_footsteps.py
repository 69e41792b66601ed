"""Steps of bodies that glide."""

import numpy as np
import pytest

from motion import SMPL22
from motion.cleaning import foot_contacts, plant_feet
from motion.footsteps import stepping
from motion.metrics.naturalness import joint_speeds, naturalness
from webdemo.inference.finish.cleanup import on_constant_bones

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
    assert naturalness(walked, FPS).standing_foot < 3.0
    swings = [(joint_speeds(walked, FPS)[:, toe] > 1.2 * speed) for toe in (FEET[1], FEET[3])]
    starts = [int((np.diff(swing.astype(int)) == 1).sum()) for swing in swings]
    assert min(starts) >= 2 and abs(starts[0] - starts[1]) <= 1
    assert joint_speeds(walked, FPS).max() < 4.5 * speed + 2.0
    others = [joint for joint in range(22) if joint not in LEGS]
    np.testing.assert_array_equal(after[:, others], before[:, others])


def test_the_steps_end_where_the_body_stands_and_bones_stay() -> None:
    before = gliding(1.0)
    after = stepping(before, FPS)
    parents, children = np.array(SMPL22.bones).T
    lengths = [np.linalg.norm(p[:, children] - p[:, parents], axis=-1) for p in (before, after)]
    np.testing.assert_allclose(lengths[1], lengths[0], atol=1e-6)
    flat = [0, 2]
    for end in (slice(0, 14), slice(110, None)):
        np.testing.assert_allclose(after[end, FEET][..., flat], before[end, FEET][..., flat], atol=0.02)


def test_others_stay_as_they_are() -> None:
    still, running = gliding(0.0), gliding(3.0)
    lying = gliding(0.5) * [1, 0.3, 1]
    flying = gliding(1.0) + np.array([0, 0.4, 0])
    stepper = gliding(0.0)
    stepper[:, FEET[:2], 2] += 0.5 * np.clip((np.arange(120) - 30) / 12, 0, 1)[:, None]
    for motion in (still, running, lying, flying, stepper, gliding(1.0)[:3]):
        np.testing.assert_array_equal(stepping(motion, FPS), motion)


def test_a_body_that_surges_ahead_takes_no_giant_stride() -> None:
    frames, way = 60, 1.3
    rest = np.repeat((SMPL22.rest_positions() + np.array([0, 0.92, 0]))[None], frames, axis=0)
    rest = plant_feet(rest, np.ones((frames, 4), dtype=bool))
    share = np.clip((np.arange(frames) - 18) / 24, 0, 1)
    before = rest + way * (share * share * (3 - 2 * share))[:, None, None] * np.array([0, 0, 1.0])
    after = stepping(before, FPS)
    apart = np.linalg.norm((after[:, FEET[0]] - after[:, FEET[2]])[:, [0, 2]], axis=-1)
    assert 0.35 < apart.max() < 0.85


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
