"""Predicates on paths: walking, standing, turning, and relative places."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .joints import Array, Mask, Motion, keep, predicate

# ---- going and standing ----------------------------------------------------------------------------------
WALK = 0.3
"""Metres a second of the root from which a person is on the way."""


def _gained(m: Motion, rate: Array, metres: float, least: float) -> Mask:
    """Stretches with ``rate`` (m/s) above ``least`` that add up to ``metres``."""
    return keep(rate > least, m.fps, lambda i, j: rate[i:j].sum() / m.fps >= metres)


@predicate
def walks(m: Motion, who: int, metres: float = 0.8, speed: float = WALK) -> Mask:
    """On the way for ``metres`` at ``speed`` or more, in any direction."""
    return _gained(m, m.speeds[who], metres, speed)


@predicate
def runs(m: Motion, who: int, metres: float = 1.0, speed: float = 1.7) -> Mask:
    """Faster than people walk."""
    return walks(m, who, metres, speed)


@predicate
def stands(m: Motion, who: int, speed: float = 0.25) -> Mask:
    """The root stays where it is, for half a second or more; arms and trunk may move."""
    return keep(m.speeds[who] < speed, m.fps, lambda i, j: j - i >= 0.5 * m.fps, pause=0.1)


@predicate
def stays(m: Motion, who: int, metres: float = 0.6) -> Mask:
    """Never further than ``metres`` from where they began: all frames or none."""
    away = np.linalg.norm(m.roots[who] - m.roots[who][0], axis=-1).max()
    return np.full(m.frames, away < metres)


@predicate
def walks_to(m: Motion, who: int, metres: float = 0.5) -> Mask:
    """Goes ``metres`` or more towards the other."""
    return _gained(m, np.sum(m.velocities[who] * m.towards(who), axis=-1), metres, 0.2)


@predicate
def walks_away(m: Motion, who: int, metres: float = 0.9) -> Mask:
    """Goes ``metres`` or more away from the other, forwards or backwards."""
    return _gained(m, -np.sum(m.velocities[who] * m.towards(who), axis=-1), metres, 0.2)


@predicate
def backs(m: Motion, who: int, metres: float = 0.3) -> Mask:
    """Goes backwards by ``metres`` or more."""
    return _gained(m, -np.sum(m.velocities[who] * m.forward[who], axis=-1), metres, 0.12)


@predicate
def sidesteps(m: Motion, who: int, metres: float = 0.3) -> Mask:
    """Leaves the line on which the two stand, to either side, by ``metres`` or more."""
    line = m.towards(who)
    across = m.velocities[who][:, 0] * line[:, 1] - m.velocities[who][:, 1] * line[:, 0]
    return _gained(m, across, metres, 0.12) | _gained(m, -across, metres, 0.12)


@predicate
def steps_aside(m: Motion, who: int, way: str = "any", metres: float = 0.25) -> Mask:
    """Goes by ``metres`` or more to the body's own "left" or "right", or to either ("any"), and not ahead."""
    left = np.sum(m.velocities[who] * m.left(who), axis=-1)
    ahead = np.abs(np.sum(m.velocities[who] * m.forward[who], axis=-1))
    rates = {"left": left, "right": -left}
    masks = [
        _gained(m, np.where(rate > ahead, rate, 0.0), metres, 0.12)
        for name, rate in rates.items()
        if way in ("any", name)
    ]
    return np.logical_or.reduce(masks or [np.zeros(m.frames, dtype=bool)])


@predicate
def goes_way(m: Motion, who: int, way: str, metres: float = 0.3) -> Mask:
    """Goes by ``metres`` or more to the "left" or "right" of where the person first faced."""
    left = m.velocities[who] @ m.left(who)[0]
    return _gained(m, {"left": 1.0, "right": -1.0}[way] * left, metres, 0.12)


@predicate
def goes_metres(m: Motion, who: int, least: float, most: float) -> Mask:
    """One way of ``least`` to ``most`` metres."""
    speed = m.speeds[who]
    return keep(speed > 0.15, m.fps, lambda i, j: least <= speed[i:j].sum() / m.fps <= most, pause=0.4)


@predicate
def goes_at(m: Motion, who: int, least: float, most: float, metres: float = 0.6) -> Mask:
    """On the way for ``metres`` at a speed between ``least`` and ``most`` metres a second."""
    return _gained(m, np.where(m.speeds[who] < most, m.speeds[who], 0.0), metres, least)


@predicate
def goes_ahead(m: Motion, who: int, metres: float = 0.5) -> Mask:
    """Goes the way they face, by ``metres`` or more."""
    return _gained(m, np.sum(m.velocities[who] * m.forward[who], axis=-1), metres, 0.15)


@predicate
def wanders(m: Motion, who: int, metres: float = 0.6) -> Mask:
    """On the way for ``metres`` or more, and back to within half of the way from where it began: all or none."""
    gone = m.speeds[who][m.speeds[who] > WALK].sum() / m.fps
    net = np.linalg.norm(m.roots[who][-1] - m.roots[who][0])
    return np.full(m.frames, bool(gone >= metres and net < 0.5 * gone))


@predicate
def passes(m: Motion, who: int, metres: float = 0.4) -> Mask:
    """One walk that comes ``metres`` nearer to the other and then as far away again."""

    def by(i: int, j: int) -> bool:
        gap = m.distance[i:j]
        k = int(gap.argmin())
        return gap[0] - gap[k] >= metres and gap[-1] - gap[k] >= metres

    return keep(walks(m, who), m.fps, by, pause=0.4)


