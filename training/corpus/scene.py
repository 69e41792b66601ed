"""The two things the corpus is made of: source clips of one person, and scenes of two."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .cues import Beat, Label

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
    """

    positions: Array = field(repr=False)
    action: str
    style: str
    side: str | None
    source: str
    dataset: str
    split: str = "train"

    @property
    def num_frames(self) -> int:
        """Length in frames."""
        return len(self.positions)


@dataclass(eq=False)
class Scene:
    """Two people in one world, with the sentences that describe them.

    Attributes:
        positions: (2, T, 22, 3) metres, 30 fps, canonical: a's root at XZ = 0 facing +Z at frame 0.
        family: its kind: "beats-2", "salsa", or a recorded interaction such as "handshake".
        sources: the files the motion comes from.
        split: "train" or "test".
        events: what a person would check, each key only where it applies:
            "contact": [{"a": joint or None, "b": joint, "start": frame, "end": frame}, …] joints that touch;
            "side": {"a": "left"} the hand that the caption names, by person;
            "distance": "approach" | "part";
            "facing": True where the two face each other in the middle of the motion.
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
    played: list[Beat] = field(default_factory=list)
    label: Label | None = None
    captions: list[str] = field(default_factory=list)
    alone: tuple[list[str], list[str]] = field(default_factory=lambda: ([], []))
    beats: list[dict[str, Any]] = field(default_factory=list)
