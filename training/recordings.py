"""Makes the recordings that acts are drafted from: ``python -m training.recordings --data DATA --out acts/recordings``.

Of people who stand by, those of ReActIdle are taken in which the feet stay and the body lives: most of its people stand
as still as they can. Of gestures, those in which the act's own rule finds it, evenly over manners and lengths.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path

import numpy as np

from acts import Act, Plan
from acts.checking import checked
from acts.staging.recordings import RATE
from motion import FPS, SMPL22, InputError
from motion.formats.files import replacing
from motion.metrics.sentences.joints import Motion
from motion.skeleton import FEET, SIDES
from motion.transforms import canonicalize, heading, leading_wrist, mirrored, resample, turn
from motion.vectors import FLAT, Array
from training.core.shell import exit_code

from .corpus.cues import SourceClip
from .corpus.duets import HELD_OUT, danced, read_takes
from .corpus.sources import load_sources

STILL = 0.2
"""Metres a second: slower than that in all joints, a body is still."""
MOST_STILL, MOST_STEPS = 0.6, 0.06
"""Shares of the frames in which the body is still, and in which a foot moves, at most."""
PIECE = 180
"""Frames of a piece of a recording."""
SHOWN = {
    "waves": ("wave", ("wave", "bye")),
    "up": ("raise-arm", ("raise-hand",)),
    "talks": ("talk", ("guide", "respond", "talking")),
}
"""Gestures, each with the act whose rule finds it and the actions of its recordings."""
PLAIN = ("normal", "active", "feminine", "masculine", "youthful", "happy", "proud", "musical", "angry")
"""Manners that suit an act of which none is told."""
MOST, GAITS = 18, 24
"""Recordings of a gesture with the same hands, and of walks and of runs."""
STRAIGHT, STRIDES, ALIKE = 0.7, (24, 100), 0.2
"""Radians by which somebody turns in a gait at most, frames of its strides, and metres between its ends at most."""
SHORTEST = 45
"""Frames of a recording of a gesture that goes on, at least."""
STAYS, FACES = 0.45, 0.9
"""Metres and radians by which somebody who gestures on the spot moves and turns, at most."""
FIGURES: Mapping[str, tuple[str, ...]] = {"dances": ("dance", "dance-show"), "shadow-boxes": ("shadow-box", "punch")}
"""Figures that go on, each with the actions of its recordings."""
BOWED, DEEPLY, BEGUN, AROUND = 0.6, 1.0, 0.15, 10
"""Radians of a bow, and of a deep one, at least, the share of them from which it has begun, and frames beside it."""
LEFT_OUT = ("cmu-dance-martial", "deepmimic")
"""Data sets with no dance that would be taken for one: temple dances, and a step or two."""
LASTS, TRAVELS, LIVELY = 180, 1.1, 0.6
"""Frames of a piece of a figure, metres that it spans at most, and the mean metres a second of its joints at least."""
TOGETHER, JOINED = 360, 0.25
"""Frames of a dance of two, and metres between two hands that are joined in it."""
NECK = SMPL22.index("neck")
WRISTS, SHOULDERS = ([SMPL22.index(f"{side}_{j}") for side in SIDES] for j in ("wrist", "shoulder"))
LEANS, RAISED, REACHED = 0.25, 0.1, 0.5
"""Metres of the neck beside the pelvis, at most, of a waving hand over the shoulder, at least, and of the wrist of
somebody who stands by beside the pelvis, at most."""


def lively(positions: Array) -> bool:
    """True for a person (T, 22, 3) who moves while their feet stay."""
    speeds = np.linalg.norm(np.diff(positions.astype(float), axis=0), axis=-1) * FPS
    still, steps = (speeds.max(-1) < STILL).mean(), (speeds[:, FEET].max(-1) > STILL).mean()
    return bool(still < MOST_STILL and steps < MOST_STEPS)


def shows(entry: str, side: str, positions: Array) -> bool:
    """True for a person (T, 22, 3) on the spot in whom an act's rule finds it, done to somebody in front of them."""
    way, turned = positions[:, 0][:, [0, 2]], np.unwrap(heading(positions))
    leans = np.linalg.norm((positions[:, NECK] - positions[:, 0])[:, [0, 2]], axis=-1)
    if np.ptp(way, axis=0).max() > STAYS or np.ptp(turned) > FACES or leans.max() > LEANS:
        return False
    other = np.array([0.0, 0.0, 1.5]) + turn(positions[:1].repeat(len(positions), axis=0), np.pi)
    act = Act.model_validate({"id": "1", "act": entry, "agents": ("a",), "side": side or None})
    over = positions[:, WRISTS, 1] - positions[:, SHOULDERS, 1]
    if entry == "wave" and np.median(over.min(axis=1) if side == "both" else over[:, 1]) < RAISED:
        return False
    return checked(Plan(acts=(act,)), Motion(np.stack([positions, other]), FPS))[0].done is True


