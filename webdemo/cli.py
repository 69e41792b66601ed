"""The same jobs from a shell: ``python -m webdemo generate|react|predict|render|info|benchmark|serve|user``.

The last line on stdout is one JSON object. What goes wrong is one line on stderr that says what is wrong and
what to do, with exit code 2; a cancelled run (Ctrl+C) ends with 130, one whose reader has gone with 141. No
file is left half-written.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from webdemo.inference.actor import FPS, read_actor
from webdemo.inference.predict_request import LONGEST, METHODS, PredictRequest, PredictResult
from webdemo.inference.requests import (
    DEFAULT_GUIDANCE,
    DEFAULT_STEPS,
    GenerateRequest,
    Progress,
    ReactRequest,
    Result,
    SamplingRequest,
)
from webdemo.motion import InputError


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, without the usage."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message[:1].upper()}{message[1:]}: see `{self.prog} --help`.")


def _add_sampling(parser: argparse.ArgumentParser) -> None:
    """The options of a :class:`SamplingRequest`, and where its result goes."""
    default = {field.name: field.default for field in fields(SamplingRequest)}
    parser.add_argument("--out", type=Path, required=True, help="file to write: .npz, .bvh, .glb …")
    parser.add_argument("--seed", type=int, default=default["seed"])
    parser.add_argument("--samples", type=int, default=default["samples"], help="how many motions to draw")
    parser.add_argument("--guidance", type=float, help="guidance scale s; the model's best by default")
    parser.add_argument("--steps", type=int, default=default["steps"], help="denoising steps")
    parser.add_argument("--damping", type=float, default=default["damping"], help="threshold, 0 to 1")
    parser.add_argument("--sampler", default=default["sampler"], help="ddim or dpm++")
    parser.add_argument("--model", default=default["model"])
    parser.add_argument(
        "--no-cleanup", action="store_true", help="leave bones and feet as the network gives them"
    )


def _sampling(options: argparse.Namespace) -> dict[str, Any]:
    """What :func:`_add_sampling` understood, as a request's fields."""
    names = ("seed", "samples", "guidance", "steps", "damping", "sampler", "model")
    found = {name: getattr(options, name) for name in names} | {"cleanup": not options.no_cleanup}
    if found["guidance"] is None:
        found["guidance"] = DEFAULT_GUIDANCE.get(options.model, SamplingRequest.guidance)
    return found


def _check_out(path: Path) -> None:
    from webdemo.formats import can_write

    if not can_write(path.suffix):
        raise InputError(
            f"{path.name} has a suffix that cannot be written: choose another, such as .npz, .bvh or .glb."
        )


def _write(result: Result, out: Path) -> dict[str, Any]:
    """Writes a result's duets and gives what the last line on stdout says of them."""
    from webdemo.formats import write

    paths: list[Path] = []
    for i, duet in enumerate(result.duets):
        number = f"_{i + 1}" if len(result.duets) > 1 else ""
        paths += write(duet, out.with_stem(out.stem + number))
    for note in result.notes:
        print(note, file=sys.stderr)
    return {
        "files": [str(path) for path in paths],
        "manifest": result.manifest,
        "readouts": [{k: r[k] for k in ("before", "after")} for r in result.readouts],
        "timings": result.timings,
        "notes": list(result.notes),
    }


def _add_generate(commands: Any) -> None:
    parser = commands.add_parser("generate", help="two people from one sentence, or a class")
    asked = parser.add_mutually_exclusive_group(required=True)
    asked.add_argument("--prompt", help="what the two people do, in English")
    asked.add_argument("--class", dest="label", help="name of a class of BiGraphDiff, such as 'shake hands'")
    parser.add_argument("--seconds", type=float, default=GenerateRequest.seconds)
    _add_sampling(parser)
    parser.set_defaults(job=generate)


