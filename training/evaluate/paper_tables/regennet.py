"""ReGenNet's ablations: Tables 6 to 10 of the paper, where the data allow it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np
import torch
from numpy.typing import NDArray

from models.diffusion import denoise, make_scheduler
from models.motion_tokens import FEATURES, TokenLayout
from models.regennet.compact import CompactReGenNet
from models.text import MiniLM
from training.core.loop import Loop
from training.corpus.strict_pairs import StrictPair
from training.trainers.regennet import Settings, Trainer
from webdemo.inference.methods import WEIGHTS

from .clips import SENTENCES, scenes_of
from .table import Row, Table

Array = NDArray[np.floating]

SMALL = Settings(
    latent_dim=64, ff_size=128, num_layers=3, batch=16, warmup=30, ema=0.98, learning_rate=1e-3,
    cond_drop_prob=1.0, offline=0.0, begin=0.0, crop=0.0, recorded=1, noisiest=0.0, root_weight=1.0,
    velocity=0.0, bone_length=0.0, foot_contact=0.0, distance=0.0, apart=0.0, own=0.0, t_bar=1.0,
)  # fmt: skip
"""The paper's losses and no others; the reactor's first pose is open, as there."""
STEPS = 5


def _paper(fid: str, accuracy: str) -> dict[str, str]:
    return {"FID": fid, "accuracy": accuracy}


RUNS: dict[str, dict[str, Any]] = {
    "whole": {},
    "no-interaction": {"interaction": 0.0},
    "one-layer": {"num_layers": 1},
    "random-roles": {},
    "offline": {"offline": 1.0},
    "constrained": {"cond_drop_prob": 0.1},
}
ROWS: dict[str, Row] = {
    "whole": Row("online, unconstrained, 5 steps", "whole", _paper("11.00", "0.749")),
    "no-interaction": Row("without interaction loss", "no-interaction", _paper("12.15", "0.751")),
    "one-layer": Row("fewest layers (1 of 3; 2 of 8)", "one-layer", _paper("29.02", "0.744")),
    "2-steps": Row("2 DDIM steps", "whole", _paper("12.13", "0.751"), {"steps": 2}),
    "10-steps": Row("10 DDIM steps", "whole", _paper("11.47", "0.749"), {"steps": 10}),
    "100-steps": Row("100 DDIM steps", "whole", _paper("11.08", "0.748"), {"steps": 100}),
    "random-roles": Row("roles at random", "random-roles", _paper("12.69", "0.656")),
    "offline": Row("offline", "offline", _paper("6.19", "0.772"), {"causal": False}),
    "constrained": Row(
        "online, constrained: the class is told", "constrained", _paper("5.89", "0.902"), {"words": True}
    ),
}


class ReGenNetTable(Table):
    """Losses, layers, DDIM steps, roles, modes and intent."""

    name = "regennet"
    title = "ReGenNet, Tables 6 to 10"
    about = (
        f"The shipped variant with {SMALL.num_layers} layers (8 in the paper) of width {SMALL.latent_dim} (512), "
        f"batches of {SMALL.batch}, DDIM-{STEPS}, no words but in the constrained row, the paper's losses alone."
    )
    runs, rows = RUNS, ROWS
    heads = ("FID", "accuracy")
    steps = 600

    def trainer(self, pairs: Sequence[StrictPair], run: str, out: Path, *, steps: int, seed: int) -> Loop:
        """See :meth:`Table.trainer`; with roles at random, half of the people change theirs."""
        train = [pair for pair in pairs if not pair.test]
        share = 0.5 if run == "random-roles" else 0.0
        swap = np.random.default_rng((seed, 7)).random(len(train)) < share
        scenes = scenes_of(train, TokenLayout(4, 1), swap=swap.tolist())
        settings = Settings(**{**vars(SMALL), **self.runs[run], "steps": steps, "seed": seed})
        return Trainer(scenes, settings, out, words=WEIGHTS / "intergen")

    def make(self, trainer: Loop, row: Row, pairs: Sequence[StrictPair], *, seed: int) -> list[Array]:
        """See :meth:`Table.make`."""
        model = cast(Trainer, trainer).ema
        sampling: dict[str, Any] = {"steps": STEPS, "causal": True, "words": False, **row.sampling}
        encoder = MiniLM() if sampling.pop("words") else None
        condition = torch.zeros(1, model.config.cond_dim)
        made = []
        for place, pair in enumerate(pairs):
            if encoder:
                tokens = encoder([SENTENCES[pair.label]])
                with torch.no_grad():
                    condition = model.conditioner(tokens.features, tokens.mask)
            made.append(_view(reactor_of(model, pair, condition, seed=1000 * seed + place, **sampling)))
        return made

    def seen(self, people: Array) -> Array:
        """The reactor's 22 joints: (T / 2, 66)."""
        return _view(people[1])


def _view(person: Array) -> Array:
    return person[::2].reshape(-1, 66)


@torch.no_grad()
def reactor_of(
    model: CompactReGenNet, pair: StrictPair, condition: torch.Tensor, *, steps: int, causal: bool, seed: int
) -> Array:
    """The reactor (T, 22, 3) to a clip's actor, all rows at once: causal attention keeps the future out."""
    frames = pair.positions.shape[1]
    actor = model.actor_rows(torch.from_numpy(pair.positions[:1]).float())

    def predict(x: torch.Tensor, t: torch.Tensor) -> torch.Tensor:
        return model(x, t, actor, condition, causal=causal)

    shape = (1, model.num_rows(frames), FEATURES)
    noise = torch.randn(shape, generator=torch.Generator().manual_seed(seed))
    x = denoise(predict, noise, make_scheduler("ddim", steps, spacing="top"))
    person: Array = model.positions(x, frames)[0][0].numpy()
    return person
