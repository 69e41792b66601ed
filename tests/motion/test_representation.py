"""The 262-number representation against the released numbers, and its round trips."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motion import representation as rep
from motion.kinematics import forward_kinematics
from motion.skeleton import SMPL22
from motion.transforms import canonicalize

REFERENCE = Path(__file__).parents[1] / "data" / "reference" / "intergen_representation.npz"


@pytest.fixture(scope="module")
def reference():
    with np.load(REFERENCE) as stored:
        return dict(stored)


def _people(seed: int, frames: int = 12):
    """Two random people whose bodies turn, bend and walk."""
    rng = np.random.default_rng(seed)
    rotations = rep.from_6d(rep.to_6d(np.eye(3)) + 0.3 * rng.normal(size=(2, 1, 22, 6)))
    rotations = np.repeat(rotations, frames, axis=1)
    root = (
        np.cumsum(rng.normal(scale=0.02, size=(2, frames, 3)), axis=1)
        + np.array([0, 1, 0])
        + rng.normal(size=(2, 1, 3))
    )
    return forward_kinematics(rotations, root)


@pytest.mark.parametrize("person", "ab")
def test_canonical_person_equals_the_release(reference, person):
    raw = reference[f"raw_{person}"]  # 22 places, Z up, and the rotations of 21 joints
    positions, rotations = rep.upright(raw), raw[:, 66:].reshape(-1, 21, 6)
    positions -= [0, positions[..., 1].min(), 0]
    features = rep.encode_person(canonicalize(positions), rotations)
    expected = reference["features_a" if person == "a" else "features_b_canonical"]
    np.testing.assert_allclose(features, expected, atol=1e-5)


def test_fitted_rotations_come_back_from_features():
    features = rep.encode_person(_people(3)[0])
    rotations = rep.from_6d(features[:, rep.ROTATIONS].reshape(-1, 21, 6))
    root = rep.fit_rotations(rep.decode_positions(features)[:-1])[:, :1]
    positions = forward_kinematics(np.concatenate([root, rotations], axis=1), features[:, :3], SMPL22)
    np.testing.assert_allclose(positions.reshape(-1, 66), features[:, rep.POSITIONS], atol=1e-4)