def generate(options: argparse.Namespace) -> dict[str, Any]:
    """Runs a :class:`GenerateRequest` and writes its duets."""
    _check_out(options.out)
    if options.label is not None:
        options.model = "bigraphdiff"
    fields = _sampling(options)
    words = options.prompt if options.label is None else options.label
    request = GenerateRequest(prompt=words, seconds=options.seconds, **fields)
    return _write(_run(request), options.out)


def _add_react(commands: Any) -> None:
    parser = commands.add_parser("react", help="a second person for a given one")
    parser.add_argument("--actor", type=Path, required=True, help="the given person: .bvh, .npz, .npy …")
    parser.add_argument("--person", help="which one, a to f, where the file holds several people")
    parser.add_argument("--start", type=float, default=0.0, help="seconds in the file")
    parser.add_argument("--end", type=float, help="seconds in the file; to its end by default")
    parser.add_argument("--prompt", default=ReactRequest.prompt, help="what the two do; may be left out")
    parser.add_argument(
        "--keep-start", action="store_true",
        help="of a file with two people: the one who is made begins as the other stands there (not intergen)",
    )  # fmt: skip
    parser.add_argument("--role", default=ReactRequest.role, help="the given person acts (a) or reacts (b)")
    parser.add_argument(
        "--mode", help="offline: in sight of the whole motion; online (regennet): of the frames so far"
    )
    parser.add_argument(
        "--stream", action="store_true",
        help="online, at the actor's pace: each frame is a line of JSON as soon as it is made",
    )  # fmt: skip
    _add_sampling(parser)
    parser.set_defaults(job=react, steps=None)


def react(options: argparse.Namespace) -> dict[str, Any]:
    """Runs a :class:`ReactRequest` on one person of a motion file and writes the duets."""
    _check_out(options.out)
    actor, pose = read_actor(
        options.actor, person=options.person, start=options.start, end=options.end,
        keep_start=options.keep_start,
    )  # fmt: skip
    fields = _sampling(options) | {"start": pose}
    if fields["steps"] is None:
        fields["steps"] = DEFAULT_STEPS.get(options.model, SamplingRequest.steps)
    mode = options.mode or ("online" if options.stream else ReactRequest.mode)
    request = ReactRequest(actor=actor, prompt=options.prompt, role=options.role, mode=mode, **fields)
    if options.stream:
        _stream(request)
    return _write(_run(request), options.out)


def _stream(request: ReactRequest) -> None:
    """Plays the actor at 30 frames a second and prints each frame of the reaction as it is made.

    A line is ``{"frame", "milliseconds", "positions": [22 × [x, y, z]]}``, the first sample's, in metres.
    """
    from webdemo.inference.engine import Engine

    frames = Engine().live(request)
    began = time.perf_counter()
    for frame in frames:
        line = {
            "frame": frame.index,
            "milliseconds": round(1000 * frame.seconds, 2),
            "positions": np.round(frame.positions[0], 4).tolist(),
        }
        print(json.dumps(line), flush=True)
        time.sleep(max(0.0, began + (frame.index + 1) / FPS - time.perf_counter()))


def _add_predict(commands: Any) -> None:
    parser = commands.add_parser("predict", help="what comes after a motion, of one person or two")
    parser.add_argument("--past", type=Path, required=True, help="the motion: .bvh, .npz, .npy …")
    parser.add_argument("--marker", type=float, help="second at which the past ends; its end by default")
    parser.add_argument("--seconds", type=float, default=PredictRequest.seconds, help="how much to predict")
    parser.add_argument("--model", default=PredictRequest.model, help=" or ".join(METHODS))
    parser.add_argument("--out", type=Path, required=True, help="file to write: .npz, .bvh …")
    parser.set_defaults(job=predict)


def predict(options: argparse.Namespace) -> dict[str, Any]:
    """Runs a :class:`PredictRequest` and writes the past with what is predicted."""
    from webdemo.formats import read

    _check_out(options.out)
    request = PredictRequest(
        motion=read(options.past, longest=LONGEST),
        marker=options.marker,
        seconds=options.seconds,
        model=options.model,
    )
    result = _run(request)
    assert isinstance(result, PredictResult)
    told = {name: getattr(result, name) for name in ("past_frames", "error", "speed", "true_speed")}
    return _write(result, options.out) | told


