"""Walking and running of two: together, towards, apart, behind, around and past each other."""

from __future__ import annotations

import numpy as np

from training.corpus.compose import Motion, place, steer
from training.corpus.library import Library, Take, pick
from training.corpus.scene import Scene
from training.corpus.stage import (
    Rng,
    act,
    beside,
    finish,
    keep_pace,
    manner,
    oppose,
    pace,
    pace_word,
    pad,
    seconds,
    stride,
    waiting,
)

from ..cues import STILL
from . import register
from .gestures import about, gesture, walk_off


def going(rng: Rng, library: Library, action: str, frames: int, *, style: str | None = None) -> Take:
    """A straight walk or run of at least ``frames`` frames."""
    take = stride(rng, library, action, 1.0, style=style)
    speed = pace(take.motion) or 1.0
    return stride(rng, library, action, speed * frames / 30 + 0.8, style=take.style)


def _abreast(rng: Rng, library: Library, family: str, action: str) -> Scene:
    style = manner(rng, library, action)
    frames = seconds(rng, 3, 6.5) if action == "walk" else seconds(rng, 2.2, 3.6)
    first = going(rng, library, action, frames, style=style)
    a = first.motion
    b = keep_pace(going(rng, library, action, frames, style=style).motion, pace(a))
    gap = pick(rng, (-1, 1)) * rng.uniform(0.65, 1.2)
    frames = min(len(a), len(b), 240)
    a, b = a[:frames], b[:frames]
    a = place(a, 0.0, 0.0, 0.0, along="travel")
    b = place(b, float(gap), float(rng.normal(0, 0.2)), 0.0, along="travel")
    if rng.random() < 0.35:  # a gentle common bend: the outer person walks the longer way
        bend = pick(rng, (-1, 1)) * rng.uniform(0.1, 0.25) * np.arange(frames) / 30
        a, b = steer(a, bend), steer(b, bend)
    word = pace_word(pace(a)) if action == "walk" else None
    return finish(
        rng,
        library,
        family,
        a,
        b,
        slots={"manner_a": style, "manner_b": style, "speed": word},
        events={"distance": "keep"},
        gaze=(float(rng.choice([0, 0.5])), float(rng.choice([0, 0.5]))),
    )


@register("walk-together", "walk-together", needs=("walk",), weight=1.6)
def walk_together(rng: Rng, library: Library) -> Scene:
    """Two people walk side by side."""
    return _abreast(rng, library, "walk-together", "walk")


@register("run-together", "run-together", needs=("run",), weight=1.2)
def run_together(rng: Rng, library: Library) -> Scene:
    """Two people run side by side."""
    return _abreast(rng, library, "run-together", "run")


@register("meet", "walk-up", needs=("walk", "idle"), weight=1.8)
def meet(rng: Rng, library: Library) -> Scene:
    """Both walk towards each other and stop face to face."""
    style = manner(rng, library, "walk")
    takes = [stride(rng, library, "walk", rng.uniform(1.4, 2.6), style=style) for _ in range(2)]
    starts = [seconds(rng, 0.1, 0.5), seconds(rng, 0.1, 0.9)]
    people = [
        act(rng, library, (start if rng.random() < 0.7 else 0, take.motion), tail=seconds(rng, 0.5, 1.2))[0]
        for start, take in zip(starts, takes, strict=True)
    ]
    frames = min(max(map(len, people)), 270)
    a, b = (pad(rng, library, person, frames) for person in people)
    b = oppose(rng, a, b, rng.uniform(0.9, 1.5), frame_a=-1, frame_b=-1)
    return finish(
        rng,
        library,
        "meet",
        a,
        b,
        slots={"manner_a": style, "manner_b": takes[1].style, "speed": pace_word(pace(takes[0].motion))},
        events={"distance": "approach", "facing": True},
    )


@register("walk-up", "walk-up", STILL, needs=("walk", "idle"), weight=1.8)
def walk_up(rng: Rng, library: Library) -> Scene:
    """a walks up to b, who waits."""
    return _approach(rng, library, "walk-up")


