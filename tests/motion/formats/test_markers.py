"""Marker files, .trc and .c3d: the joints of bodies out of named points."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from motion import SMPL22, Clip, InputError, formats
from motion.formats.markers import people_of
from motion.skeleton import POINTS17
from tests.motion.bodies import as_stored, marching

from .written import JOINT, c3d_bytes, keypoints, trc_text

POSITIONS, _ = marching(24)


def error_of(found: Clip) -> float:
    """The largest distance in metres from the body that the markers were put on, at the joints that they show."""
    names = [name for name in POINTS17.joint_names if name not in ("pelvis",)]
    theirs = [POINTS17.index(name) for name in names]
    ours = [SMPL22.index(name) for name in names]
    return float(np.linalg.norm(found.positions[:, theirs] - POSITIONS[:, ours], axis=-1).max())


@pytest.mark.parametrize("separator", ["\t", ","])
@pytest.mark.parametrize(("unit", "scale"), [("m", 1.0), ("mm", 1000.0), ("cm", 100.0)])
def test_key_points_of_a_trc_are_the_joints(unit: str, scale: float, separator: str) -> None:
    text = trc_text(keypoints(), unit=unit, scale=scale).replace("\t", separator)
    clip = as_stored(text.encode(), name="walk.trc")
    assert isinstance(clip, Clip) and clip.fps == 30 and clip.notes == ()
    assert error_of(clip) < 1e-4


def test_points_of_a_c3d_in_whole_numbers_are_scaled() -> None:
    clip = as_stored(c3d_bytes(keypoints(), scale=0.1), name="walk.c3d")
    assert isinstance(clip, Clip) and error_of(clip) < 1e-3


def test_the_last_frame_of_a_c3d_may_take_more_than_sixteen_bits() -> None:
    data, first = bytearray(c3d_bytes(keypoints())), 2**16 - 6
    last = first + len(POSITIONS) - 1
    data[6:10] = struct.pack("<2H", first, 0xFFFF)
    at = data.index(b"ACTUAL_END_FIELD") + len("ACTUAL_END_FIELD") + 5
    data[at : at + 4] = struct.pack("<2H", last % 2**16, last // 2**16)
    assert error_of(as_stored(bytes(data), name="walk.c3d")) < 1e-3


@pytest.mark.parametrize("kind", ["trc", "c3d"])
def test_zeros_are_a_marker_that_was_not_seen(kind: str) -> None:
    points = {name: np.array(place) for name, place in keypoints().items()}
    points["RKnee"][7:9] = 0.0
    data = trc_text(points).encode() if kind == "trc" else c3d_bytes(points)
    clip = as_stored(data, name=f"x.{kind}")
    assert np.abs(clip.positions[7:9, POINTS17.index("right_knee")] - JOINT["right_knee"][7:9]).max() < 0.1


@pytest.mark.parametrize("unseen", [(), ("RPSI",)])
def test_hips_come_from_the_markers_of_a_pelvis(unseen: tuple[str, ...]) -> None:
    """A pelvis 24 cm wide in front: hips 0.36, 0.30 and 0.19 of that beside, below and behind the middle."""
    still = {name: np.repeat(place[:1], 3, axis=0) for name, place in keypoints().items()}
    markers = {name: place for name, place in still.items() if name not in ("LHip", "RHip")}
    markers |= {
        "LASI": np.full((3, 3), (0.12, 1.0, 0.1)),
        "RASI": np.full((3, 3), (-0.12, 1.0, 0.1)),
        "LPSI": np.full((3, 3), (0.05, 1.0, -0.1)),
        "RPSI": np.full((3, 3), (-0.05, 1.0, -0.1)),
    }
    names = [name for name in markers if name not in unseen]
    points = np.stack([markers[name] for name in names], axis=1)
    (clip,) = people_of(names, points, 100.0, "m", "x.c3d").people
    np.testing.assert_allclose(
        clip.positions[0, POINTS17.index("left_hip")], [0.36 * 0.24, 1.0 - 0.30 * 0.24, 0.1 - 0.19 * 0.24], atol=1e-6
    )


@pytest.mark.parametrize("kind", ["trc", "c3d"])
def test_gaps_are_interpolated_and_long_ones_are_said(kind: str) -> None:
    points = keypoints()
    points["LWrist"] = points["LWrist"].copy()
    points["LWrist"][5:15] = np.nan
    data = trc_text(points).encode() if kind == "trc" else c3d_bytes(points)
    clip = as_stored(data, name=f"gap.{kind}")
    assert clip.notes == ("Interpolated, as their markers were often not seen: left wrist.",)
    wrist = clip.positions[:, POINTS17.index("left_wrist")]
    middle = points["LWrist"][4] + 0.5 * (points["LWrist"][15] - points["LWrist"][4])
    np.testing.assert_allclose((wrist[9] + wrist[10]) / 2, middle, atol=2e-4)


WHOLE = trc_text(keypoints())


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (WHOLE.replace("30\t30", "x\t30", 1), "DataRate as a number"),
        (WHOLE.replace("\tm\t", "\tfurlong\t", 1), "unit 'furlong'"),
        (WHOLE.replace("LKnee", "Tail"), "left knee"),
        (WHOLE.replace("\t0.0000\t", "\t0.0000\twing", 1), "line 6: 'wing"),
        (trc_text(keypoints(), scale=1e6), "is its unit right"),
    ],
)
def test_wrong_trc_files_are_one_sentence(text: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        formats.read(text.encode(), name="x.trc")


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"\2\x50" + b"\0" * 600, "not possible"),
        (c3d_bytes({"Tail": POSITIONS[:, 0]}), "no marker or key point"),
        (c3d_bytes(keypoints())[:1500], "damaged|holds"),
    ],
)
def test_wrong_c3d_files_are_one_sentence(data: bytes, says: str) -> None:
    with pytest.raises(InputError, match=says):
        formats.read(data, name="x.c3d")
