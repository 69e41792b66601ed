"""Bodies bound to SMPL22: they stand where the joints stand, whatever the pose."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from motion.body import bone_rotations, load_body, skin
from motion.hands import SHAPES
from motion.kinematics import forward_kinematics
from motion.looks import LOOKS, size_of
from motion.skeleton import SMPL22

J = {name: index for index, name in enumerate(SMPL22.joint_names)}
EXAMPLES = Path(__file__).resolve().parents[2] / "static" / "examples"


def t_pose() -> np.ndarray:
    rest = SMPL22.rest_positions()
    return (rest - [0, rest[J["left_foot"], 1], 0])[None]


def recorded() -> np.ndarray:
    with np.load(EXAMPLES / "shake-hands.npz") as stored:
        return np.concatenate(list(stored["positions"]))[::15]


@pytest.mark.parametrize("name", LOOKS)
def test_limbs_lie_along_their_bones(name):
    """Vertices that one limb moves alone lie within a forearm's, a shin's thickness of its bone."""
    body, positions = load_body(name), size_of(name) * recorded()
    surface = skin(body, positions)
    for child in ("left_wrist", "right_wrist", "left_ankle", "right_ankle"):
        joint = SMPL22.parents[J[child]]
        own = np.nonzero((body.bones[:, 0] == joint) & (body.weights[:, 0] > 0.95))[0]
        assert len(own) > 20
        start, end = positions[:, None, joint], positions[:, None, J[child]]
        along = end - start
        share = np.clip(np.sum((surface[:, own] - start) * along, -1) / np.sum(along**2, -1), 0, 1)
        away = np.linalg.norm(surface[:, own] - start - share[..., None] * along, axis=-1)
        assert away.max() < 0.11


def test_a_bent_elbow_turns_the_palm_to_the_other_hand():
    """Forearms held forward from hanging arms, as to shake hands: palms look inwards, thumbs lie on top."""
    rotations = np.tile(np.eye(3), (1, 22, 1, 1))
    for side, sign in (("left", -1), ("right", 1)):
        rotations[0, J[f"{side}_shoulder"]] = Rotation.from_euler("z", sign * 85, degrees=True).as_matrix()
        rotations[0, J[f"{side}_elbow"]] = Rotation.from_euler("y", sign * 80, degrees=True).as_matrix()
    positions = forward_kinematics(rotations, np.array([[0.0, 0.95, 0.0]]))
    turned = bone_rotations(positions)[0]
    for side, inwards in (("left", -1), ("right", 1)):
        palm = turned[J[f"{side}_wrist"]] @ [0, -1, 0]  # in the T-pose palms look down
        assert palm[0] * inwards > 0.95


def put_on_the_floor(height: float) -> np.ndarray:
    """(2, 22, 3) somebody on both hands, which are straight under the shoulders; and the same a metre higher."""
    pose = t_pose()[0]
    for side in ("left", "right"):
        shoulder, elbow, wrist = (J[f"{side}_{name}"] for name in ("shoulder", "elbow", "wrist"))
        for joint, parent in ((elbow, shoulder), (wrist, elbow)):
            pose[joint] = pose[parent] - [0.0, SMPL22.bone_lengths[joint], 0.0]
    pose[:, 1] += height - pose[J["left_wrist"], 1]
    return np.stack([pose, pose + np.array([0.0, 1.0, 0.0])])


def test_a_hand_that_is_put_on_the_floor_lies_flat_and_one_in_the_air_goes_on_with_its_forearm():
    poses = put_on_the_floor(0.055)
    world = bone_rotations(poses)
    for side in ("left", "right"):
        palm = -world[:, J[f"{side}_wrist"], :, 1]
        assert palm[0, 1] < -0.99, "the palm is down"
        assert world[1, J[f"{side}_wrist"]] == pytest.approx(world[1, J[f"{side}_elbow"]])
    body = load_body("man")
    hands = np.isin(
        body.bones[np.arange(len(body.bones)), body.weights.argmax(axis=1)], [J["left_wrist"], J["right_wrist"]]
    )
    flat = np.broadcast_to(SHAPES["flat"], (2, 2, 20))
    lowest = skin(body, poses, flat)[:, hands, 1].min(axis=1)
    assert lowest[0] > -0.03, "no fingers in the floor"
    assert lowest[1] < 1.0 - 0.08, "they hang down in the air"
