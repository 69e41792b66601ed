"""Acts are done, not done, or cannot be judged: on motions made for it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from acts import Plan, read
from acts.checking import Verdict, checked
from acts.plan import Act, Relation
from motion import Duet
from motion.metrics.sentences.joints import Motion
from motion.skeleton import SBU15
from motion.transforms import heading_matrix
from tests.motion.metrics.figures import duet, each, index, put, shift, spin, tilt


def plan(*acts: Act) -> Plan:
    return Plan(acts=acts)


def told(name: str, number: int = 1, who: str = "a", **fields: object) -> Act:
    return Act(id=str(number), act=name, agents=tuple(who), **fields)  # type: ignore[arg-type]


def one(act: Act, motion: Motion) -> Verdict:
    (verdict,) = checked(plan(act), motion)
    return verdict


def apply(motion: Motion, *edits, frames: slice = slice(None)) -> Motion:
    """The motion with edits in some of its frames only."""
    changed = motion.positions.copy()
    for edit in edits:
        edit(changed)
    found = motion.positions.copy()
    found[:, frames] = changed[:, frames]
    return Motion(found, motion.fps)


def on_other(part: str) -> Motion:
    """a's left hand on a joint of b."""
    motion = duet()
    motion.positions[0, :, index("left_wrist")] = motion.positions[1, :, index(part)]
    return Motion(motion.positions, motion.fps)


# ---- rules -----------------------------------------------------------------------------------------------
DOES: dict[str, Motion] = {
    "walk-away": duet(shift((0, 0, 0), (0, 0, -2))),
    "walk-up": duet(shift((0, 0, -3), (0, 0, 0))),
    "turn-around": duet(spin(170)),
    "spin": duet(spin(370)),
    "bow": apply(
        duet(),
        tilt(50, (0, 1)),
        lambda both: both[0, :, index("head")].__isub__([0.0, 0.25, -0.3]),
        frames=slice(40, 80),
    ),
    "raise-arm": duet(put("left_wrist", (0.2, 0.9, 0.0))),
    "hand-on": on_other("right_shoulder"),
    "hold-thing": duet(*each("wrist", (0.15, 0.2, 0.35))),
    "lift-up": duet(lambda both: both[1].__iadd__([0.0, 0.4, 0.0])),
}


@pytest.mark.parametrize("name", DOES)
def test_a_rule_holds_on_a_motion_made_for_it(name: str) -> None:
    assert one(told(name, part="shoulder" if name == "hand-on" else None), DOES[name]).done


# ---- values of the act -----------------------------------------------------------------------------------
def test_the_side_of_an_arm_counts() -> None:
    motion = DOES["raise-arm"]
    assert one(told("raise-arm", side="left"), motion).done
    assert one(told("raise-arm", side="right"), motion).done is False


def test_the_part_that_is_touched_counts_by_any_of_its_names() -> None:
    motion = on_other("head")
    assert one(told("hand-on", part="cheek"), motion).done
    assert one(told("hand-on", part="knee"), motion).done is False
    assert one(told("hand-on"), motion).done  # any part
    sided = one(told("hand-on", part="cheek", part_side="left"), motion)
    assert sided.done and sided.unchecked == ("which side",), "one joint is all of the face"


def hop(start: int) -> Callable[[np.ndarray], None]:
    return lambda both: both[0, start : start + 10].__iadd__([0.0, 0.2, 0.0])


def test_jumps_are_counted() -> None:
    twice = duet(hop(30), hop(70))
    assert one(told("jump", times=2), twice).done
    thrice = one(told("jump", times=3), twice)
    assert thrice.done is False and thrice.measure == "done 2 times, not 3"


def test_what_is_done_again_is_not_counted_over_all() -> None:
    acts = (told("jump", times=2), told("jump", 2, times=3, order=(Relation(kind="after", act="1"),)))
    motion = duet(*map(hop, range(5, 120, 24)))
    assert [verdict.done for verdict in checked(plan(*acts), motion)] == [True, True]


