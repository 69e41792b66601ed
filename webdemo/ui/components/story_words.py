"""The words over the story line and its beats: two views of one thing, of which what was changed last is made."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import gradio as gr
import numpy as np

from motion import InputError
from webdemo.inference.story import Beat, Pose, SceneRequest, in_time, read_words, split_sentence
from webdemo.inference.story.beats import seconds_of
from webdemo.ui.text.panels import status
from webdemo.ui.text.words import counted, error_line

from .story import story_fields, story_value, ticked

Updates = tuple[Any, ...]


def story_text(beats: Sequence[Beat]) -> str:
    """The words of beats as the text that the page shows over them."""
    return " ".join(beat.sentence for beat in beats if beat.sentence)


def settled(story: Any, text: str) -> tuple[Any, str]:
    """The story that is made, and the text that stands for it: the text and the beats are two views of one thing.

    What was changed last is what is made. Beats that were changed after their text (``ahead``) give the text; a text
    that was changed gives the beats, of which those that it still names stay as they are. An empty text is filled
    from the beats, and a story in TOML is shown as its words.
    """
    beats = story_fields(story)["beats"]
    if beats and (story.get("ahead") or not text.strip()):
        return {**story, "ahead": False}, story_text(beats)
    go_on = in_time()
    read = read_words(text, go_on)
    if "paths" in read:
        laid = story_value(read["beats"], read["paths"], read["poses"], loop=read["loop"], planned=read["planned"])
        return laid, story_text(read["beats"])
    return reworded(story, read["beats"], go_on), text


def reworded(story: Any, beats: tuple[Beat, ...], go_on: Callable[[], None]) -> Any:
    """A story of other beats: those at its beginning and end whose words stay keep their lengths and seeds.

    Poses stay with beats that stay, and paths as long as any does. The story itself, where nothing changes.
    ``go_on`` is called before each sentence that is read.
    """
    old = story_fields(story)
    words = [tuple(part.words for part in split_sentence(beat.sentence, go_on)) for beat in old["beats"]]
    new = [beat.words for beat in beats]
    head = _kept(words, new)
    tail = _kept([each[::-1] for each in words[head:][::-1]], new[sum(map(len, words[:head])) :][::-1])
    first, last = sum(map(len, words[:head])), sum(map(len, words[len(words) - tail :]))
    if head == len(words) and first == len(new):
        return story
    left = (*old["beats"][:head], *beats[first : len(new) - last], *old["beats"][len(words) - tail :])
    paths = old["paths"] if head + tail else ()
    poses = _along(old["poses"], old["beats"], left, head, tail) if head + tail else ()
    return story_value(left, paths, poses, **ticked(story))


def _kept(words: Sequence[Sequence[str]], new: Sequence[str]) -> int:
    """The number of first beats, each as the sentences it is split into, with which the new sentences begin."""
    at = 0
    for count, own in enumerate(words):
        if not own or tuple(new[at : at + len(own)]) != tuple(own):
            return count
        at += len(own)
    return len(words)


def _along(poses: tuple[Pose, ...], old: Sequence[Beat], new: Sequence[Beat], head: int, tail: int) -> tuple[Pose, ...]:
    """Poses in the first ``head`` beats, and those in or behind the last ``tail``, which move with them."""
    starts = np.cumsum([0.0, *(beat.length for beat in old)])
    by = sum(beat.length for beat in new) - float(starts[-1])
    moved = []
    for pose in poses:
        beat = int(np.searchsorted(starts, pose.seconds + 1e-4, side="right")) - 1
        if beat < head:
            moved.append(pose)
        elif beat >= len(old) - tail:
            moved.append(replace(pose, seconds=round(pose.seconds + by, 4)))
    return tuple(moved)


def said_of(text: str, story: Any) -> str:
    """The words that a run was asked for with where they are those of its story; otherwise the words of its beats."""
    try:
        laid, said = settled(story, text)
    except InputError:
        laid, said = None, ""
    return said if laid is story else story_text(story_fields(story)["beats"])


# ---- events


def lay_out(sentences: str, story: Any = None) -> Updates:
    """A sentence, and the line with its beats; what was ticked on the line stays so."""
    beats = split_sentence(sentences, in_time())
    return (
        sentences,
        story_value(beats, **ticked(story)),
        status(f"{counted(len(beats), 'beat').capitalize()}: press Generate."),
    )


def edited(story: Any) -> Updates:
    """The lengths of the beats and their words after a change on the line, and what is wrong with them."""
    lengths: list[float] | None = None
    words: Any = gr.skip()
    try:
        fields = story_fields(story)
        lengths = [seconds_of(beat.sentence) for beat in fields["beats"]]
        if isinstance(story, Mapping) and story.get("ahead"):
            words = story_text(fields["beats"])
        SceneRequest(**fields)
    except Exception as error:
        line = error_line(error) if isinstance(story, Mapping) and story.get("beats") else ""
        return (gr.update(lengths=lengths), status(line, tone="warning") if line else status(), words)
    return gr.update(lengths=lengths), status(), words


def written(text: str, story: Any) -> Updates:
    """The line as the words over it say, once they are written."""
    unchanged = (gr.skip(),) * 3
    if isinstance(story, Mapping) and story.get("ahead"):
        return unchanged  # the beats were changed since
    try:
        laid, said = settled(story, text or "")
        if laid is story and said == text:
            return unchanged
        request = SceneRequest(**story_fields(laid))
    except Exception as error:
        empty = not (text or "").strip()
        return unchanged if empty else (gr.skip(), status(error_line(error), tone="warning"), gr.skip())
    shown = {name: laid[name] for name in ("beats", "paths", "poses")}
    line = status(f"{counted(len(request.beats), 'beat').capitalize()}, {request.seconds:g} s: press Generate.")
    return gr.update(laid=shown | {"at": time.time()}), line, gr.skip() if said == text else said
