"""Uploaded characters on SMPL22: how they are brought there, and how they then move."""

from __future__ import annotations

import base64

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from motion import SMPL22, Clip, Duet, InputError, character
from motion.body import skin
from motion.character import character_body, packed_body
from motion.formats.glb_reader import read_character
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
