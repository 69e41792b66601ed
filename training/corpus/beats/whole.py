"""Acts of one person that recordings show whole: sitting, falling, lifting, crouching, jumping, kicking a ball."""

from __future__ import annotations

from ..compose import Motion, join
from ..library import Take, pick
from .play import Act, Done, Make, Play


def perform(play: Play, i: int, take: Take, *, aim: float = 0.0) -> Done:
    """Person i does what was drawn; ``aim`` turns it away from their front."""
    person = play.people[i]
    start, stop = person.perform(take.motion, aim=aim)
    return Done(start, stop, take.side, take.style)


def taken(action: str, frames: tuple[int, int] = (40, 100), *, side: str | None = None, one: bool = False) -> Make:
    """An act that is one clip of the library; with ``one``, of one hand."""

    def make(play: Play, i: int) -> Done:
        person, rng = play.people[i], play.rng
        own = side or (pick(rng, ("left", "right")) if one else None)
        styles = play.library.styles(action)
        style = person.style if person.style in styles and rng.random() < 0.7 else pick(rng, styles)
        length = (frames[0], max(frames[0] + 15, int(0.72 * frames[1]))) if play.brisk else frames
        return perform(play, i, play.library.take(rng, action, side=own, style=style, frames=length))

    return make


def then(first: Motion, *more: Motion, blend: int = 12) -> Motion:
    """Motions of one person after one another."""
    for motion in more:
        first = join(first, motion, blend=blend)
    return first


def plain(play: Play, *actions: str) -> list[Motion]:
    """A clip of each action."""
    return [play.library.take(play.rng, action, frames=(1, 400)).motion for action in actions]


def frozen(motion: Motion, frames: int) -> Motion:
    """The last pose held for ``frames`` frames."""
    last = [len(motion) - 1] * frames
    return Motion(motion.rotations[last], motion.root[last], motion.sources)


def looped(motion: Motion, frames: int, *, blend: int = 8) -> Motion:
    """At least ``frames`` frames of a clip that ends as it begins."""
    longer = motion
    while len(longer) < frames:
        longer = join(longer, motion, blend=blend)
    return longer


def sit(play: Play, i: int) -> Done:
    """Sits down, stays a while, gets up."""
    rng = play.rng
    down, up = plain(play, "sit-down", "stand-up")
    still = plain(play, pick(rng, ("sitting", "sitting-talk")))[0]
    rest = looped(still, 120)[: play.seconds(0.8, 2.0)]
    start, stop = play.people[i].perform(then(down, rest, up))
    return Done(start, stop)


def fall(play: Play, i: int) -> Done:
    """Falls on the back, lies there and gets up."""
    down, up = plain(play, "fall", "get-up-back")
    start, stop = play.people[i].perform(then(down, frozen(down, play.seconds(0.3, 0.8)), up, blend=18))
    return Done(start, stop)


def crawl(play: Play, i: int) -> Done:
    """Person i lies down, crawls and gets up."""
    down, on, up = plain(play, "lie-down-front", "crawl", "get-up-front")
    start, stop = play.people[i].perform(then(down[: len(down) - 25], on, up, blend=14))
    return Done(start, stop)


def push_up(play: Play, i: int) -> Done:
    """Person i does push-ups."""
    down, press, up = plain(play, "lie-down-front", "push-up", "get-up-front")
    presses = looped(press, int(len(press) * play.rng.integers(1, 3)))
    start, stop = play.people[i].perform(then(down[: len(down) - 30], presses, up[20:], blend=14))
    return Done(start, stop)


def jacks(play: Play, i: int) -> Done:
    """Person i does jumping jacks."""
    (jump,) = plain(play, "jumping-jacks")
    start, stop = play.people[i].perform(looped(jump, int(len(jump) * play.rng.uniform(1.9, 3.2)), blend=4))
    return Done(start, stop)


def rage(play: Play, i: int) -> Done:
    """Person i rages."""
    (clip,) = plain(play, "rage")
    start, stop = play.people[i].perform(looped(clip, play.seconds(1.5, 2.8), blend=5))
    return Done(start, stop)


def part_of(action: str, least: float, most: float) -> Make:
    """An act that is a stretch of ``least`` to ``most`` seconds of a clip which goes on and on."""

    def make(play: Play, i: int) -> Done:
        take = play.library.take(play.rng, action)
        frames = min(play.seconds(least, most), len(take))
        at = int(play.rng.integers(0, len(take) - frames + 1))
        start, stop = play.people[i].perform(take.motion[at : at + frames])
        return Done(start, stop, take.side, take.style)

    return make


