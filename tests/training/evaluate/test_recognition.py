"""What the recogniser sees in each row of the thesis' Table 5.2."""

from __future__ import annotations

import numpy as np
import pytest

from models.agent.recogniser import FRAMES, OBSERVED
from tests.motion.bodies import marching
from training.corpus.strict_pairs import StrictPair
from training.evaluate import recognition
from training.trainers.recogniser import GESTURES

POSITIONS, _ = marching(100)


def clip(label: str, dataset: str = "k3hi", name: str = "kicking/001", frames: int = 100) -> StrictPair:
    people = np.stack([POSITIONS[:frames], POSITIONS[:frames]]).astype(np.float32)
    return StrictPair(people, label, dataset, False, name)


def test_gestures_are_those_of_the_agent() -> None:
    names = list(GESTURES)
    assert names[recognition.gesture_of(clip("handshake"))] == "shake hands"
    assert names[recognition.gesture_of(clip("walking", "sbu", "s01s02/02/001"))] == "walk away"


def test_one_second_hides_the_rest() -> None:
    people = recognition.windows([clip("kick")], [0])
    assert people.shape == (1, 90, 22, 3)
    later = people.copy()
    later[:, OBSERVED:] += 1.0
    one = recognition.as_seen(people, recognition.known)
    assert one.shape == (1, FRAMES, 22, 3)
    np.testing.assert_array_equal(one, recognition.as_seen(later, recognition.known))
    assert not np.array_equal(one, recognition.as_seen(people, lambda p: p))


def test_a_predictor_sees_the_first_second_alone() -> None:
    class Moves:
        def predict(self, past: np.ndarray, frames: int) -> np.ndarray:
            assert past.shape == (1, OBSERVED, 22, 3)
            return np.repeat(past[:, -1:], frames, axis=1) + 0.5

    people = recognition.windows([clip("kick")], [0])
    made = recognition.predicted(Moves())(people)
    np.testing.assert_array_equal(made[:, :OBSERVED], people[:, :OBSERVED])
    np.testing.assert_allclose(made[:, OBSERVED:] - people[:, OBSERVED - 1 : OBSERVED], 0.5)


def test_a_short_clip_holds_its_last_pose() -> None:
    (people,) = recognition.windows([clip("kick", frames=40)], [3])
    np.testing.assert_allclose(people[36], POSITIONS[39], atol=1e-6)
    np.testing.assert_array_equal(people[-1], people[36])


def test_scores_come_from_the_test_clips(monkeypatch: pytest.MonkeyPatch) -> None:
    train = [clip("kick"), clip("kick")]
    right = recognition.score(train, [clip("kick")], recognition.known, seeds=1, steps=8)
    wrong = recognition.score(train, [clip("push")], recognition.known, seeds=1, steps=8)
    assert right["K3HI"] == right["both"] == [1.0] and wrong["both"] == [0.0]
    shown = recognition.table({"1 s recorded": {"both": [0.5, 0.7]}}, {"both": 2})
    assert "| 1 s recorded | 60.0 ± 127.1 | 47.7 |" in shown
