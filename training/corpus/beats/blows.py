"""Beats in which one strikes, pushes, offers or throws something, and the other gives way, refuses or catches it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..compose import Array
from ..contact import axes, envelope, impulse, lean_to, nod, on_body, reach, reach_arm, towards
from ..cues import STILL
from ..library import pick, stride
from ..touches import Touches, chosen_side
from .acts import ACTS, blow, dodge, recoil
from .acts import reach as reach_of
from .moves import close_in, come
from .play import Play

FALL = "fall-down>stand-up"


def push(play: Play, i: int) -> None:
    """i pushes the other with both hands, who stumbles or falls."""
    rng = play.rng
    start = come(play, i, rng.uniform(0.53, 0.62))
    hit = int(rng.integers(16, 22))
    own, other = play.people[i], play.people[1 - i]
    own.hold(hit + 34)
    other.hold(hit + 6)
    falls = play.library.has("fall", "get-up-back")
    answer = play.wanted(("stumble", "stumble", FALL), 1) if falls else "stumble"
    if answer == FALL:
        ACTS[FALL].make(play, 1 - i)
    else:
        other.perform(stride(rng, play.library, "walk-back", rng.uniform(0.5, 1.3)).motion)
    depth, leaning = rng.uniform(0.25, 0.4) * (0.5 if answer == FALL else 1.0), rng.uniform(0.12, 0.25)

    def effect(a: Array, b: Array) -> tuple[Array, Array, Touches]:
        frames = len(a)
        line = towards(a[:, 0], b[:, 0])
        give = impulse(frames, hit - 1, rise=7, fall=24) * depth
        stood = b
        b = nod(lean_to(b, line, give), give * 0.6)
        weight = envelope(frames, hit - 15, hit - 1, hit + 4, hit + 24)
        a = lean_to(a, line, envelope(frames, hit - 10, hit + 2, hit + 4, hit + 26) * leaning)
        still = stood[min(hit + 2, frames - 1)][None].repeat(frames, axis=0)
        seen = np.where((np.arange(frames) > hit + 2)[:, None, None], still, stood)
        chest = {
            side: on_body(seen, "spine3", 0.11 * sign, 0.02, 0.13) + 0.1 * line * give[:, None]
            for side, sign in (("left", -1), ("right", 1))
        }
        drawn = 1 - envelope(frames, hit - 10, hit, hit + 30, hit + 31)
        chest = {side: point - 0.14 * line * drawn[:, None] for side, point in chest.items()}
        a = reach(a, chest, weight, elbow=(0.8, -0.9, -0.2))
        return a, b, [(f"{side}_wrist", "spine3", hit - 2, hit + 3) for side in ("left", "right")]

    play.effect(start, start + hit + 36, effect, i=i)
    play.note(("push", answer), start, i=i, sides=("both", None))


def blow_at(name: str) -> Callable[[Play, int], None]:
    """A blow in the air in front of the other, who gives way: recoil, dodge or retreat."""

    def make(play: Play, i: int) -> None:
        rng = play.rng
        take = blow(rng, play.library, name, most=1)
        start = play.sync()
        answers = {"punch": ("dodge", "flinch", "step-back", FALL), "kick": ("step-back", "flinch", FALL)}
        answer = play.wanted(answers[name], 1)
        if answer == FALL and not play.library.has("fall", "get-up-back"):
            answer = "flinch"
        far = play.gap
        close_in(play, i, reach_of(take) + rng.uniform(0.1, 0.25))
        begun = play.sync()
        if far - play.gap > 0.6:
            play.note_span(("walk-up", STILL), start, begun, i=i, relation="while", minor=True)
        own, other = play.people[i], play.people[1 - i]
        first, _ = own.perform(take.motion, aim=take.aim)
        hit = first + take.peaks[0]
        if answer == "step-back":
            other.hold_until(max(hit - 12, len(other)))
            other.perform(stride(rng, play.library, "walk-back", rng.uniform(0.5, 1.1)).motion)
        elif answer == FALL:
            other.hold_until(max(hit - 2, len(other)))
            ACTS[FALL].make(play, 1 - i)
        else:
            other.hold_until(max(len(own), hit + 34))
            other.motion = (dodge if answer == "dodge" else recoil)(rng, other.motion, hit)
        play.note((name, answer), begun, i=i, sides=(take.side, None))

    return make


# ---- offers and throws ---------------------------------------------------------------------------


_OFFERS = {
    "shake-hands?": (0.95, (-0.02, -0.34, 0.46)),
    "high-five?": (0.92, (0.02, 0.22, 0.36)),
    "hand-over?": (1.0, (-0.06, -0.2, 0.46)),
    "hug?": (0.95, (0.34, -0.06, 0.3)),
}
"""Offers that can be refused: metres apart, and where the hand goes from its shoulder: out, up, ahead."""


_REFUSALS = (STILL, "shake-head", "turn-away", "step-back", "fold-arms", "stop-hand")
"""Answers to an offer that leave it where it is."""


def refused(play: Play, i: int) -> None:
    """i offers a hand, a high five, a thing or a hug, and the other does not take it."""
    rng = play.rng
    offer = play.wanted(tuple(_OFFERS))
    distance, (out, up, front) = _OFFERS[offer]
    start = come(play, i, rng.uniform(distance, distance + 0.15))
    side, _ = chosen_side(rng)
    sides = ("left", "right") if offer == "hug?" else (side,)
    answers = [*_REFUSALS, "wave-off"] if play.library.has("reject") else list(_REFUSALS)
    wish = play.wish[1] if play.wish else ""
    answer = wish if wish in answers else pick(rng, answers)
    other = play.people[1 - i]
    other.hold(play.seconds(0.7, 1.2))
    if answer == "turn-away":
        other.turn(pick(rng, (-1, 1)) * rng.uniform(2.0, 3.0))
        play.look(1 - i, start + 20, len(other) + 40, 0.0)
    elif answer == "step-back":
        other.perform(stride(rng, play.library, "walk-back", rng.uniform(0.4, 0.9)).motion)
    elif answer != STILL:
        ACTS[answer].make(play, 1 - i)
    play.people[i].hold_until(max(len(other) + 10, start + 66))
    stop = play.sync()
    leave = stop - start - 26

    def effect(a: Array, b: Array) -> tuple[Array, Array, Touches]:
        weight = envelope(len(a), 2, 20, leave, leave + 22)
        for hand in sides:
            sign = 1.0 if hand == "left" else -1.0
            a = reach_arm(a, hand, on_body(a, f"{hand}_shoulder", sign * out, up, front), weight)
        return a, b, []

    play.effect(start, stop, effect, i=i)
    play.note((offer, answer), start, i=i, sides=(None if len(sides) > 1 else side, None))


def throw_catch(play: Play, i: int) -> None:
    """i throws something, the other catches it with both hands."""
    rng = play.rng
    start = play.sync()
    if not 1.6 < play.gap < 4.0 or abs(play.off(i)) > 0.3 or abs(play.off(1 - i)) > 0.3:
        close_in(play, i, float(np.clip(play.gap, 1.8, 3.0)))
        start = play.sync()
    take = play.library.take(rng, "throw", frames=(40, 90))
    own = play.people[i]
    first, last = own.perform(take.motion)
    caught = first - start + int(0.62 * len(take.motion)) + int(8 * play.gap / 2)
    play.people[1 - i].hold_until(max(last, start + caught + 40))

    def effect(a: Array, b: Array) -> tuple[Array, Array, Touches]:
        weight = envelope(len(b), max(caught - 20, 0), caught, caught + 6, caught + 34)
        drawn = envelope(len(b), caught, caught + 14, len(b), len(b) + 1)
        for side, sign in (("left", 1.0), ("right", -1.0)):
            goal = on_body(b, "spine3", 0.08 * sign, 0.0, 0.42) - 0.2 * axes(b)[1] * drawn[:, None]
            b = reach_arm(b, side, goal, weight, elbow=(0.7, -0.8, 0.0))
        return a, b, []

    stop = play.sync()
    play.effect(start, stop, effect, i=i)
    play.note(("throw-ball", "catch-thing"), start, i=i, sides=(take.side, None))
