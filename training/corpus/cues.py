"""Cues of a scene's beats, as entries of the lexicon, and the plan that is its label.

A cue says what one person does in a beat: the name of an entry (``wave``), with a part of the body behind a colon
(``pat:shoulder``), a side of its own (``raise-arm@both``), a question mark for what is only offered
(``shake-hands?``), ``+`` between what is done at the same time (``walk-up+wave``) and ``>`` between what follows
(``fall-down>stand-up``). The corpus is made of source clips of one person, and of scenes of two.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from acts import Act, Plan, Relation
from acts.lexicon import Entry, lexicon
from motion import InputError
from motion.vectors import Array

STILL = "stand-still"
"""The entry of a person who does nothing."""
WORDS: dict[str, Any] = tomllib.loads(Path(__file__).with_name("words.toml").read_text(encoding="utf-8"))
"""Words of captions beside those of the lexicon's entries."""
STYLES: dict[str, str] = WORDS["styles"]
"""The manner of a recording's style; other styles are told without one."""
SPEEDS = {"slow": 0.7, "brisk": 1.2}
"""Speed of a style against the usual one."""
Step = tuple[str, str | None, str | None, bool]
"""An act of a cue: entry, part of the body, side, whether it is only offered."""
Groups = tuple[tuple[Step, ...], ...]
_STEP = re.compile(r"([a-z-]+)(?::([a-z]+))?(?:@(left|right|both))?(\?)?")


@dataclass
class Beat:
    """One stretch of a scene, in which each of the two does one thing.

    Attributes:
        acts: the cues of a and b.
        start, end: frames, ``end`` exclusive.
        first: 0 where a acts first or both at once, 1 where b does.
        relation: "reply" (the second answers the first), "while" (at the same time) or "order".
        sides, styles: of a and b, "left", "right", "both" or None; a style's name.
        minor: a transition that a caption may leave out.
        direction: "clockwise" or "counterclockwise", where one walks round the other.
    """

    acts: tuple[str, str]
    start: int
    end: int
    first: int = 0
    relation: str = "reply"
    sides: tuple[str | None, str | None] = (None, None)
    styles: tuple[str | None, str | None] = ("normal", "normal")
    minor: bool = False
    direction: str | None = None

    def swapped(self) -> Beat:
        """The same with the two people exchanged."""
        return replace(
            self, acts=self.acts[::-1], first=1 - self.first, sides=self.sides[::-1], styles=self.styles[::-1]
        )


class Label(BaseModel, frozen=True):
    """The label of a scene.

    Attributes:
        plan: its acts, in the order in which they begin.
        spans: first and last frame (exclusive) of each act, by its id.
        minor: ids of transitions that a caption may leave out.
        beats: ids of the acts of each beat.
    """

    plan: Plan
    spans: dict[str, tuple[int, int]]
    minor: tuple[str, ...] = ()
    beats: tuple[tuple[str, ...], ...] = ()

    def row(self) -> dict[str, Any]:
        """The label as the index has it."""
        return self.model_dump(mode="json", exclude_defaults=True)

    def cut(self, frames: int) -> Label:
        """The label of the scene's first ``frames`` frames: acts that begin later are left out."""
        spans = {act: (start, min(stop, frames)) for act, (start, stop) in self.spans.items() if start < frames}
        acts = [
            act.model_copy(update={"order": tuple(one for one in act.order if one.act in spans)})
            for act in self.plan.acts
            if act.id in spans
        ]
        beats = tuple(tuple(act for act in ids if act in spans) for ids in self.beats)
        plan, minor = (
            self.plan.model_copy(update={"acts": tuple(acts)}),
            tuple(act for act in self.minor if act in spans),
        )
        return Label(plan=plan, spans=spans, minor=minor, beats=beats)


@cache
def steps(cue: str) -> Groups:
    """The acts of a cue, in groups that follow each other; none of an empty cue, of which nothing is known.

    Raises:
        KeyError: if an entry is not in the lexicon.
    """
    groups = []
    for step in cue.split(">") if cue else ():
        phases = []
        for text in step.split("+"):
            match = _STEP.fullmatch(text)
            if match is None:
                raise KeyError(f"{text!r} in the cue {cue!r} is not an act: write an entry's name, as in pat:shoulder.")
            entry(match[1])
            phases.append((match[1], match[2], match[3], bool(match[4])))
        groups.append(tuple(phases))
    return tuple(groups)


def entry(name: str) -> Entry:
    """An entry of the lexicon; raises KeyError with its name."""
    known = lexicon().entries.get(name)
    if known is None:
        raise KeyError(f"No entry {name!r} in the lexicon of acts.")
    return known


def label(beats: Sequence[Beat], frames: int) -> Label:
    """The label of a scene of ``frames`` frames from its beats."""
    writer = _Writer(frames)
    ids = tuple(writer.add(beat) for beat in beats)
    minor = tuple(act for beat, own in zip(beats, ids, strict=True) if beat.minor for act in own)
    return Label(plan=Plan(acts=tuple(writer.acts), reader="corpus"), spans=writer.spans, minor=minor, beats=ids)


