"""Predicates on limbs, levels and unison, each shown on a body that does it and on one that does not."""

from __future__ import annotations

import numpy as np
import pytest

from motion.metrics.sentences.joints import PREDICATES, Motion
from motion.metrics.sentences.language import RuleError, check, measured

from .figures import FPS, Place, duet, each, elbow_on, index, put, rise, shift, spin, swing, tilt

BENT = [*each("knee", (0.1, -0.2, 0.35)), *each("ankle", (0.1, -0.5, 0.0))]
DOES: dict[str, tuple[Motion, str]] = {
    "hand_over_head": (duet(put("left_wrist", (0.2, 0.9, 0.0))), "a, 'left'"),
    "hand_near_floor": (duet(put("left_wrist", (0.2, -0.7, 0.3))), "a"),
    "arms_wide": (duet(*each("wrist", (0.5, 0.0, 0.0), "shoulder")), "a"),
    "arms_crossed": (duet(*each("wrist", (-0.15, 0.2, 0.2))), "a, 0.4"),
    "holds_in_front": (duet(*each("wrist", (0.15, 0.2, 0.35))), "a"),
    "hands_ahead": (duet(*each("wrist", (0.15, -0.1, 0.35))), "a"),
    "hands_apart": (duet(*each("wrist", (0.5, 0.2, 0.0))), "a"),
    "arm_level": (duet(put("left_wrist", (0.0, 0.0, 0.5), base="left_shoulder")), "a, 'left'"),
    "hand_behind_back": (duet(put("left_wrist", (0.0, 0.0, -0.2))), "a, 'left'"),
    "knees_bent": (duet(*BENT), "a"),
    "knee_high": (duet(put("left_knee", (0.1, -0.1, 0.35))), "a, 'left'"),
    "heels_up": (duet(rise), "a"),
    "foot_up": (duet(put("left_ankle", (0.1, -0.5, 0.0))), "a, 'left'"),
    "wide_stance": (duet(put("left_ankle", (0.1, -0.88, 0.7))), "a"),
    "leans": (duet(tilt(30, (0, 1))), "a, 'towards'"),
    "turned": (duet(spin(180)), "a, 180"),
    "turns_way": (duet(spin(120)), "a, 'left'"),
    "off_floor": (duet(shift((0, 0.4, 0), (0, 0.4, 0))), "a"),
    "goes_at": (duet(shift((0, 0, -2), (0, 0, 0))), "a, 0.3, 0.8"),
    "goes_ahead": (duet(shift((0, 0, -2), (0, 0, 0))), "a"),
    "moves": (duet(swing(0, "left")), "a"),
    "higher": (duet(shift((0, -0.5, 0), (0, -0.5, 0), who=1)), "a"),
    "back_to_back": (duet(gap=-0.4), ""),
    "in_front": (duet(), "a"),
    "at_others_start": (duet(shift((0, 0, 0), (0, 0, 2))), "a"),
    "arm_on": (duet(elbow_on), "a, 'shoulder'"),
    "hips_meet": (duet(lambda both: np.copyto(both[1], both[0] + [0.36, 0, 0])), ""),
    "alike": (duet(swing(0, "left"), swing(1, "left")), ""),
    "copies": (duet(swing(0, "left"), swing(1, "left", 0.8)), "b"),
}


IDLE = duet()


@pytest.mark.parametrize("name", DOES)
def test_it_holds_for_those_who_do_it_and_not_for_those_who_stand(name: str) -> None:
    motion, arguments = DOES[name]
    rule = f"happens({name}({arguments}))"
    assert check(rule, motion)
    still = duet(gap=-2.0) if name == "in_front" else IDLE
    assert not check(rule, still)


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("hand_over_head", "a, 'right'"),
        ("leans", "a, 'back'"),
        ("turns_way", "a, 'right'"),
        ("higher", "b"),
        ("copies", "a"),
        ("alike", "mirrored=True"),
        ("at_others_start", "b"),
        ("arm_on", "b, 'shoulder'"),
    ],
)
def test_it_does_not_hold_for_the_other_side_way_or_person(name: str, arguments: str) -> None:
    assert not check(f"happens({name}({arguments}))", DOES[name][0])


