"""BVH of any rig, and how wrong files are refused."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from motion import SMPL22, InputError, formats
from motion.formats import bvh
from motion.formats.bvh import read_bvh
from motion.formats.importing import import_motion
from motion.formats.recording import ImportChoices
from motion.retarget import retarget
from tests.motion.bodies import marching

from .rigs import RIGS, bvh_text

POSITIONS, ROTATIONS = marching(40)
ROOT = POSITIONS[:, 0]
WRISTS_AND_ANKLES = [SMPL22.index(f"{s}_{p}") for s in ("left", "right") for p in ("wrist", "ankle", "knee", "elbow")]


@pytest.mark.parametrize("name", RIGS)
def test_rigs_come_back_as_the_motion_they_were(name):
    rig = read_bvh(bvh_text(ROTATIONS, ROOT, RIGS[name]).encode())[0]
    clip = retarget(rig, plant=False)
    truth = POSITIONS - np.array([0, np.quantile(POSITIONS[..., 1].min(axis=-1), 0.05), 0])
    error = np.linalg.norm(clip.positions - truth, axis=-1)
    assert error.max() < 0.06, dict(zip(SMPL22.joint_names, error.max(axis=0).round(3), strict=True))
    assert error[:, WRISTS_AND_ANKLES].mean() < 0.02
    assert clip.positions[:, SMPL22.index("left_wrist"), 0].mean() > 0.2


@pytest.mark.parametrize(
    "lacking",
    [["left_collar"], ["left_collar", "right_collar"], ["left_foot", "right_foot"], ["spine1", "spine2"]],
    ids=" ".join,
)
def test_rigs_that_lack_joints(lacking):
    names = {joint: name for joint, name in RIGS["mixamo"].items() if joint not in lacking}
    rotations = ROTATIONS.copy()
    rotations[:, [SMPL22.index(joint) for joint in lacking]] = np.eye(3)
    truth = retarget(read_bvh(bvh_text(rotations, ROOT, RIGS["mixamo"]).encode())[0], plant=False).positions
    found = retarget(read_bvh(bvh_text(rotations, ROOT, names).encode())[0], plant=False).positions
    spared = [SMPL22.index(f"{side}_{part}") for side in ("left", "right") for part in ("elbow", "knee", "ankle")]
    assert np.linalg.norm(found - truth, axis=-1)[:, spared].max() < 0.08


@pytest.mark.parametrize("helper", ["HipJoint", "Hip_helper_Joint"])
def test_a_helper_at_the_root_is_no_hip(helper):
    text = bvh_text(ROTATIONS, ROOT, RIGS["xsens"])
    head, numbers = text.split("MOTION\n")
    widths = [int(line.split()[1]) for line in head.splitlines() if line.startswith("CHANNELS")]
    names = [line.split()[1] for line in head.splitlines() if line.startswith(("ROOT", "JOINT"))]
    for side in ("Left", "Right"):
        joint = f"JOINT {side}Hip\n"
        head = head.replace(
            joint,
            f"JOINT {side[0]}{helper}\n{{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n"
            f"{{\nOFFSET 0 0 0\n}}\n}}\n{joint}",
        )
    rows = numbers.splitlines()
    for side in ("Right", "Left"):
        before = sum(widths[: names.index(f"{side}Hip")])
        rows[2:] = [" ".join([*(w := row.split())[:before], "0 0 0", *w[before:]]) for row in rows[2:]]
    (rig,) = read_bvh("\n".join([head + "MOTION", *rows]).encode())
    assert [rig.joint_names[rig.parts.joints[f"{side}_hip"]] for side in ("left", "right")] == ["LeftHip", "RightHip"]
    np.testing.assert_allclose(retarget(rig).positions, retarget(read_bvh(text.encode())[0]).positions, atol=1e-3)


@pytest.mark.parametrize("unit", [1.0, 100.0, 1000.0, 39.37])
def test_units_are_found(unit):
    rig = read_bvh(bvh_text(ROTATIONS, ROOT, unit=unit).encode())[0]
    assert rig.metres_per_unit == pytest.approx(1 / unit, rel=1e-3)
    np.testing.assert_allclose(rig.positions[:, 0], ROOT, atol=1e-3)


@settings(max_examples=12, deadline=None)
@given(st.permutations("XYZ"), st.booleans(), st.booleans())
def test_channel_order_positions_and_up_axis(order, positions_everywhere, z_up):
    text = bvh_text(
        ROTATIONS,
        ROOT,
        RIGS["motionbuilder"],
        order="".join(order),
        positions_everywhere=positions_everywhere,
        z_up=z_up,
    )
    clip = retarget(read_bvh(text.encode())[0], plant=False)
    expected = retarget(read_bvh(bvh_text(ROTATIONS, ROOT, RIGS["motionbuilder"]).encode())[0], plant=False)
    # Without a sensible rest pose the neck's lean cannot be measured; the limbs are the same.
    wanted = slice(None) if not positions_everywhere else WRISTS_AND_ANKLES
    np.testing.assert_allclose(clip.positions[:, wanted], expected.positions[:, wanted], atol=0.06)


def down(kind: str) -> np.ndarray:
    """Rotations of a person who lies on their back, or is on hands and knees, all the time."""
    rotations = np.tile(np.eye(3), (40, 22, 1, 1))
    rotations[:, 0] = Rotation.from_euler("x", -88 if kind == "lies" else 88, degrees=True).as_matrix()
    if kind == "crawls":
        for side in ("left", "right"):
            rotations[:, SMPL22.index(f"{side}_hip")] = Rotation.from_euler("x", -80, degrees=True).as_matrix()
            rotations[:, SMPL22.index(f"{side}_knee")] = Rotation.from_euler("x", 85, degrees=True).as_matrix()
    turned = Rotation.from_euler("y", 90, degrees=True).as_matrix()
    rotations[:, 0] = turned @ rotations[:, 0]
    return rotations


@pytest.mark.parametrize("kind", ["lies", "crawls"])
@pytest.mark.parametrize("rig", ["mixamo", "cmu"])
@pytest.mark.parametrize("z_up", [False, True])
def test_who_is_down_all_the_time_is_not_stood_up(kind, rig, z_up):
    root = np.tile([0.0, 0.12 if kind == "lies" else 0.45, 0.0], (40, 1))
    content = bvh_text(down(kind), root, RIGS[rig], z_up=z_up).encode()
    found = import_motion(content, name="down.bvh")
    assert found.up == ("z" if z_up else "y"), "the rest pose stands along it"
    assert f"{found.up.upper()} is up" in found.describe()
    positions = found.people[0].positions
    assert positions[..., 1].max() < 0.9 and positions[:, 0, 1].max() < 0.7
    long = positions[0, SMPL22.index("neck")] - positions[0, 0]
    assert abs(long[1]) < 0.25 and np.hypot(long[0], long[2]) > 0.35, "the trunk is level"
    other = import_motion(content, choices=ImportChoices(up="x"), name="down.bvh")
    assert other.up == "x", "and it can be corrected"


@pytest.mark.parametrize("floor", [0.0, 0.7])
@pytest.mark.parametrize("up", [None, "z"])
def test_a_z_up_world_is_seen_although_the_rest_pose_is_y_up(floor, up):
    tilt = Rotation.from_euler("x", 90, degrees=True).as_matrix()
    rotations = ROTATIONS.copy()
    rotations[:, 0] = tilt @ rotations[:, 0]
    walk = ROOT + np.linspace(0, 1, len(ROOT))[:, None] * [0.0, 0.0, 1.5]
    text = bvh_text(rotations, (walk + np.array([0, floor, 0])) @ tilt.T, RIGS["mixamo"])
    found = import_motion(text.encode(), name="x.bvh", choices=ImportChoices(up=up))
    truth = import_motion(bvh_text(ROTATIONS, walk, RIGS["mixamo"]).encode(), name="x.bvh")
    assert found.up == "z" and any("Z was taken as up" in note for note in found.notes) == (up is None)
    np.testing.assert_allclose(found.motion.positions, truth.motion.positions, atol=0.02)


@pytest.mark.parametrize("frame_time", ["1.0", "1e-9", "nan"])
def test_a_given_rate_comes_before_what_a_file_says_of_its_own(frame_time):
    text = bvh_text(np.tile(ROTATIONS, (20, 1, 1, 1)), np.tile(ROOT, (20, 1)), RIGS["mixamo"])
    text = text.replace("Frame Time: 0.0333333", f"Frame Time: {frame_time}")
    with pytest.raises(InputError, match="true rate"):
        formats.read(text.encode(), name="x.bvh")
    assert formats.read(text.encode(), name="x.bvh", choices=ImportChoices(fps=30)).num_frames == 800


@pytest.mark.parametrize("encoding", ["utf-8-sig", "latin-1"])
@pytest.mark.parametrize("newline", ["\n", "\r"])
def test_encodings_and_line_ends(encoding, newline):
    names = {**RIGS["mixamo"], "spine2": "Rücken"}
    data = bvh_text(ROTATIONS, ROOT, names).replace("\n", newline).encode(encoding)
    assert read_bvh(data)[0].num_frames == 40


GOOD = bvh_text(ROTATIONS[:3], ROOT[:3], RIGS["mixamo"])
LAST = GOOD.splitlines()[-1]
FAST = bvh_text(np.repeat(ROTATIONS, 4, axis=0)[2:], np.repeat(ROOT, 4, axis=0)[2:], RIGS["mixamo"])


def test_places_below_the_root_that_are_all_zero_say_nothing():
    text = re.sub(r"(JOINT [^{]*{\s*OFFSET[^\n]*\s*CHANNELS) 3 ", r"\1 6 Xposition Yposition Zposition ", GOOD)
    head, tail = text.split("Frame Time")
    rows = []
    for numbers in (row.split() for row in tail.splitlines()[1:]):
        turns = (" ".join(numbers[i : i + 3]) for i in range(6, len(numbers), 3))
        rows.append(" ".join([*numbers[:6], *(f"0 0 0 {each}" for each in turns)]))
    found = read_bvh("\n".join([f"{head}Frame Time: 0.0333333", *rows]).encode())[0]
    np.testing.assert_allclose(found.positions, read_bvh(GOOD.encode())[0].positions, atol=1e-6)


@pytest.mark.parametrize(("file_fps", "every"), [(120, 4), (30, 1), (100, 2)])
def test_of_a_faster_file_only_the_frames_that_are_needed_are_placed(file_fps, every, monkeypatch):
    data = FAST.replace("Frame Time: 0.0333333", f"Frame Time: {1 / file_fps:.7f}").encode()
    whole = read_bvh(data)[0]
    monkeypatch.setattr(bvh, "_PIECE", 3400)  # bytes, five frames
    rig = read_bvh(data, fps=30.0)[0]
    assert (rig.every, rig.fps * rig.every) == (every, file_fps) and whole.fps == file_fps
    np.testing.assert_array_equal(rig.positions, whole.positions[::every])
    assert import_motion(data, name="x.bvh").fps == file_fps


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (GOOD.split("MOTION")[0], "no MOTION"),
        (GOOD.replace("Frames: 3", "Frames: 1000000000"), "600 s allowed"),
        (GOOD.replace("Frames: 3", "Frames: 9"), "cut short"),
        (GOOD.replace(LAST, LAST.replace(LAST.split()[7], "nan", 1)), "no usable number in frame 3"),
        (GOOD.replace(LAST, LAST.replace(LAST.split()[3], "abc", 1)), "after frame 0 something is not a number"),
        (GOOD.replace("OFFSET 0.000000 0.000000 0.000000", "OFFSET 0 0", 1), "line 4: OFFSET of joint mixamorig:Hips"),
        (GOOD.replace("}\nMOTION", "MOTION"), "never closed"),
        (GOOD.replace("mixamorig:RightArm", "mixamorig:LeftArm"), "two joints are named"),
        ("HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n}\nMOTION\nFrames: 1\nFrame Time: 0.03\n1", "CHANNELS"),
        ("HIERARCHY\n" + "".join(f"ROOT j{i}\n{{\n" for i in range(5000)) + "}" * 5000 + "\nMOTION\n", "200 joints"),
    ],
)
def test_wrong_files_are_refused_in_one_sentence(text, message):
    with pytest.raises(InputError, match=message) as error:
        read_bvh(text.encode(), name="take.bvh")
    assert "take.bvh" in str(error.value) and "\n" not in str(error.value) and len(str(error.value)) < 250