class _Writer:
    """Collects the acts of one beat after the other."""

    def __init__(self, frames: int) -> None:
        self.frames = frames
        self.acts: list[Act] = []
        self.spans: dict[str, tuple[int, int]] = {}
        self.before: list[str] = []

    def add(self, beat: Beat) -> tuple[str, ...]:
        """Adds the acts of a beat behind those of the beats before; their ids."""
        together = beat.relation == "while" or STILL in beat.acts  # nobody waits to stand still
        one, other = (steps(beat.acts[person]) for person in (beat.first, 1 - beat.first))
        shared: set[Step] = set()
        if together and len(one) == len(other) == 1:
            alike = beat.sides[0] == beat.sides[1]
            shared = {step for step in set(one[0]) & set(other[0]) if alike or entry(step[0]).mutual}
        begun = len(self.acts)
        ends = self._chain(beat, beat.first, one, shared, _after(self.before))
        beside = tuple(Relation(kind="while", act=act.id) for act in self.acts[begun : begun + 1])
        rest = tuple(tuple(step for step in group if step not in shared) for group in other)
        self.before = ends + self._chain(beat, 1 - beat.first, rest, set(), beside if together else _after(ends))
        return tuple(act.id for act in self.acts[begun:])

    def _chain(
        self, beat: Beat, person: int, groups: Groups, shared: set[Step], order: tuple[Relation, ...]
    ) -> list[str]:
        """Adds what one person does, group after group; the acts that end it."""
        made: list[str] = []
        length = min(beat.end, self.frames) - beat.start
        for k, group in enumerate(groups):
            order, made = _after(made) if made else order, []
            for step in group:
                people = (person, 1 - person) if step in shared else (person,)
                act = _act(str(len(self.acts) + 1), beat, people, step)
                beside = (Relation(kind="while", act=made[0]),) if made else order
                self.acts.append(act.model_copy(update={"order": beside}))
                part = (beat.start + length * j // len(groups) for j in (k, k + 1))
                self.spans[act.id] = (int(next(part)), int(next(part)))
                made.append(act.id)
        return made


def _act(made: str, beat: Beat, people: tuple[int, ...], step: Step) -> Act:
    """The act of a step of a beat."""
    name, part, side, offered = step
    listed = entry(name)
    at_other = listed.to == "other" or any("{b}" in caption for caption in listed.caption[:1])
    known: dict[str, Any] = {}
    if name != STILL:
        style = beat.styles[people[0]] or "normal"
        manner = (STYLES[style],) if style in STYLES else ()
        known = {"side": side or beat.sides[people[0]], "manner": manner, "speed": SPEEDS.get(style, 1.0)}
    return Act(
        id=made,
        act=name,
        agents=tuple("ab"[person] for person in people),
        patient="ab"[1 - people[0]] if len(people) == 1 and at_other else None,
        part=part,
        modality="offered" if offered else "told",
        direction=beat.direction if name != STILL else None,
        **known,
    )


def _after(acts: Sequence[str]) -> tuple[Relation, ...]:
    return tuple(Relation(kind="after", act=act) for act in acts)


def class_of(row: Mapping[str, Any]) -> str:
    """The class of a scene by its row's label: "shake hands", or "punch, dodge" of two entries.

    Transitions and people who stand still do not count.

    Raises:
        InputError: if the row has no label, as those of InterHuman.
    """
    if not row.get("label"):
        raise InputError(
            f"A scene of {row.get('family', 'unknown origin')} has no label and so no class: build the corpus with "
            "`python -m training.corpus`."
        )
    known = Label.model_validate(row["label"])
    names = [act.act for act in known.plan.acts if act.act != STILL and act.id not in known.minor]
    return ", ".join(dict.fromkeys(names or [STILL])).replace("-", " ")


# ---- clips and scenes ----------------------------------------------------------------------------


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


@dataclass(eq=False)
class Scene:
    """Two people in one world, with the sentences that describe them.

    Attributes:
        positions: (2, T, 22, 3) metres, 30 fps, canonical: a's root at XZ = 0 facing +Z at frame 0.
        family: its kind: "beats-2", "salsa", or a recorded interaction such as "handshake".
        sources: the files the motion comes from.
        split: "train" or "test".
        events: "contact": [{"a": joint, "b": joint, "start": frame, "end": frame}, …] joints that touch, if any do.
        played: the beats that were played, from which the label and the captions come.
        label: the plan of the scene, with the frames of its acts.
        captions: different sentences that are all true of the motion.
        alone: sentences on what a does and on what b does, each without the other's part.
        beats: what happens when: {"start", "end" (frames, end exclusive), "acts" of a and b, "minor" (a transition that
            captions may leave out), "captions"}.
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
