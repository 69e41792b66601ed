"""Things from a plan: seats under people, and what hands hold, give, throw and put down."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from acts import Act, Plan, read
from motion import SMPL22, Duet, InputError
from motion.looks import UNSAID
from motion.things import Thing
from webdemo.inference.requests import GenerateRequest, Result
from webdemo.inference.things import with_own_thing
from webdemo.inference.things.furnishing import furnished
from webdemo.inference.things.holding import Hands
from webdemo.inference.things.tracks import GRAVITY

FPS, FRAMES = 30, 120
REST = SMPL22.rest_positions()
REST = REST - np.array([0.0, REST[:, 1].min(), 0.0])
GAP = 1.3
"""Metres between the two people."""


def standing() -> np.ndarray:
    """(2, T, 22, 3): a at the origin facing +Z, b before them facing back, arms hanging a little ahead."""
    person = np.repeat(REST[None], FRAMES, axis=0)
    for side, sign in (("left", 1), ("right", -1)):
        put_hand(person, side, np.array([0.22 * sign, 0.9, 0.12]))
    other = person * np.array([-1.0, 1.0, -1.0]) + np.array([0.0, 0.0, GAP])
    return np.stack([person, other])


def put_hand(person: np.ndarray, side: str, place: np.ndarray) -> None:
    """Moves a wrist of (T, 22, 3) to a place (3,) or (T, 3), and the elbow between it and the shoulder."""
    shoulder, elbow, wrist = (SMPL22.index(f"{side}_{name}") for name in ("shoulder", "elbow", "wrist"))
    person[:, wrist] = place
    person[:, elbow] = (person[:, shoulder] + person[:, wrist]) / 2 + np.array([0, -0.05, 0])


def sitting() -> np.ndarray:
    """Both sit, half a metre lower than they stand."""
    people = standing()
    upper = [
        j
        for j, name in enumerate(SMPL22.joint_names)
        if not any(p in name for p in ("knee", "ankle", "foot"))
    ]
    people[:, :, upper, 1] -= 0.4
    for person, ahead in zip(people, (1.0, -1.0), strict=True):
        for side in ("left", "right"):
            person[:, SMPL22.index(f"{side}_knee"), 2] += 0.4 * ahead
            for name in ("ankle", "foot"):
                person[:, SMPL22.index(f"{side}_{name}"), 2] += 0.4 * ahead
    return people


def made(people: np.ndarray, *acts: Act, sentence: str = "") -> tuple[Thing, ...]:
    duet = Duet.from_positions(people.astype(np.float32), fps=FPS)
    plan = Plan(sentence=sentence, acts=acts)
    result = furnished(Result(duets=(duet,), manifest={}), [(plan, 0, None, None)])
    (found,) = result.duets
    assert isinstance(found, Duet)
    np.testing.assert_array_equal(found.positions, duet.positions, "the people are moved")
    if found.things:
        rows = result.manifest["things"]
        assert [row["kind"] for row in rows] == [thing.kind for thing in found.things]
        assert found.manifest is not None and found.manifest["things"] == rows
    else:
        assert "things" not in result.manifest
    return found.things


def act(name: str, agents: str = "a", **fields) -> Act:
    return Act(id=fields.pop("id", "1"), act=name, agents=tuple(agents), **fields)


def said(sentence: str, name: str, agents: str = "a", **fields) -> tuple[Act, str]:
    return act(name, agents, words={"start": 0, "stop": len(sentence)}, **fields), sentence


def palms(people: np.ndarray) -> np.ndarray:
    """(2, 2, T, 3)."""
    return Hands.of(Duet.from_positions(people.astype(np.float32), fps=FPS)).palms


# ---- seats -----------------------------------------------------------------------------------------------
def test_a_seat_is_under_the_hips_of_a_person_who_sits():
    people = sitting()
    one, sentence = said("He sits.", "sit-down")
    (chair,) = made(people, one, sentence=sentence)
    hips = people[0, 60, [SMPL22.index("left_hip"), SMPL22.index("right_hip")]].mean(axis=0)
    top = chair.at(60)
    seat = top[np.abs(top[:, 1] - (hips[1] - 0.095)) < 0.02]
    assert chair.kind == "chair" and len(seat) and not chair.moves
    assert np.abs(seat.mean(axis=0) - hips)[[0, 2]].max() < 0.12
    assert chair.rotations[0] @ [0, 0, 1] == pytest.approx([0, 0, 1], abs=0.1), (
        "it faces where the person does"
    )


def test_nobody_has_a_seat_who_stands_or_sits_on_the_floor():
    one, sentence = said("He sits.", "sit-down")
    assert made(standing(), one, sentence=sentence) == ()
    low = sitting()
    low[:, :, :, 1] -= 0.35
    assert made(low, one, sentence=sentence) == ()
    one, sentence = said("He sits on the floor.", "sit-down")
    assert made(sitting(), one, sentence=sentence) == ()


def test_the_words_name_the_seat_and_two_beside_each_other_share_a_bench():
    people = sitting()
    one, sentence = said("They sit on a sofa.", "sit-down", "ab")
    assert [t.kind for t in made(people, one, sentence=sentence)] == ["bench", "bench"], "face to face"
    people[1] = people[0] + np.array([0.7, 0.0, 0.0])
    (bench,) = made(people, one, sentence=sentence)
    assert bench.name == "sofa" and bench.mesh.size[0] == pytest.approx(1.5, abs=0.1)
    assert bench.places[0, 0] == pytest.approx(0.35, abs=0.05)


def test_a_table_stands_before_people_who_sit_at_one():
    one, sentence = said("She sits at the table.", "sit-down")
    chair, table = made(sitting(), one, sentence=sentence)
    assert (chair.kind, table.kind) == ("chair", "table") and table.places[0, 2] > chair.places[0, 2] + 0.5


# ---- hands -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "thing", ["cup", "sword", "umbrella", "phone", "book", "flower", "bag", "stick", "ring"]
)
def test_a_held_thing_follows_the_hand(thing):
    people = standing()
    swing = 0.2 * np.sin(np.linspace(0, 6, FRAMES))
    put_hand(people[0], "right", np.stack([-0.2 + 0 * swing, 1.2 + swing, 0.3 + swing], axis=1))
    (held,) = made(people, act("hold-thing", thing=thing))
    away = np.linalg.norm(held.places - palms(people)[0, 1], axis=1)
    assert away.max() < 0.07 and held.kind == thing


def test_no_thing_appears_where_the_words_name_none_or_none_with_a_shape():
    assert made(standing(), act("hold-thing")) == ()
    assert made(standing(), act("hold-thing", thing="piano")) == ()
    assert made(standing(), act("wave")) == ()
    assert made(standing(), act("hold-thing", thing="cup", polarity="not")) == ()
    assert made(standing(), act("hold-thing", thing="cup", modality="wished")) == ()


def test_a_box_is_held_before_the_body_in_both_hands():
    people = standing()
    (box,) = made(people, act("hold-thing", thing="box"))
    assert box.at(0)[:, 2].min() > 0.1, "it is inside the body"


def reaching() -> np.ndarray:
    """Both reach out with their right hands, which meet in the middle at frame 60."""
    people = standing()
    reach = np.exp(-(((np.arange(FRAMES) - 60) / 12.0) ** 2))[:, None]
    for person, hang in zip(
        people, (np.array([-0.22, 0.9, 0.12]), np.array([0.22, 0.9, GAP - 0.12])), strict=True
    ):
        put_hand(person, "right", hang + reach * (np.array([0.0, 1.15, GAP / 2]) - hang))
    return people


def test_a_thing_is_handed_over_where_hands_meet_and_stays_with_the_receiver():
    people = reaching()
    (flower,) = made(people, act("hand-over", patient="b", thing="flower"))
    hands = palms(people)
    assert np.linalg.norm(flower.places[20] - hands[0, 1, 20]) < 0.03
    assert np.linalg.norm(flower.places[100] - hands[1, 1, 100]) < 0.03
    steps = np.linalg.norm(np.diff(flower.places, axis=0), axis=1) * FPS
    assert steps.max() < 4.0, "it jumps from hand to hand"


def test_a_thing_stays_with_the_giver_where_hands_never_meet():
    people = standing()
    people[1, :, :, 2] += 2.0
    (flower,) = made(people, act("hand-over", patient="b", thing="flower"))
    assert np.linalg.norm(flower.places - palms(people)[0], axis=2).max(axis=1).min() < 0.03


def test_what_is_taken_was_held_by_the_other():
    people = reaching()
    (bag,) = made(people, act("take-from", "a", patient="b", thing="bag"))
    assert np.linalg.norm(bag.places[10] - palms(people)[1, 1, 10]) < 0.03
    assert np.linalg.norm(bag.places[110] - palms(people)[0, 1, 110]) < 0.03


# ---- flight ----------------------------------------------------------------------------------------------
def test_a_ball_that_is_rolled_leaves_the_lowest_hand_and_rolls_over_the_floor_to_the_other():
    people = standing()
    low = np.tile([0.1, 0.9, 0.3], (FRAMES, 1))
    low[30:50, 1] = 0.2
    put_hand(people[0], "right", low)
    rolls, sentence = said("A rolls a ball to B.", "bowl", patient="b")
    (ball,) = made(people, rolls, sentence=sentence)
    radius = ball.mesh.size[1] / 2
    assert np.ptp(ball.places[:20, 1]) < 0.05 and ball.places[20, 1] > 0.8, "it is in the hand"
    assert ball.places[55:, 1] == pytest.approx(radius, abs=0.005)
    x, _, z = ball.places[-1]
    assert 0.2 < np.hypot(x, z - GAP) < 0.4, "at b's feet"
    way = np.linalg.norm(np.diff(ball.places[55:, [0, 2]], axis=0), axis=1)
    turned = np.arccos(
        np.clip((np.einsum("tij,tij->t", ball.rotations[56:], ball.rotations[55:-1]) - 1) / 2, -1, 1)
    )
    assert turned == pytest.approx(way / radius, abs=0.02), "it does not slide"


def test_a_ball_that_is_kicked_lies_before_the_foot_and_rolls_from_it_to_the_other():
    people = standing()
    people[1, :, :, 2] += 2.0
    swing = 0.5 * np.exp(-(((np.arange(FRAMES) - 40) / 5.0) ** 2))
    for joint in ("right_ankle", "right_foot"):
        people[0, :, SMPL22.index(joint), 2] += swing
    (ball,) = made(people, act("kick-ball", patient="b", thing="ball"))
    lies = ball.places[0]
    assert lies[1] == pytest.approx(ball.mesh.size[1] / 2, abs=0.005) and lies[2] > 0.3
    moved = np.flatnonzero(np.abs(ball.places[:, 2] - lies[2]) > 0.02)[0]
    foot = people[0, moved, SMPL22.index("right_foot")]
    assert 30 < moved < 45 and np.hypot(*(foot - lies)[[0, 2]]) < 0.3, "the foot meets it"
    assert 0.2 < abs(ball.places[-1, 2] - GAP - 2.0) < 0.4, "at b's feet"


def test_two_who_throw_a_ball_have_it_in_turn():
    people = standing()
    people[1, :, :, 2] += 2.0
    frames = np.arange(FRAMES)
    for person, thrown, ahead in ((0, 25, 1.0), (1, 80, -1.0)):
        swing = np.clip((frames - thrown) / 6.0, 0, 1)[:, None]
        start = np.array([-0.2 * ahead, 1.3, person * (GAP + 2.0) - 0.1 * ahead])
        put_hand(people[person], "right", start + swing * np.array([0.0, 0.2, 0.6 * ahead]))
    sentence = "They play catch."
    throws, _ = said(sentence, "throw-ball", "ab")
    (ball,) = made(people, throws, sentence=sentence)
    assert ball.kind == "ball"
    hands = palms(people)
    for frame, person in ((10, 0), (65, 1), (110, 0)):
        gaps = np.linalg.norm(ball.places[frame] - hands[person, :, frame], axis=-1)
        assert gaps.min() < 0.16, f"person {person} has it at frame {frame}"


def test_a_ball_bounces_between_a_hand_that_goes_up_and_down_and_the_floor():
    people = standing()
    hand = np.tile([-0.25, 0.95, 0.3], (FRAMES, 1))
    hand[30:, 1] += 0.1 * np.cos(2 * np.pi * 1.5 * np.arange(FRAMES - 30) / FPS)
    put_hand(people[0], "right", hand)
    bounces, sentence = said("A bounces a ball.", "dribble", side="right")
    (ball,) = made(people, bounces, sentence=sentence)
    radius = ball.mesh.size[1] / 2
    assert ball.places[:, 1].min() > radius - 0.005, "not into the floor"
    low = ball.places[:, 1] < radius + 0.15
    assert np.sum(np.diff(low.astype(int)) == 1) == 4, "as often as the hand goes down, once the ball is back"
    assert np.linalg.norm(ball.places[:25] - palms(people)[0, 1, :25], axis=1).max() < radius + 0.06
    assert np.linalg.norm(np.diff(ball.places, axis=0), axis=1).max() * FPS < 9.0


def test_who_dribbles_has_a_ball_that_no_word_names():
    people = standing()
    dribbles, sentence = said("The player dribbles.", "dribble")
    assert [thing.kind for thing in made(people, dribbles, sentence=sentence)] == ["ball"]


def test_a_throw_is_a_parabola_from_hand_to_hand():
    people = standing()
    people[1, :, :, 2] += 2.0
    swing = np.clip((np.arange(FRAMES) - 40) / 6.0, 0, 1)[:, None]
    put_hand(people[0], "right", np.array([-0.2, 1.3, -0.1]) + swing * np.array([0.0, 0.2, 0.6]))
    put_hand(people[1], "right", np.array([0.2, 1.2, GAP + 2.0 - 0.35]))
    (ball,) = made(people, act("throw-ball", patient="b", thing="ball"))
    hands = palms(people)
    steps = np.diff(ball.places[:, 1], n=2)
    flight = np.flatnonzero(np.abs(steps * FPS**2 + GRAVITY) < 0.2)
    assert len(flight) >= 9 and np.ptp(flight) == len(flight) - 1, "no parabola"
    assert np.linalg.norm(ball.places[20] - hands[0, 1, 20]) < 0.16
    assert np.linalg.norm(ball.places[100] - hands[1, 1, 100]) < 0.16
    assert np.linalg.norm(np.diff(ball.places, axis=0), axis=1).max() * FPS < 12.0, "it jumps"


def test_what_nobody_catches_comes_down_on_the_floor():
    away, up = (act("throw-ball", patient="b", thing="ball", direction=way) for way in ("away", "up"))
    (ball,) = made(standing(), away)
    assert ball.places[-1, 1] == pytest.approx(ball.mesh.size[1] / 2, abs=0.02)
    (ball,) = made(standing(), up)
    assert np.linalg.norm(ball.places[-1] - palms(standing())[0, :, -1], axis=-1).min() < 0.25


def test_a_broom_is_in_the_hand_with_its_far_end_on_the_floor():
    sentence = "A sweeps the floor."
    sweeps, _ = said(sentence, "sweep", thing="floor")
    (broom,) = made(standing(), sweeps, sentence=sentence)
    ends = broom.mesh.vertices[[broom.mesh.vertices[:, 1].argmin(), broom.mesh.vertices[:, 1].argmax()]]
    handle, far = (broom.places + broom.rotations @ end for end in ends)
    assert np.abs(far[:, 1]).max() < 0.05 and far[:, 2].min() > 0.4, "the far end is on the floor ahead"
    palm = palms(standing())[0, 1]
    along = (far - handle) / np.linalg.norm(far - handle, axis=1, keepdims=True)
    off = np.linalg.norm(np.cross(palm - handle, along), axis=1)
    assert off.max() < 0.05, "the hand is not on it"


def test_two_have_a_glass_each_and_carry_one_box():
    sentence = "They raise their glasses."
    glasses, _ = said(sentence, "drink-together", "ab", thing="glass")
    assert [thing.kind for thing in made(standing(), glasses, sentence=sentence)] == ["cup", "cup"]
    boxes = made(standing(), act("hold-thing", "ab", thing="box"))
    assert [thing.kind for thing in boxes] == ["box"]


def test_what_goes_without_saying_is_in_the_hand():
    sentence = "They drink."
    drinks, _ = said(sentence, "drink", "ab")
    cups = made(standing(), drinks, sentence=sentence)
    assert [cup.kind for cup in cups] == ["cup", "cup"]
    assert not made(standing(), act("wave")), "a wave needs nothing"
    other, sentence = said("A drinks the sea.", "drink", thing="sea")
    assert not made(standing(), other, sentence=sentence), "what is named has no shape"


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
    (box,) = made(people, act("put-down-thing", thing="cup"))
    bottom = box.at(FRAMES - 1)[:, 1].min()
    assert abs(bottom) < 1e-3
    np.testing.assert_allclose(box.places[80:], np.broadcast_to(box.places[-1], (40, 3)), atol=1e-4)
    assert np.linalg.norm(box.places[20] - palms(people)[0, 1, 20]) < 0.07
    assert np.linalg.norm((box.places[-1] - palms(people)[0, 1, 60])[[0, 2]]) < 0.15


def test_a_table_is_there_for_what_is_put_on_one():
    people = bending()
    one, sentence = said("She puts a cup on the table.", "put-down-thing", thing="cup")
    cup, table = made(people, one, sentence=sentence)
    top = table.mesh.size[1]
    assert table.kind == "table" and cup.at(FRAMES - 1)[:, 1].min() == pytest.approx(top, abs=2e-3)
    inside = table.at(0)
    assert inside[:, 0].min() < cup.places[-1, 0] < inside[:, 0].max()
    assert inside[:, 2].min() < cup.places[-1, 2] < inside[:, 2].max()


def test_what_is_picked_up_lay_on_the_floor_before():
    people = bending()
    (box,) = made(people, act("pick-up-thing", thing="cup"))
    assert abs(box.at(10)[:, 1].min()) < 1e-3
    assert np.linalg.norm(box.places[100] - palms(people)[0, 1, 100]) < 0.07


def test_a_story_of_one_thing_follows_its_acts():
    people = reaching()
    after = {"order": ({"kind": "after", "act": "1"},)}
    (book,) = made(
        people, act("hand-over", patient="b", thing="book"), act("let-go", "b", id="2", thing="book", **after)
    )
    assert np.linalg.norm(book.places[20] - palms(people)[0, 1, 20]) < 0.03
    assert book.at(FRAMES - 1)[:, 1].min() == pytest.approx(0.0, abs=1e-3)


# ---- both ------------------------------------------------------------------------------------------------
def test_two_carry_a_thing_between_their_hands():
    people = standing()
    people[:, :, :, 2] += np.linspace(0, 2, FRAMES)[:, None]
    (table,) = made(people, act("carry-thing", "ab", thing="table"))
    middle = palms(people).mean(axis=(0, 1))
    assert np.abs(table.places - middle)[:, [0, 2]].max() < 0.05
    across = table.rotations[60] @ [1, 0, 0]
    assert abs(across[2]) > 0.99, "it lies along the line between them"


def test_both_have_a_sword_of_their_own():
    one, other = made(standing(), act("sword-fight", "ab", thing="sword"))
    assert np.linalg.norm(one.places[0] - other.places[0]) > 0.5


def test_the_same_plan_and_motion_give_the_same_things():
    people = reaching()
    one, other = (made(people, act("hand-over", patient="b", thing="flower"))[0] for _ in range(2))
    np.testing.assert_array_equal(one.places, other.places)
    np.testing.assert_array_equal(one.rotations, other.rotations)


def test_other_skeletons_stay_as_they_are():
    from motion.skeleton import SBU15

    duet = Duet.from_positions(np.random.default_rng(0).normal(size=(2, 9, 15, 3)), fps=30, skeleton=SBU15)
    result = Result(duets=(duet,), manifest={})
    plan = Plan(acts=(act("hold-thing", thing="cup"),))
    same = furnished(result, [(plan, 0, None, None)])
    assert same.duets[0] is duet and same.manifest == {}


def test_a_beat_has_its_own_frames():
    people = reaching()
    duet = Duet.from_positions(people.astype(np.float32), fps=FPS)
    plan = Plan(acts=(act("hand-over", patient="b", thing="flower"),))
    late = furnished(Result(duets=(duet,), manifest={}), [(plan, 90, 120, 2)])
    assert late.manifest["things"][0]["events"][0]["at"] != pytest.approx(2.0, abs=0.1)


# ---- one's own thing -------------------------------------------------------------------------------------
def owned(people: np.ndarray, prompt: str, tmp_path) -> Result:
    trimesh.creation.box((0.1, 0.2, 0.1)).export(tmp_path / "mine.stl")
    duet = Duet.from_positions(people.astype(np.float32), fps=FPS)
    result = Result(duets=(duet,), manifest={})
    return with_own_thing(result, GenerateRequest(prompt=prompt, seconds=4.0), tmp_path / "mine.stl")


def test_ones_own_thing_is_held_where_the_words_name_one(tmp_path):
    made_ = owned(standing(), "A holds a cup.", tmp_path)
    (thing,) = made_.duets[0].things
    assert thing.kind == "own" and thing.name == "cup"
    assert np.linalg.norm(thing.places - palms(standing())[0], axis=2).max(axis=1).min() < 0.07
    assert made_.manifest["own_thing"]["file"] == "mine.stl"


def test_ones_own_seat_stands_under_who_sits(tmp_path):
    (thing,) = owned(sitting(), "A sits down.", tmp_path).duets[0].things
    assert thing.kind == "own" and thing.at(0)[:, 1].min() == pytest.approx(0.0, abs=1e-3)
    assert np.abs(thing.places[0, [0, 2]]).max() < 0.2


def test_ones_own_thing_stands_beside_where_the_words_name_none(tmp_path):
    (thing,) = owned(standing(), "They wave.", tmp_path).duets[0].things
    assert thing.at(0)[:, 1].min() == pytest.approx(0.0, abs=1e-3)
    assert np.linalg.norm(thing.places[0] - standing()[:, 0, 0], axis=1).min() > 0.4


def test_a_file_that_is_no_thing_is_one_sentence(tmp_path):
    (tmp_path / "mine.stl").write_bytes(b"nonsense")
    result = Result(duets=(Duet.from_positions(standing(), fps=FPS),), manifest={})
    with pytest.raises(InputError, match=r"mine\.stl"):
        with_own_thing(result, GenerateRequest(prompt="They wave.", seconds=4.0), tmp_path / "mine.stl")


def test_people_look_as_their_plans_say():
    """A later plan adds what an earlier one leaves open and changes nothing that it says."""
    duet = Duet.from_positions(standing().astype(np.float32), fps=FPS)
    first = read("She bows.")
    second = read("An old man waves at a boy.")
    result = Result(duets=(duet,), manifest={}, readouts=(), timings={}, notes=())
    both = furnished(result, [(first, 0, 60, 0), (second, 60, None, 1)]).duets[0]
    assert both.looks == ("old-woman", "boy")
    assert furnished(result, []).duets[0].looks == UNSAID
