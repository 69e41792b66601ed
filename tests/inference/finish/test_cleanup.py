"""Clean-up of one person, for whole motions and frame by frame."""

import numpy as np
import pytest

from acts.staging.poses import posed
from motion import SMPL22
from motion.kinematics import bone_lengths
from motion.metrics.quality import standing_foot
from webdemo.inference.finish import cleanup
from webdemo.inference.finish.cleanup import FollowingCleanup, _elbow_pole, clean_person, on_constant_bones

WRISTS = [SMPL22.index(name) for name in ("left_wrist", "right_wrist")]
TOES = [SMPL22.index(name) for name in ("left_foot", "right_foot")]


def trembling(frames: int = 60) -> np.ndarray:
    """(T, 22, 3) a person who stands with bent elbows and knees while every joint shakes by millimetres."""
    rng = np.random.default_rng(0)
    rest = SMPL22.rest_positions() + np.array([0, 0.93, 0])
    for side in ("left", "right"):
        knee, wrist = SMPL22.index(f"{side}_knee"), SMPL22.index(f"{side}_wrist")
        rest[knee] += [0, 0, 0.12]
        rest[wrist] = rest[SMPL22.index(f"{side}_elbow")] + [0, 0.1, 0.2]
    return rest + 0.004 * rng.normal(size=(frames, 22, 3))


def test_bones_become_constant_and_wrists_stay() -> None:
    shaking = trembling()
    steady = on_constant_bones(shaking)
    assert bone_lengths(shaking).std(axis=0).max() > 0.002
    np.testing.assert_allclose(bone_lengths(steady), SMPL22.bone_lengths[1:].reshape(1, -1).repeat(60, 0), atol=1e-6)
    assert np.linalg.norm(steady[:, WRISTS] - shaking[:, WRISTS], axis=-1).max() < 0.02


def test_standing_feet_slide_less() -> None:
    shaking = trembling()
    slide = [np.abs(np.diff(x[:, TOES][..., [0, 2]], axis=0)).mean() for x in (shaking, clean_person(shaking))]
    assert slide[1] < 0.5 * slide[0]


def test_frame_by_frame_no_frame_depends_on_a_later_one() -> None:
    shaking, contacts = trembling(20), np.full(4, 0.9)
    whole, part = FollowingCleanup(), FollowingCleanup()
    shown = [whole(frame, contacts) for frame in shaking]
    np.testing.assert_array_equal([part(frame, contacts) for frame in shaking[:8]], shown[:8])


def test_a_standing_foot_keeps_its_place_and_is_let_go() -> None:
    shaking = trembling(40)
    cleanup = FollowingCleanup()
    stands = np.array([cleanup(frame, np.full(4, 0.9)) for frame in shaking[:20]])
    assert np.ptp(stands[:, TOES][..., [0, 2]], axis=0).max() < 0.005
    assert np.ptp(shaking[:20, TOES][..., [0, 2]], axis=0).max() > 0.01
    loose = np.array([cleanup(frame, np.zeros(4)) for frame in shaking[20:]])
    assert np.ptp(loose[5:, TOES][..., [0, 2]], axis=0).max() > 0.005
    assert min(loose[:, TOES, 1].min(), stands[:, TOES, 1].min()) > -1e-6


def test_toes_that_swing_are_raised(monkeypatch: pytest.MonkeyPatch) -> None:
    walker = np.repeat((SMPL22.rest_positions() + np.array([0, 0.95, 0]))[None], 40, axis=0)
    share = np.clip((np.arange(40) - 12) / 14, 0, 1)
    walker[:, [SMPL22.index("right_ankle"), TOES[1]], 2] += (0.6 * share**2 * (3 - 2 * share))[:, None]
    raised = clean_person(walker)[:, TOES[1], 1]
    monkeypatch.setattr(cleanup, "lift_swinging_feet", lambda positions, fps: positions)
    assert (raised - clean_person(walker)[:, TOES[1], 1]).max() > 0.015


def test_bodies_are_kept_above_the_floor() -> None:
    sunk = np.repeat(posed("lies", np.zeros(2), 0.0)[None], 20, axis=0) - [0.0, 0.3, 0.0]
    assert clean_person(sunk)[:, 0, 1].min() > 0.05


def test_an_arm_that_folds_over_its_shoulder_does_not_fling_its_elbow() -> None:
    """The line from shoulder to wrist has no direction where they meet, so the elbow turned about it at 11 m/s."""
    moving = np.repeat((SMPL22.rest_positions() + np.array([0, 0.98, 0]))[None], 60, axis=0)
    shoulder, elbow, wrist = (SMPL22.index(f"left_{joint}") for joint in ("shoulder", "elbow", "wrist"))
    moving[:, elbow] = moving[:, shoulder] + [0.26, 0.0, 0.0]
    height = np.linspace(-0.2, 0.2, 60)
    moving[:, wrist] = moving[:, shoulder] + np.stack([0.02 + 0 * height, height, 0.01 + 0 * height], axis=-1)
    cleaned = clean_person(moving)
    assert np.linalg.norm(np.diff(cleaned[:, elbow], axis=0), axis=-1).max() * 30 < 2.0


def test_a_straight_arm_bends_backwards_and_down() -> None:
    ahead = np.array([[0.0, 0.0, 1.0]])
    np.testing.assert_array_equal(_elbow_pole(ahead), [[0.0, -1.0, -1.0]])


def walking() -> np.ndarray:
    """(T, 22, 3) a person who walks at 1.2 m/s, whose feet glide by turns as one hands the weight to the other."""
    rest = SMPL22.rest_positions() + np.array([0, 0.93, 0])
    time = np.arange(90) / 30
    walker = np.repeat(rest[None], 90, axis=0)
    walker[..., 2] += 1.2 * time[:, None]
    for side, phase in (("left", 0.0), ("right", 0.5)):
        step = time + phase
        swing = np.clip((step % 1.0 - 0.54) / 0.46, 0, 1)
        ahead = 1.2 * (np.floor(step) + swing**2 * (3 - 2 * swing) - phase) + 0.32
        for joint, rise in (("knee", 0.0), ("ankle", 0.06), ("foot", 0.02)):
            at = SMPL22.index(f"{side}_{joint}")
            walker[:, at, 2] = rest[at, 2] + (0.5 * (ahead + 1.2 * time) if joint == "knee" else ahead)
            walker[:, at, 1] += rise * np.sin(np.pi * swing) ** 2
    return walker


def test_one_foot_stands_until_the_other_does() -> None:
    assert standing_foot(clean_person(walking()), 30.0) < 1.0
