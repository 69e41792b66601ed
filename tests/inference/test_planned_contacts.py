"""Touches of the words are met by a network that has learned nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acts.staging.moves import coming, meeting
from acts.staging.places import Standing
from acts.staging.score import Move, Score, Touch
from motion import FPS, SMPL22
from motion.metrics.quality import jerk_percentile
from motion.transforms import facing, heading
from webdemo.inference import Engine

from .planned import made


def nearest(motion: np.ndarray, giver: int, joints: list[str], others: list[str]) -> np.ndarray:
    """(T,) metres between the nearest of a person's joints and of the other's."""
    mine, theirs = ([SMPL22.index(name) for name in names] for names in (joints, others))
    gaps = motion[giver, :, mine][:, None] - motion[1 - giver, :, theirs][None]
    return np.linalg.norm(gaps, axis=-1).min(axis=(0, 1))


@pytest.mark.parametrize(
    ("prompt", "giver", "part"),
    [
        ("Person A lays a hand on person B's head.", 0, ["head"]),
        ("While person B kneels, person A lays a hand on person B's head.", 0, ["head"]),
        ("Person A is tapped on the back by person B.", 1, ["left_shoulder", "right_shoulder", "spine3"]),
        ("Person A puts both hands on person B's shoulders.", 0, ["left_shoulder", "right_shoulder"]),
        ("Person B lies on the floor. Person A touches person B's shoulder.", 0, ["left_shoulder", "right_shoulder"]),
        ("Person A bends down and ties person B's shoe.", 0, ["left_ankle", "right_ankle"]),
    ],
)
def test_a_hand_touches_what_the_words_name(engine: Engine, prompt: str, giver: int, part: list[str]) -> None:
    gap = nearest(made(engine, prompt), giver, ["left_wrist", "right_wrist"], part)
    assert gap.min() < 0.36, "a hand's length, of what no network holds"
    free = nearest(made(engine, prompt, planned=False), giver, ["left_wrist", "right_wrist"], part)
    assert gap.min() < free.min()


@pytest.mark.parametrize("before", ["", "Person A walks up to person B. "])
def test_a_head_is_laid_on_the_shoulder_of_the_one_beside(engine: Engine, before: str) -> None:
    found = made(engine, before + "Person A rests the head on person B's shoulder.", seconds=4.0 + len(before) / 10)
    gap = nearest(found, 0, ["head"], ["left_shoulder", "right_shoulder"])
    assert gap.min() < 0.3
    rests = int(gap.argmin())
    ahead, theirs = facing(found[:, rests])
    assert ahead @ theirs > 0.7, "they look the same way"
    lean = found[0, rests, SMPL22.index("neck")] - found[0, rests, 0]
    assert abs(lean @ ahead) < 0.2, "to the side, not forward"


def test_a_pat_is_given_twice(engine: Engine) -> None:
    gap = nearest(
        made(engine, "Person B pats person A on the shoulder."), 1, ["right_wrist"], ["left_shoulder", "right_shoulder"]
    )
    on = gap < gap.min() + 0.08
    assert np.count_nonzero(on[1:] & ~on[:-1]) + on[0] >= 2


def test_who_is_tapped_and_turns_round_is_tapped_first(engine: Engine) -> None:
    found = made(engine, "Person A is tapped on the back by person B and turns around.")
    gap = nearest(found, 1, ["right_wrist"], ["left_shoulder", "right_shoulder", "spine3"])
    angle = np.unwrap(heading(found[0]))
    turned = np.abs(angle - angle[0]) > 1.0
    assert turned[-1] and gap[: int(np.flatnonzero(turned)[0])].min() < 0.25


@pytest.mark.parametrize("prompt", ["A couple dances a waltz.", "They take each other by both hands and spin around."])
def test_those_in_a_hold_have_their_hands_joined_while_they_turn(engine: Engine, prompt: str) -> None:
    found = made(engine, prompt)
    joined = nearest(found, 0, ["left_wrist"], ["right_wrist"])[30:110]
    assert np.mean(joined < 0.22) > 0.9, "palms that touch lie between the wrists"
    line = found[1, :, 0] - found[0, :, 0]
    angle = np.unwrap(np.arctan2(line[:, 0], line[:, 2]))
    assert abs(angle[-1] - angle[0]) > 1.5


@pytest.mark.parametrize(
    "prompt",
    [
        "Person A pats person B on the back.",
        "Person A taps person B on the shoulder from behind.",
        "Person A waves at person B. Then person A pats person B on the back.",
    ],
)
def test_a_touch_of_the_back_or_from_behind_comes_from_there(engine: Engine, prompt: str) -> None:
    found = made(engine, prompt, seconds=8.0 if "Then" in prompt else 4.0)
    gap = nearest(found, 0, ["left_wrist", "right_wrist"], ["left_shoulder", "right_shoulder", "spine3"])
    behind = np.sum((found[0, :, 0] - found[1, :, 0]) * facing(found[1]), axis=1) < 0
    assert gap[behind].min() < 0.3, "a hand may come near on the way round them as well"


def test_a_person_who_comes_up_goes_to_the_side_that_is_touched() -> None:
    stand = Standing(np.array([[0.0, 0.0], [0.0, 2.0]]), np.array([0.0, np.pi]))
    for behind, way in ((True, "behind"), (False, "to")):
        touch = Touch(person="a", part="back", hands="right", behind=behind)
        for moves in ((), (Move("a", "to", 1.0),)):
            _, found = meeting(touch, moves, {}, stand)
            assert [move.way for move in found if move.person == "a"] == [way]


def test_who_waves_while_touched_from_behind_is_not_given_two_places_for_a_hand(engine: Engine) -> None:
    found = made(engine, "Person A hugs person B from behind while person B waves.")
    assert np.linalg.norm(np.diff(found[1, :, SMPL22.index("right_wrist")], axis=0), axis=-1).max() * 30 < 8


def test_a_hand_that_is_offered_stays_out_and_nobody_takes_it(engine: Engine) -> None:
    found = made(engine, "Person A offers a hand, but person B does not take it.")
    wrist, pelvis = found[0, 45:105, SMPL22.index("right_wrist")], found[0, 45:105, 0]
    assert np.mean((wrist - pelvis)[:, 2] > 0.25) > 0.8, "a faces +Z"
    hands = nearest(found, 0, ["left_wrist", "right_wrist"], ["left_wrist", "right_wrist"])
    assert hands.min() > 0.3


@pytest.mark.parametrize(
    ("prompt", "same"), [("They practise side by side.", True), ("They sit on the floor back to back.", False)]
)
def test_people_begin_and_stay_where_the_words_put_them(engine: Engine, prompt: str, same: bool) -> None:
    found = made(engine, prompt)
    alike = np.einsum("ti,ti->t", *facing(found))[29::30]
    assert (alike > 0).all() if same else (alike < 0).all()


def test_who_is_pushed_over_stood_and_was_pushed_first(engine: Engine) -> None:
    found = made(engine, "Person A is pushed over by person B.")
    gap = nearest(found, 1, ["left_wrist", "right_wrist"], ["spine2", "spine3"])
    touched = int(np.flatnonzero(gap < 0.3)[0])
    assert found[0, touched, 0, 1] > 0.7 and found[0, -5, 0, 1] < 0.35


def test_who_is_led_backwards_by_both_hands_keeps_them(engine: Engine) -> None:
    found = made(engine, "Holding both her hands, he walks backwards and leads her along.")
    for mine, theirs in (("left_wrist", "right_wrist"), ("right_wrist", "left_wrist")):
        assert (nearest(found, 0, [mine], [theirs])[59::30] < 0.3).all(), "where their places are given"
    assert np.linalg.norm(found[0, -1, 0] - found[0, 0, 0]) > 1.0


def speed_of_hands(motion: np.ndarray, person: int) -> np.ndarray:
    """(2, T - 1) metres a second of both wrists, beside their shoulders."""
    arms = [
        motion[person, :, SMPL22.index(f"{side}_wrist")] - motion[person, :, SMPL22.index(f"{side}_shoulder")]
        for side in ("left", "right")
    ]
    return np.linalg.norm(np.diff(arms, axis=1), axis=-1) * 30


def test_two_who_fight_both_strike_and_reach_each_other(engine: Engine) -> None:
    found = made(engine, "They fight.")
    free = made(engine, "They fight.", planned=False)
    for giver in (0, 1):
        gap = nearest(found, giver, ["left_wrist", "right_wrist"], ["head", "neck", "spine3"])
        assert gap.min() < 0.35 and speed_of_hands(found, giver).max() > 2.0
        assert gap.min() < nearest(free, giver, ["left_wrist", "right_wrist"], ["head", "neck", "spine3"]).min()


def test_a_punch_goes_over_who_ducks_and_is_returned(engine: Engine) -> None:
    found = made(engine, "Person A throws a punch, person B ducks under it and punches back.")
    fast = [speed_of_hands(found, person).max(axis=0)[15:] for person in (0, 1)]
    ducked = int(found[1, :, 0, 1].argmin())
    first = 15 + int(np.argmax(fast[0] > 2.0))  # later the hand is the network's, which has learned nothing
    assert found[1, ducked, 0, 1] < 0.6 and abs(ducked - first) < 12
    assert fast[1][first:].max() > 2.0


def test_a_ball_goes_to_and_fro_between_two_who_stand_apart(engine: Engine) -> None:
    found = made(engine, "Two people throw a ball to each other.")
    assert np.linalg.norm(found[0, :, 0] - found[1, :, 0], axis=-1).min() > 1.8
    first = [int(speed_of_hands(found, person).max(axis=0)[5:70].argmax()) for person in (0, 1)]
    thrown = [found[p, :, SMPL22.index("right_wrist"), 1] - found[p, :, 0, 1] for p in (0, 1)]
    assert thrown[0][5:30].max() > 0.55 and thrown[1][50:80].max() > 0.55 and first[0] < 30


def test_who_is_twirled_turns_all_the_way_round_under_joined_hands(engine: Engine) -> None:
    found = made(engine, "He twirls her under his arm.")
    for left, right in (("left_hip", "right_hip"), ("left_shoulder", "right_shoulder")):
        across = found[1, :, SMPL22.index(left)] - found[1, :, SMPL22.index(right)]
        angle = np.unwrap(np.arctan2(across[:, 0], across[:, 2]))
        assert abs(abs(angle[-15] - angle[15]) - 2 * np.pi) < 0.6
    gap = nearest(found, 0, ["right_wrist"], ["right_wrist"])[20:130]
    assert np.mean(gap < 0.2) > 0.9
    assert found[0, 20:130, SMPL22.index("right_wrist"), 1].min() > 1.6


@pytest.mark.parametrize(
    ("prompt", "people"),
    [
        ("They stand side by side.", (0, 1)),
        ("They stand back to back.", (0, 1)),
        ("Person A hugs person B from behind.", (1,)),
    ],
)
def test_who_turns_their_back_keeps_the_trunk_over_the_feet(
    shipped: Engine, prompt: str, people: tuple[int, ...]
) -> None:
    """The network would turn the shoulders to the other, half a turn against the hips."""
    found = made(shipped, prompt)
    for person in people:
        hips, shoulders = (
            found[person, :, SMPL22.index(f"left_{part}")] - found[person, :, SMPL22.index(f"right_{part}")]
            for part in ("hip", "shoulder")
        )
        flat = hips[:, [0, 2]], shoulders[:, [0, 2]]
        cosine = (flat[0] * flat[1]).sum(-1) / np.prod([np.linalg.norm(each, axis=-1) for each in flat], axis=0)
        assert cosine[10:-10].min() > 0.3, prompt


def test_who_is_pulled_up_has_their_hand_held_while_they_are_down(engine: Engine) -> None:
    found = made(engine, "Person B helps person A up.", seconds=6.0)
    gap = nearest(found, 1, ["right_wrist"], ["right_wrist"])
    low = found[0, :, 0, 1] < 0.7
    assert gap[low].min() < 0.18 and low[0] and not low[-1]


@pytest.mark.parametrize(
    ("prompt", "near"),
    [("Then person B hugs person A.", 0.4), ("Then they hug.", 0.4), ("Then they shake hands.", 0.75)],
)
def test_who_is_far_away_comes_up_first_and_both_face_each_other(engine: Engine, prompt: str, near: float) -> None:
    found = made(engine, f"Person A walks away. {prompt}", seconds=8.0)
    gap = np.linalg.norm((found[1] - found[0])[:, 0, [0, 2]], axis=-1)
    assert gap[115] > 2.0 and gap[-1] == pytest.approx(near, abs=0.1)
    for who in (0, 1):
        for side in ("hip", "shoulder"):
            across = found[who, -1, SMPL22.index(f"left_{side}")] - found[who, -1, SMPL22.index(f"right_{side}")]
            assert np.cross(across, [0.0, 1.0, 0.0]) @ (found[1 - who, -1, 0] - found[who, -1, 0]) > 0


def test_nobody_comes_up_who_is_there_or_has_a_way_of_their_own() -> None:
    reaching = Score(reaching={"b": 0.4})
    far = Standing(np.array([[0.0, 0.0], [0.0, 2.5]]), np.array([np.pi, np.pi]))
    near = Standing(np.array([[0.0, 0.0], [0.0, 0.7]]), np.array([np.pi, np.pi]))
    assert [(m.person, m.way) for m in coming(reaching, far, ())] == [("b", "to"), ("a", "face")]
    assert [(m.person, m.way) for m in coming(reaching, far, (0,))] == [("b", "to")], "who lies does not turn"
    assert coming(reaching, near, ()) == ()
    own = (Move("a", "away"),)
    assert coming(replace(reaching, moves=own), far, ()) == own
    assert coming(Score(), far, ()) == ()


def test_who_sits_keeps_still_between_the_given_poses(engine: Engine) -> None:
    seated = made(engine, "Person A is sitting.")[0].astype(float)
    legs = [SMPL22.index(f"{side}_{part}") for side in ("left", "right") for part in ("hip", "knee", "ankle")]
    assert jerk_percentile(seated[30:-15][:, legs], FPS) < 10
