"""Parts of a scene on the page: what the player shows, the beats in a span, the story after a continuation."""

from __future__ import annotations

import secrets
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from motion import FPS, Duet, InputError
from webdemo.inference.requests.sampling import MAX_SEED
from webdemo.inference.run import Result
from webdemo.inference.story import Beat, FloorPath, Pose, SceneRequest, in_time, split_sentence

from .exports import Record
from .film import MOST_FRAMES, number_of, read_player
from .story import span_of, story_fields, story_value

FUTURES = 3
FUTURE_SECONDS = 4.0
"""Length of a future without words."""


def place_of(shown: str) -> dict[str, int]:
    """The frame and the sample that the player shows, as the browser reports them."""
    state = read_player(shown)
    return {key: int(number_of(state, key, 0, MOST_FRAMES) or 0) for key in ("frame", "sample")}


def part_request(fields: Mapping[str, Any]) -> SceneRequest:
    """A request for a part of the motion that the player shows: the selected span again, or several futures.

    Args:
        fields: of the tab, with ``part`` ("span" or "futures"), its ``words``, the ``record`` of the motion, and what
            :func:`place_of` gives.

    Raises:
        InputError: without a motion or a span.
    """
    duet, story = shown_duet(fields["record"], fields["sample"]), story_fields(fields["story"])
    plain = {f: fields[f] for f in ("guidance", "steps", "damping", "strictness")}
    plain |= {"seed": secrets.randbelow(MAX_SEED + 1), "planned": story["planned"]}
    words = str(fields["words"] or "").strip()
    if fields["part"] == "futures":
        start = min(fields["frame"] / duet.fps, duet.seconds)
        beats = split_sentence(words, in_time()) or (Beat(seconds=FUTURE_SECONDS),)
        length = start + sum(beat.length for beat in beats)
        paths, poses = wishes_in(story, start, length, length)
        return SceneRequest(beats=beats, paths=paths, poses=poses, motion=duet, start=start, samples=FUTURES, **plain)
    span = span_of(fields["story"])
    if span is None:
        raise InputError("No span is selected: drag on the ruler over the beats, or type its seconds.")
    start, end = max(0.0, span[0]), min(span[1], duet.seconds)
    beats = split_sentence(words, in_time()) or beats_in(story["beats"], start, end)
    paths, poses = wishes_in(story, start, end, duet.seconds)
    return SceneRequest(beats=beats, paths=paths, poses=poses, motion=duet, start=start, end=end, **plain)


def shown_duet(record: Record | None, sample: int) -> Duet:
    """The motion of two people that the player shows; raises InputError if there is none."""
    if record is None:
        raise InputError("There is no motion yet: write a story and press Generate.")
    duets = record.result.duets
    duet = duets[min(max(sample, 0), len(duets) - 1)]
    if not isinstance(duet, Duet):
        raise InputError("The last result holds one person: generate a scene of two first.")
    return duet


def only_sample(result: Result, sample: int) -> Result:
    """A result with one of its samples alone."""
    sample = min(max(sample, 0), len(result.duets) - 1)
    return replace(
        result,
        duets=(result.duets[sample],),
        readouts=result.readouts[sample : sample + 1],
        manifest={**result.manifest, "sample": sample},
    )


def went_on(story: Any, wanted: SceneRequest) -> dict[str, Any]:
    """The story up to where a continuation begins, and its beats."""
    fields = story_fields(story)
    start = wanted.start or 0.0
    known = beats_in(fields["beats"], 0.0, start) if fields["beats"] else ()
    missing = start - sum(beat.length for beat in known)
    if known and abs(missing) > 1e-6:  # a beat of which too little is left
        known = (*known[:-1], replace(known[-1], seconds=round(known[-1].length + missing, 2)))
    paths, poses = wishes_in(fields, 0.0, wanted.total_seconds, wanted.total_seconds)
    return story_value((*known, *wanted.beats), paths, poses, planned=wanted.planned)


def beats_in(beats: tuple[Beat, ...], start: float, end: float) -> tuple[Beat, ...]:
    """The beats of which a span holds at least half a second, with their lengths in it."""
    listed, at = [], 0.0
    for beat in beats:
        inside = min(at + beat.length, end) - max(at, start)
        if inside >= 0.5:
            listed.append(Beat(beat.words, beat.a, beat.b, round(inside, 2)))
        at += beat.length
    return tuple(listed) or (Beat(seconds=max(end - start, 0.5)),)


def wishes_in(
    story: Mapping[str, Any], start: float, end: float, total: float
) -> tuple[tuple[FloorPath, ...], tuple[Pose, ...]]:
    """The points of paths and the poses of a story of ``total`` seconds that fall into a part of it.

    Args:
        story: the fields of :func:`~webdemo.ui.components.story.story_fields`.
        start, end: of the part in seconds; its last frame lies before ``end``.
        total: seconds of the motion.
    """
    first, last = round(start * FPS), round(end * FPS)
    poses = tuple(pose for pose in story["poses"] if first <= round(pose.seconds * FPS) < last)
    paths = []
    for path in story["paths"]:
        timed = path.timed(total).points
        inside = tuple(p for p in timed if first <= round((p.seconds or 0.0) * FPS) < last)
        if inside:
            paths.append(FloorPath(path.person, inside))
    return tuple(paths), poses
