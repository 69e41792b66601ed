"""Scores of scenes against their stories, beat by beat: ``python -m training.evaluate.scenes --out scenes.json``.

Generates stories of three to six beats from acts that have a geometric rule each, and judges every rule in the beat's
own time. Beside it: jerk and feet at the seams, drawn paths, headings, spans that are made again, poses, and loops.
"""

from __future__ import annotations

import argparse
import itertools
import random
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion import FPS, SMPL22, Duet
from motion.metrics.sentences.joints import Motion
from motion.metrics.sentences.language import check
from motion.metrics.sentences.scores import share
from motion.skeleton import FEET
from motion.transforms import heading
from training.core.shell import add_options, exit_code, write_scores
from webdemo.inference import Engine, Result
from webdemo.inference.story import Beat, FloorPath, FloorPoint, Pose, SceneRequest
from webdemo.inference.story.windows import windows
from webdemo.inference.story.wishes import bent_wrong

Array = NDArray[np.floating]
Make = Callable[[SceneRequest], tuple[Duet, float]]

MARGIN = 9
"""Frames beyond a beat's edges that still belong to it."""
AROUND = 4
"""Frames on each side of a seam."""


@dataclass(frozen=True)
class Act:
    """A beat that can be judged: its words and its conditions (:mod:`motion.metrics.sentences.language`)."""

    words: str
    rules: tuple[str, ...]


MEET = Act("Two people walk up to each other.", ("happens(either(walks_to(a), walks_to(b)))",))
PART = Act(
    "They turn around and walk away from each other.", ("happens(walks_away(a))", "happens(walks_away(b))")
)
NEAR = (
    Act("They shake hands.", ("happens(hands_meet())",)),
    Act("They give each other a high five.", ("happens(hands_meet())",)),
    Act("They hug each other.", ("happens(hugs())",)),
    Act("They bow to each other.", ("happens(bows(a))", "happens(bows(b))")),
    Act("One person waves with the right hand.", ("happens(hand_up(a, 'right'))",)),
    Act("The other person waves back with the right hand.", ("happens(hand_up(b, 'right'))",)),
    Act("One person walks in a circle around the other.", ("happens(either(orbits(a), orbits(b)))",)),
    Act("They bump fists.", ("happens(hands_meet())",)),
)
"""Acts of people who stand near each other."""


def stories(count: int, seed: int = 0) -> list[tuple[Act, ...]]:
    """Stories of three to six acts: people meet, do one to four things, and part."""
    rng, found = random.Random(seed), []
    for i in range(count):
        found.append((MEET, *rng.sample(NEAR, 1 + i % 4), PART))
    return found


def obeyed(duet: Duet, story: Sequence[Act], edges: Sequence[int]) -> list[bool]:
    """Checks that each act's conditions hold in its own time."""
    found = []
    for act, start, stop in zip(story, edges[:-1], edges[1:], strict=True):
        part = duet.positions[:, max(0, start - MARGIN) : stop + MARGIN]
        motion = Motion(part, duet.fps)
        found.append(
            any(all(check(rule, m) for rule in act.rules) for m in (motion, motion.swapped()))
            if "One person" not in act.words and "other person" not in act.words
            else all(check(rule, motion) for rule in act.rules)
        )
    return found


def seams(duet: Duet, edges: Sequence[int]) -> dict[str, list[float]]:
    """Jerk (m/s³) at the seams beside its 95th percentile elsewhere, and the longest step of a foot (m) there."""
    jerk = np.linalg.norm(np.diff(duet.positions, n=3, axis=1), axis=-1).mean((0, 2)) * FPS**3
    steps = np.linalg.norm(np.diff(duet.positions[:, :, list(FEET)], axis=1), axis=-1).max((0, 2))
    near = np.zeros(len(jerk), dtype=bool)
    for edge in edges[1:-1]:
        near[max(0, edge - AROUND - 2) : edge + AROUND] = True
    usual, usual_step = float(np.percentile(jerk[~near], 95)), float(np.percentile(steps, 99))
    return {
        "ratio": [float(jerk[e - AROUND - 2 : e + AROUND].mean()) / usual for e in edges[1:-1]],
        "foot": [float(steps[e - AROUND : e + AROUND].max()) for e in edges[1:-1]],
        "usual_foot": [usual_step],
    }


