"""The fair order over several page processes, and a name of its own for each of them."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import update

from motion import InputError
from tests.server.clients import CALL, DATABASES, FIELDS, database_url, drop_tables, events_of, lab_of, sign_in
from tests.server.lab import ROOT
from webdemo.inference.requests import GenerateRequest
from webdemo.server.cluster.instance_lock import InstanceLock
from webdemo.server.queue.shares import KEPT_SECONDS, Shares, Work
from webdemo.server.store.database import Database
from webdemo.server.store.history import History

from .test_queue import make, request, wait_for


@pytest.fixture(params=DATABASES)
def two(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[tuple[Shares, Shares]]:
    """What two processes know of each other."""
    databases = [Database(database_url(request.param, tmp_path)) for _ in range(2)]
    yield Shares(databases[0], "one"), Shares(databases[1], "two")
    drop_tables(databases[0].engine)
    for database in databases:
        database.close()


def test_each_server_knows_what_people_used_at_the_other(two: tuple[Shares, Shares]) -> None:
    one, other = two
    for units in (3.0, 4.0):
        one.add("ada", units)
    one.add("eve", 1.0)
    assert other.exchange() == {}  # it is not written yet
    assert one.exchange() == {}  # it does not hear of its own
    assert other.exchange() == {"ada": 7.0, "eve": 1.0}
    one.add("ada", 2.0)
    other.add("ada", 50.0)
    assert one.exchange() == {}
    assert other.exchange() == {"ada": 9.0, "eve": 1.0}
    assert one.exchange() == {"ada": 50.0}


def test_what_was_long_ago_is_forgotten(two: tuple[Shares, Shares]) -> None:
    one, other = two
    one.add("ada", 5.0)
    one.exchange()
    with one.database.session.begin() as session:
        session.execute(update(Work).values(seen=Work.seen - KEPT_SECONDS - 1))
    one.add("eve", 1.0)
    one.exchange()
    assert other.exchange() == {"eve": 1.0}


def test_a_person_who_used_much_elsewhere_waits_longer(
    monkeypatch: pytest.MonkeyPatch, two: tuple[Shares, Shares]
) -> None:
    one, other = two
    other.add("greedy", 1000.0)  # before this process began: that counts for nobody
    other.exchange()
    gate, people = make(monkeypatch)
    people.queue.served = one.add
    people.queue.charge_elsewhere(one.exchange())
    people.ask("first", request("first"))
    people.ask("greedy", request("greedy"))
    people.ask("modest", request("modest"))
    other.add("greedy", 60.0)
    other.exchange()
    people.queue.charge_elsewhere(one.exchange())
    gate.open.release(3)
    people.end()
    assert [names[0] for names in gate.order] == ["first", "modest", "greedy"]
    one.exchange()
    assert other.exchange() == {"first": 60.0, "greedy": 60.0, "modest": 60.0}


def test_what_was_before_this_process_counts_for_nobody(
    monkeypatch: pytest.MonkeyPatch, two: tuple[Shares, Shares]
) -> None:
    one, other = two
    gate, people = make(monkeypatch)
    for name in ("first", "much", "little"):
        people.ask(name, request(name))
    other.add("much", 1000.0)
    other.exchange()
    people.queue.charge_elsewhere(one.exchange())
    gate.open.release(3)
    people.end()
    assert [names[0] for names in gate.order] == ["first", "much", "little"]


def test_two_servers_tell_each_other(pair: tuple[TestClient, TestClient]) -> None:
    """What a person had, and how many runs they have."""
    body = {"data": [*FIELDS[:5], 40, *FIELDS[6:]]}
    queues = [lab_of(client).queue for client in pair]
    ada, eve = sign_in(pair[0], "ada"), sign_in(pair[0], "eve")
    wait_for(lambda: all(queue._turns._elsewhere is not None for queue in queues))
    for client in pair:
        assert client.post(f"{CALL}/generate", json=body, headers=ada).status_code == 200
        wait_for(lambda: queues[0].running)
    both = 2 * (1 * 40 + 10)  # samples × (seconds × steps + 10)
    wait_for(lambda: list(queues[0]._turns.served.values()) == [both])
    for client in pair:
        assert "You have 2 runs waiting or running already" in events_of(client, "generate", FIELDS, ada)
    assert pair[0].post(f"{CALL}/generate", json=body, headers=eve).status_code == 200
    wait_for(lambda: queues[0].waiting == 1)  # somebody else's is let in
    for queue in queues:
        for token in list(queue._sessions):
            queue.cancel(token)
    wait_for(lambda: not any(queue.running for queue in queues))


# ---- names ---------------------------------------------------------------------------------------

HOLD = """
import sys
from pathlib import Path
from webdemo.server.cluster.instance_lock import InstanceLock
node = InstanceLock(Path(sys.argv[1]), "lab")
print(node.name, flush=True)
sys.stdin.read()
"""


def another_process(folder: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", HOLD, str(folder)], cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )


def test_every_process_has_a_name_of_its_own(tmp_path: Path) -> None:
    """Two servers of one folder that were given no names leave each other's runs alone."""
    mine = InstanceLock(tmp_path, "lab")
    other = another_process(tmp_path)
    assert other.stdout is not None
    assert (mine.name, other.stdout.readline().strip()) == ("lab", "lab-2")
    histories = [
        History(Database(f"sqlite:///{tmp_path / 'h.db'}"), tmp_path / "motions", node=node)
        for node in ("lab", "lab-2", "elsewhere")
    ]
    wanted = GenerateRequest(prompt="They walk.", seconds=1.0)
    for history in histories:
        history.begin("local", wanted, history.node)
    assert histories[0].recover(mine.dead) == 1  # its own name's last life; the others live, or may
    other.kill()
    other.wait()
    assert histories[0].recover(mine.dead) == 1
    states = {entry.title: entry.state for entry in histories[0].entries("local")}
    assert states == {"lab": "interrupted", "lab-2": "interrupted", "elsewhere": "running"}
    again = InstanceLock(tmp_path, "lab")
    assert again.name == "lab-2"
    again.close()
    mine.close()
    assert InstanceLock(tmp_path, "lab").name == "lab"


def test_a_folder_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "data").write_text("a file")
    with pytest.raises(InputError, match="cannot be written"):
        InstanceLock(tmp_path / "data", "lab")


def test_a_name_is_no_path(tmp_path: Path) -> None:
    node = InstanceLock(tmp_path / "data", "../../evil/" + "x" * 300)
    assert [path.parent.name for path in tmp_path.rglob("*.lock")] == ["nodes"]
    assert node.dead(["../../evil", node.name]) == [node.name]
