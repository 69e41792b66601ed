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

from motion import Duet, InputError
from webdemo.inference.actor import FPS, read_actor
from webdemo.inference.method import Task
from webdemo.inference.methods import method, methods
from webdemo.inference.predict_request import LONGEST, PredictRequest, PredictResult
from webdemo.inference.requests import (
    GenerateRequest,
    Progress,
    ReactRequest,
    Result,
    SamplingRequest,
)


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, without the usage."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message[:1].upper()}{message[1:]}: see `{self.prog} --help`.")


def _names(task: Task) -> str:
    return " or ".join(found.name for found in methods(task))


def _add_sampling(parser: argparse.ArgumentParser, task: Task) -> None:
    """The options of a :class:`SamplingRequest`, and where its result goes."""
    default = {field.name: field.default for field in fields(SamplingRequest)}
    parser.add_argument("--out", type=Path, required=True, help="file to write: .npz, .bvh, .glb …")
    parser.add_argument("--seed", type=int, default=default["seed"])
    parser.add_argument(
        "--samples", type=int, default=default["samples"], help="how many motions to generate"
    )
    parser.add_argument(
        "--guidance", type=float, help="guidance scale s; the model's own default if not given"
    )
    parser.add_argument("--steps", type=int, help="denoising steps; the model's own default if not given")
    parser.add_argument("--damping", type=float, default=default["damping"], help="damping threshold, 0 to 1")
    parser.add_argument("--sampler", default=default["sampler"], help="ddim or dpm++")
    parser.add_argument("--model", default=default["model"], help=_names(task))
    parser.add_argument(
        "--no-cleanup", action="store_true", help="keep bones and feet as the network outputs them"
    )


def _sampling(options: argparse.Namespace) -> dict[str, Any]:
    """What :func:`_add_sampling` understood, as a request's fields."""
    names = ("seed", "samples", "guidance", "steps", "damping", "sampler", "model")
    found = {name: getattr(options, name) for name in names} | {"cleanup": not options.no_cleanup}
    for name in ("guidance", "steps"):
        if found[name] is None:
            found[name] = method(options.model).default(name, getattr(SamplingRequest, name))
    return found


def _check_out(path: Path) -> None:
    from motion.formats import can_write

    if not can_write(path.suffix):
        raise InputError(
            f"{path.name} has a suffix that cannot be written: choose another, such as .npz, .bvh or .glb."
        )


def _write(result: Result, out: Path) -> dict[str, Any]:
    """Writes a result's duets and gives what the last line on stdout says of them."""
    from motion.formats import write

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
    parser = commands.add_parser("generate", help="generate two people from a sentence or a class")
    asked = parser.add_mutually_exclusive_group(required=True)
    asked.add_argument("--prompt", help="what the two people do, in English")
    asked.add_argument("--class", dest="label", help="name of a class of BiGraphDiff, such as 'shake hands'")
    parser.add_argument("--seconds", type=float, default=GenerateRequest.seconds)
    _add_sampling(parser, "generate")
    parser.set_defaults(job=generate)


def generate(options: argparse.Namespace) -> dict[str, Any]:
    """Runs a :class:`GenerateRequest` and writes its duets."""
    _check_out(options.out)
    if options.label is not None:
        options.model = next(m.name for m in methods("generate") if "class" in m.takes)
    fields = _sampling(options)
    words = options.prompt if options.label is None else options.label
    request = GenerateRequest(prompt=words, seconds=options.seconds, **fields)
    return _write(_run(request), options.out)


def _add_react(commands: Any) -> None:
    parser = commands.add_parser("react", help="generate a second person for a given one")
    parser.add_argument("--actor", type=Path, required=True, help="the given person: .bvh, .npz, .npy …")
    parser.add_argument("--person", help="which person, a to f, if the file holds several")
    parser.add_argument("--start", type=float, default=0.0, help="first second of the file to use")
    parser.add_argument("--end", type=float, help="last second of the file to use; the end by default")
    parser.add_argument("--prompt", default=ReactRequest.prompt, help="what the two people do (optional)")
    parser.add_argument(
        "--keep-start", action="store_true",
        help="start the new person in the first pose of the file's other person (not intergen)",
    )  # fmt: skip
    parser.add_argument(
        "--role", default=ReactRequest.role, help="whether the given person acts (a) or reacts (b)"
    )
    parser.add_argument(
        "--mode", help="offline sees the whole motion; online (regennet) sees the frames so far"
    )
    parser.add_argument(
        "--stream", action="store_true",
        help="react online at the actor's pace and print each frame as a line of JSON",
    )  # fmt: skip
    parser.add_argument(
        "--own-rig", action="store_true",
        help="of a BVH: also the partner on that file's rig, as NAME_rig.bvh, in its unit and rest pose",
    )  # fmt: skip
    _add_sampling(parser, "react")
    parser.set_defaults(job=react)


