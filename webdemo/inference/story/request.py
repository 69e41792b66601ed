"""The request for a scene: beats one after another, alone or as a part of a given motion, and its windows."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from acts import Plan
from acts.lexicon import lexicon
from acts.plan import PlanFrames
from acts.staging.beginnings import Take
from acts.staging.score import Score
from acts.staging.stage import scores_of
from acts.staging.window import AFTER, MOST_FRAMES, PAST, Window
from motion import FPS, Duet, InputError
from motion.formats import ImportChoices, read
from webdemo.inference import methods
from webdemo.inference.requests.paths import FloorPath, path_of, timed_paths
from webdemo.inference.requests.plans import KeptPlan
from webdemo.inference.requests.predict import check_motion
from webdemo.inference.requests.sampling import SETTINGS, GenerateRequest, SamplingRequest, number
from webdemo.inference.run import Progress

from .beats import MOST_BEATS, SHORTEST, Beat, beat_of, filling, plan_of_beat, seconds_of_acts
from .poses import MOST_POSES, Pose, check_together, pose_of

MOST_SECONDS = 180.0
"""Of a scene."""
MOST_MADE = 360.0
"""Seconds of motion that one request makes, over all samples and tries."""
_HELD_EVERY = 0.5
"""Seconds between two moments at which a person who has walked a path is held to its end."""


def read_motion(path: Path, choices: ImportChoices) -> Duet:
    """The motion in a file that a scene goes on from; raises InputError for one that is not of two people."""
    given = read(path, longest=MOST_SECONDS, choices=choices)
    if not isinstance(given, Duet):
        raise InputError(f"{path.name} holds one person: a scene goes on from a motion of two.")
    return given


@dataclass(frozen=True, kw_only=True)
class SceneRequest(SamplingRequest):
    """Two people through the beats of a story.

    Without ``motion`` the scene is made from nothing. With it, the beats are made from ``start`` on: up to ``end``,
    where the given motion goes on (a span that is made again), or as a continuation that replaces what followed.
    The given motion is kept bit for bit, at 30 frames a second.

    Attributes:
        beats: one or more; without ``motion`` each needs words. Their lengths are set when the request is made.
            In a span they are stretched to fill it.
        paths: on the floor, one for a person at most; seconds count from the scene's beginning.
        poses: likewise.
        strictness: as of :class:`GenerateRequest`.
        loop: the end meets the beginning; not with ``motion``.
        planned: where the words of a beat send people becomes a path, bystanders are held in place, and postures,
            jumps and hands become poses (:mod:`acts.staging`), unless a path or pose says it.
        motion: a given motion of two people on SMPL22's joints, of up to three minutes.
        start: second of the given motion at which the beats begin; its end by default.
        end: second at which the given motion goes on.
    """

    beats: tuple[Beat, ...] = ()
    paths: tuple[FloorPath, ...] = ()
    poses: tuple[Pose, ...] = field(default=(), compare=False)
    loop: bool = False
    planned: bool = True
    strictness: float = GenerateRequest.strictness
    motion: Duet | None = None
    start: float | None = None
    end: float | None = None

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        self._check(methods.method(self.model, "scene"))
        set_(self, "beats", tuple(self.beats))
        self._check_beats()
        if self.motion is not None:
            self._check_motion(self.motion)
        elif self.start is not None or self.end is not None:
            raise InputError("A start or an end belongs to a given motion: give the motion too, or leave them out.")
        self._time_beats()
        if self.total_seconds > MOST_SECONDS + 1e-6:
            raise InputError(
                f"The scene would last {self.total_seconds:.0f} s: shorten it to {MOST_SECONDS:g} s or less."
            )
        if (made := self.seconds * self.samples * self.tries) > MOST_MADE:
            tries = f"{self.tries} tries of " if self.tries > 1 else ""
            raise InputError(
                f"{tries}{self.samples} samples of {self.seconds:.0f} s are {made:.0f} s of motion: "
                f"ask for {MOST_MADE:g} s or less in all."
            )
        self._check_wishes()

    # ---- checks ----------------------------------------------------------------------------------

    def _check_beats(self) -> None:
        if not self.beats:
            raise InputError("The story is empty: say in a sentence or more what the two people do.")
        if len(self.beats) > MOST_BEATS:
            raise InputError(f"The story has {len(self.beats)} beats: keep to {MOST_BEATS} or fewer.")
        for place, beat in enumerate(self.beats, 1):
            beat.check(place)
            if self.motion is None and not beat.sentence:
                raise InputError(f"Beat {place} has no words: say what happens in it, or delete it.")

    def _check_motion(self, motion: Duet) -> None:
        set_ = object.__setattr__
        if not isinstance(motion, Duet):
            raise InputError("A scene goes on from a motion of two people: give both.")
        if self.loop:
            raise InputError("Only a scene that is made from nothing can be a loop: leave the motion or the loop out.")
        checked = check_motion(motion, longest=MOST_SECONDS)
        assert isinstance(checked, Duet)
        motion = checked
        set_(self, "motion", motion)
        length = motion.seconds
        start = length if self.start is None else number("Start", self.start, 0.0, length, " seconds")
        start = round(start * FPS) / FPS
        set_(self, "start", start)
        if self.end is None:
            if start < SHORTEST:
                raise InputError(f"A continuation needs {SHORTEST:g} s of motion before it: start it later.")
            return
        end = round(number("End", self.end, 0.0, length, " seconds") * FPS) / FPS
        if end - start < SHORTEST - 1e-6:
            raise InputError(f"The span from {start:g} to {end:g} s is too short: select {SHORTEST:g} s or more.")
        if start == 0 and end >= length - 1e-6:
            raise InputError("The span is the whole motion, so nothing of it is kept: generate a new one instead.")
        set_(self, "end", end)

    def _time_beats(self) -> None:
        """Sets the beats' lengths, in whole frames; in a span they fill it."""
        beats = [
            beat
            if beat.seconds is not None
            else replace(beat, seconds=seconds_of_acts(beat.acts or self.plans[i].acts))
            for i, beat in enumerate(self.beats)
        ]
        if self.end is not None:
            span = self.end - (self.start or 0.0)
            lengths = filling(span, [beat.length for beat in beats])
            if min(lengths) < SHORTEST - 1e-6:
                raise InputError(
                    f"{len(beats)} beats do not fit into a span of {span:.1f} s: use fewer, or a longer span."
                )
            beats = [replace(beat, seconds=length) for beat, length in zip(beats, lengths, strict=True)]
        object.__setattr__(self, "beats", tuple(beats))

    def _check_wishes(self) -> None:
        if not (self.paths or self.poses):
            return
        set_, total = object.__setattr__, self.total_seconds
        if len(self.poses) > MOST_POSES:
            raise InputError(f"There are {len(self.poses)} poses: keep to {MOST_POSES} or fewer.")
        set_(self, "paths", timed_paths(self.paths, total))
        set_(self, "poses", tuple(pose.check(total) for pose in self.poses))
        check_together(self.paths, self.poses)
        if self.motion is None:
            return
        first, last = self.made
        for moment in [p.seconds or 0.0 for path in self.paths for p in path.points] + [p.seconds for p in self.poses]:
            if not first <= round(moment * FPS) < last:
                raise InputError(
                    f"A path or pose at {moment:g} s lies in the part that is kept: give times from "
                    f"{first / FPS:g} to {last / FPS:g} s."
                )

    # ---- what it comes to ------------------------------------------------------------------------

    @property
    def seconds(self) -> float:
        """Length of what is made."""
        return sum(beat.length for beat in self.beats)

    @property
    def total_seconds(self) -> float:
        """Length of the whole motion that results."""
        if self.motion is not None and self.end is not None:
            return self.motion.seconds
        return (self.start or 0.0) + self.seconds

    @property
    def plans_words(self) -> bool:
        """True where words become ways and poses; spans and loops are left to the network."""
        return self.planned and self.end is None and not self.loop

    @cached_property
    def edges(self) -> tuple[int, ...]:
        """Frames at which the beats begin, and at which the last ends."""
        first = round((self.start or 0.0) * FPS)
        times = np.cumsum([0.0, *(beat.length for beat in self.beats)])
        return tuple(first + round(t * FPS) for t in times)

    @property
    def made(self) -> tuple[int, int]:
        """The first frame that is made, and the one after the last."""
        return self.edges[0], self.edges[-1]

    @property
    def plan_of_result(self) -> KeptPlan | None:
        """The plan of an earlier result, whose windows are taken as they are; None where the words are planned now."""
        return self.plan if self.plan is not None and self.plan.of_result else None

    @cached_property
    def plans(self) -> tuple[Plan, ...]:
        """The plan of acts of each beat: as it is kept, or as its words are read now."""
        kept = self.plan.acts if self.plan is not None else ()
        return kept if len(kept) == len(self.beats) else tuple(map(plan_of_beat, self.beats))

    def spans(self) -> Iterator[PlanFrames]:
        """The plan of each beat that says something."""
        several, edges = len(self.beats) > 1, self.edges
        for i, plan in enumerate(self.plans):
            if plan.sentence or plan.acts:
                yield plan, edges[i], edges[i + 1], i + 1 if several else None

    def _read(self) -> tuple[Plan, ...]:
        return self.plans

    @cached_property
    def scores(self) -> tuple[Score, ...]:
        """The score of each beat, in the take of its seed."""
        scores, known = [], lexicon()
        for beat, plan in zip(self.beats, self.plans, strict=True):
            take = Take.of(self.seed if beat.seed is None else beat.seed)
            scores.append(take.of_acts(beat.acts or plan.acts, known))
        return scores_of(scores)

    @cached_property
    def walks(self) -> tuple[FloorPath, ...]:
        """The paths as they are walked: people stay where theirs ends until the words lead them on from there.

        A way that the words name while a path is walked is that path.
        """
        if self.poses or self.loop or self.end is not None:
            return self.paths
        return tuple(self._stayed(path) for path in self.paths)

    def _stayed(self, path: FloorPath) -> FloorPath:
        last, edges = path.points[-1], [edge / FPS for edge in self.edges]
        ended, rest = last.seconds or 0.0, edges[-1]
        for score, (start, end) in reversed(list(zip(self.scores, pairwise(edges), strict=True))):
            walked = {move.person for move in score.moves} if start < ended else set()
            bound = score.joined or score.touch or score.strike or score.reaching
            if end > ended and (bound or path.person in score.going - walked):
                rest = start
        held = np.arange(ended + _HELD_EVERY, rest - 1 / FPS, _HELD_EVERY)
        return replace(path, points=(*path.points, *(replace(last, seconds=float(t)) for t in held)))

    @property
    def num_frames(self) -> int:
        """Frames of the whole motion that results."""
        if self.motion is not None and self.end is not None:
            return self.motion.num_frames
        return self.edges[-1]

    def to_dict(self) -> dict[str, Any]:
        """All fields; of a given motion the part that is kept, by its SHA-256."""
        written = {
            "kind": "scene",
            "beats": [beat.to_dict() for beat in self.beats],
            "paths": [asdict(path) for path in self.paths],
            "poses": [pose.to_dict() for pose in self.poses],
            "loop": self.loop,
            "planned": self.planned,
            "strictness": self.strictness,
        }
        if self.motion is not None:
            kept = self.kept(self.motion)
            written["motion"] = {
                "name": self.motion.a.name[:100],
                "frames": self.motion.num_frames,
                "sha256": hashlib.sha256(b"".join(np.ascontiguousarray(part).tobytes() for part in kept)).hexdigest(),
            }
            written |= {"start": self.start, "end": self.end}
        return written | self.sampling

    def kept(self, motion: Duet) -> tuple[np.ndarray, np.ndarray]:
        """The parts of a motion (2, T, 22, 3) before and after what is made."""
        first, last = self.made
        positions = motion.positions
        return positions[:, :first], positions[:, last:] if self.end is not None else positions[:, :0]

    @classmethod
    def from_dict(
        cls, values: Mapping[str, Any], motion: Duet | None = None, plan: KeptPlan | None = None
    ) -> SceneRequest:
        """The request that :meth:`to_dict` gave, with the motion that it was given, and the plan of its result.

        Raises:
            InputError: for values that are no longer taken.
        """
        plain = {name: values[name] for name in SETTINGS if name in values}
        return cls(
            **plain,
            beats=tuple(beat_of(beat) for beat in values.get("beats", ())),
            paths=tuple(path_of(path) for path in values.get("paths", ())),
            poses=tuple(pose_of(pose) for pose in values.get("poses", ())),
            loop=bool(values.get("loop", False)),
            planned=bool(values.get("planned", False)),  # scenes of before did without
            strictness=values.get("strictness", cls.strictness),
            motion=motion,
            start=values.get("start"),
            end=values.get("end"),
            plan=plan,
        )


