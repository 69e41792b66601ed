"""The nearest recorded reaction: chosen and warped by the actor's tempo, finished by InterGen."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion import Clip, Duet, InputError
from motion.formats import write
from webdemo.inference import Engine, ReactRequest, Result
from webdemo.inference.built_in import REACTIONS_VARIABLE
from webdemo.inference.pipelines.nearest import WARPS, Bank

from .people import waver


def folder_of(folder: Path) -> Path:
    """A folder with a waver who is answered by another, and one who stands and is answered by one aside."""
    one = waver().positions.astype(np.float64)
    for name, actor, off in (("waves", one, [0.5, 0.0, 1.5]), ("stands", one[:1].repeat(60, axis=0), [2.0, 0.0, 0.0])):
        people = np.stack([actor, one + off]).astype(np.float32)
        write(Duet.from_positions(people, fps=30.0), folder / f"{name}.npz")
    return folder


def reaction(engine: Engine, actor: Clip | None = None, **fields: object) -> Duet:
    request = ReactRequest(actor=actor or waver(), model="nearest", **fields)  # type: ignore[arg-type]
    *_, result = engine.run(request)
    assert isinstance(result, Result) and isinstance(result.duets[-1], Duet)
    return result.duets[-1]


def apart(person: np.ndarray, other: np.ndarray) -> float:
    """Mean metres between the joints of two motions."""
    return float(np.linalg.norm(person - other, axis=-1).mean())


def test_an_actor_who_is_in_the_folder_gets_the_recorded_answer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(REACTIONS_VARIABLE, str(folder_of(tmp_path)))
    engine, expected = Engine(), np.add(waver().positions, [0.5, 0.0, 1.5])
    assert apart(reaction(engine).b.positions, expected) < 0.1
    second = reaction(engine, samples=2)  # the next nearest
    assert apart(second.b.positions, np.add(waver().positions, [2.0, 0.0, 0.0])) < 0.1
    pose = waver().positions[0] + [0.4, 0.0, 1.7]
    begun = reaction(engine, first_pose=pose, cleanup=False).b.positions
    np.testing.assert_allclose(begun[0], pose, atol=1e-4)
    assert apart(begun, expected + (pose - expected[0])) < 0.1


def test_warps_rise_and_no_third_is_over_twice_as_fast_or_slow() -> None:
    assert (np.diff(WARPS(np.linspace(0, 1, 91))) > 0).all()
    tempo = 3 * np.diff(WARPS(np.linspace(0, 1, 4)))
    assert tempo.min() > 0.49 and tempo.max() < 2.01


@pytest.mark.parametrize("share", [0.35, 0.65])
def test_the_example_follows_the_actors_tempo(share: float) -> None:
    """An actor who takes this share of the time for the first half of what the example's does."""
    steady = waver().positions.astype(np.float64)
    bank = Bank([np.stack([steady, np.add(steady, [0.0, 0.0, 1.5])])])
    late = np.interp(np.linspace(0, 1, 60), [0, share, 1], [0, 29.5, 59])
    _, moments = bank.answers(steady[np.rint(late).astype(int)])[0]
    assert np.abs(moments - late).mean() < 0.4 * np.abs(np.arange(60) - late).mean()  # which is that of no warp


@pytest.mark.parametrize("along", [0.0, 1.0])
def test_who_went_along_with_the_recorded_actor_goes_along_with_this_one(along: float) -> None:
    steady = waver().positions[:1].astype(np.float64).repeat(60, axis=0)
    way = np.linspace(0, 1, 60)[:, None, None] * [1.0, 0.0, 0.0]
    bank = Bank([np.stack([steady + way, np.add(steady + along * way, [0.0, 0.0, 1.0])])])
    made = bank.reactor(0, np.arange(60.0), steady + 1.6 * way)
    np.testing.assert_allclose(made[-1, 0] - made[0, 0], [1.6 * along, 0, 0], atol=0.1)


def test_the_network_finishes_the_example() -> None:
    steady = waver().positions.astype(np.float64)
    engine = Engine()
    floating: Any = engine.pipeline("nearest")
    floating.bank = Bank([np.stack([steady, np.add(steady, [0.0, 0.2, 1.5])])])
    made = reaction(engine, cleanup=False)
    assert np.median(made.b.positions[..., 1].min(axis=1)) < 0.1  # on the floor
    np.testing.assert_array_equal(made.a.positions, waver().positions)


def test_a_longer_actor_is_answered_part_by_part_without_a_jump() -> None:
    person = reaction(Engine(), waver(11.0)).b.positions
    assert len(person) == 330
    steps = np.linalg.norm(np.diff(person, axis=0), axis=-1).max(axis=-1)
    assert steps.max() < 3 * np.percentile(steps, 95)


def test_a_folder_without_pairs_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(REACTIONS_VARIABLE, str(tmp_path))
    with pytest.raises(InputError, match=r"holds no \.npz of two people"):
        Engine().pipeline("nearest")
