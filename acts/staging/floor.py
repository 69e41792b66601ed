"""The floor of a beat: the moves of two people as places and headings over time.

The floor is seen from above, in metres of the scene's world; headings are radians from +Z towards +X. Places of a
walk are given every few frames, and of somebody who stays once a second; where people touch, the way is left free.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from motion import FPS
from motion.vectors import Array, bearing, direction, travelled, wrapped

from .places import ABEAM, EASE, MOST, TURNING, Standing, Track, Way2D, between, eased, sampled, smoothed
from .score import DODGES, IN_PLACE, Move, Way
from .window import REACHES

CLOSE = 0.9
"""Metres from each other at which people who walk up to each other are left to the network."""
NEAR_BY = 0.6
"""Metres from the other at which one who came up behind them stands."""
ABREAST = 0.9
"""Metres between two people who walk side by side."""
LINKED = 0.6
"""Metres between two people who walk hand in hand or arm in arm."""
BEHIND = 1.2
"""Metres by which one follows the other."""
ASIDE = 0.7
"""Metres beside the other at which one walks past."""
ACROSS = 1.3
"""Metres that somebody walks to a thing, for which they turn from the other."""
BACKWARDS = 0.9
"""Metres of a step back, at most."""
CREEPS = 0.8
"""Metres a second up to which somebody creeps, limps or crawls, who has not as far to go."""
RUN = 1.6
"""Metres a second from which somebody runs, who gets up their speed within a step."""
SIDESTEP = 0.8
"""Metres of a step aside."""
PACED = 1.1
"""Metres to either side that somebody walks to and fro."""
WIDE = 0.9
"""Radius in metres of a walk around the other, at least."""
SEAT = 0.4
"""Metres from where somebody stands back to the middle of the seat on which they sit down."""
_HALF_ROUND = 1.15 * math.pi
"""Radians that somebody gets round the other at least, however slowly they walk."""
FARTHEST = 5.0
"""Metres apart to which people walk; the training scenes hold next to nothing beyond."""
_CHASED = 7.0
"""Metres that somebody goes who is followed."""
_REACTS = 0.4
"""Seconds after which somebody follows who walks away."""
_ROUND_BEHIND = 0.55
"""Share of a beat that a walk round the other to their back takes at most: what is done there follows."""
_WEIGHT = {"stay": 0.4, "averted": 0.6, "turn": 0.5, "face": 0.4, "back": 0.7, "aside": 0.7}
"""Shares of a beat's time that moves take beside a walk."""


def plan(
    moves: Sequence[Move], standing: Standing, frames: int, *, first: bool = False, seats: Sequence[Array] = ()
) -> list[Way2D]:
    """The ways of both people through a beat of so many frames, from where they stand, round seats at places (2,).

    A person without moves has no way. In a ``first`` beat the ways also say where the two begin.
    """
    tracks = [
        Track(
            np.asarray(standing.places[i], dtype=float),
            float(standing.headings[i]),
            np.full((frames, 2), np.nan),
            np.full(frames, np.nan),
            seats=list(seats),
        )
        for i in range(2)
    ]
    own = [[move for move in moves if move.person == person] for person in "ab"]
    for who in (0, 1) if not any(m.way in ("after", "face", *DODGES) for m in own[0]) else (1, 0):
        _walked(who, own, tracks, standing)
    if first:
        for who, track in enumerate(tracks):
            track.places[0], track.headings[0] = standing.places[who], standing.headings[who]
    return [way for who, track in enumerate(tracks) if (way := sampled(who, track, first=first)) is not None]


