"""The thesis' protocol: every listed clip, in the data sets' own classes, only fitted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import scipy.io

from motion.skeleton import SBU15
from training.corpus import strict_pairs as strict
from training.corpus.sbu import KinectPair


def kinect(family: str, dataset: str, split: str = "train") -> KinectPair:
    return KinectPair(np.zeros((2, 4, 15, 3)), family, "s01s02/01/001", split, dataset, SBU15, 15.0, 0.0)


def test_approaching_and_departing_are_one_class_of_sbu_alone() -> None:
    assert strict.label_of(kinect("approach", "sbu")) == strict.label_of(kinect("depart", "sbu")) == "walking"
    assert strict.label_of(kinect("approach", "k3hi")) == "approach"
    assert strict.label_of(kinect("kick", "sbu")) == "kick"


def test_listed_clips_are_kept_however_bad_and_read_from_the_cache(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    clips = [kinect("approach", "sbu"), kinect("kick", "sbu", "benchmark"), kinect("kick", "sbu", "unlisted")]
    monkeypatch.setattr(strict, "read_sbu", lambda _: clips)
    monkeypatch.setattr(strict, "read_k3hi", lambda _: [])
    far_off = np.random.default_rng(0).normal(size=(2, 5, 22, 3))  # no body: the corpus would drop it
    monkeypatch.setattr(strict, "fit_pair", lambda _: (far_off, 9.0))
    found = strict.strict_pairs(tmp_path)
    assert [(pair.label, pair.test) for pair in found] == [("walking", False), ("kick", True)]
    assert (tmp_path / strict.CACHE).is_file()
    monkeypatch.setattr(strict, "fit_pair", lambda _: pytest.fail("fitted again"))
    again = strict.strict_pairs(tmp_path)
    for a, b in zip(found, again, strict=True):
        np.testing.assert_array_equal(a.positions, b.positions)
        assert (a.label, a.dataset, a.test, a.name) == (b.label, b.dataset, b.test, b.name)


def test_nothing_is_relabelled(tmp_path: Path) -> None:
    """Both people walk: the corpus calls it "meet", the data set "approaching"."""
    folder = tmp_path / "k3hi" / "Skeletons" / "approaching" / "001"
    folder.mkdir(parents=True)
    rest = np.array(
        [
            [0, 1.65, 0],
            [0, 1.45, 0],
            [0.2, 1.4, 0],
            [-0.2, 1.4, 0],
            [0.25, 1.1, 0],
            [-0.25, 1.1, 0],
            [0.27, 0.85, 0],
            [-0.27, 0.85, 0],
            [0, 1.2, 0],
            [0.1, 0.95, 0],
            [-0.1, 0.95, 0],
            [0.1, 0.5, 0],
            [-0.1, 0.5, 0],
            [0.1, 0.08, 0],
            [-0.1, 0.08, 0],
        ]
    )
    for letter, sign in (("A", 1), ("B", -1)):
        path = sign * np.linspace(1.5, 0.5, 40)[:, None, None] * np.array([1.0, 0, 0]) + rest + [0, 0, 3]
        x, y, z = path.transpose(2, 1, 0)
        stored = np.concatenate([(1280 - 1000 * x) / 2560, (960 - 1000 * y) / 1920, z * 0.78125])
        scipy.io.savemat(folder / f"skeleton_{letter}.mat", {"curve_B": stored})
    root = tmp_path / "k3hi"
    line = "Skeletons/approaching/001/skeleton_A.mat Skeletons/approaching/001/skeleton_B.mat\n"
    (root / "Test.txt").write_text(line)
    (root / "Train.txt").write_text("")
    from training.corpus.k3hi import read_k3hi

    (pair,) = read_k3hi(tmp_path)
    (found,) = strict._fitted_of([pair])
    assert found.label == "approach" and found.test
    gap = np.linalg.norm((found.positions[0] - found.positions[1])[:, 0], axis=-1)
    assert gap[0] - gap[-1] > 1.2
