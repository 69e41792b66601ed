"""What is written can be read by others, and is whole or not there."""

from __future__ import annotations

import errno
import os
from dataclasses import replace
from pathlib import Path

import bvhio
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from motion import SMPL22, Clip, Duet, InputError, formats
from motion.body import load_body, skin
from motion.formats.hand_rig import FINGER_JOINTS
from motion.hands import Grip, angles
from motion.skeleton import SBU15
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


def test_bvh_rest_is_a_t_pose_and_the_clock_is_kept(tmp_path):
    path = formats.write(DUET, tmp_path / "take.bvh")[0]
    container = bvhio.readAsBvh(str(path))
    assert container.FrameCount == 24 and container.FrameTime == pytest.approx(1 / 30, abs=1e-7)
    rest = {joint.Name: np.array(joint.Offset) for joint, _, _ in container.Root.layout()}
    assert rest["left_elbow"][0] > 0.2 and abs(rest["left_elbow"][1]) < 0.05
    assert rest["right_elbow"][0] < -0.2
    assert rest["left_ankle"][1] < -0.35 and rest["spine2"][1] > 0.1


def test_bvh_keeps_given_rotations(tmp_path):
    twisted = ROTATIONS.copy()
    wrist = SMPL22.index("left_wrist")
    twisted[:, wrist] = Rotation.from_euler("x", 40, degrees=True).as_matrix()
    clip = Clip(A, 30, SMPL22, twisted)
    back = formats.read(formats.write(Duet(clip, clip), tmp_path / "x.bvh")[0])
    np.testing.assert_allclose(back.rotations, twisted, atol=1e-4)


def test_bvh_pair_comes_back_as_a_duet(tmp_path):
    back = formats.read_pair(*formats.write(DUET, tmp_path / "x.bvh"))
    np.testing.assert_allclose(back.positions, DUET.positions, atol=1e-4)


def test_glb_plays_the_motion(tmp_path):
    found = Skinned(formats.write(DUET, tmp_path / "x.glb")[0])
    assert len(found.gltf.skins) == 2 and len(found.gltf.animations) == 1
    np.testing.assert_allclose(found.times, np.arange(24) / 30, atol=1e-6)
    for person in (0, 1):
        np.testing.assert_allclose(found.joints(person)[:, :22, :3, 3], DUET.positions[person], atol=1e-4)


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


@pytest.mark.parametrize("size", [1.0, 1.15])
def test_every_limb_of_a_glb_lies_along_its_bone(tmp_path, size):
    duet = Duet.from_positions(DUET.positions * size, fps=30)
    found = Skinned(formats.write(duet, tmp_path / "x.glb")[0])
    limbs = (
        "left_hip",
        "right_hip",
        "left_knee",
        "right_knee",
        "left_elbow",
        "right_elbow",
        "left_shoulder",
        "right_shoulder",
    )
    for person, clip in enumerate(duet.people):
        surface, owner = found.surface(person)
        for name in limbs:
            joint = SMPL22.index(name)
            (end,) = SMPL22.children[joint]
            start, bone = clip.positions[:, joint], clip.positions[:, end] - clip.positions[:, joint]
            own = surface[:, owner == joint] - start[:, None]
            along = np.einsum("tvi,ti->tv", own, bone) / np.sum(bone**2, axis=-1, keepdims=True)
            aside = np.linalg.norm(own - along[..., None] * bone[:, None], axis=-1)
            assert own.shape[1] > 20, name
            assert along.min() > -0.3 and along.max() < 1.3, name
            assert np.abs(along.mean(axis=1) - 0.5).max() < 0.25 and aside.max() < 0.18, name


def test_normals_of_a_glb_are_of_unit_length(tmp_path):
    found = Skinned(formats.write(DUET, tmp_path / "x.glb")[0])
    for mesh in found.gltf.meshes:
        normals = found.array(mesh.primitives[0].attributes.NORMAL)
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-3)


def test_a_glb_shows_the_body_of_the_player(tmp_path):
    found = Skinned(formats.write(DUET, tmp_path / "x.glb")[0])
    for person, (name, clip) in enumerate(zip(DUET.looks, DUET.people, strict=True)):
        np.testing.assert_allclose(found.surface(person)[0], skin(load_body(name), clip), atol=1e-3)


def test_hands_of_a_glb_take_their_shapes(tmp_path):
    grips = (Grip(0, "left", "fist", 6, 20), Grip(1, "right", "point", 0, 24))
    found = Skinned(formats.write(replace(DUET, grips=grips), tmp_path / "x.glb")[0])
    for person, (name, clip) in enumerate(zip(DUET.looks, DUET.people, strict=True)):
        shapes = angles(grips, person, np.arange(24.0), 30)
        surface = skin(load_body(name), clip, shapes)
        np.testing.assert_allclose(found.surface(person)[0], surface, atol=1e-3)
        assert np.abs(surface - skin(load_body(name), clip)).max() > 0.03
    names = [found.gltf.nodes[c.target.node].name for c in found.animation.channels]
    assert "a_left_index1" in names and "a_right_index1" not in names, "still fingers have no key frames"


def test_nothing_but_smpl_is_posed(tmp_path):
    duet = Duet.from_positions(np.zeros((2, 3, 15, 3)), fps=15, skeleton=SBU15)
    for suffix in (".bvh", ".glb"):
        with pytest.raises(InputError, match="retarget"):
            formats.write(duet, tmp_path / f"x{suffix}")
    assert not list(tmp_path.iterdir())


def test_unknown_endings_name_the_known_ones(tmp_path):
    with pytest.raises(InputError, match=r"'.fbx' cannot be written: use .npz, .bvh, .npy, .glb, .usda or .smpl.npz"):
        formats.write(DUET, tmp_path / "x.fbx")
    with pytest.raises(InputError, match=r"'.fbx' cannot be read: use "):
        formats.read(tmp_path / "x.fbx")
    with pytest.raises(InputError, match="without an ending"):
        formats.read(b"123")
    assert formats.can_read(".BVH") and formats.can_write(".npz")
    assert not formats.can_read(".fbx") and not formats.can_write(".fbx")


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


def test_a_folder_in_the_way_is_one_sentence(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="could not be written"):
        formats.write(DUET, tmp_path / "file" / "x.npz")
