"""The map of predicted motions: t-SNE keeps neighbours, distances are the thesis', and the command draws."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from training.corpus import cmu
from training.evaluate import prediction_map
from training.evaluate.prediction_map import chosen_windows, motion_distances, same_action
from training.evaluate.tsne import embedded, neighbours


def squares_of(points: np.ndarray) -> np.ndarray:
    return np.square(points[:, None] - points[None]).sum(-1)


def test_every_point_has_the_wanted_number_of_neighbours() -> None:
    found = neighbours(squares_of(np.random.default_rng(0).normal(size=(60, 4)) * [1, 1, 1, 30]), 10.0)
    np.testing.assert_allclose(found, found.T)
    assert found.sum() == pytest.approx(1) and not found.diagonal().any()
    line = neighbours(squares_of(np.arange(60.0)[:, None]), 10.0)
    shares = line[30] / line[30].sum()
    assert np.exp(-(shares * np.log(np.maximum(shares, 1e-300))).sum()) == pytest.approx(10, rel=0.05)


def test_groups_stay_groups_on_the_map() -> None:
    rng = np.random.default_rng(1)
    groups = np.repeat([0, 1, 2], 25)
    points = 8 * rng.normal(size=(3, 10))[groups] + rng.normal(size=(75, 10))
    places = embedded(squares_of(points), perplexity=10, steps=400)
    nearest = (squares_of(places) + np.diag(np.full(75, np.inf))).argmin(1)
    assert (groups[nearest] == groups).all()
    np.testing.assert_array_equal(places, embedded(squares_of(points), perplexity=10, steps=400))


def test_the_distance_of_motions_sees_no_turn_of_the_body() -> None:
    rng = np.random.default_rng(2)
    motions = rng.normal(size=(20, 3, 17, 3))
    motions[1] = motions[0] @ Rotation.random(rng=rng).as_matrix()
    found = motion_distances(motions, rows=8)
    assert found[0, 1] < 1e-4 < 1 < found[0, 2] == found[2, 0]


def test_a_motion_is_not_its_own_nearest() -> None:
    distances = squares_of(np.array([[0.0], [1], [9], [10]]))
    assert same_action(distances, np.array(["a", "a", "b", "b"])) == 1
    assert same_action(distances, np.array(["a", "b", "a", "b"])) == 0


def test_windows_are_taken_evenly_from_the_papers_actions(monkeypatch: pytest.MonkeyPatch) -> None:
    clip = np.arange(100.0)[:, None, None] * np.ones((100, 17, 3))
    actions = {"walking": [clip], "walking_extra": [clip], "running": [clip[:30]]}
    monkeypatch.setattr(cmu, "read_actions", lambda data, split: actions)
    found = chosen_windows(Path(), 3)
    assert list(found) == ["walking"] and found["walking"][:, 0, 0, 0].tolist() == [0, 12, 25]


def test_the_command_draws_and_refuses_in_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    rng = np.random.default_rng(3)
    swaying = np.sin(rng.uniform(0, 3, size=(2, 110, 17, 3)) * 0.1 + np.arange(110)[:, None, None] / 9)
    monkeypatch.setattr(
        cmu,
        "read_actions",
        lambda data, split: dict(zip(("running", "soccer"), swaying[:, None], strict=True)),
    )
    given = ["--data", str(tmp_path), "--windows", "35", "--out"]
    assert prediction_map.main([*given, str(tmp_path / "map.svg")]) == 0
    assert "running 35, soccer 35" in capsys.readouterr().out
    assert "<svg" in (tmp_path / "map.svg").read_text()
    assert prediction_map.main([*given, str(tmp_path / "map.txt")]) == 2
    assert "is no picture" in capsys.readouterr().err
    assert prediction_map.main([*given, str(tmp_path / "map.png"), "--windows", "5"]) == 2
    assert "says nothing" in capsys.readouterr().err