@register("approach", "walk-up", STILL, needs=("walk", "idle"), weight=0.8)
def approach(rng: Rng, library: Library) -> Scene:
    """The same in the words of the recorded data sets' class."""
    return _approach(rng, library, "approach")


def _approach(rng: Rng, library: Library, family: str) -> Scene:
    action = "run" if library.has("run") and rng.random() < 0.15 else "walk"
    take = stride(rng, library, action, rng.uniform(1.8, 3.4), style=manner(rng, library, "walk"))
    a, _ = act(
        rng, library, (pick(rng, (0, seconds(rng, 0.2, 0.7))), take.motion), tail=seconds(rng, 0.5, 1.2)
    )
    b = oppose(rng, a, waiting(rng, library, len(a)), rng.uniform(0.8, 1.4), frame_a=-1, frame_b=-1)
    word = "fast" if action == "run" else pace_word(pace(take.motion))
    return finish(
        rng,
        library,
        family,
        a,
        b,
        slots={"manner_a": take.style, "speed": word},
        events={"distance": "approach", "facing": True},
    )


@register("part", "part", needs=("walk", "idle"), weight=1.5)
def part(rng: Rng, library: Library) -> Scene:
    """They stand face to face, turn about and walk apart."""
    style = manner(rng, library, "walk")
    people = [
        act(
            rng,
            library,
            (seconds(rng, 0.4, 1.2), walk_off(rng, library, style=style, distance=2.4)),
            idle_after=False,
        )[0]
        for _ in range(2)
    ]
    frames = min(*map(len, people), 240)
    a, b = people[0][:frames], people[1][:frames]
    b = oppose(rng, a, b, rng.uniform(0.9, 1.6))
    return finish(
        rng,
        library,
        "part",
        a,
        b,
        slots={"manner_a": style, "manner_b": style},
        events={"distance": "part"},
        gaze=(0.4, 0.4),
    )


@register("leave", "walk-away", STILL, needs=("walk", "idle"), weight=1.5)
def leave(rng: Rng, library: Library) -> Scene:
    """a turns about and walks away from b, who stays."""
    return _leave(rng, library, "leave")


@register("depart", "walk-away", STILL, needs=("walk", "idle"), weight=0.8)
def depart(rng: Rng, library: Library) -> Scene:
    """The same in the words of the recorded data sets' class."""
    return _leave(rng, library, "depart")


def _leave(rng: Rng, library: Library, family: str) -> Scene:
    style = manner(rng, library, "walk")
    walk = walk_off(rng, library, style=style, distance=2.4)
    a, _ = act(rng, library, (seconds(rng, 0.3, 1.2), walk), idle_after=False)
    b = oppose(rng, a, waiting(rng, library, len(a)), rng.uniform(0.9, 1.8))
    return finish(rng, library, family, a, b, slots={"manner_a": style}, events={"distance": "part"})


def _behind(
    rng: Rng,
    library: Library,
    family: str,
    actions: tuple[str, str],
    gap: tuple[float, float],
    lengths: tuple[float, float],
) -> Scene:
    style = manner(rng, library, actions[0])
    frames = seconds(rng, *lengths)
    first = going(rng, library, actions[0], frames, style=style)
    second = going(rng, library, actions[1], frames, style=None if rng.random() < 0.5 else style)
    a = first.motion
    b = keep_pace(second.motion, pace(a))
    frames = min(len(a), len(b), 240)
    distance = rng.uniform(*gap)
    lag = int(distance / max(pace(a), 0.3) * 30)
    bend = np.zeros(frames + lag)
    if rng.random() < 0.5:  # a curve that the second walks where the first has walked
        bend = pick(rng, (-1, 1)) * rng.uniform(0.15, 0.5) * np.arange(frames + lag) / 30
    a = place(a[:frames], 0.0, 0.0, 0.0, along="travel")
    b = place(b[:frames], 0.0, -distance, 0.0, along="travel")
    late = np.concatenate([np.zeros(min(lag, frames)), bend[: max(frames - lag, 0)]])
    a, b = steer(a, bend[:frames]), steer(b, late)
    return finish(
        rng,
        library,
        family,
        a,
        b,
        slots={
            "manner_a": style,
            "manner_b": second.style if family == "follow" else None,
            "speed": pace_word(pace(a)) if family == "follow" else None,
        },
        events={"distance": "keep"},
        gaze=(0.0, 0.5),
    )


