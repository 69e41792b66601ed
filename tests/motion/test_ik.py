"""The whole-clip fit: exact on clean joints, constant bones and less error on noisy ones."""

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from motion.ik import body_scale, fit_skeleton
from motion.kinematics import forward_kinematics
from motion.skeleton import LAYOUTS, SMPL22, Skeleton

# Without collars, ankles and most of the spine: what cheap trackers give.
SPARSE = [
    name
    for name in SMPL22.joint_names
    if not name.endswith(("collar", "ankle")) and name not in ("pelvis", "spine1", "spine3")
]


def plausible_motion(seed: int, frames: int = 60) -> tuple[np.ndarray, np.ndarray]:
    """Rotations (T, 22, 3, 3) and root (T, 3) of someone who walks along and moves all limbs smoothly."""
    rng = np.random.default_rng(seed)
    time_ = np.arange(frames) / 30

    def swing(size: float, centre: float = 0.0) -> np.ndarray:
        return centre + size * np.sin(2 * np.pi * rng.uniform(0.3, 1.2) * time_ + rng.uniform(0, 6))

    def turns(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
        return np.stack([x, y, z], axis=-1)

    vectors = np.zeros((frames, 22, 3))
    vectors[:, 0] = turns(swing(0.1), swing(0.7, rng.uniform(-3, 3)), swing(0.05))
    for name in ("spine1", "spine2", "spine3", "neck"):
        vectors[:, SMPL22.index(name)] = turns(swing(0.1, 0.05), swing(0.05), swing(0.05))
    for side, sign in (("left", 1.0), ("right", -1.0)):
        vectors[:, SMPL22.index(f"{side}_shoulder")] = turns(swing(0.2), swing(0.4), swing(0.4, -0.8 * sign))
        vectors[:, SMPL22.index(f"{side}_elbow"), 1] = -sign * swing(0.6, 0.8)
        vectors[:, SMPL22.index(f"{side}_hip")] = turns(swing(0.5, -0.3), swing(0.1), swing(0.1))
        vectors[:, SMPL22.index(f"{side}_knee"), 0] = swing(0.4, 0.5)
        vectors[:, SMPL22.index(f"{side}_ankle"), 0] = swing(0.1)
    rotations = Rotation.from_rotvec(vectors.reshape(-1, 3)).as_matrix().reshape(frames, 22, 3, 3)
    return rotations, turns(swing(0.3), np.full(frames, 0.93), 0.3 * time_)


def recorded(layout_name: str, rotations: np.ndarray, root: np.ndarray) -> np.ndarray:
    """The joints of a layout on its own body; joints SMPL22 lacks at the root."""
    layout = LAYOUTS[layout_name]
    body = Skeleton("body", SMPL22.joint_names, SMPL22.parents, layout.offsets)
    joints = np.repeat(root[:, None], len(layout.joints), axis=1)
    joints[:, layout.columns] = forward_kinematics(rotations, root, body)[:, layout.observed]
    return joints


@settings(max_examples=3, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(seed=st.integers(0, 10_000))
@example(seed=2805)
def test_clean_joints_are_recovered(seed: int) -> None:
    truth = forward_kinematics(*plausible_motion(seed))
    for names in (SMPL22.joint_names, SPARSE):
        columns = [SMPL22.index(name) for name in names]
        fit = fit_skeleton(truth[:, columns], names)
        # Smoothness holds the fit back where a motion turns sharply, however long it is solved: the worst
        # coordinate of 246 seeds was off by 1.2 mm, the median seed's by 0.3.
        assert np.abs(fit.positions - truth)[:, columns].max() < 2e-3
        assert fit.error < 1e-3


@pytest.mark.parametrize("name", ["sbu15", "k3hi15", "ntu25", "cmu17"])
def test_other_layouts_give_the_same_pose(name: str) -> None:
    rotations, root = plausible_motion(3)
    fit = fit_skeleton(recorded(name, rotations, root), LAYOUTS[name], scale=1.0)
    # Limb directions are the pose; SMPL22's own proportions are what differs.
    truth = forward_kinematics(rotations, root)
    for joint in ("left_knee", "right_knee", "left_elbow", "right_wrist"):
        child, parent = SMPL22.index(joint), SMPL22.parents[SMPL22.index(joint)]
        expected, found = (p[:, child] - p[:, parent] for p in (truth, fit.positions))
        cosine = np.sum(expected * found, -1) / SMPL22.bone_lengths[child] ** 2
        assert cosine.min() > np.cos(np.radians(6))


def test_flipped_and_missing_joints_are_outvoted() -> None:
    truth = forward_kinematics(*plausible_motion(5))
    spoilt = truth.copy()
    wrist, foot = SMPL22.index("left_wrist"), SMPL22.index("right_foot")
    spoilt[20:23, wrist] += [0.0, 0.8, 0.5]
    spoilt[40:44, foot] = np.nan
    fit = fit_skeleton(spoilt, SMPL22.joint_names)
    assert np.linalg.norm(fit.positions - truth, axis=-1).max() < 0.08
    weights = np.ones((60, 22, 1))
    weights[20:23, wrist] = 0
    weighted = fit_skeleton(spoilt, SMPL22.joint_names, weights=weights)
    assert np.linalg.norm(weighted.positions - truth, axis=-1)[:, wrist].max() < 0.03


def test_large_people_shrink_to_the_skeleton_and_keep_their_path() -> None:
    truth = forward_kinematics(*plausible_motion(7))
    assert body_scale(1.2 * truth, SMPL22.joint_names) == pytest.approx(1.2, abs=0.01)
    fit = fit_skeleton(1.2 * truth, SMPL22.joint_names)
    assert np.abs(fit.positions - truth).max() < 0.01
    shared = fit_skeleton(1.2 * truth, SMPL22.joint_names, scale=1.0)
    np.testing.assert_allclose(shared.positions[:, 0, [0, 2]], 1.2 * truth[:, 0, [0, 2]], atol=0.01)
