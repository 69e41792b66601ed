"""The largest files that a visitor may send: refused at once, with little memory beside the file itself."""

from __future__ import annotations

import contextlib
import re
import time
import tracemalloc
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from motion import SMPL22, InputError
from motion.formats.files import MAX_BYTES
from motion.formats.importing import import_motion
from motion.formats.recording import ImportChoices
from motion.rigs import RigMotion
from tests.motion.bodies import marching

from .arrays import npy, npz
from .characters import glb_motion, packed
from .written import c3d_bytes, keypoints, skeleton_text, trc_text, zipped

MEGABYTE = 2**20
FULL = MAX_BYTES - 1000
CHAIN = (
    "HIERARCHY\nROOT hips\n{\nOFFSET 0 0 0\n"
    "CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation\n"
    + "JOINT j%d\n{\nOFFSET 0 10 0\nCHANNELS 3 Zrotation Yrotation Xrotation\n" * 31 % tuple(range(31))
    + "}\n" * 32
)


def moving(frames: int, last: str) -> bytes:
    """A chain of 32 joints whose motion ends in ``last``."""
    head = f"{CHAIN}MOTION\nFrames: {frames}\nFrame Time: 0.00833333\n"
    return (head + ("0 " * 99 + "\n") * (frames - 1) + "0 " * 98 + last).encode()


