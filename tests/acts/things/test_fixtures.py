"""Windows, doors and a hi-fi: where they stand, what of them moves, and who looks at them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acts import read
from acts.checking import checked
from acts.things.furnishing import furnish, judge_things
from motion import SMPL22, Duet
from motion.metrics.sentences.joints import Motion
from motion.things import Thing

from .furnishing import FPS, FRAMES, put_hand, reaching, sitting, standing

HALF = FRAMES // 2


def apart() -> np.ndarray:
    """(2, T, 22, 3): a faces +Z, b is far behind them; in the second half a's hands are out ahead."""
    people = standing()
    people[1] += np.array([0.0, 0.0, -4.0])
    reach(people, HALF)
    return people


def reach(people: np.ndarray, first: int, who: int = 0) -> None:
    ahead = 1.0 if who == 0 else -1.0
    for side, sign in (("left", 1), ("right", -1)):
        pelvis = people[who, 0, 0]
        place = people[who, :, 0] + np.array([0.2 * sign * ahead, 1.3 - pelvis[1], 0.1 * ahead])
        place[first:, 2] += 0.4 * ahead
        put_hand(people[who], side, place)


def furnished(sentence: str, people: np.ndarray | None = None) -> tuple[dict[str, list[Thing]], Duet]:
    people = apart() if people is None else people
    duet = Duet.from_positions(people.astype(np.float32), fps=FPS)
    result = furnish(duet, [(read(sentence), 0, None, None)], ())
    kinds: dict[str, list[Thing]] = {}
    for thing in result.things:
        kinds.setdefault(thing.kind, []).append(thing)
    return kinds, result


@pytest.mark.parametrize(
    ("sentence", "kind", "name"),
    [
        ("A opens the window.", "window", "window"),
        ("A closes the curtains.", "window", "window"),
        ("A opens the door.", "door frame", "door"),
        ("A turns the hi-fi on.", "hi-fi", "stereo"),
        ("A turns the radio down.", "hi-fi", "radio"),
        ("A looks out of the window.", "window", "window"),
        ("A walks to the window.", "window", "window"),
    ],
)
def test_what_the_words_name_stands_before_the_person_and_faces_them(sentence, kind, name):
    kinds, duet = furnished(sentence)
    (body,) = kinds[kind]
    x, y, z = body.places[0]
    assert body.name == name and not body.moves
    assert (x, y) == (pytest.approx(0, abs=0.1), 0) and 0.4 < z < 1.2
    assert body.rotations[0] @ [0, 0, 1] == pytest.approx([0, 0, -1], abs=0.05)
    row = next(row for row in duet.manifest["things"] if row["kind"] == kind)
    assert row["events"][0]["by"] == "a" and row["events"][0]["at"] is not None


def test_hands_reach_what_they_use():
    (body,) = furnished("A turns the hi-fi on.")[0]["hi-fi"]
    knobs = body.mesh.vertices[body.mesh.vertices[:, 2] > 0.17]
    front = (knobs @ body.rotations[0].T + body.places[0])[:, 2]
    assert front.min() == pytest.approx(0.6, abs=0.12), "palms are 0.6 m ahead"


