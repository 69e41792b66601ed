"""Parameters of SMPL bodies, InterHuman's frames, and two people in two files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from motion import SMPL22, Clip, Duet, InputError, formats
from motion.formats.importing import import_motion
from motion.formats.registry import partner_file
from motion.formats.smpl import PELVIS
from motion.guesses import turn_of
from motion.transforms import heading_matrix
from tests.motion.bodies import marching
from tests.motion.formats.arrays import npy, npz

from .written import interhuman, interx, zipped

POSITIONS, ROTATIONS = marching(20)
APART = POSITIONS + np.array([0.4, 0.0, 1.2])
DUET = Duet.from_positions(np.stack([POSITIONS, APART]), fps=30)
# ---- Inter-X and InterHuman --------------------------------------------------------------------------


@pytest.mark.parametrize("z_up", [True, False])
@pytest.mark.parametrize("flat", [True, False])
def test_interx_stands_upright_where_it_was(z_up: bool, flat: bool) -> None:
    clip = formats.read(npz(**interx(POSITIONS, z_up=z_up, flat=flat)), name="P1.npz")
    assert isinstance(clip, Clip) and clip.fps == 120
    np.testing.assert_allclose(clip.positions, POSITIONS, atol=1e-5)


def test_interhuman_is_read_by_its_body_joints() -> None:
    found = import_motion(npy(interhuman(POSITIONS)), name="12.npy")
    assert found.asks and found.fps == 30
    np.testing.assert_allclose(found.motion.positions, POSITIONS - [0, POSITIONS[..., 1].min(), 0], atol=1e-5)


@pytest.mark.parametrize(
    ("arrays", "says"),
    [
        ({"pose_body": np.zeros((4, 60))}, "63 or more"),
        ({"trans": np.zeros((3, 3))}, "same number of frames"),
        ({"pose_body": np.full((4, 63), np.nan)}, "NaN"),
        ({"fps": np.array(0.0)}, "not possible"),
    ],
)
def test_wrong_parameters_are_one_sentence(arrays: dict[str, np.ndarray], says: str) -> None:
    whole = {"root_orient": np.zeros((4, 3)), "pose_body": np.zeros((4, 63)), "trans": np.zeros((4, 3))}
    with pytest.raises(InputError, match=says):
        formats.read(npz(**(whole | arrays)), name="P1.npz")


@pytest.mark.parametrize("flat", [True, False])
@pytest.mark.parametrize("matrices", [True, False])
def test_dictionaries_of_estimators_are_read_whichever_axis_of_the_camera_is_up(matrices: bool, flat: bool) -> None:
    down = turn_of("-y")
    whole = interx(POSITIONS, z_up=False, flat=True)
    turns = (
        Rotation.from_rotvec(
            np.concatenate([whole["root_orient"], whole["pose_body"], np.zeros((len(POSITIONS), 6))], axis=1).reshape(
                -1, 3
            )
        )
        .as_matrix()
        .reshape(-1, 24, 3, 3)
    )
    turns[:, 0] = down @ turns[:, 0]
    vectors = Rotation.from_matrix(turns.reshape(-1, 3, 3)).as_rotvec().reshape(-1, 24, 3)
    rotations = turns if matrices else vectors.reshape(len(vectors), -1, 3)
    transl = (whole["trans"] + PELVIS) @ down.T - PELVIS
    found = {"global_orient": rotations[:, :1], "body_pose": rotations[:, 1:], "transl": transl}
    if flat:
        found = {"poses": rotations, "transl": transl}
    clip = formats.read(npz(**found), name="wild.npz")
    np.testing.assert_allclose(clip.positions, POSITIONS - [0, POSITIONS[..., 1].min(), 0], atol=1e-5)
    assert import_motion(npz(**found), name="wild.npz").up == "-y"


def test_amass_in_a_world_with_y_up_stands() -> None:
    arrays = {
        "poses": np.zeros((20, 156)),
        "trans": np.tile([0.0, 1.16, 0.0], (20, 1)),
        "mocap_framerate": np.array(60.0),
    }
    found = import_motion(npz(**arrays), name="x.npz")
    assert found.up == "y" and any("not Z as is usual" in note for note in found.notes)
    assert found.people[0].positions[0, SMPL22.index("head"), 1] > 1.4


def test_humanml3d_gives_the_joints_again() -> None:
    angle = np.linspace(0, 2.0, len(POSITIONS))
    moved = np.einsum("tij,tkj->tki", heading_matrix(angle), POSITIONS - POSITIONS[:, :1] * [1, 0, 1])
    moved += np.stack([np.sin(angle), 0 * angle, angle], axis=-1)[:, None]
    local = np.einsum("tji,tkj->tki", heading_matrix(angle), moved - moved[:, :1] * [1, 0, 1])
    features = np.zeros((len(moved), 263))
    features[:-1, 0] = -np.diff(angle) / 2
    steps = np.einsum("tji,tj->ti", heading_matrix(angle[1:]), np.diff(moved[:, 0], axis=0))
    features[:-1, [1, 2]], features[:, 3] = steps[:, [0, 2]], moved[:, 0, 1]
    features[:, 4:67] = local[:, 1:].reshape(len(moved), -1)
    found = import_motion(npy(features), name="000001.npy")
    np.testing.assert_allclose(found.motion.positions, moved - moved[:1, :1] * [1, 0, 1], atol=1e-5)
    assert found.fps == 20 and found.asks


# ---- two files ---------------------------------------------------------------------------------------


def pair_of(kind: str) -> tuple[dict[str, bytes], float]:
    lifted = 0.7  # metres above the floor: both people are shifted by the same
    if kind == "interhuman":
        a, b = (npy(interhuman(person + np.array([0, up, 0]))) for person, up in ((POSITIONS, lifted), (APART, 0.9)))
        return {"take/person1/3.npy": a, "take/person2/3.npy": b, "annots/3.txt": b"two people meet"}, 30
    a, b = (npz(**interx(person + np.array([0, up, 0]))) for person, up in ((POSITIONS, lifted), (APART[:15], 0.9)))
    return {"G001/P1.npz": a, "G001/P2.npz": b, "__MACOSX/G001/._P1.npz": b"x"}, 120


@pytest.mark.parametrize("kind", ["interhuman", "interx"])
@pytest.mark.parametrize("packed", [True, False])
def test_two_files_keep_one_world(kind: str, packed: bool, tmp_path: Path) -> None:
    parts, fps = pair_of(kind)
    if packed:
        duet = formats.read(zipped(parts), name="take.zip")
    else:
        for name, data in parts.items():
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_bytes(data)
        first = tmp_path / next(iter(parts))
        other = partner_file(first)
        assert other is not None
        duet = formats.read_pair(first, other)
    assert isinstance(duet, Duet) and duet.fps == fps
    frames = duet.num_frames
    assert frames == (20 if kind == "interhuman" else 15)  # the longer one is cut
    assert abs(duet.positions[..., 1].min()) < 0.01  # the height of both is one floor's
    between = duet.b.positions - duet.a.positions
    np.testing.assert_allclose(
        between, (APART + np.array([0, 0.2, 0]) - POSITIONS)[:frames].astype(np.float32), atol=1e-4
    )


@pytest.mark.parametrize(
    ("parts", "says"),
    [
        ({"readme.md": b"x"}, "holds no motion files"),
        ({f"P{n}.npz": npz(**interx(POSITIONS)) for n in (1, 2, 3)}, "holds 3 motion files"),
        ({"P1.npz": b"x" * 100, "P2.npz": b"y"}, "P1.npz"),
        ({"P1.npz": npz(positions=DUET.positions), "P2.npz": npz(positions=DUET.positions)}, "two people"),
    ],
)
def test_wrong_archives_are_one_sentence(parts: dict[str, bytes], says: str) -> None:
    with pytest.raises(InputError, match=says):
        formats.read(zipped(parts), name="take.zip")


def test_an_archive_that_grows_is_refused_before_it_does() -> None:
    bomb = zipped({"P1.npy": b"\0" * (60 * 2**20)})
    assert len(bomb) < 100_000
    with pytest.raises(InputError, match="unpack to more than 50 MB"):
        formats.read(bomb, name="take.zip")


# ---- writing -----------------------------------------------------------------------------------------


def joints_again(file: Path) -> np.ndarray:
    """(T, 22, 3) of a written file as another program makes them, without a line of ours but the bones: SMPL's rule.

    Each joint's rotation is the product of those on the way from the root; the pelvis lies at trans plus its place in
    the body's own frame.
    """
    with np.load(file, allow_pickle=False) as stored:
        poses, trans = stored["poses"].reshape(-1, 52, 3), stored["trans"]
    turns: list[Rotation] = []
    joints = np.zeros((len(poses), 22, 3))
    for joint, parent in enumerate(SMPL22.parents):
        own = Rotation.from_rotvec(poses[:, joint])
        turns.append(own if parent < 0 else turns[parent] * own)
        joints[:, joint] = (
            trans + np.array([-0.00179506, -0.22333382, 0.02821918])
            if parent < 0
            else joints[:, parent] + turns[parent].apply(SMPL22.offsets[joint])
        )
    return joints[..., [0, 2, 1]] * [1, 1, -1]  # (x, y, z) of a Z-up world is (x, z, -y) here


def test_written_parameters_give_the_joints_within_a_millimetre(tmp_path: Path) -> None:
    files = formats.write(DUET, tmp_path / "meet.smpl.npz")
    assert [file.name for file in files] == ["meet_a.smpl.npz", "meet_b.smpl.npz"]
    for file, person in zip(files, DUET.people, strict=True):
        assert np.abs(joints_again(file) - person.positions).max() < 0.001
        with np.load(file, allow_pickle=False) as stored:
            assert stored["poses"].shape == (20, 156) and stored["betas"].shape == (16,)
            assert str(stored["gender"]) == "neutral" and not stored["betas"].any()
            assert float(stored["mocap_frame_rate"]) == float(stored["mocap_framerate"]) == 30
