"""A partner on the rig of somebody else's file."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from motion import SMPL22, Clip, InputError, formats
from motion.formats.bvh import read_bvh
from motion.formats.bvh_rig import bvh_on_rig
from motion.formats.on_rig import on_rig
from motion.retarget import retarget
from motion.skeleton import SBU15
from motion.transforms import turn
from tests.motion.bodies import marching

from .rigs import RIGS, bvh_text

A, ROTATIONS = marching(30)
ROOT = A[:, 0] + np.array([0.4, 0.0, 0.2])
OTHER = Clip(turn(marching(40, seed=5)[0], 2.0) + np.array([0.5, 0.0, 1.1]), 30)


def _reference(name: str, **options) -> bytes:
    return bvh_text(ROTATIONS, ROOT, RIGS[name], **options).encode()


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("options", [{}, {"z_up": True, "unit": 1.0}, {"positions_everywhere": True, "order": "XYZ"}])
def test_a_partner_stands_on_the_rig_where_they_stood(name, options):
    reference = _reference(name, **options)
    made = bvh_on_rig(OTHER, reference, name="rig.bvh")
    assert made.split(b"MOTION")[0] == reference.split(b"MOTION")[0]  # names, bones, rest pose, unit
    rig = read_bvh(made)
    assert rig.num_frames == 40 and rig.fps == 30
    assert rig.metres_per_unit == pytest.approx(read_bvh(reference).metres_per_unit)
    floor = min(0.0, float(OTHER.positions[..., 1].min()))
    found = retarget(rig, plant=False).positions
    limbs = [SMPL22.index(f"{s}_{p}") for s in ("left", "right") for p in ("hip", "knee", "ankle", "elbow", "wrist")]
    away = np.linalg.norm(found[:, limbs] - (OTHER.positions[:, limbs] - np.array([0, floor, 0])), axis=-1)
    assert away.mean() < 0.03 and away.max() < 0.09


@pytest.mark.parametrize("name", RIGS)
def test_neck_and_head_keep_their_posture_on_the_rig(name):
    nods = _nodding(OTHER)
    assert np.ptp(_apart(nods.positions, OTHER.positions, "neck", "head")) > 20.0
    found = retarget(read_bvh(bvh_on_rig(nods, _reference(name), name="rig.bvh")), plant=False).positions
    for first, second in (("spine3", "neck"), ("neck", "head"), ("pelvis", "neck")):
        assert _apart(found, nods.positions, first, second).max() < 5.0, (first, second)


def _nodding(clip):
    """The clip with a head that sinks by 25 degrees to the front and to the side, and comes up again."""
    positions = clip.positions.astype(np.float64)
    bone = positions[:, SMPL22.index("head")] - positions[:, SMPL22.index("neck")]
    angle = np.radians(25.0) * np.sin(np.linspace(0.0, np.pi, len(bone)))[:, None]
    across = positions[:, SMPL22.index("left_hip")] - positions[:, SMPL22.index("right_hip")]
    axis = across / np.linalg.norm(across, axis=-1, keepdims=True) + [0.0, 0.0, 0.5]
    turned = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis, axis=-1, keepdims=True)).apply(bone)
    positions[:, SMPL22.index("head")] += turned - bone
    return Clip(positions, clip.fps)


def _apart(found, wanted, first, second):
    """(T,) degrees between the directions from one joint to another."""
    ends = [p[:, SMPL22.index(second)] - p[:, SMPL22.index(first)] for p in (found, wanted)]
    a, b = (end / np.linalg.norm(end, axis=-1, keepdims=True) for end in ends)
    return np.degrees(np.arccos(np.clip(np.sum(a * b, axis=-1), -1.0, 1.0)))


def test_what_is_no_rig_or_no_body_is_one_sentence(tmp_path):
    with pytest.raises(InputError, match="22 joints"):
        bvh_on_rig(Clip(np.ones((3, 15, 3)), 30, SBU15), _reference("mixamo"))
    with pytest.raises(InputError, match="is not a BVH"):
        bvh_on_rig(OTHER, b"no rig", name="x.bvh")
    path = tmp_path / "rig.bvh"
    path.write_bytes(_reference("mixamo"))
    assert formats.read(on_rig(OTHER, path), name="partner.bvh").num_frames == 40
    with pytest.raises(InputError, match=r"rig of a BVH or \.glb file, and x\.npz is none"):
        on_rig(OTHER, tmp_path / "x.npz")
