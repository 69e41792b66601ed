"""Fits the :class:`models.intergen.compact.TouchReader` of a trained network on the corpus' touches.

Every training caption stands for the touch that its scene shows, as the trainer shows it: a sentence that
names a side for both mirror images, one that names none for the right-handed image.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import Any, TypeVar

import torch
import torch.nn.functional as F
from torch import Tensor

from models.intergen.compact import CompactInterGen, Touch
from models.regennet.compact import CompactReGenNet
from models.released import Released
from models.text import TextConditioner
from motion.skeleton import OTHER_SIDE
from training.core.handedness import mirror_caption, mirrored
from training.core.loop import fit, mixed_precision
from training.core.text_features import encoded
from training.prepare import Scenes

Network = TypeVar("Network", CompactInterGen, CompactReGenNet)

RARE = 8
MOST, STEPS = 24_000, 3000
"""Captions that a reader is fitted on and scored on, at most, and its steps of AdamW in batches of 256."""


def touch_of(row: dict[str, Any], *, mirror: bool = False, beat: dict[str, Any] | None = None) -> Touch:
    """The joints that touch in a scene of :mod:`training.prepare`, or in one beat of it, or in the mirror image."""
    entries = (row["events"] or {}).get("contact") or ()
    if beat is not None:
        entries = [entry for entry in entries if beat["start"] <= entry["start"] < beat["end"]]
    pairs = {(entry["a"], entry["b"]) for entry in entries}
    return tuple(sorted((_mirror(a), _mirror(b)) if mirror else (a, b) for a, b in pairs))


def _mirror(joint: str) -> str:
    side, _, part = joint.partition("_")
    return f"{OTHER_SIDE[side]}_{part}" if side in OTHER_SIDE else joint


def examples(rows: list[dict[str, Any]]) -> list[tuple[str, Touch]]:
    """(caption, touch) of every way in which the trainer may show these scenes and their single beats."""
    touches = set()
    for row in rows:
        captioned = [(caption, None) for caption in row["captions"]]
        captioned += [(caption, beat) for beat in row.get("beats") or () for caption in beat["captions"]]
        for caption, beat in captioned:
            for draw in (0.0, 0.9):
                mirror = mirrored(caption, row.get("hand"), draw)
                touch = touch_of(row, mirror=mirror, beat=beat)
                touches.add((mirror_caption(caption) if mirror else caption, touch))
    return sorted(touches)


@torch.no_grad()
def conditions(conditioner: TextConditioner, captions: list[str]) -> Tensor:
    """(N, cond_dim) condition vectors of captions."""
    vectors = torch.empty(len(captions), conditioner.config.latent_dim)
    for places, tokens in encoded(captions):
        with mixed_precision("cpu"):
            vectors[places] = conditioner(tokens.features, tokens.mask).float()
    return vectors


def without_touches(model: CompactInterGen | CompactReGenNet) -> Released:
    """The weights of a network but for its touch reader."""
    known = {k: v for k, v in model.state_dict().items() if not k.startswith("touch_reader.")}
    return Released(known, type(model).__name__.removeprefix("Compact"))


def _says(row: dict[str, Any]) -> bool:
    return bool(row.get("label") or row["events"])


def with_touches(model: Network, scenes: Scenes) -> Network:
    """The same network with a fitted touch reader; as it was, where too few scenes of the corpus touch.

    Scenes with neither a label nor events say nothing of touches. The reader's accuracy is printed where there are test
    captions.
    """
    train, test = ([row for row in scenes.split(name) if _says(row)] for name in ("train", "test"))
    counts = Counter(touch_of(r, mirror=m) for r in train for m in (False, True))
    known = tuple(sorted(t for t, count in counts.items() if t and count >= RARE))
    if not known:
        return model
    result = type(model)(replace(model.config, touches=known))
    result.load_state_dict(without_touches(model), strict=False)
    reader = result.eval().touch_reader
    assert reader is not None

    generator = torch.Generator().manual_seed(0)
    touches = examples(train)
    chosen = [touches[i] for i in torch.randperm(len(touches), generator=generator)[:MOST].tolist()]
    inputs, labels = _tensors(result, chosen)
    torch.manual_seed(0)

    def loss(step: int) -> Tensor:
        rows = torch.randint(len(inputs), (256,), generator=generator)
        return F.cross_entropy(reader(inputs[rows]), labels[rows], label_smoothing=0.02)

    fit(reader, loss, STEPS, rate=2e-3, weight_decay=1e-2)
    if unseen := examples(test)[:MOST]:
        seen, wanted = _tensors(result, unseen)
        right = (reader(seen).argmax(-1) == wanted).float().mean()
        print(f"touches read from test captions: {right:.1%}")
    return result


def _tensors(model: CompactInterGen | CompactReGenNet, touches: list[tuple[str, Touch]]) -> tuple[Tensor, Tensor]:
    reader = model.touch_reader
    assert reader is not None
    kept = [(caption, reader.touches.index(t)) for caption, t in touches if t in reader.touches]
    return conditions(model.conditioner, [caption for caption, _ in kept]), torch.tensor([label for _, label in kept])
