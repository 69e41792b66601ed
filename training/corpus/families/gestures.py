"""Greetings, gestures and dances: two people who stand apart and answer each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from motion.easing import smoothstep
from motion.kinematics import forward_kinematics, global_rotations, local_rotations
from motion.skeleton import SMPL22
from training.corpus.blending import ease, slerp
from training.corpus.compose import ARMS, Motion, drift, lean, mirror, place, steer, tempo, turned
from training.corpus.library import Library, Take, pick
from training.corpus.scene import Scene
from training.corpus.stage import Rng, act, finish, manner, oppose, pad, seconds, stride, waiting

from ..cues import STILL
from . import register

SIDES = ("left", "right")
HEAD = SMPL22.index("head")
SPAN = {"wave": (66, 120), "raise-hand": (40, 90), "bow": (60, 125), "bye": (60, 130), "guide": (60, 125)}


def gesture(
    rng: Rng, library: Library, name: str, *, side: str | None = None, style: str | None = None
) -> Take:
    """A gesture by the name that captions use: "raise-hands" and "cheer" are raised hands of both sides."""
    if name in ("raise-hands", "cheer"):
        return library.take(rng, "raise-hand", side="both", style=style, frames=SPAN["raise-hand"])
    if name in ("raise-hand", "wave") and side is None:
        side = pick(rng, SIDES)
    take = library.take(rng, name, side=side, style=style, frames=SPAN.get(name, (50, 150)))
    if name == "bow":
        return replace(take, motion=deepened(take.motion, rng.uniform(0.27, 0.4)))
    return take


def deepened(motion: Motion, drop: float) -> Motion:
    """A bow whose head comes down by ``drop`` metres at least: the spine bends as much further as needed."""
    height = forward_kinematics(motion.rotations, motion.root)[:, HEAD, 1]
    fallen = height[: max(len(height) // 8, 1)].mean() - height
    if fallen.max() < 0.04:
        raise LookupError("a bow that is none")
    if fallen.max() >= drop:
        return motion
    weight = smoothstep(fallen / fallen.max())
    angle = 0.0
    bent = motion
    for _ in range(6):
        lacking = drop - (height.max() - forward_kinematics(bent.rotations, bent.root)[:, HEAD, 1].min())
        if lacking < 0.01:
            break
        angle = min(angle + lacking / 0.45, 1.25)
        bent = lean(motion, angle * weight)
        back = np.stack([np.sin(motion.headings), np.zeros(len(motion)), np.cos(motion.headings)], axis=-1)
        bent = drift(bent, -0.09 * angle * weight[:, None] * back)
    return bent


def pair(
    rng: Rng,
    library: Library,
    family: str,
    first: Take,
    second: Take | None,
    *,
    delay: tuple[float, float] = (0.25, 1.2),
    distance: tuple[float, float] = (1.2, 2.6),
    slots: dict | None = None,
    events: dict | None = None,
) -> Scene:
    """Face to face: a performs ``first``, b performs ``second`` after a delay in seconds or just watches."""
    start = seconds(rng, 0.1, 0.7)
    a, _ = act(rng, library, (start, first.motion), tail=seconds(rng, 0.2, 0.6))
    if second is None:
        b = waiting(rng, library, len(a))
    else:
        later = max(start + seconds(rng, *delay), 0)
        b, _ = act(rng, library, (later, second.motion), tail=seconds(rng, 0.2, 0.6))
    frames = min(max(len(a), len(b)), 270)
    a, b = pad(rng, library, a, frames), pad(rng, library, b, frames)
    gap = rng.uniform(*distance)
    known = {"manner_a": first.style, "side_a": first.side}
    if second is not None:
        known |= {"manner_b": second.style, "side_b": second.side}
    known |= slots or {}
    if rng.random() < 0.4 or "side_a" in (slots or {}):
        known = {
            key: value for key, value in known.items() if not key.startswith("side") or key in (slots or {})
        }
    said = {key[-1]: value for key, value in known.items() if key.startswith("side") and value}
    found = {"facing": True, "distance": "keep"} | ({"side": said} if said else {}) | (events or {})
    b = oppose(rng, a, b, gap)
    return finish(rng, library, family, a, b, slots=known, events=found)


@register("wave-back", "wave", relation="reply", needs=("wave",), weight=2.0)
def wave_back(rng: Rng, library: Library) -> Scene:
    """A waves, and B waves back."""
    style = manner(rng, library, "wave")
    first = gesture(rng, library, "wave", side=pick(rng, ("left", "right", "both")), style=style)
    second = gesture(
        rng,
        library,
        "wave",
        side=first.side if rng.random() < 0.6 else None,
        style=style if rng.random() < 0.6 else None,
    )
    slots = {"side_b": second.side} if second.side != first.side and rng.random() < 0.6 else None
    scene = pair(rng, library, "wave-back", first, second, slots=slots, distance=(1.2, 3.2))
    return scene


@register("bow-back", "bow", relation="reply", needs=("bow",), weight=1.5)
def bow_back(rng: Rng, library: Library) -> Scene:
    """A bows, and B bows in return."""
    style = manner(rng, library, "bow")
    first = gesture(rng, library, "bow", style=style)
    second = gesture(rng, library, "bow", style=style if rng.random() < 0.6 else None)
    return pair(rng, library, "bow-back", first, second, distance=(1.5, 2.6))


@register("raise-copy", "raise-arm", relation="reply", needs=("raise-hand",), weight=1.3)
def raise_copy(rng: Rng, library: Library) -> Scene:
    """A raises a hand, and B does the same."""
    side, style = pick(rng, ("left", "right", "both")), manner(rng, library, "raise-hand")
    first, second = (gesture(rng, library, "raise-hand", side=side, style=style) for _ in range(2))
    return pair(
        rng,
        library,
        "raise-copy",
        first,
        second,
        delay=(0.5, 1.5),
        slots={"side_a": side, "side_b": side},
        events={"side": {"a": side, "b": side}},
    )


@register("raise-watch", "raise-arm", STILL, needs=("raise-hand",), weight=1.3)
def raise_watch(rng: Rng, library: Library) -> Scene:
    """A raises a hand while B watches."""
    side = pick(rng, ("left", "right", "both"))
    first = gesture(rng, library, "raise-hand", side=side, style=manner(rng, library, "raise-hand"))
    return pair(rng, library, "raise-watch", first, None, slots={"side_a": side}, distance=(1.0, 3.0))


@register("goodbye", "wave", relation="reply", needs=("bye", "wave", "walk"), weight=1.5)
def goodbye(rng: Rng, library: Library) -> Scene:
    """Two people say goodbye, and one may leave."""
    first = gesture(rng, library, "bye", style=manner(rng, library, "bye"))
    second = gesture(rng, library, pick(rng, ("bye", "wave")))
    if rng.random() < 0.55:
        return pair(rng, library, "goodbye", first, second, delay=(0.2, 1.0))
    start = seconds(rng, 0.1, 0.5)
    a, _ = act(rng, library, (start, first.motion), (None, walk_off(rng, library)), idle_after=False)
    b, _ = act(rng, library, (start + seconds(rng, 0.2, 0.8), second.motion))
    frames = min(max(len(a) - 5, 90), 270)
    b = oppose(rng, a, pad(rng, library, b, frames), rng.uniform(1.2, 2.2))
    slots = {"manner_a": first.style, "acts": ("wave>walk-away", "wave")}
    return finish(rng, library, "goodbye", a, b, slots=slots, events={"distance": "part"})


def walk_off(rng: Rng, library: Library, *, style: str | None = None, distance: float = 2.2) -> Motion:
    """A walk that begins with an about-turn, as in leaving."""
    walk = stride(rng, library, "walk", distance + rng.uniform(0, 1.0), style=style).motion
    return about(rng, walk)


def about(rng: Rng, walk: Motion, *, angle: float | None = None) -> Motion:
    """Bends the first second of a walk so that it turns about by ``angle`` (default: half a turn)."""
    angle = angle if angle is not None else (np.pi + rng.normal(0, 0.2)) * pick(rng, (-1.0, 1.0))
    frames = min(int(rng.uniform(30, 42)), len(walk) - 2)
    extra, scale = np.full(len(walk), angle), np.ones(len(walk))
    extra[:frames] = angle * ease(frames)
    scale[:frames] = 0.25 + 0.75 * ease(frames) ** 2  # who turns hardly gets on meanwhile
    return steer(tempo(walk, scale), extra)


@register("cheer", "cheer", needs=("raise-hand",), weight=1.2)
def cheer(rng: Rng, library: Library) -> Scene:
    """Two people cheer together."""
    style = pick(rng, ("normal", "active", "youthful", "happy"))
    first, second = (gesture(rng, library, "cheer", style=style) for _ in range(2))
    return pair(
        rng,
        library,
        "cheer",
        first,
        second,
        delay=(-0.2, 0.5),
        distance=(1.0, 2.2),
        slots={"side_a": None, "side_b": None},
        events={"side": {"a": "both", "b": "both"}},
    )


@register("point", "point", STILL, needs=("idle",), weight=1.0)
def point(rng: Rng, library: Library) -> Scene:
    """A points at B."""
    side, gap = pick(rng, SIDES), rng.uniform(1.2, 3.0)
    start, hold = seconds(rng, 0.2, 0.8), seconds(rng, 1.2, 2.6)
    frames = start + hold + seconds(rng, 0.8, 1.2)
    a, b = waiting(rng, library, frames), waiting(rng, library, frames)
    a = place(a, 0.0, 0.0, 0.0)
    b = oppose(rng, a, b, gap)
    a = pointing(a, b.root + np.array([0.0, 0.25, 0.0]), side, start, start + hold)
    return finish(
        rng,
        library,
        "point",
        a,
        b,
        slots={"side_a": side if rng.random() < 0.7 else None},
        events={"side": {"a": side}, "facing": True},
    )


def pointing(
    motion: Motion, target: np.ndarray, side: str, start: int, stop: int, *, raise_in: int = 16
) -> Motion:
    """Stretches one arm towards ``target`` (T, 3) from frame ``start`` to ``stop``."""
    world = global_rotations(motion.rotations)
    _, shoulder, elbow, wrist = ARMS[side]
    sign = 1.0 if side == "left" else -1.0
    reach = target - motion.root - np.array([0.0, 0.45, 0.0])
    reach = reach / np.linalg.norm(reach, axis=-1, keepdims=True)
    up = np.broadcast_to([0.0, 1.0, 0.0], reach.shape)
    x = sign * reach  # the arm's rest direction is +X on the left, -X on the right
    z = np.cross(x, up)
    z = z / np.linalg.norm(z, axis=-1, keepdims=True)
    aimed = np.stack([x, np.cross(z, x), z], axis=-1)
    wanted = world.copy()
    for joint in (shoulder, elbow, wrist):
        wanted[:, joint] = aimed
    weight = np.zeros(len(motion))
    weight[start : start + raise_in] = ease(raise_in)
    weight[start + raise_in : stop] = 1.0
    weight[stop : stop + raise_in] = ease(raise_in)[::-1][: len(motion) - stop]
    rotations = motion.rotations.copy()
    local = local_rotations(wanted)
    chosen = [shoulder, elbow, wrist]
    rotations[:, chosen] = slerp(rotations[:, chosen], local[:, chosen], weight[:, None])
    return Motion(rotations, motion.root, motion.contacts, motion.sources)


@register("call-come", "beckon", "walk-up", relation="reply", needs=("call", "walk"), weight=1.5)
def call_come(rng: Rng, library: Library) -> Scene:
    """A beckons, and B comes."""
    call = gesture(rng, library, pick(rng, ("call", "call", "guide")) if library.has("guide") else "call")
    a, _ = act(rng, library, (seconds(rng, 0.1, 0.4), call.motion), tail=20)
    runs = library.has("run") and rng.random() < 0.25
    distance, stop = rng.uniform(1.8, 3.2), rng.uniform(0.8, 1.3)
    walk = stride(rng, library, "run" if runs else "walk", distance, style=manner(rng, library, "walk"))
    b, _ = act(rng, library, (min(len(call) // 2 + seconds(rng, 0.3, 0.8), 75), walk.motion), tail=20)
    frames = min(max(len(a), len(b)), 270)
    a, b = pad(rng, library, a, frames), pad(rng, library, b, frames)
    b = oppose(rng, a, b, stop, frame_b=-1)
    return finish(
        rng,
        library,
        "call-come",
        a,
        b,
        slots={"manner_b": walk.style, "acts": ("beckon", "run-up" if runs else "walk-up")},
        events={"distance": "approach", "facing": True},
    )


@register("talk", "talk", STILL, needs=("guide", "respond"), weight=1.3)
def talk(rng: Rng, library: Library) -> Scene:
    """Two people talk to each other."""
    style = manner(rng, library, "guide")
    first = gesture(rng, library, "guide", style=style)
    more = gesture(rng, library, pick(rng, ("guide", "respond")), style=style)
    a, _ = act(
        rng, library, (seconds(rng, 0.0, 0.5), first.motion), (None, more.motion), tail=seconds(rng, 0.2, 1)
    )
    if rng.random() < 0.5:
        acts = ("talk", "talk")
        answer = gesture(rng, library, pick(rng, ("respond", "guide")))
        b, _ = act(rng, library, (seconds(rng, 1.5, 3.5), answer.motion))
    else:
        acts = ("talk", "listen")
        b = waiting(rng, library, len(a))
    frames = min(max(len(a), 90), 270)
    a, b = pad(rng, library, a, frames), pad(rng, library, b, frames)
    b = oppose(rng, a, b, rng.uniform(1.0, 1.8))
    return finish(
        rng,
        library,
        "talk",
        a,
        b,
        slots={"manner_a": style, "acts": acts},
        events={"facing": True, "distance": "keep"},
    )


@register("turn-away", "turn-away>walk-away", STILL, needs=("walk",), weight=0.8)
def turn_away(rng: Rng, library: Library) -> Scene:
    """A turns away from B."""
    walk = about(
        rng, stride(rng, library, "walk", rng.uniform(0.8, 1.6), style=manner(rng, library, "walk")).motion
    )
    a, _ = act(rng, library, (seconds(rng, 0.3, 1.2), walk), tail=seconds(rng, 0.5, 1.2))
    b = oppose(rng, a, waiting(rng, library, len(a)), rng.uniform(1.1, 2.2))
    return finish(rng, library, "turn-away", a, b, events={"distance": "part"})


@register("idle", STILL, needs=("idle",), weight=0.8)
def idle(rng: Rng, library: Library) -> Scene:
    """Two people stand and wait."""
    frames, gap = seconds(rng, 3, 7), rng.uniform(0.9, 3.0)
    a, b = waiting(rng, library, frames), waiting(rng, library, frames)
    b = oppose(rng, a, b, gap)
    return finish(rng, library, "idle", a, b, events={"distance": "keep"})


# ---- dances ------------------------------------------------------------------------------------------------


def dance_piece(rng: Rng, library: Library) -> Take:
    """Four to eight seconds of the dance."""
    take = library.take(rng, "dance")
    frames = min(seconds(rng, 4, 8), len(take))
    start = int(rng.integers(0, len(take) - frames + 1))
    return Take(take.motion[start : start + frames], take.action, take.style)


@register("dance-together", "dance", needs=("dance",), weight=1.3)
def dance_together(rng: Rng, library: Library) -> Scene:
    """Two people dance together."""
    first = dance_piece(rng, library).motion
    second = first if rng.random() < 0.5 else dance_piece(rng, library).motion
    frames = min(len(first), len(second))
    a, b = first[:frames], second[:frames]
    across = rng.random() < 0.6
    b = (
        oppose(rng, a, b, rng.uniform(1.7, 2.6))
        if across
        else place(
            b,
            *(a.root[0, [0, 2]] + pick(rng, (-1, 1)) * rng.uniform(1.5, 2.2) * a.rotations[0, 0, [0, 2], 0]),
            a.headings[0],
        )
    )
    return finish(rng, library, "dance-together", a, b, gaze=(0.0, 0.0))


@register("dance-mirrored", "dance+mirror", needs=("dance",), weight=1.2)
def dance_mirrored(rng: Rng, library: Library) -> Scene:
    """Two people dance as mirror images."""
    a = place(dance_piece(rng, library).motion, 0.0, 0.0, 0.0)
    b = turned(mirror(a), np.pi)
    gap = 2 * max(float(a.root[:, 2].max()), 0.0) + rng.uniform(1.2, 1.8)
    b = Motion(b.rotations, b.root + np.array([0.0, 0.0, gap]), b.contacts, b.sources)
    lag = int(rng.integers(0, 5))
    return finish(rng, library, "dance-mirrored", a[lag:], b[: len(b) - lag], gaze=(0.0, 0.0))


@register("dance-watch", "dance", STILL, needs=("dance", "idle"), weight=1.0)
def dance_watch(rng: Rng, library: Library) -> Scene:
    """A dances while B watches."""
    a = dance_piece(rng, library).motion
    b = oppose(rng, a, waiting(rng, library, len(a)), rng.uniform(1.8, 3.0))
    return finish(rng, library, "dance-watch", a, b, gaze=(0.0, 0.9))
