"""A plan of acts as the network sees it: at each token, who does what, in which way, and how far it has come.

A track has a column for each word of a vocabulary ("do shake-hands", "undergo push", "side left", "manner sadly"): the
share of a token's time in which the word holds for a person. Then come :data:`PACE` columns for how the act that
began last goes on, and one for each trait of how a person moves whatever is done (energy, tempo). Words that a network
was not trained on have no column.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from models.motion_tokens import TokenLayout

PACE = ("left", "done", "speed")
"""Columns for the act that began last: the share that is left of it, the share that is done, and log2 of its speed."""


@dataclass(frozen=True)
class TimedAct:
    """One act with its time.

    Attributes:
        name: of the act.
        agents: 0 for a, 1 for b, or both.
        start, stop: frames; ``stop`` exclusive.
        patient: to whom it is done.
        side: "left", "right" or "both".
        manner: adverbs.
        direction: where it goes.
        speed: factor beside the act's usual speed.
    """

    name: str
    agents: tuple[int, ...]
    start: float
    stop: float
    patient: int | None = None
    side: str | None = None
    manner: tuple[str, ...] = ()
    direction: str | None = None
    speed: float = 1.0

    @property
    def words(self) -> tuple[str, ...]:
        """The words that hold for an agent."""
        more = [f"manner {adverb}" for adverb in self.manner]
        more += [f"side {self.side}"] if self.side else []
        return (f"do {self.name}", *more, *([f"direction {self.direction}"] if self.direction else []))

    @property
    def undergone(self) -> str:
        """The word that holds for the patient."""
        return f"undergo {self.name}"


class PlanTrack:
    """Writes plans as tracks.

    Args:
        words: the vocabulary, in the order of the columns.
        layout: frames a knot and knots a token.
        traits: what is told of how a person moves, in the order of their columns.
    """

    def __init__(self, words: Sequence[str], layout: TokenLayout, traits: Sequence[str] = ()) -> None:
        self.frames = layout.frames_per_knot * layout.knots_per_token
        self.traits = tuple(traits)
        self._column = {word: i for i, word in enumerate(words)}
        self.width = len(columns(words, traits))

    def __call__(self, acts: Sequence[TimedAct], tokens: int, traits: Tensor | None = None) -> Tensor:
        """(tokens, 2·width) the track of a, then of b.

        Args:
            acts: of the plan.
            tokens: of the motion.
            traits: (2, number of traits) standard deviations from what is usual; 0 for what is not said.
        """
        track = torch.zeros(2, tokens, self.width)
        if not self.width:
            return track.transpose(0, 1).flatten(1)
        pace = slice(len(self._column), len(self._column) + len(PACE))
        if traits is not None and self.traits:
            track[..., pace.stop :] = traits[:, None]
        begins = self.frames * torch.arange(tokens)
        for act in sorted(acts, key=lambda act: act.start):
            share = (
                (act.stop - begins).clamp(0, self.frames) - (act.start - begins).clamp(0, self.frames)
            ) / self.frames
            goes_on = share > 0
            for person in act.agents:
                for word in act.words:
                    self._write(track[person], word, share)
                done = ((begins + self.frames / 2 - act.start) / max(act.stop - act.start, 1)).clamp(0, 1)
                how = torch.stack([1 - done, done, torch.full_like(done, act.speed).log2()], 1)
                track[person, goes_on, pace] = how[goes_on]
            if act.patient is not None:
                self._write(track[act.patient], act.undergone, share)
        return track.transpose(0, 1).flatten(1)

    def _write(self, track: Tensor, word: str, share: Tensor) -> None:
        if (column := self._column.get(word)) is not None:
            track[:, column] = torch.maximum(track[:, column], share)


def columns(words: Sequence[str], traits: Sequence[str] = ()) -> tuple[str, ...]:
    """The columns of one person's track; none for a network without a vocabulary, which reads no plans."""
    return (
        (*words, *(f"pace {name}" for name in PACE), *(f"trait {name}" for name in traits)) if words else ()
    )
