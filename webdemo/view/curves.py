"""What the strip under the player draws: distances between two people and when they touch.

Pure geometry of joint positions. The measures that results are judged by live in
:mod:`webdemo.metrics`; these only have to be quick and easy to read off a timeline.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]

TOUCH_DISTANCE = 0.2
"""Metres between a wrist or foot *joint* and the other's body that count as touching: skeletons of 22
joints end at the wrist, and a hand reaches about 0.19 m beyond it."""
_JOIN_GAP = 0.1
_SHORTEST = 0.05


@dataclass(frozen=True)
class Curve:
    """One value a frame.

    Attributes:
        key: what a program calls it.
        label: what the page calls it.
        unit: behind the value, such as ``"m"``.
        values: (T,).
    """

    key: str
    label: str
    unit: str
    values: Array


@dataclass(frozen=True)
class Contact:
    """A stretch of frames during which the two people touch.

    Attributes:
        start: first frame.
        stop: one past the last frame.
        kind: ``"hands"`` (hand on hand), ``"touch"`` (hand on body) or ``"foot"`` (foot on body).
        label: for people, such as ``"hand of A on B"``.
    """

    start: int
    stop: int
    kind: str
    label: str


def joints_named(joint_names: Sequence[str], *words: str) -> list[int]:
    """Indices of the joints whose name has one of ``words`` in it, first word first."""
    for word in words:
        found = [i for i, name in enumerate(joint_names) if word in name.lower()]
        if found:
            return found
    return []


def interaction_curves(positions: Array, joint_names: Sequence[str]) -> list[Curve]:
    """Distance between the two pelvises over the floor plan, and between the nearest pair of wrists.

    Args:
        positions: (2, T, J, 3) metres, Y up.
        joint_names: J names; a curve whose joints are missing is left out.

    Returns:
        Curves in metres; empty for a single person.
    """
    if len(positions) != 2:
        return []
    a, b = np.asarray(positions, dtype=np.float64)
    curves = []
    if pelvis := (joints_named(joint_names, "pelvis", "hips", "base_of_spine", "torso") or [0]):
        apart = np.linalg.norm((a - b)[:, pelvis[0]][:, [0, 2]], axis=-1)
        curves.append(Curve("pelvis_distance", "Apart", "m", apart))
    if wrists := joints_named(joint_names, "wrist", "hand"):
        pairs = np.linalg.norm(a[:, wrists, None] - b[:, None, wrists], axis=-1)
        curves.append(Curve("wrist_distance", "Hands", "m", pairs.min(axis=(1, 2))))
    return curves


def find_contacts(
    positions: Array, joint_names: Sequence[str], parents: Sequence[int], *, fps: float,
    touch_distance: float = TOUCH_DISTANCE,
) -> list[Contact]:  # fmt: skip
    """Stretches during which a hand or foot of one person is at the other's body.

    Args:
        positions: (2, T, J, 3) metres.
        joint_names: J names.
        parents: J indices, -1 for the root.
        fps: frames a second.
        touch_distance: metres between joint and body that count as touching.

    Returns:
        Contacts by start; stretches closer than 0.1 s are joined, those under 0.05 s are dropped.
    """
    if len(positions) != 2:
        return []
    people = np.asarray(positions, dtype=np.float64)
    hands = joints_named(joint_names, "wrist", "hand")
    feet = joints_named(joint_names, "foot", "ankle", "toe")
    children = [j for j, parent in enumerate(parents) if parent >= 0]
    middles = 0.5 * (people[:, :, children] + people[:, :, [parents[j] for j in children]])
    # A limb is longer than the touch distance, so its middle stands in for the skin between two joints.
    others = [j for j in range(len(joint_names)) if j not in hands]
    body = np.concatenate([people[:, :, others], middles], axis=2)

    found: list[Contact] = []

    def collect(touching: NDArray[np.bool_], kind: str, label: str) -> None:
        found.extend(Contact(start, stop, kind, label) for start, stop in _stretches(touching, fps))

    def near(points: Array, targets: Array) -> NDArray[np.bool_]:
        gaps = np.linalg.norm(points[:, :, None] - targets[:, None], axis=-1)
        return (gaps < touch_distance).any(axis=(1, 2))

    hand_on_hand = np.zeros(people.shape[1], dtype=bool)
    if hands:
        hand_on_hand = near(people[0][:, hands], people[1][:, hands])
        collect(hand_on_hand, "hands", "hand on hand")
    for me, (mine, other) in enumerate((("A", "B"), ("B", "A"))):
        if hands:
            # A handshake also brings the hand near the other's forearm; it is one contact, not two.
            on_body = near(people[me][:, hands], body[1 - me]) & ~hand_on_hand
            collect(on_body, "touch", f"hand of {mine} on {other}")
        if feet:
            lower = [j for j in feet if j < people.shape[2]]
            collect(near(people[me][:, lower], body[1 - me]), "foot", f"foot of {mine} on {other}")
    return sorted(found, key=lambda contact: (contact.start, contact.kind))


def _stretches(flags: NDArray[np.bool_], fps: float) -> list[tuple[int, int]]:
    """(start, stop) of the runs of True, joined over short gaps, without the shortest."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    joined: list[list[int]] = []
    for start, stop in edges.reshape(-1, 2).tolist():
        if joined and start - joined[-1][1] <= _JOIN_GAP * fps:
            joined[-1][1] = stop
        else:
            joined.append([start, stop])
    return [(start, stop) for start, stop in joined if stop - start >= _SHORTEST * fps]
