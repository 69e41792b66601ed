"""No regular expression takes long on the longest text that it may be given, whatever the text.

A careless one takes quadratic or exponential time where a part of it can match the same text in many ways, so each is
tried on texts that repeat a few characters and end in some that do not fit. Run as a program, this tries all of them.
"""

from __future__ import annotations

import ast
import functools
import importlib
import json
import operator
import pkgutil
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from webdemo.inference.requests.sampling import MAX_PROMPT
from webdemo.inference.story.sentences import LONGEST_READ, MOST_WORDS

ROOT = Path(__file__).parents[1]
PACKAGES = ("motion", "models", "webdemo", "acts")
CALLS = {"compile", "match", "fullmatch", "search", "sub", "subn", "split", "findall", "finditer"}
ANYTHING = 20_000
"""Characters of texts whose length nothing else bounds; on them a pattern must take linear time."""
LONGEST = {
    "webdemo/inference/story/sentences.py": MOST_WORDS,
    "webdemo/inference/story/toml": ANYTHING,
    "webdemo/inference/story/": LONGEST_READ,
}
"""Characters of the longest text that the patterns of some files see, the first that fits."""
SLOWEST = 0.05
"""Seconds of processor time that a pattern may take, on a machine of the usual pace."""
PUMPS = (
    *(" ", "a", "1", ",", "\n", "(", '"', "-", "é", "\t\n", "[[a]]\n", "a ", "as ", "the ", ", ", ". ", "A ", "B. "),
    *("a's ", "aly ", "slowly ", "and ", "person a ", "the other person ", "is ", "aing ", "1 ", "1e", "0.", "a=a "),
)
ENDS = ("", "\0", " \n")

Pattern = re.Pattern[Any]


def patterns() -> dict[tuple[str, Any, int], Pattern]:
    """All that the packages compile when they are imported or write into a function, by (file, pattern, flags)."""
    found: dict[tuple[str, Any, int], Pattern] = {}
    original = re._compile  # type: ignore[attr-defined]

    def recording(pattern: Any, flags: Any) -> Pattern:
        file = Path(sys._getframe(2).f_code.co_filename)
        compiled: Pattern = original(pattern, flags)
        if file.is_relative_to(ROOT) and file.relative_to(ROOT).parts[0] in PACKAGES:
            found[str(file.relative_to(ROOT)), compiled.pattern, compiled.flags] = compiled
        return compiled

    re._compile = recording  # type: ignore[attr-defined]
    try:
        for package in PACKAGES:
            for module in pkgutil.walk_packages([str(ROOT / package)], f"{package}."):
                if not module.name.endswith("__main__"):  # which runs
                    importlib.import_module(module.name)
    finally:
        re._compile = original  # type: ignore[attr-defined]
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            for compiled in _written(ast.parse(path.read_text(encoding="utf-8")), path):
                found[str(path.relative_to(ROOT)), compiled.pattern, compiled.flags] = compiled
    return found


def _written(tree: ast.AST, path: Path) -> Iterator[Pattern]:
    """The patterns in a module's functions, which must be constants."""
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]
    for call in (node for function in functions for node in ast.walk(function) if isinstance(node, ast.Call)):
        of = call.func
        if isinstance(of, ast.Attribute) and ast.unparse(of.value) == "re" and of.attr in CALLS:
            if not isinstance(given := call.args[0], ast.Constant):
                raise SystemExit(
                    f"{path}:{call.lineno} makes a pattern at run time: compile it where the module begins."
                )
            anchored = rf"\A(?:{given.value})" if of.attr in ("match", "fullmatch") else given.value
            named = {node.attr for node in ast.walk(call) if isinstance(node, ast.Attribute)}
            yield re.compile(
                anchored,  # type: ignore[arg-type]
                functools.reduce(operator.or_, (flag for flag in re.RegexFlag if flag.name in named), 0),
            )


def slow(pattern: Pattern, longest: int) -> str:
    """The text on which a pattern takes longer than :data:`SLOWEST`, in a few words; "" if there is none."""
    own = re.findall(r"[\w.-]{2,}", str(pattern.pattern))
    for pump in (*PUMPS, *own):
        for end in ENDS:
            for length in sorted({min(25 * len(pump), longest), min(2_000, longest), longest}):
                text = (pump * (length // len(pump)))[: length - len(end)] + end
                if all(seconds(pattern, text) > SLOWEST * pace() for _ in range(2)):  # not for another reason, once
                    return f"{text[:80]!r} … {text[-12:]!r} ({len(text)} characters)"
    return ""


@functools.cache
def pace() -> float:
    """How many times as long as usual this machine takes to match a pattern, and at least 1."""
    return max(1.0, min(seconds(re.compile(r"[a-z]{80}!"), "a" * 200_000) for _ in range(5)) / 0.02)


def seconds(pattern: Pattern, text: str) -> float:
    """Processor seconds in which a pattern is looked for throughout a text, and held against the whole of it."""
    given: Any = text if isinstance(pattern.pattern, str) else text.encode()
    began = time.process_time()
    for _ in pattern.finditer(given):
        pass
    pattern.fullmatch(given)
    return time.process_time() - began


@pytest.mark.parametrize("pattern", [r"(?:a|a?b)+\s+$", r"\s+$", rb"[ \t]*\n[ \t]*M"])
def test_a_pattern_of_quadratic_time_is_found(pattern: str | bytes) -> None:
    assert slow(re.compile(pattern), ANYTHING)


def test_the_longest_sentence_is_no_shorter_than_a_prompt() -> None:
    assert LONGEST_READ >= MAX_PROMPT


def test_every_pattern_of_the_packages_is_fast() -> None:
    """In a process of its own, which is ended where a pattern does not end."""
    command = [sys.executable, "-m", "tests.test_patterns"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=280)
    assert done.returncode == 0, done.stderr[-2000:]
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["patterns"] > 25
    assert found["slow"] == []


if __name__ == "__main__":
    every, lines = patterns(), []
    for (path, text, _), compiled in every.items():
        most = next((most for prefix, most in LONGEST.items() if path.startswith(prefix)), ANYTHING)
        if told := slow(compiled, most):
            lines.append(f"{path}: {text[:120]!r} is slow on {told}")
    print(json.dumps({"patterns": len(every), "slow": lines}))
