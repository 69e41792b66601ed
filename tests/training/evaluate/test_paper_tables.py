"""The papers' tables of small trainings, on clips that take a moment to make."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import torch

from motion import InputError
from motion.transforms import turn
from tests.motion.bodies import marching
from training.core.loop import Loop
from training.corpus.strict_pairs import StrictPair
from training.evaluate.paper_tables import run, table
from training.evaluate.paper_tables.clips import scenes_of
from training.evaluate.paper_tables.run import TABLES, made_by, markdown
from training.trainers.bigraphdiff import Trainer as BiGraphDiff

POSITIONS, _ = marching(50)


@pytest.fixture(scope="module")
def pairs() -> list[StrictPair]:
    """Who is pushed goes back, who is kicked stays."""
    rng, found = np.random.default_rng(0), []
    for i in range(24):
        label, frames = ("kick", "push")[i % 2], 20 + i
        size, near = rng.uniform(0.8, 1.2), [rng.uniform(-0.5, 0.5), 0, rng.uniform(0.7, 1.3)]
        still = turn(POSITIONS[:1], rng.uniform(2, 4), np.zeros(3)) * rng.uniform(0.8, 1.2) + near
        away = np.linspace(0, 2.0 if i % 2 else 0.0, frames)[:, None, None] * [0, 0, 1.0]
        both = np.stack([POSITIONS[:frames] * size, still + away]).astype(np.float32)
        found.append(StrictPair(both, label, "sbu", i >= 18, f"pair/{i}"))
    return found


@pytest.mark.parametrize("name", TABLES)
def test_every_row_answers_every_test_clip_and_is_kept(
    name: str, pairs: list[StrictPair], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = TABLES[name]
    steps = (
        20 if name == "bigraphdiff" else 2
    )  # its batch norms must have seen some motion, or samples diverge
    made = {}
    for key, row in shown.rows.items():
        clips, took = made_by(shown, row, pairs, tmp_path, steps=steps, seed=0)
        wanted = [shown.seen(pair.positions).shape for pair in pairs if pair.test]
        assert [clip.shape for clip in clips] == wanted and took > 0
        assert all(np.isfinite(clip).all() for clip in clips)
        made[key] = [clips]
    assert set(shown.runs) == {row.run for row in shown.rows.values()}
    distinct = {clips[0].tobytes() for (clips,) in made.values()}
    assert len(distinct) == len(made)  # every row differs from every other

    def never(*_: object, **__: object) -> Loop:
        raise AssertionError("trained again")

    monkeypatch.setattr(type(shown), "trainer", never)
    again, _ = made_by(shown, next(iter(shown.rows.values())), pairs, tmp_path, steps=steps, seed=0)
    np.testing.assert_array_equal(again[0], next(iter(made.values()))[0][0])
    with pytest.raises(InputError, match=f"after {steps} steps"):
        made_by(shown, next(iter(shown.rows.values())), pairs, tmp_path, steps=steps + 1, seed=0)

    found = table.scores(shown, pairs, made, classifiers=2, epochs=2)
    assert set(found) == {"SBU"} and set(found["SBU"]) == {"recorded", *shown.rows}
    assert len(found["SBU"]["recorded"]["fvd"]) == 2
    assert found["SBU"]["recorded"]["fvd"] == [pytest.approx(0, abs=1e-3)] * 2
    page = markdown(shown, found, {})
    assert page.count("\n") == 3 + len(shown.rows)
    assert len({line.count("|") for line in page.splitlines()}) == 1


def test_what_diverges_is_refused(
    pairs: list[StrictPair], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = TABLES["interformer"]
    monkeypatch.setattr(type(shown), "make", lambda *_, **__: [np.full((9, 45), np.nan)])
    with pytest.raises(InputError, match="diverges: train longer"):
        made_by(shown, shown.rows["s1"], pairs, tmp_path, steps=1, seed=0)
    assert not list(tmp_path.rglob("*.npz"))


def test_a_training_that_stopped_goes_on(pairs: list[StrictPair], tmp_path: Path) -> None:
    shown = TABLES["interformer"]
    whole = shown.trainer(pairs, "s4", tmp_path / "whole", steps=4, seed=1)
    assert len(list(whole.run(minutes=9))) == 4
    begun = shown.trainer(pairs, "s4", tmp_path / "halves", steps=4, seed=1)
    begun.train_step()
    begun.save()
    resumed = shown.trainer(pairs, "s4", tmp_path / "halves", steps=4, seed=1)
    assert resumed.step == 1 and len(list(resumed.run(minutes=9))) == 3
    for a, b in zip(whole.model.parameters(), resumed.model.parameters(), strict=True):
        torch.testing.assert_close(a, b, rtol=0, atol=0)


def test_a_deterministic_network_sees_its_class_alone(pairs: list[StrictPair], tmp_path: Path) -> None:
    shown = TABLES["bigraphdiff"]
    trainer = shown.trainer(pairs, "s1", tmp_path, steps=2, seed=0)
    assert isinstance(trainer, BiGraphDiff)
    list(trainer.run(minutes=9))
    tests = [pair for pair in pairs if pair.test]
    one, other = (shown.make(trainer, shown.rows["s1"], tests, seed=seed) for seed in (0, 1))
    np.testing.assert_array_equal(one[0], other[0])


def test_roles_are_swapped_where_told(pairs: list[StrictPair]) -> None:
    from models.motion_tokens import TokenLayout, decode

    layout = TokenLayout(4, 1)
    plain, swapped = (scenes_of(pairs[1:2], layout, swap=swap) for swap in ((), (True,)))
    assert plain.rows[0]["class"] == "sbu: push" and plain.rows[0]["captions"]

    def gone(scenes: object, person: int) -> float:
        positions = decode(scenes.scene(scenes.rows[0]), layout)[0][person]  # type: ignore[attr-defined]
        return float((positions[-1, 0] - positions[0, 0]).norm())

    assert gone(plain, 1) > 1 > gone(plain, 0)
    assert gone(swapped, 0) > 1 > gone(swapped, 1)


def test_the_command_writes_its_table(
    pairs: list[StrictPair],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    given: Callable[..., list[StrictPair]] = lambda *_: pairs  # noqa: E731
    monkeypatch.setattr(run, "strict_pairs", given)
    monkeypatch.setattr(run, "scores", partial(run.scores, epochs=1))
    given_options = [
        "interformer",
        "--data",
        "nowhere",
        "--out",
        str(tmp_path),
        "--steps",
        "1",
        "--seeds",
        "2",
    ]
    assert run.main([*given_options, "--rows", "s1", "s4"]) == 0
    page = (tmp_path / "interformer" / "table.md").read_text()
    assert (
        "Steps: 1; trainings of each network: 2; classifiers: 2." in page
        and "| S1: Transformer |" in page
        and "| 80.0 |" in page
    )
    kept = json.loads((tmp_path / "interformer" / "scores.json").read_text())
    assert len(kept["scores"]["SBU"]["s4"]["accuracy"]) == 4
    assert run.main([*given_options, "--rows", "s9"]) == 2
    assert "no row 's9'" in capsys.readouterr().err
