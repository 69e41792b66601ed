"""The compact default: InterGen's network over spline tokens, with its text conditioner and normaliser.

One object holds what is trained, averaged, shipped and sampled together. On disk it is a folder:
``config.json`` (sizes, files and their SHA-256), float16 ``*.safetensors`` shards, and ``captions.json`` with
``captions.safetensors``, a bank of training captions by which a far-off prompt is known.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError
from safetensors.torch import load
from torch import Tensor, nn

from models.errors import WeightsError
from models.intergen import InterGenConfig, InterGenDenoiser
from models.motion_tokens import FEATURES, TokenLayout, decode, unpack
from models.text import TextConditioner, TextConditionerConfig

Touch = tuple[tuple[str, str], ...]
"""Which joints of the two people come together: (joint of a, joint of b), …"""


def as_touches(values: Iterable[Iterable[Sequence[str]]]) -> tuple[Touch, ...]:
    """Touches as JSON holds them, in lists, as the tuples that a config holds."""
    return tuple(tuple((a, b) for a, b in touch) for touch in values)


@dataclass(frozen=True)
class CompactConfig:
    """Sizes of a :class:`CompactInterGen`, and the touches that it reads from a sentence.

    role_text: see :class:`models.intergen.InterGenConfig`.
    """

    latent_dim: int = 320
    ff_size: int = 1024
    num_layers: int = 6
    num_heads: int = 5
    cond_dim: int = 256
    text_layers: int = 2
    dropout: float = 0.0
    role_text: bool = False
    layout: TokenLayout = field(default_factory=TokenLayout)
    touches: tuple[Touch, ...] = ()

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> CompactConfig:
        touches = as_touches(values.get("touches", ()))
        return cls(**(values | {"layout": TokenLayout(**values["layout"]), "touches": touches}))


class TouchReader(nn.Module):
    """Says from the condition vector which joints the sentence wants to meet.

    The network's own motion brings hands near each other; what they should do there is in the words. This
    small classifier is fitted after the network, on its frozen condition vectors (:mod:`training.touch`).
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


class DuetSpace(nn.Module):
    """The space in which two people's tokens are diffused, and the way back to metres.

    ``mean`` and ``std`` (70,) are those of one person's control point, see :mod:`models.motion_tokens`.
    """

    mean: Tensor
    std: Tensor

    def __init__(self, layout: TokenLayout) -> None:
        super().__init__()
        self.layout = layout
        self.register_buffer("mean", torch.zeros(FEATURES))
        self.register_buffer("std", torch.ones(FEATURES))

    @property
    def scale(self) -> Tensor:
        """(2·token_features,) metres to a unit of network space."""
        return self.std.repeat(2 * self.layout.knots_per_token)

    def control(self, x: Tensor) -> Tensor:
        """Network space (B, tokens, 2·token_features) → control points (B, 2, knots, 70) in metres."""
        return unpack(x, self.layout) * self.std + self.mean

    def positions(self, x: Tensor) -> tuple[Tensor, Tensor]:
        """Network space → positions (B, 2, T, 22, 3) in metres and contact scores (B, 2, T, 4)."""
        return decode(self.control(x), self.layout)


class CompactInterGen(DuetSpace):
    """Denoiser, text conditioner and the normaliser of control points."""

    def __init__(self, config: CompactConfig) -> None:
        super().__init__(config.layout)
        self.config = config
        self.denoiser = InterGenDenoiser(
            InterGenConfig(
                input_features=config.layout.token_features,
                latent_dim=config.latent_dim,
                ff_size=config.ff_size,
                num_layers=config.num_layers,
                num_heads=config.num_heads,
                cond_dim=config.cond_dim,
                dropout=config.dropout,
                role_embedding=True,
                role_text=config.role_text,
            )
        )
        self.conditioner = TextConditioner(
            TextConditionerConfig(latent_dim=config.cond_dim, num_layers=config.text_layers, dropout=0.05)
        )
        self.touch_reader = TouchReader(config.cond_dim, config.touches) if config.touches else None

    def touches(self, condition: Tensor) -> list[Touch]:
        """What should touch, for each condition vector (B, cond_dim); () where nothing should."""
        if self.touch_reader is None:
            return [()] * len(condition)
        return self.touch_reader.read(condition)


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


