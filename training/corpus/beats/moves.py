"""Ways of two people: towards, away from, past, around, behind and beside each other."""

from __future__ import annotations

import numpy as np

from motion.vectors import bearing, direction, leftwards, travelled, wrapped

from ..compose import Array, ease, steer
from ..cues import STILL
from ..library import Take, pick, stride
from .acts import ACTS, SPOKEN, arms_over, one_of
from .play import Play


def gait(play: Play, *, fast: float = 0.15) -> str:
    """The source action of a way to go: "run", as often as ``fast``, "sneak" or "walk"."""
    rng = play.rng
    if play.library.has("run") and rng.random() < fast:
        return "run"
    return "sneak" if play.library.has("sneak") and rng.random() < 0.05 else "walk"


def off_from(play: Play, i: int) -> float:
    """The heading of a person who goes away from the other."""
    own = play.people[i]
    return own.angle + (np.pi + play.rng.normal(0, 0.35) if abs(play.off(i)) < 1.2 else 0.0)


def rounded(take: Take, radius: float) -> Array:
    """(T,) radians by which a walk has turned that goes round a point: to the left for a radius above 0, in metres."""
    return travelled(take.motion.root[:, [0, 2]]) / radius


def sideways(play: Play, metres: float) -> tuple[Take, float]:
    """Steps to a side, and the ``aim`` at which they are level with a person's front."""
    side = pick(play.rng, ("left", "right"))
    take = stride(play.rng, play.library, f"walk-{side}", metres, side=side)
    step = take.motion.root[-1] - take.motion.root[0]
    course = wrapped(float(np.arctan2(step[0], step[2]) - take.motion.headings.mean()))
    return take, course - (1 if side == "left" else -1) * np.pi / 2


def close_in(play: Play, i: int, distance: float, *, both: bool = False, action: str = "walk") -> Take | None:
    """The two come to stand ``distance`` metres apart, face to face; the walk of i, if any was needed."""
    start, own, other = play.begin(i)
    gap, axis = play.gap, own.spot - other.spot
    axis = axis / max(float(np.linalg.norm(axis)), 1e-6)
    towards = bearing(-axis)
    take = None
    if both and gap - distance > 1.4:
        middle = (own.spot + other.spot) / 2
        take = own.go(middle + axis * distance / 2, towards, action=action)
        other.go(middle - axis * distance / 2, towards + np.pi, action=action)
    else:
        if abs(distance - gap) > 0.08 or abs(play.off(i)) > 0.25:
            take = own.go(other.spot + axis * distance, towards, action=action)
        if abs(play.off(1 - i)) > 0.3:
            other.hold(max(min(len(own) - start - 40, 12), 0))
            other.turn(play.off(1 - i))
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


def come(play: Play, i: int, distance: float, *, action: str = "walk", minor: bool | None = None) -> int:
    """The two come to stand ``distance`` metres apart; a long way there is a beat of its own, often a ``minor`` one."""
    start, rng = play.sync(), play.rng
    far = play.gap - distance
    both = far > 1.6 and rng.random() < 0.3
    take = close_in(play, i, distance, both=both, action=action)
    if far > 0.5:
        sneaks = action == "sneak"
        cue = "walk-up" if sneaks else f"{action}-up"
        style = action if sneaks else take.style if take else "normal"
        known = {"minor": bool(rng.random() < 0.4) if minor is None else minor}
        play.note((cue, cue if both else STILL), start, i=i, styles=(style, "normal"), **known)
    return play.sync()


def walk_up(play: Play, i: int) -> None:
    """i comes up to the other, who stands; or both do."""
    come(play, i, play.rng.uniform(0.8, 1.3), action=gait(play, fast=0.25), minor=False)


_TO_LEAVING = (STILL, "wave", "wave", "beckon", "turn-away", "shake-head", "shrug", "point", STILL, *["follow"] * 3)


def leave(play: Play, i: int) -> None:
    """i turns and goes away; the other stays, with or without an answer, or comes after."""
    start, own, other = play.begin(i)
    rng, action, way = play.rng, gait(play), off_from(play, i)
    answer = pick(rng, _TO_LEAVING)
    if answer in ACTS and not play.library.has(*ACTS[answer].needs):
        answer = STILL
    stops = answer != "follow" and rng.random() < 0.6
    take = own.go(own.spot + rng.uniform(1.6, 3.0) * direction(way), None, action=action, stop=stops)
    side, style = None, "normal"
    if answer == "follow":
        other.hold(play.seconds(0.1, 0.5))
        other.go(own.spot - rng.uniform(0.9, 1.3) * direction(way), None, action=action, stop=False)
        answer = "chase" if action == "run" else "follow"
    elif answer != STILL:
        other.hold(play.seconds(0.3, 0.9))
        done = ACTS[answer].make(play, 1 - i)
        side, style = done.side, done.style
    play.note((f"{action}-away", answer), start, i=i, styles=(take.style, style), sides=(None, side))


