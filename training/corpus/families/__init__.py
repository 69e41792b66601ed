"""The families of interaction: functions (rng, library) -> Scene, registered by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module

import numpy as np

from ..library import Library
from ..scene import Scene, played
from ..telling import describe

Builder = Callable[[np.random.Generator, Library], Scene]


@dataclass(frozen=True)
class Family:
    """A family of scenes.

    Attributes:
        name: of the family.
        make: makes one scene, without words.
        shows: the cues of a and b (:mod:`training.corpus.cues`), of which a scene may show others; none where it plays
            beats of its own.
        needs: source actions without which the family cannot be made.
        weight: its share of the corpus relative to the other families.
        contact: whether the two may touch.
    """

    name: str
    make: Builder
    shows: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()
    weight: float = 1.0
    contact: bool = False

    def build(self, rng: np.random.Generator, library: Library) -> Scene:
        """One scene with its label and captions."""
        scene = self.make(rng, library)
        return scene if scene.label else describe(rng, scene)


REGISTRY: dict[str, Family] = {}


def register(
    name: str,
    *shows: str,
    relation: str = "while",
    needs: tuple[str, ...] = (),
    weight: float = 1.0,
    contact: bool = False,
) -> Callable[[Builder], Builder]:
    """Decorator: adds a builder to :data:`REGISTRY` under the family's name.

    ``shows`` are the cues of a and b; one by itself is done by both.
    """

    def add(build: Builder) -> Builder:
        def make(rng: np.random.Generator, library: Library) -> Scene:
            scene = build(rng, library)
            if shows and not scene.played:
                scene.played = played(scene, (shows[0], shows[-1]), relation)
            return scene

        REGISTRY[name] = Family(name, make, shows, needs, weight, contact)
        return build

    return add


def load_families() -> dict[str, Family]:
    """All registered families in the order of their modules, on which a seed's corpus depends."""
    for module in ("gestures", "locomotion", "combat", "sequences", "contact", "bodies", "blows", "beats"):
        import_module(f"{__name__}.{module}")
    return REGISTRY
