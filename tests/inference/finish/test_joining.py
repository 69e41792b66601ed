"""What is made leads to given frames, and a loop's end to its beginning, without a jolt and on constant bones."""

import numpy as np

from motion import SMPL22
from motion.kinematics import bone_lengths, fit_rotations, forward_kinematics
from motion.skeleton import FEET
from motion.transforms import heading_matrix
from webdemo.inference.finish.joining import PASSING, REACH, closed, joined, passing
from webdemo.inference.pipelines.given import with_given

FRAMES = 90


def mover(shift: float = 0.0, speed: float = 0.4) -> np.ndarray:
    """(FRAMES, 22, 3) a person who floats on and swings the arms; another shift, another phase of the arms."""
    rest = fit_rotations(SMPL22.rest_positions())
    rotations = np.repeat(rest[None], FRAMES, axis=0)
    for side, joint in enumerate(("left_shoulder", "right_shoulder")):
        angle = 0.8 * np.sin(np.arange(FRAMES) / 8 + 2 * shift + side)
        rotations[:, SMPL22.index(joint)] = np.stack([heading_matrix(a) for a in angle])
    pelvis = np.array([0.3 * shift, 1.3, 0.0]) + np.arange(FRAMES)[:, None] / 30 * [0, 0, speed]
    return forward_kinematics(rotations, pelvis)


def jerk(positions: np.ndarray) -> np.ndarray:
    return np.linalg.norm(np.diff(positions, n=3, axis=0), axis=-1).max(-1)


def test_given_frames_are_led_to_without_a_jolt_on_the_same_bones() -> None:
    made, given = mover(1.0), mover()
    ends = np.r_[0:30, 75:FRAMES]
    hard = made.copy()
    hard[ends] = given[ends]
    found = joined(made, ends[::-1], given[ends[::-1]])
    np.testing.assert_allclose(found[ends], given[ends], atol=1e-9)
    untouched = slice(30 + REACH, 75 - REACH)
    np.testing.assert_allclose(found[untouched], made[untouched], atol=1e-9)
    np.testing.assert_allclose(bone_lengths(found), bone_lengths(made), atol=1e-6)
    assert jerk(found).max() < 0.05 * jerk(hard).max()


def test_a_foot_that_stands_at_given_frames_stays_there() -> None:
    standing = np.repeat((SMPL22.rest_positions() + np.array([0, 0.98, 0]))[None], FRAMES, axis=0)
    feet = joined(standing + np.array([0.06, 0, 0]), np.arange(30), standing[:30])[:, list(FEET)]
    assert np.abs(feet - standing[:1, list(FEET)])[..., 0].max() < 0.02


def test_a_single_pose_is_passed_through_without_a_jolt() -> None:
    """An arm that is straight one frame and bent the next, as clean-up leaves it where bones were too short."""
    pose = mover()[45]
    shoulder, elbow, wrist = (SMPL22.index(f"right_{part}") for part in ("shoulder", "elbow", "wrist"))
    for joint, before in ((elbow, shoulder), (wrist, elbow)):
        pose[joint] = pose[before] + np.array([0, SMPL22.bone_lengths[joint], 0])  # straight up
    made, fixed = mover(), np.arange(FRAMES) < 20
    for joint, before in ((elbow, shoulder), (wrist, elbow)):
        made[46:50, joint] = made[46:50, before] + [0, -SMPL22.bone_lengths[joint], 0]
    alone = with_given(made, np.array([45]), pose[None])
    found = passing(made, np.array([45]), pose[None], fixed)
    np.testing.assert_allclose(found[45], pose, atol=1e-9)
    away = np.abs(np.arange(FRAMES) - 45) > PASSING
    np.testing.assert_allclose(found[away | fixed], made[away | fixed], atol=1e-9)
    np.testing.assert_allclose(bone_lengths(found[40:45]), bone_lengths(made[40:45]), atol=1e-6)
    assert jerk(found)[35:55].max() < 0.3 * jerk(alone)[35:55].max()
    # Poses and given frames that are neighbours: what is held stays.
    close = passing(made, np.array([22, 45]), np.stack([made[22], pose]), fixed)
    np.testing.assert_allclose(close[:20], made[:20], atol=1e-9)


def test_a_loop_closes_in_place_and_speed_and_keeps_what_is_fixed() -> None:
    """In half a second the arms take another phase and the pelvis comes back 30 cm."""
    open_ended = mover(speed=0.1)
    found = closed(open_ended, np.array([4]))
    ahead = 2 * found[-1] - found[-2]
    speed = (found[1] - found[0]) - (found[-1] - found[-2])
    assert np.linalg.norm(open_ended[0] - 2 * open_ended[-1] + open_ended[-2], axis=-1).max() > 0.3
    assert np.linalg.norm(found[0] - ahead, axis=-1).max() < 0.01
    assert np.linalg.norm(speed, axis=-1).max() < 0.01
    np.testing.assert_array_equal(found[4], open_ended[4])
    np.testing.assert_allclose(found[REACH:-REACH], open_ended[REACH:-REACH], atol=1e-9)
    np.testing.assert_allclose(bone_lengths(found), bone_lengths(open_ended), atol=1e-6)


def dancer(seconds: float = 3.0, turn: float = 1.2) -> np.ndarray:
    """(T, 22, 3) a person who turns around on bent knees, ``turn`` times a second, and lets an arm circle."""
    time = np.arange(round(30 * seconds)) / 30
    rotations = np.repeat(fit_rotations(SMPL22.rest_positions())[None], len(time), axis=0)
    rotations[:, 0] = np.stack([heading_matrix(a) for a in 2 * np.pi * turn * time])
    circle = np.stack([heading_matrix(a) for a in -2 * np.pi * 1.5 * time])
    rotations[:, SMPL22.index("left_shoulder")] = circle
    way = np.stack([0.2 * np.sin(3 * time), 1.3 + 0 * time, 0.2 * time], axis=-1)
    return forward_kinematics(rotations, way)


def test_what_turns_fast_is_not_thrown_around_where_it_joins() -> None:
    """The mean of two rotation matrices that are half a turn apart is none, and limbs jumped by half a metre."""
    made = dancer()
    ends = np.r_[0:30, 60:90]
    found = joined(made, ends, made[ends])
    hard = np.linalg.norm(np.diff(made, n=2, axis=0), axis=-1).max()
    assert np.linalg.norm(np.diff(found, n=2, axis=0), axis=-1).max() < 1.5 * hard
    np.testing.assert_allclose(bone_lengths(found), bone_lengths(made), atol=1e-6)


def test_a_dance_that_turns_closes_without_a_jolt_and_only_there() -> None:
    made = dancer(3.1, turn=0.7)  # an odd number of frames
    found = closed(made, np.zeros(0, dtype=int))
    around = np.concatenate([found[-REACH - 5 :], found[: REACH + 5]])
    assert jerk(around).max() < 0.025, "metres a frame³, where the hand circles at 13 cm a frame"
    closing = np.diff(np.concatenate([found[-2:], found[:2]]), n=2, axis=0)
    assert np.linalg.norm(closing, axis=-1).max() < 0.01
    assert np.linalg.norm(closing.sum(0), axis=-1).max() < 0.01
    np.testing.assert_array_equal(found[REACH:-REACH], made[REACH:-REACH])
    np.testing.assert_allclose(bone_lengths(found), bone_lengths(made), atol=1e-6)
