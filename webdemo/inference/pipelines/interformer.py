"""Reactions by InterFormer, shipped and as released, generated pose by pose from a first pose.

The network works on 15 joints at 15 frames a second. The actor's joints are selected from SMPL22's. The reactor's
are converted to SMPL22 by fitting constant bones to the whole motion (:mod:`motion.ik`), so nothing pops. A long
motion is processed in sub-sequences. Each one starts with the last pose of the previous one (Chopin's thesis,
section 3.5), in the frame of the actor's place at that moment, as in training.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from models.diffusion import sample_noise
from models.interformer.compact import FPS as NETWORK_FPS
from models.interformer.compact import JOINTS_15, CompactInterFormer
from models.interformer.network import NETWORK, WIDTH, InterFormer, from_released
from models.released import read_tensors
from models.weights_io import load_network
from motion import FPS, SMPL22, Clip
from motion.ik import fit_skeleton
from motion.transforms import Placement, heading_matrix, resample
from motion.vectors import Array
from webdemo.inference.finish.cleanup import clean_person
from webdemo.inference.own.entries import Entry
from webdemo.inference.requests import ReactRequest
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer

from .given import reacted, settle

RECORDED_START_DISTANCE = 1.05
"""Metres between the two people of the median recorded pair at its first frame."""
_ROOM = 0.7
"""Metres between the actor's path and a reactor who stands in front of it."""
_NAMES_15 = tuple(SMPL22.joint_names[joint] for joint in JOINTS_15)
_NOISE = 0.01
"""Metres: uncertainty of the network's joints in the fit."""
_NO_WORDS = "InterFormer takes no words: it reacts to what the given person does."
CONVERTED = (
    "Of 22 joints the network saw 15, at 15 frames a second; its answer was fitted onto 22 joints with constant bones "
    "at 30. Toes, collars and the upper spine are the fit's."
)
STARTED = "No first pose was given: the reactor begins in the actor's own, face to face."
ALIKE = "The network draws nothing: all samples are the same."


class InterFormerPipeline:
    """The compact InterFormer, loaded from a weights folder.

    Raises WeightsError (an InputError) if files are missing or altered.
    """

    def __init__(self, folder: Path) -> None:
        self.model, source = load_network(folder, CompactInterFormer)
        self.name, self.digest = folder.name, source.digest

    def run(self, request: ReactRequest, cancel: CancelToken, timer: StageTimer) -> Iterator[Progress | Result]:
        """Progress events, then one :class:`Result` without a manifest.

        Raises:
            Cancelled: within one frame.
        """
        placement = Placement.of(request.actor, "a")
        actor = placement.to_network(request.actor.positions)
        first_pose = self._first_pose(actor) if request.first_pose is None else placement.to_network(request.first_pose)
        made = yield from self._sample(request, actor, first_pose, cancel, timer)
        timer.lap("sample")
        yield timer.progress("finish")
        frames = request.actor.num_frames
        raw = np.stack([on_smpl22(person, frames) for person in made])
        # Joints that the network lacks, such as the toes, also start at the first pose.
        raw = raw + settle(first_pose - raw[:, :1], np.arange(frames))
        shown = np.stack([clean_person(person) for person in raw]) if request.cleanup else raw
        raw, shown = placement.to_world(raw), placement.to_world(shown)
        yield reacted(request, raw, shown, self.notes(request))

    def notes(self, request: ReactRequest) -> tuple[str, ...]:
        """Sentences on what the network made of the request."""
        return (_NO_WORDS,) if request.prompt.strip() else ()

    def _first_pose(self, actor: Array) -> Array:
        """(22, 3) a person who stands in front of the actor, clear of their path, and faces their first place."""
        ahead = actor[:, 0, 2].max() + _ROOM
        stance = self.model.stance.double().numpy()
        return stance @ heading_matrix(np.pi).T + np.array([0.0, 0.0, max(RECORDED_START_DISTANCE, ahead)])

    def _sample(
        self, request: ReactRequest, actor: Array, first_pose: Array, cancel: CancelToken, timer: StageTimer
    ) -> Generator[Progress, None, Array]:
        """Returns the network's frames (samples, T', 15, 3), which cover the actor's motion."""
        slow = resample(actor, FPS, NETWORK_FPS)
        reaction = [np.repeat(first_pose[None, list(JOINTS_15)], request.samples, axis=0)]
        total = len(slow) - 1
        while (begun := len(reaction) - 1) < total:
            window = slow[begun : begun + self._longest]
            here = Placement.of(Clip(window, NETWORK_FPS, SMPL22), "a")
            seen = here.to_network(window)[:, list(JOINTS_15)]
            for poses in self._poses(seen, here.to_network(reaction[-1]), request.seed):
                reaction.append(here.to_world(poses))
                yield timer.progress("sample", len(reaction) - 1, total, "frame")
                cancel.raise_if_cancelled()
        return np.stack(reaction, axis=1)

    @property
    def _longest(self) -> int:
        """Frames of a sub-sequence."""
        return self.model.config.window

    def _poses(self, seen: Array, first: Array, seed: int) -> Iterator[Array]:
        """The poses (samples, 15, 3) that follow the first ones, from the actor's (T, 15, 3) of a sub-sequence."""
        noise = sample_noise(seed, len(first), (self.model.config.noise,))
        actors = torch.tensor(seen, dtype=torch.float32).expand(len(first), -1, -1, -1)
        for pose in self.model.poses_after(actors, torch.tensor(first, dtype=torch.float32), noise):
            yield pose.double().numpy()


