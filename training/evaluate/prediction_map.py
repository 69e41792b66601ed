"""Predicted and true motions as a map: ``python -m training.evaluate.prediction_map --data DIR --out FILE.png``.

Figure 2.10 of Chopin's thesis: t-SNE of the second that follows windows of CMU MoCap's test files, as predicted and as
recorded, by the Gram distance of poses (eq. 2.8), averaged over time. What is also printed: how often a motion's
nearest recorded one, other than that of its own window, is of its action; and the time of the prediction (Table 2.5).
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from models.mawgan.losses import gram_distance
from models.predictors import load_predictor
from motion import InputError
from motion.formats.files import replacing
from training.core.shell import add_options, exit_code
from training.corpus import cmu
from training.evaluate.prediction import of_predictor
from training.evaluate.tsne import embedded

Array = NDArray[np.floating]

EVERY = 5
"""Frames from one compared pose to the next."""
PERPLEXITY = 30.0
SUFFIXES = (".png", ".webp", ".svg", ".pdf")


def chosen_windows(data: Path, count: int) -> dict[str, Array]:
    """Up to ``count`` test windows of each of the papers' actions, evenly over its clips: (n, 75, 17, 3)."""
    found = {}
    for action, clips in cmu.read_actions(data, "test").items():
        windows = cmu.windows(clips)
        if action in cmu.ACTIONS and len(windows):
            places = np.linspace(0, len(windows) - 1, min(count, len(windows))).round().astype(int)
            found[action] = windows[places]
    if not found:
        raise InputError(f"{data} holds no test window of the papers' actions.")
    return found


def motion_distances(motions: Array, *, rows: int = 16) -> Array:
    """(N, N) mean Gram distance over time, m², of motions (N, T, J, 3)."""
    poses = torch.from_numpy(np.ascontiguousarray(motions, dtype=np.float32))
    parts = [gram_distance(part[:, None], poses[None]).mean(-1) for part in poses.split(rows)]
    found: Array = torch.cat(parts).clamp_min(0).double().numpy()
    return (found + found.T) / 2


def same_action(distances: Array, actions: Array) -> float:
    """Share of motions whose nearest of the others is of their action; distances (N, N), window by window."""
    others = distances + np.where(np.eye(len(distances), dtype=bool), np.inf, 0.0)
    return float((actions[others.argmin(1)] == actions).mean())


def draw(places: Array, counts: Mapping[str, int], path: Path) -> None:
    """Writes the map: a colour an action, dots recorded and crosses predicted; places (2 N, 2), recorded first."""
    from matplotlib import colormaps
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 6), layout="constrained")
    axes = figure.add_subplot()
    true, made = np.split(places, 2)
    first = 0
    for number, (action, count) in enumerate(counts.items()):
        part, colour = slice(first, first + count), colormaps["tab10"](number)
        axes.scatter(*true[part].T, s=14, color=colour, label=action, linewidths=0)
        axes.scatter(*made[part].T, s=18, color=colour, marker="x", linewidths=0.9)
        first += count
    axes.set(xticks=[], yticks=[], title="The next second: recorded (dots) and predicted (crosses)")
    axes.legend(frameon=False)
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=150, format=path.suffix[1:])


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.evaluate.prediction_map", description=__doc__)
    add_options(parser, "cmu")
    parser.add_argument("--predictor", type=Path, default=Path("models/weights/mawgan-cmu"))
    parser.add_argument("--windows", type=int, default=80, help="of each action, at most")
    parser.add_argument("--out", type=Path, required=True, help=f"picture ({', '.join(SUFFIXES)})")
    options = parser.parse_args(argv)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    if options.out.suffix not in SUFFIXES:
        raise InputError(f"{options.out} is no picture: give a name that ends in {', '.join(SUFFIXES)}.")
    chosen = chosen_windows(options.data, options.windows)
    counts = {action: len(windows) for action, windows in chosen.items()}
    windows = np.concatenate(list(chosen.values()))
    if len(windows) < 2 * PERPLEXITY:
        raise InputError(f"A map of {len(windows)} windows says nothing: give more, --windows.")
    predict = of_predictor(load_predictor(options.predictor))
    began = time.perf_counter()
    made = predict(windows[:, : cmu.PAST])
    took = 1000 * (time.perf_counter() - began) / len(windows)
    motions = np.concatenate([windows[:, cmu.PAST :], made])[:, EVERY - 1 :: EVERY]
    distances = motion_distances(motions)
    draw(embedded(distances, perplexity=PERPLEXITY), counts, options.out)
    actions, count = np.repeat(list(counts), list(counts.values())), len(windows)
    print(f"{count} windows: {', '.join(f'{action} {number}' for action, number in counts.items())}")
    print(f"{took:.2f} ms a window to predict, all at once")
    for name, part in (("recorded", distances[:count, :count]), ("predicted", distances[count:, :count])):
        print(
            f"{name}: the nearest recorded motion is of the same action for {same_action(part, actions):.1%}"
        )


if __name__ == "__main__":
    raise SystemExit(main())
