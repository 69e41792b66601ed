"""What ada has on a server: real things, so that an attack that fails does so because it is refused."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from webdemo.server.store.database import Database
from webdemo.server.store.storage import Storage
from webdemo.server.store.studies import Studies
from webdemo.study import Pair

from ..clients import FIELDS
from ..lab import stub_module
from .known import API
from .target import Target

SECRET, UPLOADED = "SECRET", "HIERARCHY of ada's"
"""What nobody else may read: her prompt, her study's runs, her file."""


class Victim:
    """Ada, who has an upload, a run, its files, a call, a page's session, a study and a public page.

    Attributes:
        things: their paths, keys and ids, by the names that attacks use.
        owner: whose runs hers are, as the server writes it.
    """

    def __init__(self, target: Target) -> None:
        self.target = target
        upload = target.upload("ada", "hers.bvh", UPLOADED.encode())
        finished = target.call("ada", "generate", [SECRET, *FIELDS[1:]])
        (download,) = [word for word in finished.split('"') if word.endswith(".npz") and word[0] == "/"][:1]
        # not the first run there is: other tests of the same server run before
        ((run, self.owner),) = target.rows(f"SELECT id, owner FROM runs WHERE title = '{SECRET}'")
        open_call = {"data": [SECRET, *FIELDS[1:]]}
        call = target.ask("ada", "POST", f"{API}/call/generate", json=open_call).json()["event_id"]
        join = {**open_call, "fn_index": 1, "session_hash": "adas own"}
        target.ask("ada", "POST", f"{API}/queue/join", json=join).raise_for_status()
        walking = stub_module().walking
        database = Database(target.data / "history.db")
        study = Studies(Storage(database, target.data / "motions"), target.data / "studies").create(
            self.owner, "Which is longer?", (SECRET, f"{SECRET} damped"), [Pair(walking(0.5), walking(0.5))]
        )
        database.close()
        self.things = {
            "upload": upload,
            "download": download,
            "call": call,
            "session": "adas own",
            "run": run,
            "study": study.id,
            "study_key": study.key,
            "public": target.publish(self.owner, run),
            "here": target.url,
            "folder_of_ada": str(Path(upload).parents[1]),
            "canary": str(target.canary),
            "folder": str(target.folder),
            "data": str(target.data),
        }
        self._kept = self._state()

    def live(self) -> str:
        """A new live stream of hers, since one closes soon when nothing comes; returns its id."""
        opened = self.target.ask("ada", "POST", "/live", json={"partner": "agent"}).json()
        self.things["stream"] = opened["id"]
        return opened["id"]

    def fill(self, value: Any) -> Any:
        """A value with her things in place of their names in braces."""
        if isinstance(value, str):
            for name, thing in self.things.items():
                value = value.replace(f"{{{name}}}", thing)
            return value
        if isinstance(value, dict):
            return {key: self.fill(item) for key, item in value.items()}
        return [self.fill(item) for item in value] if isinstance(value, list) else value

    def _state(self) -> list[Any]:
        run, study = self.things["run"], self.things["study"]
        return [
            self.target.rows(f"SELECT * FROM {table} WHERE {column} = '{key}'")
            for table, column, key in (("runs", "id", run), ("shares", "run_id", run), ("studies", "id", study))
        ]

    def check(self, number: Callable[[str], int]) -> None:
        """Fails unless all of it is there, as it was, and opens for her: so nothing failed for want of a target.

        Args:
            number: the index of a backend function by its name.
        """
        target, hers = self.target, self.things
        assert target.ask("ada", "GET", f"{API}/file={hers['upload']}").text == UPLOADED
        assert target.ask("ada", "GET", f"{API}/file={hers['download']}").content[:2] == b"PK"
        opened = target.event("ada", number("HistoryTab.open_address"), [hers["run"]])
        assert SECRET in opened, opened
        assert hers["study_key"] in target.event("ada", number("StudyPanel.show"), [None])
        assert self._state() == self._kept
