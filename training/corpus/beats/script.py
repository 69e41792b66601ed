"""The order of beats: draws scenes of one to four beats that fit into their frames."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from ..compose import Array
from ..cues import STILL, Scene
from ..library import Library, pick
from ..telling import describe
from . import joined, moves
from .acts import ACTS
from .play import Done, Play, Rng
from .stories import Pair, stories
from .touching import TOUCH_BEATS

MOST = 300
"""Frames of a scene at most: ten seconds."""
COUNTS = (1, 2, 3, 4)
SHARES = (0.1, 0.3, 0.4, 0.2)
"""How many beats a scene is meant to have, and how often."""


@dataclass(frozen=True)
class Option:
    """A beat that may come next.

    Attributes:
        make: (play, who begins).
        needs: source actions.
        weight: how often it is drawn.
        fits: whether it makes sense where the two stand now.
    """

    make: Callable[[Play, int], None]
    needs: tuple[str, ...]
    weight: float
    fits: Callable[[Play, int], bool] = lambda play, i: True


def _near(play: Play, i: int) -> bool:
    return play.gap < 4.5


def _far(play: Play, i: int) -> bool:
    return play.gap > 1.9


def _facing(play: Play, i: int) -> bool:
    return abs(play.off(i)) < 0.9


def _turned(play: Play, i: int) -> bool:
    return abs(play.off(i)) > 1.6


def _close(play: Play, i: int) -> bool:
    return play.gap < 2.4


_ANSWERS = (
    "nod clap wave shake-head shrug bow point fold-arms arms-out raise-arm talk hands-on-hips jump make-fist "
    "cover-face wave-off rage dance hand-on-chest"
)
ANSWERS = _ANSWERS.split()


def solo(name: str) -> Callable[[Play, int], None]:
    """A beat in which i does something and the other answers, does the same, does something else, or watches."""

    def make(play: Play, i: int) -> None:
        start = _face(play, i)
        draw = play.rng.random()
        if play.wish:
            need = max(ACTS[act].room for act in (name, play.wish[1]) if act in ACTS)
            moves.make_room(play, i, need + 0.1)
            start = play.sync()
        done = ACTS[name].make(play, i)
        answer, relation, second = _play_answer(play, 1 - i, _draw_answer(play, name, draw), done)
        play.note(
            (name, answer),
            start,
            i=i,
            relation=relation,
            sides=(done.side, second.side if second else None),
            styles=(done.style, second.style if second else "normal"),
        )

    return make


def _face(play: Play, i: int) -> int:
    """Turns person i to the other, most of the time; the frame at which the beat proper begins."""
    start = play.sync()
    if abs(play.off(i)) > 1.0 and (play.wish or play.rng.random() < 0.8):
        play.people[i].turn(play.off(i))
        if len(play.people[i]) - start > 25:
            play.note(("turn-to", STILL), start, i=i, relation="while", minor=True)
            start = play.sync()
    return start


def _draw_answer(play: Play, name: str, draw: float) -> str:
    """Draws the other's answer to ``name``: as the story wishes, or by ``draw`` from 0 to 1."""
    if play.wish:
        answer = play.wish[1]
        if answer in ACTS and not play.library.has(*ACTS[answer].needs):
            raise LookupError(f"no {answer}")
        return answer
    if draw < 0.28:
        return name
    if draw < 0.62:
        return pick(play.rng, [a for a in ANSWERS if a != name and play.library.has(*ACTS[a].needs)])
    if draw < 0.68:
        return "turn-away"
    return "turn-to" if draw < 0.72 else STILL


