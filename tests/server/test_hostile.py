"""Uploads, links and connections of somebody who means ill."""

from __future__ import annotations

import json
import resource
import socket
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import update

from webdemo.motion import InputError
from webdemo.server.accounts import Users
from webdemo.server.app import create_app
from webdemo.server.database import Link
from webdemo.server.queue import FairQueue, QueueLimits
from webdemo.server.serve import make_server
from webdemo.ui.visitor import Visitor

from .lab import stub_module
from .test_guard import HERE, client_of, find_fn, lab_of, read_all, settings_for, sign_in

UPLOAD, CALL = "/gradio_api/upload", "/gradio_api/call"
FIELDS = ["Two people walk.", 1, 0, 1, 3, 1, 0, "ddim"]


@pytest.fixture(scope="module")
def open_to_all(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A server without accounts, open to everybody; 25 requests a minute and person."""
    folder = tmp_path_factory.mktemp("open")
    with client_of(settings_for(folder, open=True, rate=25, address_people=2)) as client:
        client.cookies.clear()
        yield client


@pytest.fixture(scope="module")
def here(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    with client_of(settings_for(tmp_path_factory.mktemp("here"))) as client:
        yield client


def told(client: TestClient, endpoint: str, data: list[Any], headers: dict[str, str] | None = None) -> str:
    """What a call of an endpoint ends with."""
    joined = client.post(f"{CALL}/{endpoint}", json={"data": data}, headers=headers)
    if joined.status_code != 200:
        return joined.text
    return client.get(f"{CALL}/{endpoint}/{joined.json()['event_id']}", headers=headers).text


def react(client: TestClient, actor: Any) -> str:
    return told(client, "react", [actor, "", "", 0, 0, "a", 0, 1, 3, 1, 0, "ddim", "intergen", "offline"])


# ---- uploads -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name",
    ["../../../evil.bvh", "/etc/evil.bvh", "..\\..\\evil.bvh", "a/../../evil.bvh", "%2e%2e%2fevil.bvh",
     "evil.bvh\r\nSet-Cookie: a=b", "e" * 3000 + ".bvh", "CON.bvh", ".bvh", "evil.bvh/"],
)  # fmt: skip
def test_an_upload_stays_in_its_folder(here: TestClient, name: str, tmp_path: Path) -> None:
    answer = here.post(UPLOAD, files={"files": (name, b"HIERARCHY")})
    assert answer.status_code in (200, 400, 422) and "set-cookie" not in answer.headers
    if answer.status_code == 200:
        (path,) = answer.json()
        assert Path(path).resolve().is_relative_to(Path(tempfile.gettempdir()).resolve() / "gradio")
        assert Path(path).is_file() and len(Path(path).name) < 256
    assert not Path("/etc/evil.bvh").exists() and not (Path.cwd().parent / "evil.bvh").exists()


def test_an_upload_is_an_upload(here: TestClient) -> None:
    """No file of the server's, and nothing of another host's, is read as if somebody had sent it."""
    database = lab_of(here).settings.data / "history.db"
    for path in (str(database), "/etc/passwd", "../../etc/passwd", str(Path(__file__)), "", "\0"):
        said = react(here, {"path": path, "meta": {"_type": "gradio.FileData"}})
        assert "event: complete" not in said and "root:" not in said
    for address in ("http://127.0.0.1:9/x.bvh", "https://example.invalid/x.bvh", "file:///etc/passwd"):
        for actor in ({"path": address, "url": address, "meta": {"_type": "gradio.FileData"}}, address):
            said = react(here, actor)
            assert "event: complete" not in said and "root:" not in said


@pytest.mark.parametrize(
    "content", [b"", b"\0" * 1000, b"PK\x03\x04 no zip", b"\x80\x04\x95 a pickle.", b"HIERARCHY\nROOT" * 99]
)
def test_a_broken_upload_is_a_sentence(here: TestClient, content: bytes) -> None:
    for suffix in ("bvh", "npz", "npy"):
        answer = here.post(UPLOAD, files={"files": (f"clip.{suffix}", content)})
        said = react(here, {"path": answer.json()[0], "meta": {"_type": "gradio.FileData"}})
        assert "event: error" in said and "Traceback" not in said and "its log says more" not in said


# ---- other people's runs -------------------------------------------------------------------------


def test_a_run_of_another_is_not_opened_by_its_id(tmp_path: Path) -> None:
    Users(tmp_path / "users").add("ada", "password of ada")
    Users(tmp_path / "users").add("eve", "password of eve")
    settings = settings_for(tmp_path, users=tmp_path / "users", host="0.0.0.0", hosts=["127.0.0.1"])
    with client_of(settings) as client:
        people = {}
        for name in ("ada", "eve"):
            client.post("/login", data={"username": name, "password": f"password of {name}"})
            people[name] = {"cookie": f"pasdedeux_session={client.cookies['pasdedeux_session']}"}
            client.cookies.clear()
        assert "event: complete" in told(client, "generate", FIELDS, people["ada"])
        history = lab_of(client).history
        (entry,) = history.entries("user ada")
        for key, owner in ((entry.id, "user eve"), (entry.id, ""), (entry.id[:-1], "user ada")):
            with pytest.raises(InputError, match="There is no such run"):
                history.open(key, owner)
        # Its event is hers as well: nobody else may read what it ends with.
        body = {"data": FIELDS}
        event = client.post(f"{CALL}/generate", json=body, headers=people["ada"]).json()["event_id"]
        stolen = client.get(f"{CALL}/generate/{event}")
        assert stolen.status_code == 401
        assert client.get("/config", headers={"cookie": "pasdedeux_session=user ada"}).status_code == 401


def page_at(client: TestClient, key: str, headers: dict[str, str]) -> str:
    """What the page does first at ``/?run=KEY``: all that it is told then."""
    session = f"page{time.monotonic_ns()}"
    fn = find_fn(client, headers, "open_address")
    body = {"data": [key], "fn_index": fn, "session_hash": session}
    assert client.post("/gradio_api/queue/join", json=body, headers=headers).status_code == 200
    lines = client.get(f"/gradio_api/queue/data?session_hash={session}", headers=headers).text.splitlines()
    events = [json.loads(line.removeprefix("data: ")) for line in lines if line.startswith("data: ")]
    (done,) = [event for event in events if event["msg"] == "process_completed"]
    assert done["success"]
    return json.dumps(done["output"]["data"])


def test_an_address_opens_no_run_of_another(tmp_path: Path) -> None:
    """To a stranger a run, one that never was and a link that ended or was revoked are the same."""
    users = Users(tmp_path / "users")
    for name in ("ada", "eve"):
        users.add(name, f"password of {name}")
    settings = settings_for(tmp_path, users=users.path, host="0.0.0.0", hosts=["127.0.0.1"])
    with client_of(settings) as client:
        ada, eve = sign_in(client, "ada"), sign_in(client, "eve")
        assert "event: complete" in told(client, "generate", ["SECRET", *FIELDS[1:]], ada)
        history = lab_of(client).history
        (entry,) = history.entries("user ada")
        assert "SECRET" in page_at(client, entry.id, ada)
        key, _ = history.link(entry.id, "user ada")
        assert "SECRET" in page_at(client, key, eve)
        history.revoke(entry.id, "user ada")
        late, _ = history.link(entry.id, "user ada")
        with history.database.session.begin() as session:
            session.execute(update(Link).where(Link.token == late).values(until=time.time() - 1))
        keys = [entry.id, "n" * len(entry.id), key, late, "../" + entry.id, entry.id + "' OR '1'='1"]
        answers = {page_at(client, each, eve) for each in keys}
        assert len(answers) == 1
        (answer,) = answers
        assert "There is no such run, or its link has ended" in answer and "SECRET" not in answer
        client.post("/logout", headers=eve)
        signed_out = client.get(f"/?run={entry.id}", headers={**eve, "accept": "text/html"})
        assert signed_out.status_code == 303 and "SECRET" not in signed_out.text


def test_a_visitors_history_is_not_had_by_naming_them(open_to_all: TestClient) -> None:
    mine = {"cookie": "pasdedeux_visitor=" + "m" * 32}
    assert "event: complete" in told(open_to_all, "generate", FIELDS, mine)
    history = lab_of(open_to_all).history
    with history.database.engine.connect() as connection:
        owners = {row[0] for row in connection.exec_driver_sql("SELECT owner FROM runs")}
    assert len(owners) == 1 and "mmm" not in owners.pop()  # the cookie itself is not kept


# ---- too much of everything ----------------------------------------------------------------------


def test_throwing_the_cookie_away_gains_nothing(open_to_all: TestClient) -> None:
    answers = [
        open_to_all.post(
            "/gradio_api/queue/join", content=b"[]", headers={"cookie": f"pasdedeux_visitor={i:032}"}
        ).status_code
        for i in range(60)
    ]
    assert 429 in answers[-15:] and 429 not in answers[:20]
    other = TestClient(open_to_all.app, base_url=HERE, client=("203.0.113.9", 5))
    assert other.post("/gradio_api/queue/join", content=b"[]").status_code != 429


def test_one_address_does_not_fill_the_line(monkeypatch: pytest.MonkeyPatch) -> None:
    started = threading.Event()

    class Busy:
        ready = True

        def run(self, request: Any, cancel: Any = None) -> Iterator[Any]:
            started.set()
            while not cancel.cancelled:
                time.sleep(0.01)
            yield from ()

    queue = FairQueue(Busy(), QueueLimits(address=3))  # type: ignore[arg-type]
    request = stub_module().GenerateRequest(prompt="x")
    jobs = [queue._enter("first", request, Visitor(person="first", address="a"))]
    assert started.wait(10)
    jobs += [queue._enter(f"s{i}", request, Visitor(person=f"p{i}", address="a")) for i in range(3)]
    with pytest.raises(InputError, match="3 runs from your network wait already"):
        queue._enter("more", request, Visitor(person="more", address="a"))
    jobs.append(queue._enter("other", request, Visitor(person="other", address="b")))
    for job in jobs:
        job.token.cancel()


def test_a_full_disk_is_a_sentence(tmp_path: Path) -> None:
    with client_of(settings_for(tmp_path, free_megabytes=1e12)) as client:
        said = told(client, "generate", FIELDS)
        assert "event: error" in said and "disk is nearly full" in said
        assert lab_of(client).history.entries("local") == []


# ---- a real socket -------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, int]]:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    settings = settings_for(
        tmp_path_factory.mktemp("served"), port=port, header_seconds=1, body_seconds=1, address_connections=50
    )
    server = make_server(settings, engine=stub_module().StubEngine())
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    until = time.monotonic() + 120
    while not server.started:
        assert time.monotonic() < until
        time.sleep(0.05)
    yield "127.0.0.1", port
    server.should_exit = True
    thread.join(timeout=60)


def answer_to(connection: socket.socket) -> bytes:
    """An answer with a Content-Length, whole."""
    got = b""
    while b"\r\n\r\n" not in got:
        got += connection.recv(65536)
    head, _, body = got.partition(b"\r\n\r\n")
    length = int(
        next(line.split(b":")[1] for line in head.lower().split(b"\r\n") if b"content-length" in line)
    )
    while len(body) < length:
        body += connection.recv(65536)
    return head


def test_the_second_head_of_a_connection_has_no_more_time(served: tuple[str, int]) -> None:
    with socket.create_connection(served, timeout=20) as slow:
        slow.sendall(b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
        assert answer_to(slow).startswith(b"HTTP/1.1 ")
        slow.sendall(b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: ")
        began = time.monotonic()
        assert read_all(slow) == b""
        assert time.monotonic() - began < 10  # an idle connection would have 30 s


def test_a_body_that_drips_is_cut_off(served: tuple[str, int]) -> None:
    head = f"POST {UPLOAD} HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: multipart/form-data; boundary=x\r\n"
    with socket.create_connection(served, timeout=20) as slow:
        slow.sendall(f"{head}Content-Length: 1000\r\nConnection: close\r\n\r\n".encode())
        began = time.monotonic()
        try:
            while time.monotonic() - began < 15:
                slow.sendall(b"-")
                time.sleep(0.1)
        except OSError:
            pass
        assert time.monotonic() - began < 10


def test_a_thousand_connections(served: tuple[str, int]) -> None:
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if hard != resource.RLIM_INFINITY and hard < 3000:
        pytest.skip("this system allows too few open files")
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, 3000), hard))
    flood: list[socket.socket] = []
    try:
        for _ in range(1000):
            flood.append(socket.create_connection(served, timeout=30))
        closed = 0
        for connection in flood[100:]:
            connection.settimeout(20)
            closed += connection.recv(1) == b""
        assert closed == 900
    finally:
        for connection in flood:
            connection.close()
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    time.sleep(0.5)
    with socket.create_connection(served, timeout=30) as one:
        one.sendall(b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n")
        assert read_all(one).startswith((b"HTTP/1.1 200", b"HTTP/1.1 503"))


def test_an_address_that_a_stranger_claims(served: tuple[str, int]) -> None:
    """What comes through a proxy from elsewhere is not this machine's, whatever else it says."""
    with socket.create_connection(served, timeout=30) as one:
        one.sendall(
            b"GET /config HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Forwarded-For: 127.0.0.1, 203.0.113.9\r\n"
            b"Connection: close\r\n\r\n"
        )
        assert b" 403 " in read_all(one)[:20]


def test_two_page_processes_on_one_database(tmp_path: Path) -> None:
    """Either knows who signed in, and every run, at the other."""
    Users(tmp_path / "users").add("ada", "password of ada")
    settings = [
        settings_for(tmp_path, users=tmp_path / "users", host="0.0.0.0", hosts=["127.0.0.1"], node=node)
        for node in ("one", "two")
    ]
    apps = [create_app(each, engine=stub_module().StubEngine()) for each in settings]
    with TestClient(apps[0], base_url=HERE) as one, TestClient(apps[1], base_url=HERE) as two:
        one.post("/login", data={"username": "ada", "password": "password of ada"})
        ada = {"cookie": f"pasdedeux_session={one.cookies['pasdedeux_session']}"}
        one.cookies.clear()
        assert find_fn(two, ada, "generate") == find_fn(one, ada, "generate")
        said = told(one, "generate", FIELDS, ada)
        answer = json.loads(
            next(x for x in said.splitlines() if x.startswith("data: [")).removeprefix("data: ")
        )
        (entry,) = lab_of(two).history.entries("user ada")
        opened = lab_of(two).history.open(entry.id, "user ada")
        assert opened.result.manifest == answer[0]["manifest"]
        key, _ = lab_of(one).history.link(entry.id, "user ada")
        assert lab_of(two).history.open(key, "").entry.id == entry.id
