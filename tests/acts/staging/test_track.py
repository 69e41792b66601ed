"""The way of one person: turned at a body's pace, also where it goes back at once."""

from __future__ import annotations

import math

import numpy as np
import pytest

from acts.staging.places import MOST, ROUND, TURNING, Track
from motion import FPS


def track(frames: int = 120) -> Track:
    return Track(np.zeros(2), 0.0, np.full((frames, 2), np.nan), np.full(frames, np.nan))


@pytest.mark.parametrize("follows", [False, True])
def test_who_goes_the_other_way_turns_at_a_bodys_pace(follows: bool) -> None:
    own = track()
    line = np.linspace([0.0, 0.0], [0.3, -2.0], 91)
    if follows:
        own.follow(line[1:])
    else:
        own.walk(line, 3.0)
    steps = np.abs(np.diff([0.0, *own.headings[:90]]))
    assert steps.max() <= math.pi / TURNING / FPS + 1e-9
    assert math.cos(own.heading) < -0.95, "at the end they face where they go"
    assert own.frame == 90 and own.place == pytest.approx([0.3, -2.0], abs=0.02)


def test_a_walk_begins_and_ends_slowly_and_no_walk_is_faster_than_a_run() -> None:
    own = track()
    own.walk(np.array([[0.0, 0.0], [0.0, 4.0]]), 4.0)
    steps = np.linalg.norm(np.diff(own.places, axis=0), axis=1) * FPS
    assert steps[0] < 0.3 and steps[-1] < 0.3 and steps.max() == pytest.approx(steps[60], rel=0.05)
    own = track()
    own.walk(np.array([[0.0, 0.0], [0.0, 40.0]]), 4.0)
    assert own.places[-1, 1] <= 4.0 * MOST


def test_a_walk_leads_round_a_seat_also_from_it_and_straight_on_where_none_is_in_the_way() -> None:
    for seat, least in (([0.05, 1.5], ROUND), ([0.0, 0.4], 0.4), ([1.0, 1.5], 1.0)):
        own = track()
        own.seats = [np.array(seat)]
        own.walk(np.array([[0.0, 0.0], [0.0, 3.0]]), 4.0)
        assert np.linalg.norm(own.places - seat, axis=1).min() > least - 0.03
        assert own.place == pytest.approx([0.0, 3.0], abs=0.02)