def test_the_side_of_what_both_hands_do_counts() -> None:
    motion = duet(put("right_elbow", (-0.45, 0.2, 0.0)), put("right_wrist", (-0.2, 0.05, 0.1)))
    assert one(told("hands-on-hips", side="right"), motion).done
    assert not one(told("hands-on-hips", side="left"), motion).done and not one(told("hands-on-hips"), motion).done


def hand_in_hand() -> Motion:
    """Two who stand at arm's length, a's left hand in b's right one."""
    motion = duet(gap=0.6)
    motion.positions[1, :, index("right_wrist")] = motion.positions[0, :, index("left_wrist")]
    return motion


SUNK = duet(lambda both: both[0].__isub__([0.0, 0.55, 0.0]))
BY_DEED: dict[str, Motion] = {
    "somersault": SUNK,
    "roll": SUNK,
    "push-ups": SUNK,
    "swing-sword": duet(shift((0, 0, 0), (0, 0, 12)), gap=20.0),
    "waltz": hand_in_hand(),
    "ring": hand_in_hand(),
    "tie-up": hand_in_hand(),
    "lift-spin": DOES["lift-up"],
    "exit": DOES["walk-up"],
    "enter": DOES["walk-away"],
    "walk-ahead": DOES["walk-away"],
    "shoot": duet(put("left_wrist", (0.6, 0.0, 0.0), base="left_shoulder")),
}


@pytest.mark.parametrize("name", BY_DEED)
def test_a_rule_does_not_hold_on_something_near_it(name: str) -> None:
    assert not one(told(name), BY_DEED[name]).done


def test_who_leans_on_the_other_is_the_one_who_leans() -> None:
    motion = duet(tilt(15, (0, 1)), gap=0.7)
    assert one(told("let-lean"), motion).done and not one(told("let-lean", who="b"), motion).done


def test_a_caption_names_the_part_that_is_touched_and_no_other() -> None:
    assert one(told("groom", patient="b"), on_other("right_shoulder")).words == "A touches B"
    assert one(told("groom", patient="b", part="cheek"), on_other("head")).words == "A touches B on the cheek"


# ---- denied and unjudged ---------------------------------------------------------------------------------
def test_a_denied_act_is_done_where_its_rule_does_not_hold() -> None:
    denied = told("raise-arm", polarity="not")
    assert one(denied, duet()).done
    assert one(denied, DOES["raise-arm"]).done is False
    assert one(denied, duet()).words == "A does not raise the hand"
    both = told("raise-arm", who="ab", polarity="not")
    assert one(both, duet()).done and one(both, DOES["raise-arm"]).done is False, "one of them does it"


def test_a_denied_act_that_is_seen_is_not_judged_where_nothing_measures_its_qualifier() -> None:
    denied = told("raise-arm", manner=("in a zigzag",), polarity="not")
    found = one(denied, DOES["raise-arm"])
    assert found.done is None and found.unchecked and one(denied, duet()).done


@pytest.mark.parametrize("modality", ["tried", "offered", "pretended", "wished"])
def test_what_is_not_told_is_not_judged(modality: str) -> None:
    verdict = one(told("raise-arm", modality=modality), DOES["raise-arm"])
    assert verdict.done is None
    assert modality in verdict.measure


def test_what_no_rule_covers_is_not_judged() -> None:
    assert one(told("sneeze"), duet()).done is None
    assert one(told("of-another-lab"), duet()).done is None


# ---- measures --------------------------------------------------------------------------------------------
def test_a_measure_says_how_far_off_it_was() -> None:
    far = one(told("hand-on", part="shoulder"), duet(gap=1.8)).measure
    assert far.startswith("hand 1.") and far.endswith(" m from the shoulder, 25 cm needed")
    assert one(told("walk-up"), duet()).measure == "A comes 0 cm nearer, 50 cm needed"
    run = np.interp(np.arange(len(duet().positions[0])), [0, 30, 119], [-1.0, -4.0, -3.2])  # away, and up slowly
    assert one(told("walk-up", speed=0.5), duet(lambda both: both[0, ..., 2].__iadd__(run[:, None]))).done


