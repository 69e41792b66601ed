"""The commands that run a network, ``generate``, ``react`` and ``predict``; and how any request is run."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from acts.plan import Plan, plan_of
from motion import InputError
from webdemo.inference.methods import by_class, reactor
from webdemo.inference.requests import GenerateRequest, ReactRequest
from webdemo.inference.requests.actor import read_actor
from webdemo.inference.requests.predict import LONGEST, PredictRequest, PredictResult
from webdemo.inference.run import Result
from webdemo.inference.story.request import SceneRequest

from .parser import add_reading, add_sampling, names_of, reading_choices, sampling_fields, with_notes

MOST_PLAN_BYTES = 200_000
"""Bytes of a plan's file, at most."""


def add_generate(commands: Any) -> None:
    """Adds ``generate`` to the shell's commands."""
    parser = commands.add_parser("generate", help="generate two people from a sentence or a class")
    asked = parser.add_mutually_exclusive_group(required=True)
    asked.add_argument("--prompt", help="what the two people do, in English")
    asked.add_argument("--class", dest="label", help="name of a class of BiGraphDiff, such as 'shake hands'")
    asked.add_argument("--plan", type=Path, help="JSON file of a plan of acts, as `read` prints it")
    parser.add_argument("--seconds", type=float, default=GenerateRequest.seconds)
    parser.add_argument(
        "--no-split", action="store_true", help="give a sentence of several beats to the network at once"
    )
    add_sampling(parser, "generate")
    parser.set_defaults(job=generate)


def generate(options: argparse.Namespace) -> dict[str, Any]:
    """Runs a :class:`GenerateRequest` and writes its duets."""
    check_out(options.out)
    if options.label is not None:
        options.model = by_class().name
    fields = sampling_fields(options)
    words = options.prompt if options.label is None else options.label
    fields |= {"split": not options.no_split, "planned": not options.no_plan}
    fields |= {"strictness": options.strictness, "tries": options.tries}
    if options.plan is not None:
        words, fields["acts"] = "", read_plan(options.plan)
    request = GenerateRequest(prompt=words, seconds=options.seconds, **fields)
    return write_result(run(request), options.out)


def read_plan(file: Path) -> Plan:
    """The plan of acts in a JSON file, alone or under "plan".

    Raises:
        InputError: if it is none.
    """
    try:
        if file.stat().st_size > MOST_PLAN_BYTES:
            raise InputError(f"{file.name} is too large for a plan, which has {MOST_PLAN_BYTES // 1000} kB at most.")
        values = json.loads(file.read_text(encoding="utf-8"))
    except OSError:
        raise InputError(f"{file} cannot be read: name a JSON file with a plan of acts.") from None
    except ValueError:
        raise InputError(f"{file.name} is not JSON: give a plan as the command read prints it.") from None
    return plan_of(values.get("plan", values) if isinstance(values, dict) else values)


def add_react(commands: Any) -> None:
    """Adds ``react`` to the shell's commands."""
    parser = commands.add_parser("react", help="generate a second person for a given one")
    parser.add_argument("--actor", type=Path, required=True, help="the given person: .bvh, .glb, .npz …")
    parser.add_argument("--person", help="which person, a to f, if the file holds several")
    add_reading(parser, "the actor")
    parser.add_argument("--start", type=float, default=0.0, help="first second of the file to use")
    parser.add_argument("--end", type=float, help="last second of the file to use; the end by default")
    parser.add_argument("--prompt", default=ReactRequest.prompt, help="what the two people do (optional)")
    parser.add_argument(
        "--keep-start",
        action="store_true",
        help="start the new person in the first pose of the file's other person (not intergen)",
    )
    parser.add_argument("--role", default=ReactRequest.role, help="whether the given person acts (a) or reacts (b)")
    parser.add_argument("--mode", help="offline sees the whole motion; online (regennet) sees the frames so far")
    add_sampling(parser, "react")
    parser.set_defaults(job=react)


