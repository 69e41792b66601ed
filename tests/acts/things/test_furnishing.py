"""Things from a plan: seats under people, and what hands hold, give and put down."""

from __future__ import annotations

import numpy as np
import pytest

from acts import Plan
from acts.plan import Relation
from acts.things.furnishing import furnish
from motion import SMPL22, Duet

from .furnishing import FPS, FRAMES, act, palms, put_hand, reaching, sitting, standing, things_of, worded


# ---- seats -----------------------------------------------------------------------------------------------
def test_a_seat_is_under_the_hips_of_a_person_who_sits():
    people = sitting()
    one, sentence = worded("He sits.", "sit-down")
    (chair,) = things_of(people, one, sentence=sentence)
    hips = people[0, 60, [SMPL22.index("left_hip"), SMPL22.index("right_hip")]].mean(axis=0)
    top = chair.at(60)
    seat = top[np.abs(top[:, 1] - (hips[1] - 0.095)) < 0.02]
    assert chair.kind == "chair" and len(seat) and not chair.moves
    assert np.abs(seat.mean(axis=0) - hips)[[0, 2]].max() < 0.12
    assert chair.rotations[0] @ [0, 0, 1] == pytest.approx([0, 0, 1], abs=0.1), "it faces where the person does"


def test_nobody_has_a_seat_who_stands_or_sits_on_the_floor():
    one, sentence = worded("He sits.", "sit-down")
    assert things_of(standing(), one, sentence=sentence) == ()
    low = sitting()
    low[:, :, :, 1] -= 0.35
    assert things_of(low, one, sentence=sentence) == ()
    one, sentence = worded("He sits on the floor.", "sit-down")
    assert things_of(sitting(), one, sentence=sentence) == ()


def test_the_words_name_the_seat_and_two_beside_each_other_share_a_bench():
    people = sitting()
    one, sentence = worded("They sit on a sofa.", "sit-down", "ab")
    assert [t.kind for t in things_of(people, one, sentence=sentence)] == ["bench", "bench"], "face to face"
    people[1] = people[0] + np.array([0.7, 0.0, 0.0])
    (bench,) = things_of(people, one, sentence=sentence)
    assert bench.name == "sofa" and bench.mesh.size[0] == pytest.approx(1.5, abs=0.1)
    assert bench.places[0, 0] == pytest.approx(0.35, abs=0.05)


def test_a_table_stands_before_people_who_sit_at_one():
    one, sentence = worded("She sits at the table.", "sit-down")
    chair, table = things_of(sitting(), one, sentence=sentence)
    assert (chair.kind, table.kind) == ("chair", "table") and table.places[0, 2] > chair.places[0, 2] + 0.5


# ---- hands -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("thing", ["cup", "sword", "umbrella", "phone", "book", "flower", "bag", "stick", "ring"])
def test_a_held_thing_follows_the_hand(thing):
    people = standing()
    swing = 0.2 * np.sin(np.linspace(0, 6, FRAMES))
    put_hand(people[0], "right", np.stack([-0.2 + 0 * swing, 1.2 + swing, 0.3 + swing], axis=1))
    (held,) = things_of(people, act("hold-thing", thing=thing))
    away = np.linalg.norm(held.places - palms(people)[0, 1], axis=1)
    assert away.max() < 0.07 and held.kind == thing


def test_no_thing_appears_where_the_words_name_none_or_none_with_a_shape():
    assert things_of(standing(), act("hold-thing")) == ()
    assert things_of(standing(), act("hold-thing", thing="piano")) == ()
    assert things_of(standing(), act("wave")) == ()
    assert things_of(standing(), act("hold-thing", thing="cup", polarity="not")) == ()
    assert things_of(standing(), act("hold-thing", thing="cup", modality="wished")) == ()


def test_a_box_is_held_before_the_body_in_both_hands():
    people = standing()
    (box,) = things_of(people, act("hold-thing", thing="box"))
    assert box.at(0)[:, 2].min() > 0.1, "it is inside the body"


def test_a_thing_is_handed_over_where_hands_meet_and_stays_with_the_receiver():
    people = reaching()
    (flower,) = things_of(people, act("hand-over", patient="b", thing="flower"))
    hands = palms(people)
    assert np.linalg.norm(flower.places[20] - hands[0, 1, 20]) < 0.03
    assert np.linalg.norm(flower.places[100] - hands[1, 1, 100]) < 0.03
    steps = np.linalg.norm(np.diff(flower.places, axis=0), axis=1) * FPS
    assert steps.max() < 4.0, "it jumps from hand to hand"


def test_a_thing_stays_with_the_giver_where_hands_never_meet():
    people = standing()
    people[1, :, :, 2] += 2.0
    (flower,) = things_of(people, act("hand-over", patient="b", thing="flower"))
    assert np.linalg.norm(flower.places - palms(people)[0], axis=2).max(axis=1).min() < 0.03


def test_a_thing_comes_into_the_hand_that_the_words_name_for_what_is_done_with_it():
    people = reaching()
    drinks = act("drink", "b", id="2", thing="cup", side="left", order=(Relation(kind="after", act="1"),))
    unsaid = act("drink", "b", id="2", side="left", order=(Relation(kind="after", act="1"),))
    assert len(things_of(people, act("hand-over", patient="b", thing="mug"), unsaid)) == 1, "from the mug"
    (cup,) = things_of(people, act("hand-over", patient="b", thing="cup"), drinks)
    assert np.linalg.norm(cup.places[115] - palms(people)[1, 0, 115]) < 0.05


