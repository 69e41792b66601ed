"""Beats in which one strikes, pushes or throws something to the other, in which the two touch or go joined."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from motion.skeleton import OTHER_SIDE
from motion.vectors import direction, leftwards, wrapped

from .. import touches
from ..compose import Array, steer
from ..contact import ELBOW_DOWN, axes, envelope, impulse, lean_to, nod, on_body, reach, reach_arm, towards
from ..cues import STILL
from ..library import pick
from ..touches import HandOn, Rng, Slap, Touch, Touched, chosen_side
from .acts import ACTS, gives_way
from .acts import reach as reach_of
from .moves import abreast, close_in, come, rounded, side_by_side, sideways
from .play import Option, Play

FALL = "fall-down>stand-up"


def push(play: Play, i: int) -> None:
    """i pushes the other with both hands, who stumbles or falls."""
    rng = play.rng
    start = come(play, i, rng.uniform(0.53, 0.62))
    hit = int(rng.integers(16, 22))
    play.people[i].hold(hit + 34)
    play.people[1 - i].hold(hit + 6)
    falls = play.library.has("fall", "get-up-back") and rng.random() < 1 / 3
    if falls:
        ACTS[FALL].make(play, 1 - i)
    else:
        play.back_off(1 - i, 0.5, 1.3)

    def effect(rng: Rng, a: Array, b: Array) -> Touched:
        frames, line = len(a), towards(a[:, 0], b[:, 0])
        # The hands follow the chest as it was when they met it.
        met = on_body(b, "spine3", 0.0, 0.02, 0.13) + 0.1 * line
        met[hit + 2 :] = met[min(hit + 2, frames - 1)]
        give = impulse(frames, hit - 1, rise=7, fall=24) * rng.uniform(0.25, 0.4) * (0.5 if falls else 1.0)
        b = nod(lean_to(b, line, give), give * 0.6)
        a = lean_to(a, line, envelope(frames, hit - 10, hit + 2, hit + 4, hit + 26) * rng.uniform(0.12, 0.25))
        drawn = 1 - envelope(frames, hit - 10, hit, hit + 30, hit + 31)
        met = met - (0.14 * drawn + 0.1 * (1 - give))[:, None] * line
        hands = {side: met + sign * 0.11 * axes(a)[0] for side, sign in (("left", 1.0), ("right", -1.0))}
        a = reach(a, hands, envelope(frames, hit - 15, hit - 1, hit + 4, hit + 24), elbow=(0.8, -0.9, -0.2))
        return a, b, [(f"{side}_wrist", "spine3", hit - 2, hit + 3) for side in hands]

    play.effect(start, start + hit + 36, effect, i=i)
    play.note(("push", FALL if falls else "stumble"), start, i=i, relation="reply", sides=("both", None))


def blow_at(name: str, *answers: str) -> Callable[[Play, int], None]:
    """A blow in the air in front of the other, who gives way: recoil, dodge or retreat."""

    def make(play: Play, i: int) -> None:
        rng = play.rng
        take = play.library.take(rng, name, blows=1)
        answer = pick(rng, answers)
        if answer == FALL and not play.library.has("fall", "get-up-back"):
            answer = "flinch"
        start, own, other = play.begin(i)
        far = play.gap
        close_in(play, i, reach_of(take) + rng.uniform(0.1, 0.25))
        begun = play.sync()
        if far - play.gap > 0.6:
            play.note(("walk-up", STILL), start, end=begun, i=i, minor=True)
        hit = own.perform(take, aim=take.aim).start + take.peaks[0]
        if answer == "step-back":
            other.hold_until(hit - 12)
            play.back_off(1 - i, 0.5, 1.1)
        elif answer == FALL:
            other.hold_until(hit - 2)
            ACTS[FALL].make(play, 1 - i)
        else:
            play.effect(hit - 12, hit + 44, gives_way(12, dodges=answer == "dodge"), i=i)
            other.hold_until(hit + 34)
        play.note((name, answer), begun, i=i, relation="reply", sides=(take.side, None))

    return make


# ---- offers and throws ---------------------------------------------------------------------------


def _hands_at(
    body: Array,
    joint: str,
    at: tuple[float, float, float],
    sides: Sequence[str],
    weight: Array,
    drawn: Array | float = 0.0,
) -> Array:
    """Hands of a person beside a joint of theirs: metres outwards, up and ahead, where they are ``drawn`` in."""
    out, up, front = at
    for side in sides:
        goal = on_body(body, joint.format(side=side), out if side == "left" else -out, up, front - 0.2 * drawn)
        body = reach_arm(body, side, goal, weight, elbow=(0.6, -0.9, -0.1))
    return body


_OFFERS = {
    "shake-hands?": (0.95, (-0.02, -0.34, 0.46)),
    "high-five?": (0.92, (0.02, 0.22, 0.36)),
    "hand-over?": (1.0, (-0.06, -0.2, 0.46)),
    "hug?": (0.95, (0.34, -0.06, 0.3)),
}
"""Offers that can be refused: metres apart, and where the hand goes from its shoulder: out, up, ahead."""
_REFUSALS = (STILL, "shake-head", "turn-away", "step-back", "fold-arms", "stop-hand", "wave-off")
"""Answers to an offer that leave it where it is."""


def refused(play: Play, i: int) -> None:
    """i offers a hand, a high five, a thing or a hug, and the other does not take it."""
    rng, other = play.rng, play.people[1 - i]
    offer = pick(rng, tuple(_OFFERS))
    distance, at = _OFFERS[offer]
    start = come(play, i, rng.uniform(distance, distance + 0.15))
    sides = ("left", "right") if offer == "hug?" else (chosen_side(rng),)
    answer = pick(rng, _REFUSALS[: None if play.library.has("reject") else -1])
    other.hold(play.seconds(0.7, 1.2))
    if answer != STILL:
        ACTS[answer].make(play, 1 - i)
    play.people[i].hold_until(max(len(other) + 10, start + 66))
    stop = play.sync()

    def effect(rng: Rng, a: Array, b: Array) -> Touched:
        leave = stop - start - 26
        return _hands_at(a, "{side}_shoulder", at, sides, envelope(len(a), 2, 20, leave, leave + 22)), b, []

    play.effect(start, stop, effect, i=i)
    play.note((offer, answer), start, i=i, relation="reply", sides=(None if len(sides) > 1 else sides[0], None))


def throw_catch(play: Play, i: int) -> None:
    """i throws something, the other catches it with both hands."""
    close_in(play, i, float(np.clip(play.gap, 1.8, 3.0)))
    start, own, other = play.begin(i)
    done = own.perform(play.library.take(play.rng, "throw", frames=(40, 90)))
    caught = done.start - start + int(0.62 * (done.stop - done.start)) + int(8 * play.gap / 2)
    other.hold_until(max(done.stop, start + caught + 40))

    def effect(rng: Rng, a: Array, b: Array) -> Touched:
        weight = envelope(len(b), max(caught - 20, 0), caught, caught + 6, caught + 34)
        drawn = envelope(len(b), caught, caught + 14, len(b), len(b) + 1)
        return a, _hands_at(b, "spine3", (0.08, 0.0, 0.42), ("left", "right"), weight, drawn), []

    play.effect(start, play.sync(), effect, i=i)
    play.note(("throw-ball", "catch-thing"), start, i=i, relation="reply", sides=(done.side, None))


# ---- touches -----------------------------------------------------------------------------------------


Place = Callable[[Play, int], tuple[int, str]]
"""Brings the two to where they touch; the frame from which they stand there, and the hand that touches."""


def facing(low: float, high: float) -> Place:
    """Face to face, so many metres apart."""
    return lambda play, i: (come(play, i, play.rng.uniform(low, high)), chosen_side(play.rng))


def abeam(play: Play, i: int) -> tuple[int, str]:
    """The other stands beside i, on the side of the hand."""
    side = side_by_side(play, i, play.rng.uniform(0.43, 0.5))
    return play.sync(), "left" if side > 0 else "right"


def at_back(
    play: Play,
    i: int,
    cue: str = "walk-up",
    turned: tuple[float, float] = (1.0, 1.4),
    back: tuple[float, float] = (0.42, 0.5),
    aside: tuple[float, float] = (0.1, 0.2),
) -> tuple[int, str]:
    """i stands half behind the other: ``turned`` by radians, ``back`` and a little ``aside`` by metres."""
    _, _, other = play.begin(i)
    rng, side = play.rng, chosen_side(play.rng)
    sign = 1.0 if side == "right" else -1.0
    way = other.angle + sign * rng.uniform(*turned)
    spot = other.spot - rng.uniform(*back) * direction(way) + sign * rng.uniform(*aside) * leftwards(way)
    return play.settle(i, spot, way, cue), side


def touching(
    weight: float,
    make: Touch,
    place: Place,
    hold: tuple[float, float],
    cue: str,
    answer: str = STILL,
    *,
    side: str | None = "one",
) -> Option:
    """A beat of a touch.

    Args:
        weight: how often it is drawn.
        make: the touch.
        place: where the two stand.
        hold: seconds for which they are within reach.
        cue, answer: of who touches and of the other.
        side: "one" where the hand counts, "both", or None.
    """

    def beat(play: Play, i: int) -> None:
        start, hand = place(play, i)
        length = play.seconds(*hold)
        play.hold(length + 18)
        play.effect(start, start + length + 44, lambda rng, a, b: make(rng, a, b, 2, length, hand), i=i)
        told = hand if side == "one" else side
        relation = "reply" if answer not in (STILL, cue) else "while"
        play.note((cue, answer), start, i=i, relation=relation, sides=(told, told if answer == cue else None))
        if cue == "hug":  # nobody stays that close
            play.back_off(pick(play.rng, (i, 1 - i)), 0.4, 0.7)
            play.sync()

    return Option(beat, ("walk", "idle", "walk-back") if cue == "hug" else ("walk", "idle"), weight)


def tap(play: Play, i: int) -> None:
    """i taps the shoulder of the other, who looks away, and who turns round."""
    begun, own, other = play.begin(i)
    if abs(play.off(1 - i)) < 2.0:  # the other turns away first
        other.turn(wrapped(np.pi - abs(play.off(1 - i))) * pick(play.rng, (-1, 1)))
    play.look(1 - i, begun, len(other) + 30, 0.0)
    start, side = at_back(play, i, "come-behind", (0.0, 0.0), (0.5, 0.58), (0.0, 0.1))
    length = play.seconds(0.9, 1.3)
    own.hold(length + 60)
    other.hold(length + 6)
    other.turn((np.pi - 0.1) * (-1.0 if side == "right" else 1.0))
    pat = HandOn("{side}_shoulder", (0.0, 0.06, -0.06), (1.0, 0.0))
    play.effect(start, start + length + 30, lambda rng, a, b: pat(rng, a, b, 0, length, side), i=i)
    play.note(("pat:shoulder", "turn-to"), start, i=i, relation="reply", sides=(side, None))


def hand_in_hand(play: Play, i: int) -> None:
    """They take each other by the hand and walk on, or stand so."""
    rng, begun = play.rng, play.sync()
    gap = rng.uniform(0.55, 0.66)
    if rng.random() < 0.25:
        side, start, name = side_by_side(play, i, gap), play.sync(), "hold-hands"
        play.hold(play.seconds(1.8, 3.0))
    else:
        start, _, side = abreast(play, i, gap, (2.0, 2.8 if play.brisk else 4.2))
        name = "walk-hand-in-hand"
    hand, stop, taken = "left" if side > 0 else "right", play.sync(), max(start - 14, begun)
    make = touches.joined_hands((hand, OTHER_SIDE[hand]), height=rng.uniform(0.78, 0.86), carried=True)
    play.effect(taken, stop + 22, lambda rng, a, b: make(rng, a, b, 0, stop - taken - 4, hand), i=i)
    play.note((name, name), taken, i=i)
    for k in (0, 1):
        play.look(k, start, stop, float(rng.uniform(0, 0.5)))


def carousel(play: Play, i: int) -> None:
    """Face to face, hands joined, they go round each other."""
    rng = play.rng
    start = come(play, i, rng.uniform(0.72, 0.86))
    radius = play.gap / 2
    walk, aim = sideways(play, radius * rng.uniform(2.5, 5.5))
    # Who steps to the left around a point ahead turns to the right.
    turn = rounded(walk, radius if walk.side == "right" else -radius)
    play.hold(16)
    for person in play.people:
        person.append(steer(walk.motion, turn), turn=-aim)
    stop = play.sync()
    play.hold(14)
    make = touches.joined_hands(("left", "right"), ("right", "left"), height=rng.uniform(0.95, 1.1))
    play.effect(start, stop + 14, lambda rng, a, b: make(rng, a, b, 0, stop - start - 6, ""), i=i)
    play.note(("ring", "ring"), start, i=i)


_SHOULDER = ("{far}_shoulder", (0.0, 0.06, 0.05))
_FIST = Slap((1.1, 1.26), 0.5, elbow=(0.7, -1.0, -0.2), pause=(2, 9), apart=0.09)
_TEN = Slap((1.45, 1.6), 0.4, mirrored=True)
_LOW = Slap((0.9, 1.02), 1.0, approach=(0.2, 1.2), elbow=ELBOW_DOWN)
_PAT_BACK = HandOn("spine3", (-0.04, 0.0, -0.14), (0.0, -1.0), (0.8, -0.7, -0.2))
_SHORT, _LONG = (1.3, 2.0), (1.6, 2.4)
"""Seconds within reach."""
TOUCH_BEATS: dict[str, Option] = {
    "shake-hands": touching(5.2, touches.handshake, facing(0.82, 0.98), (1.5, 2.4), "shake-hands", "shake-hands"),
    "high-five": touching(3.9, Slap((1.48, 1.65), 0.5), facing(0.76, 0.92), _SHORT, "high-five", "high-five"),
    "high-ten": touching(1.7, _TEN, facing(0.66, 0.8), _SHORT, "high-five", "high-five", side="both"),
    "low-five": touching(1.6, _LOW, facing(0.68, 0.82), _SHORT, "low-five", "low-five"),
    "fist-bump": touching(2.3, _FIST, facing(0.82, 0.98), _SHORT, "fist-bump", "fist-bump"),
    "elbow-bump": touching(1.3, touches.elbow_bump, facing(0.46, 0.54), _SHORT, "elbow-bump", "elbow-bump"),
    "hand-over": touching(3.3, touches.hand_over, facing(0.85, 1.02), (1.8, 2.4), "hand-over", "take-from"),
    "pat:shoulder": touching(2.0, HandOn(*_SHOULDER, (1.0, 0.0)), facing(0.58, 0.72), _LONG, "pat:shoulder"),
    "hand-on:shoulder": touching(2.0, HandOn(*_SHOULDER), facing(0.58, 0.72), _LONG, "hand-on:shoulder"),
    "hug": touching(5.2, touches.hug, facing(0.41, 0.46), (1.8, 2.6), "hug", "hug", side=None),
    "pat:back": touching(2.0, _PAT_BACK, at_back, _LONG, "pat:back"),
    "whisper": touching(2.0, touches.whisper, at_back, _LONG, "whisper", "listen"),
    "arm-around": touching(1.7, touches.arm_around, abeam, (1.8, 3.0), "arm-around"),
    "help-up": touching(2.0, touches.help_up, facing(0.83, 0.94), (3.8, 3.9), "help-up", "stand-up"),
    "walk-hand-in-hand": Option(hand_in_hand, ("walk", "idle"), 3.9),
    "ring": Option(carousel, ("walk-left", "walk-right"), 2.6),
    "push": Option(push, ("walk", "walk-back"), 3.3),
    "tap": Option(tap, ("walk", "idle"), 2.3),
    "refused": Option(refused, ("walk", "walk-back"), 6.5),
    "throw-ball": Option(throw_catch, ("throw",), 2.0),
    "punch": Option(blow_at("punch", "dodge", "flinch", "step-back", FALL), ("punch", "walk-back"), 2.3),
    "kick": Option(blow_at("kick", "step-back", "flinch", FALL), ("kick", "walk-back"), 2.0),
}
"""Beats with touches, by name."""
