"""Data of the compact InterGen: a run's settings, and batches of scenes with their words."""

from __future__ import annotations

import json
from bisect import bisect
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from models.intergen.losses import LossWeights
from models.motion_tokens import canonical_control, mirror_control, pack, unpack
from motion import SMPL22, InputError
from training.core import checkpoint
from training.core.handedness import mirror_caption, mirrored
from training.core.loop import moved
from training.core.shell import at_least
from training.core.text_features import CaptionFeatures, CaptionTokens
from training.corpus.cues import STILL
from training.prepare import Scenes, normalizer, sentence_lists
from training.trainers.given import Shares


@dataclass(frozen=True)
class Settings:
    """The settings of a run; a checkpoint of others is refused.

    cond_drop_prob: probability that a scene's words are dropped, for classifier-free guidance.
    noisiest: share of samples whose timestep is drawn from the noisiest tenth, where it is decided what
        happens, see :func:`training.trainers.intergen.draw_timesteps`.
    continued: share of the scenes of several beats that are cut: their words are one beat's, and what came before
        is given, which is how a scene is made longer.
    given: how often each kind of part of the motion is given.
    """

    latent_dim: int = 320
    ff_size: int = 1024
    num_layers: int = 4
    num_heads: int = 5
    cond_dim: int = 256
    dropout: float = 0.0
    batch: int = 32
    steps: int = 20_000
    learning_rate: float = 4e-4
    warmup: int = 300
    weight_decay: float = 2e-5
    ema: float = 0.9985
    cond_drop_prob: float = 0.1
    root_weight: float = 4.0
    t_bar: float = 0.7
    noisiest: float = 0.4
    seed: int = 0
    continued: float = 0.2
    given: Shares = field(default_factory=Shares)
    weights: LossWeights = field(
        default_factory=lambda: LossWeights(
            velocity=300.0,
            foot_contact=300.0,
            bone_length=30.0,
            distance_map=10.0,
            joint_affinity=1.0,
            relative_orientation=0.02,
            contact=10.0,
        )
    )

    def __post_init__(self) -> None:
        sizes = ("latent_dim", "ff_size", "num_layers", "num_heads", "cond_dim", "batch", "warmup")
        at_least(self, **dict.fromkeys(sizes, 1))


def settings_of(path: Path) -> Settings:
    """The settings of a checkpoint; raises InputError where it is damaged or of another trainer."""
    known = json.loads(checkpoint.metadata(path)["settings"])
    try:
        parts = {"weights": LossWeights, "given": Shares}
        known |= {name: kind(**known[name]) for name, kind in parts.items()}
        return Settings(**known)
    except (KeyError, TypeError) as error:
        raise InputError(f"{path} is of another training ({error}): give one of this version.") from error


def seeded(*words: int) -> torch.Generator:
    """A generator that depends on all the given numbers, the same on every machine."""
    return torch.Generator().manual_seed(int(np.random.SeedSequence(words).generate_state(1)[0]))


SENTENCES: dict[tuple[bool, bool, bool], float] = {
    (True, False, False): 0.45,
    (True, True, True): 0.2,
    (False, True, True): 0.15,
    (True, True, False): 0.05,
    (True, False, True): 0.05,
    (False, True, False): 0.05,
    (False, False, True): 0.05,
}
"""How often which sentences of a scene that has all three are read: the one for both, for a, for b."""


@dataclass
class Batch:
    """Scenes as the network takes them.

    Attributes:
        x0: (B, tokens, 2·F) normalised motion.
        mask: (B, tokens, 2), 1 where a token is real.
        frame_mask: (B, T), 1 where a frame is real.
        text: (N, L, 384) features of N sentences, those for both people of all B first; until
            :meth:`Data.on_device`, (N, L) ids where the encoder runs in each step.
        text_mask: (N, L) bool.
        places: (N,) 3 times a sentence's row, plus 0 for both people, 1 for a, 2 for b.
        read: (B, 3), 1 where a sentence is read; those for both people are there even if they are not.
        past: (B,) frames at the beginning that are given.
    """

    x0: Tensor
    mask: Tensor
    frame_mask: Tensor
    text: Tensor
    text_mask: Tensor
    places: Tensor
    read: Tensor
    past: Tensor


LEAST = 20
"""Frames of a beat that must be left of it, where a scene was cut to ten seconds."""


def later_beats(row: dict[str, Any]) -> list[dict[str, Any]]:
    """The beats of a scene that follow on another and that have words."""
    return [beat for beat in (row.get("beats") or ())[1:] if beat["captions"] and not beat.get("minor")]


def acts_of(row: dict[str, Any]) -> set[str]:
    """The acts of either person in a scene of beats, besides standing; none for other scenes."""
    return {act for beat in row.get("beats") or () for act in beat["acts"]} - {STILL}


