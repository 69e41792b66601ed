"""The list of faults that the tests must find, and the command that makes them."""

from pathlib import Path

import pytest

from tests.mutations import LIST, ROOT, Mutation, mutations, survivors

ALL = mutations()


def test_the_list_covers_what_people_rely_on() -> None:
    assert len(ALL) >= 60
    for floor in ("motion/", "acts/", "webdemo/inference/", "webdemo/server/"):
        assert sum(fault.file.startswith(floor) for fault in ALL) >= 12
    assert len({(fault.file, fault.old) for fault in ALL}) == len(ALL), LIST


@pytest.mark.parametrize("fault", ALL, ids=lambda fault: f"{fault.file}: {fault.old[:40]}")
def test_a_fault_can_be_made_and_has_tests(fault: Mutation) -> None:
    source = (ROOT / fault.file).read_text(encoding="utf-8")
    assert source.count(fault.old) == 1, "the source has changed: bring the list up to date"
    compile(source.replace(fault.old, fault.new), fault.file, "exec")
    assert fault.tests and all((ROOT / test).is_file() for test in fault.tests)


def test_what_survives_is_told(tmp_path: Path) -> None:
    (tmp_path / "double.py").write_text("def double(x):\n    return 2 * x\n")
    (tmp_path / "test_good.py").write_text("from double import double\ndef test():\n    assert double(3) == 6\n")
    (tmp_path / "test_weak.py").write_text("from double import double\ndef test():\n    assert double(0) == 0\n")
    (tmp_path / "test_bad.py").write_text("def test():\n    assert False\n")
    faults = [Mutation("double.py", "2 * x", "3 * x", (f"test_{name}.py",)) for name in ("good", "weak", "bad")]
    told = [(fault.tests[0], why) for fault, why in survivors(faults, tmp_path)]
    assert told == [("test_weak.py", "survives"), ("test_bad.py", "its tests fail without it")]
    assert "2 * x" in (tmp_path / "double.py").read_text()
