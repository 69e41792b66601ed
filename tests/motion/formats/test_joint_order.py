"""The joint order of arrays without names."""

import numpy as np
import pytest

from motion.formats.importing import import_motion
from motion.formats.joint_order import likely_skeleton, skeletons_of
from motion.layouts import LAYOUTS
from motion.skeleton import K3HI15, SBU15, SKELETONS, SMPL22, Skeleton
from motion.transforms import heading_matrix
from tests.motion.bodies import marching
from tests.motion.formats.arrays import npy


def moving(skeleton: Skeleton, scale: float = 1.0) -> np.ndarray:
    """(40, J, 3) a body with bones of constant length that turn, its sides alike."""
    rng = np.random.default_rng(0)
    lengths = {name.replace("right_", "left_"): rng.uniform(0.1, 0.5) for name in skeleton.joint_names}
    positions = np.zeros((40, skeleton.num_joints, 3))
    for parent, child in skeleton.bones:
        way = rng.normal(size=3) + 0.2 * rng.normal(size=(40, 3)).cumsum(0)
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        name = skeleton.joint_names[child].replace("right_", "left_")
        positions[:, child] = positions[:, parent] + lengths[name] * way
    return scale * positions


def test_the_number_of_joints_decides_where_it_can() -> None:
    assert likely_skeleton(np.zeros((4, 22, 3)))[0] is SMPL22
    assert likely_skeleton(np.zeros((4, 21, 3)))[0] is None and likely_skeleton(np.zeros(3))[0] is None
    assert set(skeletons_of(15)) == {SBU15, K3HI15}


@pytest.mark.parametrize("skeleton", [SBU15, K3HI15], ids=lambda s: s.name)
@pytest.mark.parametrize("scale", [1.0, 1000.0])
def test_bones_that_keep_their_length_decide_between_two_orders(skeleton: Skeleton, scale: float) -> None:
    assert likely_skeleton(moving(skeleton, scale))[0] is skeleton
    assert likely_skeleton(np.stack([moving(skeleton, scale)] * 2))[0] is skeleton


@pytest.mark.parametrize("name", ["cmu17", "h36m17", "coco17"])
@pytest.mark.parametrize("turn", [0.0, 1.0, 3.0])
def test_seventeen_joints_are_of_the_order_in_which_they_are_a_body(name: str, turn: float) -> None:
    body = marching(30)[0] @ heading_matrix(turn).T
    positions = np.stack(
        [body[:, ours if ours >= 0 else SMPL22.index("head")] for ours in LAYOUTS[name].joints], axis=1
    )
    assert likely_skeleton(positions) == (SKELETONS[name], None)


def test_an_order_that_stays_unsure_is_asked() -> None:
    assert likely_skeleton(np.zeros((3, 17, 3)))[1] is not None
    found = import_motion(npy(np.zeros((3, 17, 3))), name="a.npy")
    assert found.asks and any("Choose the order" in note for note in found.notes)