def _play_answer(play: Play, i: int, answer: str, done: Done) -> tuple[str, str, Done | None]:
    """Person i answers what the other has ``done``: the act that came of it, its relation, how it was done.

    An answer that does not fit where the two stand becomes :data:`STILL`.
    """
    rng, person = play.rng, play.people[i]
    if answer in ACTS and play.gap > ACTS[answer].room - (0.4 if play.wish else 0.0):
        relation = pick(rng, ("while", "reply", "reply", "order"))
        wait = {"while": done.start - 4, "reply": done.start + play.seconds(0.5, 1.3), "order": done.stop - 4}[relation]
        if relation != "while" and abs(play.off(i)) > 0.9:
            person.turn(play.off(i))
        person.hold_until(wait)
        return answer, relation, ACTS[answer].make(play, i)
    if answer == "turn-away" and abs(play.off(i)) < 1.0:
        person.hold_until(done.start + play.seconds(0.4, 1.0))
        person.turn(pick(rng, (-1, 1)) * rng.uniform(2.2, 3.1))
        play.look(i, done.start, len(person) + 30, 0.0)
        return answer, "reply", None
    if answer == "turn-to" and abs(play.off(i)) > 1.2:
        person.hold_until(done.start + play.seconds(0.2, 0.8))
        person.turn(play.off(i))
        return answer, "reply", None
    return STILL, "while", None


def _room(name: str) -> Callable[[Play, int], bool]:
    return lambda play, i: ACTS[name].room < play.gap < 5.0


MENU: dict[str, Option] = {
    **{name: Option(solo(name), act.needs, act.weight, _room(name)) for name, act in ACTS.items()},
    **{name: Option(make, needs, weight * 1.3, _near) for name, (make, weight, needs) in TOUCH_BEATS.items()},
    "walk-up": Option(moves.walk_up, ("walk",), 9.0, _far),
    "leave": Option(moves.leave, ("walk",), 8.0, _close),
    "part": Option(moves.part, ("walk",), 3.0, _close),
    "turn-away": Option(moves.turn_away, ("idle",), 2.0, _facing),
    "turn-to": Option(moves.turn_to, ("idle",), 9.0, _turned),
    "step-back": Option(moves.step_back, ("walk-back",), 2.5, _close),
    "step-aside": Option(moves.step_aside, ("walk-left", "walk-right"), 1.5, _near),
    "walk-around": Option(moves.circle, ("walk",), 3.0, _close),
    "pace": Option(moves.pace_about, ("walk",), 1.2, _near),
    "follow": Option(moves.follow, ("walk",), 3.0, _close),
    "walk-together": Option(moves.walk_together, ("walk",), 6.0, _near),
    "walk-and": Option(moves.walk_and, ("walk", "walk-back", "wave"), 3.5, _near),
    "walk-past": Option(joined.walk_past, ("walk",), 2.5, _far),
    "skip": Option(joined.skip_past, ("skip",), 4.0, _far),
}


APPROACHES = ("walk-up", "run-up", "creep-up", "walk-up+wave", "walk-up+raise-arm", "walk-past", "skip")
_CAUSES = ("push", "hand-over", "throw-ball", "punch", "kick", "help-up", "whisper")
"""Cues that the other's part follows from."""
_STAGED_BY: dict[str | Pair, str] = {
    **dict.fromkeys(("run-up", "creep-up"), "walk-up"),
    **dict.fromkeys(("walk-away", "run-away", "sneak-away"), "leave"),
    **dict.fromkeys(("walk-together+talk", (STILL, "walk-ahead")), "walk-together"),
    **dict.fromkeys(("shake-hands?", "high-five?", "hand-over?", "hug?"), "refused"),
    **dict.fromkeys(("walk-up+wave", "walk-up+raise-arm", "step-back+wave", "step-back+raise-arm"), "walk-and"),
    ("pat:shoulder", "turn-to"): "tap",
    "step-forward": "step-back",
    "hold-hands": "walk-hand-in-hand",
}
"""Which entry of the menu plays an act that is not an entry itself."""


