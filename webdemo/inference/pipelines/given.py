"""The scene of a request: its length, its given part, and the conversion of samples to duets."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # its parts are loaded with their first use
import torch
from numpy.typing import NDArray
from torch import Tensor

from acts.staging.given import places_of
from acts.staging.window import KnownFrames, Part
from models.known import Hold, Known
from models.motion_tokens import DuetSpace
from motion import FPS, SMPL22, Clip, Duet, InputError
from motion.kinematics import project_to_skeleton
from motion.metrics import compare
from motion.representation import NUM_FEATURES
from motion.smoothing import minimum_jerk, smoothstep
from motion.transforms import Placement
from motion.vectors import Array
from webdemo.inference.finish.joining import PASSING, joined, passing
from webdemo.inference.requests import ReactRequest
from webdemo.inference.run import Result

Finish = Callable[[Array], Array]
NAMES = ("actor", "reactor")
SETTLE = 0.5
"""Seconds over which the difference between a given first pose and the network's fades out."""
FADE = 12
"""Frames over which what clean-up changed at a given frame is taken back beside it."""
_APART = 30
"""Frames between two poses of a draft beyond which it says nothing of what is between them."""


class GivenPerson:
    """Writes a given person's numbers into samples, in place of :class:`models.known.Hold`.

    Args:
        numbers: (T − 1, 262) normalised.
        place: 0 if they are person a, 1 if b.
    """

    features: Tensor | None = None

    def __init__(self, numbers: Tensor, place: int) -> None:
        self.numbers = numbers
        self.part = slice(place * NUM_FEATURES, (place + 1) * NUM_FEATURES)

    @property
    def frozen(self) -> Tensor:
        """(1, T − 1, 524) true where a number is given."""
        fixed = torch.zeros(1, len(self.numbers), 2 * NUM_FEATURES, dtype=torch.bool)
        fixed[..., self.part] = True
        return fixed

    def __call__(self, x: Tensor) -> Tensor:
        """A sample or prediction (B, T − 1, 524) with the given person in their place."""
        held = x.clone()
        held[..., self.part] = self.numbers
        return held

    bend = __call__  # the whole person is given, so there is nothing to lead up to


@dataclass(frozen=True)
class Between:
    """Samples that are held to a plan's poses in part: a share of the way from the hold to places."""

    places: Hold
    poses: Hold
    share: float

    @property
    def features(self) -> Tensor | None:
        """Of the places: the poses are a draft."""
        return self.places.features

    @property
    def frozen(self) -> Tensor:
        """As of both."""
        return self.places.frozen

    def __call__(self, x: Tensor) -> Tensor:
        """See :class:`models.known.Hold`."""
        return torch.lerp(self.places(x), self.poses(x), self.share)

    def bend(self, x: Tensor) -> Tensor:
        """See :class:`models.known.Hold`."""
        return torch.lerp(self.places.bend(x), self.poses.bend(x), self.share)


Given = Hold | GivenPerson | Between
"""Writes the known part of a motion into samples (B, tokens, features), and lets a prediction lead up to it."""


@dataclass(frozen=True)
class Scene:
    """A scene in which both people are made around what is given, if anything.

    Attributes:
        frames: length at 30 fps.
        given: what is known of the motion at every step.
        draft: what a network that reads drafts sees of one, see :meth:`models.known.Known.features`.
        parts: what the finished motion meets.
        poses: holds also the poses of the draft.
        strictness: the share of the steps, from the first one on, in which the sample is held to them.
    """

    frames: int
    given: Given | None = None
    draft: Tensor | None = None
    parts: Sequence[Part] = ()
    poses: Hold | None = None
    strictness: float = 0.0

    def held(self, steps: int) -> list[Given | None]:
        """What is known at each of so many denoising steps: the places and, while the plan is strict, the poses."""
        places, poses = self.given, self.poses
        if poses is None or not isinstance(places, Hold):
            return [places] * steps
        shares = (min(max(self.strictness * steps - step, 0.0), 1.0) for step in range(steps))
        return [poses if s == 1 else Between(places, poses, s) if s else places for s in shares]

    @property
    def shares(self) -> Tensor:
        """See :attr:`models.known.Hold.shares`; over all steps."""
        total = torch.zeros(self.frames)
        for hold, weight in ((self.given, 1 - self.strictness), (self.poses, self.strictness)):
            if isinstance(hold, Hold):
                total = total + weight * hold.shares[: self.frames]
        return total

    def duet(self, pair: Array, finish: Finish) -> Duet:
        """The duet of one sample (2, T, 22, 3) in metres; ``finish`` cleans up a generated person."""
        people = [self.met(i, finish(person)) for i, person in enumerate(pair)]
        return Duet.from_positions(np.stack(people), fps=FPS, roles=NAMES)

    def met(self, person: int, made: Array) -> Array:
        """A made person (T, 22, 3) who meets what is given of them exactly; what was made leads there smoothly."""
        own = [part for part in self.parts if isinstance(part, KnownFrames) and part.person == person]
        if given := [part for part in own if not part.joints]:
            at = np.concatenate([np.asarray(p.frames) for p in given])
            wanted = np.concatenate([p.positions for p in given])
            runs = np.isin(at + 1, at) | np.isin(at - 1, at)  # a single pose says nothing about speed
            if runs.any():
                made = joined(made, at[runs], wanted[runs])
            apart = np.abs(at[:, None] - at[~runs])
            alone = ~runs & (np.sum(apart <= 2 * PASSING, axis=1) == 1)  # a series says how people move
            if alone.any():
                held = np.isin(np.arange(len(made)), at)
                made = passing(made, at[alone], wanted[alone], held)
            made = with_given(made, at, wanted)
        for part in own:
            if part.kept:
                made = with_joints(made, part)
        return made


