"""Ways of two people: towards, away from, past, around, behind and beside each other."""

from __future__ import annotations

import numpy as np

from motion.vectors import wrapped

from ..compose import Array, ease, steer, tempo
from ..cues import STILL
from ..library import Take, pick, stride
from .acts import ACTS, arms_over, spoken
from .play import Play, bearing


def ahead(angle: float) -> Array:
    """(2,) unit vector (x, z) of a heading."""
    return np.array([np.sin(angle), np.cos(angle)])


def leftwards(angle: float) -> Array:
    """(2,) unit vector on the floor to the left of a heading in radians."""
    return np.array([np.cos(angle), -np.sin(angle)])


def gait(play: Play, *, fast: float = 0.15) -> str:
    """The source action of a way to go: "run", as often as ``fast``, "sneak" or "walk"."""
    rng = play.rng
    if play.library.has("run") and rng.random() < fast:
        return "run"
    return "sneak" if play.library.has("sneak") and rng.random() < 0.05 else "walk"


def close_in(play: Play, i: int, distance: float, *, both: bool = False, action: str = "walk") -> Take | None:
    """The two come to stand ``distance`` metres apart, face to face; the walk of i, if any was needed."""
    own, other = play.people[i], play.people[1 - i]
    start = play.sync()
    gap, axis = play.gap, own.spot - other.spot
    axis = axis / max(float(np.linalg.norm(axis)), 1e-6)
    towards = bearing(-axis)
    take = None
    if both and gap - distance > 1.4:
        middle = (own.spot + other.spot) / 2
        take = own.go(middle + axis * distance / 2, towards, action=action)
        other.go(middle - axis * distance / 2, towards + np.pi, action=action)
    else:
        stay = other.spot
        if abs(distance - gap) > 0.08 or abs(play.off(i)) > 0.25:
            take = own.go(stay + axis * distance, towards, action=action)
        if abs(play.off(1 - i)) > 0.3:
            other.hold(max(min(len(own) - start - 40, 12), 0))
            other.turn(wrapped(bearing(own.spot - other.spot) - other.angle))
    play.sync()
    error = play.gap - distance
    if abs(error) > 0.06 or max(abs(play.off(0)), abs(play.off(1))) > 0.22:
        shift = -error * (own.spot - other.spot) / max(play.gap, 1e-6)
        turns = (play.off(i), play.off(1 - i))
        frames = int(14 + 30 * abs(error) + 10 * max(map(abs, turns)))
        own.hold(frames, turn=turns[0], shift=shift)
        other.hold(frames, turn=turns[1])
    play.sync()
    return take


def come(play: Play, i: int, distance: float) -> int:
    """The two come within reach; the way there is a beat of its own if it is long enough."""
    start = play.sync()
    far = play.gap - distance
    both = far > 1.6 and play.rng.random() < 0.3
    take = close_in(play, i, distance, both=both)
    if far > 0.5:
        acts = ("walk-up", "walk-up") if both else ("walk-up", STILL)
        style = take.style if take else "normal"
        play.note(acts, start, i=i, styles=(style, "normal"), minor=bool(play.rng.random() < 0.4))
    return play.sync()


def walk_up(play: Play, i: int) -> None:
    """i comes up to the other, who stands; or both do."""
    rng = play.rng
    start = play.sync()
    action = gait(play, fast=0.25)
    both = rng.random() < 0.25
    take = close_in(play, i, rng.uniform(0.8, 1.3), both=both, action=action)
    style = take.style if take else "normal"
    acts = ("walk-up", "walk-up") if both else ("creep-up" if action == "sneak" else f"{action}-up", STILL)
    play.note(acts, start, i=i, styles=(style, "normal"))


def leave(play: Play, i: int) -> None:
    """i turns and goes away; the other stays, with or without an answer."""
    rng = play.rng
    start = play.sync()
    own = play.people[i]
    action = gait(play)
    way = own.angle + np.pi + rng.normal(0, 0.35) if abs(play.off(i)) < 1.2 else own.angle
    answer = pick(rng, (STILL, STILL, "wave", "wave", "beckon", "turn-away", "shake-head", "shrug", "point"))
    if answer in ACTS and not play.library.has(*ACTS[answer].needs):
        answer = STILL
    take = own.go(own.spot + rng.uniform(1.6, 3.0) * ahead(way), None, action=action, stop=rng.random() < 0.6)
    side, style = None, "normal"
    if answer == "turn-away":
        _turn_off(play, 1 - i, start)
    elif answer != STILL:
        play.people[1 - i].hold(play.seconds(0.3, 0.9))
        done = ACTS[answer].make(play, 1 - i)
        side, style = done.side, done.style
    play.note((f"{action}-away", answer), start, i=i, styles=(take.style, style), sides=(None, side))


def _turn_off(play: Play, i: int, start: int) -> None:
    """i turns the back on the other."""
    person = play.people[i]
    person.hold(play.seconds(0.2, 0.6))
    person.turn(pick(play.rng, (-1, 1)) * play.rng.uniform(2.3, 3.1))
    play.look(i, start, len(person) + 60, 0.0)


