"""What is written can be read by others, and is whole or not there."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import bvhio
import numpy as np
import pytest

from motion import SMPL22, Duet, InputError, formats
from motion.body import load_body, skin
from motion.formats.skinned import FINGER_JOINTS
from motion.transforms import turn
from tests.motion.bodies import marching

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
        np.testing.assert_allclose(found.surface(person)[0], skin(load_body(name), clip.positions), atol=1e-3)


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
