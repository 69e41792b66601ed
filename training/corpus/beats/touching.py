"""Beats in which the two touch face to face or from the side, and the list of all beats with touches."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from motion.skeleton import SMPL22
from motion.vectors import wrapped

from ..compose import Array
from ..contact import UP, envelope, on_body, reach
from ..cues import STILL
from ..library import pick, stride
from ..touches import TOUCHES, Touches, chosen_side, help_up, hug, pat_back, pats, whisper
from .blows import blow_at, push, refused, throw_catch
from .joined import arm_around_beat, carousel, hand_in_hand
from .moves import ahead, close_in, come, leftwards
from .play import Play

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
        side, _ = chosen_side(rng)
        for person in play.people:
            person.hold(length + 16)
        own_rng = np.random.default_rng(rng.integers(2**32))
        play.effect(start, start + length + AFTER + 16, lambda a, b: touch.make(own_rng, a, b, 2, length, side), i=i)
        cue = _CUES.get(name, name)
        answer = {"hand-over": "take-from", "pat-shoulder": STILL, "hand-on-shoulder": STILL}.get(name, cue)
        sides = ("both",) * 2 if both else (side, side if answer == cue else None)
        play.note((cue, answer), start, i=i, relation="while", sides=sides)

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
    play.note(("hug", "hug"), start, i=i, relation="while")
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
        side, _ = chosen_side(rng)
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
            play.note_span(("walk-up", STILL), begun, start, i=i, relation="while", minor=True)
        length = play.seconds(1.6, 2.4)
        for person in play.people:
            person.hold(length + 22)
        own_rng = np.random.default_rng(rng.integers(2**32))
        play.effect(start, start + length + 40, lambda a, b: make(own_rng, a, b, 2, length, side), i=i)
        play.look(1 - i, start, start + length, 0.3)
        play.note((name, answer), start, i=i, relation="while", sides=(side, None))

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
    side, own_rng = chosen_side(rng)[0], np.random.default_rng(rng.integers(2**32))
    down = max(begun, start - 45)

    def effect(a: Array, b: Array) -> tuple[Array, Array, Touches]:
        helped = help_up(own_rng, a, b, start - down, start - down + length, side)
        # The other goes down at first, if the scene has begun before.
        rise = envelope(len(b), 0, 30, len(b), len(b) + 1)[:, None, None] if down > 0 else 1.0
        mixed = b + (helped[1] - b) * rise
        return helped[0], _on_bones(mixed, b), helped[2]

    play.effect(down, start + length + 24, effect, i=i)
    play.note(("help-up", "stand-up"), begun, i=i, sides=(side, None))


def _on_bones(positions: Array, like: Array) -> Array:
    """Positions whose bones are as long as ``like``'s."""
    result = positions.copy()
    for parent, joint in SMPL22.bones:
        bone = positions[:, joint] - positions[:, parent]
        length = np.linalg.norm(like[:, joint] - like[:, parent], axis=-1, keepdims=True)
        result[:, joint] = result[:, parent] + bone * length / np.maximum(
            np.linalg.norm(bone, axis=-1, keepdims=True), 1e-9
        )
    return result


def _tap_turn(play: Play, i: int) -> None:
    """i taps the shoulder of the other, who looks away, and who turns round."""
    rng = play.rng
    begun = play.sync()
    own, other = play.people[i], play.people[1 - i]
    side, _ = chosen_side(rng)
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
        play.note_span(("come-behind", STILL), begun, start, i=i, relation="while", minor=True)
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
    play.note(("pat:shoulder", "turn-to"), start, i=i, sides=(side, None))


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