class WeightsFolder:
    """A model's folder, every file checked against the SHA-256 that its ``config.json`` names.

    Raises WeightsError where a file is missing or altered.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        try:
            self.meta = json.loads((folder / "config.json").read_text())
            self.files: dict[str, str] = dict(self.meta["files"])
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise WeightsError(
                f"The model's weights are missing or damaged ({folder.name}/config.json): restore the folder "
                "from the project."
            ) from error

    @cached_property
    def digest(self) -> str:
        """One SHA-256 for all files, by which a manifest names the weights."""
        return hashlib.sha256(json.dumps(self.files, sort_keys=True).encode()).hexdigest()

    def read(self, name: str) -> bytes:
        """The bytes of one file."""
        try:
            data = (self.folder / name).read_bytes()
        except OSError as error:
            raise WeightsError(
                f"The weights file {self.folder.name}/{name} is missing: restore it from the project."
            ) from error
        if hashlib.sha256(data).hexdigest() != self.files.get(name):
            raise WeightsError(
                f"The weights file {self.folder.name}/{name} is altered (its SHA-256 differs): restore it "
                "from the project."
            )
        return data

    def tensors(self, name: str) -> dict[str, Tensor]:
        try:
            return load(self.read(name))
        except SafetensorError as error:
            raise WeightsError(f"{self.folder.name}/{name} is no safetensors file: restore it.") from error

    def model(self) -> CompactInterGen:
        """The network in float32, eval mode."""
        model = CompactInterGen(CompactConfig.from_dict(self.meta["model"]))
        weights: dict[str, Tensor] = {}
        for name in self.files:
            if name.startswith("model"):
                weights |= self.tensors(name)
        try:
            model.load_state_dict({name: tensor.float() for name, tensor in weights.items()})
        except RuntimeError as error:
            raise WeightsError(
                f"The weights in {self.folder.name} do not fit their config: restore them."
            ) from error
        return model.eval().requires_grad_(False)

    def captions(self) -> CaptionBank:
        vectors = self.tensors("captions.safetensors")["vectors"]
        captions = json.loads(self.read("captions.json"))
        return CaptionBank(tuple(captions), vectors, float(self.meta["far"]))


def save_folder(
    folder: Path, model: CompactInterGen, bank: CaptionBank, *, shard_bytes: int = 15_000_000, **meta: Any
) -> None:
    """Writes a model's folder: float16 shards of at most ``shard_bytes``, the caption bank, ``config.json``.

    ``config.json`` comes last, so a folder that was not written whole does not load.
    """
    from safetensors.torch import save

    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("model*.safetensors"):
        old.unlink()
    shards: list[dict[str, Tensor]] = [{}]
    size = 0
    for name, tensor in model.state_dict().items():
        tensor = tensor.detach().cpu().half().contiguous()
        if size + tensor.nbytes > shard_bytes and shards[-1]:
            shards.append({})
            size = 0
        shards[-1][name] = tensor
        size += tensor.nbytes
    contents = {f"model-{i + 1}-of-{len(shards)}.safetensors": save(s) for i, s in enumerate(shards)}
    contents["captions.safetensors"] = save({"vectors": bank.vectors.half().contiguous()})
    contents["captions.json"] = json.dumps(bank.captions, indent=0).encode()
    for name, data in contents.items():
        (folder / name).write_bytes(data)
    files = {name: hashlib.sha256(data).hexdigest() for name, data in contents.items()}
    config = {"model": asdict(model.config), "files": files, "far": bank.far} | meta
    (folder / "config.json").write_text(json.dumps(config, indent=1) + "\n")
