"""The floors of the house: who may import whom, and what no file may say."""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("motion", "acts", "models", "webdemo", "training")
TORCH_FREE = ("motion", "acts", "webdemo.view", "webdemo.study", "webdemo.ui")
"""The page draws before the networks load, so nothing it needs may wait for torch."""


def module_name(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


FILES = {
    module_name(path): path
    for path in sorted([ROOT / "app.py", *(p for name in PACKAGES for p in (ROOT / name).rglob("*.py"))])
}


def package_of(module: str) -> str:
    """The floor a module stands on: ``motion`` for ``motion.clip``."""
    parts = module.split(".")
    return ".".join(parts[:2]) if parts[0] == "webdemo" else parts[0]


def is_type_checking(node: ast.stmt) -> bool:
    return isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)


def statements(tree: ast.AST, *, at_import: bool) -> Iterator[ast.Import | ast.ImportFrom]:
    """Import statements; with ``at_import`` only those that run when the module is imported."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield node
        elif not at_import or not (
            isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda) or is_type_checking(node)
        ):
            yield from statements(node, at_import=at_import)


@cache
def imports(module: str, at_import: bool) -> frozenset[str]:
    """Absolute names of the modules that a module imports, ours and others'."""
    path = FILES[module]
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    found: set[str] = set()
    for node in statements(ast.parse(path.read_text()), at_import=at_import):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
            continue
        base = node.module or ""
        if node.level:
            above = package.split(".")[: len(package.split(".")) - node.level + 1]
            base = ".".join([*above, *filter(None, [base])])
        submodules = {f"{base}.{alias.name}" for alias in node.names} & FILES.keys()
        found |= submodules or {base}
    return frozenset(found)


def ours(module: str, *, at_import: bool = False) -> set[str]:
    """Our modules among a module's imports."""
    return {name for name in imports(module, at_import) if name in FILES}


def reached(module: str) -> set[str]:
    """All modules of ours that importing a module runs, with the packages that hold them."""
    seen, waiting = set(), {module}
    while waiting:
        name = waiting.pop()
        seen.add(name)
        parents = {".".join(name.split(".")[:i]) for i in range(1, name.count(".") + 1)} & FILES.keys()
        waiting |= (ours(name, at_import=True) | parents) - seen
    return seen


def lint_imports(config: Path) -> int:
    """The exit code of import-linter, in a process of its own: it sets up the logs of the one that it runs in."""
    code = "import sys; from importlinter.cli import lint_imports; sys.exit(lint_imports(sys.argv[1], no_cache=True))"
    return subprocess.run([sys.executable, "-c", code, str(config)], cwd=ROOT, capture_output=True).returncode


def test_imports_keep_the_contracts() -> None:
    """The floors are contracts of import-linter in pyproject.toml, which follows late and type-only imports too."""
    assert lint_imports(ROOT / "pyproject.toml") == 0


def test_modules_form_no_circle() -> None:
    """Late imports and those for types count: what is hidden from Python still ties two modules together.

    But the server hands its objects to the page, which knows them by their types alone.
    """
    below = {module: ours(module, at_import=module == "webdemo.ui.context") - {module} for module in FILES}
    while below:
        settled = {module for module, needs in below.items() if not needs & below.keys()}
        assert settled, f"these import each other: {below}"
        below = {module: needs for module, needs in below.items() if module not in settled}


def test_the_registry_names_pipelines_that_exist() -> None:
    """Shipped methods name their pipelines as text, since requests read the registry and pipelines read requests."""
    registry = FILES["webdemo.inference.built_in"].read_text()
    named = re.findall(r'load_pipeline[,(] ?"([^"]+)"', registry)
    assert len(named) == registry.count("    Method(") > 5
    for place in named:
        module, _, name = place.partition(".")
        assert f"\nclass {name}" in FILES[f"webdemo.inference.pipelines.{module}"].read_text()


@pytest.mark.parametrize("package", TORCH_FREE)
def test_page_waits_for_no_torch(package: str) -> None:
    modules = {module for module in FILES if package_of(module) == package}
    assert modules
    heavy = {
        f"{module}, through {name}"
        for module in modules
        for name in reached(module)
        if any(found.partition(".")[0] == "torch" for found in imports(name, True))
    }
    assert not heavy


def test_no_file_names_a_place_on_somebodys_machine() -> None:
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True)
    if listed.returncode:
        pytest.skip("not a git checkout")
    place = re.compile(rb"(?<![\w.~/-])/(?:work|home|root|Users|tmp|mnt|media|srv)/[\w.-]")
    found = {}
    for name in filter(None, listed.stdout.split("\0")):
        path = ROOT / name
        if name.startswith("static/camera/mediapipe/"):  # others' files, unchanged
            continue
        data = path.read_bytes() if path.is_file() else b""
        if b"\0" not in data[:8000] and (match := place.search(data)):
            found[name] = match[0]
    assert not found


HEAVY = """
heavy = {"plotly.graph_objs", "networkx", "trimesh", "sympy", "scipy.interpolate", "scipy.optimize", "scipy.signal",
         "scipy.stats", "matplotlib.pyplot"}
import sys
print(sorted(heavy & sys.modules.keys()))
"""
PAGE = "import webdemo.server.serve"
NETWORKS = """
import numpy as np, webdemo.inference.engine, webdemo.inference.pipelines.intergen
from models.motion_tokens import TokenLayout
from motion import SMPL22, Duet
from motion.formats.glb_writer import glb_bytes
TokenLayout().fit(10)
glb_bytes(Duet.from_positions(np.stack([[SMPL22.rest_positions()] * 2] * 2), fps=30))
"""


@pytest.mark.parametrize("start", [PAGE, NETWORKS])
def test_what_the_page_and_a_request_do_not_use_is_not_loaded(start: str) -> None:
    command = [sys.executable, "-c", f"{start}\n{HEAVY}"]
    ran = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert ran.stdout.strip() == "[]", ran.stderr


TESTED_FROM_OUTSIDE = {
    "e2e",  # the page in a browser
    "server/attacks",  # a server as an attacker sees it
}
"""Folders of tests that belong to no one package."""


def test_tests_lie_where_their_packages_lie() -> None:
    folders = {path.parent.relative_to(ROOT / "tests").as_posix() for path in (ROOT / "tests").rglob("test_*.py")}
    mirrored = {name for name in folders if (ROOT / name).is_dir() or (ROOT / "webdemo" / name).is_dir()}
    assert len(mirrored) > 20
    assert folders - mirrored == TESTED_FROM_OUTSIDE & folders
