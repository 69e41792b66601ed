"""BiGraphDiff's ablation: the thesis' Table 4.6."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import torch
from numpy.typing import NDArray

from models.diffusion import denoise, make_scheduler
from models.intergen.losses import LossWeights
from models.motion_tokens import TokenLayout
from training.core.loop import Loop
from training.corpus.strict_pairs import StrictPair
from training.trainers.bigraphdiff import Settings, Trainer

from .clips import class_name, scenes_of
from .table import Row, Table

Array = NDArray[np.floating]

SMALL = Settings(
    latent_dim=64, ff_size=128, num_layers=3, num_heads=4, embed_dim=64, cond_dim=32, batch=16, learning_rate=1e-3,
    warmup=30, ema=0.98, root_weight=1.0, noisiest=0.0,
    weights=LossWeights(**dict.fromkeys(vars(LossWeights()), 0.0)),
)  # fmt: skip
"""No regularisers, as in the thesis; the clean motion is predicted, as on the page."""
STEPS = 25
GUIDANCE = 1.5
LARGEST = 5.0
"""Standard deviations within which a predicted motion is kept: the graph units are cubic in what they see, so that
samples of a network that has learned for some hundred steps can run away."""


def _paper(accuracy: str, fvd: str) -> dict[str, str]:
    return {"accuracy %": accuracy, "FVD": fvd}


RUNS: dict[str, dict[str, Any]] = {
    "s1": {"graph": "none", "diffusion": False},
    "s2": {"graph": "none"},
    "s3": {"graph": "simple"},
    "s4": {},
}
ROWS: dict[str, Row] = {
    "s1": Row("S1: two-stream Transformer", "s1", _paper("3.9", "21,215")),
    "s2": Row("S2: in a diffusion process", "s2", _paper("69.3", "1,406")),
    "s3": Row("S3: S2 + simple graph", "s3", _paper("73.2", "1,124")),
    "s4": Row("S4: S2 + bipartite graph", "s4", _paper("77.0", "1,048")),
}


class BiGraphDiffTable(Table):
    """S1 to S4: two people from a class."""

    name = "bigraphdiff"
    title = "BiGraphDiff, Table 4.6"
    about = (
        f"The shipped variant with {SMALL.num_layers} layers (8 in the thesis) of width {SMALL.latent_dim} (512), "
        f"batches of {SMALL.batch}, DDIM-{STEPS}; the classifier sees both people."
    )
    runs, rows = RUNS, ROWS
    heads = ("accuracy %", "FVD")
    steps = 400

    def trainer(self, pairs: Sequence[StrictPair], run: str, out: Path, *, steps: int, seed: int) -> Loop:
        """See :meth:`Table.trainer`."""
        scenes = scenes_of([pair for pair in pairs if not pair.test], TokenLayout())
        changes = {**self.runs[run], "steps": steps, "seed": seed}
        return Trainer(scenes, replace(SMALL, **changes), out)  # type: ignore[arg-type]  # by name

    def make(self, trainer: Loop, row: Row, pairs: Sequence[StrictPair], *, seed: int) -> list[Array]:
        """Two people of each test clip's class and length."""
        known = cast(Trainer, trainer)
        return [
            self.seen(people_of(known, pair, seed=1000 * seed + place)) for place, pair in enumerate(pairs)
        ]

    def seen(self, people: Array) -> Array:
        """Both people's 22 joints: (T / 2, 132)."""
        return people[:, ::2].swapaxes(0, 1).reshape(-1, 132)


@torch.no_grad()
def people_of(trainer: Trainer, pair: StrictPair, *, seed: int) -> Array:
    """Two people (2, T, 22, 3) of a clip's class and length."""
    model, layout, frames = trainer.ema, trainer.ema.config.layout, pair.positions.shape[1]
    cond = model.condition([class_name(pair)])
    shape = (1, layout.num_tokens(frames), 2 * layout.token_features)

    def predict(x: torch.Tensor, t: torch.Tensor) -> torch.Tensor:
        return model.denoiser.guided(x, t, cond, scale=GUIDANCE).clamp(-LARGEST, LARGEST)

    if trainer.settings.diffusion:
        noise = torch.randn(shape, generator=torch.Generator().manual_seed(seed))
        x = denoise(predict, noise, make_scheduler("ddim", STEPS, spacing="top"))
    else:
        x = model.denoiser(torch.zeros(shape), torch.zeros(1, dtype=torch.long), cond)
    people: Array = model.positions(x)[0][0][:, :frames].numpy()
    return people
