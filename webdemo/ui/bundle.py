"""Modules of the page's own scripts as one script, so that a browser need not ask for each of them."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable
from pathlib import Path

_IMPORT = re.compile(r'^import (\* as )?(\w+|\{.*?\}) from "(.+?)".*;$', re.MULTILINE)
_EXPORT = re.compile(r"^export (?:(default)|(.*?(?:function|class|const) (\w+)))", re.MULTILINE)


def bundled(entries: Iterable[Path], address: Callable[[Path], str]) -> str:
    """A script that keeps what modules export in ``window.pdModules``, by their addresses.

    Each module has a function's scope of its own, after those that it imports. They are written with one import a line
    and import each other in no circle.

    Args:
        entries: the modules; what they import comes with them.
        address: of a file, which ``import.meta.url`` gives.
    """
    names: dict[Path, str] = {}
    scopes: list[str] = []

    def imported(path: Path) -> str:
        """The name of what a module exports."""
        if path not in names:
            names[path] = f"module{len(names)}"
            code = path.read_text(encoding="utf-8")
            code = f"export default {code};\n" if path.suffix == ".json" else code
            scopes.append(f"const {names[path]} = (() => {{\n{scope(path, code)}}})();\n")
        return names[path]

    def scope(path: Path, code: str) -> str:
        def taken(found: re.Match[str]) -> str:
            whole, given, other = found.groups()
            module = imported((path.parent / other).resolve())
            return f"const {given} = {module}{'' if whole or given.startswith('{') else '.default'};"

        code = _IMPORT.sub(taken, code).replace("import.meta.url", json.dumps(address(path)))
        own = ["default: exported" if default else name for default, _, name in _EXPORT.findall(code)]
        code = _EXPORT.sub(lambda found: found[2] or "const exported =", code)
        return f"{code}return {{ {', '.join(own)} }};\n"

    kept = ", ".join(f"{json.dumps(address(path))}: {imported(path)}" for path in entries)
    return f'(() => {{\n"use strict";\n{"".join(scopes)}window.pdModules = {{ {kept} }};\n}})();'
