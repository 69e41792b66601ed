"""Characters in glTF binary: what is read of them, and what an enemy may send."""

from __future__ import annotations

import json
import struct
import time
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion import InputError
from motion.character import character_body
from motion.formats.glb_reader import read_character

from .characters import glb_character
from .test_fuzz import EDITS, PATIENT, SECONDS

VALID = glb_character()
LENGTH = struct.unpack_from("<I", VALID, 12)[0]
GLTF = json.loads(VALID[20 : 20 + LENGTH])


def test_a_character_is_its_joints_its_surface_and_its_weights() -> None:
    found = read_character(VALID, name="box.glb")
    assert found.joint_names[0] == "mixamorig:Hips" and found.parents[0] == -1
    assert all(parent < joint for joint, parent in enumerate(found.parents))
    assert found.vertices.shape == (22 * 8, 3) and found.faces.shape == (22 * 12, 3)
    np.testing.assert_allclose(found.weights.sum(axis=1), 1.0)
    hand = found.joint_names.index("mixamorig:LeftHand")
    its = found.vertices[found.slots[:, 0] == hand]
    assert np.linalg.norm(its - found.joints[hand], axis=1).max() < 0.2, "vertices are near the joint that moves them"


def _changed(kind: str, number: int, **fields: Any) -> dict[str, Any]:
    return {kind: [each | fields if i == number else each for i, each in enumerate(GLTF[kind])]}


WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "a view outside": (_changed("bufferViews", 0, byteOffset=2**30), "outside of the file"),
    "too many vertices": (_changed("accessors", 0, count=10**9), "300,000 are the limit"),
    "a stride of none": (_changed("bufferViews", 0, byteStride=3), "outside of the file"),
    "another file": ({"buffers": [{"byteLength": 4, "uri": "file:///etc/passwd"}]}, "in other files"),
    "compression": ({"extensionsRequired": ["KHR_draco_mesh_compression"]}, "KHR_draco"),
    "a circle": (_changed("nodes", 21, children=[0]), "circle|two parents"),
    "a node that is not there": (_changed("nodes", 0, children=[999]), "is not there"),
    "no skin": (_changed("nodes", 22, skin=None), "bound to a skeleton"),
    "no bind pose": ({"skins": [{"joints": list(range(22))}]}, "no bind pose"),
    "fewer joints than weights say": ({"skins": [{"joints": [0], "inverseBindMatrices": 4}]}, "not there"),
    "wrong kinds": ({"meshes": [7]}, "is damaged"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_is_one_sentence(name: str) -> None:
    changes, says = WRONG[name]
    with pytest.raises(InputError, match=says) as error:
        read_character(glb_character(**changes), name="box.glb")
    assert "\n" not in str(error.value) and str(error.value).startswith("box.glb")


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"nothing at all, really", "no glTF binary"),
        (VALID[:-3000], "cut off"),
        (VALID[:4] + b"\1\0\0\0" + VALID[8:], "version 1"),
    ],
)
def test_other_files_are_one_sentence(data: bytes, says: str) -> None:
    with pytest.raises(InputError, match=says):
        read_character(data, name="box.glb")


@pytest.mark.parametrize("rig", ["mixamo", "unreal"])
def test_damaged_characters_are_read_or_a_sentence(rig: str) -> None:
    whole = glb_character(rig)
    length = struct.unpack_from("<I", whole, 12)[0]

    @PATIENT
    @given(EDITS, st.booleans())
    def read(edits: list[tuple[str, int, int, bytes]], in_description: bool) -> None:
        raw = bytearray(whole)
        for kind, place, size, piece in edits:
            at = 20 + place % length if in_description else place % (len(raw) + 1)
            if kind == "cut":
                del raw[at : at + size]
            elif kind == "flip" and at < len(raw):
                raw[at] ^= size % 255 + 1
            elif kind == "put":
                raw[at : at + len(piece)] = piece
            else:
                raw[at:at] = raw[at : at + size]
        began = time.process_time()
        try:
            body = character_body(read_character(bytes(raw), name="box.glb"))
            assert np.isfinite(body.vertices).all()
        except InputError as error:
            assert str(error) and "\n" not in str(error) and len(str(error)) < 400
        assert time.process_time() - began < SECONDS

    read()