def windows(request: SceneRequest) -> list[Window]:
    """The windows of a scene in the order in which they are made."""
    edges = request.edges
    listed: list[Window] = []
    behind = min(AFTER, request.num_frames - edges[-1]) if request.end is not None else 0
    if request.loop:  # the scene's own beginning lies behind its end
        behind = min(AFTER, edges[-1] // 2)
    for beat, (start, stop) in enumerate(pairwise(edges)):
        after = behind if beat == len(edges) - 2 else 0
        most = MOST_FRAMES - PAST - after
        parts = -(-(stop - start) // most)
        if request.loop and len(request.beats) == 1:
            parts = max(parts, 2)  # the last window needs a beginning to return to
        cuts = np.linspace(start, stop, parts + 1).round().astype(int).tolist()
        for part, (first, last) in enumerate(pairwise(cuts)):
            known = min(after, first) if request.loop else after
            listed.append(Window(beat, part, first, last, known if part == parts - 1 else 0))
    return listed


def window_seed(request: SceneRequest, sample: int, window: Window) -> int:
    """The seed of a window's noise; the first window of a story has the story's own, as plain generation would."""
    seed = request.beats[window.beat].seed
    if seed is None and sample == window.beat == window.part == 0 and request.motion is None:
        return request.seed
    first = request.seed if seed is None else seed
    return int(np.random.SeedSequence([first, sample, window.beat, window.part]).generate_state(1)[0])


@dataclass(frozen=True, kw_only=True)
class SceneProgress(Progress):
    """A window is finished; what is there so far can be shown, and stays if the run is cancelled.

    Attributes:
        sample: its number from 0.
        beat: index of the beat that the window belongs to.
        motion: the scene from its beginning to the window's end.
    """

    sample: int
    beat: int
    motion: Duet