@pytest.mark.parametrize(
    ("part", "joint", "on", "off"),
    [
        ("face", "head", (0.0, 0.0, 0.12), (0.0, 0.0, -0.12)),
        ("shoulder", "left_shoulder", (0.0, 0.08, 0.0), (0.0, -0.16, 0.1)),
        ("waist", "pelvis", (0.15, 0.0, 0.0), (0.02, 0.0, -0.18)),
        ("chest", "spine3", (0.0, 0.0, 0.15), (0.0, 0.0, -0.15)),
        ("back", "spine3", (0.0, 0.0, -0.1), (0.0, 0.0, 0.17)),
    ],
)
def test_a_hand_is_on_a_part_where_that_is_on_the_body(part: str, joint: str, on: Place, off: Place) -> None:
    """And not as near to it on another side: the hand of a at a place beside a joint of b, who looks back."""
    rule = f"happens(hand_on(a, '{part}', gap=0.25))"
    laid, missed = duet(), duet()
    for motion, place in ((laid, on), (missed, off)):
        aside, up, ahead = place
        motion.positions[0, :, index("left_wrist")] = motion.positions[1, :, index(joint)] + [-aside, up, -ahead]
    assert check(rule, laid) and not check(rule, missed)
    assert measured(rule, missed, lacking=True) == f"needed: a hand (wrist or palm) is on the other's {part}"


# ---- conditions -------------------------------------------------------------------------------------------
def test_conditions_are_joined_by_and_and_or() -> None:
    motion = DOES["goes_ahead"][0]
    yes, no = "happens(goes_ahead(a))", "happens(goes_ahead(b))"
    assert check(f"{yes} or {no}", motion) and not check(f"{yes} and {no}", motion)
    assert check(f"{yes} and ({no} or {yes})", motion)
    with pytest.raises(RuleError, match="is not known here"):
        check(f"{yes} or happens(flies(a))", motion)
    with pytest.raises(RuleError, match="must begin with"):
        check("not happens(goes_ahead(b))", motion)


def test_a_lean_is_measured_in_the_way_that_is_asked_for() -> None:
    motion = duet(tilt(30, (0, 1)))
    assert measured("happens(leans(a, 'left'))", motion, lacking=True) == "trunk leans to the left by 0°, 15° needed"
    assert measured("happens(runs(a, 0.5))", motion, lacking=True) == "A reaches 0.0 m/s, 1.7 m/s needed"
    assert measured("never(near(9.0))", motion, lacking=True) == "they stay 2.0 m apart, more than 9.0 m needed"
    just = "they stay just under 2.0 m apart, more than 2.0 m needed"
    assert measured("never(near(2.001))", motion, lacking=True) == just
    assert measured("happens(goes_way(a, 'right'))", motion, lacking=True) == "A goes 0 cm to the right, 30 cm needed"
    assert measured("happens(leans(a, 'forward'))", motion) == "trunk leans forward by 30°"
    both = "happens(both(leans(a, 'forward'), near(0.5)))"
    assert measured(both, motion, lacking=True) == "they stay 2.0 m apart, 50 cm needed", "and not what holds"
    assert measured("happens(leans(a, 'any'))", motion) == "trunk leans by 30°"


def test_a_child_reaches_out_as_far_as_its_arm() -> None:
    """A wrist that is 25 cm before the shoulder is held out by a child, and not by an adult."""
    adult = duet(put("left_wrist", (0.2, 0.25, 0.25)))
    child = Motion(adult.positions * np.array([[[[0.74]]], [[[1.0]]]]), FPS)
    child.positions[0, :, index("left_wrist")] = child.positions[0, :, index("left_shoulder")] + [0.0, -0.2, 0.25]
    assert adult.size(0) == 1.0 and child.size(0) == pytest.approx(0.74)
    assert not PREDICATES["reaches"](adult, 0).any() and PREDICATES["reaches"](child, 0).all()
