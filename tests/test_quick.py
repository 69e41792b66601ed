"""``pytest -m quick`` runs some tests of every package in less than a minute."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.quick import TESTS, chosen, is_left_out, listed, main

FOLDERS = {
    folder for path in TESTS.rglob("test_*.py") if not is_left_out(folder := path.parent.relative_to(TESTS).as_posix())
}


def test_every_folder_of_tests_is_represented() -> None:
    quick = listed()
    assert not [module for module in quick if not (TESTS / module).is_file()]
    folders = {module.parent.as_posix() for module in quick}
    assert folders == FOLDERS, "add a quick module of each, or choose anew: python -m tests.quick"


def test_there_are_many_and_they_took_little() -> None:
    written = sum(len(re.findall(r"^\s*def test_", (TESTS / m).read_text(), re.M)) for m in listed())
    assert written > 300
    assert sum(seconds for _, seconds in listed().values()) < 40


def test_they_are_marked(request: pytest.FixtureRequest) -> None:
    here = Path(__file__).relative_to(TESTS)
    assert here in listed() and request.node.get_closest_marker("quick")


def test_the_modules_that_test_most_in_a_second_are_taken() -> None:
    modules = {
        "a/test_1.py": (10, 0.1),
        "a/test_2.py": (1, 0.6),
        "a/test_3.py": (10, 0.5),
        "b/test_4.py": (1, 9.0),
        "e2e/test_5.py": (9, 0.1),
        "e2e/tour/test_6.py": (9, 0.1),
    }
    found = chosen({Path(name): times for name, times in modules.items()}, share=0.65)
    assert [module.as_posix() for module in found] == ["a/test_1.py", "a/test_3.py", "b/test_4.py"]


def test_the_list_is_written_from_results(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    case = '<testcase classname="tests.{}" name="x" time="{}">{}</testcase>'
    cases = [
        case.format("test_quick", 0.25, ""),
        case.format("test_quick", 0.5, ""),
        case.format("test_structure", 0.1, "<failure/>"),
        case.format("gone.test_gone", 0.1, ""),
    ]
    (tmp_path / "results.xml").write_text(f"<testsuites>{''.join(cases)}</testsuites>")
    monkeypatch.setattr("tests.quick.LIST", tmp_path / "quick.txt")
    main([str(tmp_path / "results.xml")])
    assert listed() == {Path("test_quick.py"): (2, 0.75)}
