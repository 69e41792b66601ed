"""The nearest recorded reaction, from the shipped recordings and from a folder of one's own."""

from pathlib import Path

import numpy as np
import pytest

from motion import Duet, InputError
from motion.formats import write
from webdemo.inference import Engine, ReactRequest, Result
from webdemo.inference.built_in import REACTIONS_VARIABLE

from .people import waver


def folder_of(folder: Path) -> Path:
    """A folder with a waver who is answered by somebody raised, and one who stands and is answered by one aside."""
    one = waver().positions.astype(np.float64)
    for name, actor, off in (("waves", one, [0.5, 0.2, 1.5]), ("stands", one[:1].repeat(60, axis=0), [2.0, 0.0, 0.0])):
        people = np.stack([actor, one + off]).astype(np.float32)
        write(Duet.from_positions(people, fps=30.0), folder / f"{name}.npz")
    return folder


def reaction(engine: Engine, **fields: object) -> Duet:
    request = ReactRequest(actor=waver(), model="nearest", cleanup=False, **fields)  # type: ignore[arg-type]
    *_, result = engine.run(request)
    assert isinstance(result, Result) and isinstance(result.duets[-1], Duet)
    return result.duets[-1]


def test_an_actor_who_is_in_the_folder_gets_the_recorded_answer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(REACTIONS_VARIABLE, str(folder_of(tmp_path)))
    engine, expected = Engine(), np.add(waver().positions, [0.5, 0.2, 1.5])
    np.testing.assert_allclose(reaction(engine).b.positions, expected, atol=0.06)
    second = reaction(engine, samples=2)  # the next nearest
    np.testing.assert_allclose(second.b.positions, np.add(waver().positions, [2.0, 0.0, 0.0]), atol=0.06)
    pose = waver().positions[0] + [0.4, 0.0, 1.7]
    begun = reaction(engine, first_pose=pose).b.positions
    np.testing.assert_allclose(begun[0], pose, atol=1e-4)
    np.testing.assert_allclose(begun, expected + (pose - expected[0]), atol=0.06)


def test_a_longer_actor_is_answered_part_by_part_without_a_jump() -> None:
    request = ReactRequest(actor=waver(9.0), model="nearest")
    *_, result = Engine().run(request)
    person = result.duets[0].b.positions
    assert len(person) == 270
    steps = np.linalg.norm(np.diff(person, axis=0), axis=-1).max(axis=-1)
    assert steps[[89, 179]].max() < 2 * np.percentile(steps, 99)


def test_a_folder_without_pairs_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(REACTIONS_VARIABLE, str(tmp_path))
    with pytest.raises(InputError, match=r"holds no \.npz of two people"):
        Engine().pipeline("nearest")