def test_what_is_taken_was_held_by_the_other():
    people = reaching()
    (bag,) = things_of(people, act("take-from", "a", patient="b", thing="bag"))
    assert np.linalg.norm(bag.places[10] - palms(people)[1, 1, 10]) < 0.03
    assert np.linalg.norm(bag.places[110] - palms(people)[0, 1, 110]) < 0.03


# ---- flight ----------------------------------------------------------------------------------------------
def test_a_broom_is_in_the_hand_with_its_far_end_on_the_floor():
    sentence = "A sweeps the floor."
    sweeps, _ = worded(sentence, "sweep", thing="floor")
    (broom,) = things_of(standing(), sweeps, sentence=sentence)
    ends = broom.mesh.vertices[[broom.mesh.vertices[:, 1].argmin(), broom.mesh.vertices[:, 1].argmax()]]
    handle, far = (broom.places + broom.rotations @ end for end in ends)
    assert np.abs(far[:, 1]).max() < 0.05 and far[:, 2].min() > 0.4, "the far end is on the floor ahead"
    palm = palms(standing())[0, 1]
    along = (far - handle) / np.linalg.norm(far - handle, axis=1, keepdims=True)
    off = np.linalg.norm(np.cross(palm - handle, along), axis=1)
    assert off.max() < 0.05, "the hand is not on it"


def test_two_have_a_glass_each_and_carry_one_box():
    sentence = "They raise their glasses."
    glasses, _ = worded(sentence, "drink-together", "ab", thing="glass")
    assert [thing.kind for thing in things_of(standing(), glasses, sentence=sentence)] == ["cup", "cup"]
    boxes = things_of(standing(), act("hold-thing", "ab", thing="box"))
    assert [thing.kind for thing in boxes] == ["box"]


def test_what_goes_without_saying_is_in_the_hand():
    sentence = "They drink."
    drinks, _ = worded(sentence, "drink", "ab")
    cups = things_of(standing(), drinks, sentence=sentence)
    assert [cup.kind for cup in cups] == ["cup", "cup"]
    assert not things_of(standing(), act("wave")), "a wave needs nothing"
    other, sentence = worded("A drinks the sea.", "drink", thing="sea")
    assert not things_of(standing(), other, sentence=sentence), "what is named has no shape"


# ---- rest ------------------------------------------------------------------------------------------------
def bending() -> np.ndarray:
    """A's right hand goes down to 30 cm over the floor at frame 60, ahead of the feet, and comes up again."""
    people = standing()
    low = np.exp(-(((np.arange(FRAMES) - 60) / 12.0) ** 2))[:, None]
    hang = np.array([-0.22, 0.9, 0.12])
    put_hand(people[0], "right", hang + low * (np.array([-0.2, 0.38, 0.5]) - hang))
    return people


def test_what_is_put_down_stays_where_it_was_put():
    people = bending()
    (box,) = things_of(people, act("put-down-thing", thing="cup"))
    bottom = box.at(FRAMES - 1)[:, 1].min()
    assert abs(bottom) < 1e-3
    np.testing.assert_allclose(box.places[80:], np.broadcast_to(box.places[-1], (40, 3)), atol=1e-4)
    assert np.linalg.norm(box.places[20] - palms(people)[0, 1, 20]) < 0.07
    assert np.linalg.norm((box.places[-1] - palms(people)[0, 1, 60])[[0, 2]]) < 0.15


def test_a_table_is_there_for_what_is_put_on_one():
    people = bending()
    one, sentence = worded("She puts a cup on the table.", "put-down-thing", thing="cup")
    cup, table = things_of(people, one, sentence=sentence)
    top = table.mesh.size[1]
    assert table.kind == "table" and cup.at(FRAMES - 1)[:, 1].min() == pytest.approx(top, abs=2e-3)
    inside = table.at(0)
    assert inside[:, 0].min() < cup.places[-1, 0] < inside[:, 0].max()
    assert inside[:, 2].min() < cup.places[-1, 2] < inside[:, 2].max()


def test_what_is_picked_up_lay_on_the_floor_before():
    people = bending()
    (box,) = things_of(people, act("pick-up-thing", thing="cup"))
    assert abs(box.at(10)[:, 1].min()) < 1e-3
    assert np.linalg.norm(box.places[100] - palms(people)[0, 1, 100]) < 0.07


# ---- both ------------------------------------------------------------------------------------------------
def test_two_carry_a_thing_between_their_hands():
    people = standing()
    people[:, :, :, 2] += np.linspace(0, 2, FRAMES)[:, None]
    (table,) = things_of(people, act("carry-thing", "ab", thing="table"))
    middle = palms(people).mean(axis=(0, 1))
    assert np.abs(table.places - middle)[:, [0, 2]].max() < 0.05
    across = table.rotations[60] @ [1, 0, 0]
    assert abs(across[2]) > 0.99, "it lies along the line between them"
    put = act("put-down-thing", "ab", id="2", thing="box", order=({"kind": "after", "act": "1"},))
    (box,) = things_of(people, act("carry-thing", "ab", thing="box"), put)
    assert abs(box.at(FRAMES - 1)[:, 1].min()) < 0.01 and abs((box.rotations[-1] @ [1, 0, 0])[2]) > 0.99


def test_a_beat_has_its_own_frames():
    people = reaching()
    duet = Duet.from_positions(people.astype(np.float32), fps=FPS)
    plan = Plan(acts=(act("hand-over", patient="b", thing="flower"),))
    late = furnish(duet, [(plan, 90, 120, 2)], ())
    assert late.manifest["things"][0]["events"][0]["at"] != pytest.approx(2.0, abs=0.1)
