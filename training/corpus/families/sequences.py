"""Gestures in order, at the same time, copied or watched."""

from __future__ import annotations

from training.corpus.cues import STILL
from training.corpus.library import Library, pick
from training.corpus.scene import Scene
from training.corpus.stage import Rng, act, finish, manner, oppose, pad, seconds, waiting

from . import register
from .gestures import gesture, pair

GESTURES = ("bow", "wave", "raise-hand", "raise-hands", "bye")
SIDED = ("wave", "raise-hand", "bye")
CUES = {"raise-hand": "raise-arm", "raise-hands": "raise-arm@both", "bye": "wave"}
"""The cues of gestures that go by another name than their entry."""


def _two(rng: Rng) -> tuple[str, str]:
    """Draws two gestures that look different; bows, the only ones without arms, are drawn twice as often."""
    first = pick(rng, ("bow", *GESTURES))
    others = [name for name in GESTURES if name[:5] != first[:5] and {name, first} != {"wave", "bye"}]
    return first, pick(rng, ["bow", *others] if "bow" in others else others)


def _cues(*names: str) -> tuple[str, ...]:
    return tuple(CUES.get(name, name) for name in names)


def _style(rng: Rng, library: Library, name: str) -> str | None:
    return manner(rng, library, {"raise-hands": "raise-hand"}.get(name, name))


@register("ordered", STILL, relation="order", needs=("bow", "wave", "raise-hand", "bye"), weight=12.0)
def ordered(rng: Rng, library: Library) -> Scene:
    """a does one thing; when it is over, b does another."""
    names = _two(rng) if rng.random() < 0.8 else (pick(rng, GESTURES),) * 2
    first, second = (gesture(rng, library, name, style=_style(rng, library, name)) for name in names)
    start = seconds(rng, 0.05, 0.4)
    a, _ = act(rng, library, (start, first.motion), tail=12)
    later = start + len(first) + int(rng.integers(-8, 14))
    b, _ = act(rng, library, (later, second.motion), tail=seconds(rng, 0.2, 0.5))
    frames = min(len(b), 285)
    gap = rng.uniform(1.2, 2.8)
    a, b = pad(rng, library, a, frames), pad(rng, library, b, frames)
    b = oppose(rng, a, b, gap)
    sides = {}
    for person, name, take in zip("ab", names, (first, second), strict=True):
        if name in SIDED and take.side and rng.random() < 0.75:
            sides[person] = take.side
    events = {"order": list(names), "facing": True, "distance": "keep"} | ({"side": sides} if sides else {})
    slots = {"acts": _cues(*names), "manner_a": first.style, "manner_b": second.style} | {
        f"side_{person}": side for person, side in sides.items()
    }
    return finish(rng, library, "ordered", a, b, slots=slots, events=events, most=285)


@register("sequence", STILL, needs=("bow", "wave", "raise-hand", "bye"), weight=12.0)
def sequence(rng: Rng, library: Library) -> Scene:
    """a does two things one after the other while b watches."""
    names = _two(rng)
    style = _style(rng, library, names[0])
    first = gesture(rng, library, names[0], style=style)
    side = first.side if set(names) <= set(SIDED) else None
    second = gesture(rng, library, names[1], side=side, style=style)
    start = seconds(rng, 0.05, 0.5)
    gap = start + len(first) + int(rng.integers(0, 12))
    a, _ = act(
        rng,
        library,
        (start, first.motion),
        (gap if gap - start > len(first) + 6 else None, second.motion),
        tail=seconds(rng, 0.2, 0.6),
    )
    b = oppose(rng, a, waiting(rng, library, len(a)), rng.uniform(1.2, 2.8))
    manner_a = first.style if first.style == second.style else None
    # One side for the sentence: that of the gesture of one hand, or of both where two are of one hand.
    sides = {take.side for name, take in zip(names, (first, second), strict=True) if name in SIDED}
    side = sides.pop() if len(sides) == 1 and "raise-hands" not in names and rng.random() < 0.6 else None
    said = {"side": {"a": side}} if side else {}
    return finish(
        rng,
        library,
        "sequence",
        a,
        b,
        slots={"acts": (">".join(_cues(*names)), STILL), "manner_a": manner_a, "side_a": side},
        events={"order": list(names), "facing": True, "distance": "keep"} | said,
        most=285,
    )


@register("together", STILL, needs=("bow", "wave", "raise-hand", "bye"), weight=6.0)
def together(rng: Rng, library: Library) -> Scene:
    """Both act at the same time: the same gesture, by the same hand or each by their own, or two gestures."""
    names = (pick(rng, GESTURES),) * 2 if rng.random() < 0.5 else _two(rng)
    first = gesture(rng, library, names[0], style=_style(rng, library, names[0]))
    side = first.side if names[0] == names[1] and first.side else None
    if side in ("left", "right") and rng.random() < 0.5:
        side = "left" if side == "right" else "right"
    second = gesture(rng, library, names[1], side=side, style=first.style)
    sides = {
        f"side_{p}": t.side
        for p, n, t in zip("ab", names, (first, second), strict=True)
        if n in SIDED and t.side
    }
    if rng.random() < 0.25:
        sides = {}
    return pair(
        rng,
        library,
        "together",
        first,
        second,
        delay=(-0.1, 0.25),
        slots={"acts": _cues(*names), "side_a": None, "side_b": None} | sides,
    )


@register("copy", STILL, relation="reply", needs=("bow", "wave", "raise-hand"), weight=1.2)
def copy(rng: Rng, library: Library) -> Scene:
    """b repeats what a does."""
    name = pick(rng, GESTURES)
    first = gesture(rng, library, name, style=_style(rng, library, name))
    second = gesture(rng, library, name, side=first.side, style=first.style)
    named = {"side_a": first.side} if name in SIDED and rng.random() < 0.6 else {"side_a": None}
    return pair(
        rng,
        library,
        "copy",
        first,
        second,
        delay=(0.6, 1.8),
        slots={"acts": _cues(name, name), "side_b": None} | named,
    )


@register("watch", STILL, needs=("bow", "wave", "raise-hand"), weight=2.0)
def watch(rng: Rng, library: Library) -> Scene:
    """a does something, b watches."""
    name = pick(rng, (*GESTURES, "wave", "raise-hand"))
    first = gesture(rng, library, name, style=_style(rng, library, name))
    named = {"side_a": first.side} if name in SIDED and rng.random() < 0.7 else {"side_a": None}
    return pair(
        rng, library, "watch", first, None, distance=(1.0, 3.0), slots={"acts": (*_cues(name), STILL)} | named
    )
