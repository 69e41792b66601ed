"""Recorded pairs: readers undo the files' scaling, repairs a Kinect's errors, and scenes come out."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat
from scipy.spatial.transform import Rotation

from motion.kinematics import bone_lengths, forward_kinematics
from motion.skeleton import K3HI15, LAYOUTS, SBU15, SMPL22, Skeleton
from motion.transforms import heading_matrix
from training.corpus.kinect import RELEASES, read_release, unswap
from training.corpus.pairs import Pair, as_seen, load_pairs, scenes_of


def standing(frames: int, place: tuple[float, float], heading: float, reach: np.ndarray | None = None) -> np.ndarray:
    """(T, 15, 3) SBU joints of a person who stands, the right arm raised by ``reach`` (T,) in 0…1."""
    body = Skeleton("openni", SMPL22.joint_names, SMPL22.parents, LAYOUTS["sbu15"].offsets)
    rotations = np.tile(np.eye(3), (frames, 22, 1, 1))

    def about(axis: int, angle: np.ndarray | float) -> np.ndarray:
        vectors = np.zeros((frames, 3))
        vectors[:, axis] = angle
        return Rotation.from_rotvec(vectors).as_matrix()

    rotations[:, 0] = heading_matrix(heading)
    rotations[:, SMPL22.index("left_shoulder")] = about(2, -1.4)
    raised = np.zeros(frames) if reach is None else reach
    rotations[:, SMPL22.index("right_shoulder")] = about(0, -1.4 * raised) @ about(2, 1.4)
    root = np.tile([place[0], 0.97, place[1]], (frames, 1))
    return forward_kinematics(rotations, root, body)[:, LAYOUTS["sbu15"].observed]


def handshake(frames: int = 30) -> np.ndarray:
    """(2, T, 15, 3) two people 1.1 m apart, 2 m from the camera, whose right hands meet."""
    reach = np.sin(np.linspace(0, np.pi, frames)) ** 0.5
    return np.stack(
        [standing(frames, (-0.5, 1.78), np.pi / 2, reach), standing(frames, (0.5, 2.22), -np.pi / 2, reach)]
    )


def write_release(folder: Path, top: str, clips: dict[str, np.ndarray], train: list[str], test: list[str]) -> None:
    """A release in the data sets' own shape; the actor of every second listed clip is in file B."""
    for name, people in clips.items():
        (folder / top / name).mkdir(parents=True)
        for letter, person in zip("AB", people, strict=True):
            x, y, z = np.moveaxis(person, -1, 0)
            curve = np.stack([(1.280 - x) / 2.560, (0.960 - y) / 1.920, z * 0.78125]).transpose(0, 2, 1)
            savemat(folder / top / name / f"skeleton_{letter}.mat", {"curve_B": curve.reshape(45, -1)})
    for listing, names in (("Train.txt", train), ("Test.txt", test)):
        lines = []
        for number, name in enumerate(names):
            files = [f"{top}/{name}/skeleton_{letter}.mat" for letter in ("BA" if number % 2 else "AB")]
            lines.append(" ".join(files) + "\n")
        (folder / listing).write_text("".join(lines))


@pytest.fixture
def data_dir(tmp_path: Path) -> Path:
    people = handshake()
    sbu = {"s01s02/05/001": people, "s01s03/05/001": people, "s02s06/05/001": people}
    write_release(tmp_path / "sbu", "Skeletons_Check", sbu, ["s01s02/05/001", "s01s03/05/001"], ["s02s06/05/001"])
    order = [SBU15.index(name) for name in K3HI15.joint_names]
    k3hi = {"shaking/1": people[:, :, order], "shaking/2": people[:, :, order]}
    write_release(tmp_path / "k3hi", "Skeletons", k3hi, ["shaking/1"], [])
    return tmp_path