def on_smpl22(joints: Array, frames: int) -> Array:
    """The network's joints (T', 15, 3) as SMPL22's, on constant bones at 30 fps: (frames, 22, 3)."""
    fast = resample(joints, NETWORK_FPS, FPS)[:frames]
    fast = np.concatenate([fast, np.repeat(fast[-1:], frames - len(fast), axis=0)])
    return fit_skeleton(fast, _NAMES_15, fps=FPS, noise=_NOISE, scale=1.0, iterations=4).positions


class ReleasedInterFormerPipeline(InterFormerPipeline):
    """The released InterFormer of an entry of the settings.

    Raises WeightsError (an InputError) where the file is missing, damaged or another network's.
    """

    def __init__(self, entry: Entry) -> None:
        checkpoint = entry.file("checkpoint")
        self.network = load_released(checkpoint)
        self.name, self.digest = entry.name, entry.digest("checkpoint")

    def notes(self, request: ReactRequest) -> tuple[str, ...]:
        """What the conversion lost, too, and what was not asked for or not done."""
        started = [STARTED] if request.first_pose is None else []
        return (*super().notes(request), CONVERTED, *started, *([ALIKE] if request.samples > 1 else []))

    def _first_pose(self, actor: Array) -> Array:
        """(22, 3) the actor's first pose, turned round, in front of them."""
        facing = actor[0] @ heading_matrix(np.pi).T
        return facing + np.array([0.0, 0.0, RECORDED_START_DISTANCE])

    @property
    def _longest(self) -> int:
        return self.network.config.max_length - 2

    def _poses(self, seen: Array, first: Array, seed: int) -> Iterator[Array]:
        made = self._answer(_numbers(seen), _numbers(first[:1])[0])
        for pose in made.double().numpy().reshape(-1, 3, len(JOINTS_15)).swapaxes(1, 2)[1:]:
            yield np.repeat(pose[None], len(first), axis=0)

    def _answer(self, source: Tensor, first: Tensor) -> Tensor:
        """The actor (T, 45) and a first pose (45,) → the reaction (T, 45), which begins with that pose."""
        whole = torch.cat([torch.zeros(1, WIDTH), source, torch.ones(1, WIDTH)])[None]
        mask = torch.ones(1, 1, len(source) + 2, dtype=torch.bool)
        mask[..., -1] = False  # the frame of ones at the end is padding to the network
        return self.network.generate(whole, mask, first[None], len(source) + 1)[0, 1:]


def load_released(checkpoint: Path) -> InterFormer:
    """The network of the authors' file; raises WeightsError for any other one."""
    tensors = read_tensors(checkpoint, network=NETWORK, mark="encoder.layers.")
    return from_released(tensors).requires_grad_(False)


def _numbers(poses: Array) -> Tensor:
    """(T, 15, 3) → (T, 45), coordinate-major."""
    return torch.from_numpy(np.ascontiguousarray(poses.swapaxes(-1, -2).reshape(len(poses), WIDTH))).float()
