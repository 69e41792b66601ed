"""CMU MoCap: kinematics against reference positions, windows, and the table's arithmetic."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from models.predictors import load_predictor
from motion import InputError
from training.corpus import cmu
from training.evaluate.prediction import evaluate, markdown, of_predictor, put_into, score, zero_velocity
from webdemo.inference.method import WEIGHTS

REFERENCE = Path(__file__).parents[2] / "data" / "reference"
SKELETON = REFERENCE / "cmu_skeleton.json"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A data set of one test action: 160 frames of a person who moves arms and legs."""
    shutil.copy(SKELETON, tmp_path / "skeleton.json")
    rng = np.random.default_rng(0)
    frames = np.cumsum(rng.normal(scale=0.01, size=(161, cmu.CHANNELS)), axis=0)
    path = tmp_path / "test" / "walking" / "walking_1.txt"
    path.parent.mkdir(parents=True)
    np.savetxt(path, frames, delimiter=",")
    return tmp_path


def test_forward_kinematics_equal_the_reference() -> None:
    with np.load(REFERENCE / "cmu_forward_kinematics.npz", allow_pickle=False) as arrays:
        expmap, expected = arrays["expmap"].astype(np.float64), arrays["positions_mm"]
    found = cmu.CmuSkeleton.read(SKELETON).forward_kinematics(expmap)
    assert np.abs(found - expected / 1000).max() < 1e-6


def test_every_second_frame_is_kept(folder: Path) -> None:
    (clip,) = cmu.read_actions(folder, "test")["walking"]
    both = cmu.read_actions(folder, "test", phases=True)["walking"]
    assert clip.shape == (80, 17, 3)
    assert [len(c) for c in both] == [80, 80] and np.array_equal(both[0], clip)
    assert not np.array_equal(both[1], clip)
    windows = cmu.windows([clip, clip[:74]])
    assert windows.shape == (6, 75, 17, 3) and np.array_equal(windows[3], clip[3:78])


def test_zero_velocity_is_the_distance_from_the_last_pose(folder: Path) -> None:
    (clip,) = cmu.read_actions(folder, "test")["walking"]
    scores = score(zero_velocity(cmu.FUTURE), cmu.windows([clip]), cmu.PAST, batch=4)
    expected = [np.linalg.norm(clip[i + 59] - clip[i + 49], axis=-1).mean() for i in range(6)]
    assert scores.error[9] == pytest.approx(1000 * np.mean(expected), rel=1e-5)
    assert scores.seam == 1.0 and scores.speed.max() == 0.0 and scores.true_speed.min() > 0


def test_table_goes_between_the_marks(folder: Path, tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    begin, end = "<!-- other -->\n", "<!-- end of other -->\n"
    page.write_text(f"<!-- table -->\n<!-- end of table -->\nBefore\n{begin}old\n{end}After\n")
    table = markdown(evaluate(folder, []))
    put_into(page, table, name="other")
    assert page.read_text().endswith(f"-->\nBefore\n{begin}\n{table}\n{end}After\n")
    put_into(tmp_path / "new.md", table)
    assert (tmp_path / "new.md").read_text() == f"<!-- table -->\n\n{table}\n<!-- end of table -->\n"
    assert "| walking (6) | zero velocity |" in table and "1.00" in table
    (tmp_path / "bare.md").write_text("no marks")
    with pytest.raises(InputError, match="lacks the lines"):
        put_into(tmp_path / "bare.md", table)


@pytest.mark.parametrize("name", ["mawgan-cmu", "motion-mlp-cmu"])
def test_the_shipped_networks_of_the_table_predict_swinging_arms_and_legs(name: str) -> None:
    """A made-up walk on the spot, which is in no file: nearer than the held pose, and no jump at the seam."""
    skeleton = cmu.CmuSkeleton.read(SKELETON)
    phase = 2 * np.pi * np.arange(cmu.WINDOW) / 60
    frames = np.zeros((cmu.WINDOW, cmu.CHANNELS))
    for place, size, behind in ((1, 0.45, 0), (4, 0.45, np.pi), (11, 0.3, np.pi), (14, 0.3, 0)):
        frames[:, skeleton.channels[skeleton.kept[place]][0]] = size * np.sin(phase + behind)
    windows = skeleton.forward_kinematics(frames)[None, :, skeleton.kept].astype(np.float32)
    found = score(of_predictor(load_predictor(WEIGHTS / name)), windows, cmu.PAST)
    held = score(zero_velocity(cmu.FUTURE), windows, cmu.PAST)
    ahead = np.array(cmu.HORIZONS) - 1
    assert np.all(found.error[ahead] < 0.9 * held.error[ahead])
    assert found.speed[:10].sum() > 0.7 * found.true_speed[:10].sum() and found.seam == 1
