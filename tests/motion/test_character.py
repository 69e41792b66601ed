"""Uploaded characters on SMPL22: how they are brought there, and how they then move."""

from __future__ import annotations

import base64
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from motion import SMPL22, Clip, Duet, InputError, character
from motion.body import skin
from motion.character import character_body, packed_body
from motion.formats.glb_reader import Character, read_character
from motion.rigs import RigMotion, pairs_of
from tests.motion.bodies import marching
from tests.motion.formats.characters import THICK, a_pose, glb_character
from tests.motion.formats.rigs import RIGS

REST = SMPL22.rest_positions()
Z_UP = Rotation.from_euler("x", 90, degrees=True).as_matrix()
TURNED = Rotation.from_euler("y", 130, degrees=True).as_matrix()
DUET = Duet(Clip(marching(20)[0], 30), Clip(marching(20, seed=5)[0] + np.float64([0, 0, 1]), 30), ("actor", "reactor"))


def off_bones(vertices: np.ndarray, joints: np.ndarray, bones: np.ndarray) -> np.ndarray:
    """(V,) metres from each vertex to the bone of the joint that moves it, where that and its one child move any."""
    away = np.full(len(vertices), np.nan)
    for joint in range(22):
        children = SMPL22.children[joint]
        its = bones == joint
        if len(children) == 1 and its.any() and children[0] in bones:
            bone = joints[children[0]] - joints[joint]
            along = np.clip((vertices[its] - joints[joint]) @ bone / (bone @ bone), 0, 1)
            away[its] = np.linalg.norm(vertices[its] - joints[joint] - along[:, None] * bone, axis=1)
    return away


@pytest.mark.parametrize("rig", RIGS)
@pytest.mark.parametrize(
    "given",
    [{}, {"unit": 100.0, "turn": Z_UP}, {"places": a_pose(), "turn": TURNED}, {"places": 0.5 * REST}],
    ids=["plain", "centimetres, Z up", "A-pose, long arms, turned", "a child"],
)
def test_every_rig_comes_to_the_same_t_pose(rig: str, given: dict, request: pytest.FixtureRequest) -> None:
    body = character_body(read_character(glb_character(rig, **given), name="x.glb"))
    np.testing.assert_allclose(body.weights.sum(axis=1), 1.0, atol=1e-9)
    surface = skin(body, REST[None].astype(np.float64))[0]
    away = off_bones(surface, REST, body.bones[:, 0])
    assert np.isfinite(away).mean() > 0.5
    thick = 2 * THICK if "a child" in request.node.name else THICK  # of half the height, with boxes as thick
    assert np.nanmax(away) < 1.6 * thick, "boxes lie around SMPL22's bones"


def test_the_surface_moves_with_the_person() -> None:
    body = character_body(read_character(glb_character("unreal", places=a_pose(), turn=TURNED), name="x.glb"))
    positions = DUET.a.positions.astype(np.float64)
    for frame, surface in zip(positions, skin(body, positions), strict=True):
        assert np.nanmax(off_bones(surface, frame, body.bones[:, 0])) < 2.5 * THICK


@pytest.mark.parametrize("unit", [1.0, 100.0])
def test_soles_stand_on_the_floor(unit: float) -> None:
    deep = REST.copy()
    for side in ("left", "right"):  # toe joints in the middle of thick shoes
        deep[SMPL22.index(f"{side}_foot")] += [0.0, 0.03, 0.02]
    body = character_body(read_character(glb_character(places=deep, unit=unit), name="x.glb"))
    lowest = skin(body, DUET.a)[..., 1].min(axis=1)
    assert np.abs(lowest).max() < 0.01, "boxes reach 4 cm below the joints, and stand on the floor"


def test_what_hangs_on_neighbouring_joints_stays_together() -> None:
    found = read_character(glb_character(places=REST * [1.0, 1.1, 0.2]), name="x.glb")
    whole = character_body(found)
    for name in ("Hips", "Spine", "Spine1", "Spine2", "Neck"):
        joint = found.joint_names.index(f"mixamorig:{name}")
        after = replace(found, slots=np.where(found.slots == joint, _child(found, joint), found.slots))
        np.testing.assert_allclose(character_body(after).vertices, whole.vertices, atol=1e-9, err_msg=name)


