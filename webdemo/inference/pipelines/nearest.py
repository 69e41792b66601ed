"""Reactions out of a bank of recorded pairs: the reactor of the pair whose actor moves most alike.

The baseline of the tables in docs/reactions.md, on which it is ahead of InterFormer by the thesis' own lists. A motion
that is longer than the recordings is answered part by part, each from the last pose of the part before, as InterFormer
does (Chopin's thesis, section 3.5).
"""

from __future__ import annotations

import hashlib
import itertools
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.weights_io import WeightsFolder
from motion import FPS, SMPL22, Clip, Duet, InputError
from motion.formats import read
from motion.transforms import Placement, resample
from motion.vectors import Array
from webdemo.inference.built_in import REACTIONS_VARIABLE
from webdemo.inference.finish.cleanup import clean_person
from webdemo.inference.requests import ReactRequest
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer

from .given import reacted, settle

MOMENTS = 16
"""At which actors are compared, over their whole length."""
PART = 90
"""Frames that are answered by one recording, at most."""
_NO_WORDS = "The nearest recorded reaction takes no words: it goes by what the given person does."


@dataclass(frozen=True, eq=False)
class Bank:
    """Recorded pairs, compared by their actors and by the reactors' first poses.

    Attributes:
        pairs: (2, T, 22, 3) metres each, actor first, in the actor's first frame (:class:`Placement`).
    """

    pairs: Sequence[Array]

    def answers(self, actor: Array, first_pose: Array | None = None) -> NDArray[np.integer]:
        """The numbers of the pairs, the nearest first.

        Args:
            actor: (T, 22, 3) metres in the actor's first frame.
            first_pose: (22, 3) of the reactor; by default only actors are compared.
        """
        seen = _outline(actor, first_pose)
        known = np.stack([_outline(pair[0], pair[1, 0])[: len(seen)] for pair in self.pairs])
        return np.argsort(np.linalg.norm(known - seen, axis=-1).mean(axis=-1), kind="stable")

    def reactor(self, number: int, frames: int, first_pose: Array | None = None) -> Array:
        """The reactor (frames, 22, 3) of a pair, stretched.

        Put where the first pose stands, every joint is moved by as much as it moved from its own first pose.
        """
        positions = self.pairs[number][1]
        moments = np.linspace(0, len(positions) - 1, frames)
        lower = np.minimum(moments.astype(int), len(positions) - 1)
        upper = np.minimum(lower + 1, len(positions) - 1)
        share = (moments - lower)[:, None, None]
        stretched = (1 - share) * positions[lower] + share * positions[upper]
        return stretched if first_pose is None else first_pose + stretched - stretched[:1]


def _outline(actor: Array, first_pose: Array | None) -> Array:
    """(17 · 22, 3): the actor at 16 moments, then the reactor's first pose, if there is one."""
    moments = np.linspace(0, len(actor) - 1, MOMENTS).round().astype(int)
    seen = actor[moments].reshape(-1, 3)
    return seen if first_pose is None else np.concatenate([seen, first_pose])


def read_bank(folder: Path) -> Bank:
    """The two-person files of a folder, person a as the one who acts.

    Raises:
        InputError: if it holds none, or one of another skeleton.
    """
    pairs = []
    for file in sorted(folder.glob("*.npz")):
        duet = read(file)
        if not isinstance(duet, Duet) or duet.skeleton.joint_names != SMPL22.joint_names:
            raise InputError(f"{file.name} in the folder of recorded reactions is not of two people on SMPL's joints.")
        positions = np.stack([resample(person, duet.fps, FPS) for person in duet.positions.astype(np.float64)])
        pairs.append(Placement.of(Clip(positions[0], FPS, SMPL22), "a").to_network(positions))
    if not pairs:
        raise InputError(f"The folder of recorded reactions {folder.name} holds no .npz of two people.")
    return Bank(pairs)


class NearestPipeline:
    """Answers from the shipped bank, or from that of :data:`REACTIONS_VARIABLE`.

    Raises WeightsError or InputError where files are missing, altered or of something else.
    """

    def __init__(self, folder: Path) -> None:
        self.name, own = folder.name, os.environ.get(REACTIONS_VARIABLE)
        source = WeightsFolder(folder)
        for name in source.files:
            source.read(name)  # as its checksums say
        self.bank, self.digest = read_bank(folder), source.digest
        if own:
            self.bank = read_bank(Path(own).expanduser())
            self.digest = hashlib.sha256(
                b"".join(np.ascontiguousarray(p).tobytes() for p in self.bank.pairs)
            ).hexdigest()

    def run(self, request: ReactRequest, cancel: CancelToken, timer: StageTimer) -> Iterator[Progress | Result]:
        """Progress events, then one :class:`Result` without a manifest; sample k is the k-th nearest.

        Raises:
            Cancelled: within one part.
        """
        frames = request.actor.num_frames
        raw = []
        for sample in range(request.samples):
            yield timer.progress("sample", sample + 1, request.samples, "pass")
            cancel.raise_if_cancelled()
            raw.append(self._reaction(request, sample))
        timer.lap("sample")
        yield timer.progress("finish")
        shown = [clean_person(person) if request.cleanup else person for person in raw]
        if request.first_pose is not None:
            shown = [one + settle(request.first_pose - one[:1], np.arange(frames))[0] for one in shown]
        yield reacted(request, raw, shown, (_NO_WORDS,) if request.prompt.strip() else ())

    def _reaction(self, request: ReactRequest, sample: int) -> Array:
        """The reactor (T, 22, 3) in the actor's world; only the first part depends on the sample."""
        actor, pose = request.actor, request.first_pose
        edges = np.linspace(0, actor.num_frames, -(-actor.num_frames // PART) + 1).round().astype(int)
        made: list[Array] = []
        for first, last in itertools.pairwise(edges):
            here = Placement.of(actor.cut(int(first), int(last)), "a")
            begins = None if pose is None else here.to_network(pose)
            ranked = self.bank.answers(here.to_network(actor.positions[first:last]), begins)
            number = int(ranked[min(sample if first == 0 else 0, len(ranked) - 1)])
            part = here.to_world(self.bank.reactor(number, int(last - first) + 1, begins))
            made.append(part[:-1])
            pose = part[-1]
        return np.concatenate(made)
