"""A second person for a given one by the compact InterFormer: a pose after the other, from a first one.

The network knows 15 joints at 15 frames a second. The actor's are taken out of SMPL22's; the reactor's are
brought back by a fit of constant bones to the whole motion (:mod:`webdemo.motion.ik`), so nothing pops. Long
actors are answered in sub-sequences, each begun with the last pose of the one before (Chopin's thesis,
section 3.5) and seen from where the actor then stands, as the clips of the training were.
"""

from __future__ import annotations

import time
from collections.abc import Generator, Iterator
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from models.compact_interformer import FPS as NETWORK_FPS
from models.compact_interformer import JOINTS_15, load_folder
from models.interformer_decoding import ReactionDecoder
from webdemo.metrics import compare
from webdemo.motion import SMPL22, Clip, InputError
from webdemo.motion.ik import fit_skeleton
from webdemo.motion.transforms import heading_matrix, resample

from .actor import FPS, Placement
from .cancel import CancelToken
from .cleanup import clean_person
from .generator import Clock, sample_noise
from .reactor import duet_of, settle
from .requests import GenerateRequest, Progress, ReactRequest, Result

Array = NDArray[np.floating]

APART = 1.05
"""Metres between the two people of the median recorded pair at its first frame."""
_ROOM = 0.7
"""Metres left between the actor's way and one who stands before it."""
_NAMES_15 = tuple(SMPL22.joint_names[joint] for joint in JOINTS_15)
_NOISE = 0.01
"""Metres by which the network's joints are uncertain."""
_NO_WORDS = "InterFormer takes no words: it reacts to what the given person does."


class InterFormerReactor:
    """The compact InterFormer, loaded from a weights folder.

    Raises WeightsError (an InputError) where files are missing or altered.
    """

    def __init__(self, folder: Path) -> None:
        self.model, source = load_folder(folder)
        self.decoder = ReactionDecoder(self.model)
        self.name, self.digest, self.meta = folder.name, source.digest, source.meta

    def run(
        self, request: GenerateRequest | ReactRequest, cancel: CancelToken, clock: Clock
    ) -> Iterator[Progress | Result]:
        """Progress events, then one :class:`Result` without a manifest.

        Raises:
            InputError: for a request without a given person.
            Cancelled: within one frame.
        """
        if not isinstance(request, ReactRequest):
            raise InputError(f"{self.name} answers a given person: give it an actor, or choose intergen.")
        now = time.perf_counter()
        placement = Placement.of(request.actor, "a")
        actor = placement.to_network(request.actor.positions)
        start = self._start(actor) if request.start is None else placement.to_network(request.start)
        made = yield from self._sample(request, actor, start, cancel, clock)
        now = clock.lap("sample", now)
        yield clock.progress("finish")
        frames = request.actor.num_frames
        raw = np.stack([on_smpl22(person, frames) for person in made])
        # The fit's joints without a counterpart, such as the toes, begin where they were given, too.
        raw = raw + settle(start - raw[:, :1], np.arange(frames))
        shown = np.stack([clean_person(person) for person in raw]) if request.cleanup else raw
        duets = [
            [duet_of(request, placement.to_world(person)) for person in people] for people in (raw, shown)
        ]
        readouts = tuple(compare(before, after) for before, after in zip(*duets, strict=True))
        clock.lap("finish", now)
        yield Result(
            duets=tuple(duets[1]),
            manifest={},
            readouts=readouts,
            notes=(_NO_WORDS,) if request.prompt.strip() else (),
            timings={**clock.stages, "total": round(clock.elapsed, 4)},
        )

    def _start(self, actor: Array) -> Array:
        """(22, 3) somebody who stands before the actor, out of their way, and faces where they began."""
        ahead = actor[:, 0, 2].max() + _ROOM
        stance = self.model.stance.double().numpy()
        return stance @ heading_matrix(np.pi).T + np.array([0.0, 0.0, max(APART, ahead)])

    def _sample(
        self, request: ReactRequest, actor: Array, start: Array, cancel: CancelToken, clock: Clock
    ) -> Generator[Progress, None, Array]:
        """Returns the network's frames (samples, T', 15, 3), as many as cover the actor's."""
        noise = sample_noise(request.seed, request.samples, (self.model.config.noise,))
        slow = resample(actor, FPS, NETWORK_FPS)
        reaction = [np.repeat(start[None, list(JOINTS_15)], request.samples, axis=0)]
        total = len(slow) - 1
        while (begun := len(reaction) - 1) < total:
            window = slow[begun : begun + self.model.config.window]
            here = Placement.of(Clip(window, NETWORK_FPS, SMPL22), "a")
            seen = _tensor(here.to_network(window)[:, list(JOINTS_15)])
            first = _tensor(here.to_network(reaction[-1]))
            actors = seen.expand(request.samples, -1, -1, -1)
            for pose in self.decoder.poses_after(actors, first, noise):
                reaction.append(here.to_world(pose.astype(np.float64)))
                yield clock.progress("sample", len(reaction) - 1, total)
                cancel.raise_if_cancelled()
        return np.stack(reaction, axis=1)


def on_smpl22(joints: Array, frames: int) -> Array:
    """The network's joints (T', 15, 3) as SMPL22's, on constant bones at 30 fps: (frames, 22, 3)."""
    fast = resample(joints, NETWORK_FPS, FPS)[:frames]
    fast = np.concatenate([fast, np.repeat(fast[-1:], frames - len(fast), axis=0)])
    return fit_skeleton(fast, _NAMES_15, fps=FPS, noise=_NOISE, scale=1.0, iterations=4).positions


def _tensor(values: Array) -> Tensor:
    return torch.from_numpy(np.ascontiguousarray(values)).float()