def _one_sided(play: Play, *actions: str) -> list[Motion]:
    """Clips of the actions, all mirrored or none, so that the legs of one lead into those of the next."""
    side = pick(play.rng, ("left", "right"))
    return [play.library.take(play.rng, action, side=side).motion for action in actions]


def crouch(play: Play, i: int) -> Done:
    """Crouches, stays a while, gets up."""
    down, up = _one_sided(play, "crouch-down", "crouch-up")
    start, stop = play.people[i].perform(then(down, up))
    return Done(start, stop)


def lie(play: Play, i: int) -> Done:
    """Crouches, lies down on the front, and gets up again."""
    down, flat, back, up = _one_sided(play, "crouch-down", "crouch-to-lie", "lie-to-crouch", "crouch-up")
    down = down[: min(len(down), 48)]
    rest = frozen(flat, play.seconds(0.2, 0.6))
    start, stop = play.people[i].perform(then(down, flat, rest, back, up))
    return Done(start, stop)


WHOLE: dict[str, Act] = {
    "jump": Act(taken("jump", (30, 110)), ("jump",), 2.0, room=1.6),
    "jumping-jacks": Act(jacks, ("jumping-jacks",), 1.2),
    "sit-down>stand-up": Act(sit, ("sit-down", "sitting", "stand-up"), 2.5),
    "crouch>stand-up": Act(crouch, ("crouch-down", "crouch-up"), 2.0),
    "lie-down>stand-up": Act(lie, ("crouch-down", "crouch-to-lie", "lie-to-crouch", "crouch-up"), 1.2, room=2.2),
    "kneel": Act(taken("kneel", (60, 110)), ("kneel",), 1.6),
    "fall-down>stand-up": Act(fall, ("fall", "get-up-back"), 1.5, room=1.4),
    "lie-down>crawl>stand-up": Act(crawl, ("lie-down-front", "crawl", "get-up-front"), 1.0, room=2.6),
    "lie-down>push-ups>stand-up": Act(push_up, ("lie-down-front", "push-up", "get-up-front"), 0.8, room=2.0),
    "somersault": Act(taken("roll", (40, 110)), ("roll",), 1.0, room=2.2),
    "cartwheel": Act(taken("cartwheel", (40, 110)), ("cartwheel",), 2.0, room=3.8),
    "turn-around": Act(taken("turn-around", (50, 80)), ("turn-around",), 2.0, room=2.0),
    "jump-ahead": Act(taken("jump-ahead", (45, 80)), ("jump-ahead",), 2.0, room=2.3),
    "squats": Act(taken("squats", (70, 150)), ("squats",), 1.0),
    "touch-toes": Act(taken("touch-toes", (60, 110)), ("touch-toes",), 1.0, room=1.2),
    "stretch": Act(taken("stretch", (60, 100)), ("stretch",), 1.0),
    "sway": Act(part_of("sway", 2.0, 4.0), ("sway",), 1.0),
    "swing-arms@both": Act(taken("swing-arms", (60, 110)), ("swing-arms",), 1.0),
    "kick-ball": Act(taken("kick-ball", (45, 80)), ("kick-ball",), 3.5, room=3.2),
    "shoot-hoop": Act(taken("shoot-hoop", (45, 80)), ("shoot-hoop",), 0.8),
    "lift-thing": Act(taken("lift-box", (60, 120)), ("lift-box",), 1.2),
    "put-down-thing": Act(taken("put-down-box", (40, 110)), ("put-down-box",), 1.2),
    "pick-up-thing": Act(taken("pick-up", (60, 120)), ("pick-up",), 1.5),
    "rage": Act(rage, ("rage",), 1.2),
    "scratch-head": Act(taken("scratch-head", (50, 100)), ("scratch-head",), 1.0),
    "drink": Act(taken("drink", (60, 110)), ("drink",), 1.2),
    "wave-off": Act(taken("reject", (50, 110)), ("reject",), 1.5),
    "cheer": Act(taken("victory", (40, 90)), ("victory",), 1.2),
    "make-fist": Act(taken("fist-pump", (40, 90)), ("fist-pump",), 1.0),
    "block": Act(taken("guard", (25, 60)), ("guard",), 0.6),
}
"""What a person does in one piece, by its cue; part of :data:`training.corpus.beats.acts.ACTS`."""
