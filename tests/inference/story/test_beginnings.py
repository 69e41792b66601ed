"""Places in which the words of a first beat have two people begin."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.inference.story.staged_words import beginning
from webdemo.inference.story.beginnings import BACKS
from webdemo.inference.story.floor import ABREAST
from webdemo.inference.story.poses import grounded


@pytest.mark.parametrize(
    "words",
    ["They practise tai chi side by side.", "Two strangers sit next to each other.", "A stands beside B."],
)
def test_those_beside_each_other_look_the_same_way(words: str) -> None:
    placed = beginning(words.replace("beside B", "beside person B"))
    assert placed is not None and abs(placed.gap() - ABREAST) < 1e-6
    assert placed.headings[0] == placed.headings[1] and placed.places[0, 1] == placed.places[1, 1]


@pytest.mark.parametrize(
    ("words", "seat"), [("They stand back to back.", None), ("sitting on the floor back to back", grounded)]
)
def test_those_back_to_back_have_their_backs_near_each_other(words: str, seat: object) -> None:
    placed = beginning(words)
    assert placed is not None
    assert math.cos(placed.headings[0] - placed.headings[1]) < -0.99
    assert callable(seat) or abs(placed.gap() - BACKS) < 1e-6
    if callable(seat):
        pelvises = [seat(placed.places[i], placed.headings[i])[0] for i in (0, 1)]
        assert abs(np.linalg.norm(pelvises[0] - pelvises[1]) - BACKS) < 0.05
        away = pelvises[0] - pelvises[1]
        assert away[2] * math.cos(placed.headings[0]) > 0, "each looks away from the other"


def test_other_words_leave_the_beginning_free() -> None:
    assert beginning("They shake hands.") is None