def react(options: argparse.Namespace) -> dict[str, Any]:
    """Runs a :class:`ReactRequest` on one person of a motion file and writes the duets."""
    check_out(options.out)
    mode = options.mode or ReactRequest.mode
    chosen = reactor(options.model, options.prompt, options.role, mode)
    options.model = chosen.name
    actor, pose = read_actor(
        options.actor,
        person=options.person,
        start=options.start,
        end=options.end,
        keep_start=options.keep_start,
        choices=reading_choices(options),
        seconds=chosen.seconds,
    )
    fields = sampling_fields(options) | {"first_pose": pose}
    request = ReactRequest(actor=actor, prompt=options.prompt, role=options.role, mode=mode, **fields)
    result = run(request)
    written = write_result(result, options.out)
    return with_notes(written, actor)


def add_predict(commands: Any) -> None:
    """Adds ``predict`` to the shell's commands."""
    parser = commands.add_parser("predict", help="predict what comes after a motion of one person or two")
    parser.add_argument("--past", type=Path, required=True, help="the motion: .bvh, .glb, .npz …")
    add_reading(parser, "the past")
    parser.add_argument("--marker", type=float, help="second at which the past ends; the end by default")
    parser.add_argument("--seconds", type=float, default=PredictRequest.seconds, help="how many seconds to predict")
    parser.add_argument("--seed", type=int, default=PredictRequest.seed, help="of a method that draws its futures")
    parser.add_argument("--samples", type=int, default=PredictRequest.samples, help="how many futures it draws, 1 to 8")
    parser.add_argument("--model", default=PredictRequest.model, help=names_of("predict"))
    parser.add_argument("--out", type=Path, required=True, help="file to write: .npz, .bvh …")
    parser.set_defaults(job=predict)


def predict(options: argparse.Namespace) -> dict[str, Any]:
    """Runs a :class:`PredictRequest` and writes the past with what is predicted."""
    from motion.formats import read

    check_out(options.out)
    request = PredictRequest(
        motion=read(options.past, choices=reading_choices(options), longest=LONGEST),
        marker=options.marker,
        seconds=options.seconds,
        seed=options.seed,
        samples=options.samples,
        model=options.model,
    )
    result = run(request)
    assert isinstance(result, PredictResult)
    figures = {name: getattr(result, name) for name in ("past_frames", "error", "speed", "true_speed")}
    return with_notes(write_result(result, options.out) | figures, request.motion)


def check_out(path: Path) -> None:
    """Raises :class:`InputError` where no motion can be written under this name."""
    from motion.formats import can_write, suffix_of

    if not can_write(suffix_of(path)):
        raise InputError(
            f"{path.name} has a suffix that cannot be written: choose another, such as .npz, .bvh or .glb."
        )


def write_result(result: Result, out: Path) -> dict[str, Any]:
    """Writes the duets of a result and returns what the last line on stdout reports of them."""
    from motion.formats import with_stem, write

    paths: list[Path] = []
    for i, duet in enumerate(result.duets):
        number = f"_{i + 1}" if len(result.duets) > 1 else ""
        paths += write(duet, with_stem(out, number))
    for note in result.notes:
        print(note, file=sys.stderr)
    return {
        "files": [str(path) for path in paths],
        "manifest": result.manifest,
        "readouts": [{k: r[k] for k in ("before", "after", "planned") if k in r} for r in result.readouts],
        "timings": result.timings,
        "notes": list(result.notes),
    }


def run(request: GenerateRequest | ReactRequest | PredictRequest | SceneRequest) -> Result:
    """Runs a request with a step counter on stderr, where that is a terminal."""
    from webdemo.inference.engine import Engine

    show = sys.stderr.isatty()
    for event in Engine().run(request):
        if isinstance(event, Result):
            if show:
                print("\r\033[K", end="", file=sys.stderr)
            return event
        if show:
            number = f"try {event.attempt}/{event.attempts}: " if event.attempts > 1 else ""
            line = f"{number}{event.stage} {event.step}/{event.total}"
            print(f"\r\033[K{line}", end="", file=sys.stderr, flush=True)
    raise InputError("The run ended without a result: try again.")