def stepping(metres: float) -> np.ndarray:
    """A person who reaches for a hi-fi, after a foot was so far ahead of them."""
    people = apart()
    people[0, : HALF // 2, [SMPL22.index("left_ankle"), SMPL22.index("left_foot")], 2] += metres
    return people


def front_of(body: Thing) -> float:
    low = body.mesh.vertices[body.mesh.vertices[:, 1] < 0.7]
    return float((low @ body.rotations[0].T + body.places[0])[:, 2].min())


def test_a_foot_that_steps_ahead_does_not_step_into_the_hi_fi():
    sentence = "A turns the hi-fi on."
    (near,), (back,) = (furnished(sentence, stepping(metres))[0]["hi-fi"] for metres in (0.0, 0.7))
    toe = stepping(0.7)[0, :, SMPL22.index("left_foot"), 2].max()
    assert front_of(near) < toe < front_of(back) < toe + 0.15
    (far,) = furnished(sentence, stepping(1.6))[0]["hi-fi"]
    assert front_of(far) == pytest.approx(front_of(near)), "it stays within reach"


def test_nothing_stands_there_for_what_is_wished_or_denied_or_is_no_fixture():
    for sentence in ("A does not open the window.", "A wants to open the window.", "A opens a gift.", "A waves."):
        assert not {"window", "door frame", "hi-fi"} & furnished(sentence)[0].keys(), sentence


def sill_gaps(sash: Thing, body: Thing) -> tuple[float, float]:
    """Metres of a sash's free edge before the wall, in the first and the last frame."""
    edge = sash.mesh.vertices[sash.mesh.vertices[:, 0].argmax()]
    out = []
    for frame in (0, -1):
        world = sash.rotations[frame] @ edge + sash.places[frame]
        out.append(float((body.rotations[frame].T @ (world - body.places[frame]))[2]))
    return out[0], out[1]


@pytest.mark.parametrize(("verb", "opens"), [("opens", True), ("closes", False)])
def test_a_window_opens_away_from_the_person_when_hands_are_at_it(verb, opens):
    kinds, _ = furnished(f"A {verb} the window.")
    for sash in kinds["sash"]:
        gaps = sill_gaps(sash, kinds["window"][0])
        shut, wide = gaps if opens else gaps[::-1]
        assert abs(shut) < 0.05 and wide < -0.4
        moved = np.abs(np.diff(sash.rotations, axis=0)).max(axis=(1, 2)) > 1e-5
        assert not moved[: HALF - 5].any() and moved[HALF:].any()
    assert not any(curtain.moves for curtain in kinds["curtain"])


def test_curtains_close_and_leave_the_window_alone():
    kinds, _ = furnished("A draws the curtains.")
    left, right = kinds["curtain"]
    assert abs(left.places[0, 0] - right.places[0, 0]) > 1.5 > 0.7 > abs(left.places[-1, 0] - right.places[-1, 0])
    assert not any(sash.moves for sash in kinds["sash"])


def test_a_window_that_is_opened_and_closed_is_one_window():
    people = apart()
    kinds, _ = furnished("A opens the window and then closes it.", people)
    assert len(kinds["window"]) == 1
    gaps = sill_gaps(kinds["sash"][0], kinds["window"][0])
    assert max(map(abs, gaps)) < 0.1, "it is closed at both ends"
    assert kinds["sash"][0].moves


def test_who_is_elsewhere_moves_nothing_and_the_manifest_says_so():
    people = apart()
    reach(people, 10, who=1)
    kinds, duet = furnished("A looks at the window. B closes it.", people)
    assert len(kinds["window"]) == 1
    events = next(row for row in duet.manifest["things"] if row["kind"] == "window")["events"]
    told = {event["by"]: event for event in events}
    assert told["b"]["at"] is not None and told["a"]["at"] is None and "m from it" in told["a"]["why"]
    assert kinds["window"][0].places[0, 2] < -2, "it stands before b, whose hands are at it"


def test_a_computer_is_on_the_desk_of_one_who_types():
    kinds, _ = furnished("A sits at a desk and types on a keyboard.", sitting())
    assert {"chair", "computer"} <= kinds.keys() and "table" not in kinds
    (desk,) = kinds["computer"]
    screen = desk.mesh.vertices[desk.mesh.vertices[:, 1] > 1.0]
    ahead = (screen @ desk.rotations[0].T + desk.places[0])[:, 2]
    assert ahead.min() > desk.places[0, 2], "the screen is at the far side"


# ---- verdicts --------------------------------------------------------------------------------------------
def verdict(sentence: str, duet: Duet) -> tuple[bool | None, str]:
    plan = read(sentence)
    (judged,) = judge_things(checked(plan, Motion(duet.positions, FPS)), plan, duet, 0, duet.num_frames, ())
    return judged.done, judged.measure


def test_a_look_at_a_window_is_judged_by_the_face():
    sentence = "A looks at the window."
    _, duet = furnished(sentence)
    assert verdict(sentence, duet) == (True, f"looks at it for {FRAMES / FPS:.1f} s")
    turned = duet.positions.copy()
    turned[0] = turned[0] * [-1, 1, -1]
    away = replace(Duet.from_positions(turned, fps=FPS), things=duet.things)
    assert verdict(sentence, away) == (False, "looks at it for 0.0 s")


def test_what_is_handed_over_is_judged_by_the_thing():
    found = verdict("A gives B a flower.", furnished("A gives B a flower.", reaching())[1])
    assert found == (True, "it goes from hand to hand at 1.8 s")
    assert verdict("A gives B a cheque.", furnished("A gives B a cheque.")[1]) == (None, "no cheque is drawn")
    gifts = "They exchange gifts."
    assert verdict(gifts, furnished(gifts, reaching())[1]) == (None, "only one thing is drawn")


def test_a_look_at_what_is_not_there_stays_unjudged():
    assert verdict("A looks at the wall.", furnished("A looks at the wall.")[1])[0] is None
    assert verdict("A looks at the window.", Duet.from_positions(apart().astype(np.float32), fps=FPS))[0] is None


@pytest.mark.parametrize(
    "sentence", ["A opens the window.", "A closes the window.", "A opens the door.", "A draws the curtains."]
)
def test_what_opens_or_closes_under_a_hand_is_done(sentence):
    done, measure = verdict(sentence, furnished(sentence)[1])
    assert done is True and measure.endswith("from it as it moves")


def test_what_nothing_measures_of_an_opening_is_said():
    sentence = "A slowly opens the window three times."
    _, duet = furnished(sentence)
    plan = read(sentence)
    (judged,) = judge_things(checked(plan, Motion(duet.positions, FPS)), plan, duet, 0, duet.num_frames, ())
    assert judged.done and {"how often", "how fast"} <= {*judged.unchecked} and "three" not in judged.words


def test_what_opens_far_from_any_hand_of_its_agent_is_not_done():
    _, duet = furnished("A opens the window.")
    away = duet.positions.copy()
    away[0, :, :, 2] -= 1.0
    far = Duet.from_positions(away, fps=FPS)
    done, measure = verdict("A opens the window.", replace(far, things=duet.things))
    assert done is False and 80 < int(measure.split()[1]) < 120


def test_a_window_of_which_nothing_moves_is_not_opened():
    _, duet = furnished("A looks at the window.")
    assert verdict("A opens the window.", duet) == (False, "nothing of it moves")


def test_an_opening_of_what_has_no_shape_is_not_judged():
    assert verdict("A opens a letter.", furnished("A looks at the window.")[1])[0] is None
