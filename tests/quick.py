"""Chooses the tests of ``pytest -m quick`` by their measured times: ``python -m tests.quick RESULTS.xml…``.

The results are pytest's (``--junitxml``) of all folders but ``tests/e2e``. Of every folder the modules that test most
in a second are taken, until they take :data:`SHARE` seconds, and one at least. The choice is written to
``tests/quick.txt``, a line for each module: its path, its number of tests and their seconds.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Iterable, Sequence
from pathlib import Path
from xml.etree import ElementTree

TESTS = Path(__file__).resolve().parent
LIST = TESTS / "quick.txt"
SHARE = 0.8
"""Seconds for each folder. There are some forty, and starting takes ten seconds: all of it stays under a minute."""
LEFT_OUT = {"e2e", "server/attacks", "server/cluster", "benchmark"}
"""Folders that need a browser, a network of processes or an idle machine."""


def is_left_out(folder: str) -> bool:
    """Whether a folder of tests, relative to ``tests``, is or lies in one of :data:`LEFT_OUT`."""
    return any(f"{folder}/".startswith(f"{left}/") for left in LEFT_OUT)


def measured(results: Iterable[Path]) -> dict[Path, tuple[int, float]]:
    """Number of tests and seconds by module, its path relative to ``tests``; modules with a failure are left out."""
    found: dict[Path, list[float]] = defaultdict(list)
    failed = set()
    for path in results:
        for case in ElementTree.parse(path).iter("testcase"):
            module = Path(*case.get("classname", "").split(".")[1:]).with_suffix(".py")
            found[module].append(float(case.get("time", 0)))
            if case.find("failure") is not None or case.find("error") is not None:
                failed.add(module)
    return {
        module: (len(times), sum(times))
        for module, times in found.items()
        if module not in failed and (TESTS / module).is_file()
    }


def chosen(modules: dict[Path, tuple[int, float]], share: float = SHARE) -> dict[Path, tuple[int, float]]:
    """The modules that are quick, of every folder those that test most in a second."""
    folders: dict[str, list[Path]] = defaultdict(list)
    for module in modules:
        folders[module.parent.as_posix()].append(module)
    quick = {}
    for folder, names in folders.items():
        if is_left_out(folder):
            continue
        left = share
        for module in sorted(names, key=lambda name: (modules[name][1] / modules[name][0], name)):
            seconds = modules[module][1]
            if left == share or seconds <= left:
                quick[module] = modules[module]
                left -= seconds
    return quick


def listed() -> dict[Path, tuple[int, float]]:
    """The modules in ``tests/quick.txt``."""
    lines = (line.split() for line in LIST.read_text().splitlines() if not line.startswith("#"))
    return {Path(name): (int(tests), float(seconds)) for name, tests, seconds in lines}


def main(argv: Sequence[str]) -> None:
    """Writes the list."""
    quick = chosen(measured(Path(name) for name in argv))
    rows = [f"{module.as_posix()} {tests} {seconds:.2f}" for module, (tests, seconds) in sorted(quick.items())]
    head = "# The modules of `pytest -m quick`, with tests and seconds; `python -m tests.quick` writes it."
    LIST.write_text("\n".join([head, *rows, ""]))


if __name__ == "__main__":
    main(sys.argv[1:])
