"""The compact ReGenNet: ReGenNet over spline control points, online or offline.

ReGenNet (Xu et al., section 3.2) denoises one row a frame. Here a row is a control point of a cubic
B-spline in time, as in :mod:`models.motion_tokens`: four times fewer rows, and no jitter by construction.

*Online.* A frame depends on its interval's first control point and the three after it, so these are predicted
ahead: row j sees the actor up to frame ``frames_per_knot · (j − 3)`` and the rows up to j. Once that frame
has arrived, the next ``frames_per_knot`` frames of the reaction are known; none of them depends on a later
frame of the actor. *Offline* uses the same network without the causal mask; a learned vector marks the mode.

Shapes: B batch, K rows, T frames, d latent width.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from models.diffusion import classifier_free, denoise, guide, make_scheduler
from models.intergen.compact import Touch, TouchReader, read_touches
from models.layers import sinusoids_at
from models.motion_tokens import FEATURES, NUM_JOINTS, TokenLayout, decode, pose_rows
from models.regennet.network import (
    ROW_WIDTH,
    ReGenNet,
    ReGenNetConfig,
    Stream,
    StreamError,
    attend_to_one,
    decoder_layer,
)
from models.text import TextConditioner, TextConditionerConfig
from models.weights_io import common

LEAD = 3
"""Control points beyond an interval's first that its frames depend on."""
POSE = 3 * NUM_JOINTS
ACTOR_FEATURES = 2 * POSE
BEGIN_FEATURES = POSE + 1


@dataclass(frozen=True)
class CompactReGenNetConfig:
    """Sizes of a :class:`CompactReGenNet`, and the touches that it reads from a sentence.

    window: how many rows an online row sees, itself included.
    """

    latent_dim: int = 192
    ff_size: int = 512
    num_layers: int = 6
    num_heads: int = 4
    cond_dim: int = 256
    text_layers: int = 2
    window: int = 40
    frames_per_knot: int = 4
    touches: tuple[Touch, ...] = ()


