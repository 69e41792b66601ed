"""The walk of a request through the code: ``python -m tests.walk "A waves with the left hand while B bows."``.

Counts the project's own files that run and the moves between them, where a move is a call into another file together
with its return, and prints the rooms that they are in. Imports and loading are done before, with another sentence. The
walks:

- *page*: a sentence from the handler of the page's button to its last update;
- *engine*: the same sentence as a request to the engine;
- *clip*: a recorded person whom somebody reacts to, by the words;
- *plan*: the sentence's plan of acts in place of its words;
- *threshold*: the files of the engine's walk that name the damping threshold, and what the correction adds to a walk.
"""

from __future__ import annotations

import argparse
import functools
import os
import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

os.environ.setdefault("GRADIO_ANALYTICS_ENABLED", "False")

import gradio as gr

from acts import read
from motion import Duet
from motion.formats import read as read_motion
from tests.ui.stub_page import stub_context
from webdemo.inference import Engine, GenerateRequest, ReactRequest
from webdemo.ui.tabs.generate import GenerateTab

ROOT = Path(__file__).resolve().parents[1]
OURS = tuple(str(ROOT / package) + os.sep for package in ("acts", "models", "motion", "webdemo"))
FIELDS = {"seconds": 4.0, "samples": 1, "guidance": 4.3, "steps": 8, "damping": 0.7, "tries": 1}


@dataclass
class Walk:
    """What ran.

    Attributes:
        calls: number of calls by file.
        moves: number of moves into each file.
        codes: the functions that ran.
    """

    calls: Counter[str] = field(default_factory=Counter)
    moves: Counter[str] = field(default_factory=Counter)
    codes: set[CodeType] = field(default_factory=set)

    def rooms(self) -> dict[str, tuple[int, int]]:
        """Files and moves by room: a package, or a part of one."""
        files, moves = Counter[str](), Counter[str]()
        for name in self.calls:
            parts = Path(name).relative_to(ROOT).parts
            room = "/".join(parts[: min(3 if parts[0] == "webdemo" else 2, len(parts) - 1)])
            files[room] += 1
            moves[room] += self.moves[name]
        return {room: (files[room], moves[room]) for room in sorted(files, key=lambda room: -moves[room])}


@contextmanager
def walked() -> Iterator[Walk]:
    """Counts what runs inside, in this thread and in those that it starts."""
    walk = Walk()

    def look(frame: FrameType, event: str, _: Any) -> None:
        name = frame.f_code.co_filename
        if event != "call" or not name.startswith(OURS):
            return
        walk.calls[name] += 1
        walk.codes.add(frame.f_code)
        back = frame.f_back
        while back is not None and not back.f_code.co_filename.startswith(OURS):
            back = back.f_back
        if back is not None and back.f_code.co_filename != name:
            walk.moves[name] += 1

    threading.setprofile(look)
    sys.setprofile(look)
    try:
        yield walk
    finally:
        sys.setprofile(None)
        threading.setprofile(None)  # type: ignore[arg-type]


def forget() -> None:
    """Empties our caches of what was asked before, which hold more entries than those of what is loaded."""
    ours = [module for name, module in sys.modules.items() if name.startswith(("acts.", "webdemo."))]
    for cached in {id(part): part for module in ours for part in vars(module).values()}.values():
        if isinstance(cached, functools._lru_cache_wrapper) and (cached.cache_info().maxsize or 0) >= 100:
            cached.cache_clear()


def walks(prompt: str) -> dict[str, Walk]:
    """The walks of a sentence by name, and that of the engine without the correction as "undamped"."""
    engine = Engine()
    tab = GenerateTab(stub_context(engine))
    with gr.Blocks():
        tab.build(gr.State())

    def page(words: str, seed: int) -> None:
        for _ in tab.run("walk", {**FIELDS, "prompt": words, "seed": seed}):
            pass

    def run(request: Any) -> None:
        for _ in engine.run(request):
            pass

    given = read_motion(ROOT / "static" / "examples" / "push.npz")
    assert isinstance(given, Duet)
    jobs: dict[str, Callable[[str, int], None]] = {
        "page": page,
        "engine": lambda words, seed: run(GenerateRequest(prompt=words, seed=seed, **FIELDS)),
        "clip": lambda words, seed: run(
            ReactRequest(actor=given.a, prompt=words, model="intergen", steps=8, seed=seed)
        ),
        "plan": lambda words, seed: run(GenerateRequest(acts=read(words), seed=seed, **FIELDS)),
        "undamped": lambda words, seed: run(GenerateRequest(prompt=words, seed=seed, **FIELDS | {"damping": 0.0})),
    }
    found = {}
    for seed, (name, job) in enumerate(jobs.items()):  # another seed each: no window of a scene is kept
        job("One person bows to the other and walks away.", seed)
        forget()
        with walked() as found[name]:
            job(prompt, seed)
    return found


def main() -> None:
    """Prints the walks of a sentence."""
    parser = argparse.ArgumentParser(prog="python -m tests.walk", description=__doc__.partition("\n")[0])
    parser.add_argument("prompt", nargs="?", default="A waves with the left hand while B bows.")
    found = walks(parser.parse_args().prompt)
    undamped, engine = found.pop("undamped"), found["engine"]
    for name, walk in found.items():
        print(f"{name}: {len(walk.calls)} files, {walk.moves.total()} moves")
        for room, (files, moves) in walk.rooms().items():
            print(f"    {room}: {files} files, {moves} moves")
    naming = {
        code.co_filename
        for code in engine.codes
        if any(name.strip("_") == "damping" for name in (*code.co_names, *code.co_varnames))
    }
    files = len(engine.calls.keys() - undamped.calls.keys())
    moves = engine.moves.total() - undamped.moves.total()
    print(
        f"threshold: named in {len(naming)} of the engine's {len(engine.calls)} files; "
        f"the correction adds {files} files and {moves} moves"
    )
    for name in sorted(naming):
        print(f"    {Path(name).relative_to(ROOT)}")


if __name__ == "__main__":
    main()
