"""Every regular expression of the packages that read what a stranger sends, as it is compiled.

Run as a program, it attacks each of them (:mod:`tests.pattern_attacks`) and prints what it found as JSON.
"""

from __future__ import annotations

import ast
import functools
import importlib
import json
import operator
import pkgutil
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
PACKAGES = ("motion", "models", "webdemo", "acts")
CALLS = {"compile", "match", "fullmatch", "search", "sub", "subn", "split", "findall", "finditer"}
SENTENCE = 1000
"""Characters that the reader of one sentence may be given: twice the longest prompt."""
STORY = 30_000
"""Characters of the longest story in sentences."""
ANYTHING = 100_000
"""Characters of texts whose length nothing else bounds; on them a pattern must take linear time."""
LONGEST = {
    "webdemo/inference/story/sentences.py": STORY,
    "webdemo/inference/story/toml": ANYTHING,
    "webdemo/inference/story/": SENTENCE,
}
"""The longest text that the patterns of some files see, the first that fits; all others are given :data:`ANYTHING`."""
COMPILING: dict[str, str] = {}
"""Functions that compile patterns made at run time, and what is called to make all of them."""

Found = dict[tuple[str, Any, int], None]


def record() -> Found:
    """Imports the packages and gives the (file, pattern, flags) of each regular expression that they compile."""
    found: Found = {}
    original: Callable[..., Any] = re._compile  # type: ignore[attr-defined]

    def recording(pattern: Any, flags: Any) -> Any:
        frame = sys._getframe(2)
        file = Path(frame.f_code.co_filename)
        if file.is_relative_to(ROOT) and file.relative_to(ROOT).parts[0] in PACKAGES:
            compiled = original(pattern, flags)
            found[str(file.relative_to(ROOT)), compiled.pattern, compiled.flags] = None
        return original(pattern, flags)

    re._compile = recording  # type: ignore[attr-defined]
    try:
        for package in PACKAGES:
            for module in pkgutil.walk_packages([str(ROOT / package)], f"{package}."):
                if not module.name.endswith(("__main__", ".migrations.env")):  # those run
                    importlib.import_module(module.name)
        for target in COMPILING.values():
            name, function = target.split(":")
            getattr(importlib.import_module(name), function)()
    finally:
        re._compile = original  # type: ignore[attr-defined]
    for file, line, pattern, flags in inline():
        if pattern is not None:
            compiled = re.compile(pattern, flags)
            found[file, compiled.pattern, compiled.flags] = None
        elif line not in COMPILING:
            raise SystemExit(f"{line} makes a pattern at run time: compile it where the module begins.")
    return found


def inline() -> Iterator[tuple[str, str, Any, int]]:
    """(file, file:function, pattern, flags) of the expressions in functions; a pattern made there is None."""
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            file = str(path.relative_to(ROOT))
            for function in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef):
                    for call in _calls(function):
                        yield file, f"{file}:{function.name}", *_constant(call)


def _calls(function: ast.AST) -> Iterator[ast.Call]:
    for node in ast.walk(function):
        if (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Attribute)
            and isinstance(node.func.value, ast.Name)
            and node.func.value.id == "re"
            and node.func.attr in CALLS
        ):
            yield node


def _constant(call: ast.Call) -> tuple[Any, int]:
    """The pattern of a call where it is a constant, and its flags."""
    pattern = call.args[0]
    if not isinstance(pattern, ast.Constant):
        return None, 0
    given: Any = pattern.value
    if isinstance(call.func, ast.Attribute) and call.func.attr in ("match", "fullmatch"):  # looked for in one place
        given = rf"\A(?:{given})" if isinstance(given, str) else rb"\A(?:%b)" % given
    named = {node.attr for node in ast.walk(call) if isinstance(node, ast.Attribute)}
    return given, functools.reduce(operator.or_, (f for f in re.RegexFlag if f.name in named), 0)


def longest(file: str) -> int:
    """The characters of the longest text that the patterns of a file are given."""
    return next((most for path, most in LONGEST.items() if file.startswith(path)), ANYTHING)


def main() -> None:
    """Prints ``{"patterns": how many, "slow": [one line for each that is]}``."""
    from tests.pattern_attacks import slow

    found, lines = record(), []
    for file, pattern, flags in found:
        told = slow(re.compile(pattern, flags), longest(file))
        if told is not None:
            lines.append(f"{file}: {pattern[:120]!r} is slow on {told}")
    print(json.dumps({"patterns": len(found), "slow": lines}))


if __name__ == "__main__":
    main()