def react(options: argparse.Namespace) -> dict[str, Any]:
    """Runs a :class:`ReactRequest` on one person of a motion file and writes the duets."""
    _check_out(options.out)
    actor, pose = read_actor(
        options.actor, person=options.person, start=options.start, end=options.end,
        keep_start=options.keep_start,
    )  # fmt: skip
    fields = _sampling(options) | {"start": pose}
    mode = options.mode or ("online" if options.stream else ReactRequest.mode)
    request = ReactRequest(actor=actor, prompt=options.prompt, role=options.role, mode=mode, **fields)
    if options.own_rig and options.actor.suffix.lower() != ".bvh":
        raise InputError(f"--own-rig needs the rig of a BVH file, and {options.actor.name} is none.")
    if options.stream:
        _stream(request)
    result = _run(request)
    written = _write(result, options.out)
    if options.own_rig:
        written["files"] += _on_own_rig(result, request, options)
    return written


def _on_own_rig(result: Result, request: ReactRequest, options: argparse.Namespace) -> list[str]:
    """Writes the one who was made, of every sample, on the rig of the given file."""
    from motion.formats.bvh_rig import write_on_rig

    paths: list[Path] = []
    for i, duet in enumerate(result.duets):
        number = f"_{i + 1}" if len(result.duets) > 1 else ""
        assert isinstance(duet, Duet)
        given_is_a = np.array_equal(duet.a.positions, request.actor.positions)
        made = duet.b if given_is_a else duet.a
        path = options.out.with_name(f"{options.out.stem}{number}_rig.bvh")
        paths += write_on_rig(made, options.actor, path)
    return [str(path) for path in paths]


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
    parser = commands.add_parser("predict", help="predict what comes after a motion of one person or two")
    parser.add_argument("--past", type=Path, required=True, help="the motion: .bvh, .npz, .npy …")
    parser.add_argument("--marker", type=float, help="second at which the past ends; the end by default")
    parser.add_argument(
        "--seconds", type=float, default=PredictRequest.seconds, help="how many seconds to predict"
    )
    parser.add_argument("--model", default=PredictRequest.model, help=_names("predict"))
    parser.add_argument("--out", type=Path, required=True, help="file to write: .npz, .bvh …")
    parser.set_defaults(job=predict)


def predict(options: argparse.Namespace) -> dict[str, Any]:
    """Runs a :class:`PredictRequest` and writes the past with what is predicted."""
    from motion.formats import read

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


def _run(request: GenerateRequest | ReactRequest | PredictRequest) -> Result:
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
    parser = commands.add_parser("render", help="draw a film or a contact sheet of any motion file")
    parser.add_argument("file", type=Path, help="motion file: .npz, .bvh, .npy …")
    parser.add_argument("second", type=Path, nargs="?", help="the other person, if each has a file")
    parser.add_argument(
        "--out", type=Path,
        help="film: .mp4, .webm or .gif; contact sheet: .png, .svg or .pdf; a .png beside the file by default",
    )  # fmt: skip
    parser.add_argument(
        "--beside", type=Path, action="append", default=[], help="film: a motion to show beside it"
    )
    parser.add_argument("--look", default="bodies", help="bodies, skeletons or both")
    parser.add_argument("--theme", default="light", help="light or dark")
    parser.add_argument("--view", default="threequarter", help="threequarter, front, side, top, a or b")
    parser.add_argument("--title", help="title in the picture; the file's name by default")
    parser.add_argument("--fps", type=float, default=30.0, help="film: frames a second")
    parser.add_argument("--size", default="1280x720", help="film: width and height in pixels")
    parser.add_argument("--trails", action="store_true", help="film: lines behind hands and pelvis")
    parser.add_argument(
        "--still-camera", action="store_true", help="film: the camera does not follow the people"
    )
    parser.add_argument(
        "--frames", default="8", help="contact sheet: how many moments, 1 to 24, or which, as in 0,30,75"
    )
    parser.add_argument(
        "--width", type=int, default=1600, help="contact sheet: pixels (points for .svg, .pdf)"
    )
    parser.set_defaults(job=render)


def render(options: argparse.Namespace) -> dict[str, Any]:
    """Draws a film or a contact sheet of a motion file; a BVH pair may be given as two files, or by its first."""
    from webdemo.view import film, sheet
    from webdemo.view.stage import Pane, Style

    motion = _motion(options.file, options.second)
    out = options.out or options.file.with_suffix(".png")
    title = options.file.stem if options.title is None else options.title
    suffix = out.suffix.lower()
    if suffix in film.SUFFIXES:
        beside = [_motion(path, None) for path in options.beside]
        names = [options.file.stem, *(path.stem for path in options.beside)] if beside else [""]
        film.write_film(
            [Pane(shown, name) for shown, name in zip([motion, *beside], names, strict=True)],
            out,
            fps=options.fps,
            size=_size(options.size),
            style=Style(look=options.look, trails=options.trails, theme=options.theme),
            view=options.view,
            follow=not options.still_camera,
            title=title,
        )
    elif suffix in sheet.SUFFIXES:
        sheet.write_sheet(
            motion,
            out,
            frames=_moments(options.frames),
            width=options.width,
            title=title,
            style=Style(look=options.look, names=False, theme=options.theme),
            view=options.view,
        )
    else:
        raise InputError(
            f"{out.name} cannot be rendered: give --out a name that ends in .mp4, .webm, .gif, .png, .svg or .pdf."
        )
    return {"files": [str(out)], "frames": motion.num_frames, "fps": motion.fps, "seconds": motion.seconds}


