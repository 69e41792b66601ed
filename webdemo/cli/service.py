"""The commands about the machine and the lab: info, benchmark, serve, user, admin and backup."""

from __future__ import annotations

import argparse
import gc
import json
import sys
from contextlib import closing
from dataclasses import asdict
from pathlib import Path
from typing import Any

from acts import lexicon
from motion import InputError
from webdemo.inference.methods import failed, methods


def add_service(commands: Any) -> None:
    """Adds ``info``, ``benchmark``, ``serve`` and ``user`` to the shell's commands."""
    info_parser = commands.add_parser("info", help="show what is installed and what the models can do")
    info_parser.set_defaults(job=info)
    bench = commands.add_parser("benchmark", help="measure the speed of this machine")
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
    bench.add_argument("--people", type=int, default=20, help="with --load")
    bench.add_argument("--minutes", type=float, default=2.0, help="with --load")
    bench.set_defaults(job=benchmark)
    serve_parser = commands.add_parser("serve", help="serve the page, like `python app.py`")
    serve_parser.add_argument("--host", help="address to listen on (127.0.0.1: this machine alone)")
    serve_parser.add_argument("--port", type=int, help="port to listen on (7860)")
    serve_parser.add_argument("--print-settings", action="store_true", help="print all settings and exit")
    serve_parser.set_defaults(job=serve)
    user_parser = commands.add_parser("user", help="add an account, or change its password")
    user_parser.add_argument("action", choices=("add",))
    user_parser.add_argument("name", help="name of the account")
    user_parser.set_defaults(job=user)


def info(options: argparse.Namespace) -> dict[str, Any]:
    """Versions, formats and the model card."""
    from importlib.metadata import version

    from motion.formats import FORMATS
    from webdemo.inference.engine import Engine

    engine, known = Engine(), lexicon()
    card = {name: value for name, value in engine.info().items() if name != "ready"}  # nothing is loaded here
    facts = {
        "model": card,
        "methods": {
            facts.name: {
                "label": facts.label,
                "tasks": facts.tasks,
                "takes": sorted(facts.takes),
                "summary": facts.summary,
            }
            for facts in methods()
        },
        "failed": failed(),
        "acts": {"all": len(known.entries), "own": sorted(known.own)},
        "weights": sorted({file.parent.name for file in engine.weights.glob("*/*.safetensors")}),
        "formats": {f.suffix: {"read": f.reader is not None, "write": f.writer is not None} for f in FORMATS.values()},
        "versions": {name: version(name) for name in ("gradio", "torch", "numpy", "plotly", "diffusers")},
    }
    print(f"{card['name']}: {card.get('summary', '')}")
    return facts


def benchmark(options: argparse.Namespace) -> dict[str, Any]:
    """Prints and returns figures of :mod:`webdemo.benchmark`."""
    if options.motion:
        from webdemo.benchmark.motion import run_motion

        return run_motion(steps=options.steps or 8)  # it prints a table
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
    gc.disable()  # until the page is up: looking for garbage among all that is imported takes a second
    from webdemo.server.serve import serve as run

    run(settings)
    return {"served": True}


def user(options: argparse.Namespace) -> dict[str, Any]:
    """Adds an account or changes its password, which is asked for, or read from a pipe."""
    import getpass

    from webdemo.server.accounts.accounts import Accounts
    from webdemo.server.settings import read_settings
    from webdemo.server.store.database import Database, sentences

    terminal = sys.stdin.isatty()
    password = getpass.getpass("Password: ") if terminal else sys.stdin.readline().rstrip("\n")
    if terminal and getpass.getpass("Once more: ") != password:
        raise InputError("The two passwords differ: try again.")
    with closing(Database(read_settings().database)) as database, sentences():
        done = "added" if Accounts(database).add(options.name, password) else "changed"
    return {done: options.name}


# ---- people of a lab, backups --------------------------------------------------------------------


_ACTIONS = ("list", "make-admin", "end-admin", "suspend", "let-in", "delete")


def add_admin(commands: Any) -> None:
    """Adds ``admin`` to the shell's commands."""
    parser = commands.add_parser("admin", help="people's use and roles; suspend, delete")
    parser.add_argument("action", choices=_ACTIONS)
    parser.add_argument("name", nargs="?", help="of the account; not for list")
    parser.set_defaults(job=admin)


def admin(options: argparse.Namespace) -> dict[str, Any]:
    """Does one act in the lab that the settings name; a running server heeds it at once."""
    from webdemo.server.accounts.administration import Administration
    from webdemo.server.settings import settings_of_history
    from webdemo.server.store.database import Database, sentences

    settings, name, action = settings_of_history(), options.name or "", options.action
    if action != "list" and not name:
        raise InputError(f"Name the account: `admin {action} NAME`.")
    with closing(Database(settings.database)) as database, sentences():
        acts = Administration(database, settings.data)
        if action == "list":
            return {"people": [asdict(row) for row in acts.rows()]}
        if action in ("make-admin", "end-admin"):
            acts.set_role(name, admin=action == "make-admin")
        elif action in ("suspend", "let-in"):
            acts.suspend(name, suspended=action == "suspend")
        else:
            acts.delete(name)
    return {"done": action, "name": name}


def add_backup(commands: Any) -> None:
    """Adds ``backup`` to the shell's commands."""
    backup_parser = commands.add_parser("backup", help="copy the lab's database and motions, while people work")
    backup_parser.add_argument("folder", type=Path, help="holds all backups; each has a folder of its own in it")
    backup_parser.add_argument("--keep", type=int, default=0, metavar="N", help="remove all but the newest N")
    backup_parser.set_defaults(job=backup)


def backup(options: argparse.Namespace) -> dict[str, Any]:
    """Makes a backup of the lab that the settings name."""
    from webdemo.server.settings import settings_of_history
    from webdemo.server.store.backup import back_up

    settings = settings_of_history()
    if options.keep < 0:
        raise InputError("Give --keep 1 or more, or leave it out to keep all.")
    made = back_up(settings, options.folder, keep=options.keep)
    print(f"The backup is in {made}.")
    return {"backup": str(made)}
