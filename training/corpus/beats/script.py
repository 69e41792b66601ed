"""The order of beats: draws scenes of one to four beats that fit into their frames."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ..cues import STILL, Scene
from ..library import Library, pick
from ..telling import describe
from . import moves
from .acts import ACTS
from .play import Done, Option, Play, Rng
from .touching import TOUCH_BEATS

MOST = 300
"""Frames of a scene at most: ten seconds."""
COUNTS = (1, 2, 3, 4)
SHARES = (0.1, 0.3, 0.4, 0.2)
"""How many beats a scene is meant to have, and how often."""


FAR, CLOSE = (1.9, np.inf), (0.0, 2.4)


_ANSWERS = (
    "nod clap wave shake-head shrug bow point fold-arms arms-out raise-arm talk hands-on-hips jump make-fist "
    "cover-face wave-off rage dance hand-on-chest"
)
ANSWERS = _ANSWERS.split()


def solo(name: str) -> Callable[[Play, int], None]:
    """A beat in which i does something and the other answers, does the same, does something else, or watches."""

    def make(play: Play, i: int) -> None:
        start = _face(play, i)
        done = ACTS[name].make(play, i)
        answer, relation, second = _play_answer(play, 1 - i, _draw_answer(play, name), done)
        sides, styles = (done.side, second.side), (done.style, second.style)
        play.note((name, answer), start, i=i, relation=relation, sides=sides, styles=styles)

    return make


def _face(play: Play, i: int) -> int:
    """Turns person i to the other, most of the time; the frame at which the beat proper begins."""
    start = play.sync()
    if abs(play.off(i)) > 1.0 and play.rng.random() < 0.8:
        play.people[i].turn(play.off(i))
        if len(play.people[i]) - start > 25:
            play.note(("turn-to", STILL), start, i=i, minor=True)
            start = play.sync()
    return start


def _draw_answer(play: Play, name: str) -> str:
    """The other's answer to ``name``."""
    draw = play.rng.random()
    if draw < 0.28:
        return name
    if draw < 0.62:
        return pick(play.rng, [a for a in ANSWERS if a != name and play.library.has(*ACTS[a].needs)])
    if draw < 0.68:
        return "turn-away"
    return "turn-to" if draw < 0.72 else STILL


def _play_answer(play: Play, i: int, answer: str, done: Done) -> tuple[str, str, Done]:
    """Person i answers what the other has ``done``: the act that came of it, its relation, how it was done.

    An answer that does not fit where the two stand becomes :data:`STILL`.
    """
    rng, person = play.rng, play.people[i]
    if answer in ACTS and ACTS[answer].fits(play, i):
        relation = pick(rng, ("while", "reply", "reply", "order"))
        wait = {"while": done.start - 4, "reply": done.start + play.seconds(0.5, 1.3), "order": done.stop - 4}[relation]
        if relation != "while" and abs(play.off(i)) > 0.9:
            person.turn(play.off(i))
        person.hold_until(wait)
        return answer, relation, ACTS[answer].make(play, i)
    return STILL, "while", Done(0, 0)


MENU: dict[str, Option] = {
    **{name: replace(act, make=solo(name)) for name, act in ACTS.items()},
    **TOUCH_BEATS,
    "walk-up": Option(moves.walk_up, ("walk",), 9.0, FAR),
    "leave": Option(moves.leave, ("walk",), 11.0, CLOSE),
    "part": Option(moves.part, ("walk",), 3.0, CLOSE),
    "turn-to": replace(ACTS["turn-to"], make=moves.turn_round),
    "step-back": replace(ACTS["step-back"], make=moves.step_back),
    "step-aside": Option(moves.step_aside, ("walk-left", "walk-right"), 1.5),
    "walk-around": Option(moves.circle, ("walk",), 3.0, CLOSE),
    "pace": Option(moves.pace_about, ("walk",), 1.2),
    "walk-together": Option(moves.walk_together, ("walk",), 6.0),
    "walk-and": Option(moves.walk_and, ("walk", "walk-back", "wave"), 3.5),
    "walk-past": Option(moves.walk_past, ("walk",), 2.5, FAR),
    "skip": Option(moves.skip_past, ("skip",), 4.0, FAR),
}


def opening(rng: Rng, library: Library) -> Play:
    """Two people somewhere on the stage: face to face, far apart, one turned away, or side by side."""
    styles = [pick(rng, library.styles("walk")) if rng.random() < 0.6 else "normal" for _ in range(2)]
    if rng.random() < 0.5:
        styles[1] = styles[0]
    kind, spot, turns = rng.random(), (float(rng.normal(0, 0.08)), rng.uniform(0.9, 2.6)), [0.0, np.pi]
    if 0.45 <= kind < 0.8:
        spot = (spot[0], rng.uniform(2.4, 4.2))
    elif 0.8 <= kind < 0.92:
        turns[int(rng.integers(2))] += np.pi + rng.uniform(-0.4, 0.4)
    elif kind >= 0.92:
        spot, turns = (pick(rng, (-1, 1)) * rng.uniform(0.6, 0.9), 0.0), [0.0, 0.0]
    spots = (((0.0, 0.0), turns[0]), (spot, turns[1] + float(rng.normal(0, 0.08))))
    return Play(rng, library, spots, styles)


def compose(rng: Rng, library: Library, *, first: str | None = None) -> Scene:
    """A scene of one to four beats, of which each fits where the one before has left the two.

    Args:
        first: the beat to begin with; drawn otherwise.

    Raises:
        LookupError: where nothing fits.
    """
    play = opening(rng, library)
    play.hold(play.seconds(0.15, 0.5))
    wanted = int(rng.choice(COUNTS, p=SHARES))
    play.brisk = wanted > 2
    who = int(rng.integers(2))
    used: list[str] = []
    for turn in range(wanted):
        for _ in range(4):
            # Who acted goes on more often than not; the first beat may be either's.
            i = who if rng.random() < 0.6 else 1 - who
            name = first if turn == 0 and first else draw_beat(rng, play, i, used)
            if name is None:
                break
            longer = play.copied()
            MENU[name].make(longer, i)
            if longer.sync() <= MOST - 6 and longer.gap < 8.0:
                play, who = longer, i
                used.append(name)
                break
    if not play.beats:
        raise LookupError("nothing fits")
    play.hold(min(play.seconds(0.2, 0.5), MOST - play.sync()))
    return as_scene(rng, play)


def draw_beat(rng: Rng, play: Play, i: int, used: list[str]) -> str | None:
    """The name of a beat that fits, or None."""
    fitting = {
        name: option.weight
        for name, option in MENU.items()
        if name not in used and play.library.has(*option.needs) and option.fits(play, i)
    }
    weights = np.array([*fitting.values()])
    return str(rng.choice([*fitting], p=weights / weights.sum())) if fitting else None


def as_scene(rng: Rng, play: Play) -> Scene:
    """The finished scene with its captions."""
    positions, touches = play.finish(MOST)
    beats = [beat for beat in play.beats if beat.start < positions.shape[1] - 5]
    events: dict[str, Any] = {"contact": touches} if touches else {}
    family = f"beats-{min(sum(not beat.minor for beat in beats) or 1, 4)}"
    sources = tuple(sorted({source for person in play.people for source in person.motion.sources}))
    return describe(rng, Scene(positions.astype(np.float32), family, sources, play.library.split, events, played=beats))