def staged_by(acts: Pair) -> tuple[str, bool] | None:
    """(entry of the menu that plays a beat of these acts of A and B, whether B begins), or None."""
    for begins, (own, other) in ((False, acts), (True, acts[::-1])):
        if other in ("follow", "chase"):
            return "follow", begins
        if (other in _CAUSES and own not in _CAUSES) or (own == STILL and other not in (STILL, "walk-ahead")):
            continue
        name = _STAGED_BY.get((own, other)) or _STAGED_BY.get(own, own)
        if name in MENU:
            return name, begins
    return None


def opening(rng: Rng, library: Library, story: Sequence[Pair] = (), first: int = 0) -> Play:
    """Two people somewhere on the stage: face to face, far apart, one turned away, or side by side.

    Args:
        story: what they will do; they begin where that makes sense.
        first: who is A in the story.
    """
    kind = rng.random()
    if story:
        early = [act for acts in story[:2] for act in acts]
        kind = 0.3 + 0.7 * kind if kind < 0.85 else kind
        if any(act in APPROACHES for act in early):
            kind = 0.6
        elif "turn-to" in story[0]:
            kind = 0.85
        else:
            kind = 0.0 if kind < 0.9 else 0.95
    styles = [pick(rng, library.styles("walk")) if rng.random() < 0.6 else "normal" for _ in range(2)]
    if rng.random() < 0.5:
        styles[1] = styles[0]
    if kind < 0.45:
        gap, turns = rng.uniform(0.9, 2.6), (0.0, np.pi)
    elif kind < 0.8:
        gap, turns = rng.uniform(2.0, 3.0) if story else rng.uniform(2.4, 4.2), (0.0, np.pi)
    elif kind < 0.92:
        gap = rng.uniform(1.2, 2.6)
        turned = first if story and story[0][0] == "turn-to" else 1 - first if story else int(rng.integers(2))
        askew = rng.uniform(-0.4, 0.4)
        turns = (np.pi + askew, np.pi) if turned == 0 else (0.0, askew)
    else:
        gap, turns = 0.0, (0.0, 0.0)
    if gap:
        spots = (((0.0, 0.0), turns[0]), ((float(rng.normal(0, 0.08)), gap), turns[1] + rng.normal(0, 0.08)))
    else:
        aside = pick(rng, (-1, 1)) * rng.uniform(0.6, 0.9)
        spots = (((0.0, 0.0), 0.0), ((aside, 0.0), float(rng.normal(0, 0.08))))
    return Play(rng, library, spots, (styles[0], styles[1]))


def compose(rng: Rng, library: Library, *, first: str | None = None, told: float = 0.55) -> Scene:
    """A scene of beats.

    Args:
        first: the beat to begin with; drawn otherwise.
        told: how often the beats are those of a story.

    Raises:
        LookupError: where nothing fits.
    """
    if first is None and rng.random() < told:
        return tell(rng, library, draw_story(rng, library))
    play = opening(rng, library)
    _begin(play)
    wanted = int(rng.choice(COUNTS, p=SHARES))
    play.brisk = wanted > 2
    _improvise(play, wanted, first=first)
    if not play.beats:
        raise LookupError("nothing fits")
    return _ended(play)


def _begin(play: Play) -> None:
    for person in play.people:
        person.hold(play.seconds(0.15, 0.5))


def _ended(play: Play) -> Scene:
    for person in play.people:
        person.hold(min(play.seconds(0.2, 0.5), MOST - play.frames))
    return as_scene(play.rng, play, play.library.split)


def _improvise(play: Play, wanted: int, *, first: str | None = None) -> None:
    """Up to ``wanted`` beats that fit, drawn from the menu."""
    rng, who = play.rng, int(play.rng.integers(2))
    used: list[str] = []
    for turn in range(wanted):
        for _ in range(4):
            # Who acted goes on more often than not; the first beat may be either's.
            i = who if rng.random() < 0.6 else 1 - who
            name = first if turn == 0 and first else draw_beat(rng, play, i, used)
            if name is None:
                return
            state = play.snapshot()
            MENU[name].make(play, i)
            if play.sync() <= MOST - 6 and play.gap < 8.0:
                used.append(name)
                who = i
                break
            play.restore(state)


