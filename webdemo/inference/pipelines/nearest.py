"""Reactions out of a bank of recorded pairs: the nearest pair's, in the actor's tempo, finished by InterGen.

The pair whose actor moves most alike, faster or slower in between, answers; its reactor follows the actor's tempo, and
InterGen makes this draft one motion with the given actor. docs/reactions.md has what each step brings. A motion that is
longer than the recordings is answered part by part, each from the last pose of the part before, as InterFormer does
(Chopin's thesis, section 3.5).
"""

from __future__ import annotations

import hashlib
import itertools
import os
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.distance import cdist

from acts.staging.window import KnownFrames
from models.weights_io import WeightsFolder
from motion import FPS, SMPL22, Clip, Duet, InputError
from motion.formats import read
from motion.transforms import Placement, heading, heading_matrix, resample
from motion.vectors import FLAT, Array
from webdemo.inference.built_in import REACTIONS_VARIABLE
from webdemo.inference.finish.cleanup import clean_person
from webdemo.inference.requests import GenerateRequest, ReactRequest
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer, until_result

from .given import directed, reacted
from .intergen import InterGenPipeline
from .two_person import Conditioning

MOMENTS = 16
"""At which actors are compared, over their whole length."""
PART = 90
"""Frames that are answered by one recording, at most."""
PAST = 15
"""Frames before a part that InterGen sees when it finishes it."""
_CALM = 6.0
"""Frames: σ of the Gaussian over where an actor is and faces, which a reactor is taken along by."""
_AHEAD = 0.3
"""Seconds: a joint's speed counts as the way that it goes in this time beside its place."""
_NO_WORDS = "The nearest recorded reaction takes no words: it goes by what the given person does."


def _warps() -> PchipInterpolator:
    """Maps shares of an actor's time (N,) to those of an example's, by each warp: (W, N), rising from 0 to 1.

    At each third of its time the actor is ahead of the example or behind it by up to a fifth of the whole; a third
    takes half as long as in the example at least, and twice as long at most.
    """
    thirds, moved = np.linspace(0, 1, 4), np.linspace(-0.2, 0.2, 9)
    inner = thirds[1:3] + np.array(list(itertools.product(moved, moved)))
    warps = np.pad(np.pad(inner, ((0, 0), (1, 0))), ((0, 0), (0, 1)), constant_values=1.0)
    tempo = 3 * np.diff(warps)
    return PchipInterpolator(thirds, warps[((tempo > 0.49) & (tempo < 2.01)).all(axis=1)], axis=1)


WARPS = _warps()


@dataclass(frozen=True, eq=False)
class Bank:
    """Recorded pairs, compared by their actors and by the reactors' first poses.

    Attributes:
        pairs: (2, T, 22, 3) metres each, actor first, in the actor's first frame (:class:`Placement`).
    """

    pairs: Sequence[Array]

    @cached_property
    def _actors(self) -> Array:
        return np.stack([_seen(pair[0]) for pair in self.pairs])

    def answers(self, actor: Array, first_pose: Array | None = None) -> list[tuple[int, Array]]:
        """The pairs, the nearest first: the number of each, and its moment (T,), in frames, at each of the actor's.

        Args:
            actor: (T, 22, 3) metres in the actor's first frame.
            first_pose: (22, 3) of the reactor; by default only actors are compared.
        """
        steps, known = np.arange(MOMENTS), self._actors
        apart = cdist(_seen(actor), known.reshape(-1, known.shape[-1])).reshape(MOMENTS, -1, MOMENTS)
        on_the_way = np.rint(WARPS(steps / (MOMENTS - 1)) * (MOMENTS - 1)).astype(int)
        costs = apart[steps, :, on_the_way].sum(axis=1)  # (W, P)
        nearest, total = costs.argmin(axis=0), costs.min(axis=0)
        if first_pose is not None:  # counts as much as one moment
            total += [np.linalg.norm(pair[1, 0] - first_pose) for pair in self.pairs]
        times = WARPS(np.linspace(0, 1, len(actor)))
        ranked = np.argsort(total, kind="stable").tolist()
        return [(i, times[nearest[i]] * (self.pairs[i].shape[1] - 1)) for i in ranked]

    def reactor(self, number: int, moments: Array, actor: Array, first_pose: Array | None = None) -> Array:
        """The reactor (T, 22, 3) of a pair at some moments (T,) of it, in frames, beside an actor (T, 22, 3).

        Put where the first pose stands, every joint is moved by as much as it moved from its own first pose. Then it is
        taken along, by the share in which it kept to its own actor, to where this one goes and turns instead.
        """
        pair = self.pairs[number]
        lower = np.minimum(moments.astype(int), pair.shape[1] - 1)
        upper = np.minimum(lower + 1, pair.shape[1] - 1)
        share = (moments - lower)[:, None, None]
        example, warped = (1 - share) * pair[:, lower] + share * pair[:, upper]
        if first_pose is not None:
            warped = first_pose + warped - warped[:1]
        way = pair[:, :, :1] * FLAT
        beside = (way[1] - way[0]) @ heading_matrix(heading(pair[0]))
        kept = 1 / (1 + beside.var(axis=0).sum() / max(way[1].var(axis=0).sum(), 1e-9))
        angles = _calm(np.unwrap(heading(actor) - heading(example)))
        there, here = (_calm(person[:, 0] * FLAT)[:, None] for person in (actor, example))
        turned = (warped - here) @ np.swapaxes(heading_matrix(kept * (angles - angles[0])), -1, -2)
        return np.asarray(turned + here + kept * (there - here - (there - here)[0]))