def _motion(file: Path, second: Path | None) -> Any:
    """The motion of a file, or of a pair of files of which the second may be left to be found."""
    from motion.formats import read, read_pair

    if second is None and file.stem.endswith("_a"):
        other = file.with_stem(file.stem[:-2] + "_b")
        second = other if other.exists() else None
    return read(file) if second is None else read_pair(file, second)


def _size(words: str) -> tuple[int, int]:
    """Width and height of ``"1280x720"``."""
    parts = words.lower().split("x")
    if len(parts) != 2 or not all(part.isdecimal() for part in parts):
        raise InputError(f"--size is width x height, such as 1280x720, not {words!r:.30}.")
    return int(parts[0]), int(parts[1])


def _moments(words: str) -> int | list[int]:
    """How many frames, or which."""
    parts = words.split(",")
    if not all(part.strip().isdecimal() for part in parts):
        raise InputError(f"--frames is a number or frames with commas, such as 0,30,75, not {words!r:.30}.")
    return int(parts[0]) if len(parts) == 1 else [int(part) for part in parts]


def _add_others(commands: Any) -> None:
    info_parser = commands.add_parser("info", help="show what is installed and what the models can do")
    info_parser.set_defaults(job=info)
    bench = commands.add_parser("benchmark", help="measure the speed of this machine, as figures and ratios")
    bench.add_argument("--seconds", type=float, default=10.0, help="length of the motion")
    bench.add_argument("--steps", type=int, default=50)
    bench.add_argument("--repeats", type=int, default=3)
    bench.add_argument("--browser", action="store_true", help="also the page and the player, in Chromium")
    bench.add_argument(
        "--load", action="store_true", help="instead: load a server on loopback with many people"
    )
    bench.add_argument("--people", type=int, default=20, help="with --load")
    bench.add_argument("--minutes", type=float, default=5.0, help="with --load")
    bench.set_defaults(job=benchmark)
    serve_parser = commands.add_parser("serve", help="serve the page, like `python app.py`")
    serve_parser.add_argument("--host", help="address to listen on (127.0.0.1: this machine alone)")
    serve_parser.add_argument("--port", type=int, help="port to listen on (7860)")
    serve_parser.add_argument("--print-settings", action="store_true", help="print all settings and exit")
    serve_parser.set_defaults(job=serve)
    user_parser = commands.add_parser("user", help="accounts: add, remove, list")
    user_parser.add_argument("action", choices=("add", "remove", "list"))
    user_parser.add_argument("name", nargs="?", help="name of the account; not for list")
    user_parser.add_argument("--users", type=Path, help="file of accounts; PASDEDEUX_USERS by default")
    user_parser.set_defaults(job=user)


def info(options: argparse.Namespace) -> dict[str, Any]:
    """Versions, formats and the model card."""
    from importlib.metadata import version

    from motion.formats import FORMATS, can_read, can_write
    from webdemo.inference.engine import Engine

    engine = Engine()
    card = {name: value for name, value in engine.info().items() if name != "ready"}  # nothing is loaded here
    found = {
        "model": card,
        "methods": {
            found.name: {"label": found.label, "tasks": found.tasks, "takes": sorted(found.takes)}
            for found in methods()
        },
        "weights": sorted({file.parent.name for file in engine.weights.glob("*/*.safetensors")}),
        "formats": {s: {"read": can_read(s), "write": can_write(s)} for s in FORMATS},
        "versions": {name: version(name) for name in ("gradio", "torch", "numpy", "plotly", "diffusers")},
    }
    print(f"{card['name']}: {card.get('summary', '')}")
    return found


def benchmark(options: argparse.Namespace) -> dict[str, Any]:
    """Speed figures of :mod:`webdemo.benchmark`, or how a server bears many people."""
    from webdemo.benchmark.suite import run_benchmark

    if options.load:
        from webdemo.benchmark.load import goals_missed, measure_batching, run_load

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

    from webdemo.server.accounts.users import Users
    from webdemo.server.settings import read_settings

    path = options.users or read_settings().users
    if path is None:
        raise InputError("Name the file of accounts: give --users FILE, or set PASDEDEUX_USERS.")
    users = Users(path)
    if options.action == "list":
        return {"users": users.names}
    if not options.name:
        raise InputError(f"Give a name: `user {options.action} NAME`.")
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
