"""A partner and both people on the skeleton of an uploaded glTF character."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from motion import SMPL22, Clip, Duet, InputError
from motion.formats.glb_motion import read_glb_people
from motion.formats.glb_rig import glb_on_rig, glb_wearing
from motion.skeleton import SBU15
from motion.transforms import turn
from tests.motion.bodies import marching

from .characters import a_pose, glb_character, glb_motion, unpacked
from .rigs import RIGS
from .skinned import Skinned

POSITIONS, ROTATIONS = marching(30)
OTHER = Clip(turn(marching(40, seed=3)[0], 2.0) + np.float64([0.3, 0.0, 1.0]), 30)
DUET = Duet(
    Clip(POSITIONS, 30), Clip(OTHER.positions[:30] + np.float32([0, 0, 3]), 30), ("actor", "reactor"), {"model": "x"}
)
Z_UP = Rotation.from_euler("x", 90, degrees=True).as_matrix()
AXES = Rotation.random(22, random_state=0).as_matrix()
LIMBS = ("elbow", "wrist", "knee", "ankle")


def angles(found: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """(…) degrees between the limbs' bones of two people (T, 22, 3)."""
    away = []
    for side in ("left", "right"):
        for part in LIMBS:
            joint = SMPL22.index(f"{side}_{part}")
            one, other = (p[:, joint] - p[:, SMPL22.parents[joint]] for p in (found, wanted))
            cosine = (one * other).sum(-1) / np.linalg.norm(one, axis=-1) / np.linalg.norm(other, axis=-1)
            away.append(np.degrees(np.arccos(np.clip(cosine, -1, 1))))
    return np.array(away)


def in_our_order(data: bytes, rig: str, person: int = 0) -> np.ndarray:
    """(T, 22, 3) joints of a person in the file as they are."""
    found = read_glb_people(data, name="made.glb")[person]
    ours = [
        next(i for i, n in enumerate(found.joint_names) if RIGS[rig][name].endswith(n)) for name in SMPL22.joint_names
    ]
    return found.positions[:, ours]


@pytest.mark.parametrize("rig", ["mixamo", "unreal", "xsens"])
@pytest.mark.parametrize("given", [{}, {"unit": 100.0, "turn": Z_UP}], ids=["plain", "turned and in centimetres"])
def test_a_partner_stands_in_the_file_s_world_on_its_skeleton(rig: str, given: dict[str, Any]) -> None:
    reference = glb_motion(ROTATIONS, POSITIONS[:, 0], rig, **given)
    made = glb_on_rig(OTHER, reference, name="rig.glb")
    document, blob = unpacked(made)
    before, its = unpacked(reference)
    assert document["nodes"] == before["nodes"] and document["skins"] == before["skins"], (
        "nothing but the motion is new"
    )
    assert document["meshes"] == before["meshes"] and blob.startswith(its)
    assert len(document["animations"]) == 1
    joints = in_our_order(made, rig)
    assert joints.shape == (40, 22, 3)
    assert angles(joints, OTHER.positions).max() < 0.1, "limbs point where the partner's do"
    assert np.linalg.norm(joints - OTHER.positions, axis=-1).max() < 0.03


def test_both_stand_on_the_character_each_under_a_node_of_their_own(tmp_path: Path) -> None:
    reference = glb_character("unreal", places=a_pose())
    (tmp_path / "x.glb").write_bytes(glb_wearing(DUET, reference, name="robot.glb"))
    found = Skinned(tmp_path / "x.glb")
    nodes = found.gltf.nodes
    top = [nodes[number].name for number in found.gltf.scenes[0].nodes]
    assert [name for name in top if name] == ["actor", "reactor"]
    for person, skin in enumerate(found.gltf.skins):
        names = {nodes[joint].name for joint in skin.joints}
        assert names == set(RIGS["unreal"].values())
        meshes = [node for node in nodes if node.skin == person]
        assert len(meshes) == 1 and meshes[0].mesh == 0, "the mesh is there once, and shown twice"
    assert found.gltf.asset.extras["manifest"] == {"model": "x"}
    for person, clip in enumerate(DUET.people):
        joints = in_our_order((tmp_path / "x.glb").read_bytes(), "unreal", person)
        assert angles(joints, clip.positions).max() < 0.1


def test_hands_that_touch_meet_on_longer_arms() -> None:
    standing = SMPL22.rest_positions() + np.array([0.0, 0.9562, 0.0])
    wrist, elbow, shoulder = (SMPL22.index(f"right_{part}") for part in ("wrist", "elbow", "shoulder"))
    person = np.repeat(standing[None], 30, axis=0)
    upper, lower = (SMPL22.bone_lengths[joint] for joint in (elbow, wrist))
    ahead = np.array([0.3, 0.0, 0.954])  # towards the other's hand
    person[:, elbow] = person[:, shoulder] + upper * ahead
    person[:, wrist] = person[:, elbow] + lower * ahead
    gap = person[0, wrist, 2] * 2 + 0.08
    duet = Duet(Clip(person, 30), Clip(turn(person, np.pi) + np.array([0.0, 0.0, gap]), 30))
    apart = np.linalg.norm(duet.a.positions[0, wrist] - duet.b.positions[0, wrist])
    data = glb_wearing(duet, glb_character("unreal", places=a_pose()), name="x.glb")
    hands = [in_our_order(data, "unreal", person)[:, wrist] for person in range(2)]
    np.testing.assert_allclose(np.linalg.norm(hands[0] - hands[1], axis=-1), apart, atol=0.01)


def test_what_is_wrong_is_one_sentence() -> None:
    with pytest.raises(InputError, match="22 joints"):
        glb_on_rig(Clip(np.ones((3, 15, 3)), 30, SBU15), glb_motion(ROTATIONS, POSITIONS[:, 0]))
    with pytest.raises(InputError, match="has no animation"):
        glb_on_rig(OTHER, glb_character(), name="x.glb")
    with pytest.raises(InputError, match="holds 2 people"):
        glb_on_rig(OTHER, glb_motion(ROTATIONS, POSITIONS[:, 0], people=2), name="x.glb")
    with pytest.raises(InputError, match="holds 2 people: export one alone"):
        glb_wearing(DUET, glb_motion(ROTATIONS, POSITIONS[:, 0], people=2), name="x.glb")
    with pytest.raises(InputError, match="no joint that looks like"):
        nodes = [{"name": "rope", "children": [i + 1] if i < 21 else []} for i in range(22)]
        glb_wearing(DUET, glb_character(nodes=[*nodes, {"mesh": 0, "skin": 0}]), name="x.glb")