@register("follow", "walk-ahead", "follow", needs=("walk",), weight=1.5)
def follow(rng: Rng, library: Library) -> Scene:
    """A follows B."""
    return _behind(rng, library, "follow", ("walk", "walk"), (0.9, 1.8), (3, 6.5))


@register("chase", "run-away", "chase", needs=("run",), weight=1.5)
def chase(rng: Rng, library: Library) -> Scene:
    """A runs after B."""
    actions = [name for name in ("run", "dash") if library.has(name)]
    return _behind(rng, library, "chase", (pick(rng, actions), pick(rng, actions)), (1.2, 2.2), (2.0, 3.6))


@register("guide-follow", "walk-ahead", "follow", needs=("guide", "walk"), weight=1.3)
def guide_follow(rng: Rng, library: Library) -> Scene:
    """a shows the way, turns and walks ahead; b follows."""
    show = gesture(rng, library, "guide", style=manner(rng, library, "guide"))
    angle = (np.pi + rng.normal(0, 0.15)) * pick(rng, (-1, 1))
    walk = stride(rng, library, "walk", rng.uniform(2.2, 3.2), style="normal")
    ahead = about(rng, walk.motion, angle=angle)
    a, starts = act(rng, library, (seconds(rng, 0.1, 0.4), show.motion), (None, ahead), idle_after=False)
    after = stride(rng, library, "walk", 3.2, style="normal").motion
    b, _ = act(rng, library, (starts[1] + seconds(rng, 0.5, 0.9), after), idle_after=False)
    frames = min(len(a), len(b), 285)
    b = oppose(rng, a, b, rng.uniform(1.1, 1.6))
    return finish(
        rng, library, "guide-follow", a[:frames], b[:frames], slots={"manner_a": show.style}, most=285
    )


def _round(
    rng: Rng,
    library: Library,
    radius: float,
    frames: int,
    side: int,
    *,
    style: str | None,
    speed: float | None,
) -> tuple[Motion, float]:
    """A walk on a circle from the origin facing +Z; its centre is ``radius`` to the ``side`` (1: left)."""
    walk = going(rng, library, "walk", frames, style=style).motion
    if speed is not None:
        walk = keep_pace(walk, speed)
    walk = place(walk, 0.0, 0.0, 0.0, along="travel")
    steps = np.concatenate([[0.0], np.diff(walk.root[:, 2])])
    return steer(walk, side * np.cumsum(np.maximum(steps, 0)) / radius), pace(walk)


@register("circle", "walk-around", STILL, needs=("walk", "idle"), weight=1.5)
def circle(rng: Rng, library: Library) -> Scene:
    """a walks around b, who stands."""
    side, radius = pick(rng, (-1, 1)), rng.uniform(1.0, 1.5)
    style = manner(rng, library, "walk")
    frames = seconds(rng, 4, 8)
    a, _ = _round(rng, library, radius, frames, side, style=style, speed=None)
    a = a[:270]
    b = waiting(rng, library, len(a))
    b = place(b, side * radius, 0.0, float(rng.uniform(-np.pi, np.pi)))
    return finish(
        rng,
        library,
        "circle",
        a,
        b,
        slots={"manner_a": style, "direction": "counterclockwise" if side > 0 else "clockwise"}
        if rng.random() < 0.5
        else {"manner_a": style},
        events={"distance": "keep", "direction": "counterclockwise" if side > 0 else "clockwise"},
        gaze=(0.6, 0.8),
    )


