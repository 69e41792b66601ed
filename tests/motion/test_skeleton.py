"""Skeletons: trees of joints with a T-pose."""

import numpy as np
import pytest

from motion.skeleton import SKELETONS, SMPL22, Skeleton


@pytest.mark.parametrize("skeleton", SKELETONS.values(), ids=list(SKELETONS))
def test_every_skeleton_is_one_tree_that_mirrors_onto_itself(skeleton: Skeleton) -> None:
    assert skeleton.parents.count(-1) == 1 and len(skeleton.bones) == skeleton.num_joints - 1
    assert all(parent < joint for joint, parent in enumerate(skeleton.parents))
    assert len(set(skeleton.joint_names)) == skeleton.num_joints == len(skeleton.offsets)
    assert [skeleton.mirror[i] for i in skeleton.mirror] == list(range(skeleton.num_joints))
    for parent, children in enumerate(skeleton.children):
        assert all(skeleton.parents[child] == parent for child in children)


def test_rest_pose_is_a_symmetric_t_pose() -> None:
    rest = SMPL22.rest_positions()
    np.testing.assert_allclose(rest[list(SMPL22.mirror)], rest * [-1, 1, 1], atol=1e-12)
    joint = {name: rest[SMPL22.index(name)] for name in SMPL22.joint_names}
    assert joint["left_wrist"][0] > 0.6 and joint["head"][1] > joint["pelvis"][1]
    assert joint["left_foot"][2] > joint["left_ankle"][2]  # it faces +Z
    lengths = [np.linalg.norm(rest[child] - rest[parent]) for parent, child in SMPL22.bones]
    np.testing.assert_allclose(lengths, SMPL22.bone_lengths[1:])
