"""Real duets: what two do is measured, takes are read in one world, windows keep the splits apart."""

from __future__ import annotations

import io
import tarfile
from pathlib import Path

import numpy as np
import pytest

from motion import SMPL22
from motion.transforms import heading, turn
from tests.motion.bodies import marching
from tests.motion.formats.rigs import RIGS, bvh_text
from training.corpus import duets
from training.corpus.cues import Label
from training.corpus.duets import HELD_OUT, SECONDS, dance_beats, danced, read_takes, windows

J = SMPL22.index
REST = SMPL22.rest_positions() + np.array([0, 0.98, 0])


def couple(frames: int, *, turned: float = 0.0) -> np.ndarray:
    """(2, frames, 22, 3): b stands before a, face to face, and turns on the spot by ``turned`` degrees."""
    angles = np.pi + np.radians(np.linspace(0, turned, frames))
    b = np.stack([turn(REST[None], float(angle))[0] for angle in angles]) + np.array([0, 0, 0.8])
    return np.stack([np.repeat(REST[None], frames, axis=0), b])


def joined(people: np.ndarray, start: int, stop: int, height: float) -> np.ndarray:
    """With a's right wrist and b's left one 10 cm apart between the two, from ``start`` to ``stop``."""
    people = people.copy()
    middle = people[:, start:stop, 0].mean(axis=0) * [1, 0, 1] + [0, height, 0]
    people[0, start:stop, J("right_wrist")] = middle - [0, 0, 0.05]
    people[1, start:stop, J("left_wrist")] = middle - np.array([0, 0, -0.05])
    return people


def told(people: np.ndarray) -> list[tuple[tuple[str, str], int, int]]:
    return [(beat.acts, beat.start, beat.end) for beat in dance_beats(people)]


@pytest.mark.parametrize(
    ("degrees", "height", "twirled"), [(360, 1.9, True), (-360, 1.9, True), (180, 1.9, False), (360, 1.0, False)]
)
def test_a_turn_under_a_raised_arm_is_a_twirl(degrees: float, height: float, twirled: bool) -> None:
    people = joined(couple(60, turned=degrees), 0, 60, height)
    assert any("twirl" in acts for acts, _, _ in told(people)) == twirled
    if twirled:
        assert dance_beats(people)[0].acts == ("twirl", "")
        assert dance_beats(people[::-1])[0].acts == ("", "twirl")


def test_the_dance_goes_on_before_and_after_a_turn() -> None:
    still, turning = couple(60), joined(couple(60, turned=360), 0, 60, 1.9)
    found = told(np.concatenate([still, turning, still], axis=1))
    assert [acts for acts, *_ in found] == [("dance", "dance"), ("twirl", ""), ("dance", "dance")]
    assert all(a < b for _, a, b in found) and [a for _, a, _ in found][1:] == [b for _, _, b in found][:-1]


def texts(frames: int) -> tuple[str, str]:
    """BVH of two who march on the spot side by side 0.8 m apart, after a first frame elsewhere."""
    positions, rotations = (array[::4] for array in marching(4 * frames + 4))
    pair = []
    for side in (-0.4, 0.4):
        root = positions[:, 0] * [0, 1, 0] + np.array([side, 0, 0])
        root[0] += [0, 0, 5.0]
        pair.append(bvh_text(rotations, root, RIGS["cmu"]))
    return pair[0], pair[1]


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An archive of a take for training, a held-out one, and one half of a third."""
    root = tmp_path_factory.mktemp("data")
    (root / "cmu-salsa").mkdir()
    files = {"02_a": texts(20)[0]}
    for name, frames in (("01", 700), (HELD_OUT[0], 150)):
        files |= {f"{name}_{who}": text for who, text in zip("ab", texts(frames), strict=True)}
    with tarfile.open(root / "cmu-salsa" / "bvh.tar.xz", "w:xz") as packed:
        for name, text in files.items():
            entry = tarfile.TarInfo(f"bvh/{name}.bvh")
            entry.size = len(text.encode())
            packed.addfile(entry, io.BytesIO(text.encode()))
    return root


def test_takes_share_one_world_and_lose_their_first_frame(data: Path) -> None:
    takes = dict(read_takes(data))
    assert set(takes) == {"01", HELD_OUT[0]}
    people = takes["01"]
    assert people.shape == (2, 700, 22, 3)
    gap = np.linalg.norm(people[0, :, 0] - people[1, :, 0], axis=-1)
    np.testing.assert_allclose(gap, 0.8, atol=0.03)
    assert abs(people[0, 1, 0, 2] - people[0, 0, 0, 2]) < 0.2


def dancers(frames: int) -> np.ndarray:
    """Two who face each other and march on the spot."""
    body = marching(2 * frames)[0][::2]
    body = body - body[:, :1] * [1, 0, 1]
    return np.stack([body, turn(body, np.pi) + np.array([0, 0, 0.9])])


def test_windows_have_all_lengths_and_training_never_sees_a_test_frame() -> None:
    scenes = list(windows("01", dancers(900)))
    lengths = {round(seconds * 30) for seconds in SECONDS}
    assert {scene.positions.shape[1] for scene in scenes if scene.split == "train"} == lengths
    first, last = danced(dancers(900))
    tail = round(duets.TAIL * (last - first))
    ends = [scene for scene in scenes if scene.split == "test"]
    assert ends and all(scene.positions.shape[1] <= tail for scene in ends)
    assert {scene.sources for scene in ends} == {("cmu-salsa/01-end",)}
    assert {scene.sources for scene in scenes if scene.split == "train"} == {("cmu-salsa/01",)}
    held_out = list(windows(HELD_OUT[1], dancers(300)))
    assert {scene.split for scene in held_out} == {"test"}


def test_scenes_are_canonical_and_told_on_several_levels() -> None:
    people = turn(dancers(400), 1.0) + np.array([3.0, 0, 4.0])
    for scene in windows("01", people):
        np.testing.assert_allclose(scene.positions[0, 0, 0, [0, 2]], 0, atol=1e-5)
        assert abs(float(heading(scene.positions[0])[0])) < 0.05
        assert scene.label is not None and scene.label.plan.acts
        known = Label.model_validate(scene.label.row())
        assert all(0 <= a < b <= scene.positions.shape[1] for a, b in known.spans.values())
        assert len(scene.captions) >= 3 and all(scene.alone)
        assert not any("waltz" in text for text in [*scene.captions, *scene.alone[0], *scene.alone[1]])
    again = [scene.captions for scene in windows("01", people)]
    assert again == [scene.captions for scene in windows("01", people)]