def _run(request: SamplingRequest | PredictRequest) -> Result:
    """Runs a request with a step counter on stderr, where that is a terminal."""
    from webdemo.inference.engine import Engine

    show = sys.stderr.isatty()
    for event in Engine().run(request):
        if isinstance(event, Result):
            if show:
                print("\r\033[K", end="", file=sys.stderr)
            return event
        if show and isinstance(event, Progress):
            print(f"\r\033[K{event.stage} {event.step}/{event.total}", end="", file=sys.stderr, flush=True)
    raise InputError("The run ended without a result: try again.")


def _add_render(commands: Any) -> None:
    parser = commands.add_parser("render", help="a contact sheet (PNG) of any motion file")
    parser.add_argument("file", type=Path, help="motion file: .npz, .bvh, .npy …")
    parser.add_argument("second", type=Path, nargs="?", help="the other person, where each has a file")
    parser.add_argument("--out", type=Path, help="the PNG; beside the motion file by default")
    parser.add_argument("--frames", type=int, default=8, help="how many evenly spaced frames, 2 to 24")
    parser.set_defaults(job=render)


def render(options: argparse.Namespace) -> dict[str, Any]:
    """Draws the contact sheet of a motion file; a BVH pair may be given as two files, or by its first."""
    from webdemo.formats import read, read_pair
    from webdemo.formats.files import replacing
    from webdemo.view.contact_sheet import contact_sheet

    if not 2 <= options.frames <= 24:
        raise InputError(f"--frames must be from 2 to 24, not {options.frames}.")
    second = options.second
    if second is None and options.file.stem.endswith("_a"):
        other = options.file.with_stem(options.file.stem[:-2] + "_b")
        second = other if other.exists() else None
    motion = read(options.file) if second is None else read_pair(options.file, second)
    out = options.out or options.file.with_suffix(".png")
    if out.suffix.lower() != ".png":
        raise InputError(f"A contact sheet is a PNG: give --out a name that ends in .png, not {out.name}.")
    with replacing(out) as temporary:
        contact_sheet(motion, temporary, frames=options.frames, title=options.file.stem)
    return {"files": [str(out)], "frames": motion.num_frames, "fps": motion.fps, "seconds": motion.seconds}


def _add_others(commands: Any) -> None:
    info_parser = commands.add_parser("info", help="what is installed, which model is shipped, what it knows")
    info_parser.set_defaults(job=info)
    bench = commands.add_parser("benchmark", help="measure speed here, as figures and as ratios")
    bench.add_argument("--seconds", type=float, default=10.0, help="length of the motion")
    bench.add_argument("--steps", type=int, default=50)
    bench.add_argument("--repeats", type=int, default=3)
    bench.add_argument("--browser", action="store_true", help="also the page and the player, in Chromium")
    bench.add_argument("--load", action="store_true", help="instead: many people at once, on loopback")
    bench.add_argument("--people", type=int, default=20, help="with --load")
    bench.add_argument("--minutes", type=float, default=5.0, help="with --load")
    bench.set_defaults(job=benchmark)
    serve_parser = commands.add_parser("serve", help="the page, as `python app.py`")
    serve_parser.add_argument("--host", help="address to listen on (127.0.0.1: this machine alone)")
    serve_parser.add_argument("--port", type=int, help="port to listen on (7860)")
    serve_parser.add_argument("--print-settings", action="store_true", help="say what is set, and end")
    serve_parser.set_defaults(job=serve)
    user_parser = commands.add_parser("user", help="accounts: add, remove, list")
    user_parser.add_argument("action", choices=("add", "remove", "list"))
    user_parser.add_argument("name", nargs="?", help="whom; not for list")
    user_parser.add_argument("--users", type=Path, help="the file; PASDEDEUX_USERS by default")
    user_parser.set_defaults(job=user)


