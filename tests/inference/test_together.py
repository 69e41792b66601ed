"""Futures of two people who know of each other."""

from __future__ import annotations

import numpy as np
import pytest

from motion import Duet, InputError
from motion.formats import read
from webdemo.inference import Engine, PredictRequest, PredictResult
from webdemo.ui.text.examples import example_clips

MODEL = "intergen-together"


@pytest.fixture(scope="module")
def pair() -> Duet:
    found = next(read(path) for _, path in example_clips() if isinstance(read(path), Duet))
    assert isinstance(found, Duet)
    return found


def futures(shipped: Engine, motion: Duet, **asked: object) -> PredictResult:
    request = PredictRequest(**{"motion": motion, "marker": 1.5, "seconds": 1.0, "model": MODEL} | asked)
    (result,) = (event for event in shipped.run(request) if isinstance(event, PredictResult))
    return result


def test_three_futures_follow_one_past(shipped: Engine, pair: Duet) -> None:
    result = futures(shipped, pair)
    made = np.stack([duet.positions for duet in result.duets])
    assert made.shape[:3] == (3, 2, 75) and result.past_frames == 45
    np.testing.assert_array_equal(made[:, :, :45], np.repeat(made[:1, :, :45], 3, axis=0))
    np.testing.assert_allclose(made[0, :, :45], result.given.positions[:, :45], atol=1e-6)
    steps = np.linalg.norm(np.diff(made[:, :, 43:], axis=2), axis=-1)
    assert steps.max() < 0.2  # no joint jumps where the future begins, or after
    for one in range(3):
        assert np.abs(made[one] - made[one - 1])[:, 45:].max() > 0.02
    truth = result.truth
    assert isinstance(truth, Duet)
    off = np.linalg.norm(made[:, :, 45:] - truth.positions, axis=-1).mean(axis=(0, 1, 3))
    np.testing.assert_allclose(result.error, 1000 * off, atol=0.1)


def test_a_seed_names_the_futures(shipped: Engine, pair: Duet) -> None:
    first, again, other = (futures(shipped, pair, seed=seed) for seed in (0, 0, 7))
    assert first.duets[1].positions.tobytes() == again.duets[1].positions.tobytes()
    assert np.abs(first.duets[1].positions - other.duets[1].positions).max() > 0.02


def test_each_knows_of_the_other(shipped: Engine, pair: Duet) -> None:
    moved = pair.positions.copy()
    moved[1, :, :, 0] += 1.0
    here, there = futures(shipped, pair), futures(shipped, pair.with_positions(moved))
    assert np.abs(here.duets[0].positions[0] - there.duets[0].positions[0])[45:].max() > 0.01


def test_one_person_is_refused(pair: Duet) -> None:
    with pytest.raises(InputError, match="continues two people"):
        PredictRequest(motion=pair.a, model=MODEL)
