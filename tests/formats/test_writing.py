"""What is written can be read by others, and is whole or not there."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import bvhio
import numpy as np
import pygltflib
import pytest
from scipy.spatial.transform import Rotation

from tests.motion.bodies import marching
from webdemo import formats
from webdemo.motion import SMPL22, Clip, Duet, InputError
from webdemo.motion.skeleton import SBU15
from webdemo.motion.transforms import turn

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
            np.testing.assert_allclose(
                _bvhio_positions(path, frame), duet.positions[person, frame], atol=1e-4
            )


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
    (path,) = formats.write(DUET, tmp_path / "x.glb")
    gltf = pygltflib.GLTF2().load(str(path))
    blob = gltf.binary_blob()

    def array(accessor: int) -> np.ndarray:
        view = gltf.bufferViews[gltf.accessors[accessor].bufferView]
        return np.frombuffer(blob, np.float32, view.byteLength // 4, view.byteOffset)

    assert len(gltf.skins) == 2 and len(gltf.animations) == 1 and len(gltf.meshes) == 2
    animation = gltf.animations[0]
    np.testing.assert_allclose(array(animation.samplers[0].input), np.arange(24) / 30, atol=1e-6)
    for person, skin in enumerate(gltf.skins):
        world = {}
        tracks = {
            (channel.target.node, channel.target.path): array(
                animation.samplers[channel.sampler].output
            ).reshape(24, -1)
            for channel in animation.channels
        }
        parents = {child: node for node in skin.joints for child in gltf.nodes[node].children or []}
        for node in skin.joints:
            move = tracks.get((node, "translation"), np.tile(gltf.nodes[node].translation, (24, 1)))
            turns = np.tile(np.eye(3), (24, 1, 1))
            if (node, "rotation") in tracks:
                turns = Rotation.from_quat(tracks[node, "rotation"]).as_matrix()
            if node in parents:
                carrier, place = world[parents[node]]
                world[node] = (carrier @ turns, place + (carrier @ move[..., None])[..., 0])
            else:
                world[node] = (turns, move)
        positions = np.stack([world[node][1] for node in skin.joints], axis=1)
        np.testing.assert_allclose(positions, DUET.positions[person], atol=1e-4)


def test_nothing_but_smpl_is_posed(tmp_path):
    duet = Duet.from_positions(np.zeros((2, 3, 15, 3)), fps=15, skeleton=SBU15)
    for suffix in (".bvh", ".glb"):
        with pytest.raises(InputError, match="retarget"):
            formats.write(duet, tmp_path / f"x{suffix}")
    assert not list(tmp_path.iterdir())


def test_unknown_endings_name_the_known_ones(tmp_path):
    with pytest.raises(InputError, match=r"'.fbx' cannot be written: use .npz, .bvh, .npy or .glb"):
        formats.write(DUET, tmp_path / "x.fbx")
    with pytest.raises(InputError, match=r"'.fbx' cannot be read: use "):
        formats.read(tmp_path / "x.fbx")
    with pytest.raises(InputError, match="without an ending"):
        formats.read(b"123")
    assert formats.can_read(".BVH") and formats.can_write(".npz")
    assert not formats.can_read(".glb") and not formats.can_write(".fbx")


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
