"""The scores of reactions: a classifier that learns, and distances that say what they should."""

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion import SMPL22
from tests.motion.bodies import marching
from training.corpus.pairs import Pair
from training.evaluate.deep_gru import accuracy, deep_features, diversity_score, fit
from training.evaluate.reactions import (
    METHODS,
    Reaction,
    _is_installed,
    drafted,
    label_of,
    long_enough,
    reacted,
    readouts,
    recorded,
    score,
    table,
    zero_velocity,
)
from webdemo.inference import Engine
from webdemo.inference.methods import WEIGHTS
from webdemo.inference.pipelines.nearest import Bank


def clips(count: int, seed: int) -> tuple[list[np.ndarray], list[int]]:
    """Clips of two classes: numbers that rise, numbers that swing."""
    rng = np.random.default_rng(seed)
    found = []
    for i in range(count):
        time = np.linspace(0, 1, int(rng.integers(12, 20)))[:, None]
        path = time if i % 2 else np.sin(9 * time)
        found.append(path * np.ones(6) + rng.normal(0, 0.05, (len(time), 6)))
    return found, [i % 2 for i in range(count)]


def test_the_classifier_learns_and_is_the_same_for_a_seed() -> None:
    known, labels = clips(40, 0)
    unseen, wanted = clips(20, 1)
    assert accuracy(fit(known, labels, seed=3, epochs=15), unseen, wanted) > 0.9
    first, again, other = (
        deep_features(fit(known[:8], labels[:8], seed=seed, epochs=2), unseen[:4]) for seed in (3, 3, 4)
    )
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)


def test_diversity_is_a_percentage_of_the_recorded_spread() -> None:
    real = np.array([[0.0, 0], [3, 4]])
    assert diversity_score(real, 2 * real) == pytest.approx(100)
    assert diversity_score(real, 0.5 * real) == pytest.approx(50)
    assert diversity_score(10 * real, 5 * real) == pytest.approx(50)


def test_the_table_holds_every_method(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("training.evaluate.reactions.fit", partial(fit, epochs=2))  # how well is another test
    rng = np.random.default_rng(0)
    people = [rng.normal(size=(2, 40, 22, 3)) for _ in range(12)]
    pairs = [Reaction(one + 3 * (i % 2), i % 2) for i, one in enumerate(people)]
    still = [zero_velocity(pair) for pair in pairs]
    assert (np.diff(still[0], axis=0) == 0).all()
    found = score(pairs, pairs, {"Zero velocity": [still]}, seeds=2)
    assert set(found) == {"Recorded", "Zero velocity"}
    assert len(found["Zero velocity"]["fvd"]) == 2
    shown = readouts(pairs, still)
    assert readouts(pairs, [one + 100.0 for one in still])["contact_due"] == 0
    assert readouts(pairs, [pair.people[1] for pair in pairs])["contact_due"] == 100
    counts = {"train": 12, "test": 12, "classes": ["a", "b"]}
    text = table({"sbu": {**counts, "scores": found, "readouts": dict.fromkeys(found, shown)}})
    row = next(line for line in text.splitlines() if line.startswith("| Zero velocity |"))
    assert "| Contact s |" in text and row.count("|") == text.splitlines()[2].count("|")
    assert "SBU: 12 training" in text


def walking(way: float, frames: int = 40) -> np.ndarray:
    """An actor who goes along X by ``way`` metres, and a reactor who goes half as far along Z."""
    rest, time = marching(2)[0][0], np.linspace(0, 1, frames)[:, None, None]
    actor = rest + time * np.array([way, 0, 0])
    return np.stack([actor, rest + np.array([0, 0, 1.0]) + time * np.array([0, 0, way / 2])])


def test_the_nearest_reaction_begins_in_the_given_pose_and_the_reaction_is_not_looked_at() -> None:
    bank = Bank([walking(0.0), walking(1.0), walking(-1.0)])
    asked = walking(0.9, frames=25)
    asked[1] += np.array([0.05, 0, 0])  # stands elsewhere: the reaction begins there
    made = drafted(bank, asked)
    assert made.shape == (25, 22, 3)
    np.testing.assert_allclose(made[0], asked[1, 0], atol=1e-12)
    np.testing.assert_allclose((made[-1] - made[0])[:, 2], 0.5, atol=1e-6)  # that of the pair that goes 1 m
    asked[1, 1:] += 3.0
    np.testing.assert_array_equal(drafted(bank, asked), made)


@pytest.mark.parametrize(("frames", "wanted"), [(12, 31), (50, 50)])
def test_short_clips_hold_their_last_poses(frames: int, wanted: int) -> None:
    people = walking(1.0, frames)
    found = long_enough(people)
    assert found.shape[1] == wanted
    np.testing.assert_array_equal(found[:, :frames], people)
    np.testing.assert_array_equal(found[:, -1], people[:, -1])


def test_every_method_answers_and_is_told_the_class_or_the_first_pose_where_its_name_says_so(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []
    run = Engine.run

    def listening(engine: Engine, request: Any) -> Any:
        asked.append(request)
        return run(engine, request)

    monkeypatch.setattr(Engine, "run", listening)
    person = (SMPL22.rest_positions() + np.array([0, 0.98, 0]))[None].repeat(45, axis=0)
    pair, engine = Reaction(np.stack([person, person * [-1, 1, -1] + [0, 0, 1.2]]), 1), Engine()
    for method in METHODS:
        made = reacted(engine, pair, ["kick", "push"], 3, method)
        assert made.shape == (45, 22, 3) and np.isfinite(made).all(), method
        assert asked[-1].prompt == ("One person pushes the other." if "class told" in method else "")
        assert (asked[-1].first_pose is not None) == ("first pose given" in method or "Nearest" in method)


def test_all_listed_clips_count_and_approaching_and_departing_are_one_class_of_sbu_alone() -> None:
    people = np.zeros((2, 9, 22, 3))
    pairs = [
        Pair(people, family, "sbu", "x", test, 0.0)
        for family in ("approach", "depart", "kick")
        for test in (False, True)
    ]
    train, test, classes = recorded(pairs)
    assert classes == ["kick", "walking"] and [len(train), len(test)] == [3, 3]
    assert [reaction.label for reaction in test] == [1, 1, 0]
    assert label_of(Pair(people, "approach", "k3hi", "x", False, 0.0)) == "approach"


def test_methods_whose_weights_are_not_all_there_are_left_out(tmp_path: Path) -> None:
    assert _is_installed("regennet", WEIGHTS) and _is_installed("nearest", WEIGHTS)
    (tmp_path / "nearest").symlink_to(WEIGHTS / "nearest")
    assert not _is_installed("nearest", tmp_path), "it needs another"
