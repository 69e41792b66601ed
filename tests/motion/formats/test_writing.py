"""What is written can be read by others, and is whole or not there."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import bvhio
import numpy as np
import pytest

from motion import SMPL22, Clip, Duet, InputError, formats
from motion.body import load_body, skin
from motion.formats import on_rig
from motion.formats.bvh import read_bvh
from motion.formats.bvh_writer import bvh_on_rig
from motion.formats.skinned import FINGER_JOINTS
from motion.retarget import retarget
from motion.skeleton import SBU15
from motion.transforms import turn
from tests.motion.bodies import marching

from .rigs import RIGS, bvh_text
from .skinned import Skinned

A, ROTATIONS = marching(24)
B = turn(marching(24, seed=5)[0], np.pi) + np.array([0.3, 0, 1.5])
DUET = Duet.from_positions(np.stack([A, B]), fps=30)


def _bvhio_positions(path, frame: int) -> np.ndarray:
    root = bvhio.readAsHierarchy(str(path))
    root.loadPose(frame)
    found = {joint.Name: np.array(joint.PositionWorld) for joint, _, _ in root.layout()}
    return np.array([found[name] for name in SMPL22.joint_names])


@pytest.mark.parametrize("size", [1.0, 1.15])
def test_bvh_pair_gives_the_positions_to_other_readers(tmp_path, size):
    duet = Duet.from_positions(DUET.positions * size, fps=30)
    paths = formats.write(duet, tmp_path / "take.bvh")
    assert [path.name for path in paths] == ["take_a.bvh", "take_b.bvh"]
    for person, path in enumerate(paths):
        for frame in (0, 11, 23):
            np.testing.assert_allclose(_bvhio_positions(path, frame), duet.positions[person, frame], atol=1e-4)


def test_glb_has_a_node_of_their_own_for_each_person(tmp_path):
    duet = Duet(DUET.a, DUET.b, ("actor", "reactor"))
    found = Skinned(formats.write(duet, tmp_path / "x.glb")[0])
    nodes = found.gltf.nodes
    holders = [found.parents[skin.joints[0]] for skin in found.gltf.skins]
    assert [nodes[holder].name for holder in holders] == ["actor", "reactor"]
    assert all(holder not in found.parents for holder in holders)
    names = [nodes[joint].name for joint in found.gltf.skins[1].joints]
    assert names == [f"reactor_{name}" for name in (*SMPL22.joint_names, *FINGER_JOINTS)]
    assert len(found.gltf.meshes) == 2, "one a person and nothing else"
    assert [node.name for node in nodes if node.mesh is not None] == ["actor_body", "reactor_body"]


def test_a_glb_shows_the_body_of_the_player(tmp_path):
    found = Skinned(formats.write(DUET, tmp_path / "x.glb")[0])
    for person, (name, clip) in enumerate(zip(DUET.looks, DUET.people, strict=True)):
        np.testing.assert_allclose(found.surface(person)[0], skin(load_body(name), clip), atol=1e-3)


@pytest.mark.parametrize("suffix", [".npz", ".bvh", ".npy", ".glb"])
@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EACCES])
def test_a_failing_disk_leaves_earlier_files_as_they_were(tmp_path, monkeypatch, suffix, code):
    earlier = {path: path.read_bytes() for path in formats.write(DUET, tmp_path / f"x{suffix}")}
    written = []
    original = Path.write_bytes

    def failing(path, data):
        written.append(path)
        if len(written) == len(earlier):  # the last of the files fails half-way
            original(path, data[: len(data) // 2])
            raise OSError(code, os.strerror(code))
        return original(path, data)

    monkeypatch.setattr(Path, "write_bytes", failing)
    with pytest.raises(InputError, match="disk is full" if code == errno.ENOSPC else "another folder"):
        formats.write(DUET.cut(0, 10), tmp_path / f"x{suffix}")
    assert len(written) == len(earlier)
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == earlier


RIG_A, RIG_ROTATIONS = marching(30)
ROOT = RIG_A[:, 0] + np.array([0.4, 0.0, 0.2])
OTHER = Clip(turn(marching(40, seed=5)[0], 2.0) + np.array([0.5, 0.0, 1.1]), 30)


def _reference(name: str, **options) -> bytes:
    return bvh_text(RIG_ROTATIONS, ROOT, RIGS[name], **options).encode()


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


def test_what_is_no_rig_or_no_body_is_one_sentence(tmp_path):
    with pytest.raises(InputError, match="22 joints"):
        bvh_on_rig(Clip(np.ones((3, 15, 3)), 30, SBU15), _reference("mixamo"))
    with pytest.raises(InputError, match="is not a BVH"):
        bvh_on_rig(OTHER, b"no rig", name="x.bvh")
    path = tmp_path / "rig.bvh"
    path.write_bytes(_reference("mixamo"))
    assert formats.read(on_rig(OTHER, path), name="partner.bvh").num_frames == 40
    with pytest.raises(InputError, match=r"rig of a BVH file, and x\.npz is none"):
        on_rig(OTHER, tmp_path / "x.npz")
