"""``python -m acts check [FOLDER]`` checks entries by their own examples; ``schema`` prints the schema of a plan."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from motion import InputError
from motion.metrics.sentences.joints import Motion
from motion.metrics.sentences.language import RuleError, check, measured

from .checking import cast
from .lexicon import OURS, Entry, files, lexicon, read_file
from .plan import Plan
from .reading import read


def check_folder(folder: Path) -> Iterator[str]:
    """A sentence, with the file and the line or entry, for everything that is wrong with the entries of a folder."""
    entries: dict[str, Entry] = {}
    problems = [problem for path in files(folder) for problem in read_file(path, entries)]
    yield from problems
    if problems:
        return
    folders = () if folder.resolve() == OURS.resolve() else (folder.resolve(),)
    for name, entry in entries.items():
        yield from check_entry(name, entry, folders)


def check_entry(name: str, entry: Entry, folders: tuple[Path, ...] = ()) -> Iterator[str]:
    """A sentence for each example of an entry that is not read as it should be."""
    where = f"{entry.group}.toml, [{name}]"
    if entry.alone and entry.alone not in lexicon(folders).entries:
        yield f"{where}: alone = “{entry.alone}” is not an act."
    for sentence in entry.reads:
        acts = [act.act for act in read(sentence, folders).acts if act.happens or not entry.shown]
        if entry.shown and name not in acts:
            yield f"{where}: “{sentence}” is not read as {name} but as {', '.join(acts) or 'nothing'}."
        elif acts and not entry.shown:
            yield f"{where}: “{sentence}” is read as {', '.join(acts)}, and nothing of it can be shown."
    for sentence in entry.ignores:
        if any(act.act == name and act.happens for act in read(sentence, folders).acts):
            yield f"{where}: “{sentence}” is read as {name}, which it should not be."
    noise = Motion(np.random.default_rng(0).normal(size=(2, 30, 22, 3)))
    for rule in entry.rule:
        try:
            check(cast(rule, "a", "b"), noise)
            measured(cast(rule, "a", "b"), noise)
        except RuleError as error:
            yield f"{where}: {error}"


def main() -> int:
    """The command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m acts", description="The lexicon of acts.")
    commands = parser.add_subparsers(dest="command", required=True)
    checking = commands.add_parser("check", help="say what is wrong with the entries of a folder")
    checking.add_argument("folder", type=Path, nargs="?", default=OURS)
    commands.add_parser("schema", help="print the JSON schema of a plan")
    given = parser.parse_args()
    try:
        if given.command == "check":
            problems = list(check_folder(given.folder))
            for problem in problems:
                print(problem)
            print(f"Problems: {len(problems)}." if problems else "All entries are read as their examples say.")
            return 1 if problems else 0
        print(json.dumps(Plan.model_json_schema(), indent=2))
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
