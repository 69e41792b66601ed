"""Beats in which one strikes, pushes or throws something to the other, in which the two touch face to face or from the
side, and the list of all beats with touches."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from motion.kinematics import project_to_skeleton
from motion.vectors import wrapped

from ..compose import Array
from ..contact import UP, axes, envelope, impulse, lean_to, nod, on_body, reach, reach_arm, towards
from ..cues import STILL
from ..library import pick, stride
from ..touches import TOUCHES, Touches, chosen_side, help_up, hug, pat_back, pats, whisper
from .acts import ACTS, blow, dodge, recoil
from .acts import reach as reach_of
from .joined import arm_around_beat, carousel, hand_in_hand
from .moves import ahead, close_in, come, leftwards
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
    answer = pick(rng, ("stumble", "stumble", FALL)) if falls else "stumble"
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
    play.note(("push", answer), start, i=i, relation="reply", sides=("both", None))


def blow_at(name: str) -> Callable[[Play, int], None]:
    """A blow in the air in front of the other, who gives way: recoil, dodge or retreat."""

    def make(play: Play, i: int) -> None:
        rng = play.rng
        take = blow(rng, play.library, name, most=1)
        start = play.sync()
        answers = {"punch": ("dodge", "flinch", "step-back", FALL), "kick": ("step-back", "flinch", FALL)}
        answer = pick(rng, answers[name])
        if answer == FALL and not play.library.has("fall", "get-up-back"):
            answer = "flinch"
        far = play.gap
        close_in(play, i, reach_of(take) + rng.uniform(0.1, 0.25))
        begun = play.sync()
        if far - play.gap > 0.6:
            play.note(("walk-up", STILL), start, end=begun, i=i, minor=True)
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
        play.note((name, answer), begun, i=i, relation="reply", sides=(take.side, None))

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
    offer = pick(rng, tuple(_OFFERS))
    distance, (out, up, front) = _OFFERS[offer]
    start = come(play, i, rng.uniform(distance, distance + 0.15))
    side = chosen_side(rng)
    sides = ("left", "right") if offer == "hug?" else (side,)
    answers = [*_REFUSALS, "wave-off"] if play.library.has("reject") else list(_REFUSALS)
    answer = pick(rng, answers)
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
    play.note((offer, answer), start, i=i, relation="reply", sides=(None if len(sides) > 1 else side, None))


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
    play.note(("throw-ball", "catch-thing"), start, i=i, relation="reply", sides=(take.side, None))


# ---- touches -----------------------------------------------------------------------------------------


AFTER = 34
"""Frames for which hands may still be on their way back when a touch is over."""
_CUES = {"handshake": "shake-hands", "pat-shoulder": "pat:shoulder", "hand-on-shoulder": "hand-on:shoulder"}
"""The cues of touches that go by another name than their entry."""


def face_to_face(name: str) -> Callable[[Play, int], None]:
    """A beat of one of :data:`~training.corpus.touches.TOUCHES`."""

    def make(play: Play, i: int) -> None:
        rng = play.rng
        both = name == "high-five" and rng.random() < 0.3
        touch = TOUCHES["high-ten" if both else name]
        start = come(play, i, rng.uniform(*touch.distance))
        length = play.seconds(touch.hold[0], min(touch.hold[1], 2.4))
        side = chosen_side(rng)
        for person in play.people:
            person.hold(length + 16)
        own_rng = np.random.default_rng(rng.integers(2**32))
        play.effect(start, start + length + AFTER + 16, lambda a, b: touch.make(own_rng, a, b, 2, length, side), i=i)
        cue = _CUES.get(name, name)
        answer = {"hand-over": "take-from", "pat-shoulder": STILL, "hand-on-shoulder": STILL}.get(name, cue)
        sides = ("both",) * 2 if both else (side, side if answer == cue else None)
        play.note((cue, answer), start, i=i, sides=sides)

    return make


def _hug(play: Play, i: int) -> None:
    rng = play.rng
    start = come(play, i, rng.uniform(0.41, 0.46))
    length = play.seconds(1.8, 2.6)
    for person in play.people:
        person.hold(length + 14)
    over, own_rng = pick(rng, ("left", "right")), np.random.default_rng(rng.integers(2**32))
    for k in (0, 1):
        play.look(k, start, start + length + 20, 0.3)
    play.effect(start - 6, start + length + 34, lambda a, b: hug(own_rng, a, b, 12, length, over), i=i)
    play.note(("hug", "hug"), start, i=i)
    if play.gap < 0.7:  # nobody stays that close
        walk = stride(rng, play.library, "walk-back", rng.uniform(0.4, 0.7))
        play.people[pick(rng, (i, 1 - i))].perform(walk.motion)
        play.sync()


def _from_the_side(make: Callable, name: str, answer: str) -> Callable[[Play, int], None]:
    """i stands half beside the other, as for a pat on the back or a whisper."""

    def beat(play: Play, i: int) -> None:
        rng = play.rng
        begun = play.sync()
        own, other = play.people[i], play.people[1 - i]
        side = chosen_side(rng)
        sign = 1.0 if side == "right" else -1.0
        # Where i must stand so that the other is ahead and a little to the other side, half turned away.
        turn = sign * rng.uniform(1.0, 1.4)
        way = other.angle + turn
        spot = other.spot - rng.uniform(0.42, 0.5) * ahead(way) + sign * rng.uniform(0.1, 0.2) * leftwards(way)
        near = float(np.linalg.norm(own.spot - spot)) < 0.6
        own.go(spot, way)
        play.sync()
        own.hold(12, turn=wrapped(way - own.angle), shift=spot - own.spot)
        start = play.sync()
        if not near:
            play.note(("walk-up", STILL), begun, end=start, i=i, minor=True)
        length = play.seconds(1.6, 2.4)
        for person in play.people:
            person.hold(length + 22)
        own_rng = np.random.default_rng(rng.integers(2**32))
        play.effect(start, start + length + 40, lambda a, b: make(own_rng, a, b, 2, length, side), i=i)
        play.look(1 - i, start, start + length, 0.3)
        play.note((name, answer), start, i=i, sides=(side, None))

    return beat


def _help_up(play: Play, i: int) -> None:
    """The other crouches; i comes and helps."""
    rng = play.rng
    begun = play.sync()
    close_in(play, i, rng.uniform(0.83, 0.94))
    start = play.sync()
    length = 100
    for person in play.people:
        person.hold(length)
    side, own_rng = chosen_side(rng), np.random.default_rng(rng.integers(2**32))
    down = max(begun, start - 45)

    def effect(a: Array, b: Array) -> tuple[Array, Array, Touches]:
        helped = help_up(own_rng, a, b, start - down, start - down + length, side)
        # The other goes down at first, if the scene has begun before.
        rise = envelope(len(b), 0, 30, len(b), len(b) + 1)[:, None, None] if down > 0 else 1.0
        mixed = b + (helped[1] - b) * rise
        return helped[0], project_to_skeleton(mixed)[0], helped[2]

    play.effect(down, start + length + 24, effect, i=i)
    play.note(("help-up", "stand-up"), begun, i=i, relation="reply", sides=(side, None))


def _tap_turn(play: Play, i: int) -> None:
    """i taps the shoulder of the other, who looks away, and who turns round."""
    rng = play.rng
    begun = play.sync()
    own, other = play.people[i], play.people[1 - i]
    side = chosen_side(rng)
    sign = 1.0 if side == "right" else -1.0
    if abs(play.off(1 - i)) < 2.0:  # the other turns away first
        other.turn(wrapped(np.pi - abs(play.off(1 - i))) * pick(rng, (-1, 1)))
    play.look(1 - i, begun, len(other) + 30, 0.0)
    way = other.angle
    spot = other.spot - rng.uniform(0.5, 0.58) * ahead(way) + sign * rng.uniform(0, 0.1) * leftwards(way)
    own.go(spot, way)
    play.sync()
    own.hold(10, turn=wrapped(way - own.angle), shift=spot - own.spot)
    start = play.sync()
    if start - begun > 30:
        play.note(("come-behind", STILL), begun, end=start, i=i, minor=True)
    arrive = int(rng.integers(14, 20))
    leave = arrive + int(rng.integers(14, 22))
    own.hold(leave + 40)
    other.hold(leave - 4)
    other.turn(sign * -1.0 * (np.pi - 0.1))
    own_rng = np.random.default_rng(rng.integers(2**32))

    def effect(a: Array, b: Array) -> tuple[Array, Array, Touches]:
        weight = envelope(len(a), 0, arrive, leave, leave + 18)
        hand = on_body(b, f"{side}_shoulder", 0.0, 0.06, -0.06)
        hand[leave - 4 :] = hand[min(leave - 4, len(hand) - 1)]
        hand = hand + UP * pats(own_rng, len(a), arrive, leave)[:, None]
        a = reach(a, {side: hand}, weight, elbow=(0.6, -0.9, 0.0))
        return a, b, [(f"{side}_wrist", f"{side}_shoulder", arrive, leave - 4)]

    play.effect(start, start + leave + 24, effect, i=i)
    play.note(("pat:shoulder", "turn-to"), start, i=i, relation="reply", sides=(side, None))


TOUCH_BEATS: dict[str, tuple[Callable[[Play, int], None], float, tuple[str, ...]]] = {
    **{
        _CUES.get(name, name): (face_to_face(name), weight, ("walk", "idle"))
        for name, weight in (
            ("handshake", 4.0),
            ("high-five", 4.3),
            ("low-five", 1.2),
            ("fist-bump", 1.8),
            ("elbow-bump", 1.0),
            ("hand-over", 2.5),
            ("pat-shoulder", 1.5),
            ("hand-on-shoulder", 1.5),
        )
    },
    "hug": (_hug, 4.0, ("walk", "idle", "walk-back")),
    "pat:back": (_from_the_side(pat_back, "pat:back", STILL), 1.5, ("walk", "idle")),
    "whisper": (_from_the_side(whisper, "whisper", "listen"), 1.5, ("walk", "idle")),
    "arm-around": (arm_around_beat, 1.3, ("walk", "idle")),
    "walk-hand-in-hand": (hand_in_hand, 3.0, ("walk", "idle")),
    "ring": (carousel, 2.0, ("walk-left", "walk-right")),
    "push": (push, 2.5, ("walk", "walk-back")),
    "help-up": (_help_up, 1.5, ("walk", "idle")),
    "tap": (_tap_turn, 1.8, ("walk", "idle")),
    "refused": (refused, 5.0, ("walk", "walk-back")),
    "throw-ball": (throw_catch, 1.5, ("throw",)),
    "punch": (blow_at("punch"), 1.8, ("punch", "walk-back")),
    "kick": (blow_at("kick"), 1.5, ("kick", "walk-back")),
}
"""(beat, how often it is drawn, source actions it needs) by name."""
