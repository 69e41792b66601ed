"""Contact: arms reach where they should, bones and untouched frames stay, beats keep their promises."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from motion.kinematics import forward_kinematics
from motion.skeleton import SMPL22
from motion.transforms import turn
from training.corpus.beats.script import compose
from training.corpus.compose import ARMS
from training.corpus.contact import envelope, reach
from training.corpus.cues import SourceClip
from training.corpus.library import Library

FRAMES = 90
HANDS = ("shake-hands", "high-five", "low-five", "fist-bump", "hand-over", "walk-hand-in-hand", "help-up")
CONTACT = (*HANDS, "elbow-bump", "hug", "pat:back", "pat:shoulder", "hand-on:shoulder", "arm-around", "push")


def _rotations(frames: int, **turns: np.ndarray) -> np.ndarray:
    """(frames, 22, 3, 3) arms hanging, and the given joints turned by rotation vectors (frames, 3)."""
    rotations = np.tile(np.eye(3), (frames, 22, 1, 1))
    hanging = {
        "left_shoulder": [0, 0, -1.35],
        "right_shoulder": [0, 0, 1.35],
        "left_elbow": [0, -0.3, 0],
        "right_elbow": [0, 0.3, 0],
    }
    for name, vector in {**hanging, **turns}.items():
        rotations[:, SMPL22.index(name)] = Rotation.from_rotvec(np.array(vector) + np.zeros((frames, 3))).as_matrix()
    return rotations


def _body(frames: int = FRAMES, *, away: float = 0.0, heading: float = 0.0, **turns: np.ndarray) -> np.ndarray:
    root = np.tile([0.0, 0.92, 0.0], (frames, 1))
    root[:, 0] += 0.01 * np.sin(np.arange(frames) / 20)
    positions = turn(forward_kinematics(_rotations(frames, **turns), root), heading)
    return positions + np.array([0.0, 0.0, away])


def _bone_error(positions: np.ndarray) -> float:
    bones = np.array(SMPL22.bones)
    lengths = np.linalg.norm(positions[:, bones[:, 1]] - positions[:, bones[:, 0]], axis=-1)
    return float(np.abs(lengths - SMPL22.bone_lengths[bones[:, 1]]).max())


def _roughest(positions: np.ndarray) -> float:
    """Greatest joint acceleration in m/s²."""
    return float(np.linalg.norm(np.diff(positions, 2, axis=0) * 900, axis=-1).max())


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_reach_arrives_keeps_bones_and_leaves_other_frames_alone(side):
    body = _body()
    target = np.tile([0.1, 1.25, 0.35], (FRAMES, 1))
    weight = envelope(FRAMES, 20, 40, 55, 75)
    reached = reach(body, {side: target}, weight)
    wrist = reached[:, ARMS[side][3]]
    assert np.linalg.norm(wrist - target, axis=-1)[40:56].max() < 0.01
    assert _bone_error(reached) < 1e-6
    np.testing.assert_allclose(reached[weight == 0], body[weight == 0], atol=1e-12)
    elbow, shoulder = reached[45, ARMS[side][2]], reached[45, ARMS[side][1]]
    assert elbow[1] < shoulder[1], "the elbow hangs below the shoulder"
    assert _roughest(reached) < 25


def test_a_far_target_takes_the_trunk_along_but_not_the_feet():
    body = _body()
    target = np.tile([0.0, 1.1, 0.68], (FRAMES, 1))
    reached = reach(body, {"right": target}, envelope(FRAMES, 20, 40, 55, 75))
    assert np.linalg.norm(reached[45, ARMS["right"][3]] - target[45]) < 0.03
    assert reached[45, SMPL22.index("right_shoulder"), 2] > body[45, SMPL22.index("right_shoulder"), 2] + 0.05
    for foot in ("left_foot", "right_foot", "left_ankle", "right_ankle"):
        np.testing.assert_allclose(reached[:, SMPL22.index(foot)], body[:, SMPL22.index(foot)], atol=5e-3)
    assert _bone_error(reached) < 1e-6


# ---- beats on small made-up sources


def _gait(frames: int, speed: float) -> np.ndarray:
    """A plain walk along +Z: legs swing, knees bend while a leg swings, arms swing against the legs."""
    phase = 2 * np.pi * np.arange(frames) / 30 * 0.9
    turns = {}
    for sign, leg, arm in ((1, "left", "right"), (-1, "right", "left")):
        swing = sign * np.sin(phase)
        turns[f"{leg}_hip"] = np.stack([-0.4 * swing, 0 * swing, 0 * swing], axis=-1)
        lift = 0.6 * np.maximum(sign * np.cos(phase), 0)
        turns[f"{leg}_knee"] = np.stack([lift, 0 * lift, 0 * lift], axis=-1)
        hang = 1.35 if arm == "right" else -1.35
        arms = Rotation.from_rotvec(np.stack([-0.35 * swing, 0 * swing, 0 * swing], axis=-1))
        arms = arms * Rotation.from_rotvec([0, 0, hang])
        turns[f"{arm}_shoulder"] = arms.as_rotvec()
    root = np.stack([np.zeros(frames), np.full(frames, 0.92), speed * np.arange(frames) / 30], axis=-1)
    return forward_kinematics(_rotations(frames, **turns), root)


def _blow(joint: str, vector: list[float], frames: int = 90) -> np.ndarray:
    """A limb that goes out and back around the middle."""
    share = envelope(frames, 30, 44, 46, 62)[:, None]
    start = np.array([0, 0, 1.35]) if "shoulder" in joint else np.zeros(3)
    turns = {joint: start * (1 - share) + np.array(vector) * share}
    root = np.tile([0.0, 0.92, 0.0], (frames, 1))
    rotations = _rotations(frames, **turns)
    if "shoulder" in joint:  # the elbow is folded before and after the blow
        folded = np.array([0, 2.0, 0]) * (1 - share)
        rotations[:, SMPL22.index("right_elbow")] = Rotation.from_rotvec(folded).as_matrix()
    return forward_kinematics(rotations, root)


@pytest.fixture(scope="module")
def library() -> Library:
    sway = {"spine2": 0.02 * np.sin(np.arange(400)[:, None] / 25) * np.ones(3)}
    clips = [
        SourceClip(_body(400, **sway), "idle", "normal", None, "idle_1", "made-up"),
        SourceClip(_gait(150, 1.1), "walk", "normal", None, "walk_1", "made-up"),
        SourceClip(_gait(150, 0.8), "walk", "tired", None, "walk_2", "made-up"),
        SourceClip(_gait(120, -0.6), "walk-back", "normal", None, "back_1", "made-up"),
        SourceClip(_blow("right_shoulder", [0, 1.45, 0.1]), "punch", "normal", "right", "punch_1", "made-up"),
        SourceClip(_blow("right_hip", [-1.75, 0, 0]), "kick", "normal", "right", "kick_1", "made-up"),
    ]
    return Library(clips, "train")


@pytest.mark.parametrize("name", CONTACT)
def test_a_beat_of_contact_touches_on_constant_bones_and_says_so(name, library):
    for seed in range(3):
        scene = compose(np.random.default_rng(seed), library, first=name, told=0.0)
        people = scene.positions
        assert max(_bone_error(person.astype(float)) for person in people) < 1e-3
        assert len(scene.captions) >= 3 and scene.split == "train" and scene.sources
        touch = min(scene.events["contact"], key=lambda one: one["start"])
        own, other = SMPL22.index(touch["a"]), SMPL22.index(touch["b"])
        assert 0 <= touch["start"] <= touch["end"] < people.shape[1]
        inside = slice(touch["start"], touch["end"] + 1)
        gap = np.linalg.norm(people[0, inside, own] - people[1, inside, other], axis=-1)
        assert gap.min() < (0.1 if name in HANDS else 0.3), (seed, touch, gap.min())