def _walked(who: int, own: Sequence[Sequence[Move]], tracks: Sequence[Track], standing: Standing) -> None:
    """Lays out the moves of one person in order."""
    track, theirs = tracks[who], [move.way for move in own[1 - who]]
    listed = list(own[who])
    for i, move in enumerate(listed):
        if track.left() <= 0.1:
            return
        if move.late and i == 0:
            track.frame = round(0.35 * track.left() * FPS)
        later = [after.way for after in listed[i + 1 :]]
        if move.way == "turn" and ("away" in later or "past" in later):
            continue  # a person walking away has turned
        if move.way == "turn" and "face" in later and "around" in theirs:
            continue  # they turn as the other goes round them
        if move.way == "to" and "past" in later:
            continue  # who walks past comes up on the way
        seconds = track.left() * _WEIGHT.get(move.way, 1.0)
        seconds /= _WEIGHT.get(move.way, 1.0) + sum(_WEIGHT.get(way, 1.0) for way in later)
        if move.until:
            seconds *= 0.55
        if move.way in IN_PLACE and later and later[0] in DODGES and tracks[1 - who].dense:  # they are touched first
            seconds = (max(tracks[1 - who].dense) + REACHES) / FPS
        _moved(move, who, tracks, standing, theirs, seconds, last=not later)
    if track.frame and listed and listed[-1].way in ("away", "back", "past", "around", "along"):
        track.stay()


def _moved(
    move: Move,
    who: int,
    tracks: Sequence[Track],
    standing: Standing,
    theirs: Sequence[Way],
    seconds: float,
    *,
    last: bool,
) -> None:
    """Lays out one move; after the ``last`` one of a beat a person stays where they are."""
    track, here = tracks[who], tracks[who].place
    other = tracks[1 - who].at(track.frame, standing.places[1 - who])
    gap = float(np.linalg.norm(other - here))
    to = (other - here) / gap if track.frame and gap > 0.3 else standing.towards(who)
    both = move.way in theirs
    match move.way:
        case "stay" | "back to back" | "averted":
            track.halt(standing.speeds[who])
            watched = any(way in theirs for way in ("turn", "face", "behind", "beside", "away"))
            track.stay(None if seconds >= track.left() else seconds, facing=watched or move.way != "stay")
        case "thing":
            if direction(track.heading) @ to > ABEAM:  # it is not where the other stands
                far = min(ACROSS, 0.6 * seconds * move.speed)
                line = np.stack([here, here - far * to])
                track.walk(line, _time(far, move.speed, 0.7 * seconds))
            track.stay(facing=True)
        case "turn":
            track.turn(2 * math.pi * move.turns * move.sense)
            track.stay(facing=True, seconds=None if last else 0.2)
        case "face" if last and "around" in theirs and tracks[1 - who].frame > track.frame:
            track.watch(tracks[1 - who])
        case "face":
            track.turn(wrapped(bearing(other - here) - track.heading))
            track.stay(facing=True, seconds=None if last else 0.2)
        case "behind" | "beside":
            faces = tracks[1 - who].faces(track.frame, standing.headings[1 - who])
            _behind(move, track, other, faces, seconds)
        case "to":
            _to(move, track, gap, to, seconds, both=both, last=last)
        case "away":
            _away(move, track, gap, to, seconds, both=both, followed="after" in theirs)
        case "back" | "aside":
            track.halt(standing.speeds[who])
            here, seconds = track.place, min(seconds, track.left())
            far = min(move.metres, move.speed * seconds) if move.metres else min(BACKWARDS, 0.6 * seconds)
            step = -far * to if move.way == "back" else move.sense * SIDESTEP * np.array([to[1], -to[0]])
            taken = min(seconds, max(1.3, float(np.linalg.norm(step)) / move.speed + EASE))
            faces = bearing(to) if direction(track.heading) @ to > -ABEAM else track.heading  # or pushed from behind
            track.walk(np.stack([here, here + step]), taken, heading=faces)
            track.stay(facing=True, seconds=None if last else 0.2)
        case "past":
            _past(move, track, other, to, seconds)
        case "ahead":
            room = gap + BACKWARDS if "back" in theirs else gap
            _ahead(move, track, room, to, seconds, last=last)
        case "to and fro":
            _to_and_fro(track, to, seconds)
        case "around":
            _around(move, track, other, seconds, both, standing)
        case "hold" | "spar":
            _in_hold(move, track, standing, seconds)
        case "along":
            _along(who, move, track, standing, seconds)
        case "after":
            _after(move, track, tracks[1 - who], standing.places[1 - who], seconds)


def _to(move: Move, track: Track, gap: float, to: Array, seconds: float, *, both: bool, last: bool) -> None:
    """A walk up to the other, or halfway where both come."""
    near = move.near or CLOSE
    way = (gap - near) / (2 if both else 1)
    if way > (0.05 if move.near else 0.25):
        line = np.stack([track.place, track.place + way * to])
        if move.sits:
            track.seats = [*track.seats, line[-1] - SEAT * to]
        track.walk(line, _time(way, move.speed, seconds))
    if last:
        track.stay(facing=bool(move.near))