def part(play: Play, i: int) -> None:
    """Both turn and go their ways."""
    start, rng = play.sync(), play.rng
    styles = []
    for k in (i, 1 - i):
        person = play.people[k]
        person.hold(int(rng.integers(0, 15)) * (k != i))
        far = rng.uniform(1.6, 2.6) * direction(off_from(play, k))
        styles.append(person.go(person.spot + far, None, stop=rng.random() < 0.5).style)
    play.note(("part", "part"), start, i=i, styles=tuple(styles))


def turn_round(play: Play, i: int) -> None:
    """i, who looks elsewhere, turns round to the other."""
    start, own, _ = play.begin(i)
    own.hold(6)
    ACTS["turn-to"].make(play, i)
    play.note(("turn-to", STILL), start, i=i)


def step_back(play: Play, i: int) -> None:
    """i goes up a step and the other backs away; or i only steps back."""
    start, rng = play.sync(), play.rng
    if play.gap < 1.6 or rng.random() < 0.5:
        play.note(("step-back", STILL), start, i=i, styles=(play.back_off(i, 0.5, 1.2).style, "normal"))
        return
    close_in(play, i, max(play.gap - rng.uniform(0.5, 0.8), 0.7))
    style = play.back_off(1 - i, 0.5, 1.2).style
    play.note(("step-forward", "step-back"), start, i=i, relation="reply", styles=("normal", style))


def step_aside(play: Play, i: int) -> None:
    """i steps to a side."""
    start, own, _ = play.begin(i)
    take, aim = sideways(play, play.rng.uniform(0.6, 1.1))
    own.perform(take, aim=aim)
    play.note(("step-aside", STILL), start, i=i, sides=(take.side, None))