@dataclass(frozen=True, kw_only=True)
class Reaction(Scene):
    """One person is given and stays unchanged, bit for bit; the other is generated in their world.

    Attributes:
        clip: the given person.
        place: 0 if they are person a, 1 if b.
        placement: maps their world to the network's frame.
    """

    clip: Clip
    place: int
    placement: Placement

    def duet(self, pair: Array, finish: Finish) -> Duet:
        """The given person with the generated one, mapped back to their world."""
        made = self.placement.to_world(self.met(1 - self.place, finish(pair[1 - self.place])))
        people = [Clip(made, FPS, self.clip.skeleton, name=NAMES[1 - self.place])]
        people.insert(self.place, self.clip)
        return Duet(people[0], people[1], NAMES)


def with_given(positions: Array, frames: Array, given: Array) -> Array:
    """Positions (T, 22, 3) that are ``given`` (N, 22, 3) at ``frames`` (N,).

    Beside them the difference in place, and where two frames in a row are given also in speed, dies out over
    :data:`FADE` frames, or half of the way to the next given one, along a polynomial of degree 5 (Bollo 2018,
    "Inertialization").
    """
    order = np.argsort(frames)
    frames, given = frames[order], np.asarray(given)[order]
    apart = given - positions[frames]
    time = np.arange(len(positions))
    after = np.searchsorted(frames, time).clip(max=len(frames) - 1)
    before = (after - 1).clip(min=0)
    nearest = np.where(np.abs(frames[after] - time) < np.abs(time - frames[before]), after, before)
    away = time - frames[nearest]
    inner = (nearest - np.sign(away)).clip(0, len(frames) - 1)
    speed = np.where(
        (frames[inner] == frames[nearest] - np.sign(away))[:, None, None], apart[nearest] - apart[inner], 0.0
    )
    gap = np.where((frames[0] < time) & (time < frames[-1]), frames[after] - frames[before], 2 * (FADE + 1))
    fade = (0.5 * gap).clip(0.5, FADE + 1)
    s = (np.abs(away) / fade).clip(max=1.0)
    place = 1 - minimum_jerk(s)
    lead = fade * s * (1 - s) ** 3 * (1 + 3 * s)
    moved = positions + place[:, None, None] * apart[nearest] + lead[:, None, None] * speed
    moved[frames] = given
    return moved


def with_joints(positions: Array, part: KnownFrames) -> Array:
    """Positions (T, 22, 3) with the joints of a part as they are given, see :func:`with_given`.

    Those that are free, such as an arm, are moved with the given joint that they hang on. Bones keep their lengths.
    """
    whole = with_given(positions, *_every_frame(np.asarray(part.frames), np.asarray(part.positions)))
    moved = positions.copy()
    for joint, parent in enumerate(SMPL22.parents):
        held = joint in part.joints
        moved[:, joint] = whole[:, joint] if held else positions[:, joint] + moved[:, parent] - positions[:, parent]
    return np.asarray(project_to_skeleton(moved)[0])


def _every_frame(frames: Array, poses: Array) -> tuple[Array, Array]:
    """Frames (N,) in order and their poses (N, 22, 3), with those between them along cubic Hermite splines."""
    if len(frames) < 2:
        return frames, poses
    time = np.arange(frames[0], frames[-1] + 1)
    return time, scipy.interpolate.CubicHermiteSpline(frames, poses, np.gradient(poses, frames, axis=0))(time)