def _behind(move: Move, track: Track, other: Array, faces: float, seconds: float) -> None:
    """A walk up to the other's back, or side, round them where they stand in the way, that ends facing as they do."""
    near, out = move.near or NEAR_BY, track.place - other
    start, ends = bearing(out), faces + math.pi
    if move.way == "beside":  # the nearer one
        ends = min((faces + math.pi / 2, faces - math.pi / 2), key=lambda side: abs(wrapped(side - start)))
    goal = other + near * direction(ends)
    sweep = wrapped(ends - start)
    line = [track.place, goal]
    if abs(sweep) > (math.pi / 3 if move.way == "behind" else 0.6 * math.pi):
        wide = min(float(np.linalg.norm(out)), WIDE)
        line[1:1] = [other + wide * direction(start + share * sweep) for share in (0.4, 0.75)]
    if move.sits:
        track.seats = [*track.seats, goal - SEAT * direction(faces)]
    way = float(travelled(np.stack(line))[-1])
    if way > (0.05 if move.near else 0.25):
        most = seconds if len(line) == 2 else _ROUND_BEHIND * seconds
        if move.sits:  # they turn round there
            most = seconds - abs(wrapped(faces - bearing(line[-1] - line[-2]))) / math.pi * TURNING
        track.walk(smoothed(np.stack(line)), _time(way, move.speed, most))
    if abs(turn := wrapped(faces - track.heading)) > 0.1:
        track.turn(turn)
    track.stay(facing=True)


def _away(move: Move, track: Track, gap: float, to: Array, seconds: float, *, both: bool, followed: bool) -> None:
    """A walk away from the other, or on in the direction that the person was going in."""
    room = _CHASED if followed else (FARTHEST - gap + max(0.0, move.speed - 1.1)) / (2 if both else 1)
    away = -to if not np.linalg.norm(track.going) else track.going
    way = min(max(seconds - 0.4, 0.5) * move.speed, max(room, 1.2))
    facing = bearing(to) if move.backwards else None
    taken = min(seconds, way / move.speed + EASE if move.speed > RUN else way / (0.8 * move.speed) + 2 * EASE)
    track.walk(np.stack([track.place, track.place + way * away]), taken, heading=facing)


def _past(move: Move, track: Track, other: Array, to: Array, seconds: float) -> None:
    """A walk past the other, to one side of them."""
    here, gap = track.place, float(np.linalg.norm(other - track.place))
    ahead = direction(track.heading)
    if ahead @ to < ABEAM and not move.backwards:  # the other is beside or behind them: they walk on
        way = min(max(seconds - 0.4, 0.5) * move.speed, FARTHEST)
        track.walk(np.stack([here, here + way * ahead]), seconds)
        return
    beyond = max(1.3 if move.speed > CREEPS else 0.7, min(gap, seconds * move.speed - gap)) + move.metres
    aside = ASIDE * np.array([to[1], -to[0]])
    line = np.stack([here, here + 0.5 * gap * to + 0.7 * aside, other + aside, other + beyond * to + aside])
    facing = bearing(-to) if move.backwards else None
    track.walk(smoothed(line), min(seconds, (gap + beyond) / min(move.speed, MOST) + EASE), heading=facing)


def _ahead(move: Move, track: Track, gap: float, to: Array, seconds: float, *, last: bool) -> None:
    """A walk straight on, which ends before the other."""
    here = track.place
    ahead = direction(track.heading)
    most = gap - CLOSE if ahead @ to > 0.7 else FARTHEST
    way = min(move.metres, most, max(seconds - 0.2, 0.5) * move.speed)
    if way > 0.15:
        track.walk(np.stack([here, here + way * ahead]), min(seconds, way / move.speed + EASE))
    track.stay(facing=True, seconds=None if last else 0.2)


def _to_and_fro(track: Track, to: Array, seconds: float) -> None:
    """A walk to and fro across the line to the other."""
    middle, across, side = track.place, np.array([to[1], -to[0]]), 1.0
    ends = track.frame + seconds * FPS
    while track.left() > 1.0 and track.frame < ends - FPS:
        goal = middle + side * PACED * across
        way = float(np.linalg.norm(goal - track.place))
        track.walk(np.stack([track.place, goal]), way + EASE)
        side = -side