def jolt(positions: Array, joins: Sequence[int]) -> float:
    """Metres a frame by which a joint's speed changes at most, frame by frame within half a second of a loop's joins.

    Args:
        positions: (2, T, 22, 3) metres of a loop.
        joins: frames at which what was made separately meets.
    """
    total = positions.shape[1]
    around = np.concatenate([positions[:, -1:], positions, positions[:, :1]], axis=1)
    changes = np.linalg.norm(np.diff(around, n=2, axis=1), axis=-1).max((0, 2))
    apart = np.abs(np.arange(total)[:, None] - np.array(joins))
    return float(changes[np.minimum(apart, total - apart).min(1) <= FPS / 2].max())


def wave_path(seconds: float) -> FloorPath:
    """A winding way of 0.8 m/s for person a, a point every quarter of a second, as it is drawn on the page."""
    times = np.arange(0.0, seconds - 0.1, 0.25)
    points = (FloorPoint(round(float(np.sin(0.7 * t)), 3), round(0.6 * float(t), 3), float(t)) for t in times)
    return FloorPath("a", tuple(points))


def path_error(duet: Duet, path: FloorPath) -> Array:
    """(frames,) metres between person a's pelvis and the drawn way, from its first point to its last."""
    found = []
    for frame, place in enumerate(duet.a.positions[:, 0][:, [0, 2]]):
        wanted = path.place(frame / FPS)
        if wanted is not None:
            found.append(float(np.linalg.norm(place - np.array(wanted))))
    return np.asarray(found)


def raised(pose: Array, side: str = "right") -> Array:
    """A pose (22, 3) with an arm stretched upwards and a little forward, on bones of the same lengths."""
    chain = [SMPL22.index(f"{side}_{part}") for part in ("shoulder", "elbow", "wrist")]
    facing = float(heading(pose[None])[0])
    way = np.array([0.3 * np.sin(facing), 1.0, 0.3 * np.cos(facing)])
    found = pose.astype(np.float64)
    for upper, lower in itertools.pairwise(chain):
        length = np.linalg.norm(pose[lower] - pose[upper])
        found[lower] = found[upper] + way / np.linalg.norm(way) * length
    return found


def turning_path() -> FloorPath:
    """A way for person a that asks for a heading every two seconds, a quarter turn after another."""
    return FloorPath("a", tuple(FloorPoint(0.1 * i, 0.2 * i, 2.0 * i, 90.0 * i) for i in range(4)))


def heading_error(duet: Duet, path: FloorPath) -> Array:
    """(points,) degrees between where person a faces and what the path's points ask for."""
    asked = [(round((p.seconds or 0.0) * FPS), p.heading) for p in path.points if p.heading is not None]
    facing = np.degrees(heading(duet.a.positions[[frame for frame, _ in asked]]))
    return np.abs((facing - np.array([angle for _, angle in asked]) + 180) % 360 - 180)


def evaluate(options: argparse.Namespace) -> dict[str, Any]:
    """All figures."""
    engine = Engine(options.weights)

    def make(request: SceneRequest) -> tuple[Duet, float]:
        began = time.perf_counter()
        *_, result = engine.run(request)
        assert isinstance(result, Result)
        duet = result.duets[0]
        assert isinstance(duet, Duet)
        return duet, time.perf_counter() - began

    plain = {"steps": options.steps}
    rows = _stories(make, options, plain)
    return {"settings": {"scenes": options.scenes, **plain}, "stories": rows, **_parts(make, options, plain)}


