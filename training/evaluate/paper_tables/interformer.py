"""InterFormer's ablations: the thesis' Tables 3.4 to 3.7."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from training.core.loop import Loop
from training.corpus.strict_pairs import StrictPair
from training.trainers.interformer_published import Settings, Trainer, fifteen_joints

from .table import Row, Table

Array = NDArray[np.floating]

SMALL = Settings(num_layers=1, ff_size=128, window=24, batch=8, learning_rate=4e-3)


HEADS = ("SBU accuracy", "K3HI accuracy")
_RUNS: tuple[tuple[str, str, dict[str, Any], tuple[str, str]], ...] = (
    ("s1", "S1: Transformer", {"spatial": False}, ("53.3", "14.3")),
    ("s2", "S2: S1 + spatial attention", {"adjacency": False, "interaction": False}, ("66.7", "28.6")),
    ("s3", "S3: S2 + skeleton adjacency", {"interaction": False}, ("73.3", "42.9")),
    ("s4", "S4: S3 + interaction distance; several heads in both", {}, ("80.0", "46.4")),
    ("one-head", "S4, one head in both", {"num_heads": 1, "spatial_heads": 1}, ("60.0", "21.4")),
    ("temporal-heads", "S4, several temporal heads", {"spatial_heads": 1}, ("70.0", "42.6")),
    ("spatial-heads", "S4, several spatial heads", {"num_heads": 1}, ("60.0", "35.7")),
)
"""Name, label, changes of the settings, and the thesis' accuracies on SBU and K3HI."""
RUNS = {name: changes for name, _, changes, _ in _RUNS}
ROWS = {name: Row(label, name, dict(zip(HEADS, paper, strict=True))) for name, label, _, paper in _RUNS}


class InterFormerTable(Table):
    """The network as published, with S1 to S4 and the number of heads, from the reactor's first pose."""

    name = "interformer"
    title = "InterFormer, Tables 3.4 to 3.7"
    about = (
        f"The published network with {SMALL.num_layers} layer (6 in the thesis), feed-forward {SMALL.ff_size} "
        f"(2,048), batches of {SMALL.batch} windows of {SMALL.window} frames (whole clips)."
    )
    runs, rows = RUNS, ROWS
    heads = HEADS
    steps = 1000

    def trainer(self, pairs: Sequence[StrictPair], run: str, out: Path, *, steps: int, seed: int) -> Loop:
        """See :meth:`Table.trainer`."""
        settings = Settings(**{**vars(SMALL), **self.runs[run], "steps": steps, "seed": seed})
        return Trainer([pair.positions for pair in pairs if not pair.test], settings, out)

    def make(self, trainer: Loop, row: Row, pairs: Sequence[StrictPair], *, seed: int) -> list[Array]:
        """See :meth:`Table.make`."""
        made = cast(Trainer, trainer).react([pair.positions for pair in pairs])
        return [person.reshape(len(person), -1) for person in made]

    def seen(self, people: Array) -> Array:
        """The reactor's 15 joints: (T / 2, 45)."""
        person = fifteen_joints(people[1])
        return person.reshape(len(person), -1)
