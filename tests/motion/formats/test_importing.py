"""What was found in a file is reported, and what the user knows about it is believed."""

import zipfile
from pathlib import Path

import numpy as np
import pytest

from motion import SMPL22, Clip, InputError, formats
from motion.formats import importing
from motion.formats.importing import import_motion, import_pair
from motion.formats.recording import ImportChoices
from motion.guesses import AXES, likely_skeleton, turn_of
from motion.skeleton import LAYOUTS, SKELETONS
from motion.transforms import heading_matrix
from tests.motion.bodies import marching, swaying
from tests.motion.formats.arrays import npy


def test_arrays_are_reported_and_kept_bit_for_bit() -> None:
    found = import_motion(npy(swaying()), name="a.npy")
    assert (found.up, found.unit, found.fps) == ("y", "m", 30.0)
    assert found.joints == 22
    assert found.motion.positions.tobytes() == swaying().tobytes()
    assert found.describe() == "22 joints found; lengths in m, Y is up, 30 frames a second"


@pytest.mark.parametrize(("unit", "metres"), [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("inch", 0.0254)])
@pytest.mark.parametrize("up", ["y", "z", "x"])
def test_up_axis_and_unit_of_arrays_are_found(up: str, unit: str, metres: float) -> None:
    x, y, z = np.moveaxis(swaying() / metres, -1, 0)
    turned = {"y": (x, y, z), "z": (x, -z, y), "x": (y, -x, z)}[up]
    found = import_motion(npy(np.stack(turned, axis=-1)), name="a.npy")
    assert (found.up, found.unit) == (up, unit)
    np.testing.assert_allclose(found.motion.positions, swaying(), atol=1e-4)


@pytest.mark.parametrize("up", AXES)
@pytest.mark.parametrize("shift", [0.0, 3.0])
def test_up_has_a_sign_and_what_was_taken_is_said_and_can_be_corrected(up: str, shift: float) -> None:
    data = npy((swaying() + np.array([0.0, shift, 0.0])) @ turn_of(up))
    found = import_motion(data, name="a.npy")
    assert found.up == up and any(f"{up.upper()} was taken as up" in note for note in found.notes) == (up != "y")
    ankles = found.motion.positions[:, SMPL22.index("left_ankle"), 1]
    assert (found.motion.positions[:, SMPL22.index("head"), 1] > ankles + 1.2).all() and found.asks
    for other in AXES:
        chosen = import_motion(data, name="a.npy", choices=ImportChoices(up=other))
        assert chosen.up == other and not any("was taken" in note for note in chosen.notes)
        height = np.ptp(chosen.motion.positions[:, [0, SMPL22.index("neck")], 1], axis=1)
        assert (height.min() > 0.3) == (other[-1] == up[-1])


def test_who_lies_or_stands_on_their_hands_on_the_floor_stays_there() -> None:
    lying = swaying() @ turn_of("z").T - np.array([0.0, 0.0, 2.0])
    lying[..., 1] -= lying[..., 1].min()
    on_hands = swaying() * [1.0, -1.0, -1.0]
    on_hands[..., 1] -= on_hands[..., 1].min()
    for positions in (lying, on_hands):
        found = import_motion(npy(positions.astype(np.float32)), name="a.npy")
        assert found.up == "y" and not any("taken" in note for note in found.notes)


@pytest.mark.parametrize("held", [1, 20])
@pytest.mark.parametrize("fps", [30.0, 120.0])
def test_a_calibration_pose_that_the_motion_jumps_from_is_left_out(held: int, fps: float) -> None:
    motion = marching(60)[0].astype(np.float32)
    t_pose = np.repeat(SMPL22.rest_positions()[None] + [0, 0.95, 0], held, axis=0).astype(np.float32)
    choices = ImportChoices(fps=fps)
    found = import_motion(npy(np.concatenate([t_pose, motion])), name="a.npy", choices=choices)
    np.testing.assert_array_equal(found.motion.positions, motion)
    assert any("a calibration pose" in note for note in found.notes)
    kept = import_motion(npy(motion), name="a.npy", choices=choices)
    assert kept.motion.num_frames == 60 and kept.notes == ()


def test_two_people_keep_one_clock_where_only_one_jumps_out_of_a_calibration_pose() -> None:
    motion = marching(60)[0].astype(np.float32)
    held = np.repeat(SMPL22.rest_positions()[None] + [0, 0.95, 0], 20, axis=0).astype(np.float32)
    still = np.concatenate([held, np.repeat(held[:1], 60, axis=0)]) + np.float32([0, 0, 1.5])
    found = import_motion(npy(np.stack([np.concatenate([held, motion]), still])), name="a.npy")
    np.testing.assert_array_equal(found.motion.positions, [motion, still[20:]])


@pytest.mark.parametrize(("choices", "says"), [({"up": "w"}, "choose x, y or z"), ({"fps": 0.0}, "not possible")])
def test_wrong_choices_are_refused_in_words(choices: dict, says: str) -> None:
    with pytest.raises(InputError, match=says):
        ImportChoices(**choices)


def test_a_long_recording_is_refused_before_it_is_fitted(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    bodies = swaying(2000)[:, [15, 12, 6, 16, 18, 20, 17, 19, 21, 1, 4, 7, 2, 5, 8]]
    for module in (formats, importing):
        monkeypatch.setattr(module, "to_smpl", lambda motion: pytest.fail("fitted"))
    (tmp_path / "kinect.npy").write_bytes(npy(bodies))
    with zipfile.ZipFile(tmp_path / "pair.zip", "w") as archive:
        for name in ("a.npy", "b.npy"):
            archive.writestr(name, npy(bodies))
    with pytest.raises(InputError, match="lasts 67 s: cut it to 60 s or less"):
        formats.read(tmp_path / "pair.zip", longest=60.0)
    with pytest.raises(InputError, match=r"^kinect\.npy lasts 67 s: cut it to 60 s or less\."):
        formats.read(tmp_path / "kinect.npy", longest=60.0)


@pytest.mark.parametrize("name", ["cmu17", "h36m17", "coco17"])
@pytest.mark.parametrize("turn", [0.0, 1.0, 3.0])
def test_seventeen_joints_are_of_the_order_in_which_they_are_a_body(name: str, turn: float) -> None:
    body = marching(30)[0] @ heading_matrix(turn).T
    positions = np.stack(
        [body[:, ours if ours >= 0 else SMPL22.index("head")] for ours in LAYOUTS[name].joints], axis=1
    )
    assert likely_skeleton(positions) == (SKELETONS[name], None)


@pytest.mark.parametrize("suffix", [".npz", ".bvh"])
@pytest.mark.parametrize("frames", [(30, 40), (40, 30)])
def test_two_files_are_as_long_as_the_shorter(frames: tuple[int, int], suffix: str, tmp_path: Path) -> None:
    paths = [tmp_path / f"P{number}{suffix}" for number in (1, 2)]
    for path, count in zip(paths, frames, strict=True):
        formats.write(Clip(swaying(count), 30.0), path)
    assert import_pair(*paths).motion.num_frames == 30
