"""Forward kinematics and rotations back from positions."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from motion import SMPL22
from motion.kinematics import (
    bone_lengths,
    fit_rotations,
    followed_rotations,
    forward_kinematics,
    global_rotations,
    local_rotations,
    project_to_skeleton,
    rotation_matrices,
)

quick = settings(max_examples=25, deadline=None)


def _pose(seed: int, spread: float) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    rotations = Rotation.from_rotvec(rng.normal(scale=spread, size=(3 * 22, 3))).as_matrix().reshape(3, 22, 3, 3)
    root = rng.normal(size=(3, 3))
    return rotations, root


@quick
@given(st.integers(0, 10**6), st.floats(0.0, 2.0))
def test_fitted_rotations_give_the_positions_back(seed, spread):
    rotations, root = _pose(seed, spread)
    positions = forward_kinematics(rotations, root)
    fitted = fit_rotations(positions)
    np.testing.assert_allclose(forward_kinematics(fitted, root), positions, atol=1e-6)
    np.testing.assert_allclose(np.linalg.det(fitted), 1, atol=1e-9)


@quick
@given(st.integers(0, 10**6))
def test_local_and_global_rotations_are_inverse(seed):
    rotations, _ = _pose(seed, 1.0)
    np.testing.assert_allclose(local_rotations(global_rotations(rotations)), rotations, atol=1e-9)


@quick
@given(st.integers(0, 10**6))
def test_projection_restores_bones_and_changes_nothing_twice(seed):
    rotations, root = _pose(seed, 0.5)
    noisy = forward_kinematics(rotations, root) + np.random.default_rng(seed).normal(scale=0.03, size=(3, 22, 3))
    projected, _ = project_to_skeleton(noisy)
    np.testing.assert_allclose(bone_lengths(projected) - SMPL22.bone_lengths[1:], 0, atol=1e-9)
    again, _ = project_to_skeleton(projected)
    np.testing.assert_allclose(again, projected, atol=1e-6)
    np.testing.assert_allclose(projected[:, 0], noisy[:, 0])


def test_rotations_go_on_where_a_limb_passes_the_opposite_of_its_rest():
    """An arm that circles through the direction opposite to the T-pose's, on a body that turns around twice."""
    angle = np.linspace(0.0, 4 * np.pi, 90)
    rotations = np.tile(np.eye(3), (90, 22, 1, 1))
    rotations[:, 0] = Rotation.from_euler("y", angle[:, None]).as_matrix()
    circle = np.stack([0.1 + 0 * angle, 0 * angle, angle], axis=-1)
    rotations[:, SMPL22.index("left_shoulder")] = Rotation.from_euler("yxz", circle).as_matrix()
    positions = forward_kinematics(rotations, np.zeros((90, 3)))
    found = followed_rotations(positions)
    assert np.linalg.norm(np.diff(found, axis=0), axis=-1).max() < 0.2
    world = rotation_matrices(found)
    np.testing.assert_allclose(world[:, 0], rotations[:, 0], atol=1e-9)
    for parent, joint in SMPL22.bones:
        bone = positions[:, joint] - positions[:, parent]
        turned = world[:, parent] @ (world[0, parent].T @ bone[0])
        np.testing.assert_allclose(turned, bone, atol=1e-9)


def test_opposite_bone_has_a_rotation():
    positions = SMPL22.rest_positions()
    knee, ankle, foot = (SMPL22.index(f"left_{n}") for n in ("knee", "ankle", "foot"))
    bone = positions[ankle] - positions[knee]
    positions[[ankle, foot]] -= 2 * bone
    projected, rotations = project_to_skeleton(positions)
    assert np.isfinite(rotations).all()
    np.testing.assert_allclose(projected[ankle], positions[ankle], atol=1e-6)
