"""The scene of a request: its length, its given part, and the conversion of samples to duets."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from models.intergen.compact import DuetSpace
from models.known import Hold, Known
from motion import FPS, Clip, Duet
from motion.placement import Placement
from webdemo.inference.requests import GenerateRequest, ReactRequest
from webdemo.inference.requests.actor import ROLES

Array = NDArray[np.floating]
Finish = Callable[[Array], Array]
NAMES = ("actor", "reactor")


@dataclass(frozen=True)
class Scene:
    """A scene in which both people are generated.

    Attributes:
        frames: length at 30 fps.
        given: what is known of the motion, if anything.
    """

    frames: int
    given: Hold | None = None

    def duet(self, pair: Array, finish: Finish) -> Duet:
        """The duet of one sample (2, T, 22, 3) in metres; ``finish`` cleans up a generated person."""
        return Duet.from_positions(np.stack([finish(person) for person in pair]), fps=FPS, roles=NAMES)


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
        made = self.placement.to_world(finish(pair[1 - self.place]))
        people = [Clip(made, FPS, self.clip.skeleton, name=NAMES[1 - self.place])]
        people.insert(self.place, self.clip)
        return Duet(people[0], people[1], NAMES)


def scene_of(request: GenerateRequest | ReactRequest, model: DuetSpace) -> Scene:
    """The scene that a request asks a model for."""
    if isinstance(request, GenerateRequest):
        return Scene(round(request.seconds * FPS))
    placement = Placement.of(request.actor, request.role, request.prompt)
    place = ROLES.index(request.role)
    given = _given_person(model, placement.to_network(request.actor.positions), place)
    return Reaction(request.actor.num_frames, given, clip=request.actor, place=place, placement=placement)


def _given_person(model: DuetSpace, positions: Array, place: int) -> Hold:
    """The known part for a person (T, 22, 3) in the network's frame, given at every frame."""
    layout = model.layout
    frames = layout.num_frames(layout.num_tokens(len(positions)))
    # The last token extends up to seven frames beyond the motion; there the last pose is held.
    whole = np.pad(positions, ((0, frames - len(positions)), (0, 0), (0, 0)), mode="edge")
    known = Known.nothing(frames)
    known.add_person(place, torch.from_numpy(whole).float())
    return Hold(known, layout, model.mean, model.std)