def directed(model: DuetSpace, frames: int, parts: Sequence[Part], strictness: float = 0.0) -> Scene:
    """A scene of so many frames with what is given of it, and its draft.

    Soft poses are a draft where the network reads one and the plan is not wholly strict, and are held otherwise; free
    ones are never held.

    Args:
        model, frames, parts: as of :func:`hold_of`.
        strictness: the share of the steps in which drafted poses are held, too.
    """
    held = [part for part in parts if not (isinstance(part, KnownFrames) and part.free)]
    poses = hold_of(model, frames, held) if held and (strictness or not model.reads_known) else None
    if not model.reads_known:
        return Scene(frames, poses, parts=held)
    if strictness == 1:
        return Scene(frames, poses, draft_of(model, frames, [p for p in parts if p not in held]), parts=held)
    places = places_of(parts)
    hold, draft = hold_of(model, frames, places) if places else None, draft_of(model, frames, parts)
    return Scene(frames, hold, draft, parts=places, poses=poses, strictness=strictness)


def draft_of(model: DuetSpace, frames: int, parts: Sequence[Part]) -> Tensor | None:
    """The draft of a scene as a network sees it that reads drafts: of its soft parts all but the place on the floor.

    In training a draft has a pose at every third to eighth frame, so those between two given ones are filled in.
    """
    known = Known.nothing(model.layout.num_frames(model.layout.num_tokens(frames)))
    for part in parts:
        if not isinstance(part, KnownFrames) or not part.soft:
            continue
        given, joints = np.array(_frames(part, frames)), part.joints or range(SMPL22.num_joints)
        for run in np.split(np.arange(len(given)), np.flatnonzero(np.diff(given) > _APART) + 1):
            at, positions = _every_frame(given[run], np.asarray(part.positions)[run])
            poses = torch.from_numpy(positions).float()
            known.add_joints(part.person, poses, at.tolist(), [joint for joint in joints if joint])
            if 0 in joints:
                known.rows[:, part.person, at, 1] = poses[:, 0, 1]
                known.mask[:, part.person, at, 1] = True
    return known.features(model.layout, model.mean, model.std) if known.mask.any() else None


def hold_of(model: DuetSpace, frames: int, parts: Sequence[Part]) -> Hold:
    """The known part of a scene.

    Args:
        model: the network's space.
        frames: length at 30 fps.
        parts: what is given.

    Raises:
        InputError: if a part lies outside the scene or contradicts another, as in a kept plan that is damaged.
    """
    length = model.layout.num_frames(model.layout.num_tokens(frames))
    known = Known.nothing(length)
    for part in parts:
        at = _frames(part, frames)
        beside = isinstance(part, KnownFrames) and part.joints and 0 not in part.joints
        if not beside and known.mask[0, part.person, at][:, 0].any():
            raise InputError(f"Two given parts say where person {'ab'[part.person]} is at the same time: give one.")
        if isinstance(part, KnownFrames):
            poses = torch.from_numpy(np.asarray(part.positions)).float()
            if part.joints:
                known.add_joints(part.person, poses, at, part.joints)
            else:
                known.add_person(part.person, poses, at)
        else:
            headings = None if part.headings is None else torch.from_numpy(np.asarray(part.headings)).float()
            places = torch.from_numpy(np.asarray(part.places)).float()
            known.add_path(part.person, at, places, headings, turned=part.turned)
    return Hold(known, model.layout, model.mean, model.std)


def _frames(part: Part, total: int) -> list[int]:
    at = [int(frame) for frame in part.frames]
    if not at or at != sorted(set(at)) or at[0] < 0 or at[-1] >= total:
        raise InputError(
            f"What is given of person {'ab'[part.person]} does not fit into the scene: give frames in order, each "
            f"once, from 0 to {total - 1}."
        )
    return at


def settle(off: Array, frames: NDArray[np.integer]) -> Array:
    """Fades out the difference between a wanted and a generated first pose.

    Args:
        off: (samples, 1, 22, 3) or (samples, 22, 3) metres.
        frames: (T,) frame indices.

    Returns:
        (samples, T, 22, 3), ``off`` at frame 0 and 0 from :data:`SETTLE` seconds on.
    """
    return off.reshape(-1, 1, *off.shape[-2:]) * smoothstep(1 - frames / (SETTLE * FPS))[:, None, None]


def duet_of(request: ReactRequest, person: Array) -> Duet:
    """The given person, unchanged, and the generated one."""
    return Duet(request.actor, Clip(person, FPS, SMPL22, name=NAMES[1]), NAMES)


def reacted(request: ReactRequest, raw: Iterable[Array], shown: Iterable[Array], notes: Sequence[str] = ()) -> Result:
    """The result of a reaction.

    Args:
        request: what was asked for.
        raw: of each sample (T, 22, 3) metres in the actor's world, before damping and clean-up.
        shown: the same after them.
        notes: sentences the user should read.
    """
    duets = tuple(duet_of(request, person) for person in shown)
    readouts = tuple(compare(duet_of(request, one), duet) for one, duet in zip(raw, duets, strict=True))
    return Result(duets=duets, readouts=readouts, notes=tuple(notes))
