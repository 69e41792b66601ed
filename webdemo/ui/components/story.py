"""The story under the player as a Gradio component: beats in lanes, a span, poses and paths.

Its value is a story as JSON, see :func:`story_value`. Like the player it is a ``gr.HTML`` with modules of its own
(``static/story``) and constant templates: what a user typed travels as data.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import Field, TypeAdapter

from acts import Act
from motion import InputError
from webdemo.inference.requests.actor import finite
from webdemo.inference.requests.paths import FloorPath, path_of
from webdemo.inference.story import Beat, Pose, SceneRequest
from webdemo.inference.story.beats import MOST_BEATS
from webdemo.inference.story.request import beat_of, pose_of

from .accepts import Finite, Flag, Sent, SentPaths, Text
from .part import Part


class SentBeat(Sent):
    """A beat as the browser sends it; ``auto`` is the length that follows from its words or from its ``acts``."""

    words: Text = ""
    a: Text = ""
    b: Text = ""
    seconds: Finite | None = None
    seed: Finite | None = None
    auto: Finite | None = None
    acts: list[Act] = Field(default_factory=list)


class SentPose(Sent):
    """A pose as the browser sends it: a position for each joint."""

    person: Text
    seconds: Finite
    positions: list[list[Finite]]


class SentStory(Sent):
    """A story as the browser sends it: what :func:`story_value` gives, as it was changed since.

    ``ahead`` is true while the words of the beats were changed after the text over them.
    """

    beats: list[SentBeat] = Field(default_factory=list)
    paths: SentPaths
    poses: list[SentPose] = Field(default_factory=list)
    loop: Flag = False
    planned: Flag = True
    span: list[Finite] | None = None
    ahead: Flag = False


class StoryLine(Part):
    """Shows a story and lets it be changed; every change is an ``input`` event.

    Props beside the value: ``lengths``, seconds of the beats as they follow from the words; ``laid``, the ``beats``,
    ``paths`` and ``poses`` that a changed text gives.
    """

    accepts = TypeAdapter(SentStory | None)
    folder = "story"
    module = "editor.js"
    styled = True
    declared: ClassVar = {"lengths": None, "laid": None}


def story_value(
    beats: tuple[Beat, ...],
    paths: tuple[FloorPath, ...] = (),
    poses: tuple[Pose, ...] = (),
    *,
    loop: bool = False,
    planned: bool = True,
) -> dict[str, Any]:
    """A story as the component holds it."""
    return {
        "beats": [beat.to_dict() | {"auto": beat.length} for beat in beats],
        "paths": [path_value(path) for path in paths],
        "poses": [pose.to_dict() for pose in poses],
        "loop": loop,
        "planned": planned,
        "span": None,
        "ahead": False,
    }


def path_value(path: FloorPath) -> dict[str, Any]:
    """A path as the browser holds it, see ``SentPath`` of :mod:`.accepts`."""
    points = [[p.seconds, p.x, p.z] + ([p.heading] if p.heading is not None else []) for p in path.points]
    return {"person": path.person, "points": points}


def value_of(request: SceneRequest) -> dict[str, Any]:
    """The story of a request."""
    return story_value(request.beats, request.paths, request.poses, loop=request.loop, planned=request.planned)


def story_fields(value: Any) -> dict[str, Any]:
    """The fields of a :class:`SceneRequest` that a story sets.

    Raises:
        InputError: if the browser sent something else.
    """
    if not isinstance(value, Mapping):
        return {"beats": (), "paths": (), "poses": (), **ticked(value)}
    try:
        beats = [entry for entry in list(value.get("beats") or ())[: MOST_BEATS + 1] if isinstance(entry, Mapping)]
        read = tuple(beat_of(entry) for entry in beats)
        for number, beat in enumerate(read, 1):
            beat.check(number)
        return {
            "beats": read,
            "paths": tuple(path_of(entry) for entry in value.get("paths") or ()),
            "poses": tuple(pose_of(entry) for entry in value.get("poses") or ()),
            **ticked(value),
        }
    except InputError:
        raise
    except (TypeError, ValueError, AttributeError) as error:
        raise InputError("The story on the page is damaged: reload the page and write it again.") from error


def ticked(value: Any) -> dict[str, Any]:
    """The fields of a :class:`SceneRequest` that are ticked on a story, whatever else is in it."""
    state = value if isinstance(value, Mapping) else {}
    return {"loop": bool(state.get("loop")), "planned": state.get("planned") is not False}


def span_of(value: Any) -> tuple[float, float] | None:
    """The selected span in seconds, if there is one."""
    span = value.get("span") if isinstance(value, Mapping) else None
    if not isinstance(span, list) or len(span) != 2 or not all(map(finite, span)):
        return None
    return float(span[0]), float(span[1])