def circle(play: Play, i: int) -> None:
    """i walks around the other, who stands or turns along."""
    start, own, other = play.begin(i)
    rng = play.rng
    side = int(pick(rng, (-1, 1)))  # 1: the other is on the left hand
    radius = float(np.clip(play.gap, 0.85, 1.3))
    if abs(play.gap - radius) > 0.15:
        close_in(play, i, radius)
    own.turn(wrapped(play.off(i) - side * np.pi / 2))
    arc = rng.uniform(0.55, 1.05) * 2 * np.pi
    take = stride(rng, play.library, "walk", radius * arc, style=own.style)
    own.append(steer(take.motion, rounded(take, side * radius)))
    follows = pick(rng, (False, True))
    if follows:
        other.hold_until(start + (len(own) - start) // 5)
        other.hold(int((len(own) - len(other)) * 0.9), turn=side * arc * 0.85)
    known = {"direction": "counterclockwise" if side > 0 else "clockwise", "styles": (take.style, "normal")}
    play.note(("walk-around", "turn-to" if follows else STILL), start, i=i, **known)


def pace_about(play: Play, i: int) -> None:
    """i walks up and down while the other stands."""
    start, own, _ = play.begin(i)
    home, way = own.spot, own.angle + pick(play.rng, (-1, 1)) * np.pi / 2
    take = own.go(home + play.rng.uniform(1.0, 1.5) * direction(way), None, stop=False)
    own.go(home, None, stop=True)
    play.note(("pace", STILL), start, i=i, styles=(take.style, "normal"))


def go_past(play: Play, i: int, spot: Array, aside: float, *, action: str = "walk") -> Take:
    """i goes past a spot, ``aside`` metres to the left of it, without stopping."""
    way = bearing(spot - play.people[i].spot)
    target = spot + aside * leftwards(way) + play.rng.uniform(0.3, 1.0) * direction(way)
    return play.people[i].go(target, None, action=action, stop=False)


def walk_past(play: Play, i: int) -> None:
    """Both go past each other without stopping, each on their own side."""
    start = play.sync()
    aside = pick(play.rng, (-1, 1)) * play.rng.uniform(0.8, 1.1)
    spots = [person.spot for person in play.people]
    styles = tuple(go_past(play, k, spots[1 - k], aside).style for k in (i, 1 - i))
    play.note(("walk-past", "walk-past"), start, i=i, styles=styles)


def skip_past(play: Play, i: int) -> None:
    """i skips past the other, who stands."""
    start, _, other = play.begin(i)
    go_past(play, i, other.spot, pick(play.rng, (-1, 1)) * play.rng.uniform(0.8, 1.1), action="skip")
    play.note(("skip", STILL), start, i=i)


def side_by_side(play: Play, i: int, gap: float) -> int:
    """The other comes to i's side and both look the same way; the side (1: left)."""
    _, own, other = play.begin(i)
    rng = play.rng
    way = own.angle + (pick(rng, (-1, 1)) * rng.uniform(0.5, 1.3) if abs(play.off(i)) < 1.2 else 0.0)
    side = 1 if np.dot(other.spot - own.spot, leftwards(way)) >= 0 else -1
    own.turn(wrapped(way - own.angle))
    play.settle(1 - i, own.spot + side * gap * leftwards(own.angle), own.angle, "join-side")
    return side


def abreast(play: Play, i: int, gap: float, length: tuple[float, float]) -> tuple[int, Take, int]:
    """Both walk side by side, in step; (first frame, walk, side of the other: 1 left)."""
    rng, own, other = play.rng, play.people[i], play.people[1 - i]
    side = side_by_side(play, i, gap)
    start = play.frames
    take = stride(rng, play.library, "walk", rng.uniform(*length), style=own.style)
    turn = (pick(rng, (-1, 1)) * rng.uniform(0.2, 1.4) if rng.random() < 0.5 else 0.0) * ease(len(take.motion))
    steps = np.append(np.diff(rounded(take, 1.0)), 1.0)
    # Who walks outside goes the longer way.
    pace = np.clip(1 - np.append(np.diff(turn), 0.0) * side * gap / np.maximum(steps, 0.01), 0.5, 1.5)
    own.append(steer(take.motion, turn), blend=12)
    other.append(steer(take.motion, turn, pace), blend=12)
    return start, take, side


def walk_together(play: Play, i: int) -> None:
    """Side by side, with or without talk; or one stops while the other goes on."""
    rng, own, other = play.rng, play.people[i], play.people[1 - i]
    start, take, _ = abreast(play, i, rng.uniform(0.65, 0.95), (2.2, 3.2 if play.brisk else 4.0))
    stop, kind, acts = play.frames, rng.random(), ["walk-together", "walk-together"]
    known = {"i": i, "styles": (take.style, take.style)}
    if kind < 0.3 and stop - start > 66:  # i stops, the other goes on
        cut = start + int((stop - start) * rng.uniform(0.4, 0.6))
        own.motion = own.motion[: cut + 8]
        play.note(("walk-together", "walk-together"), start, end=cut, **known)
        own.hold_until(len(other))
        start, acts = cut, [STILL, "walk-ahead"]
    elif kind < 0.65 and play.library.has("guide"):  # talking while strolling
        who = int(rng.random() < 0.4)
        speaker = (own, other)[who]
        speaker.motion, _ = arms_over(play.library, rng, speaker.motion, one_of(play, SPOKEN), start + 12, None)
        acts[who] += "+talk"
    play.note((acts[0], acts[1]), start, **known)


_SAID = {"wave": "wave", "bye": "wave", "raise-hand": "raise-arm"}
"""The entry of a source action whose arms are laid over a walk."""


def walk_and(play: Play, i: int) -> None:
    """i walks away or up and waves, talks or raises a hand meanwhile."""
    start, own, other = play.begin(i)
    rng = play.rng
    over = one_of(play, ("wave", "wave", "bye", "raise-hand"))
    up = play.gap > 2.2
    side = pick(rng, ("left", "right")) if over != "bye" else None
    if up:
        axis = (own.spot - other.spot) / max(play.gap, 1e-6)
        style = own.go(other.spot + rng.uniform(0.9, 1.3) * axis, bearing(-axis), stop=False).style
    else:
        style = play.back_off(i, 1.2, 1.9).style
    # The hand is up while the person walks, not only after it.
    length = len(own) - start
    own.hold(14)
    own.motion, gesture = arms_over(play.library, rng, own.motion, over, start, side, most=length)
    cue = f"{'walk-up' if up else 'step-back'}+{_SAID[over]}"
    play.note((cue, STILL), start, i=i, sides=(gesture.side, None), styles=(style, "normal"))
