"""The compact default: InterGen's network over spline tokens, with its text conditioner and normaliser.

One object holds what is trained, averaged, shipped and sampled together. On disk it is a weights folder (see
:mod:`models.weights_io`) with ``captions.json`` and ``captions.safetensors``: a bank of training captions,
which measures how far a prompt is from the training data.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import torch
from safetensors.torch import save
from torch import Tensor, nn

from models.intergen import InterGenConfig, InterGenDenoiser
from models.known import KNOWN_FEATURES
from models.motion_tokens import DuetSpace, TokenLayout
from models.text import TextConditioner, TextConditionerConfig, TokenFeatures
from models.weights_io import WeightsFolder, load_network, save_network
from motion.errors import InputError

from .words import WordDenoiser

Touch = tuple[tuple[str, str], ...]
"""Which joints of the two people come together: (joint of a, joint of b), …"""


def as_touches(values: Iterable[Iterable[Sequence[str]]]) -> tuple[Touch, ...]:
    """Touches as JSON holds them, in lists, as the tuples that a config holds."""
    return tuple(tuple((a, b) for a, b in touch) for touch in values)


@dataclass(frozen=True)
class CompactConfig:
    """Sizes of a :class:`CompactInterGen`, and the touches that it reads from a sentence.

    role_text: see :class:`models.intergen.InterGenConfig`.
    words: the denoiser is a :class:`models.intergen.words.WordDenoiser`, which reads words, a sentence for each
        person and the known part of a motion.
    drafts: with ``words``, it reads drafts, too.
    """

    latent_dim: int = 320
    ff_size: int = 1024
    num_layers: int = 6
    num_heads: int = 5
    cond_dim: int = 256
    text_layers: int = 2
    dropout: float = 0.0
    role_text: bool = False
    words: bool = False
    drafts: bool = False
    layout: TokenLayout = field(default_factory=TokenLayout)
    touches: tuple[Touch, ...] = ()

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> CompactConfig:
        """The config that ``config.json`` holds as a dictionary."""
        known = {key: value for key, value in values.items() if key != "fast_rank"}  # 0 in the shipped folder
        touches = as_touches(values.get("touches", ()))
        return cls(**(known | {"layout": TokenLayout(**values["layout"]), "touches": touches}))


class TouchReader(nn.Module):
    """Says from the condition vector which joints the sentence wants to meet.

    The network's own motion brings hands near each other; what they should do there is in the words. This
    small classifier is fitted after the network, on its frozen condition vectors (:mod:`training.trainers.touch`).
    """

    def __init__(self, cond_dim: int, touches: Sequence[Touch], width: int = 128) -> None:
        super().__init__()
        self.touches: tuple[Touch, ...] = ((), *touches)
        self.net = nn.Sequential(nn.Linear(cond_dim, width), nn.GELU(), nn.Linear(width, len(self.touches)))

    def forward(self, condition: Tensor) -> Tensor:
        """Condition (B, cond_dim) → logits (B, 1 + touches); the first says that nothing touches."""
        return self.net(condition)

    @torch.no_grad()
    def read(self, condition: Tensor, sure: float = 0.5) -> list[Touch]:
        """The likeliest touch of each sentence, () where all touches together are less than ``sure``."""
        probability = self(condition).softmax(-1)
        due = 1 - probability[:, 0] >= sure
        best = probability[:, 1:].argmax(-1) + 1
        return [self.touches[int(i)] if d else () for d, i in zip(due, best, strict=True)]


class CompactInterGen(DuetSpace):
    """Denoiser, text conditioner and the normaliser of control points."""

    def __init__(self, config: CompactConfig) -> None:
        super().__init__(config.layout)
        self.config, self.reads_known, self.reads_drafts = config, config.words, config.drafts
        shared = {f.name: getattr(config, f.name) for f in fields(InterGenConfig) if hasattr(config, f.name)}
        sizes = InterGenConfig(**shared, input_features=config.layout.token_features, role_embedding=True)
        self.denoiser: InterGenDenoiser = (
            WordDenoiser(sizes, KNOWN_FEATURES * config.layout.knots_per_token, drafts=config.drafts)
            if config.words
            else InterGenDenoiser(sizes)
        )
        self.conditioner = TextConditioner(
            TextConditionerConfig(latent_dim=config.cond_dim, num_layers=config.text_layers, dropout=0.05)
        )
        self.touch_reader = TouchReader(config.cond_dim, config.touches) if config.touches else None

    def condition(self, both: TokenFeatures, a: TokenFeatures | None = None, b: TokenFeatures | None = None) -> Tensor:
        """Encodes sentences for both people and for each as the denoiser's condition.

        Args:
            both: of B sentences; one without tokens is missing.
            a, b: of B sentences for each person; only a network with ``words`` reads them.

        Returns:
            (B, cond_dim), or with ``words`` (B, 3, R, cond_dim), R rows for the longest sentence.
        """
        if not self.config.words:
            return self.conditioner(both.features, both.mask)
        given = {i: tokens for i, tokens in enumerate((both, a, b)) if tokens is not None}
        longest = 1 + max(tokens.mask.shape[1] for tokens in given.values())
        text = both.features.new_zeros(len(both.mask), 3, longest, self.config.cond_dim)
        for i, tokens in given.items():
            rows = self.conditioner.rows(tokens.features, tokens.mask)
            text[:, i, : rows.shape[1]] = rows * tokens.mask.any(1)[:, None, None]
        return text

    def no_condition(self, batch: int = 1) -> Tensor:
        """The condition of no words."""
        shape = (3, 1, self.config.cond_dim) if self.config.words else (self.config.cond_dim,)
        return torch.zeros(batch, *shape)

    def vector(self, condition: Tensor) -> Tensor:
        """The vector (B, cond_dim) of the sentence for both people in what :meth:`condition` gives."""
        return condition[:, 0, 0] if self.config.words else condition

    def touches(self, condition: Tensor) -> list[Touch]:
        """The joints that should touch, for each condition of :meth:`condition`; () if none should."""
        if self.touch_reader is None:
            return [()] * len(condition)
        return self.touch_reader.read(self.vector(condition))

    def grow_from(self, trained: CompactInterGen) -> None:
        """Takes over the weights of a network without ``words`` or with them; what it lacks stays as it is.

        Raises:
            InputError: if its sizes are others.
        """
        own, taken = self.state_dict(), trained.state_dict()
        taken = {name: tensor for name, tensor in taken.items() if not name.startswith("touch_reader.")}
        if any(name not in own or own[name].shape != tensor.shape for name, tensor in taken.items()):
            raise InputError("The weights to begin with are of other sizes: give the sizes they were trained with.")
        self.load_state_dict(own | taken)


@dataclass(frozen=True)
class CaptionBank:
    """Training captions and their unit sentence vectors (N, 384)."""

    captions: tuple[str, ...]
    vectors: Tensor
    far: float

    def nearest(self, vector: Tensor, count: int = 3) -> list[tuple[float, str]]:
        """The captions nearest to a unit sentence vector (384,): (cosine, caption), best first."""
        scores = self.vectors.float() @ vector.float()
        best = scores.topk(min(count, len(self.captions)))
        return [(float(s), self.captions[int(i)]) for s, i in zip(best.values, best.indices, strict=True)]


def load_folder(folder: Path) -> tuple[CompactInterGen, WeightsFolder]:
    """See :func:`models.weights_io.load_network`."""
    return load_network(folder, lambda sizes: CompactInterGen(CompactConfig.from_dict(sizes)))


def load_captions(source: WeightsFolder) -> CaptionBank:
    """The bank of training captions in a weights folder.

    Raises:
        WeightsError: if a file is missing or altered.
    """
    vectors = source.tensors("captions.safetensors")["vectors"]
    return CaptionBank(tuple(json.loads(source.read("captions.json"))), vectors, float(source.meta["far"]))


def save_folder(folder: Path, model: CompactInterGen, bank: CaptionBank, **options: Any) -> None:
    """Writes the network and its caption bank; options as in :func:`models.weights_io.save_network`."""
    files = {
        "captions.safetensors": save({"vectors": bank.vectors.half().contiguous()}),
        "captions.json": json.dumps(bank.captions, indent=0).encode(),
    }
    save_network(folder, model, extra=files, far=bank.far, **options)
