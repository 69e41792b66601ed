"""What words leave open, drawn by the seed: which hand, how fast, which way round, how far apart, how open.

The seed of the network's noise alone gives two motions that differ by little, as the plan holds both to one way of
doing what is said. Two takes of two people also differ in these.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from acts import shapes
from acts.lexicon import Lexicon
from acts.plan import Act

from .places import Standing
from .score import Score

LEFT_HANDED = 0.35
"""Share of the people who use the left hand where either would do."""
PACE = (0.88, 1.15)
"""Factors of the speed of a walk whose words do not say how fast."""
APART = (0.9, 1.25)
"""Factors of the metres between two who begin without touching."""
OPEN = 0.3
"""Radians by which somebody who begins may be turned away from the other, to either side."""
_SIDED = (shapes.Gesture, shapes.Limb, shapes.Touch, shapes.Strike)
_REACHING = frozenset(("hold", "spar", "along", "after", "past", "back to back", "averted", "behind", "thing"))
"""Ways whose places depend on each other."""


@dataclass(frozen=True)
class Take:
    """One take of a story.

    Attributes:
        left: whether a, and b, use the left hand where either would do.
        clockwise: they go round clockwise where no words say how.
        pace: factor of both people's speed.
        apart: factor of the metres between the two at the beginning.
        turned: radians by which a, and b, are turned away from the other at the beginning.
    """

    left: tuple[bool, bool]
    clockwise: bool
    pace: float
    apart: float
    turned: tuple[float, float]

    @classmethod
    def of(cls, seed: int) -> Take:
        """The take of a seed."""
        dice = np.random.default_rng([seed, 1])
        left, clockwise = dice.random(2) < LEFT_HANDED, dice.random() < 0.5
        pace, apart, (a, b) = dice.uniform(*PACE), dice.uniform(*APART), dice.uniform(-OPEN, OPEN, 2).tolist()
        return cls((bool(left[0]), bool(left[1])), clockwise, pace, apart, (a, b))

    def of_acts(self, acts: Sequence[Act], known: Lexicon) -> list[Act]:
        """The acts of a beat with what their words leave open filled in."""
        sided = {str(who) for act in acts if act.side for who in act.agents}
        return [self._filled(act, known, sided) for act in acts]

    def _filled(self, act: Act, known: Lexicon, sided: set[str]) -> Act:
        if act.act not in known.entries or not act.happens:
            return act
        stage, update = known.entries[act.act].stage, dict[str, object]()
        left = all(self.left["ab".index(who)] and who not in sided for who in act.agents)
        if left and act.direction is None and any(isinstance(shape, _SIDED) for shape in stage):
            update["side"] = "left"
        if act.direction is None and act.side is None and self.clockwise and any(_is_round(shape) for shape in stage):
            update["direction"] = "clockwise"
        if act.speed == 1.0 and any(isinstance(shape, shapes.Go) for shape in stage):
            update["speed"] = self.pace
        return act.model_copy(update=update)

    def of_places(self, stand: Standing, score: Score) -> Standing:
        """The places at which a story begins whose first beat leaves them free."""
        fixed = score.joined or score.has_places or score.strike or score.touch or score.linked or score.reaching
        if fixed or {move.way for move in score.moves} & _REACHING:
            return stand
        a, b = stand.places
        beside, ahead = self.apart * (b - a)
        sine, cosine = np.sin(self.turned[0]), np.cos(self.turned[0])
        b = a + np.array([beside * cosine + ahead * sine, ahead * cosine - beside * sine])
        return replace(stand, places=np.stack([a, b]), headings=stand.headings + np.array([0.0, sum(self.turned)]))


def _is_round(shape: shapes.Shape) -> bool:
    return isinstance(shape, shapes.Go | shapes.Turn) and shape.way == "around"
