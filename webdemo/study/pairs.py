"""The pairs of a study: motions of different sets for the same sentence, and pairs with a known answer."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from motion import SMPL22, Clip, Duet, InputError, stacked_positions
from motion.skeleton import Skeleton
from motion.transforms import resample, turn

MOST_SETS = 6
MOST_STIMULI = 400
"""Motions of all sets together."""
MOST_PAIRS = 200
MOST_CHECKS = 20
FPS = 30.0
"""Frames a second at which every motion of a study is shown: a different rate would tell its origin."""
PIECE_SECONDS = 0.2
"""Length of the pieces of a shuffled motion."""


@dataclass(frozen=True)
class Stimulus:
    """One motion of a set.

    Attributes:
        caption: the sentence that it was made from, which voters may see; empty for none.
        motion: of one person or two.
        seed: pairs are made of equal seeds where there are any.
        name: motions of the same name stand beside each other, such as that of a file; the caption by default.
    """

    caption: str
    motion: Duet | Clip = field(repr=False)
    seed: int | None = None
    name: str = ""

    @property
    def key(self) -> str:
        """The name without its capitals and marks."""
        words = (self.name or self.caption).lower().replace("-", " ").replace("_", " ")
        return " ".join(words.split()).rstrip(".")


@dataclass(frozen=True)
class Pair:
    """Two motions that are shown side by side.

    Attributes:
        sets: the numbers of their sets; the same number twice for an attention check.
        motions: the numbers of the motions among all of the study.
        caption: the sentence of both; empty where they have different ones.
        known: the first or the second of :data:`~.results.ANSWERS` for an attention check, whose right answer it is.
    """

    sets: tuple[int, int]
    motions: tuple[int, int]
    caption: str = ""
    known: str = ""


def matched_pairs(sets: Sequence[Sequence[Stimulus]]) -> list[Pair]:
    """Every motion of a set beside one of each other set: of the same sentence and seed where there are any.

    Sets without a common sentence are paired in their order. Motions are numbered through all sets.

    Raises:
        InputError: for fewer than two sets, too many pairs or none at all, or motions that cannot be compared.
    """
    if not 2 <= len(sets) <= MOST_SETS:
        raise InputError(
            f"A study compares 2 to {MOST_SETS} sets of motions, not {len(sets)}: choose runs that differ in a "
            "setting, tag them, or upload motions as another set."
        )
    if sum(map(len, sets)) > MOST_STIMULI:
        raise InputError(f"A study holds {MOST_STIMULI} motions at most: choose fewer runs.")
    starts = np.cumsum([0, *map(len, sets)]).tolist()
    pairs = []
    for i, j in combinations(range(len(sets)), 2):
        for first, second in _matches(sets[i], sets[j]):
            captions = {sets[i][first].caption, sets[j][second].caption} - {""}
            same = captions.pop() if sets[i][first].key == sets[j][second].key and len(captions) == 1 else ""
            pairs.append(Pair((i, j), (starts[i] + first, starts[j] + second), same))
    if not pairs:
        raise InputError("These sets make no pairs: choose runs of the same sentences for each set.")
    if len(pairs) > MOST_PAIRS:
        raise InputError(
            f"These sets make {len(pairs)} pairs: choose fewer runs, {MOST_PAIRS} pairs at most."
        )
    motions = [each.motion for each_set in sets for each in each_set]
    for pair in pairs:
        one, other = (motions[number] for number in pair.motions)
        if one.skeleton.joint_names != other.skeleton.joint_names or type(one) is not type(other):
            raise InputError(
                "Some of these motions have different joints or numbers of people, so they cannot be compared: "
                "choose others."
            )
    return pairs


def _matches(ours: Sequence[Stimulus], theirs: Sequence[Stimulus]) -> list[tuple[int, int]]:
    """Numbers of the motions of two sets that stand beside each other."""
    common = {each.key for each in ours} & {each.key for each in theirs}
    found: list[tuple[int, int]] = []
    for key in sorted(common):
        left, right = ([i for i, each in enumerate(side) if each.key == key] for side in (ours, theirs))
        for i in list(left):
            equal = [j for j in right if ours[i].seed is not None and theirs[j].seed == ours[i].seed]
            if equal:
                found.append((i, equal[0]))
                left.remove(i)
                right.remove(equal[0])
        found += zip(left, right, strict=False)
    return sorted(found) if common else list(zip(range(len(ours)), range(len(theirs)), strict=False))


# ---- what is shown ---------------------------------------------------------------------------------


def as_shown(motion: Duet | Clip) -> Duet | Clip:
    """A motion without what would tell its origin: at :data:`FPS`, in the middle, turned the same way, no names.

    The first frame decides where the middle is; two people stand along the Z axis in it, one faces +Z.
    """
    people = np.stack([resample(person, motion.fps, FPS) for person in stacked_positions(motion)])
    start = people[:, 0, 0]
    people -= start.mean(axis=0) * np.array([1.0, 0.0, 1.0])
    people = turn(people, -_direction(people, motion.skeleton))
    if isinstance(motion, Duet):
        return Duet.from_positions(people, fps=FPS, skeleton=motion.skeleton)
    return Clip(people[0], FPS, motion.skeleton)


def _direction(people: np.ndarray, skeleton: Skeleton) -> float:
    """Heading in radians of the line from A to B in the first frame, or of the only person."""
    if len(people) > 1:
        line = people[1, 0, 0] - people[0, 0, 0]
    elif skeleton.joint_names == SMPL22.joint_names:
        across = people[0, 0, skeleton.index("left_hip")] - people[0, 0, skeleton.index("right_hip")]
        line = np.array([-across[2], 0.0, across[0]])
    else:
        return 0.0
    return float(np.arctan2(line[0], line[2]))


def shuffled(motion: Duet | Clip, seed: int) -> Duet | Clip:
    """A motion that is worse than itself by any question: its pieces in random order, each person's in another."""
    draw = np.random.default_rng(seed)
    length = max(round(PIECE_SECONDS * motion.fps), 1)
    frames = np.arange(motion.num_frames)
    people = []
    for person in stacked_positions(motion):
        pieces = np.array_split(frames, max(len(frames) // length, 2))
        order = draw.permutation(len(pieces))
        while len(pieces) > 2 and (order == np.arange(len(pieces))).all():
            order = draw.permutation(len(pieces))
        people.append(person[np.concatenate([pieces[i] for i in order])])
    return motion.with_positions(people) if isinstance(motion, Duet) else motion.with_positions(people[0])


def check_sources(pairs: Sequence[Pair], count: int, seed: int) -> list[Pair]:
    """The pairs whose first motion is shown beside its own shuffled copy, as attention checks."""
    if not 0 <= count <= MOST_CHECKS:
        raise InputError(f"A study has 0 to {MOST_CHECKS} attention checks, not {count}.")
    sources = list({pair.motions[0]: pair for pair in pairs}.values())
    draw = random.Random(seed)
    return (
        [draw.choice(sources) for _ in range(count)] if count > len(sources) else draw.sample(sources, count)
    )