def info(options: argparse.Namespace) -> dict[str, Any]:
    """Versions, formats and the model card."""
    from importlib.metadata import version

    from webdemo.formats import FORMATS, can_read, can_write
    from webdemo.inference.engine import Engine

    engine = Engine()
    card = {name: value for name, value in engine.info().items() if name != "ready"}  # nothing is loaded here
    found = {
        "model": card,
        "weights": sorted({file.parent.name for file in engine.weights.glob("*/*.safetensors")}),
        "formats": {s: {"read": can_read(s), "write": can_write(s)} for s in FORMATS},
        "versions": {name: version(name) for name in ("gradio", "torch", "numpy", "plotly", "diffusers")},
    }
    print(f"{card['name']}: {card.get('summary', '')}")
    return found


def benchmark(options: argparse.Namespace) -> dict[str, Any]:
    """Speed figures of :mod:`webdemo.benchmark`, or how a server bears many people."""
    from webdemo.benchmark import run_benchmark

    if options.load:
        from webdemo.server.load import goals_missed, measure_batching, run_load

        figures = measure_batching(steps=options.steps)
        figures |= run_load(people=options.people, minutes=options.minutes, steps=options.steps)
        return figures | {"goals_missed": goals_missed(figures)}
    return run_benchmark(
        seconds=options.seconds, steps=options.steps, repeats=options.repeats, browser=options.browser
    )


def serve(options: argparse.Namespace) -> dict[str, Any]:
    """Serves the page until it is stopped, or prints what is set."""
    from webdemo.server.settings import Settings, read_settings

    settings = read_settings(host=options.host, port=options.port)
    if options.print_settings:
        for name, value in settings.shown().items():
            print(f"{name} = {json.dumps(value)}  # {Settings.model_fields[name].description}")
        return settings.shown()
    from webdemo.server.serve import serve as run

    run(settings)
    return {"served": True}


def user(options: argparse.Namespace) -> dict[str, Any]:
    """Adds, removes or lists accounts; a password is asked for, or read from a pipe."""
    import getpass

    from webdemo.server.accounts import Users
    from webdemo.server.settings import read_settings

    path = options.users or read_settings().users
    if path is None:
        raise InputError("Say which file holds the accounts: --users FILE, or set PASDEDEUX_USERS.")
    users = Users(path)
    if options.action == "list":
        return {"users": users.names}
    if not options.name:
        raise InputError(f"Say whom: `user {options.action} NAME`.")
    if options.action == "remove":
        users.remove(options.name)
        return {"removed": options.name}
    terminal = sys.stdin.isatty()
    password = getpass.getpass("Password: ") if terminal else sys.stdin.readline().rstrip("\n")
    if terminal and getpass.getpass("Once more: ") != password:
        raise InputError("The two passwords differ: try again.")
    return {"added" if users.add(options.name, password) else "changed": options.name}


def main(argv: Sequence[str] | None = None) -> int:
    """Runs one command; returns the exit code."""
    parser = _Parser(prog="python -m webdemo", description="Motion of two people, from a shell.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND", parser_class=_Parser)
    for add in (_add_generate, _add_react, _add_predict, _add_render, _add_others):
        add(commands)
    began = time.perf_counter()
    try:
        options = parser.parse_args(argv)
        job: Callable[[argparse.Namespace], dict[str, Any]] = options.job
        answer = job(options)
    except InputError as error:
        print(" ".join(str(error).split()), file=sys.stderr)
        return 2
    except BrokenPipeError:  # whoever read what is printed has gone, as `head` does
        with contextlib.suppress(OSError):
            said = sys.stdout.fileno()
            os.dup2(os.open(os.devnull, os.O_WRONLY), said)
        return 141
    except KeyboardInterrupt:
        print("Stopped; nothing was written.", file=sys.stderr)
        return 130
    print(json.dumps(answer | {"wall_seconds": round(time.perf_counter() - began, 3)}))
    return 0
