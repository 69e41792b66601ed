"""The animations of a glTF file: their names, and the one that is read of several."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

from motion.errors import InputError

from .choices import Animation, check_animation
from .glb_file import GlbFile
from .glb_nodes import moves

_LONGEST = 40
"""Characters of a name that are shown."""
_LISTED = 5


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
        took = _listed(self.names, self.taken, "and")
        return (
            f"Of the {len(self.names):,} animations in {self.label}, {took} "
            f"{'was' if len(self.taken) == 1 else 'were'} taken; "
            f"the {'other is' if len(others) == 1 else 'others are'} {_listed(self.names, others, 'and')}."
        )


def chosen(
    file: GlbFile, people: Sequence[Collection[int]], animation: Animation | None
) -> tuple[list[Any], Animations]:
    """One animation for each person, and what there was to choose from.

    A person whom the chosen animation does not move keeps the first of their own.

    Args:
        file: whose animations.
        people: the nodes that each person moves by.
        animation: its name, or its number among those that move a person; the first by default.

    Raises:
        InputError: where a person has none, or there is none of this name or number.
    """
    known = file.document["animations"]
    joints = [set(nodes) for nodes in people]
    moved = [{who for who, nodes in enumerate(joints) if moves(each, nodes)} for each in known]
    theirs = [number for number, who in enumerate(moved) if who]
    if set().union(*moved) < set(range(len(people))):
        raise InputError(f"{file.label} has an animation, but it moves no joint of the skeleton: export it again.")
    names = [known[number].get("name") for number in theirs]
    first = theirs[0 if animation is None else _found(names, animation, file.label)]
    taken = [
        first if who in moved[first] else next(number for number in theirs if who in moved[number])
        for who in range(len(people))
    ]
    numbers = sorted({theirs.index(number) + 1 for number in taken})
    found = Animations(file.label, tuple(map(_shown, names)), tuple(numbers))
    return [known[number] for number in taken], found


def _found(names: Sequence[Any], animation: Animation, label: str) -> int:
    """The index of an animation by its name, or else by its number."""
    check_animation(animation)
    if isinstance(animation, str):
        asked = animation.strip()
        for same in (str, str.casefold):
            for index, name in enumerate(names):
                if isinstance(name, str) and same(name.strip()) == same(asked):
                    return index
        animation = int(asked) if asked.isdecimal() and len(asked) < 9 else 0
    if not 1 <= animation <= len(names):
        listed = _listed([_shown(name) for name in names], range(1, len(names) + 1), "or")
        raise InputError(f"{label} has no such animation: choose {listed}.")
    return animation - 1


def _shown(name: Any) -> str:
    """A name on one line, without characters that cannot be seen, cut where it is too long."""
    if not isinstance(name, str):
        return ""
    seen = "".join(each if each.isprintable() else " " for each in name[: 10 * _LONGEST])
    seen = " ".join(seen.split())
    return seen if len(seen) <= _LONGEST else f"{seen[: _LONGEST - 1].rstrip()}…"


def _listed(names: Sequence[str], numbers: Sequence[int], last: str) -> str:
    """Numbers with names: "1 (“idle”), 2 and 3 (“walk”)"."""
    parts = [f"{n} (“{names[n - 1]}”)" if names[n - 1] else str(n) for n in numbers[:_LISTED]]
    if (more := len(numbers) - len(parts)) > 0:
        parts.append(f"{more:,} more")
    return f" {last} ".join(part for part in (", ".join(parts[:-1]), parts[-1]) if part)
