"""Shapes of hands by contact, by act and by what is held."""

from __future__ import annotations

import numpy as np
import pytest

from acts import Act, Plan
from acts.things.furnishing import furnish
from motion import Duet
from motion.hands import SHAPES, Grip, angles

from .furnishing import FPS, FRAMES, GAP, act, put_hand, reaching, standing, worded


def grips(people: np.ndarray, *acts: Act, sentence: str = "") -> tuple[Grip, ...]:
    duet = Duet.from_positions(people.astype(np.float32), fps=FPS)
    plans = [(Plan(sentence=sentence, acts=acts), 0, None, None)] if acts else []
    return furnish(duet, plans, ()).grips


def shapes_at(found: tuple[Grip, ...], person: int, side: str, frame: int) -> list[str]:
    """Names of the shapes that a hand is near to at a frame."""
    now = angles(found, person, np.array([float(frame)]), FPS)[0, ("left", "right").index(side)]
    return [name for name, shape in SHAPES.items() if np.abs(now - shape).max() < 1e-6]


def test_hands_are_relaxed_where_nothing_touches_and_nothing_is_done():
    assert grips(standing()) == ()


def test_palms_that_meet_clasp_each_other_and_let_go():
    found = grips(reaching())
    for person in (0, 1):
        assert shapes_at(found, person, "right", 60) == ["clasp"]
        assert shapes_at(found, person, "right", 10) == ["relaxed"] == shapes_at(found, person, "left", 60)


def test_the_acts_shape_comes_before_that_of_the_contact():
    found = grips(reaching(), act("fist-bump", "ab"))
    assert shapes_at(found, 0, "right", 60) == ["fist"]


def test_a_hand_on_the_others_shoulder_is_flat():
    people = standing()
    put_hand(people[0], "right", np.array([-0.12, 1.45, GAP - 0.2]))
    assert shapes_at(grips(people), 0, "right", 60) == ["flat"]


def test_a_hand_that_points_points_while_it_does():
    people = standing()
    raised = ((np.arange(FRAMES) > 40) & (np.arange(FRAMES) < 100))[:, None]
    put_hand(people[0], "right", np.where(raised, [-0.2, 1.4, 0.62], [-0.22, 0.9, 0.12]))
    found = grips(people, act("point", patient="b"))
    assert shapes_at(found, 0, "right", 70) == ["point"]
    assert shapes_at(found, 0, "right", 10) == ["relaxed"]


def test_thumbs_up_are_read_from_the_words():
    one, sentence = worded("She gives a thumbs up.", "gesture-about")
    found = grips(standing(), one, sentence=sentence)
    assert "thumbs up" in {grip.shape for grip in found}


@pytest.mark.parametrize(("thing", "shape"), [("cup", "grasp"), ("flower", "pinch"), ("sword", "fist")])
def test_a_hand_closes_about_what_it_holds(thing, shape):
    people = standing()
    put_hand(people[0], "right", np.array([-0.2, 1.2, 0.35]))
    found = grips(people, act("hold-thing", thing=thing))
    assert shapes_at(found, 0, "right", 60) == [shape]
    assert shapes_at(found, 0, "left", 60) == ["relaxed"] == shapes_at(found, 1, "right", 60)


def test_the_receivers_hand_closes_and_the_givers_opens():
    found = grips(reaching(), act("hand-over", patient="b", thing="flower"))
    assert shapes_at(found, 0, "right", 20) == ["pinch"] and shapes_at(found, 0, "right", 100) == ["relaxed"]
    assert shapes_at(found, 1, "right", 20) == ["relaxed"] and shapes_at(found, 1, "right", 100) == ["pinch"]