def part(play: Play, i: int) -> None:
    """Both turn and go their ways."""
    rng = play.rng
    start = play.sync()
    take = None
    for k in (i, 1 - i):
        person = play.people[k]
        way = person.angle + np.pi + rng.normal(0, 0.3)
        if k != i:
            person.hold(int(rng.integers(0, 15)))
        take = person.go(person.spot + rng.uniform(1.6, 2.6) * ahead(way), None, stop=rng.random() < 0.5)
    play.note(("part", "part"), start, i=i, styles=(take.style, take.style) if take else None)


def turn_away(play: Play, i: int) -> None:
    """A turns away from B."""
    start = play.sync()
    _turn_off(play, i, start)
    play.note(("turn-away", STILL), start, i=i)


def turn_to(play: Play, i: int) -> None:
    """i, who looks elsewhere, turns round to the other."""
    start = play.sync()
    play.people[i].hold(6)
    play.people[i].turn(play.off(i))
    play.note(("turn-to", STILL), start, i=i)


def step_back(play: Play, i: int) -> None:
    """i goes up a step and the other backs away; or i only steps back."""
    rng = play.rng
    start = play.sync()
    if play.gap < 1.6 or rng.random() < 0.5:
        walk = stride(rng, play.library, "walk-back", rng.uniform(0.5, 1.2))
        play.people[i].perform(walk.motion)
        play.note(("step-back", STILL), start, i=i, styles=(walk.style, "normal"))
        return
    close_in(play, i, max(play.gap - rng.uniform(0.5, 0.8), 0.7))
    walk = stride(rng, play.library, "walk-back", rng.uniform(0.5, 1.2))
    play.people[1 - i].perform(walk.motion)
    play.note(("step-forward", "step-back"), start, i=i, relation="reply", styles=("normal", walk.style))


def step_aside(play: Play, i: int) -> None:
    """i steps to a side."""
    rng = play.rng
    start = play.sync()
    side = pick(rng, ("left", "right"))
    walk = stride(rng, play.library, f"walk-{side}", rng.uniform(0.6, 1.1), side=side)
    step = walk.motion.root[-1] - walk.motion.root[0]
    course = wrapped(float(np.arctan2(step[0], step[2]) - walk.motion.headings.mean()))
    play.people[i].perform(walk.motion, aim=course - (1 if side == "left" else -1) * np.pi / 2)
    play.note(("step-aside", STILL), start, i=i, sides=(side, None))