@register("circle-each-other", "circle-together", needs=("walk",), weight=1.3)
def circle_each_other(rng: Rng, library: Library) -> Scene:
    """Two people circle each other."""
    side, radius = pick(rng, (-1, 1)), rng.uniform(0.8, 1.3)
    style, frames = manner(rng, library, "walk"), seconds(rng, 4, 8)
    a, speed = _round(rng, library, radius, frames, side, style=style, speed=None)
    b, _ = _round(rng, library, radius, frames, side, style=style, speed=speed)
    b = beside(b, np.array([side * 2 * radius, 0.0]), np.pi, 0.0, 0.0, 0.0)
    return finish(
        rng,
        library,
        "circle-each-other",
        a,
        b,
        slots={"direction": "counterclockwise" if side > 0 else "clockwise"} if rng.random() < 0.5 else {},
        events={"distance": "keep", "direction": "counterclockwise" if side > 0 else "clockwise"},
    )


@register("walk-past", "walk-past", needs=("walk",), weight=1.5)
def walk_past(rng: Rng, library: Library) -> Scene:
    """Two people walk past each other."""
    style = manner(rng, library, "walk")
    frames = seconds(rng, 3, 5)
    first, second = (
        going(rng, library, "walk", frames, style=s) for s in (style, manner(rng, library, "walk"))
    )
    frames = min(len(first), len(second), 210)
    a = place(first.motion[:frames], 0.0, 0.0, 0.0, along="travel")
    b = place(second.motion[:frames], 0.0, 0.0, np.pi, along="travel")
    # They meet in the middle of the scene: b starts as far ahead as both walk until then.
    middle = frames // 2
    offset = np.array([pick(rng, (-1, 1)) * rng.uniform(0.6, 1.0), 0.0, 0.0])
    shift = a.root[middle] - b.root[middle] + offset
    b = Motion(b.rotations, b.root + shift * np.array([1.0, 0.0, 1.0]), b.contacts, b.sources)
    return finish(
        rng, library, "walk-past", a, b, slots={"manner_a": style, "manner_b": second.style}, gaze=(0.5, 0.5)
    )


def _advance(rng: Rng, library: Library, family: str, action: str, gap: float) -> Scene:
    """a walks up to b, who steps back or aside in time."""
    take = stride(rng, library, "walk", rng.uniform(1.6, 2.6), style=manner(rng, library, "walk"))
    start = seconds(rng, 0.1, 0.5)
    a, _ = act(rng, library, (start, take.motion), tail=seconds(rng, 0.5, 1.0))
    side = {"walk-left": "left", "walk-right": "right"}.get(action)
    away = stride(rng, library, action, rng.uniform(0.8, 1.6), side=side)
    aim = 0.0
    if side is not None:  # the clips go askew; here the way goes straight to the side
        step = away.motion.root[-1] - away.motion.root[0]
        course = float(np.arctan2(step[0], step[2]) - away.motion.headings.mean())
        aim = course - (1 if side == "left" else -1) * np.pi / 2 * rng.uniform(0.8, 1.0)
    reaction = start + max(int(len(take.motion) * rng.uniform(0.35, 0.6)), 8)
    b, _ = act(rng, library, (reaction, away.motion, aim), tail=seconds(rng, 0.4, 0.9))
    frames = min(max(len(a), len(b)), 270)
    a, b = pad(rng, library, a, frames), pad(rng, library, b, frames)
    travelled = float(np.linalg.norm((take.motion.root[-1] - take.motion.root[0])[[0, 2]]))
    b = oppose(rng, a, b, travelled + gap, aside=0.05)
    return finish(
        rng,
        library,
        family,
        a,
        b,
        slots={"manner_a": take.style, "side_b": side if rng.random() < 0.7 else None},
        events={"side": {"b": side}} if side else {"facing": True},
    )


@register("step-back", "walk-up", "step-back", relation="reply", needs=("walk", "walk-back"), weight=1.3)
def step_back(rng: Rng, library: Library) -> Scene:
    """A comes, and B steps back."""
    return _advance(rng, library, "step-back", "walk-back", rng.uniform(0.6, 1.0))


@register(
    "make-way",
    "walk-up",
    "step-aside",
    relation="reply",
    needs=("walk", "walk-left", "walk-right"),
    weight=1.2,
)
def make_way(rng: Rng, library: Library) -> Scene:
    """A comes, and B steps aside."""
    return _advance(rng, library, "make-way", pick(rng, ("walk-left", "walk-right")), rng.uniform(0.3, 0.8))
