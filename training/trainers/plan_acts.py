"""The plans that a training scene's label gives to the network: whole, in part, or not at all.

The lab knows what happens, seldom exactly when, and it plans no transitions. So the times of a label are moved a little
or lost, transitions and sides are left out, and a scene may have its words, its plan, both or neither.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from models.intergen.plan_track import TimedAct
from training.corpus.cues import Label
from webdemo.inference.timed import timed_act

FEWEST = 20
"""Scenes in which a word must occur to be in a network's vocabulary."""
MOVED = 10.0
"""Frames by which the beginning and the end of an act are moved at most."""
MIRRORED = {
    "left": "right", "right": "left", "clockwise": "counterclockwise", "counterclockwise": "clockwise",
}  # fmt: skip


@dataclass(frozen=True)
class PlanShares:
    """Probabilities of what is told of a scene, and of what its plan leaves out.

    Attributes:
        neither: neither words nor plan, for classifier-free guidance.
        words: words alone; ``plan``: the plan alone; the rest of the scenes have both.
        untimed: of the plans, those whose acts last as long as the motion.
        minor: of the transitions, those that are left out.
        side: of the plans, those without sides.
    """

    neither: float = 0.1
    words: float = 0.25
    plan: float = 0.3
    untimed: float = 0.1
    minor: float = 0.5
    side: float = 0.3


MOSTLY_PLANS = PlanShares(words=0.05, plan=0.35)
"""What is told where only what reads the plan is trained: words alone teach it little."""


@dataclass(frozen=True)
class LabelledAct:
    """An act of a label, and whether it is a transition."""

    act: TimedAct
    minor: bool


def acts_of_label(row: dict[str, Any]) -> tuple[LabelledAct, ...]:
    """The acts of a prepared scene that happen, in its frames; none for a scene without a label."""
    if not row.get("label"):
        return ()
    label = Label.of_row(row["label"])
    return tuple(
        LabelledAct(timed_act(act, *map(float, label.spans[act.id])), act.id in label.minor)
        for act in label.plan.acts
        if act.happens
    )


def vocabulary(scenes: Iterable[Sequence[LabelledAct]], fewest: int | None = None) -> tuple[str, ...]:
    """The words of plans that occur in enough scenes (:data:`FEWEST`), and their mirror images, sorted."""
    counts: Counter[str] = Counter()
    for acts in scenes:
        known = {word for one in acts for word in (*one.act.words, one.act.undergone)}
        counts.update({word for word in known if not word.startswith("undergo ")})
        counts.update({one.act.undergone for one in acts if one.act.patient is not None})
    kept = {word for word, count in counts.items() if count >= (FEWEST if fewest is None else fewest)}
    return tuple(sorted(kept | {_mirrored_word(word) for word in kept}))


def told(
    acts: Sequence[LabelledAct],
    shares: PlanShares,
    draw: Sequence[float],
    *,
    before: float = 0.0,
    frames: float,
) -> list[TimedAct]:
    """A plan as the network is told it.

    Args:
        acts: of the label.
        shares: what is left out how often.
        draw: numbers uniform in [0, 1): whether it is untimed, whether sides are left out, then three an act, as far as
            they go: for a transition whether it is left out, and by how much beginning and end are moved.
        before: frames of the scene that were cut off before the motion.
        frames: of the motion.
    """
    untimed, sideless = draw[0] < shares.untimed, draw[1] < shares.side
    found = []
    for one, at in zip(acts, range(2, len(draw) - 2, 3), strict=False):
        if one.minor and draw[at] < shares.minor:
            continue
        act = one.act
        start = act.start - before + MOVED * (2 * draw[at + 1] - 1)
        stop = max(act.stop - before + MOVED * (2 * draw[at + 2] - 1), start + 1)
        if stop <= 0 or start >= frames:
            continue
        span = (0.0, frames) if untimed else (start, stop)
        found.append(replace(act, start=span[0], stop=span[1], side=None if sideless else act.side))
    return found


def mirrored_act(act: TimedAct) -> TimedAct:
    """The act in the scene's mirror image."""
    side, direction = (MIRRORED.get(value or "", value) for value in (act.side, act.direction))
    return replace(act, side=side, direction=direction)


def sides_named(acts: Sequence[TimedAct]) -> str:
    """The sides of a plan's acts in words, see :func:`training.core.handedness.mirrored`."""
    return " ".join(f"the {act.side} hand" for act in acts if act.side in ("left", "right"))


def _mirrored_word(word: str) -> str:
    kind, _, value = word.partition(" ")
    return f"{kind} {MIRRORED.get(value, value)}" if kind in ("side", "direction") else word
