"""OpenUSD as text: the joints, and what is around them; OpenUSD itself reads it where ``usd-core`` is installed."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from motion import SMPL22, Clip, Duet, formats
from motion.body import load_body, skin
from motion.formats.usd import usd_bytes
from motion.hands import Grip, angles
from motion.transforms import turn
from tests.motion.bodies import marching

A = marching(24)[0]
B = turn(marching(24, seed=5)[0], np.pi) + np.array([0.3, 0, 1.5])
DUET = Duet(Clip(A, 30), Clip(B.astype(np.float32), 30), ("actor", "reactor"), {"prompt": 'They "wave" \\ 😀\n'})


def samples(text: str, what: str, width: int) -> np.ndarray:
    """(people, frames, joints, width) of an attribute with time samples."""
    found = []
    for block in re.findall(rf"{what}\.timeSamples = {{\n(.*?)}}", text, flags=re.DOTALL):
        rows = [line.split(": ", 1)[1] for line in block.splitlines()]
        found.append([re.findall(r"-?[\d.]+(?:e-?\d+)?", row) for row in rows])
    return np.array(found, dtype=float).reshape(len(found), len(found[0]), -1, width)


def test_rotations_and_places_give_the_joints() -> None:
    text = usd_bytes(DUET).decode()
    turns = samples(text, r"quatf\[\] rotations", 4)
    places = samples(text, r"float3\[\] translations", 3)
    assert turns.shape == (2, 24, 52, 4) and places.shape == (2, 24, 52, 3)
    turns, places = turns[:, :, :22], places[:, :, :22]  # fingers come last
    for clip, quaternions, local in zip(DUET.people, turns, places, strict=True):
        matrices = Rotation.from_quat(quaternions[..., [1, 2, 3, 0]].reshape(-1, 4)).as_matrix()
        world, at = matrices.reshape(24, 22, 3, 3).copy(), local.copy()
        for parent, joint in SMPL22.bones:
            at[:, joint] = at[:, parent] + (world[:, parent] @ local[:, joint, :, None])[..., 0]
            world[:, joint] = world[:, parent] @ world[:, joint]
        np.testing.assert_allclose(at, clip.positions, atol=2e-5)


def test_openusd_reads_the_same_joints_and_bodies(tmp_path: Path) -> None:
    """Runs with ``pip install usd-core``."""
    pytest.importorskip("pxr", reason="usd-core is not installed")
    from pxr import Usd, UsdGeom, UsdShade, UsdSkel, Vt

    grips = (Grip(0, "right", "fist", 5, 20),)
    (path,) = formats.write(replace(DUET, grips=grips), tmp_path / "take.usda")
    stage = Usd.Stage.Open(str(path))
    assert UsdGeom.GetStageUpAxis(stage) == "Y" and UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode(), stage.GetTimeCodesPerSecond()) == (0, 23, 30)
    assert json.loads(stage.GetRootLayer().customLayerData["manifest"]) == DUET.manifest
    cache = UsdSkel.Cache()
    for number, (clip, role, name) in enumerate(zip(DUET.people, DUET.roles, DUET.looks, strict=True)):
        person = f"/duet/{role}/person"
        assert stage.GetPrimAtPath(f"/duet/{role}").GetTypeName() == "Scope"
        assert cache.Populate(UsdSkel.Root(stage.GetPrimAtPath(person)), Usd.PrimDefaultPredicate)
        skeleton = cache.GetSkelQuery(UsdSkel.Skeleton(stage.GetPrimAtPath(f"{person}/{role}")))
        mesh = stage.GetPrimAtPath(f"{person}/{role}_body")
        surfaces = skin(load_body(name), clip.positions, angles(grips, number, np.arange(24.0), 30))
        for frame in (0, 11, 23):
            joints = np.array(skeleton.ComputeJointSkelTransforms(frame))[:22, 3, :3]
            np.testing.assert_allclose(joints, clip.positions[frame], atol=2e-5)
            points = Vt.Vec3fArray(UsdGeom.Mesh(mesh).GetPointsAttr().Get())
            cache.GetSkinningQuery(mesh).ComputeSkinnedPoints(skeleton.ComputeSkinningTransforms(frame), points, frame)
            np.testing.assert_allclose(np.array(points), surfaces[frame], atol=5e-5)
        subsets = UsdShade.MaterialBindingAPI(mesh).GetMaterialBindSubsets()
        assert all(UsdShade.MaterialBindingAPI(each).ComputeBoundMaterial()[0] for each in subsets)
        assert sum(len(each.GetIndicesAttr().Get()) for each in subsets) == len(load_body(name).faces)
