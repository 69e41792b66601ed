"""Every file, folder and Python name that a document mentions exists; sentences that are offered are read whole."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from acts import read
from webdemo.ui.text.examples import EXAMPLES

ROOT = Path(__file__).resolve().parents[1]
SKIPPED = {".venv", ".git", "node_modules", "runs", "outputs"}
DOCUMENTS = sorted(
    str(path.relative_to(ROOT)) for path in ROOT.rglob("*.md") if not SKIPPED & set(path.relative_to(ROOT).parts)
)
FOLDERS = "motion|models|webdemo|training|static|tests|docs"
_CODE = re.compile(r"^```.*?^```|`[^`]+`", re.DOTALL | re.MULTILINE)
_CODE_BLOCK = re.compile(r"^```.*?^```", re.DOTALL | re.MULTILINE)
_HEADING = re.compile(r"^#+ (.+)$", re.MULTILINE)
_LINK = re.compile(r"\]\(([^)\s]+)\)")
_PATH = re.compile(rf"(?<![\w./-])(?:{FOLDERS})/[\w./-]*\w")
_TABLE = re.compile(r"^\[.*\]$", re.MULTILINE)  # a table's heading in a settings file, such as [models.toy]
_NAME = re.compile(r"(?<![\w./-])(?:motion|models|webdemo|training)(?:\.[A-Za-z_]\w*)+(?![\w/])")


def missing_links(text: str, folder: Path) -> list[str]:
    """Relative link targets in Markdown that do not exist, headings included; `folder` holds the document."""
    missing = []
    for target in (target for target in _LINK.findall(text) if "://" not in target):
        name, _, heading = target.partition("#")
        path = folder / name
        if not path.exists() or (heading and heading not in anchors(path.read_text() if name else text)):
            missing.append(target)
    return missing


def anchors(text: str) -> set[str]:
    """The names by which links reach the headings of a Markdown text."""
    headings = _HEADING.findall(_CODE_BLOCK.sub("", text))
    return {re.sub(r"[^\w -]", "", heading).lower().replace(" ", "-") for heading in headings}


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


def test_every_module_that_a_document_calls_by_its_name_alone_exists() -> None:
    modules = {path.name for folder in (*FOLDERS.split("|"), "acts") for path in (ROOT / folder).rglob("*.py")}
    written = {"toy.py", "ours.py", "app.py"}  # by the reader, and at the root
    named = {
        (document, name)
        for document in ("README.md", "CONTRIBUTING.md", *(d for d in DOCUMENTS if d.startswith("docs/")))
        for name in re.findall(r"`(\w+\.py)`", (ROOT / document).read_text())
    }
    assert not {each for each in named if each[1] not in modules | written}


def test_every_document_is_in_the_index() -> None:
    index = (ROOT / "docs" / "README.md").read_text()
    linked = {(ROOT / "docs" / target).resolve() for target in _LINK.findall(index) if "://" not in target}
    documents = [*ROOT.glob("docs/*.md"), *ROOT.glob("models/weights/*/CARD.md")]
    assert not [str(d.relative_to(ROOT)) for d in documents if d.name != "README.md" and d not in linked]


def test_what_does_not_exist_is_found() -> None:
    text = (
        "# A tab\n[a](gone.md) [b](README.md#start) [c](#a-tab) [d](README.md#gone) "
        "`models/gone.py` `models/weights_io.py` `motion.Clip` `motion.Gone` text"
    )
    assert missing_links(text, ROOT) == ["gone.md", "README.md#gone"]
    assert missing_paths(text) == ["models/gone.py"]
    assert missing_names(text) == ["motion.Gone"]


def test_every_sentence_that_the_page_and_its_guide_offer_is_read_whole() -> None:
    guide = (ROOT / "docs/using.md").read_text()
    table = guide[guide.index("| kind | try |") : guide.index("People look as the words say")]
    offered = [words for _, words in EXAMPLES] + re.findall(r"\*([A-Z][^*]+)\*", table)
    assert len(offered) > 15
    assert {words: plan.unread for words in offered if (plan := read(words)).unread} == {}
