"""Listed clips as prepared scenes, for the trainers that read :class:`training.prepare.Scenes`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray

from models.motion_tokens import TokenLayout, encode, foot_contacts
from motion.transforms import canonicalize
from training.corpus.strict_pairs import StrictPair
from training.prepare import Scenes

Array = NDArray[np.floating]

SENTENCES = {
    "approach": "One person walks up to the other.",
    "depart": "One person walks away from the other.",
    "exchange": "Two people exchange something.",
    "handshake": "Two people shake hands.",
    "kick": "One person kicks the other.",
    "meet": "Two people walk up to each other.",
    "part": "Two people walk away from each other.",
    "point": "One person points at the other.",
    "punch": "One person punches the other.",
    "push": "One person pushes the other.",
    "walking": "One person walks and the other stands still.",
}
"""What the actor, named first, and the reactor do, by class. *Meet* and *part* are of the filtered pairs."""


def class_name(pair: StrictPair) -> str:
    """The class with its data set, since the two show the same class in another way."""
    return f"{pair.dataset}: {pair.label}"


def held(positions: Array, frames: int) -> Array:
    """A pair (2, T, 22, 3) with its last poses held up to a number of frames."""
    missing = frames - positions.shape[1]
    return np.concatenate([positions, np.repeat(positions[:, -1:], missing, axis=1)], axis=1)


def scenes_of(pairs: Sequence[StrictPair], layout: TokenLayout, *, swap: Sequence[bool] = ()) -> Scenes:
    """Training scenes of clips, the last poses held to a whole token.

    Args:
        swap: clips whose two people change roles; none by default.
    """
    parts, rows, start = [], [], 0
    for place, pair in enumerate(pairs):
        tokens = layout.num_tokens(pair.positions.shape[1])
        motion = held(pair.positions, layout.num_frames(tokens))
        if swap and swap[place]:
            motion = canonicalize(motion[::-1])
        positions = torch.from_numpy(motion.copy()).float()
        parts.append(encode(positions, foot_contacts(positions), layout).transpose(0, 1).half())
        rows.append({
            "start": start, "tokens": tokens, "hand": "right", "family": pair.label, "class": class_name(pair),
            "captions": [SENTENCES[pair.label]], "alone": None, "split": "train", "events": None, "beats": [],
            "label": None, "sources": [f"{pair.dataset}/{pair.name}"],
        })  # fmt: skip
        start += tokens * layout.knots_per_token
    return Scenes(torch.cat(parts), rows, layout)