def test_readers_give_metres_roles_and_splits(data_dir: Path) -> None:
    clips = {clip.name: clip for clip in read_release(data_dir, "sbu")}
    assert [clips[n].test for n in ("s01s02/05/001", "s02s06/05/001")] == [False, True]
    assert clips["s01s02/05/001"].family == "handshake"
    np.testing.assert_allclose(clips["s01s02/05/001"].positions, handshake(), atol=1e-9)
    np.testing.assert_allclose(clips["s01s03/05/001"].positions, handshake()[::-1], atol=1e-9)  # B acts
    (listed,) = read_release(data_dir / "k3hi", "k3hi")  # in neither list, nobody knows who acts
    assert (listed.name, listed.test) == ("shaking/1", False)
    wrist = RELEASES["k3hi"].skeleton.index("right_wrist")
    np.testing.assert_allclose(listed.positions[:, :, wrist], handshake()[:, :, SBU15.index("right_wrist")], atol=1e-9)


def test_exchanged_legs_are_put_back() -> None:
    true = handshake()[0]
    spoilt = true.copy()
    left, right = ([SBU15.index(f"{side}_{part}") for part in ("knee", "foot")] for side in ("left", "right"))
    spoilt[10:14, left], spoilt[10:14, right] = true[10:14, right], true[10:14, left]
    for seen in (spoilt, true):
        np.testing.assert_array_equal(unswap(seen, SBU15, ("knee", "foot"), 15.0), true)


def test_listed_pairs_are_fitted_once_and_become_scenes(data_dir: Path, tmp_path: Path) -> None:
    cache = tmp_path / "cache"
    first, second = load_pairs(data_dir, cache), load_pairs(tmp_path / "nowhere", cache)
    listed = [("sbu", False), ("sbu", False), ("sbu", True), ("k3hi", False)]
    for pairs in (first, second):
        assert [(one.dataset, one.test) for one in pairs] == listed
        assert all(one.family == "handshake" and one.error < 0.05 for one in pairs)
    for one, other in zip(first, second, strict=True):
        np.testing.assert_array_equal(one.positions, other.positions)
    scenes = scenes_of(second, Counter())
    assert [scene.sources for scene in scenes] == [("sbu/s01s02/05/001",), ("sbu/s01s03/05/001",), ("k3hi/shaking/1",)]
    scene = scenes[0]
    a, b = scene.positions.astype(np.float64)
    assert len(a) == 59  # 30 frames at 15 fps
    np.testing.assert_allclose(bone_lengths(scene.positions) - SMPL22.bone_lengths[1:], 0, atol=1e-5)
    np.testing.assert_allclose(a[0, 0, [0, 2]], 0, atol=1e-6)
    assert scene.positions[..., 1].min() > -0.01
    contact = scene.events["contact"][0]
    assert (contact["a"], contact["b"]) == ("right_wrist", "right_wrist")
    middle, wrist = (contact["start"] + contact["end"]) // 2, SMPL22.index("right_wrist")
    assert np.linalg.norm(a[middle, wrist] - b[middle, wrist]) == pytest.approx(0.10, abs=0.02)
    assert scene.captions and len(set(scene.captions)) == len(scene.captions)
    feet = scene.positions[:, :, [SMPL22.index("left_foot"), SMPL22.index("right_foot")]][..., [0, 2]]
    assert np.linalg.norm(np.diff(feet, axis=1), axis=-1).max() * 30 < 0.05


def test_bad_clips_are_counted_with_their_reason(data_dir: Path) -> None:
    good = load_pairs(data_dir)[0].positions
    apart = good + np.array([[[[0, 0, -0.5]]], [[[0, 0, 0.5]]]], dtype=np.float32)
    clips, rejected = ((apart, 0.0), (good[:, :20], 0.0), (good, 0.2)), Counter[str]()
    assert not scenes_of([Pair(people, "handshake", "sbu", "x", False, error) for people, error in clips], rejected)
    reasons = ("the hands do not meet", "shorter than 0.8 s", "fit further than 90 mm from the joints")
    assert rejected == {f"sbu handshake: {reason}": 1 for reason in reasons}


def test_who_walks_is_the_actor_of_an_approach() -> None:
    still = np.zeros((40, 22, 3))
    way = still + np.linspace(0, 0.8, 40)[:, None, None] * np.array([0.0, 0.0, 1.0])
    family, people = as_seen("approach", np.stack([still, way]))
    assert family == "approach" and np.array_equal(people, np.stack([way, still]))
    assert as_seen("approach", np.stack([way, -way]))[0] == "meet"
    assert as_seen("push", np.stack([still, way]))[0] == "push"
