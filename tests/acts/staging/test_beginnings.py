"""Places in which the words of a first beat have two people begin."""

from __future__ import annotations

import math

import numpy as np
import pytest

from acts.staging.beginnings import BACKS
from acts.staging.floor import ABREAST
from acts.staging.poses import posed
from motion import SMPL22

from .staged_words import beginning


@pytest.mark.parametrize(
    "words", ["They practise tai chi side by side.", "Two strangers sit next to each other.", "A stands beside B."]
)
def test_those_beside_each_other_look_the_same_way(words: str) -> None:
    placed = beginning(words.replace("beside B", "beside person B"))
    assert placed is not None and abs(placed.gap() - ABREAST) < 1e-6
    assert placed.headings[0] == placed.headings[1] and placed.places[0, 1] == placed.places[1, 1]


@pytest.mark.parametrize(
    ("words", "pose"),
    [("They stand back to back.", "stands"), ("sitting on the floor back to back", "sits on the ground")],
)
def test_those_back_to_back_touch_with_their_backs(words: str, pose: str) -> None:
    placed = beginning(words)
    assert placed is not None
    assert math.cos(placed.headings[0] - placed.headings[1]) < -0.99
    a, b = (posed(pose, placed.places[i], placed.headings[i]) for i in (0, 1))
    assert abs(np.linalg.norm(a[0] - b[0]) - BACKS) < 0.05
    assert (a[0] - b[0])[2] * math.cos(placed.headings[0]) > 0, "each looks away from the other"
    spines = [SMPL22.index(name) for name in ("spine1", "spine2", "spine3")]
    gap = np.linalg.norm(a[spines] - b[spines], axis=1).min()
    assert 0.22 < gap < 0.3, "a trunk is 24 cm thick"


def test_other_words_leave_the_beginning_free() -> None:
    assert beginning("They shake hands.") is None
