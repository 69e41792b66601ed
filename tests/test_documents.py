"""Every file, folder and Python name that a document mentions exists, and what it counts has that number."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import get_args

import pytest

from acts import read
from acts.shapes import Shape
from acts.things import Does
from models.weights_io import WeightsFolder
from webdemo.ui.text.examples import EXAMPLES

ROOT = Path(__file__).resolve().parents[1]
SKIPPED = {".venv", ".git", "node_modules", "runs", "outputs"}
DOCUMENTS = sorted(
    str(path.relative_to(ROOT))
    for path in ROOT.rglob("*.md")
    if not SKIPPED & set(path.relative_to(ROOT).parts)
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


def test_every_document_is_in_the_index() -> None:
    index = (ROOT / "docs" / "README.md").read_text()
    linked = {(ROOT / "docs" / target).resolve() for target in _LINK.findall(index) if "://" not in target}
    documents = [*ROOT.glob("docs/*.md"), *ROOT.glob("models/weights/*/CARD.md")]
    assert not [str(d.relative_to(ROOT)) for d in documents if d.name != "README.md" and d not in linked]


def test_the_readme_is_a_map() -> None:
    readme = (ROOT / "README.md").read_text()
    for path in (
        "models/diffusion/sampling.py",
        "webdemo/inference/finish/damping.py",
        "webdemo/inference/methods/",
    ):
        assert f"`{path}`" in readme


def test_what_does_not_exist_is_found() -> None:
    text = (
        "# A tab\n[a](gone.md) [b](README.md#start) [c](#a-tab) [d](README.md#gone) "
        "`models/gone.py` `models/weights_io.py` `motion.Clip` `motion.Gone` text"
    )
    assert missing_links(text, ROOT) == ["gone.md", "README.md#gone"]
    assert missing_paths(text) == ["models/gone.py"]
    assert missing_names(text) == ["motion.Gone"]


def shares(text: str, pattern: str) -> list[str]:
    """The groups of the only match of a pattern in a text whose lines are joined."""
    (found,) = re.findall(pattern, " ".join(text.split()))
    return list(found) if isinstance(found, tuple) else [found]


def test_the_class_models_card_has_the_scores_of_the_table() -> None:
    card = (ROOT / "models/weights/bigraphdiff/CARD.md").read_text()
    scores = (ROOT / "docs/scores.md").read_text()
    table = scores[
        scores.index("## A class to two people") : scores.index("## Reactions to a recorded person")
    ]
    rows = {name: cells for name, *cells in re.findall(r"^\| ([^|]+) \| ([^|]+) \| ([^|]+) \|$", table, re.M)}
    named, among = rows["class recognised"], rows["class among the 3 likeliest"]
    said = shares(card, r"right class in (\d+) % .* likeliest in (\d+) % \(.*: (\d+) and (\d+) %\)")
    assert said == [cell.rstrip("%") for cell in (named[0], among[0], named[1], among[1])]
    touch, apart, face = shares(
        card, r"do so in (\d+ of \d+) .* should in (\d+ of \d+), .* in (\d+ of \d+)\."
    )
    for kind, share in (("contact", touch), ("distance", apart), ("facing", face)):
        assert f"({share.replace(' of ', '/')})" in rows[f"{kind} as in a scene of the class"][0]
    said = shares(card, r"Jerk is ([\d.]+) times and foot skate ([\d.]+) times")
    for kind, ratio in zip(("jerk, m/s³", "foot skate, cm/s"), said, strict=True):
        assert f"{float(rows[kind][0]) / float(rows[kind][1]):.2f}" == ratio


@pytest.mark.parametrize("page", ["scores.md", "reactions.md"])
def test_scores_are_those_of_the_shipped_weights(page: str) -> None:
    text = " ".join((ROOT / "docs" / page).read_text().split())
    found = re.findall(r"\b(InterGen|ReGenNet|InterFormer) ([0-9a-f]{12})\b", text)
    assert {name for name, _ in found} == {"InterGen", "ReGenNet", "InterFormer"}
    for name, digest in found:
        assert WeightsFolder(ROOT / "models/weights" / name.lower()).digest.startswith(digest), name


def test_gestures_and_classes_are_counted() -> None:
    labels = WeightsFolder(ROOT / "models/weights/agent").meta["model"]["labels"]
    assert labels[0] == "nothing"
    assert f"the gesture among {len(labels) - 1}." in (ROOT / "docs/live.md").read_text()
    classes = WeightsFolder(ROOT / "models/weights/bigraphdiff").meta["model"]["labels"]
    for page in ("README.md", "models/weights/bigraphdiff/CARD.md"):
        assert f"{len(classes)} classes" in (ROOT / page).read_text()


def test_the_size_of_a_clone_is_right() -> None:
    """Every file twice, once as it is and once, packed, in ``.git``."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True)
    if listed.returncode:
        pytest.skip("not a git checkout")
    files = [ROOT / name for name in listed.stdout.split("\0") if name]
    bytes_here = sum(path.stat().st_size for path in files if path.is_file())
    (said,) = shares((ROOT / "README.md").read_text(), r"brings about (\d+) MB")
    assert 1.5 < int(said) * 1e6 / bytes_here < 2


def test_the_acts_page_names_all_shapes_and_uses_of_things() -> None:
    page = (ROOT / "docs/acts.md").read_text()
    union, _ = get_args(Shape)
    known = {get_args(shape.model_fields["do"].annotation)[0] for shape in get_args(union)}
    known |= set(get_args(Does)) - {""}
    assert {"go", "words", "passes"} <= known
    assert not sorted(name for name in known if f"`{name}`" not in page)


@pytest.mark.parametrize("page", ["README.md", "docs/using.md"])
def test_pages_name_all_endpoints(page: str) -> None:
    sources = [path.read_text() for path in (ROOT / "webdemo/ui").glob("*api.py")]
    named = re.compile(r'_publish\(self\.\w+, "(\w+)"|api_name="(\w+)"')
    published = {a or b for source in sources for a, b in named.findall(source)}
    assert {"generate", "scene", "render", "read"} <= published
    text = (ROOT / page).read_text()
    assert not sorted(name for name in published if f"`/{name}`" not in text)


def test_every_sentence_that_the_page_and_its_guide_offer_is_read_whole() -> None:
    guide = (ROOT / "docs/using.md").read_text()
    table = guide[guide.index("| kind | try |") : guide.index("People look as the words say")]
    offered = [words for _, words in EXAMPLES] + re.findall(r"\*([A-Z][^*]+)\*", table)
    assert len(offered) > 25
    assert {words: plan.unread for words in offered if (plan := read(words)).unread} == {}
