"""The commands about the machine and the lab: ``info``, ``benchmark``, ``serve`` and ``user``."""

from __future__ import annotations

import argparse
import json
import sys
from contextlib import closing
from pathlib import Path
from typing import Any

from acts import lexicon
from motion import InputError
from webdemo.inference.methods import failed, methods


def add_service(commands: Any) -> None:
    """Adds ``info``, ``benchmark``, ``serve`` and ``user`` to the shell's commands."""
    info_parser = commands.add_parser("info", help="show what is installed and what the models can do")
    info_parser.set_defaults(job=info)
    bench = commands.add_parser("benchmark", help="measure the speed of this machine, as figures and ratios")
    bench.add_argument("--seconds", type=float, default=10.0, help="length of the motion")
    bench.add_argument("--steps", type=int, help="denoising steps (50; with --motion and --load 8)")
    bench.add_argument("--repeats", type=int, default=3)
    bench.add_argument("--browser", action="store_true", help="also the page and the player, in Chromium")
    bench.add_argument("--load", action="store_true", help="instead: load a server on loopback with many people")
    bench.add_argument(
        "--motion",
        action="store_true",
        help="instead: planned motion beside the network's own and recorded motion, by kind of act",
    )
    bench.add_argument("--kinds", nargs="+", default=[], metavar="KIND", help="with --motion: only these kinds")
    bench.add_argument("--people", type=int, default=20, help="with --load")
    bench.add_argument("--minutes", type=float, default=2.0, help="with --load; half of them beside attackers")
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

    engine, known = Engine(), lexicon()
    card = {name: value for name, value in engine.info().items() if name != "ready"}  # nothing is loaded here
    found = {
        "model": card,
        "methods": {
            found.name: {
                "label": found.label,
                "tasks": found.tasks,
                "takes": sorted(found.takes),
                "summary": found.summary,
            }
            for found in methods()
        },
        "failed": failed(),
        "acts": {"all": len(known.entries), "own": list(known.own), "problems": list(known.problems)},
        "weights": sorted({file.parent.name for file in engine.weights.glob("*/*.safetensors")}),
        "formats": {s: {"read": can_read(s), "write": can_write(s)} for s in FORMATS},
        "versions": {name: version(name) for name in ("gradio", "torch", "numpy", "plotly", "diffusers")},
    }
    print(f"{card['name']}: {card.get('summary', '')}")
    return found


def benchmark(options: argparse.Namespace) -> dict[str, Any]:
    """Prints and returns figures of :mod:`webdemo.benchmark`."""
    if options.motion:
        from webdemo.benchmark.motion import run_motion

        return run_motion(steps=options.steps or 8, only=options.kinds)  # it prints a table
    if options.load:
        from webdemo.benchmark.load import run_load

        figures = run_load(people=options.people, minutes=options.minutes, steps=options.steps or 8)
    else:
        from webdemo.benchmark.speed import run_speed

        figures = run_speed(seconds=options.seconds, steps=options.steps or 50, repeats=options.repeats)
        if options.browser:
            from webdemo.benchmark.browser import measure_browser

            figures |= measure_browser()
    figures = {name: float(f"{v:.4g}") if isinstance(v, float) else v for name, v in figures.items()}
    for name, value in figures.items():
        print(f"{name:40} {value}")
    return figures


def serve(options: argparse.Namespace) -> dict[str, Any]:
    """Serves the page until it is stopped, or prints what is set."""
    from webdemo.server.settings import Settings, read_settings

    settings = read_settings(host=options.host, port=options.port)
    if options.print_settings:
        for name, value in settings.shown().items():
            print(f"{name} = {json.dumps(value)}  # {Settings.model_fields[name].description}")
        return settings.shown()
    from webdemo.server.process import put_off_collection

    put_off_collection()  # before Gradio is imported
    from webdemo.server.serve import serve as run

    run(settings)
    return {"served": True}


def user(options: argparse.Namespace) -> dict[str, Any]:
    """Adds, removes or lists accounts; a password is asked for, or read from a pipe.

    An account of the lab that the settings name is removed with everything that is its person's.
    """
    import getpass

    from webdemo.server.accounts.users import Users
    from webdemo.server.lab import administration_of
    from webdemo.server.settings import read_settings
    from webdemo.server.store.database import Database, sentences

    settings = read_settings()
    path = options.users or settings.users
    if path is None:
        raise InputError("Name the file of accounts: give --users FILE, or set PASDEDEUX_USERS.")
    users = Users(path)
    if options.action == "list":
        return {"users": users.names}
    if not options.name:
        raise InputError(f"Give a name: `user {options.action} NAME`.")
    if options.action == "remove":
        if path == settings.users and (settings.database or (settings.data / "history.db").is_file()):
            with closing(Database(settings.database_url)) as database, sentences():
                administration_of(settings, database, users).delete(options.name)
        else:
            users.remove(options.name)
        return {"removed": options.name}
    terminal = sys.stdin.isatty()
    password = getpass.getpass("Password: ") if terminal else sys.stdin.readline().rstrip("\n")
    if terminal and getpass.getpass("Once more: ") != password:
        raise InputError("The two passwords differ: try again.")
    done = "added" if users.add(options.name, password) else "changed"
    return {done: options.name}
