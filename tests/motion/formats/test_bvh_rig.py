"""A partner on the rig of somebody else's file."""

from __future__ import annotations

import numpy as np
import pytest

from motion import SMPL22, Clip, InputError, formats
from motion.formats.bvh import read_bvh
from motion.formats.bvh_rig import bvh_on_rig, write_on_rig
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
@pytest.mark.parametrize(
    "options", [{}, {"z_up": True, "unit": 1.0}, {"positions_everywhere": True, "order": "XYZ"}]
)
def test_a_partner_stands_on_the_rig_where_they_stood(name, options):
    reference = _reference(name, **options)
    made = bvh_on_rig(OTHER, reference, name="rig.bvh")
    assert made.split(b"MOTION")[0] == reference.split(b"MOTION")[0]  # names, bones, rest pose, unit
    rig = read_bvh(made)
    assert rig.num_frames == 40 and rig.fps == 30
    assert rig.metres_per_unit == pytest.approx(read_bvh(reference).metres_per_unit)
    floor = min(0.0, float(OTHER.positions[..., 1].min()))
    found = retarget(rig, plant=False).positions
    limbs = [
        SMPL22.index(f"{s}_{p}")
        for s in ("left", "right")
        for p in ("hip", "knee", "ankle", "elbow", "wrist")
    ]
    away = np.linalg.norm(found[:, limbs] - (OTHER.positions[:, limbs] - np.array([0, floor, 0])), axis=-1)
    assert away.mean() < 0.03 and away.max() < 0.09


def test_what_is_no_rig_or_no_body_is_one_sentence(tmp_path):
    with pytest.raises(InputError, match="22 joints"):
        bvh_on_rig(Clip(np.ones((3, 15, 3)), 30, SBU15), _reference("mixamo"))
    with pytest.raises(InputError, match="is not a BVH"):
        bvh_on_rig(OTHER, b"no rig", name="x.bvh")
    path = tmp_path / "rig.bvh"
    path.write_bytes(_reference("mixamo"))
    (made,) = write_on_rig(OTHER, path, tmp_path / "partner.bvh")
    assert formats.read(made).num_frames == 40
