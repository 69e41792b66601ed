"""People who stand by, as recorded: they stay where they are, face where they should, and live."""

from __future__ import annotations

import numpy as np
import pytest

from acts.staging.poses import recordings, standing_by
from motion import FPS, SMPL22
from motion.transforms import heading

FRAMES = np.arange(600)
PLACE = np.array([2.0, -1.0])
FEET = [SMPL22.index(f"{side}_{joint}") for side in ("left", "right") for joint in ("ankle", "foot")]


@pytest.mark.parametrize("seed", range(0, 60, 7))
def test_they_stay_and_move_a_little_all_the_time(seed: int) -> None:
    poses = standing_by(PLACE, 2.0, FRAMES, seed)
    assert np.abs(poses[:, 0][:, [0, 2]] - PLACE).max() < 0.4
    off = heading(poses) - 2.0
    assert abs(np.arctan2(np.sin(off).mean(), np.cos(off).mean())) < 0.35
    speeds = np.linalg.norm(np.diff(poses, axis=0), axis=-1) * FPS
    assert speeds.max() < 2.5, "also where the recording is turned back"
    assert (speeds[:, FEET].max(-1) < 0.2).mean() > 0.85, "the feet stay"
    assert (speeds.max(-1) > 0.2).mean() > 0.3


def test_a_scene_goes_on_where_it_was_and_seeds_differ() -> None:
    whole = standing_by(PLACE, 0.0, FRAMES, 1)
    np.testing.assert_array_equal(standing_by(PLACE, 0.0, FRAMES[300:], 1), whole[300:])
    others = [standing_by(PLACE, 0.0, FRAMES, seed) for seed in range(2, 12)]
    assert min(np.abs(other - whole).max() for other in others) > 0.05


def test_bones_are_those_of_the_skeleton() -> None:
    parents, children = (list(side) for side in zip(*SMPL22.bones, strict=True))
    for poses in recordings():
        lengths = np.linalg.norm(poses[:, children] - poses[:, parents], axis=-1)
        np.testing.assert_allclose(lengths, np.broadcast_to(SMPL22.bone_lengths[children], lengths.shape), atol=0.004)