class CompactReGenNet(nn.Module):
    """Denoiser, text conditioner and normalisers.

    ``mean`` and ``std`` (70,) are those of the reactor's control point, ``actor_mean`` and ``actor_std``
    (132,) those of :meth:`actor_rows`.
    """

    sizes = CompactReGenNetConfig
    mean: Tensor
    std: Tensor
    actor_mean: Tensor
    actor_std: Tensor

    def __init__(self, config: CompactReGenNetConfig) -> None:
        super().__init__()
        self.config = config
        self.layout = TokenLayout(config.frames_per_knot, 1)
        self.network = ReGenNet(
            ReGenNetConfig(
                rows=-(-FEATURES // ROW_WIDTH),
                actor_rows=ACTOR_FEATURES // ROW_WIDTH,
                online=True,
                dropout=0.0,
                **common(config, ReGenNetConfig),
            )
        )
        self.condition = nn.Linear(config.cond_dim, config.latent_dim, bias=False)
        self.begin = nn.Linear(BEGIN_FEATURES, config.latent_dim, bias=False)
        self.offline = nn.Parameter(torch.zeros(config.latent_dim))
        self.conditioner = TextConditioner(
            TextConditionerConfig(latent_dim=config.cond_dim, num_layers=config.text_layers, dropout=0.0)
        )
        self.touch_reader = TouchReader(config.cond_dim, config.touches) if config.touches else None
        for name, width in (("mean", FEATURES), ("actor_mean", ACTOR_FEATURES)):
            self.register_buffer(name, torch.zeros(width))
        for name, width in (("std", FEATURES), ("actor_std", ACTOR_FEATURES)):
            self.register_buffer(name, torch.ones(width))

    def touches(self, condition: Tensor) -> list[Touch]:
        """The joints that should touch, for each condition vector (B, cond_dim); () if none should."""
        return read_touches(self.touch_reader, condition)

    # ---- motion ----------------------------------------------------------------------------------

    def num_rows(self, frames: int) -> int:
        """Control points that ``frames`` frames need."""
        return self.layout.num_tokens(frames)

    def actor_rows(self, positions: Tensor) -> Tensor:
        """The actor as each row sees it, normalised: positions (B, T, 22, 3) metres → (B, K, 132).

        The pose at the row's frame, and how it differs from the pose a knot earlier.
        """
        step = self.config.frames_per_knot
        knots = torch.arange(self.num_rows(positions.shape[1]), device=positions.device) - LEAD
        now = pose_rows(positions[:, step * knots.clamp_min(0)])
        before = pose_rows(positions[:, step * (knots - 1).clamp_min(0)])
        return (torch.cat([now, now - before], dim=-1) - self.actor_mean) / self.actor_std

    def begin_row(self, pose: Tensor) -> Tensor:
        """The reactor's first pose in the form that :meth:`embed` takes: (…, 22, 3) metres → (…, 67).

        The pose, normalised, and a 1 that says it is given; zeros say that it is not.
        """
        row = (pose_rows(pose) - self.mean[:POSE]) / self.std[:POSE]
        return torch.cat([row, torch.ones_like(row[..., :1])], dim=-1)

    def positions(self, x: Tensor, frames: int) -> tuple[Tensor, Tensor]:
        """Network space (B, K, 70) → positions (B, T, 22, 3) in metres and foot contacts (B, T, 4)."""
        decoded, contacts = decode(x * self.std + self.mean, self.layout)
        return decoded[:, :frames], contacts[:, :frames]

    # ---- network ---------------------------------------------------------------------------------

    def embed(self, t: Tensor, condition: Tensor, begin: Tensor | None, *, causal: bool) -> Tensor:
        """The token that all rows attend to, (B, d): timestep, words (zeros for none), the reactor's first
        pose (:meth:`begin_row`; None or zeros where it is open), and the mode."""
        emb = self.network.embed_timestep(t) + self.condition(condition)
        if begin is not None:
            emb = emb + self.begin(begin)
        return emb if causal else emb + self.offline

    def forward(
        self,
        x: Tensor,
        t: Tensor,
        actor: Tensor,
        condition: Tensor,
        *,
        causal: bool,
        start: Tensor | None = None,
        begin: Tensor | None = None,
    ) -> Tensor:
        """The predicted clean reaction.

        Args:
            x: (B, K, 70) noised reaction in network space.
            t: (B,) int64 timesteps.
            actor: (B, K, 132) of :meth:`actor_rows`.
            condition: (B, cond_dim) of the conditioner; zeros leave the words out.
            causal: online; else every row sees all.
            start: (B,) int64, the place of the first row, 0 by default; training draws it, so that long
                streams meet no place that is new.
            begin: (B, 67) of :meth:`begin_row`, where the reactor's first pose is given.

        Returns:
            (B, K, 70)
        """
        rows, d = x.shape[1], self.config.latent_dim
        emb = self.embed(t, condition, begin, causal=causal)
        place = torch.arange(rows, device=x.device)
        places = place if start is None else place + start[:, None]
        h = self.network.fuse(widen(x), actor)
        h = h + sinusoids_at(places.flatten(), d).view(*places.shape, d)
        mask = None
        if causal:
            behind = place[:, None] - place[None]
            mask = (behind >= 0) & (behind < self.config.window)
        attend = partial(F.scaled_dot_product_attention, attn_mask=mask)
        for layer in self.network.seqTransDecoder.layers:
            memory = attend_to_one(layer.multihead_attn, emb)[:, None]
            h = decoder_layer(layer, h, memory, attend)
        return self.network.output_process(h)[..., :FEATURES]

    def guided(
        self, x: Tensor, t: Tensor, actor: Tensor, condition: Tensor, *, scale: float, begin: Tensor | None = None
    ) -> Tensor:
        """Offline :func:`models.diffusion.classifier_free` on the words; shapes as in `forward`."""

        def predict(x: Tensor, t: Tensor, actor: Tensor, begin: Tensor | None, condition: Tensor) -> Tensor:
            return self(x, t, actor, condition, causal=False, begin=begin)

        scale = scale if condition.any() else 1.0  # without words both halves are the same
        return classifier_free(predict, x, t, actor, begin, cond=condition, scale=scale)


def widen(x: Tensor) -> Tensor:
    """(…, 70) → (…, 72): whole rows of six."""
    return F.pad(x, (0, -FEATURES % ROW_WIDTH))


class CompactStream(Stream):
    """One actor frame in, one reaction frame out.

    Rows are denoised at every ``frames_per_knot``-th frame, the frames between are read off the spline, so
    most frames cost next to nothing and the others the same whatever came before: attention reaches back
    over a fixed window.

    Args:
        model: the network.
        condition: (B, cond_dim) of B samples.
        steps: DDIM steps.
        scale: of the guidance.
        max_frames: how many frames there can be.
        begin: (B, 67) of :meth:`CompactReGenNet.begin_row` where the reactor's first pose is given.
    """

    def __init__(
        self,
        model: CompactReGenNet,
        condition: Tensor,
        *,
        steps: int,
        scale: float = 1.0,
        max_frames: int,
        begin: Tensor | None = None,
    ) -> None:
        if max_frames < 1:
            raise StreamError("A stream needs at least one frame: give max_frames 1 or more.")
        self.model, self.scale = model, scale
        self.guided = scale != 1 and bool(condition.any())
        if self.guided:
            condition = torch.cat([condition, torch.zeros_like(condition)])
            begin = None if begin is None else torch.cat([begin, begin])
        super().__init__(
            model.network,
            lambda t: model.embed(t.expand(len(condition)), condition, begin, causal=True),
            make_scheduler("ddim", steps, spacing="top"),
            max_frames=max_frames,
            rows=model.num_rows(max_frames) + 1,
            window=model.config.window,
        )
        self._last: Tensor | None = None
        self._recent: list[Tensor] = []
        self._interval: tuple[Tensor, Tensor]  # the frames up to the next row, set with the first frame

    @torch.no_grad()
    def step(self, actor: Tensor, *, noise: Iterator[Tensor]) -> tuple[Tensor, Tensor]:
        """The reaction's next frame.

        Args:
            actor: (22, 3) metres, the actor's frame in the network's frame of reference.
            noise: gives a (B, 70) tensor for each row; four rows are taken at the first frame and one at
                every ``frames_per_knot``-th.

        Returns:
            Positions (B, 22, 3) in metres and contact scores (B, 4) of the feet. Raises StreamError after
            ``max_frames`` frames.
        """
        interval, within = divmod(self.count(), self.model.config.frames_per_knot)
        if within == 0:
            pose = pose_rows(actor)
            last = pose if self._last is None else self._last
            seen = torch.cat([pose, pose - last])
            seen = (seen - self.model.actor_mean) / self.model.actor_std
            for _ in range(1 if interval else 1 + LEAD):
                self._recent.append(self._denoise(seen, next(noise)))
            self._recent = self._recent[-1 - LEAD :]
            self._last = pose
            control = torch.stack(self._recent, dim=1) * self.model.std + self.model.mean
            self._interval = decode(control, self.model.layout)
        positions, contacts = self._interval
        return positions[:, within], contacts[:, within]

    def _denoise(self, seen: Tensor, x: Tensor) -> Tensor:
        """The next row (B, 70) from its noise."""

        def predict(x: Tensor, t: Tensor) -> Tensor:
            # Both halves of the guidance are lanes of one pass, which keeps what each has seen.
            lanes = torch.cat([x, x]) if self.guided else x
            rows = self.passes[int(t[0])].step(widen(lanes), seen.expand(len(lanes), -1))[..., :FEATURES]
            if not self.guided:
                return rows
            conditional, unconditional = rows.chunk(2)
            return guide(conditional, unconditional, self.scale)

        return denoise(predict, x, self.scheduler)
