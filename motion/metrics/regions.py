"""Touches between regions of two bodies: hands, arms, shoulders, chests, heads and feet."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from motion.clip import Duet
from motion.skeleton import Skeleton

from .bodies import Capsules, capsules, segment_segment_distance, sideless
from .interaction import HANDS_TOUCH, SKIN_TOUCH, above_ground, hand_distance, hand_touching, touching

Mask = NDArray[np.bool_]

REGIONS = {
    "arm": ("elbow", "wrist"),
    "shoulder": ("collar", "shoulder"),
    "chest": ("spine1", "spine2", "spine3"),
    "head": ("neck", "head"),
}
"""The bones of a region, by the joint in which they end, without its side."""
PAIRS = ("hand–hand", "hand–arm", "hand–shoulder", "hand–chest", "hand–head", "chest–chest", "foot–body")
SHORTEST = 0.1
"""Seconds for which regions must touch to count."""


def region_contacts(duet: Duet) -> dict[str, Mask]:
    """The frames in which regions of the two touch.

    Hands meet within 10 cm of each other; a hand or a foot touches within 5 cm of the surface of the other's
    capsules, and chests where their capsules come within 5 cm. Feet side by side on the floor are no touch.

    Args:
        duet: of a skeleton with ankles and feet, such as SMPL's 22 joints.

    Returns:
        for every name of :data:`PAIRS` a (2, T) mask: the first row for the hand, chest or foot of a on b,
        the second for those of b on a. Both rows are equal where the regions are of one kind.
    """
    body = capsules(duet.skeleton)
    feet = [duet.skeleton.index(f"{s}_{p}") for s in ("left", "right") for p in ("foot", "ankle")]
    meet = hand_distance(duet) < HANDS_TOUCH
    found = {"hand–hand": np.stack([meet, meet])}
    for region in REGIONS:
        part = _region(body, duet.skeleton, region)
        found[f"hand–{region}"] = np.stack([hand_touching(duet, me, part) for me in (0, 1)])
    chest = _region(body, duet.skeleton, "chest")
    chests = _capsules_touch(duet, chest)
    found["chest–chest"] = np.stack([chests, chests])
    solid = above_ground(body, duet.skeleton)
    found["foot–body"] = np.stack(
        [
            touching(duet.people[me].positions[:, feet], duet.people[1 - me].positions, solid, margin=SKIN_TOUCH)
            for me in (0, 1)
        ]
    )
    return {name: found[name] for name in PAIRS}


def _region(body: Capsules, skeleton: Skeleton, region: str) -> Capsules:
    return body.part([sideless(skeleton.joint_names[end]) in REGIONS[region] for end in body.ends])


def _capsules_touch(duet: Duet, part: Capsules) -> Mask:
    a, b = duet.positions
    found = np.zeros(duet.num_frames, dtype=bool)
    for i in range(len(part.starts)):
        for j in range(len(part.starts)):
            gap = segment_segment_distance(
                a[:, part.starts[i]], a[:, part.ends[i]], b[:, part.starts[j]], b[:, part.ends[j]]
            )
            found |= gap - part.radii[i] - part.radii[j] < SKIN_TOUCH
    return found


def contact_precision_recall(
    made: Iterable[Duet], recorded: Iterable[Duet]
) -> dict[str, Mapping[str, tuple[int, int]]]:
    """Compares the regions that touch in generated motion with those in recorded motion of the same words.

    A region of a on one of b and the same of b on a are two touches, so that exchanged roles count as wrong.

    Args:
        made, recorded: duets, pair by pair.

    Returns:
        for every name of :data:`PAIRS`: ``precision`` (touches made that were recorded, touches made) and
        ``recall`` (the same, touches recorded).
    """
    tally = {name: np.zeros(3, dtype=int) for name in PAIRS}
    for one, other in zip(made, recorded, strict=True):
        touches = [_held(region_contacts(duet), duet.fps) for duet in (one, other)]
        for name in PAIRS:
            # Where both rows are equal by nature the touch is one, not two.
            rows = slice(0, 1) if name in ("hand–hand", "chest–chest") else slice(0, 2)
            mine, theirs = touches[0][name][rows], touches[1][name][rows]
            tally[name] += [int((mine & theirs).sum()), int(mine.sum()), int(theirs.sum())]
    return {
        name: {"precision": (int(both), int(mine)), "recall": (int(both), int(theirs))}
        for name, (both, mine, theirs) in tally.items()
    }


def _held(contacts: Mapping[str, Mask], fps: float) -> dict[str, Mask]:
    """(2,) whether each touch lasts long enough."""
    frames = max(1, round(SHORTEST * fps))
    window = np.ones(frames)
    return {
        name: np.array([(np.convolve(row, window, mode="valid") >= frames - 1e-9).any() for row in mask])
        if mask.shape[1] >= frames
        else np.zeros(2, dtype=bool)
        for name, mask in contacts.items()
    }
