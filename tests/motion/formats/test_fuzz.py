"""Every reader against noise and damaged files: a motion or one sentence, soon, whatever comes."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from motion import Clip, InputError
from motion.formats import FORMATS
from motion.formats.importing import import_motion
from motion.formats.npz import arrays_of
from motion.formats.recording import AXES, ORDERS, ImportChoices
from motion.things import Thing, shape
from tests.motion.bodies import marching
from tests.motion.formats.arrays import npy, npz

from .characters import glb_motion, glb_takes
from .rigs import RIGS, bvh_text
from .written import c3d_bytes, interhuman, interx, keypoints, sbu_text, skeleton_text, trc_text, zipped

SECONDS = 2.0
"""The most that a file of these sizes may keep the processor."""
BODIES = np.random.default_rng(0).normal(size=(2, 4, 25, 3)).round(3)
POSITIONS, ROTATIONS = marching(6)
SKELETONS_15 = POSITIONS[:, [15, 12, 6, 16, 18, 20, 17, 19, 21, 1, 4, 7, 2, 5, 8]]


CUP = Thing.at_rest("cup", shape("cup"), np.zeros(3), 0.0, len(POSITIONS))
BVH = bvh_text(ROTATIONS, POSITIONS[:, 0], RIGS["mixamo"], unit=100)
VALID = {
    "ours.npz": npz(positions=np.stack([POSITIONS, POSITIONS + 1]), fps=np.float64(30)),
    "things.npz": npz(positions=np.stack([POSITIONS, POSITIONS + 1]), fps=np.float64(30), **arrays_of([CUP])),
    "crowd.npz": npz(positions=np.stack([POSITIONS, POSITIONS + 1, POSITIONS - 1])),
    "amass.npz": npz(
        poses=np.zeros((40, 156)), trans=np.zeros((40, 3)), mocap_framerate=np.float64(120), gender=np.array("x")
    ),
    "P1.npz": npz(**interx(POSITIONS)),
    "interhuman.npy": npy(interhuman(POSITIONS)),
    "two.zip": zipped({"P1.npz": npz(**interx(POSITIONS)), "P2.npz": npz(**interx(POSITIONS + 1))}),
    "key-points.trc": trc_text(keypoints()).encode(),
    "markers.c3d": c3d_bytes(keypoints()),
    "walk.glb": glb_motion(ROTATIONS, POSITIONS[:, 0], unit=100.0),
    "bones.glb": glb_motion(ROTATIONS, POSITIONS[:, 0], skinned=False, way="CUBICSPLINE"),
    "takes.glb": glb_takes(
        ROTATIONS, POSITIONS[:, 0], ["idle", "\u202ewalk\n\ud800", "x" * 5000, None, ["2"], "3"], skinned=False
    ),
    "22.npy": npy(POSITIONS.astype(np.float32)),
    "15.npy": npy(SKELETONS_15),
    "17.npy": npy(POSITIONS[:, [0, 2, 5, 8, 1, 4, 7, 3, 9, 12, 15, 16, 18, 20, 17, 19, 21]]),
    "humanml3d.npy": npy(np.random.default_rng(2).normal(scale=0.2, size=(6, 263))),
    "wild.npz": npz(global_orient=np.zeros((9, 1, 3)), body_pose=np.zeros((9, 23, 3)), transl=np.zeros((9, 3))),
    "kimodo.npz": npz(posed_joints=np.random.default_rng(3).normal(size=(6, 77, 3))),
    "commas.trc": trc_text(keypoints()).replace("\t", ",").encode(),
    "bones.vrma": glb_motion(ROTATIONS, POSITIONS[:, 0], skinned=False),
    "take.bvh": BVH.encode(),
    "take-latin.bvh": BVH.replace("mixamorig:Head", "Kopf_é").encode("latin-1"),
    "S001.skeleton": skeleton_text(BODIES).encode(),
    "skeleton_pos.txt": sbu_text(np.random.default_rng(1).random((5, 90))).encode(),
}
PIECES = [
    *(b"{", b"}", b"nan ", b"inf", b"1e999 ", b"-", b",", b"\0", b"\xff\xfe", b"999999999", b"\n", b"\r", b"   "),
    *(b"ROOT x\n{\n", b"JOINT x\n", b"End Site", b"CHANNELS 6 ", b"MOTION\n", b"Frames: 1000000000\n"),
    *(b"PK\x05\x06", b"PK\x01\x02", b"\x93NUMPY", "é\u2028".encode(), b"(9999999, 22, 3)", b"4294967295", b"-1, "),
    *(b"1e30", b"[]", b'"node": 0, ', b'"LINEAR"', b"null", b'"count": 99999999, '),
]
HEADS = (b"", b"HIERARCHY\nROOT a\n{\n", b"\x93NUMPY\x01\0", b"PK\x03\x04", b"3\n2\n", b"1,0.5,", b"\xff\xfe")
HEADS += (b"glTF\2\0\0\0",)
EDITS = st.lists(
    st.tuples(
        st.sampled_from(["cut", "flip", "put", "repeat"]),
        st.integers(0, 10**6),
        st.integers(1, 3000),
        st.one_of(st.sampled_from(PIECES), st.binary(max_size=8)),
    ),
    min_size=1,
    max_size=4,
)
CHOICES = st.builds(
    ImportChoices,
    up=st.sampled_from([None, *AXES]),
    fps=st.sampled_from([None, 1.0, 30.0, 1000.0]),
    order=st.sampled_from([None, *ORDERS]),
    animation=st.sampled_from([None, 1, 2, 6, 7, 10**12, "3", "IDLE", "x" * 5000, "\u202ewalk\n\ud800", "٣", "²"]),
)
PATIENT = settings(
    max_examples=80, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large]
)


@pytest.fixture(autouse=True, scope="module")
def loaded() -> None:
    """Libraries that a first file loads are not counted to it."""
    for name in ("key-points.trc", "take.bvh"):
        assert import_motion(VALID[name], name=name).motion


def check(data: bytes, name: str, choices: ImportChoices | None = None) -> bool:
    """Whether it was read; fails where it takes long or anything but an InputError of one line is raised."""
    began = time.thread_time()  # of this thread alone, whatever else the process and the machine do
    try:
        found = import_motion(data, name=name, choices=choices)
        if found.people[0].num_frames < 30:
            assert np.isfinite(found.motion.positions).all()
        note = found.animations.note if found.animations else ""
        assert (note + found.describe()).isprintable() and len(note) < 600
    except InputError as error:
        message = str(error)
        assert message and "\n" not in message and len(message) < 400
        return False
    finally:
        assert time.thread_time() - began < SECONDS
    assert all(isinstance(person, Clip) and np.isfinite(person.positions).all() for person in found.people)
    return True


@pytest.mark.parametrize("name", VALID)
def test_what_is_damaged_below_is_read_when_whole(name: str) -> None:
    assert check(VALID[name], name)


@pytest.mark.parametrize("suffix", [suffix for suffix, known in FORMATS.items() if known.reader])
def test_noise_is_a_sentence(suffix: str) -> None:
    @PATIENT
    @given(st.sampled_from(HEADS), st.binary(max_size=400))
    def read(head: bytes, tail: bytes) -> None:
        check(head + tail, f"noise{suffix}")

    read()


@pytest.mark.parametrize("name", VALID)
def test_damaged_files_are_read_or_a_sentence(name: str) -> None:
    @PATIENT
    @given(EDITS, CHOICES)
    def read(edits: list[tuple[str, int, int, bytes]], choices: ImportChoices) -> None:
        raw = bytearray(VALID[name])
        for kind, place, length, piece in edits:
            at = place % (len(raw) + 1)
            if kind == "cut":
                del raw[at : at + length]
            elif kind == "flip" and at < len(raw):
                raw[at] ^= length % 255 + 1
            elif kind == "put":
                raw[at:at] = piece
            else:
                raw[at:at] = raw[at : at + length]
        choices = choices if name == "takes.glb" else replace(choices, animation=None)
        check(bytes(raw), name, choices)

    read()