REPEATS = 5
"""How often a rare scene is drawn where a common one is drawn once."""


def balanced(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The rows, those of rare families and of rare acts in scenes of beats up to :data:`REPEATS` times.

    A family is rare beside those that are commoner than three in four, so that long scenes do not make it rare. An act
    is rare beside the commonest tenth: scenes of beats hold many acts, most of them ways of coming and going.
    """
    families = Counter(row["family"] for row in rows)
    acts = Counter(act for row in rows for act in acts_of(row))
    usual = float(np.quantile(list(families.values()), 0.75))
    usual_act = float(np.quantile(list(acts.values()) or [0], 0.9))

    def repeats(row: dict[str, Any]) -> int:
        rarest = min((acts[act] for act in acts_of(row)), default=0)
        return min(max(round(usual_act / rarest if rarest else usual / families[row["family"]]), 1), REPEATS)

    return [row for row in rows for _ in range(repeats(row))]


class Data:
    """Draws batches of similar lengths, on the CPU; batch ``step`` is the same in every run of the same seed.

    Args:
        settings: its ``batch``, ``seed`` and ``cond_drop_prob``, and of InterGen ``continued``.
        cache: where the features of sentences are kept.
        device: where the text encoder runs: on a CPU once for all sentences, on a GPU in each step.
        captions: whether the batches have words.
    """

    captions: CaptionFeatures | CaptionTokens | None = None

    def __init__(self, scenes: Scenes, settings: Any, cache: Path, device: str, *, captions: bool = True) -> None:
        self.scenes, self.settings, self.device = scenes, settings, device
        self.rows = self.weighted(scenes.split("train"))
        if len(self.rows) < settings.batch:
            raise InputError(
                f"{len(self.rows)} training scenes do not fill a batch of {settings.batch}: lower --batch."
            )
        if captions:
            known = self.known_captions()
            known |= {mirror_caption(c) for c in known}
            on_cpu = torch.device(device).type == "cpu"
            self.captions = CaptionFeatures(sorted(known), cache) if on_cpu else CaptionTokens(device)
        self.mean, self.std = normalizer(scenes)
        self.tokens = torch.tensor([row["tokens"] for row in self.rows])
        self.batches_an_epoch = len(self.rows) // settings.batch
        self._epoch, self._order = -1, torch.empty(0)

    def weighted(self, rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
        """The rows, each as often as it is drawn."""
        return balanced(rows)

    def known_captions(self) -> set[str]:
        """All captions that a batch may have, but for their mirror images."""
        known = {c for row in self.rows for sentences in sentence_lists(row) for c in sentences}
        if self.settings.continued:
            known |= {c for row in self.rows for beat in later_beats(row) for c in beat["captions"]}
        return known

    def _rows_of(self, step: int) -> Tensor:
        epoch, place = divmod(step, self.batches_an_epoch)
        if epoch != self._epoch:
            generator = seeded(self.settings.seed, 1, epoch)
            jitter = torch.rand(len(self.rows), generator=generator) * 6
            by_length = (self.tokens + jitter).argsort()
            spare = len(by_length) % self.settings.batch
            keep = torch.randperm(len(by_length), generator=generator)[spare:].sort().values
            groups = by_length[keep].view(self.batches_an_epoch, -1)
            self._order = groups[torch.randperm(len(groups), generator=generator)]
            self._epoch = epoch
        return self._order[place]

    def sentences(self, row: dict[str, Any], draw: Sequence[float]) -> tuple[list[str], list[bool]]:
        """A scene's sentences for both people, a and b, and which are read.

        Args:
            draw: five numbers uniform in [0, 1): for which are read, two, and for each sentence.
        """
        drawn = zip(sentence_lists(row), draw[2:], strict=True)
        chosen = [sentences[int(u * len(sentences))] if sentences else "" for sentences, u in drawn]
        if draw[0] < self.settings.cond_drop_prob:
            return chosen, [False] * 3
        if not all(chosen):
            return chosen, [True, False, False]
        read = bisect(list(accumulate(SENTENCES.values())), draw[1])
        return chosen, list(list(SENTENCES)[min(read, len(SENTENCES) - 1)])

    def continued(self, row: dict[str, Any], draw: Sequence[float]) -> tuple[Tensor, int, str] | None:
        """A scene from some time before one of its later beats until that beat's end.

        Args:
            draw: four numbers uniform in [0, 1): whether, which beat, its sentence, how long before.

        Returns:
            control points (2, K, 70) in metres, canonical, how many frames pass before the beat, and its words;
            None where the scene is not cut.
        """
        beats = later_beats(row)
        if not beats or draw[0] >= self.settings.continued:
            return None
        beat = beats[int(draw[1] * len(beats))]
        layout = self.scenes.layout
        knot = max(0, beat["start"] - round(15 + 45 * draw[3])) // layout.frames_per_knot
        before, after = (beat[key] - knot * layout.frames_per_knot for key in ("start", "end"))
        left = (row["tokens"] * layout.knots_per_token - knot) // layout.knots_per_token
        tokens = min(layout.num_tokens(after), left)
        if before + LEAST > layout.num_frames(tokens):
            return None
        one = self.scenes.scene(row)[:, knot : knot + tokens * layout.knots_per_token]
        words = beat["captions"][int(draw[2] * len(beat["captions"]))]
        return canonical_control(one), before, words

    def mirrors(self, row: dict[str, Any], text: str, draw: float) -> bool:
        """Whether a scene is shown mirrored under this text; ``draw`` is uniform in [0, 1)."""
        return mirrored(text, row.get("hand"), draw)

    def features(self, captions: list[str]) -> tuple[Tensor, Tensor]:
        """The text encoder's output for captions: features (B, …) and their mask."""
        assert self.captions is not None
        return self.captions.batch(captions)

    def control(self, x0: Tensor) -> Tensor:
        """Normalised motion (B, tokens, 2·F) → control points (B, 2, K, 70) in metres."""
        return unpack(x0, self.scenes.layout) * self.std.to(x0) + self.mean.to(x0)

    def batch(self, step: int) -> Batch:
        """The batch of a step; the same for the same seed and step."""
        settings, layout = self.settings, self.scenes.layout
        rows = [self.rows[i] for i in self._rows_of(step)]
        generator = seeded(settings.seed, 2, step)
        draws = torch.rand(len(rows), 10, generator=generator).tolist()
        tokens = -4 * (-max(row["tokens"] for row in rows) // 4)  # few shapes: kernels are made for each
        control = self.mean.expand(len(rows), 2, tokens * layout.knots_per_token, -1).clone()
        mask, read = torch.zeros(len(rows), tokens, 2), torch.zeros(len(rows), 3)
        frame_mask = torch.zeros(len(rows), layout.num_frames(tokens))
        past = torch.zeros(len(rows), dtype=torch.long)
        both, alone, places = [], [], []
        for i, (row, draw) in enumerate(zip(rows, draws, strict=True)):
            one, (sentences, chosen) = self.scenes.scene(row), self.sentences(row, draw[1:6])
            cut = self.continued(row, draw[6:])
            if cut is not None:
                one, past[i], words = cut
                sentences, chosen = [words, "", ""], [any(chosen), False, False]
            own = one.shape[1] // layout.knots_per_token
            named = [s for s, wanted in zip(sentences, chosen, strict=True) if wanted]
            text = " ".join(named or sentences[:1])
            mirror = self.mirrors(row, text, draw[0])
            if mirror:
                one = mirror_control(one, SMPL22.mirror)
                sentences = [mirror_caption(sentence) for sentence in sentences]
            control[i, :, : one.shape[1]] = one
            mask[i, :own] = 1
            frame_mask[i, : layout.num_frames(own)] = 1
            read[i] = torch.tensor(chosen)
            both.append(sentences[0])
            for person in (1, 2):
                if chosen[person]:
                    alone.append(sentences[person])
                    places.append(3 * i + person)
        text, text_mask = self.features(both + alone)
        x0 = pack((control - self.mean) / self.std, layout)
        where = torch.tensor([*range(0, 3 * len(rows), 3), *places])
        return Batch(x0, mask, frame_mask, text, text_mask, where, read, past)

    def on_device(self, batch: Batch) -> Batch:
        """A batch on the device, with the features of its sentences."""
        batch = moved(batch, self.device)
        if self.captions is None:
            return batch
        return replace(batch, text=self.captions.features_of(batch.text, batch.text_mask))


class OneSentence(Data):
    """Batches in which of the words only those for both people are read, and no scene is cut."""

    def caption(self, row: dict[str, Any], draw: float) -> str:
        """The words of a scene; ``draw`` is uniform in [0, 1)."""
        return row["captions"][int(draw * len(row["captions"]))]

    def known_captions(self) -> set[str]:
        """All captions that a batch may have, but for their mirror images."""
        return {caption for row in self.rows for caption in row["captions"]}

    def sentences(self, row: dict[str, Any], draw: Sequence[float]) -> tuple[list[str], list[bool]]:
        """A scene's sentence, and whether it is read."""
        return [self.caption(row, draw[2]), "", ""], [draw[0] >= self.settings.cond_drop_prob, False, False]

    def continued(self, row: dict[str, Any], draw: Sequence[float]) -> tuple[Tensor, int, str] | None:
        """The whole scene."""
        return None
