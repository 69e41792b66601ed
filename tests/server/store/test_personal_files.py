"""A person owns what lies in their folder, wherever links lead."""

from pathlib import Path

import pytest

from webdemo.server.store import scratch as personal_files
from webdemo.server.store.scratch import folder_of, owns


@pytest.fixture(autouse=True)
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(personal_files, "get_upload_folder", lambda: str(tmp_path))
    return tmp_path


def test_a_folder_does_not_show_its_person(root: Path) -> None:
    assert folder_of("ann").parent == root and "ann" not in folder_of("ann").name
    assert folder_of("ann") != folder_of("bob")


def test_files_belong_to_the_folder_they_lie_in() -> None:
    mine = folder_of("ann") / "x" / "walk.bvh"
    assert not owns("ann", str(mine)), "it is not there"
    mine.parent.mkdir(parents=True)
    mine.write_text("")
    assert owns("ann", str(mine)) and not owns("bob", str(mine))


@pytest.mark.parametrize("path", ["walk.bvh", "", "\0", "/walk\0.bvh", "/etc/passwd"])
def test_no_other_path_belongs_to_anybody(path: str) -> None:
    assert not owns("ann", path)


def test_ways_out_of_the_folder_are_followed(root: Path) -> None:
    own = folder_of("ann")
    own.mkdir()
    secret = root / "secret.txt"
    secret.write_text("")
    (own / "link").symlink_to(secret)
    assert not owns("ann", str(own / "link"))
    assert not owns("ann", f"{own}/../secret.txt")
    assert not owns("ann", f"{own}-other/file")
