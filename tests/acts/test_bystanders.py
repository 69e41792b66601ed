"""No rule of the lexicon holds on two recorded people who idle, talk or walk by."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from acts import lexicon
from acts.checking import cast
from acts.plan import ON_TIPTOE, Act
from acts.qualifiers import qualifiers
from motion.metrics.sentences.joints import Motion
from motion.metrics.sentences.language import check, measured
from motion.transforms import facing

RECORDED = Path(__file__).parents[1] / "data" / "bystanders" / "bystanders.npz"
STANDS = {"stand-still", "freeze", "keep-distance", "face-other"}
TALKS = {"talk", "argue", "nod", "bend-arm", "look-up"}
"""What a person does who talks with hands and head."""
WALKS = {"walk-up", "walk-away", "walk-past", "walk-ahead", "move-about", "step-forward", "part", "step-over"}
WALKS |= {"cross-way", "return", "go-back", "exit", "enter", "back-turned", "copy", "mirror"}
"""What two people do who walk past each other: come near, go away, leave the other behind, step alike."""
WALK = lexicon().entries["walk-ahead"]
PAIRS = {
    "idle": [
        ("idle_1", "idle_2", 1.3),
        ("idle_3", "idle_4", 0.9),
        ("idle_5", "idle_6", 1.8),
        ("idle_7", "idle_8", 1.1),
    ],
    "talk": [("talk_1", "idle_2", 1.3), ("talk_2", "talk_3", 1.1), ("talk_3", "idle_7", 1.0)],
    "walk by": [("walk_1", "idle_4", 2.0), ("walk_2", "idle_1", 2.0), ("walk_1", "walk_2", 4.0)],
}
"""The names of a and b, and metres between them where they begin, by what they do."""


def person(name: str) -> np.ndarray:
    """(120, 22, 3) metres, from the origin and facing, or walking, along Z."""
    with np.load(RECORDED) as kept:
        joints = np.cumsum(kept[name], axis=0, dtype=np.int32) / 1000.0
    way = joints[-1, 0] - joints[0, 0] if name.startswith("walk") else facing(joints[:1])[0]
    angle = -np.arctan2(way[0], way[2])
    cos, sin = np.cos(angle), np.sin(angle)
    return joints @ np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]]).T


def pair(a: str, b: str, gap: float) -> Motion:
    """Two people who face each other; one who walks passes the other a metre to the side."""
    first, second = person(a), person(b) * [-1, 1, -1] + [0, 0, gap]
    first[..., 0] += 1.0 if a.startswith("walk") else 0.0
    return Motion(np.stack([first, second]), 30.0)


@pytest.mark.parametrize("kind", PAIRS)
def test_no_rule_holds_on_bystanders_but_for_what_they_do(kind: str) -> None:
    does = {"idle": STANDS, "talk": STANDS | TALKS, "walk by": STANDS | WALKS}[kind]
    motions = [pair(*each) for each in PAIRS[kind]]
    found = {
        f"{name}: {' and '.join(entry.rule)}"
        for name, entry in lexicon().entries.items()
        for motion in motions
        for who, whom in (("a", "b"), ("b", "a"))
        if entry.rule and name not in does and all(check(cast(rule, who, whom), motion) for rule in entry.rule)
    }
    assert not found


def test_every_rule_that_fails_says_what_is_missing() -> None:
    motion = pair(*PAIRS["idle"][0])
    rules = [cast(rule, "a", "b") for entry in lexicon().entries.values() for rule in entry.rule]
    said = {rule: measured(rule, motion, lacking=True) for rule in rules if not check(rule, motion)}
    assert not [rule for rule, reason in said.items() if not re.search(r"needed|not ", reason)]


def test_who_walks_as_usual_is_not_on_tiptoe() -> None:
    for names in PAIRS["walk by"]:
        motion = pair(*names)
        for who in "ab":
            asked = qualifiers(Act(id="1", act="walk-ahead", agents=(who,), manner=(ON_TIPTOE,)), WALK, who, "", "")
            assert not any(check(rule, motion) for _, rule in asked if rule)
