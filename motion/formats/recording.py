"""What is known of a file before it is read (:class:`ImportChoices`), and what a reader finds in it, as it is there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from motion.clip import Clip
from motion.errors import InputError
from motion.guesses import AXES
from motion.rigs import RigMotion
from motion.skeleton import SKELETONS

MAX_PEOPLE = 6

Animation = int | str
"""A choice: the number of an animation, from 1, or its name."""

_LISTED = 5
"""Animations that a message lists."""
RATES = (1.0, 1000.0)
ORDERS = {"sbu15": "SBU", "k3hi15": "K3HI", "cmu17": "CMU", "h36m17": "Human3.6M", "coco17": "COCO"}
"""Display names of joint orders that share a number of joints."""


@dataclass(frozen=True)
class ImportChoices:
    """Known facts about a file; a field that is None is found from its contents.

    Attributes:
        up: what points up: "x", "y", "z", or "-x", "-y", "-z" where that axis points down.
        fps: frames a second; overrides the file, before anything is checked.
        order: order of joints without names: a key of :data:`~motion.SKELETONS`, such as
            "sbu15" or "h36m17".
        animation: the name or the number, from 1, of the one to read of a .glb with several.
    """

    up: str | None = None
    fps: float | None = None
    order: str | None = None
    animation: Animation | None = None

    def __post_init__(self) -> None:
        check_animation(self.animation)
        if self.up is not None and self.up not in AXES:
            raise InputError(f"Up axis {self.up!r:.20} is not known: choose x, y or z, or -x, -y or -z.")
        if self.fps is not None and not RATES[0] <= self.fps <= RATES[1]:
            raise InputError(f"A frame rate of {self.fps!r:.20} is not possible: give {RATES[0]:g} to 1,000.")
        if self.order is not None and self.order not in SKELETONS:
            raise InputError(f"Joint order {self.order!r:.20} is not known: choose one of {', '.join(SKELETONS)}.")


def check_animation(animation: Animation | None) -> None:
    """Raises InputError for a choice that is neither a name nor a number from 1."""
    if animation is None or (type(animation) is int and animation >= 1):
        return
    if not isinstance(animation, str) or not animation.strip():
        raise InputError(f"Animation {animation!r:.40} is neither a name nor a number from 1: give one of them.")


@dataclass(frozen=True)
class Animations:
    """The animations in a file that move a person.

    Attributes:
        label: the file, in messages.
        names: of all of them, in the order of the file, fit to be shown; empty for one without a name.
        taken: the numbers, from 1, of those that were read: one, unless each person has their own.
    """

    label: str
    names: tuple[str, ...]
    taken: tuple[int, ...]

    @property
    def note(self) -> str:
        """A sentence on which was taken and which were not; empty where there was nothing to choose."""
        others = [number for number in range(1, len(self.names) + 1) if number not in self.taken]
        if not others:
            return ""
        took = listed(self.names, self.taken, "and")
        return (
            f"Of the {len(self.names):,} animations in {self.label}, {took} "
            f"{'was' if len(self.taken) == 1 else 'were'} taken; "
            f"the {'other is' if len(others) == 1 else 'others are'} {listed(self.names, others, 'and')}."
        )


def listed(names: Sequence[str], numbers: Sequence[int], last: str) -> str:
    """Numbers with names: "1 (“idle”), 2 and 3 (“walk”)"."""
    parts = [f"{n} (“{names[n - 1]}”)" if names[n - 1] else str(n) for n in numbers[:_LISTED]]
    if (more := len(numbers) - len(parts)) > 0:
        parts.append(f"{more:,} more")
    return f" {last} ".join(part for part in (", ".join(parts[:-1]), parts[-1]) if part)


@dataclass(frozen=True, eq=False)
class Recording:
    """Everybody in a file, in its own axes.

    Attributes:
        people: on joints that are known, or on rigs of their own; up to :data:`MAX_PEOPLE`, who share one clock.
        usual_up: the axis that points up in such files, if there is one: it is taken unless the people stand along
            another.
        on_floor: heights count from nowhere, so that the lowest joint of all people is put on the floor.
        animations: those of a .glb file, and which of them this is.
        beside: what a duet holds beside two people: roles, manifest, things, grips and looks.
    """

    people: tuple[Clip, ...] | tuple[RigMotion, ...]
    usual_up: str = "y"
    on_floor: bool = False
    animations: Animations | None = None
    beside: Mapping[str, Any] = field(default_factory=dict)