def _calm(values: Array) -> Array:
    """Values (T, …) without what changes within a fifth of a second."""
    return np.asarray(gaussian_filter1d(values, _CALM, axis=0, mode="nearest"))


def _seen(actor: Array) -> Array:
    """(16, 135) of an actor (T, 22, 3): poses and speeds, as seen by somebody who faces with them, and places."""
    speeds = np.diff(actor, axis=0, append=actor[-1:]) * FPS * _AHEAD
    turned = np.concatenate([actor - actor[:, :1] * FLAT, speeds], axis=1) @ heading_matrix(heading(actor))
    every = np.concatenate([turned.reshape(len(actor), -1), actor[:, 0]], axis=-1)
    return every[np.linspace(0, len(actor) - 1, MOMENTS).round().astype(int)]


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

    Args:
        folder: of the shipped bank.
        intergen: finishes what the bank answers.

    Raises WeightsError or InputError where files are missing, altered or of something else.
    """

    def __init__(self, folder: Path, intergen: InterGenPipeline) -> None:
        self.name, own = folder.name, os.environ.get(REACTIONS_VARIABLE)
        self.intergen, source = intergen, WeightsFolder(folder)
        for name in source.files:
            source.read(name)  # as its checksums say
        self.bank = read_bank(Path(own).expanduser() if own else folder)
        known = [np.ascontiguousarray(pair).tobytes() for pair in self.bank.pairs]
        self.digest = hashlib.sha256(b"".join([source.digest.encode(), intergen.digest.encode(), *known])).hexdigest()

    def run(self, request: ReactRequest, cancel: CancelToken, timer: StageTimer) -> Iterator[Progress | Result]:
        """Progress events, then one :class:`Result` without a manifest; sample k is the k-th nearest.

        Raises:
            Cancelled: within one denoising step.
        """
        raw = []
        for sample in range(request.samples):
            raw.append((yield from self._reaction(request, sample, cancel, timer)))
        yield timer.progress("finish")
        shown = [clean_person(person) if request.cleanup else person for person in raw]
        yield reacted(request, raw, shown, (_NO_WORDS,) if request.prompt.strip() else ())

    def _reaction(
        self, request: ReactRequest, sample: int, cancel: CancelToken, timer: StageTimer
    ) -> Generator[Progress, None, Array]:
        """The reactor (T, 22, 3) in the actor's world, part after part; only the first one depends on the sample."""
        actor, first_pose = request.actor, request.first_pose
        made = np.empty((0, 22, 3)) if first_pose is None else first_pose[None]
        for last in np.linspace(0, actor.num_frames, -(-actor.num_frames // PART) + 1).round().astype(int)[1:]:
            first = max(len(made) - 1, 0)
            here = Placement.of(actor.cut(first, int(last)), "a")
            seen = here.to_network(actor.positions[first:last])
            begins = here.to_network(made[-1]) if len(made) else None
            number, moments = self.bank.answers(seen, begins)[0 if first else sample % len(self.bank.pairs)]
            draft = here.to_world(self.bank.reactor(number, moments, seen, begins))[len(made) - first :]
            made = yield from self._finished(request, made, draft, sample, cancel, timer)
        return made

    def _finished(
        self, request: ReactRequest, made: Array, draft: Array, sample: int, cancel: CancelToken, timer: StageTimer
    ) -> Generator[Progress, None, Array]:
        """What is made so far (N, 22, 3), and what follows as InterGen finishes the draft of it (M, 22, 3)."""
        first, last = max(len(made) - PAST, 0), len(made) + len(draft)
        here = Placement.of(request.actor.cut(first, last), "a")
        actor, past = here.to_network(request.actor.positions[first:last]), here.to_network(made[first:])
        ahead = KnownFrames(1, range(len(past), len(actor)), here.to_network(draft), soft=True)
        behind = [KnownFrames(1, range(len(past)), past)] if len(past) else []
        parts = [KnownFrames(0, range(len(actor)), actor), ahead, *behind]
        model, noise = self.intergen.model, (request.seed + sample, 1)
        scene = directed(model, len(actor), parts, GenerateRequest.strictness)
        settings, nothing = replace(request, cleanup=False), Conditioning(model.no_condition(), 1.0)
        events = self.intergen.sample(settings, nothing, scene, noise, cancel, timer, measured=False)
        result = yield from until_result(events)
        return np.concatenate([made, here.to_world(result.duets[0].people[1].positions[len(past) :])])
