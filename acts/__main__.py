"""``python -m acts check [FOLDER]`` checks a folder of entries; ``read TEXT`` prints a plan; ``schema`` its schema."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from motion import InputError

from .checks import check_folder
from .lexicon import OURS
from .plan import Plan
from .reading import read


def main() -> int:
    """The command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m acts", description="The lexicon of acts.")
    commands = parser.add_subparsers(dest="command", required=True)
    check = commands.add_parser("check", help="say what is wrong with the entries of a folder")
    check.add_argument("folder", type=Path, nargs="?", default=OURS)
    reading = commands.add_parser("read", help="print the plan of a text")
    reading.add_argument("text")
    commands.add_parser("schema", help="print the JSON schema of a plan")
    given = parser.parse_args()
    try:
        if given.command == "check":
            problems = list(check_folder(given.folder))
            for problem in problems:
                print(problem)
            print(f"{len(problems)} problems." if problems else "All entries are read as their examples say.")
            return 1 if problems else 0
        if given.command == "schema":
            print(json.dumps(Plan.model_json_schema(), indent=2))
        else:
            print(json.dumps({"plan": read(given.text).model_dump(mode="json")}))
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
