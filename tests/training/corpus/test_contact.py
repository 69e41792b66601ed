"""Contact: arms reach where they should, bones and untouched frames stay, beats keep their promises."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from motion.kinematics import forward_kinematics
from motion.skeleton import SMPL22
from tests.training.corpus.recorded import bone_error, clips, standing
from training.corpus.beats.script import compose
from training.corpus.compose import ARMS
from training.corpus.contact import envelope, reach
from training.corpus.cues import SourceClip
from training.corpus.library import Library

FRAMES = 90
HANDS = ("shake-hands", "high-five", "low-five", "fist-bump", "hand-over", "walk-hand-in-hand", "help-up")
CONTACT = (*HANDS, "elbow-bump", "hug", "pat:back", "pat:shoulder", "hand-on:shoulder", "arm-around", "push")


def body() -> np.ndarray:
    """A person who stands and sways."""
    return forward_kinematics(*standing(FRAMES))


def _roughest(positions: np.ndarray) -> float:
    """Greatest joint acceleration in m/s²."""
    return float(np.linalg.norm(np.diff(positions, 2, axis=0) * 900, axis=-1).max())


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_reach_arrives_keeps_bones_and_leaves_other_frames_alone(side):
    own = body()
    target = np.tile([0.1, 1.25, 0.35], (FRAMES, 1))
    weight = envelope(FRAMES, 20, 40, 55, 75)
    reached = reach(own, {side: target}, weight)
    wrist = reached[:, ARMS[side][3]]
    assert np.linalg.norm(wrist - target, axis=-1)[40:56].max() < 0.01
    assert bone_error(reached) < 1e-6
    np.testing.assert_allclose(reached[weight == 0], own[weight == 0], atol=1e-12)
    elbow, shoulder = reached[45, ARMS[side][2]], reached[45, ARMS[side][1]]
    assert elbow[1] < shoulder[1], "the elbow hangs below the shoulder"
    assert _roughest(reached) < 25


def test_a_far_target_takes_the_trunk_along_but_not_the_feet():
    own = body()
    target = np.tile([0.0, 1.1, 0.68], (FRAMES, 1))
    reached = reach(own, {"right": target}, envelope(FRAMES, 20, 40, 55, 75))
    assert np.linalg.norm(reached[45, ARMS["right"][3]] - target[45]) < 0.03
    assert reached[45, SMPL22.index("right_shoulder"), 2] > own[45, SMPL22.index("right_shoulder"), 2] + 0.05
    for foot in ("left_foot", "right_foot"):  # a heel may rise
        np.testing.assert_allclose(reached[:, SMPL22.index(foot)], own[:, SMPL22.index(foot)], atol=5e-3)
    assert bone_error(reached) < 1e-6


# ---- beats on small made-up sources


def blow(joint: str, still: list[float], vector: list[float], action: str) -> SourceClip:
    """A limb that goes out and back around the middle."""
    rotations, root = standing(90)
    share = envelope(90, 30, 44, 46, 62)[:, None]
    turns = {joint: np.array(still) * (1 - share) + np.array(vector) * share}
    if "shoulder" in joint:  # the elbow is folded before and after the blow
        turns["right_elbow"] = np.array([0, 2.0, 0]) * (1 - share)
    for name, turn in turns.items():
        rotations[:, SMPL22.index(name)] = Rotation.from_rotvec(turn).as_matrix()
    return SourceClip(forward_kinematics(rotations, root), action, "normal", "right", f"train-{action}", "made-up")


@pytest.fixture(scope="module")
def library() -> Library:
    punch = blow("right_shoulder", [0, 0, 1.35], [0, 1.45, 0.1], "punch")
    kick = blow("right_hip", [0, 0, 0], [-1.75, 0, 0], "kick")
    return Library([*clips(), punch, kick], "train")


@pytest.mark.parametrize("name", CONTACT)
def test_a_beat_of_contact_touches_on_constant_bones_and_says_so(name, library):
    for seed in range(3):
        scene = compose(np.random.default_rng(seed), library, first=name)
        people = scene.positions
        assert bone_error(people.astype(float)) < 1e-3
        assert len(scene.captions) >= 3 and scene.split == "train" and scene.sources
        touch = min(scene.events["contact"], key=lambda one: one["start"])
        own, other = SMPL22.index(touch["a"]), SMPL22.index(touch["b"])
        assert 0 <= touch["start"] <= touch["end"] < people.shape[1]
        inside = slice(touch["start"], touch["end"] + 1)
        gap = np.linalg.norm(people[0, inside, own] - people[1, inside, other], axis=-1)
        assert gap.min() < (0.1 if name in HANDS else 0.3), (seed, touch, gap.min())
