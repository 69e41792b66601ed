"""The two things the corpus is made of: source clips of one person, and scenes of two."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .cues import STILL, Beat, Label

Array = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class SourceClip:
    """A real single-person clip on the 22-joint skeleton.

    Attributes:
        positions: (T, 22, 3) metres, 30 fps, floor at 0, root at the origin facing +Z at the first frame.
        action: what the person does, e.g. "bow", "wave", "raise-hand", "walk", "idle".
        style: the actor's manner, e.g. "tired"; "normal" where there is none.
        side: "left", "right", "both" or None: the hand or the turn the action names.
        source: unique stem of the file, for credit and for splits.
        dataset: "bandai-namco-1", "bandai-namco-2", "reactidle", …
        split: "train", "test", or "both" where an action has too few recordings to hold one out.
        place: x and z in metres and heading in radians of the first frame in the file, by which people who
            were recorded together are put together again.
    """

    positions: Array = field(repr=False)
    action: str
    style: str
    side: str | None
    source: str
    dataset: str
    split: str = "train"
    place: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def num_frames(self) -> int:
        """Length in frames."""
        return len(self.positions)


@dataclass(eq=False)
class Scene:
    """Two people in one world, with the sentences that describe them.

    Attributes:
        positions: (2, T, 22, 3) metres, 30 fps, canonical: a's root at XZ = 0 facing +Z at frame 0.
        family: the kind of interaction, e.g. "handshake".
        sources: the files the motion comes from.
        split: "train" or "test".
        events: what a person would check, each key only where it applies:
            "contact": [{"a": joint or None, "b": joint, "start": frame, "end": frame}, …] joints that touch;
            "side": {"a": "left"} the hand that the caption names, by person;
            "distance": "approach" | "part" | "keep";
            "order": ["bow", "wave"] actions in the order in which they happen;
            "facing": True where the two face each other in the middle of the motion.
        said: what the family's builder knows for the captions: "acts" (cues of a and b), "relation", "span" (frames),
            "side_a", "side_b", "manner_a", "manner_b" (styles), "speed" ("slow" or "fast"), "direction", "came" ("a" or
            "ab" walk up before) and "left" (True where a walks away after).
        played: the beats that were played, from which the label and the captions come.
        label: the plan of the scene, with the frames of its acts.
        captions: different sentences that are all true of the motion.
        alone: sentences on what a does and on what b does, each without the other's part.
        beats: what happens when: {"start", "end" (frames, end exclusive), "acts" of a and b, "first" 0 or 1
            (who begins), "minor" (a transition that captions may leave out), "captions"}.
    """

    positions: Array = field(repr=False)
    family: str
    sources: tuple[str, ...]
    split: str
    events: dict[str, Any] = field(default_factory=dict)
    said: dict[str, Any] = field(default_factory=dict)
    played: list[Beat] = field(default_factory=list)
    label: Label | None = None
    captions: list[str] = field(default_factory=list)
    alone: tuple[list[str], list[str]] = field(default_factory=lambda: ([], []))
    beats: list[dict[str, Any]] = field(default_factory=list)


def played(scene: Scene, acts: tuple[str, str], relation: str) -> list[Beat]:
    """The beats of a scene, from its family's cues and what its builder says of it."""
    said, frames = scene.said, scene.positions.shape[1]
    start, stop = said.get("span", (0, frames))
    styles = (said.get("manner_a"), said.get("manner_b"))
    main = Beat(
        said.get("acts", acts),
        start,
        stop,
        relation=said.get("relation", relation),
        sides=(said.get("side_a"), said.get("side_b")),
        styles=styles,
        more={key: said[key] for key in ("direction", "speed") if said.get(key)},
    )
    beats = [main]
    if said.get("came"):
        walk_up = ("walk-up", "walk-up" if said["came"] == "ab" else STILL)
        beats.insert(0, Beat(walk_up, 0, start, relation="while", styles=styles, minor=True))
        main.styles = ("normal", "normal")
    if said.get("left"):
        beats.append(Beat(("walk-away", STILL), stop, frames, relation="while", minor=True))
    return beats
