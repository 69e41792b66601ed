"""The families of interaction: functions (rng, library) -> Scene, registered by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module

import numpy as np

from training.corpus.library import Library
from training.corpus.scene import Scene

Builder = Callable[[np.random.Generator, Library], Scene]


@dataclass(frozen=True)
class Family:
    """A family of scenes.

    Attributes:
        name: as in the phrase book.
        build: makes one scene.
        needs: source actions without which the family cannot be made.
        weight: its share of the corpus relative to the other families.
        contact: whether the two may touch.
    """

    name: str
    build: Builder
    needs: tuple[str, ...] = ()
    weight: float = 1.0
    contact: bool = False


REGISTRY: dict[str, Family] = {}


def register(
    name: str, *, needs: tuple[str, ...] = (), weight: float = 1.0, contact: bool = False
) -> Callable[[Builder], Builder]:
    """Decorator: adds a builder to :data:`REGISTRY` under the family's name."""

    def add(build: Builder) -> Builder:
        REGISTRY[name] = Family(name, build, needs, weight, contact)
        return build

    return add


def load_families() -> dict[str, Family]:
    """All registered families in the order of their modules, on which a seed's corpus depends."""
    for module in ("gestures", "locomotion", "combat", "sequences", "contact", "bodies", "blows", "beats"):
        import_module(f"{__name__}.{module}")
    return REGISTRY