def draw_story(rng: Rng, library: Library) -> tuple[Pair, ...]:
    """The beats of a sentence, of two beats or more in three of four; stories with a rare act are drawn more often."""
    keys = _stories(library.split, tuple(sorted(name for name in MENU if library.has(*MENU[name].needs))))
    chosen = keys[rng.random() < 0.7]
    if not chosen:
        raise LookupError("no story fits the sources")
    weights = _rarity(chosen)
    return chosen[int(rng.choice(len(chosen), p=weights))]


@cache
def _rarity(chosen: tuple[tuple[Pair, ...], ...]) -> Array:
    """Shares of the stories among those drawn: the root of one over the number that have a story's rarest act."""
    cues = [{cue for acts in story for cue in acts} for story in chosen]
    count = Counter(cue for own in cues for cue in own)
    weights = np.array([1 / np.sqrt(min(count[cue] for cue in own)) for own in cues])
    return weights / weights.sum()


@cache
def _stories(split: str, menu: tuple[str, ...]) -> tuple[tuple[tuple[Pair, ...], ...], tuple[tuple[Pair, ...], ...]]:
    """Stories of one beat and of more whose beats are all on the menu."""
    found: tuple[list[tuple[Pair, ...]], list[tuple[Pair, ...]]] = ([], [])
    for story in stories():
        entries = [staged_by(acts) for acts in story]
        if all(entry and entry[0] in menu for entry in entries):
            found[len(story) > 1].append(story)
    return tuple(found[0]), tuple(found[1])


def tell(rng: Rng, library: Library, story: Sequence[Pair]) -> Scene:
    """A scene of just these beats (acts of A and B), of which A is either of the two.

    Raises:
        LookupError: where it does not fit into the frames, or cannot be played.
    """
    a = int(rng.integers(2))
    play = opening(rng, library, story, a)
    play.brisk = len(story) > 2
    _begin(play)
    k = 0
    while k < len(story):
        acts = story[k]
        if k + 1 < len(story) and story[k + 1] == (STILL, "walk-ahead"):
            k += 1
            acts = story[k]
        entry = staged_by(acts)
        if entry is None:
            raise LookupError(f"nobody plays {acts}")
        name, swapped = entry
        play.wish = acts[::-1] if swapped else acts
        MENU[name].make(play, 1 - a if swapped else a)
        done = play.beats[-1].acts if a == 0 else play.beats[-1].acts[::-1]
        if done != acts:
            raise LookupError(f"{acts} became {done}")
        if play.sync() > MOST - 4 or play.gap > 8.0:
            raise LookupError("too long")
        k += 1
    play.wish = None
    if len(story) < 3:  # a short story may be followed by more
        play.brisk = True
        _improvise(play, int(rng.integers(0, 4 - len(story))))
    return _ended(play)


def draw_beat(rng: Rng, play: Play, i: int, used: list[str]) -> str | None:
    """The name of a beat that fits, or None."""
    open_names = [
        name
        for name, option in MENU.items()
        if name not in used and play.library.has(*option.needs) and option.fits(play, i)
    ]
    if not open_names:
        return None
    weights = np.array([MENU[name].weight for name in open_names])
    return open_names[int(rng.choice(len(open_names), p=weights / weights.sum()))]


def as_scene(rng: Rng, play: Play, split: str) -> Scene:
    """The finished scene with its captions."""
    positions, touches = play.finish(MOST)
    frames = positions.shape[1]
    beats = [beat for beat in play.beats if beat.start < frames - 5]
    events: dict[str, Any] = {"contact": touches} if touches else {}
    family = f"beats-{min(sum(not beat.minor for beat in beats) or 1, 4)}"
    return describe(rng, Scene(positions.astype(np.float32), family, play.sources(), split, events, played=beats))
