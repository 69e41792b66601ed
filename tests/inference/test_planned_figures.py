"""Figures of the words are met by a network that has learned nothing, with room for both bodies."""

from __future__ import annotations

import numpy as np

from acts.shapes import Figure
from acts.staging.beginnings import BODY, distance
from acts.staging.figures import _rested, figured
from acts.staging.window import late_by
from motion import SMPL22
from webdemo.inference import Engine, SceneRequest
from webdemo.inference.story import Beat

from .planned import FEET, QUICK, WRISTS, heights, made
from .runs import positions, run

HEAD = SMPL22.index("head")
SHOULDERS = [SMPL22.index("left_shoulder"), SMPL22.index("right_shoulder")]


def test_two_do_push_ups_on_hands_that_stay_and_with_room_for_both(engine: Engine) -> None:
    found = made(engine, "They do push-ups.", seconds=6.0)
    for person in (0, 1):
        down = (found[person][:, WRISTS, 1] < 0.075).all(axis=1)
        assert down.sum() > 45
        assert np.ptp(found[person][down][8:-8][:, WRISTS][..., [0, 2]], axis=0).max() < 0.05
        assert heights(found, person)[[0, -1]].min() > 0.85
    assert distance(found[0][::5], found[1][::5]) > 0.8 * BODY


def test_a_person_does_a_handstand_and_the_other_stands_by(engine: Engine) -> None:
    found = made(engine, "Person A does a handstand.", seconds=5.0)
    assert (found[0][:, FEET, 1].min(axis=1) > 1.5).sum() > 20
    figure = Figure(figure="handstand", late=late_by(QUICK["seed"], 0, 150))
    wanted = _rested(figured([figure], np.zeros(2), 0.0, 150), [figure], 0, 2 * QUICK["seed"])
    wanted += (found[0, 0, FEET] - wanted[0, FEET]).mean(axis=0)
    inverted = wanted[:, FEET, 1].min(axis=1) > 0.3
    assert np.abs(found[0] - wanted)[inverted].max() < 0.03, "no clean-up plants what is given"
    assert np.abs(found[0] - wanted).max() < 0.06
    assert heights(found, 1).min() > 0.85
    free = made(engine, "Person A does a handstand.", seconds=5.0, planned=False)
    assert not (free[0][:, FEET, 1].min(axis=1) > 1.5).any()


def test_arms_that_are_lowered_were_up(engine: Engine) -> None:
    found = made(engine, "Person A lowers both arms.", seconds=3.0)
    up = found[0][:, WRISTS, 1] - found[0][:, SHOULDERS, 1]
    assert up[0].min() > 0.2 and up[-10:].max() < -0.3


def test_two_who_carry_a_table_face_each_other_and_walk_one_way(engine: Engine) -> None:
    found = made(engine, "They carry a table across the room.", seconds=5.0)
    way = found[:, -1, 0] - found[:, 30, 0]
    assert np.linalg.norm(way[:, [0, 2]], axis=1).min() > 0.8
    assert way[0] @ way[1] > 0.9 * np.linalg.norm(way[0]) * np.linalg.norm(way[1])
    gap = np.linalg.norm((found[0] - found[1])[60:, 0][:, [0, 2]], axis=1)
    assert gap.min() > 0.9 and gap.max() < 2.0
    for person in (0, 1):
        wrists = found[person][60:, WRISTS, 1] - found[person][60:, SHOULDERS, 1]
        assert (wrists.mean(axis=0) > -0.5).all() and (wrists.mean(axis=0) < -0.1).all()


def test_a_person_types_with_moving_hands_on_a_seat(engine: Engine) -> None:
    found = made(engine, "Person A types on a keyboard.", seconds=5.0)[0]
    assert np.abs(found[-30:, 0, 1] - 0.63).max() < 0.08, "seated"
    beside = found[-45:, WRISTS] - found[-45:, :1]
    assert (np.ptp(beside[..., 1], axis=0) > 0.01).all()


def test_a_person_who_lies_gets_up_before_a_cartwheel(engine: Engine) -> None:
    beats = (Beat("Person A lies down.", seconds=3.0), Beat("Person A does a cartwheel.", seconds=6.0))
    found = positions(run(engine, SceneRequest(beats=beats, **QUICK)))[0]
    assert found[85, HEAD, 1] < 0.5
    up = np.flatnonzero(found[90:, 0, 1] > 0.85)[0]
    wheels = np.flatnonzero(found[90:, FEET, 1].min(axis=1) > 0.9)
    assert len(wheels) and wheels[0] > up
    assert found[-1, HEAD, 1] > 1.4
    speed = np.linalg.norm(np.diff(found, axis=0), axis=-1) * 30
    assert speed.max() < 9.0


def test_two_who_crawl_up_to_each_other_do_not_crawl_into_each_other(engine: Engine) -> None:
    found = made(engine, "They crawl up to each other.", seconds=4.5)
    gap = np.linalg.norm((found[0] - found[1])[:, 0][:, [0, 2]], axis=1)
    assert gap[0] - gap[-1] > 0.8 and gap[-30:].min() > 1.3
    assert heights(found, 0).max() < 0.75


def test_who_kneels_ties_a_shoe_without_getting_up_before(engine: Engine) -> None:
    beats = (Beat("Person A kneels down.", seconds=4.0), Beat("Person A ties a shoe.", seconds=5.0))
    pelvis = positions(run(engine, SceneRequest(beats=beats, **QUICK)))[0, :, 0, 1]
    assert pelvis[70:210].max() < 0.85


def test_who_sneaks_away_walks_on_tiptoe_and_whoever_touches_then_walks_as_ever(engine: Engine) -> None:
    found = made(engine, "Person A sneaks away.", seconds=4.0)[0]
    ankles = [SMPL22.index("left_ankle"), SMPL22.index("right_ankle")]
    assert (found[25:-25, ankles, 1] - found[25:-25, FEET, 1]).min() > 0.09
    assert np.linalg.norm((found[-1, 0] - found[0, 0])[[0, 2]]) > 1.0
    made(engine, "Person A limps up to person B and hugs them.", seconds=5.0)


def test_two_do_a_thing_in_their_own_time_unless_they_are_in_unison(engine: Engine) -> None:
    """Their first movement is at one time in unison only."""

    def begins(prompt: str) -> list[int]:
        moved = np.abs(np.diff(made(engine, prompt, seconds=6.0)[:, :, WRISTS, 1], axis=1)).max(axis=2) > 0.01
        return [int(np.flatnonzero(person)[0]) for person in moved]

    one, other = begins("They dance in unison.")
    assert abs(one - other) <= 1
    one, other = begins("They warm up.")
    assert abs(one - other) >= 3
