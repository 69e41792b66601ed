"""Two people who stand or sit, and the things that a plan gives them."""

from __future__ import annotations

import numpy as np

from acts import Act, Plan
from acts.things.furnishing import furnish
from motion import SMPL22, Duet
from motion.things import Thing
from motion.things.hands import Hands

FPS, FRAMES = 30, 120
REST = SMPL22.standing()
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
    upper = [j for j, name in enumerate(SMPL22.joint_names) if not any(p in name for p in ("knee", "ankle", "foot"))]
    people[:, :, upper, 1] -= 0.4
    for person, ahead in zip(people, (1.0, -1.0), strict=True):
        for side in ("left", "right"):
            person[:, SMPL22.index(f"{side}_knee"), 2] += 0.4 * ahead
            for name in ("ankle", "foot"):
                person[:, SMPL22.index(f"{side}_{name}"), 2] += 0.4 * ahead
    return people


def things_of(people: np.ndarray, *acts: Act, sentence: str = "") -> tuple[Thing, ...]:
    duet = Duet.from_positions(people.astype(np.float32), fps=FPS)
    result = furnish(duet, [(Plan(sentence=sentence, acts=acts), 0, None, None)], ())
    np.testing.assert_array_equal(result.positions, duet.positions, "the people are moved")
    rows = (result.manifest or {}).get("things", [])
    assert [row["kind"] for row in rows] == [thing.kind for thing in result.things]
    return result.things


def act(name: str, agents: str = "a", **fields) -> Act:
    return Act(id=fields.pop("id", "1"), act=name, agents=tuple(agents), **fields)


def worded(sentence: str, name: str, agents: str = "a", **fields) -> tuple[Act, str]:
    return act(name, agents, words={"start": 0, "stop": len(sentence)}, **fields), sentence


def palms(people: np.ndarray) -> np.ndarray:
    """(2, 2, T, 3)."""
    return Hands.of(Duet.from_positions(people.astype(np.float32), fps=FPS)).palms


def reaching() -> np.ndarray:
    """Both reach out with their right hands, which meet in the middle at frame 60."""
    people = standing()
    reach = np.exp(-(((np.arange(FRAMES) - 60) / 12.0) ** 2))[:, None]
    for person, hang in zip(people, (np.array([-0.22, 0.9, 0.12]), np.array([0.22, 0.9, GAP - 0.12])), strict=True):
        put_hand(person, "right", hang + reach * (np.array([0.0, 1.15, GAP / 2]) - hang))
    return people