HOSTILE: dict[str, tuple[Callable[[], bytes], str]] = {
    "lines.txt": (lambda: b"1,0.5" + b"\n" * FULL, "90 are needed"),
    "one-line.txt": (lambda: b"1," * (FULL // 2), "too long"),
    "hours.txt": (lambda: ("0," * 90 + "0\n").encode() * (FULL // 182), "600 s allowed"),
    "joints.skeleton": (lambda: b"17000\n" + b"1\n" * (FULL // 2 - 10), "25 joints"),
    "braces.bvh": (lambda: b"HIERARCHY\n" + b"{" * FULL, "first megabyte"),
    "lines.bvh": (lambda: b"HIERARCHY\n" + b" \t\n" * (FULL // 3), "first megabyte"),
    "frames.bvh": (lambda: moving(2, "0").replace(b"Frames: 2", b"Frames: 1000000000"), "600 s allowed"),
    "late.bvh": (lambda: moving(50_000, "x"), "something is not a number"),
    "parts.npz": (lambda: b"PK\x01\x02" * (FULL // 4), "200 parts"),
    "noise.npz": (lambda: b"\x13\x37" * (FULL // 2), "not a whole .npz"),
    "noise.zip": (lambda: b"\x13\x37" * (FULL // 2), "not a whole .zip"),
    "head.trc": (lambda: b"DataRate\t" * (FULL // 9), "head of five lines"),
    "line.trc": (lambda: trc_text(keypoints()).encode() + b"1\t" * (FULL // 2 - 10_000), "is longer than"),
    "noise.c3d": (lambda: b"\x02\x50" * (FULL // 2), "not possible"),
    "lists.glb": (lambda: packed({"asset": {"version": "2.0"}, "extras": [[]] * 900_000}, b""), "100,000 parts"),
    "lines.trc": (lambda: trc_text(keypoints()).encode() + b"\n" * (FULL - 20_000), "lines: cut it"),
    "sizes.c3d": (lambda: _with_parameters(), "not a whole C3D"),
    "deep.glb": (lambda: _deep(), "more than 500 deep"),
    "manifest.npz": (lambda: _with(manifest=np.array("[" + "[]," * 1_300_000 + "[]]")), "100,000 parts"),
    "text.npz": (lambda: _with(manifest=np.array("a" * 30_000_000)), "too much text"),
    "names.npz": (lambda: _with(joint_names=np.full(10_000_000, "a")), "too much text"),
    "bytes.npz": (lambda: _with(positions=np.zeros((2, 9_000, 200, 3, 3), np.int8)), "that are left"),
    "noise.npy": (lambda: b"\x93NUMPY\x01\x00\xff\xff" + b"(" * FULL, "not a NumPy"),
}


def _with(**arrays: np.ndarray) -> bytes:
    """A .npz of two people, a few kilobytes packed, with further arrays."""
    return npz(**{"positions": np.stack([marching(30)[0]] * 2), "fps": np.array(30.0), **arrays})


def _with_parameters() -> bytes:
    """A .c3d file of 300 parameters of 16 MB each, all of the same bytes, and 5 million small ones."""
    data = c3d_bytes({name: places[:2] for name, places in keypoints().items()})
    large = b"".join(b"\x04\x01%04d\x07\x00\x01\x03\xff\xff\xff" % i for i in range(300))
    return data[: 512 * (data[0] - 1) + 4] + large + b"\x01\x01A\x02\x00" * 5_000_000


def _deep() -> bytes:
    """A .glb file of 200 skeletons below a chain of nodes."""
    nodes = [{"children": [i + 1]} for i in range(4_999)] + [{}]
    skins = [{"joints": [4_999 - i]} for i in range(200)]
    moves = [{"channels": [], "samplers": []}]
    return packed({"asset": {"version": "2.0"}, "nodes": nodes, "skins": skins, "animations": moves}, b"")


@pytest.mark.slow
@pytest.mark.parametrize("name", HOSTILE)
def test_large_wrong_files_are_refused_soon_and_within_twice_the_limit(name: str) -> None:
    make, says = HOSTILE[name]
    data = make()
    began = time.process_time()
    with pytest.raises(InputError, match=says):
        import_motion(data, name=name)
    assert time.process_time() - began < 4.0
    tracemalloc.start()
    try:
        with pytest.raises(InputError, match=says):
            import_motion(data, name=name)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert len(data) + peak < 2 * MAX_BYTES + 8 * MEGABYTE


def _markers(count: int, frames: int) -> bytes:
    """A .trc file of so many markers: a still body, and points beside it."""
    points = {name: places[:1] for name, places in keypoints().items()}
    points |= {f"P{i}": np.ones((1, 3)) for i in range(count - len(points))}
    *head, row, _ = trc_text(points, rate=60).split("\n")
    short = re.sub(r"(\.\d)\d+", r"\1", re.sub(r"\.0+(?=\t|$)", "", row))
    return "\n".join([*head, *([short] * frames)]).encode()


def _recorded(count: int, frames: int) -> bytes:
    """A .c3d file likewise, whose one frame is written again and again."""
    points = {name: places[:2] for name, places in keypoints().items()}
    points |= {f"P{i}": np.ones((2, 3)) for i in range(count - len(points))}
    data = bytearray(c3d_bytes(points))
    row = 16 * count
    start = 512 * (int.from_bytes(data[16:18], "little") - 1)
    data[8:10] = frames.to_bytes(2, "little")
    at = data.find(b"FRAMES")
    assert at > 0
    data[at + 10 : at + 12] = frames.to_bytes(2, "little")
    return bytes(data[:start] + data[start : start + row] * frames)


VALID: dict[str, Callable[[], bytes]] = {
    "full.trc": lambda: _markers(188, 35_400),
    "full.c3d": lambda: _recorded(250, 12_800),
    "full.txt": lambda: b"\n".join([b"1," + b",".join([b"0.4", b"0.5", b"0.6"] * 30)] * 9_000),
    "full.npy": lambda: npy(np.linspace(0, 1, 2 * 36_000 * 22 * 3, dtype=np.float32).reshape(2, -1, 22, 3)),
    "full.npz": lambda: _turned(36_000),
    "full.bvh": lambda: moving(MAX_BYTES // 200, "0"),
    "full.skeleton": lambda: _seen(8_000),
    "full.glb": lambda: _animated(18_000),
    "full.zip": lambda: zipped({f"{i}.npy": npy(np.zeros((18_000, 492), np.float32)) for i in (1, 2)}),
}


def _turned(frames: int) -> bytes:
    """SMPL's parameters as matrices of a byte a number."""
    turns = np.tile(np.eye(3, dtype=np.int8), (frames, 60, 1, 1))
    return npz(poses=turns, trans=np.zeros((frames, 3), np.float32))


def _seen(frames: int) -> bytes:
    """Two people of Kinect's 25 joints in short numbers."""
    return skeleton_text(np.full((2, frames, 25, 3), 0.5)).encode()


def _animated(frames: int) -> bytes:
    """A character that moves for ten minutes."""
    positions, rotations = marching(frames)
    return glb_motion(rotations, positions[:, 0], skinned=False)


@pytest.mark.slow
@pytest.mark.parametrize("name", VALID)
def test_the_largest_valid_file_of_a_reader_takes_five_times_the_limit_at_most(name: str) -> None:
    data = VALID[name]()
    assert len(data) <= MAX_BYTES
    tracemalloc.start()
    try:
        with contextlib.suppress(InputError):  # what is said of its body comes after its numbers
            import_motion(data, name=name, choices=ImportChoices(fps=60.0))
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert len(data) + peak < 5 * MAX_BYTES


def test_many_joints_of_one_part_cost_no_more_than_a_look_at_some_frames() -> None:
    hands = [f"{side}_hand{i}" for side in ("left", "right") for i in range(89)]
    above = [SMPL22.index(name.partition("_")[0] + "_wrist") for name in hands]
    offsets = np.concatenate([SMPL22.offsets, np.zeros((len(hands), 3))])
    rig = RigMotion((*SMPL22.joint_names, *hands), (*SMPL22.parents, *above), offsets, np.empty(0), 60.0)
    rig = replace(rig, positions=np.broadcast_to(rig.rest_positions().astype(np.float32), (33_000, len(offsets), 3)))
    began = time.process_time()
    assert rig.parts.matched == 22
    assert time.process_time() - began < 1.0


def test_more_numbers_than_a_motion_may_have_are_refused_before_they_are_kept() -> None:
    with pytest.raises(InputError, match="196 markers in more than"):
        import_motion(_markers(196, 35_900), name="many.trc")
