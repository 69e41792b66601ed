"""Makes the faults of ``tests/mutations.toml`` one by one in a copy of the sources and tells which no test finds.

``python -m tests.mutations`` runs all, ``python -m tests.mutations motion/smoothing.py …`` those of some files. Its
status is 1 if a fault survives. What all tests need is imported once; each fault then has a process of its own.
"""

from __future__ import annotations

import gc
import importlib
import multiprocessing
import os
import shutil
import sys
import tempfile
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LIST = ROOT / "tests" / "mutations.toml"
SOURCES = ("motion", "acts", "models", "webdemo", "training", "tests")
MOST_SECONDS = 300.0
"""A fault that makes a test run for longer is found, too."""
_SHARED = ("numpy", "scipy.interpolate", "scipy.ndimage", "scipy.optimize", "torch", "gradio", "spacy", "sqlalchemy")


@dataclass(frozen=True)
class Mutation:
    """A fault.

    Attributes:
        file: the source, relative to the repository.
        old: a text that occurs in it once.
        new: the text in its place.
        tests: modules of which one test at least must fail.
    """

    file: str
    old: str
    new: str
    tests: tuple[str, ...]


def mutations() -> list[Mutation]:
    """All faults of the list."""
    listed = tomllib.loads(LIST.read_text(encoding="utf-8"))["mutation"]
    return [Mutation(each["file"], each["old"], each["new"], tuple(each["tests"])) for each in listed]


def survivors(chosen: Sequence[Mutation], copy: Path) -> Iterator[tuple[Mutation, str]]:
    """The faults that no test finds, and the reason; those whose tests fail without the fault as well.

    Args:
        chosen: faults to make.
        copy: of the sources, which are changed and changed back.
    """
    sound: dict[tuple[str, ...], int] = {}
    for number, fault in enumerate(chosen, 1):
        print(f"{number}/{len(chosen)} {fault.file}: {fault.old!r:.60}", file=sys.stderr)
        if fault.tests not in sound:
            sound[fault.tests] = run(copy, fault.tests)
        if sound[fault.tests]:
            yield fault, "its tests fail without it"
            continue
        file = copy / fault.file
        before = file.read_text(encoding="utf-8")
        file.write_text(before.replace(fault.old, fault.new), encoding="utf-8")
        if run(copy, fault.tests) == 0:
            yield fault, "survives"
        file.write_text(before, encoding="utf-8")


def run(copy: Path, tests: Sequence[str]) -> int:
    """pytest's exit status for some modules in a copy, in a process of its own; -1 if it takes too long."""
    process = multiprocessing.get_context("fork").Process(target=_run, args=(copy, tests))
    process.start()
    process.join(MOST_SECONDS)
    if process.is_alive():
        process.kill()
        process.join()
        return -1
    return process.exitcode or 0


def _run(copy: Path, tests: Sequence[str]) -> None:
    import pytest

    gc.freeze()  # the parent's objects wait for threads that are not in this process
    os.chdir(copy)
    os.environ["PYTHONPATH"] = str(copy)
    sys.path[:] = [str(copy), *(path for path in sys.path if path not in ("", str(ROOT)))]
    sys.dont_write_bytecode = True
    for name in [name for name in sys.modules if name.partition(".")[0] in SOURCES]:
        del sys.modules[name]
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        os.dup2(nowhere.fileno(), 2)
        status = pytest.main(["-q", "-x", "-p", "no:cacheprovider", "-p", "no:xdist", *tests])
    os._exit(status)


def copied(to: Path) -> None:
    """Copies the sources, without compiled files, and links all else of the repository."""
    for path in ROOT.iterdir():
        if path.name in SOURCES:
            shutil.copytree(path, to / path.name, ignore=shutil.ignore_patterns("__pycache__", "weights"))
        elif path.name != ".git":
            (to / path.name).symlink_to(path)
    (to / "models" / "weights").symlink_to(ROOT / "models" / "weights")


def main(files: Sequence[str]) -> int:
    """Prints what survives; 1 if anything does."""
    chosen = [fault for fault in mutations() if not files or fault.file in files]
    for name in _SHARED:
        importlib.import_module(name)
    with tempfile.TemporaryDirectory() as folder:
        copied(Path(folder))
        left = 0
        for fault, why in survivors(chosen, Path(folder)):
            left += 1
            print(f"{fault.file}: {fault.old!r} → {fault.new!r} {why}: {', '.join(fault.tests)}", flush=True)
    print(f"{len(chosen) - left} of {len(chosen)} faults are found.")
    return int(left > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
