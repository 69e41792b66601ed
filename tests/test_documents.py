"""Every file, folder and Python name of the repository that a document mentions exists."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
SKIPPED = {".venv", ".git", "node_modules", "runs", "outputs"}
DOCUMENTS = sorted(
    str(path.relative_to(ROOT))
    for path in ROOT.rglob("*.md")
    if not SKIPPED & set(path.relative_to(ROOT).parts)
)
FOLDERS = "motion|models|webdemo|training|static|tests|docs"
_CODE = re.compile(r"^```.*?^```|`[^`]+`", re.DOTALL | re.MULTILINE)
_LINK = re.compile(r"\]\(([^)\s]+)\)")
_PATH = re.compile(rf"(?<![\w./-])(?:{FOLDERS})/[\w./-]*\w")
_TABLE = re.compile(r"^\[.*\]$", re.MULTILINE)  # a table's heading in a settings file, such as [models.toy]
_NAME = re.compile(r"(?<![\w./-])(?:motion|models|webdemo|training)(?:\.[A-Za-z_]\w*)+(?![\w/])")


def missing_links(text: str, folder: Path) -> list[str]:
    """Relative link targets in Markdown that do not exist; `folder` holds the document."""
    targets = [target.split("#")[0] for target in _LINK.findall(text) if "://" not in target]
    return [target for target in targets if target and not (folder / target).exists()]


def missing_paths(text: str) -> list[str]:
    """Paths from the root of the repository, in code, that do not exist."""
    found = {path for code in _CODE.findall(text) for path in _PATH.findall(code)}
    return sorted(path for path in found if "NAME" not in path and not (ROOT / path).exists())


def missing_names(text: str) -> list[str]:
    """Dotted names in code whose module does not exist or does not mention the rest."""
    found = {name for code in _CODE.findall(text) for name in _NAME.findall(_TABLE.sub("", code))}
    return sorted(name for name in found if not _defined(name.split(".")))


def _defined(parts: list[str]) -> bool:
    for count in range(len(parts), 0, -1):
        base = ROOT.joinpath(*parts[:count])
        for file in (base.with_suffix(".py"), base / "__init__.py"):
            if file.is_file():
                source = file.read_text()
                return all(re.search(rf"\b{part}\b", source) for part in parts[count:])
    return False


@pytest.mark.parametrize("document", DOCUMENTS)
def test_what_a_document_mentions_exists(document: str) -> None:
    text = (ROOT / document).read_text()
    assert not missing_links(text, (ROOT / document).parent)
    if document != "CHANGELOG.md":  # it also names what was moved or removed
        assert not missing_paths(text)
        assert not missing_names(text)


def test_every_document_is_in_the_index() -> None:
    index = (ROOT / "docs" / "README.md").read_text()
    linked = {(ROOT / "docs" / target).resolve() for target in _LINK.findall(index) if "://" not in target}
    documents = [*ROOT.glob("docs/*.md"), *ROOT.glob("models/weights/*/CARD.md")]
    assert not [str(d.relative_to(ROOT)) for d in documents if d.name != "README.md" and d not in linked]


def test_the_readme_is_a_map() -> None:
    readme = (ROOT / "README.md").read_text()
    for path in (
        "models/diffusion/sampling.py",
        "webdemo/inference/damping.py",
        "webdemo/inference/methods/",
    ):
        assert f"`{path}`" in readme


def test_what_does_not_exist_is_found() -> None:
    text = (
        "[a](gone.md) [b](README.md) `models/gone.py` `models/weights_io.py` `motion.Clip` `motion.Gone` text"
    )
    assert missing_links(text, ROOT) == ["gone.md"]
    assert missing_paths(text) == ["models/gone.py"]
    assert missing_names(text) == ["motion.Gone"]