def gestures(clips: Sequence[SourceClip]) -> Iterator[tuple[str, Array]]:
    """Names and positions (T, 22, 3) of the recordings of gestures: by the right hand, or by both."""
    for gesture, (entry, actions) in SHOWN.items():
        taken: dict[tuple[str, str], list[Array]] = defaultdict(list)
        for clip in clips:
            lasts = gesture == "up" or len(clip.positions) >= SHORTEST
            if clip.action in actions and clip.style in PLAIN and lasts:
                positions = clip.positions.astype(np.float64)
                side = "both" if gesture == "talks" else clip.side or leading_wrist(positions) or "both"
                if side == "left":
                    positions, side = mirrored(positions), "right"
                if shows(entry, "" if gesture == "talks" else side, positions):
                    taken[side, clip.style].append(positions)
        for side in ("right", "both"):
            styles = [sorted(own, key=len) for (hands, _), own in sorted(taken.items()) if hands == side]
            each = -(-MOST // max(len(styles), 1))
            kept = [own[i] for own in styles for i in np.unique(np.linspace(0, len(own) - 1, each).round().astype(int))]
            yield from ((f"{gesture}-{side}-{i}", canonicalize(positions)) for i, positions in enumerate(kept))


def gaits(clips: Sequence[SourceClip]) -> Iterator[tuple[str, Array]]:
    """Names and positions (T, 22, 3) of walks and runs straight ahead, each a few strides that end as they begin."""
    for action in ("walk", "run"):
        loops = []
        for clip in clips:
            if clip.action == action and clip.style in PLAIN and len(clip.positions) >= SHORTEST:
                loop = looped(canonicalize(clip.positions.astype(np.float64)))
                if loop is not None:
                    loops.append(loop)
        loops.sort(key=lambda loop: float(loop[-1, 0, 2]) / len(loop))
        kept = np.unique(np.linspace(0, len(loops) - 1, GAITS).round().astype(int))
        yield from ((f"{action}-{i}", loops[at]) for i, at in enumerate(kept))


def looped(positions: Array) -> Array | None:
    """The strides of a gait (T, 22, 3) between the two moments that look most alike; None of one that is not straight.

    The pelvis goes along +Z, and what is left between the two moments is spread over the strides.
    """
    turned = heading(positions)
    if np.ptp(np.unwrap(turned)) > STRAIGHT:
        return None
    poses = turn(positions, -float(np.median(turned)))
    left, right = (poses[:, SMPL22.index(f"{side}_ankle"), 2] for side in SIDES)
    passes = np.flatnonzero((left[:-1] < right[:-1]) & (left[1:] >= right[1:])) + 1
    pelvis = poses[:, :1] * FLAT
    local = poses - pelvis
    pairs = [(i, j) for i in passes for j in passes if STRIDES[0] <= j - i <= STRIDES[1]]
    if not pairs:
        return None
    first, last = min(pairs, key=lambda pair: float(np.abs(local[pair[0]] - local[pair[1]]).max()))
    if np.abs(local[first] - local[last]).max() > ALIKE:
        return None
    share = np.linspace(0.0, 1.0, last - first + 1)[:, None, None]
    loop = local[first : last + 1] - share * (local[last] - local[first])
    loop[..., 2] += np.maximum.accumulate(pelvis[first : last + 1, :, 2] - pelvis[first, 0, 2])
    return loop


def bystanders(clips: Sequence[SourceClip]) -> Iterator[tuple[str, Array]]:
    """Names and positions (T, 22, 3) of the recordings of people who stand by."""
    for i, clip in enumerate(clips):
        for start in range(0, len(clip.positions) - PIECE + 1, PIECE) if clip.dataset == "reactidle" else ():
            piece = clip.positions[start : start + PIECE]
            out = np.linalg.norm((piece[:, WRISTS] - piece[:, :1])[..., [0, 2]], axis=-1)
            if lively(piece) and out.max() < REACHED:
                yield f"{clip.source}_{i}_{start}", canonicalize(piece)


def figures(clips: Sequence[SourceClip]) -> Iterator[tuple[str, Array]]:
    """Names and positions (T, 22, 3) of people who do a figure around one place, and move a lot."""
    for figure, actions in FIGURES.items():
        own = [clip.positions for clip in clips if clip.action in actions and clip.dataset not in LEFT_OUT]
        pieces = [each[at : at + LASTS].astype(np.float64) for each in own for at in range(0, len(each), LASTS)]
        for i, piece in enumerate(piece for piece in pieces if len(piece) >= SHORTEST):
            speed = np.linalg.norm(np.diff(piece, axis=0), axis=-1).mean() * FPS
            if speed > LIVELY and np.ptp(piece[:, 0][:, [0, 2]], axis=0).max() < TRAVELS:
                yield f"{figure}-{i}", canonicalize(piece)


def bows(clips: Sequence[SourceClip]) -> Iterator[tuple[str, Array]]:
    """Names and positions (T, 22, 3) of bows, and of deep ones."""
    for i, clip in enumerate(clip for clip in clips if clip.action == "bow"):
        trunk = clip.positions[:, NECK] - clip.positions[:, 0]
        lean = np.arctan2(np.linalg.norm(trunk[:, [0, 2]], axis=-1), trunk[:, 1])
        if lean.max() > BOWED:
            bent = np.flatnonzero(lean > lean[0] + BEGUN * (lean.max() - lean[0]))
            piece = clip.positions[max(bent[0] - AROUND, 0) : bent[-1] + AROUND]
            name = "bows deeply" if lean.max() > DEEPLY else "bows"
            yield f"{name}-{i}", canonicalize(piece.astype(np.float64))


def couples(data: Path) -> Iterator[tuple[str, Array]]:
    """Names and positions (T, 2, 22, 3) of two who dance with each other, where their hands are joined the longest."""
    for name, people in read_takes(data):
        first, last = danced(people)
        starts = range(first, last - TOGETHER + 1, 15)
        if name not in HELD_OUT and starts:
            gaps = people[0][:, WRISTS, None] - people[1][:, None, WRISTS]
            joined = np.linalg.norm(gaps, axis=-1).min(axis=(1, 2)) < JOINED
            at = max(starts, key=lambda start: int(joined[start : start + TOGETHER].sum()))
            yield name, canonicalize(people[:, at : at + TOGETHER]).swapaxes(0, 1)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.recordings", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="folder of the data sets")
    parser.add_argument("--out", type=Path, required=True, help="folder of the recordings")
    options = parser.parse_args(argv)

    def job() -> None:
        clips = load_sources(options.data)
        options.out.mkdir(parents=True, exist_ok=True)
        made = {"idle": bystanders(clips), "gestures": gestures(clips), "gaits": gaits(clips)}
        made |= {"figures": chain(figures(clips), bows(clips)), "couples": couples(options.data)}
        for name, chosen in made.items():
            kept = {each: resample(positions, FPS, RATE) for each, positions in chosen}
            if not kept:
                raise InputError(f"{options.data} holds no recordings for {name}: docs/corpus.md names the data sets.")
            with replacing(options.out / f"{name}.npz") as temporary, temporary.open("wb") as file:
                poses = {each: np.rint(1000 * positions).astype(np.int16) for each, positions in kept.items()}
                np.savez_compressed(file, **poses)
            print(f"{name}: {len(kept)} recordings, {sum(map(len, kept.values())) / RATE:.0f} s")

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