def _child(found: Character, joint: int) -> int:
    """The next joint of the trunk."""
    return next(
        c
        for c, parent in enumerate(found.parents)
        if parent == joint and "Left" not in found.joint_names[c] and "Right" not in found.joint_names[c]
    )


def test_thighs_meet_the_pelvis_above_the_hips() -> None:
    found = read_character(glb_character(places=REST * [1.5, 1.1, 0.2]), name="x.glb")
    hips, thigh = (found.joint_names.index(f"mixamorig:{name}") for name in ("Hips", "LeftUpLeg"))
    high = found.vertices[:, 1] > found.joints[thigh, 1] + 0.06
    its = high & (found.slots[:, 0] == hips)
    assert its.any()
    after = replace(found, slots=np.where(its[:, None], thigh, found.slots))
    np.testing.assert_allclose(character_body(after).vertices, character_body(found).vertices, atol=1e-9)


@pytest.mark.parametrize(("length", "numbers"), [(1, "3"), (2, "13"), (3, "123"), (5, "11233")])
def test_the_last_joint_of_any_spine_carries_the_shoulders(length: int, numbers: str) -> None:
    ours = [name for name in SMPL22.joint_names if not name.startswith("spine")]
    names = ("pelvis", *(f"back{number}" for number in range(length)), *ours[1:])
    above = {name: SMPL22.joint_names[SMPL22.parents[SMPL22.index(name)]] for name in ours[1:]}
    parents = [-1, *range(length)]
    parents += [length if above[name] == "spine3" else names.index(above[name]) for name in ours[1:]]
    offsets = np.zeros((len(names), 3))
    rig = RigMotion(names, tuple(parents), offsets, offsets[None], None, 30.0)
    found = pairs_of(rig)
    assert [SMPL22.joint_names[found[1 + number]] for number in range(length)] == [f"spine{n}" for n in numbers]
    assert {found[names.index(name)] for name in ours} == {SMPL22.index(name) for name in ours}


def test_joints_that_smpl_lacks_move_with_the_one_above() -> None:
    found = read_character(glb_character("bandai-namco"), name="x.glb")
    body = character_body(found)
    assert set(np.unique(body.bones[:, 0])) <= {SMPL22.index(name) for name in RIGS["bandai-namco"]} | {
        SMPL22.index("spine2")
    }


def test_a_fine_mesh_becomes_coarser(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = character_body(read_character(glb_character(fine=3), name="x.glb"))
    assert len(whole.vertices) <= 22 * 8, "equal vertices become one"
    monkeypatch.setattr(character, "MOST_DRAWN", 60)
    small = character_body(read_character(glb_character(), name="x.glb"))
    assert 20 < len(small.vertices) <= 60 and small.faces.max() < len(small.vertices) and len(small.faces)
    np.testing.assert_allclose(small.weights.sum(axis=1), 1.0, atol=1e-9)


def test_what_is_no_person_is_a_sentence() -> None:
    nodes = [{"name": f"tail_{i}", "children": [i + 1] if i < 21 else []} for i in range(22)]
    found = glb_character(nodes=[*nodes, {"mesh": 0, "skin": 0}])
    with pytest.raises(InputError, match="no joint that looks like"):
        character_body(read_character(found, name="snake.glb"))
    far = read_character(glb_character(), name="x.glb")
    far.vertices[:] += 500.0
    with pytest.raises(InputError, match="far away from its skeleton"):
        character_body(far)


def test_the_player_gets_the_body_as_it_is() -> None:
    body = character_body(read_character(glb_character(), name="x.glb"))
    packed = packed_body(body)
    levels = np.frombuffer(base64.b64decode(packed["vertices"]), "<u2").reshape(-1, 3)
    np.testing.assert_allclose(packed["min"] + levels * np.array(packed["scale"]), body.vertices, atol=1e-4)
    faces = np.frombuffer(base64.b64decode(packed["faces"]), "<u2").reshape(-1, 3)
    np.testing.assert_array_equal(faces, body.faces)
    assert packed["zones"] == ["character"] and len(packed["turns"]) == 22