# ---- order -----------------------------------------------------------------------------------------------
WAVES_UP = put("left_wrist", (0.2, 0.9, 0.0))


def arm_then_leg() -> Motion:
    motion = apply(duet(), WAVES_UP, frames=slice(0, 40))
    return apply(motion, put("right_ankle", (-0.1, -0.5, 0.0)), frames=slice(70, 110))


def test_an_act_after_another_must_come_later() -> None:
    arm, leg = told("raise-arm", 1), told("raise-leg", 2, order=(Relation(kind="after", act="1"),))
    assert [v.done for v in checked(plan(arm, leg), arm_then_leg())] == [True, True]
    leg, arm = told("raise-leg", 1), told("raise-arm", 2, order=(Relation(kind="after", act="1"),))
    verdicts = checked(plan(leg, arm), arm_then_leg())
    assert [v.done for v in verdicts] == [True, False]
    assert "not come after" in verdicts[1].measure


def test_who_follows_begins_before_the_other_has_gone() -> None:
    goes, follows = (
        told("walk-away", 1, "b", patient="a"),
        told("follow", 2, order=(Relation(kind="after", act="1"),)),
    )
    motion = duet(gap=1.0)
    away = np.linspace(0, 4.8, motion.positions.shape[1]).clip(max=4)
    motion.positions[1] = motion.positions[1, :1] * [-1, 1, 1] + away[:, None, None] * [0, 0, 1]
    motion.positions[0, :, :, 2] += (away - away[motion.positions.shape[1] // 4]).clip(0)[:, None]
    assert [v.done for v in checked(plan(goes, follows), motion)] == [True, True]


def test_an_answer_may_come_at_once_and_who_kneels_may_stay_on_their_knees() -> None:
    falls = duet(gap=1.0)
    falls.positions[1, 40:, :, 1] *= 0.15
    assert verdicts("A pushes B over, and B falls down.", falls) == [False, True], "nobody touched them"
    falls.positions[0, 30:39, index("right_wrist")] = falls.positions[1, 30:39, index("spine3")]
    assert verdicts("A pushes B over, and B falls down.", falls) == [True, True]
    assert verdicts("A crouches down, then A crouches down.", sits(slice(40, 120))) == [True, True]
    assert verdicts("A crouches down, then B crouches down.", sits(slice(40, 120), slice(40, 120))) == [True, False]


def test_before_is_after_the_other_way_round() -> None:
    leg, arm = told("raise-leg", 1, order=(Relation(kind="before", act="2"),)), told("raise-arm", 2)
    assert [v.done for v in checked(plan(leg, arm), arm_then_leg())] == [True, False]


def test_an_act_that_failed_holds_up_no_other() -> None:
    bow, arm = told("bow", 1), told("raise-arm", 2, order=(Relation(kind="after", act="1"),))
    assert [v.done for v in checked(plan(bow, arm), arm_then_leg())] == [False, True]


def test_who_does_it_again_does_it_twice() -> None:
    after = [(Relation(kind="after", act=str(i)),) for i in (1, 2)]
    acts = (told("raise-arm", 1), told("raise-leg", 2, order=after[0]), told("raise-arm", 3, order=after[1]))
    assert [v.done for v in checked(plan(*acts), arm_then_leg())] == [True, True, False]
    twice = apply(arm_then_leg(), WAVES_UP, frames=slice(112, 120))
    assert [v.done for v in checked(plan(*acts), twice)] == [True, True, True]


def test_who_stands_up_after_sitting_stands_up_later() -> None:
    def sit(both: np.ndarray) -> None:
        both[0, 40:80, :, 1] -= 0.4  # sinks with all joints, so that the pelvis is low
        both[0, 40:80, index("left_foot"), 1] = both[0, 40:80, index("right_foot"), 1] = 0.02

    after = (Relation(kind="after", act="1"),)
    low, up = told("crouch", 1), told("stand-up", 2, order=after)
    assert [v.done for v in checked(plan(low, up), duet(sit))] == [True, True]


# ---- sides, order and what is held before -------------------------------------------------------------------
def verdicts(sentence: str, motion: Motion) -> list[bool | None]:
    return [verdict.done for verdict in checked(read(sentence), motion)]


@pytest.mark.parametrize(
    ("sentence", "done"),
    [
        ("A taps B on the right shoulder.", True),
        ("A taps B on the left shoulder.", False),
        ("A puts a hand on B's right shoulder.", True),
        ("A puts a hand on B's left shoulder.", False),
        ("A touches B's right shoulder with the left hand.", True),
        ("A touches B's right shoulder with the right hand.", False),
    ],
)
def test_the_side_of_the_other_is_theirs_beside_the_hand_that_touches(sentence: str, done: bool) -> None:
    assert verdicts(sentence, on_other("right_shoulder")) == [done], "a's left hand is on b's right shoulder"


def test_who_ties_a_shoe_has_a_hand_at_that_shoe() -> None:
    def kneels(both: np.ndarray) -> None:
        both[0, 30:, :, 1] *= 0.6
        both[0, 30:, index("left_wrist")] = both[1, 30:, index("right_foot")] + [0, 0.1, 0]

    assert verdicts("A ties B's right shoe.", duet(kneels, gap=0.8)) == [True]
    assert verdicts("A ties B's left shoe.", duet(kneels, gap=0.8)) == [False]
    assert verdicts("A ties B's shoes.", duet(lambda both: both[0, 30:, :, 1].__imul__(0.6))) == [False]


def test_what_is_done_at_the_same_time_is_in_no_order() -> None:
    both = apply(duet(), WAVES_UP, put("right_ankle", (-0.1, -0.5, 0.0)), frames=slice(40, 80))
    assert verdicts("A raises an arm and then lifts a leg.", both) == [True, False]
    assert verdicts("A raises an arm while he lifts a leg.", both) == [True, True]
    assert verdicts("A raises an arm and then lifts a leg.", arm_then_leg()) == [True, True]
    all_along = apply(apply(duet(), WAVES_UP), put("right_ankle", (-0.1, -0.5, 0.0)), frames=slice(10, 50))
    assert verdicts("A raises an arm and then lifts a leg.", all_along) == [True, True]


def sits(*frames: slice) -> Motion:
    def sit(both: np.ndarray) -> None:
        for who, during in enumerate(frames):
            both[who, during, :, 1] -= 0.4
            for foot in ("left_foot", "right_foot"):
                both[who, during, index(foot), 1] = 0.02

    return duet(sit)


def test_who_sits_from_the_start_does_not_sit_down() -> None:
    assert verdicts("A crouches down.", sits(slice(0, 120))) == [False]
    assert verdicts("A crouches down.", sits(slice(30, 120))) == [True]
    assert verdicts("A is crouching.", sits(slice(0, 120))) == [True]


def test_an_attitude_after_another_act_begins_after_it() -> None:
    first, later = slice(20, 120), slice(70, 120)
    assert verdicts("A crouches down, and then B crouches down.", sits(first, later)) == [True, True]
    assert verdicts("A crouches down, and then B crouches down.", sits(later, first)) == [True, False]
    assert verdicts("A crouches down, and then B crouches down.", sits(first, first)) == [True, False]


# ---- whole -----------------------------------------------------------------------------------------------
def test_another_skeleton_is_refused() -> None:
    motion = Duet.from_positions(np.zeros((2, 30, 15, 3)), fps=30.0, skeleton=SBU15)
    with pytest.raises(ValueError, match="SMPL"):
        checked(plan(told("raise-arm")), motion)


@pytest.mark.parametrize(
    ("sentence", "words"),
    [
        ("He brings her a plate.", "A hands the plate to B"),
        ("A picks up a book.", "A picks up the book"),
        ("She holds out a mug to him.", "A holds the mug out to B"),
        ("A holds out the left hand to B.", "A holds out the left hand to B"),
        ("A pushes B with both hands.", "A pushes B with both hands"),
        ("A jumps once.", "A jumps once"),
        ("They walk side by side to the left.", "they walk side by side to the left"),
        ("A runs around B.", "A walks around B quickly"),
        ("A sneaks up behind B on tiptoe.", "A comes up behind B on tiptoe slowly"),
        ("A puts both hands on B's hips.", "A puts both hands on B's hip"),
        ("A kicks with the left foot.", "A kicks B with the left foot"),
        ("A is sitting.", "A sits"),
        ("A turns away from B.", "A turns away from B"),
        ("A waves.", "A waves"),
        ("A throws his hat on the floor.", "A throws the hat"),
        ("A walks around B clockwise.", "A walks around B clockwise"),
        ("A limps around B.", "A limps around B"),
        ("They skip up to each other.", "they skip up to each other"),
        ("A skips behind B.", "A follows B skipping"),
        ("A jumps forward.", "A jumps forward"),
        ("A takes thirteen steps back.", "A steps back (9.1 m)"),
        ("A waves goodbye to her friend.", "A waves at B"),
        ("Two duelists walk five paces.", "they walk (3.5 m)"),
        ("A pushes B away.", "A pushes B away"),
        ("They look at each other.", "they look at each other"),
        ("A drags B across the room.", "A drags B"),
        ("A catches B.", "A catches B"),
        ("A puts an arm around B's shoulders.", "A puts an arm around B's shoulders"),
    ],
)
def test_a_verdict_names_the_thing_and_the_qualifiers_of_the_words(sentence: str, words: str) -> None:
    """And not the caption's example of one."""
    (found,) = checked(read(sentence), duet())
    assert found.words == words


@pytest.mark.parametrize("late", [0, 40])
def test_what_two_do_together_they_do_at_the_same_time(late: int) -> None:
    one = DOES["bow"].positions[0]
    bow = Motion(np.stack([one, np.roll(one * [-1, 1, -1] + [0, 0, 2], late, axis=0)]), 30.0)
    assert (
        checked(read("They bow together."), bow)[0].done is not bool(late) and checked(read("They bow."), bow)[0].done
    )


@pytest.mark.parametrize("ahead", [True, False])
def test_who_salutes_somebody_faces_them(ahead: bool) -> None:
    salutes = duet(put("left_wrist", (0.08, 0.05, 0.1), base="head"), gap=2.0 if ahead else -2.0)
    assert checked(read("Leo salutes Mia."), salutes)[0].done is ahead


def test_what_is_thrown_back_is_thrown_to_whom_it_came_from() -> None:
    verdicts = checked(read("A throws a ball to B, who catches it and throws it back."), duet())
    assert [each.words for each in verdicts[1:]] == ["B catches the ball", "B throws the ball to A"]


def test_who_walks_on_tiptoe_all_along_has_no_flat_stance() -> None:
    def glide(both: np.ndarray) -> None:
        both[0, ..., 2] += np.linspace(0, 2, both.shape[1])[:, None]
        for side in ("left", "right"):
            both[0, :, index(f"{side}_ankle"), 1] += 0.08 * np.float64(heels)

    for heels in (0, 1):
        assert verdicts("A walks past B on tiptoe.", duet(glide, gap=1.0)) == [bool(heels)]


def crawling(both: np.ndarray, up: float) -> None:
    both[0, ..., 1] -= 0.4
    both[0, ..., 2] += np.linspace(0, 1, both.shape[1])[:, None]
    both[0, :, index("left_wrist"), 1] = up


def strolling(both: np.ndarray) -> None:
    both[..., 2] += np.linspace(0, 4, both.shape[1])[:, None]
    both[1] = both[0] + [0.3, 0, 0]


def circling(both: np.ndarray) -> None:
    """Both go once around the middle between them."""
    middle = both[:, 0, 0].mean(axis=0) * [1, 0, 1]
    turns = heading_matrix(np.linspace(0, 2 * np.pi, both.shape[1]))
    both[:] = np.einsum("tij,ptkj->ptki", turns, both - middle) + middle


HELD_OUT = put("left_wrist", (0.2, 0.4, 0.4))


@pytest.mark.parametrize(
    ("sentence", "motion", "done"),
    [
        ("They stand 1 metre apart.", duet(gap=1.0), True),
        ("They stand 3 metres apart.", duet(gap=1.8), False),
        ("A holds out a hand to B.", duet(HELD_OUT, gap=1.2), True),
        ("A holds out a hand to B.", duet(HELD_OUT, gap=1.85), True),
        ("A offers B a cup.", duet(HELD_OUT, gap=1.2), True),
        ("They stand facing each other.", duet(gap=1.2), True),
        ("They stroll hand in hand.", duet(strolling), True),
    ],
)
def test_what_is_there_is_seen_at_the_distance_and_the_pace_that_the_words_name(
    sentence: str, motion: Motion, done: bool
) -> None:
    assert all(verdicts(sentence, motion)) is done


def test_those_who_circle_each_other_are_as_far_apart_as_the_words_say() -> None:
    for metres, done in ((1.0, True), (2.0, False), (0.5, False)):
        assert one(told("circle-together", who="ab", distance=metres), duet(circling, gap=1.1)).done is done


def test_strides_of_somebody_who_sneaks_are_not_fast() -> None:
    """The pelvis goes with each step; what counts is how far it gets."""

    def step(both: np.ndarray) -> None:
        t = np.arange(both.shape[1]) / 30
        both[0, ..., 2] += (0.6 * t - 0.14 * np.sin(4.3 * t))[:, None]  # 0 to 1.2 m/s, a step in 1.5 s

    def run(both: np.ndarray) -> None:
        both[0, ..., 2] += 1.3 * np.arange(both.shape[1])[:, None] / 30

    slow, fast = (checked(read("A walks up to B slowly."), duet(way, gap=5.0))[0] for way in (step, run))
    assert slow.done and not fast.done


def for_a_while(edit: Callable[[np.ndarray, float], None], frames: int = 40) -> Callable[[float], Motion]:
    """A motion by its measure: two people who stand, with an edit of some frames."""
    return lambda measure: apply(duet(gap=1.0), lambda both: edit(both, measure), frames=slice(40, 40 + frames))


def tilted(sign: int) -> Callable[[float], Motion]:
    def edit(both: np.ndarray, degrees: float) -> None:
        own = np.radians(4.5 + sign * degrees * (np.abs(np.arange(120) - 60) < 20))  # the trunk leans back by 4.5
        way = np.stack([0 * own, np.cos(own), np.sin(own)], axis=1)
        both[0, :, index("head")] = both[0, :, index("neck")] + 0.2 * way

    return lambda degrees: duet(lambda both: edit(both, degrees))


def hands(both: np.ndarray, ahead: float, up: float = -0.3, base: str = "pelvis") -> None:
    for edit in each("wrist", (0.2, up, ahead), base):
        edit(both)


def jack(both: np.ndarray, rise: float, over: float = 0.1) -> None:
    hands(both, 0.0, over, "shoulder")
    both[0, ..., 1] += rise * (np.arange(120) // 10 % 2)[:, None]


def clapping(both: np.ndarray, apart: float, up: float = 0.3) -> None:
    hands(both, 0.35, up)
    for side, sign in (("left", 1), ("right", -1)):
        both[0, :, index(f"{side}_wrist"), 0] = sign * (apart + 0.1 * (np.arange(120) // 6 % 2))


def squatting(both: np.ndarray, drop: float) -> None:
    for edit in each("knee", (0.1, -0.2, 0.35)):
        edit(both)
    both[0, ..., 1] -= drop * (np.arange(120) // 10 % 2)[:, None]


def kneeling(both: np.ndarray, behind: float) -> None:
    both[0, ..., 1] -= 0.3
    put("right_knee", (-0.1, -0.55, -behind))(both)


def beside(gap: float) -> Motion:
    return duet(lambda both: np.copyto(both[1], both[0] + [gap, 0, 0]))


def bumped(both: np.ndarray, gap: float) -> None:
    both[0, :, index("left_wrist")] = both[1, :, index("right_wrist")] - [0, 0, gap]


def blindfolding(both: np.ndarray, up: float) -> None:
    for side, x in (("left", 0.06), ("right", -0.06)):
        both[0, :, index(f"{side}_wrist")] = both[1, :, index("head")] + [x, up, -0.1]


def pushing(second: float) -> Motion:
    """A hand of a on b's chest for a fifth of a second, and b going back from second 1 to 2."""
    motion, at = duet(), slice(round(30 * second), round(30 * second) + 6)
    motion.positions[1] += 0.4 * np.clip(np.arange(120) / 30 - 1, 0, 1)[:, None, None] * [0, 0, 1]
    motion.positions[0, at, index("left_wrist")] = motion.positions[1, at, index("spine3")]
    return motion


def thrust(both: np.ndarray, metres: float, up: float = -0.1) -> None:
    put("left_wrist", (0.0, up, metres), base="left_shoulder")(both)


@pytest.mark.parametrize(
    ("name", "shown", "beyond", "before"),
    [
        ("jump", for_a_while(lambda both, up: np.add.at(both, (0, ..., 1), up), 6), 0.11, 0.09),
        ("look-down", tilted(1), 24, 20),
        ("look-up", tilted(-1), 28, 24),
        ("punch", for_a_while(thrust, 4), 0.35, 0.31),
        ("jumping-jacks", for_a_while(jack), 0.04, 0.02),
        ("jumping-jacks", for_a_while(lambda both, over: jack(both, 0.05, over)), 0.03, -0.03),
        (
            "sword-fight",
            lambda gap: apply(duet(gap=gap), lambda both: thrust(both, 0.4), frames=slice(40, 44)),
            2.5,
            2.7,
        ),
        ("swing-sword", for_a_while(lambda both, up: thrust(both, 0.4, up), 6), 0.35, 0.2),
        ("cover-eyes", for_a_while(blindfolding), 0.05, 0.2),
        ("push", pushing, 1.0, 3.5),
        ("catch-thing", for_a_while(lambda both, ahead: hands(both, ahead, 0.1)), 0.28, 0.24),
        ("shake-hands", lambda frames: for_a_while(bumped, int(frames))(0.05), 17, 12),
        ("fist-bump", for_a_while(bumped), 0.12, 0.2),
        ("hip-bump", beside, 0.36, 0.4),
        ("crawl", lambda up: duet(lambda both: crawling(both, up), gap=3.0), 0.1, 0.6),
        ("form-line", beside, 1.0, 1.5),
        ("form-line-close", beside, 0.5, 0.9),
        ("clap", for_a_while(clapping, 80), 0.07, 0.12),
        ("clap", for_a_while(lambda both, up: clapping(both, 0.07, up), 80), 0.15, 0.05),
        ("squats", for_a_while(squatting, 60), 0.25, 0.15),
        ("kneel", for_a_while(kneeling), 0.1, 0.35),
        ("face-other", lambda degrees: duet(spin(degrees)), 90, 360),
        ("bump-into", lambda gap: duet(shift((0, 0, 0), (0, 0, 2 - gap))), 0.34, 0.44),
        ("punch", lambda gap: apply(duet(gap=gap), lambda both: thrust(both, 0.4), frames=slice(40, 44)), 1.0, 3.0),
    ],
)
def test_a_rule_holds_beyond_its_limit_and_not_before_it(
    name: str, shown: Callable[[float], Motion], beyond: float, before: float
) -> None:
    assert one(told(name), shown(beyond)).done and not one(told(name), shown(before)).done