def _stories(make: Make, options: argparse.Namespace, plain: dict[str, Any]) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = []
    for i, story in enumerate(stories(options.scenes)):
        request = SceneRequest(beats=tuple(Beat(act.words) for act in story), seed=i, **plain)
        duet, spent = make(request)
        rows.append(
            {
                "words": [act.words for act in story],
                "obeyed": obeyed(duet, story, request.edges),
                "seconds": duet.seconds,
                "spent": round(spent, 2),
                **seams(duet, request.edges),
            }
        )
        print(f"\r{i + 1} of {options.scenes} scenes", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    return rows


def _parts(make: Make, options: argparse.Namespace, plain: dict[str, Any]) -> dict[str, Any]:
    """Paths, spans and loops."""
    paths, spans, loops, jolts = [], [], [], []
    walk = (Beat("One person walks and the other follows.", seconds=5.0),) * 2
    for seed in range(options.parts):
        path = wave_path(10.0)
        duet, _ = make(SceneRequest(beats=walk, paths=(path,), seed=seed, **plain))
        paths.append(path_error(duet, path))
        span = SceneRequest(beats=(Beat("They wave."),), motion=duet, start=3.0, end=6.0, seed=seed, **plain)
        remade, _ = make(span)
        outside = np.abs(remade.positions - duet.positions)
        outside[:, 90:180] = 0
        spans.append((float(outside.max()), seams(remade, (0, 90, 180, remade.num_frames))["ratio"]))
        dance = SceneRequest(
            beats=(Beat("They dance together.", seconds=6.0),), loop=True, seed=seed, **plain
        )
        loop, _ = make(dance)
        x = loop.positions.astype(np.float64)
        jolts.append(jolt(x, [window.start for window in windows(dance)]))
        ahead = 2 * x[:, -1] - x[:, -2]
        loops.append(
            (
                float(np.linalg.norm(x[:, 0] - ahead, axis=-1).max()),
                float(np.linalg.norm((x[:, 1] - x[:, 0]) - (x[:, -1] - x[:, -2]), axis=-1).max()),
            )
        )
    return _wishes(make, options, plain) | {
        "path_cm": [[round(100 * float(e.mean()), 2), round(100 * float(e.max()), 2)] for e in paths],
        "outside": [value for value, _ in spans],
        "span_jerk": [ratio for _, ratios in spans for ratio in ratios],
        "loop_cm": [[round(100 * gap, 2), round(100 * speed, 2)] for gap, speed in loops],
        "loop_jolt_cm": [round(100 * value, 2) for value in jolts],
    }


def _wishes(make: Make, options: argparse.Namespace, plain: dict[str, Any]) -> dict[str, Any]:
    """Poses that a span is made again through, as the page does, and headings along a way."""
    poses, headings = [], []
    beats = (
        Beat("Two people walk up to each other.", seconds=3.0),
        Beat("They talk to each other.", seconds=4.0),
    )
    for seed in range(options.parts):
        duet, _ = make(SceneRequest(beats=beats, seed=seed, **plain))
        frame = possible_frame(duet.a.positions)
        wanted = raised(duet.a.positions[frame])
        span = SceneRequest(
            beats=beats[1:], poses=(Pose("a", frame / FPS, wanted),), motion=duet, start=frame / FPS - 1,
            end=frame / FPS + 1, seed=seed, **plain,
        )  # fmt: skip
        remade, _ = make(span)
        miss = np.linalg.norm(remade.a.positions[frame] - wanted, axis=-1)
        moved = np.linalg.norm(remade.a.positions[frame] - duet.a.positions[frame], axis=-1)
        alone = Duet.from_positions(np.stack([remade.a.positions] * 2), fps=FPS)  # the other has no pose
        ratio = seams(alone, (0, frame, remade.num_frames))["ratio"][0]
        edges = seams(remade, (0, frame - 30, frame + 30, remade.num_frames))["ratio"]
        poses.append({"miss_cm": 100 * float(miss.max()), "moved_cm": 100 * float(moved.max()),
                      "jerk": ratio, "edges": edges})  # fmt: skip
        way = turning_path()
        walk = (Beat("One person walks and turns, while the other person stands.", seconds=6.5),)
        turned, _ = make(SceneRequest(beats=walk, paths=(way,), seed=seed, **plain))
        headings.append([float(e) for e in heading_error(turned, way)])
    return {"poses": poses, "heading_degrees": headings}


def possible_frame(positions: Array, near: int = 120) -> int:
    """The frame next to ``near`` in which a person (T, 22, 3) bends no joint wrong: other poses are refused."""
    frames = sorted(range(30, len(positions) - 30), key=lambda frame: abs(frame - near))
    return next(frame for frame in frames if bent_wrong(positions[frame]) is None)


def table(scores: dict[str, Any]) -> str:
    """The figures as Markdown."""
    rows = scores["stories"]
    flags = [flag for row in rows for flag in row["obeyed"]]
    by_words: dict[str, list[bool]] = {}
    for row in rows:
        for words, flag in zip(row["words"], row["obeyed"], strict=True):
            by_words.setdefault(words, []).append(flag)
    ratios = [ratio for row in rows for ratio in row["ratio"]]
    feet = [foot for row in rows for foot in row["foot"]]
    usual = float(np.mean([row["usual_foot"][0] for row in rows]))
    spent, made = sum(row["spent"] for row in rows), sum(row["seconds"] for row in rows)
    path = np.mean([p[0] for p in scores["path_cm"]]), max(p[1] for p in scores["path_cm"])
    loop = tuple(max(pair[i] for pair in scores["loop_cm"]) for i in range(2))
    checks = {
        "beats that obey their rule in their own time": share(sum(flags), len(flags)),
        "scenes in which every beat does": share(sum(all(r["obeyed"]) for r in rows), len(rows)),
        "seams with less jerk than the 95th percentile elsewhere": share(
            sum(r < 1 for r in ratios), len(ratios)
        ),
        "longest step of a foot at a seam, median and worst": (
            f"{100 * np.median(feet):.1f} and {100 * max(feet):.1f} cm a frame"
        ),
        "the same anywhere, 99th percentile": f"{100 * usual:.1f} cm a frame",
        "distance from a drawn path, mean and worst": f"{path[0]:.1f} and {path[1]:.1f} cm",
        "largest difference outside a remade span": f"{max(scores['outside']):g} m",
        "headings asked for on a way, mean and worst error": (
            f"{np.mean(scores['heading_degrees']):.1f} and {np.max(scores['heading_degrees']):.1f} degrees"
        ),
        "poses in a span made again: farthest joint from its place": (
            f"{max(p['miss_cm'] for p in scores['poses']):.2g} cm"
        ),
        "jerk around a pose, beside the 95th percentile elsewhere": (
            f"{min(p['jerk'] for p in scores['poses']):.1f} to {max(p['jerk'] for p in scores['poses']):.1f} times"
        ),
        "loop: worst gap in place and in speed": f"{loop[0]:.1f} cm and {loop[1]:.1f} cm a frame",
        "largest change of a joint's speed within half a second of a loop's joins, mean and worst": (
            f"{np.mean(scores['loop_jolt_cm']):.1f} and {max(scores['loop_jolt_cm']):.1f} cm a frame"
        ),
        "jerk at the edges of a span made again, beside the 95th percentile elsewhere": (
            f"{min(scores['span_jerk']):.1f} to {max(scores['span_jerk']):.1f} times"
        ),
        "time for a minute of motion, on this machine": f"{60 * spent / made:.0f} s",
    }
    out = [
        f"{len(rows)} scenes, {len(flags)} beats, {made:.0f} s of motion; DDIM-{scores['settings']['steps']}.",
        "",
        "| Check | Result |",
        "|---|---|",
        *(f"| {name} | {value} |" for name, value in checks.items()),
        "",
        "| Beat | Obeyed |",
        "|---|---|",
    ]
    out += [f"| {words} | {share(sum(found), len(found))} |" for words, found in sorted(by_words.items())]
    return "\n".join(out) + "\n"


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m training.evaluate.scenes", description="Judge scenes beat by beat."
    )
    add_options(parser, "weights", "table")
    parser.add_argument("--out", type=Path, required=True, help="JSON file for all figures")
    parser.add_argument("--scenes", type=int, default=60, help="how many stories (60)")
    parser.add_argument("--parts", type=int, default=10, help="how many paths, spans, poses and loops (10)")
    parser.add_argument("--steps", type=int, default=50, help="DDIM steps (50)")
    options = parser.parse_args(argv)
    if min(options.scenes, options.parts, options.steps) < 1:
        parser.error("--scenes, --parts and --steps must be at least 1.")

    def job() -> None:
        scores = evaluate(options)
        write_scores(options, scores, table(scores))

    return exit_code(job)


if __name__ == "__main__":
    sys.exit(main())