def circle(play: Play, i: int) -> None:
    """i walks around the other, who stands or turns along."""
    rng = play.rng
    start = play.sync()
    own, other = play.people[i], play.people[1 - i]
    side = int(pick(rng, (-1, 1)))  # 1: the other is on the left hand
    radius = float(np.clip(play.gap, 0.85, 1.3))
    if abs(play.gap - radius) > 0.15:
        close_in(play, i, radius)
    own.turn(wrapped(bearing(other.spot - own.spot) - side * np.pi / 2 - own.angle))
    arc = rng.uniform(0.55, 1.05) * 2 * np.pi
    take = stride(rng, play.library, "walk", radius * arc, style=own.style)
    steps = np.linalg.norm(np.diff(take.motion.root[:, [0, 2]], axis=0), axis=-1)
    own.append(steer(take.motion, side / radius * np.concatenate([[0.0], np.cumsum(steps)])))
    follows = pick(rng, (False, True))
    if follows:
        other.hold_until(start + (len(own) - start) // 5)
        other.hold(int((len(own) - len(other)) * 0.9), turn=side * arc * 0.85)
    direction = "counterclockwise" if side > 0 else "clockwise"
    play.note(
        ("walk-around", "turn-to" if follows else STILL), start, i=i, styles=(take.style, "normal"), direction=direction
    )


def pace_about(play: Play, i: int) -> None:
    """i walks up and down while the other stands."""
    rng = play.rng
    start = play.sync()
    person = play.people[i]
    angle = play.people[i].angle + pick(rng, (-1, 1)) * np.pi / 2
    home = person.spot
    take = person.go(home + rng.uniform(1.0, 1.5) * ahead(angle), None, stop=False)
    person.go(home, None, stop=True)
    play.note(("pace", STILL), start, i=i, styles=(take.style, "normal"))


def follow(play: Play, i: int) -> None:
    """i goes off and the other comes after."""
    rng = play.rng
    start = play.sync()
    own, other = play.people[i], play.people[1 - i]
    runs = rng.random() < 0.25 and play.library.has("run")
    action = "run" if runs else "walk"
    way = own.angle + np.pi + rng.normal(0, 0.3) if abs(play.off(i)) < 1.2 else own.angle
    far = rng.uniform(2.6, 4.0) if runs else rng.uniform(2.0, 3.0)
    take = own.go(own.spot + far * ahead(way), None, action=action, stop=False)
    other.hold(play.seconds(0.1, 0.5))
    other.go(own.spot - rng.uniform(0.9, 1.3) * ahead(way), None, action=action, stop=False)
    acts = ("run-away", "chase") if runs else ("walk-away", "follow")
    play.note(acts, start, i=i, styles=(take.style, "normal"))


def side_by_side(play: Play, i: int, gap: float) -> tuple[float, int]:
    """The other comes to i's side and both look the same way; that heading, and the side (1: left)."""
    rng = play.rng
    own, other = play.people[i], play.people[1 - i]
    play.sync()
    way = own.angle + (pick(rng, (-1, 1)) * rng.uniform(0.5, 1.3) if abs(play.off(i)) < 1.2 else 0.0)
    side = 1 if np.dot(other.spot - own.spot, leftwards(way)) >= 0 else -1
    own.turn(wrapped(way - own.angle))
    way = own.angle
    other.go(own.spot + side * gap * leftwards(way), way)
    play.sync()
    other.hold(10, turn=wrapped(way - other.angle), shift=own.spot + side * gap * leftwards(way) - other.spot)
    play.sync()
    return way, side


def abreast(play: Play, i: int, gap: float, length: tuple[float, float]) -> tuple[int, int, Take, int]:
    """Both walk side by side, in step; (first frame, last frame, walk, side of the other: 1 left)."""
    rng = play.rng
    own, other = play.people[i], play.people[1 - i]
    _, side = side_by_side(play, i, gap)
    start = play.frames
    take = stride(rng, play.library, "walk", rng.uniform(*length), style=own.style)
    frames = len(take.motion)
    turn = (pick(rng, (-1, 1)) * rng.uniform(0.2, 1.4) if rng.random() < 0.5 else 0.0) * ease(frames)
    steps = np.linalg.norm(np.diff(take.motion.root[:, [0, 2]], axis=0), axis=-1)
    # Who walks outside goes the longer way.
    scale = np.clip(1 + np.append(np.diff(turn), 0.0) * -side * gap / np.maximum(np.append(steps, 1.0), 0.01), 0.5, 1.5)
    own.append(steer(take.motion, turn), blend=12)
    other.append(steer(tempo(take.motion, scale), turn), blend=12)
    return start, play.frames, take, side


def walk_together(play: Play, i: int) -> None:
    """Side by side, with or without talk; or one stops while the other goes on."""
    rng = play.rng
    begun = play.sync()
    start, stop, take, _ = abreast(play, i, rng.uniform(0.65, 0.95), (2.2, 3.2 if play.brisk else 4.0))
    own, other = play.people[i], play.people[1 - i]
    style = (take.style, take.style)
    if start - begun > 35:
        play.note(("join-side", STILL), begun, end=start, i=1 - i, minor=True)
    kind = rng.random()
    if kind < 0.3 and stop - start > 66:  # i stops, the other goes on
        cut = start + int((stop - start) * rng.uniform(0.4, 0.6))
        own.motion = own.motion[: cut + 8]
        play.note(("walk-together", "walk-together"), start, end=cut, i=i, styles=style)
        own.hold_until(len(other))
        play.note((STILL, "walk-ahead"), cut, i=i, styles=style)
        return
    if kind < 0.65 and play.library.has("guide"):  # talking while strolling
        who = i if rng.random() < 0.6 else 1 - i
        speaker = play.people[who]
        speaker.motion, _ = arms_over(play.library, rng, speaker.motion, pick(rng, spoken(play)), start + 12, None)
        play.look(who, start, stop, 0.6)
        acts = ("walk-together+talk", "walk-together") if who == i else ("walk-together", "walk-together+talk")
        play.note(acts, start, i=i, styles=style)
        return
    play.note(("walk-together", "walk-together"), start, i=i, styles=style)


_SAID = {"wave": "wave", "bye": "wave", "raise-hand": "raise-arm"}
"""The entry of a source action whose arms are laid over a walk."""


def walk_and(play: Play, i: int) -> None:
    """i walks away or up and waves, talks or raises a hand meanwhile."""
    rng = play.rng
    start = play.sync()
    own, other = play.people[i], play.people[1 - i]
    ways = [n for n in ("wave", "wave", "bye", "raise-hand") if play.library.has(n)]
    over = pick(rng, ways)
    up = play.gap > 2.2
    side = pick(rng, ("left", "right")) if over != "bye" else None
    if up:
        axis = (own.spot - other.spot) / max(play.gap, 1e-6)
        take = own.go(other.spot + rng.uniform(0.9, 1.3) * axis, bearing(-axis), stop=False)
    else:
        take = stride(rng, play.library, "walk-back", rng.uniform(1.2, 1.9))
        own.perform(take.motion)
    # The hand is up while the person walks, not only after it.
    length = len(own) - start
    own.hold(14)
    own.motion, gesture = arms_over(play.library, rng, own.motion, over, start, side, most=length)
    play.note(
        (f"{'walk-up' if up else 'step-back'}+{_SAID[over]}", STILL),
        start,
        i=i,
        sides=(gesture.side, None),
        styles=(take.style, "normal"),
    )
