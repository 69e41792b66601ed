"""Scores a generator: ``python -m training.evaluate --scenes FILE --out scores.json --table scores.md``.

Sentences of the test split, generated and judged by the rules of :mod:`training.evaluate.judge`. Beside the scores
stand those of the recorded motion of the same sentences (what the rules allow at best) and those of recorded
motion that belongs to other sentences (what they allow to chance). ``--real-only`` needs no weights;
``--everyday`` also judges sentences that were written by hand and not by the corpus' grammar. With
``--reactions`` every model that reacts gets the sentences and the recorded person a. With ``--extractor``
come InterGen's measures, R-precision to multimodality (:mod:`training.evaluate.judge.retrieval`).
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from motion import Duet, InputError
from training.core.shell import add_options, write_scores
from training.evaluate.judge import retrieval
from training.evaluate.judge.prompts import choose, everyday, real_duet
from training.evaluate.judge.reactions import WITH_WORDS, installed, of_the_reactor, react_to_all
from training.evaluate.judge.report import reactions_table, score, table
from training.evaluate.judge.rules import Task
from training.prepare import Scenes, load
from webdemo.inference import Engine
from webdemo.inference.engine import WEIGHTS


def evaluate(options: argparse.Namespace) -> dict[str, Any]:
    """Scores as :func:`training.evaluate.judge.report.table` takes them."""
    scenes = load(options.scenes)
    chosen = choose(scenes, options.prompts, seed=options.seed)
    tasks = [task for task, _ in chosen]
    drawn: dict[int, Duet] = {}
    about: dict[str, Any] = {"prompts": len(tasks), "seed": options.seed}
    if not options.real_only:
        drawn, drawing = _generate(tasks, options)
        about |= drawing
    judged = sorted(drawn) if drawn else list(range(len(tasks)))
    tasks = [tasks[i] for i in judged]
    real = [real_duet(scenes, chosen[i][1]) for i in judged]
    families = len({task.family for task in tasks})
    scores: dict[str, Any] = {"real": score(real, tasks), "other": score(_of_other_words(real, tasks), tasks)}
    text = f"{len(tasks)} test captions of {families} families, seed {options.seed}"
    if drawn:
        scores["generated"] = score([drawn[i] for i in judged], tasks)
        text += (
            f"; DDIM-{options.steps}, guidance {options.guidance:g}, damping {options.damping:g}, weights "
            f"{about['weights_sha256'][:12]}, {about['seconds']:.0f} s"
        )
        if len(tasks) < about["prompts"]:
            text += f"; stopped by --minutes before {about['prompts']} captions"
    if drawn and options.everyday:
        sentences = everyday()
        made, _ = _generate(sentences, options)
        scores["everyday"] = score([made[i] for i in sorted(made)], [sentences[i] for i in sorted(made)])
    if options.reactions and not options.real_only:
        scores["reactions"] = _react(tasks, real, options)
    if options.extractor:
        scores["features"] = _measure(scenes, options)
    return scores | {"about": text + ".", "settings": about}


def _react(tasks: Sequence[Task], real: Sequence[Duet], options: argparse.Namespace) -> dict[str, Any]:
    """Scores of person b, recorded and from each method, on the sentences that require something of b."""
    judged = [of_the_reactor(task) for task in tasks]
    kept = [i for i, task in enumerate(judged) if task.checks]
    tasks, real = [judged[i] for i in kept], [real[i] for i in kept]
    engine, found = Engine(options.weights.parent), {"Recorded": score(real, tasks)}
    for method in installed(WITH_WORDS, options.weights.parent):
        print(f"{method}: {len(tasks)} reactions", file=sys.stderr, flush=True)
        made = list(react_to_all(engine, tasks, real, options.seed, WITH_WORDS[method]))
        found[method] = score(made, tasks)
    return found


def _measure(scenes: Scenes, options: argparse.Namespace) -> dict[str, Any]:
    from training.evaluate.extractor import load_extractor
    from training.evaluate.judge.draw import Sampling, draw
    from webdemo.inference.pipelines.intergen import InterGenPipeline

    extractor = load_extractor(options.extractor)
    generator = None if options.real_only else InterGenPipeline(options.weights)
    chosen = {key: getattr(options, key) for key in ("steps", "guidance", "damping")}

    def drawn(tasks: Sequence[Task], seed: int) -> Iterator[tuple[int, Duet]]:
        assert generator is not None
        return draw(generator, tasks, Sampling(seed=seed, **chosen))

    return retrieval.measure(
        scenes,
        extractor,
        drawn if generator else None,
        prompts=options.retrieval_prompts,
        repeats=options.repeats,
        seed=options.seed,
    )


def _of_other_words(duets: Sequence[Duet], tasks: Sequence[Task]) -> list[Duet]:
    """Pairs every sentence with a motion of another family, from half the list away."""
    count = len(tasks)
    found = []
    for i, task in enumerate(tasks):
        places = [(i + count // 2 + k) % count for k in range(count)]
        found.append(duets[next((j for j in places if tasks[j].family != task.family), places[0])])
    return found


def _generate(tasks: Sequence[Task], options: argparse.Namespace) -> tuple[dict[int, Duet], dict[str, Any]]:
    from training.evaluate.judge.draw import Sampling, draw
    from webdemo.inference.pipelines.intergen import InterGenPipeline

    generator = InterGenPipeline(options.weights)
    sampling = Sampling(
        seed=options.seed, steps=options.steps, guidance=options.guidance, damping=options.damping
    )
    began, drawn = time.perf_counter(), {}
    for index, duet in draw(generator, tasks, sampling):
        drawn[index] = duet
        seconds = time.perf_counter() - began
        print(f"\r{len(drawn)} of {len(tasks)} drawn, {seconds:.0f} s", end="", file=sys.stderr, flush=True)
        if options.minutes and seconds > 60 * options.minutes:
            break
    print(file=sys.stderr)
    settings = {key: getattr(options, key) for key in ("steps", "guidance", "damping")}
    seconds = round(time.perf_counter() - began, 1)
    return drawn, settings | {"weights_sha256": generator.digest, "seconds": seconds}


def main(argv: list[str] | None = None) -> None:
    """Runs the command."""
    parser = argparse.ArgumentParser(description="Judge a generator on captions of the test split.")
    add_options(parser, "scenes", "out", "table", "seed", "steps", "guidance", "damping")
    parser.add_argument("--weights", type=Path, default=WEIGHTS / "intergen", help="its folder")
    parser.add_argument("--prompts", type=int, default=200, help="how many captions (200)")
    parser.add_argument(
        "--minutes", type=float, default=0.0, help="draw no more after this time; 0: no limit"
    )
    parser.add_argument(
        "--extractor", type=Path, help="what training.evaluate.extractor wrote: measures by features"
    )
    parser.add_argument("--repeats", type=int, default=20, help="of the measures by features (20)")
    parser.add_argument(
        "--retrieval-prompts", type=int, default=256, help="test scenes in a repeat, at most (256)"
    )
    parser.add_argument(
        "--everyday", action="store_true", help="also judge sentences as people type them, written by hand"
    )
    parser.add_argument(
        "--reactions", action="store_true", help="also judge the models that react to the recorded person a"
    )
    parser.add_argument("--real-only", action="store_true", help="only the recorded motion; needs no weights")
    options = parser.parse_args(argv)
    if options.prompts < 1:
        parser.error("--prompts must be at least 1.")
    try:
        scores = evaluate(options)
        shown = table(scores)
        if "reactions" in scores:
            shown += "\n" + reactions_table(scores["reactions"])
        if "features" in scores:
            shown += "\n" + retrieval.table(scores["features"])
        write_scores(options, scores, shown)
    except InputError as error:
        parser.exit(2, f"{error}\n")


if __name__ == "__main__":
    main()
