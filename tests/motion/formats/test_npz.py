"""NumPy files: ours, AMASS', bare arrays, and hostile ones."""

from __future__ import annotations

import io
import json
import pickle
import zipfile

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from motion import SKELETONS, SMPL22, Clip, Duet, InputError, formats
from motion.formats.bvh import read_bvh
from motion.formats.npz import _SOMA
from motion.formats.smpl import PELVIS
from motion.representation import decode_positions, encode_person
from motion.transforms import turn
from tests.motion.bodies import as_stored, marching
from tests.motion.formats.arrays import npy, npz

from .rigs import RIGS, bvh_text

A, ROTATIONS = marching(20)
B = turn(marching(20, seed=1)[0], np.pi) + np.array([0, 0, 2.0])
DUET = Duet.from_positions(np.stack([A, B]), fps=30, roles=("actor", "reactor"), manifest={"seed": 3, "text": "Gruß"})


def test_npz_keeps_the_contract_and_comes_back(tmp_path):
    (path,) = formats.write(DUET, tmp_path / "x.npz")
    with np.load(path, allow_pickle=False) as stored:
        assert stored["positions"].shape == (2, 20, 22, 3) and stored["positions"].dtype == np.float32
        assert stored["fps"] == 30 and tuple(stored["joint_names"]) == SMPL22.joint_names
        assert tuple(stored["parents"]) == SMPL22.parents and list(stored["roles"]) == ["actor", "reactor"]
        assert json.loads(str(stored["manifest"])) == {"seed": 3, "text": "Gruß"}
    back = formats.read(path)
    assert isinstance(back, Duet) and back.roles == DUET.roles and back.manifest == DUET.manifest
    np.testing.assert_array_equal(back.positions, DUET.positions)


@pytest.mark.parametrize("skeleton", SKELETONS.values(), ids=SKELETONS)
def test_other_skeletons_come_back(skeleton, tmp_path):
    duet = Duet.from_positions(
        np.random.default_rng(0).normal(size=(2, 4, skeleton.num_joints, 3)), fps=15, skeleton=skeleton
    )
    (path,) = formats.write(duet, tmp_path / "x.npz")
    assert as_stored(path).skeleton is skeleton


def test_npy_forms():
    assert isinstance(formats.read(npy(A), name="a.npy"), Clip)
    assert isinstance(formats.read(npy(A[None]), name="a.npy"), Clip)
    duet = formats.read(npy(DUET.positions), name="a.npy", choices=formats.ImportChoices(fps=25))
    assert isinstance(duet, Duet) and duet.fps == 25
    features = np.concatenate([encode_person(person) for person in DUET.positions], axis=-1)
    np.testing.assert_allclose(
        formats.read(npy(features), name="a.npy").positions, decode_positions(features), atol=1e-6
    )
    raw = np.random.default_rng(0).normal(size=(5, 492))
    floor = raw[:, 2:66:3].min()
    np.testing.assert_allclose(formats.read(npy(raw), name="a.npy").positions[:, 0, 1], raw[:, 2] - floor, atol=1e-6)


@pytest.mark.parametrize("joints", _SOMA)
def test_kimodos_joints_are_put_on_smpls(joints):
    positions = np.zeros((20, joints, 3), np.float32)
    positions[:, _SOMA[joints]] = A
    clip = formats.read(npz(posed_joints=positions, fps=np.float64(30)), name="kimodo.npz")
    assert np.linalg.norm(clip.positions - A, axis=-1).mean() < 0.05


def test_positions_with_the_names_and_parents_of_any_rig_are_read():
    (rig,) = read_bvh(bvh_text(ROTATIONS, A[:, 0], RIGS["rokoko"]).encode())
    named = {"joint_names": np.array(rig.joint_names), "parents": np.array(rig.parents)}
    clip = formats.read(npz(positions=rig.positions, fps=np.float64(30), **named), name="x.npz")
    assert np.linalg.norm(clip.positions - A, axis=-1).mean() < 0.05


