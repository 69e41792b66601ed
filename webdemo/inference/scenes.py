"""What a request leaves open: how long the motion is, what of it is given, and how samples become duets."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from models.compact import DuetSpace
from models.motion_tokens import encode, foot_contacts, pack
from webdemo.motion import Clip, Duet

from .actor import FPS, ROLES, Placement
from .requests import GenerateRequest, ReactRequest

Array = NDArray[np.floating]
Finish = Callable[[Array], Array]
NAMES = ("actor", "reactor")


@dataclass(frozen=True)
class Given:
    """The part of a motion that is known and not denoised.

    Attributes:
        x0: (tokens, 2·token_features) clean motion in network space; anything where it is not known.
        mask: the same shape, true where it is known.
    """

    x0: Tensor
    mask: Tensor

    def hold(self, x: Tensor) -> Tensor:
        """``x`` (B, tokens, 2·token_features) with the known part in its place."""
        return torch.where(self.mask, self.x0, x)


@dataclass(frozen=True)
class Scene:
    """Both people are made.

    Attributes:
        frames: length at 30 fps.
        given: what is known of the motion, if anything.
    """

    frames: int
    given: Given | None = None

    def duet(self, pair: Array, finish: Finish) -> Duet:
        """The duet of one sample (2, T, 22, 3) in metres; ``finish`` cleans a person who was made."""
        return Duet.from_positions(np.stack([finish(person) for person in pair]), fps=FPS, roles=NAMES)


@dataclass(frozen=True, kw_only=True)
class Reaction(Scene):
    """One person is given and stays bit for bit as they are; the other is made in their world.

    Attributes:
        clip: the given person.
        place: 0 where they are person a, 1 where they are b.
        placement: from their world to the network's frame.
    """

    clip: Clip
    place: int
    placement: Placement

    def duet(self, pair: Array, finish: Finish) -> Duet:
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


def _given_person(model: DuetSpace, positions: Array, place: int) -> Given:
    """A person (T, 22, 3) in the network's frame who is given at every frame."""
    layout = model.layout
    tokens = layout.num_tokens(len(positions))
    # The last token reaches up to seven frames beyond the motion: there the person keeps still.
    missing = layout.num_frames(tokens) - len(positions)
    whole = np.pad(positions, ((0, missing), (0, 0), (0, 0)), mode="edge")
    motion = torch.from_numpy(whole).float()
    control = encode(motion, foot_contacts(motion, FPS), layout)
    normalised = ((control - model.mean) / model.std).expand(1, 2, -1, -1)
    mask = torch.zeros(tokens, 2, layout.token_features, dtype=torch.bool)
    mask[:, place] = True
    return Given(pack(normalised, layout)[0], mask.flatten(1))