@predicate
def follows(m: Motion, who: int, metres: float = 0.7, away: float = 100.0) -> Mask:
    """Walks after the other, who walks ahead and faces ``away`` degrees or more away from this one."""
    other = 1 - who
    mine, theirs = m.velocities[who], m.velocities[other]
    line = m.towards(who)
    ahead = np.sum(theirs * line, axis=-1) > 0.15
    after = np.sum(mine * line, axis=-1) > 0.7 * m.speeds[who]
    mask = ahead & after & (m.speeds[who] > 0.2) & (m.off(other) >= away)
    return keep(mask, m.fps, lambda i, j: m.speeds[who][i:j].sum() / m.fps >= metres)


@predicate
def same_way(m: Motion, speed: float = WALK) -> Mask:
    """Both are on the way in one direction, give or take 45°."""
    a, b = m.velocities
    cos = np.sum(a * b, axis=-1) / np.maximum(m.speeds[0] * m.speeds[1], 1e-6)
    return (m.speeds[0] > speed) & (m.speeds[1] > speed) & (cos > 0.7)


@predicate
def beside(m: Motion) -> Mask:
    """Next to each other, looking the same way."""
    same = np.sum(m.forward[0] * m.forward[1], axis=-1) > 0.6
    aside = [(m.off(who) > 45) & (m.off(who) < 140) for who in (0, 1)]
    return same & aside[0] & aside[1] & (m.distance < 1.8)


@predicate
def orbits(m: Motion, who: int, degrees: float = 180.0, way: str = "any") -> Mask:
    """Goes around the other: their line turns by ``degrees`` or more while this one walks.

    Counter-clockwise, seen from above, is "left".
    """
    line = m.roots[who] - m.roots[1 - who]
    angle = np.degrees(np.unwrap(np.arctan2(line[:, 0], line[:, 1])))
    moving = (m.speeds[who] > 0.15) & (m.distance > 0.15)
    signs = {"left": (1.0,), "right": (-1.0,)}.get(way, (1.0, -1.0))

    def around(i: int, j: int) -> bool:
        return any(sign * (angle[j - 1] - angle[i]) >= degrees for sign in signs)

    return keep(moving, m.fps, around, pause=0.5)


# ---- where they are and where they look ------------------------------------------------------------------
@predicate
def near(m: Motion, metres: float) -> Mask:
    """The roots are closer than ``metres``."""
    return m.distance < metres


@predicate
def apart(m: Motion, metres: float) -> Mask:
    """The roots are further apart than ``metres``."""
    return m.distance > metres


@predicate
def faces(m: Motion, who: int, degrees: float = 50.0) -> Mask:
    """Looks towards the other, give or take ``degrees``."""
    return m.off(who) < degrees


@predicate
def faces_away(m: Motion, who: int, degrees: float = 110.0) -> Mask:
    """Turned ``degrees`` or more away from the other."""
    return m.off(who) > degrees


@predicate
def behind(m: Motion, who: int) -> Mask:
    """In the other's back."""
    return m.off(1 - who) > 110


_TURNS = 20.0
"""Degrees a second from which somebody turns."""


@predicate
def turns_way(m: Motion, who: int, way: str, degrees: float = 60.0) -> Mask:
    """Turns by ``degrees`` or more to the "left" or "right"; to either for every other way."""
    mask = np.zeros(m.frames, dtype=bool)
    for sign in {"left": (1.0,), "right": (-1.0,)}.get(way, (1.0, -1.0)):
        heading = sign * m.headings[who]
        turning = np.gradient(heading) * m.fps > _TURNS
        mask |= keep(turning, m.fps, lambda i, j: heading[j - 1] - heading[i] >= degrees, pause=0.4)  # noqa: B023
    return mask


@predicate
def turns(m: Motion, who: int, degrees: float = 90.0) -> Mask:
    """Turns by ``degrees`` or more, on the spot or on the way."""
    return turns_way(m, who, "any", degrees)


@predicate
def revolves(m: Motion, who: int, rounds: int = 1, way: str = "any") -> Mask:
    """Turns all the way around ``rounds`` times, give or take a third of a turn, to the "left", "right" or "any"."""
    heading = m.headings[who]
    rate = np.gradient(heading) * m.fps
    turning = {"left": rate > _TURNS, "right": rate < -_TURNS}.get(way, np.abs(rate) > _TURNS)

    def around(i: int, j: int) -> bool:
        return bool(abs(abs(heading[j - 1] - heading[i]) / 360 - rounds) < 0.34)

    return keep(turning, m.fps, around, pause=0.5)


@predicate
def turns_to(m: Motion, who: int, degrees: float = 60.0) -> Mask:
    """Turns by ``degrees`` or more, from looking elsewhere until they look at the other."""
    return _turned(m, who, degrees, lambda first, last: first > 60 > last and first - last > 0.7 * degrees)


@predicate
def turns_away(m: Motion, who: int, degrees: float = 60.0) -> Mask:
    """Turns by ``degrees`` or more, from looking at the other until they look elsewhere."""
    return _turned(m, who, degrees, lambda first, last: first < 60 and last > max(90, first + 0.7 * degrees))


def _turned(m: Motion, who: int, degrees: float, done: Callable[[float, float], bool]) -> Mask:
    """Turns by so many degrees, of which those from and to the other's direction say that they are done."""
    off, late = m.off(who), round(0.2 * m.fps)
    return keep(turns(m, who, degrees), m.fps, lambda i, j: done(off[i], off[min(j + late, m.frames) - 1]), pause=0.0)