def test_amass_is_turned_upright_and_put_on_the_floor():
    to_z_up = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    rotations = ROTATIONS.copy()
    rotations[:, 0] = to_z_up @ rotations[:, 0]
    poses = np.zeros((20, 156))
    poses[:, :66] = Rotation.from_matrix(rotations.reshape(-1, 3, 3)).as_rotvec().reshape(20, 66)
    data = npz(poses=poses, trans=A[:, 0] @ to_z_up.T - PELVIS, mocap_framerate=np.array(120.0), betas=np.zeros(16))
    clip = formats.read(data, name="amass.npz")
    assert clip.fps == 120
    np.testing.assert_allclose(clip.positions, A, atol=1e-5)


class _Bomb:
    def __reduce__(self):
        return (pytest.fail, ("unpickled an upload",))


def _zip_bomb() -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive, archive.open("positions.npy", "w") as member:
        header = io.BytesIO()
        np.lib.format.write_array_header_1_0(
            header, {"descr": "<f4", "fortran_order": False, "shape": (2, 10**6, 22, 3)}
        )
        member.write(header.getvalue())
        for _ in range(33):
            member.write(bytes(2**23))
    return buffer.getvalue()


def _with_header(shape: str) -> bytes:
    text = f"{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}".ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode() + bytes(400)


@pytest.mark.parametrize(
    ("data", "name", "message"),
    [
        (b"", "x.npz", "empty"),
        (npz(positions=A)[:-200], "x.npz", "not a whole .npz"),
        (npz(motion=A), "x.npz", "none of 'positions'"),
        (npz(positions=np.full((2, 3, 22, 3), np.nan)), "x.npz", "NaN"),
        (npz(positions=np.full((2, 3, 22, 3), 1e9)), "x.npz", "metres"),
        (npz(positions=np.zeros((9, 5, 22, 3))), "x.npz", "holds 9 people"),
        (npz(positions=np.zeros((5, 7, 3))), "x.npz", "7 joints"),
        (npz(positions=A, fps=np.array(np.nan)), "x.npz", "frame rate"),
        (npz(positions=A, joint_names=np.array(["a"] * 22)), "x.npz", "not known"),
        (npz(positions=DUET.positions, manifest=np.array("{")), "x.npz", "JSON"),
        (npz(positions=np.zeros((20000, 22, 3))), "x.npz", "600 s"),
        (npz(poses=np.zeros((5, 10)), trans=np.zeros((5, 3))), "x.npz", "66 or more"),
        (npz(positions=np.array([_Bomb()], dtype=object)), "x.npz", "Python objects"),
        (_zip_bomb(), "x.npz", "unpack"),
        (npy(np.array([_Bomb()], dtype=object), allow_pickle=True), "x.npy", "Python objects"),
        (pickle.dumps(_Bomb()), "x.npy", "not a NumPy"),
        (_with_header("(2, 1000000000, 22, 3)"), "x.npy", "another size"),
        (npy(A)[:-8], "x.npy", "another size"),
    ],
)
def test_wrong_files_are_refused_in_one_sentence(data, name, message):
    with pytest.raises(InputError, match=message) as error:
        formats.read(data, name=name)
    assert "\n" not in str(error.value) and len(str(error.value)) < 300


def test_mdms_results_are_read_turned_and_never_unpickled():
    clip = formats.read(npy(A.transpose(1, 2, 0)), name="motion.npy")
    np.testing.assert_allclose(clip.positions, A, atol=1e-6)
    results = npy(np.array({"motion": _Bomb()}, dtype=object), allow_pickle=True)
    with pytest.raises(
        InputError, match=r'`numpy\.save\("motion\.npy", results\["motion"\]\[0\]\.transpose\(2, 0, 1\)\)`'
    ):
        formats.read(results, name="results.npy")