def _around(move: Move, track: Track, other: Array, seconds: float, both: bool, standing: Standing) -> None:
    """A walk around the other, or of both around the middle between them."""
    middle = standing.places.mean(axis=0) if both else other
    out = track.place - middle
    start, radius = bearing(out), float(np.linalg.norm(out))
    wanted = 2 * math.pi * move.turns * (1.1 if move.turns >= 1 else 1.5)
    end_radius = max(radius, WIDE / 2 if both else WIDE)
    speed = max(move.speed, 1.6) if move.speed > 0.9 else move.speed  # once around within the usual five seconds
    way = speed * max(seconds - 0.4, 0.5)
    if speed <= CREEPS and way < min(wanted, _HALF_ROUND) * radius:  # nearer to the other, to get round them
        end_radius = max(way / _HALF_ROUND, NEAR_BY)
    wanted = min(wanted, way / max((radius + end_radius) / 2 if end_radius > radius else end_radius, 0.4))
    angles = start + move.sense * np.linspace(0, wanted, 60)
    radii = radius + (end_radius - radius) * np.clip(np.linspace(0, 5, 60), 0, 1)
    line = middle + radii[:, None] * direction(angles)
    track.walk(line, seconds)


def _in_hold(move: Move, track: Track, standing: Standing, seconds: float) -> None:
    """The way of one of two who turn around the middle between them; in hold they face each other."""
    middle = standing.places.mean(axis=0)
    out = track.place - middle
    time = np.linspace(0, 1, max(round(seconds * FPS), 2))
    start, radius = bearing(out), float(np.linalg.norm(out))
    nearer = np.clip(time * seconds / 1.2, 0, 1)
    turned = 2 * math.pi * move.turns * seconds * eased(time, min(0.5, 1.5 / seconds))
    angles, radii = start + turned, radius + (move.near / 2 - radius) * nearer
    line = middle + radii[:, None] * direction(angles)
    begins, room = track.frame, len(track.places) - track.frame
    track.follow(line[:room], (angles + math.pi)[:room])
    if move.way == "spar":
        track.headings[begins : track.frame] = np.nan


def _along(who: int, move: Move, track: Track, standing: Standing, seconds: float) -> None:
    """A walk side by side: both turn into one direction across the line between them."""
    between = standing.towards(0)
    ahead = np.array([between[1], -between[0]])
    facing = direction(standing.headings[0]) + direction(standing.headings[1])
    if ahead @ facing < 0:
        ahead = -ahead
    middle = standing.places.mean(axis=0)
    side = between * ((LINKED if move.linked else ABREAST) / 2) * (-1 if who == 0 else 1)
    way = min(max(seconds - 0.4, 0.5) * move.speed, 7.0)
    line = np.stack([track.place, middle + side + min(0.8, 0.4 * way) * ahead, middle + side + way * ahead])
    taken = way / move.speed + EASE if move.speed > RUN else seconds
    track.walk(smoothed(line), min(seconds, taken))
    track.going = ahead


def _after(move: Move, track: Track, ahead: Track, start: Array, seconds: float) -> None:
    """A walk on the other's way, some steps behind them."""
    frames = min(round(seconds * FPS), len(track.places) - track.frame)
    first = track.frame
    theirs = np.stack([ahead.at(frame, start) for frame in range(first, first + frames)])
    line = np.concatenate([track.place[None], theirs])
    along = travelled(line)
    most = max(move.speed, MOST) / FPS
    done, gone = np.zeros(frames), 0.0
    for i in range(frames):
        if i > _REACTS * FPS:
            free = along[i + 1] - (move.near or BEHIND) - gone
            gone += float(np.clip(free, 0.0, most * min(1.0, (i / FPS - _REACTS) / EASE)))
        done[i] = gone
    if done[-1] > 0.25:
        track.follow(between(line, along, done))


def _time(way: float, speed: float, most: float) -> float:
    """Seconds in which a way is walked, at a run if there is little time."""
    return min(most, max(way / speed + EASE, way / MOST))
