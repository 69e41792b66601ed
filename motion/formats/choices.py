"""Facts known of a file before it is read: its up axis, unit, frame rate, joint order and animation."""

from __future__ import annotations

from dataclasses import dataclass

from motion.errors import InputError
from motion.skeleton import SKELETONS
from motion.up import AXES

Animation = int | str
"""A choice: the number of an animation, from 1, or its name."""

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "inch": 0.0254}
"""Metres of each unit."""
RATES = (1.0, 1000.0)
ORDERS = {"sbu15": "SBU", "k3hi15": "K3HI", "cmu17": "CMU", "h36m17": "Human3.6M", "coco17": "COCO"}
"""Display names of joint orders that share a number of joints."""


@dataclass(frozen=True)
class ImportChoices:
    """Known facts about a file; a field that is None is found from its contents.

    Attributes:
        up: what points up: "x", "y", "z", or "-x", "-y", "-z" where that axis points down.
        unit: "m", "cm", "mm" or "inch".
        fps: frames a second; overrides the file, before anything is checked.
        order: order of joints without names: a key of :data:`~motion.SKELETONS`, such as
            "sbu15" or "h36m17".
        animation: the name or the number, from 1, of the one to read of a .glb with several.
    """

    up: str | None = None
    unit: str | None = None
    fps: float | None = None
    order: str | None = None
    animation: Animation | None = None

    def __post_init__(self) -> None:
        check_animation(self.animation)
        if self.up is not None and self.up not in AXES:
            raise InputError(f"Up axis {self.up!r:.20} is not known: choose x, y or z, or -x, -y or -z.")
        if self.unit is not None and self.unit not in UNITS:
            raise InputError(f"Unit {self.unit!r:.20} is not known: choose one of {', '.join(UNITS)}.")
        if self.fps is not None and not RATES[0] <= self.fps <= RATES[1]:
            raise InputError(f"A frame rate of {self.fps:g} is not possible: give {RATES[0]:g} to 1,000.")
        if self.order is not None and self.order not in SKELETONS:
            raise InputError(f"Joint order {self.order!r:.20} is not known: choose one of {', '.join(SKELETONS)}.")


def check_animation(animation: Animation | None) -> None:
    """Raises InputError for a choice that is neither a name nor a number from 1."""
    if animation is None or (type(animation) is int and animation >= 1):
        return
    if not isinstance(animation, str) or not animation.strip():
        raise InputError(f"Animation {animation!r:.40} is neither a name nor a number from 1: give one of them.")
