"""Traits of how people move whatever they do, as a network can be told them: drawn for each person from the seed.

A network that was trained with traits (:mod:`training.trainers.traits`) knows them in standard deviations from what is
usual for the same acts. Two people in a room are never both usual, and two seeds are other people: so what is asked for
is where the draw is centred.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import torch
from torch import Tensor

from models.intergen.plan_track import PlanTrack

SPREAD = 0.7
"""Standard deviation of a draw, where 1 is that of recorded people."""
_STREAM = 7  # other than the noise, whose numbers begin with the seed and the sample alone


def traits_of(track: PlanTrack | None, seed: int, sample: int, asked: Mapping[str, float]) -> Tensor | None:
    """The traits (2, traits) of a and b in a sample; None for a network that is told none.

    Args:
        track: of the network.
        seed: of the run.
        sample: its number.
        asked: where draws are centred, by the name of the trait; 0, what is usual, for those that it lacks.
    """
    if track is None or not track.traits:
        return None
    state = int(np.random.SeedSequence([seed, sample, _STREAM]).generate_state(1, np.uint64)[0])
    draws = torch.randn(2, len(track.traits), generator=torch.Generator().manual_seed(state))
    return torch.tensor([asked.get(name, 0.0) for name in track.traits]) + SPREAD * draws
