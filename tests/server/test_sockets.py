"""Slow, broken and very many connections, on a real socket."""

from __future__ import annotations

import resource
import socket
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from functools import partial

import gradio.routes
import httpx
import pytest

from tests.server.clients import wait_for
from webdemo.server.http import connections
from webdemo.server.serve import FILES, with_room_for_files
from webdemo.server.settings import Settings
from webdemo.server.store.scratch import UPLOADS as KEPT

from .clients import JOIN, UPLOAD, answers, read_all


def test_a_head_that_never_ends_is_cut_off(served: tuple[str, int]) -> None:
    with socket.create_connection(served, timeout=30) as slow:
        slow.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: ")
        assert read_all(slow) == b""


def test_a_body_that_never_comes_is_cut_off(served: tuple[str, int]) -> None:
    head = f"POST {JOIN} HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 100\r\nConnection: close\r\n\r\n{{"
    with socket.create_connection(served, timeout=30) as slow:
        slow.sendall(head.encode())
        assert read_all(slow).startswith(b"HTTP/1.1 408")


@pytest.mark.parametrize("path", [JOIN, UPLOAD, "/nowhere"])
def test_a_body_in_tiny_pieces_is_cut_off(served: tuple[str, int], path: str) -> None:
    """Reading each takes 11 µs of the event loop: a few megabits a second kept everybody else from being answered."""
    head = f"POST {path} HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: chunked\r\n"
    with socket.create_connection(served, timeout=30) as slow:
        slow.sendall(f"{head}Content-Type: multipart/form-data; boundary=x\r\n\r\n".encode())
        with pytest.raises(OSError):
            for _ in range(200):  # far below the most bytes of a body
                slow.sendall(b"1\r\n-\r\n" * 1000)
                time.sleep(0.01)
    wait_for(lambda: answers(served))


def test_few_large_bodies_come_at_a_time(served: tuple[str, int]) -> None:
    """390 of 2 MB, held before their ends, took 700 MB."""
    head = f"POST {JOIN} HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: {2**20}\r\nConnection: close\r\n\r\n".encode()
    with ExitStack() as held:
        slow = [held.enter_context(connect(served)) for _ in range(4)]
        for one in slow:
            one.sendall(head)
        with connect(served) as fifth:
            fifth.sendall(head)
            said = read_all(fifth)
            assert said.startswith(b"HTTP/1.1 429") and b"You already have 4 large requests" in said
        assert all(read_all(one).startswith(b"HTTP/1.1 408") for one in slow)
    with connect(served) as one:
        one.sendall(head)
        assert read_all(one).startswith(b"HTTP/1.1 408"), "there is a place again"


def test_an_upload_has_one_watcher_and_little_is_kept_of_it(served: tuple[str, int]) -> None:
    """Each looks twenty times a second; and the names of uploads that never came stayed for ever."""
    statuses = gradio.routes.file_upload_statuses
    watch = partial(httpx.get, f"http://{served[0]}:{served[1]}{UPLOAD}_progress", timeout=30)
    with ThreadPoolExecutor(1) as pool:
        first = pool.submit(watch, params={"upload_id": "none"})
        wait_for(lambda: "none" in statuses._signals)
        assert watch(params={"upload_id": "other"}).status_code == 429
        assert first.result().status_code == 404, "such an upload does not come"
    assert watch(params={"upload_id": "again"}).status_code == 404, "there is a place again"
    for i in range(2 * KEPT):
        statuses.track(f"{i}")
    assert len(statuses._statuses) == KEPT == len(statuses._signals)


elsewhere = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="has one loopback address")
"""Comes from other addresses of this machine."""


def connect(served: tuple[str, int], address: str = "127.0.0.1") -> socket.socket:
    return socket.create_connection(served, timeout=30, source_address=(address, 0))


def closed(connections: list[socket.socket]) -> int:
    """How many of the connections the server closes."""
    count = 0
    for connection in connections:
        connection.settimeout(20)
        count += connection.recv(1) == b""
    return count


@elsewhere
def test_a_flood_from_many_addresses_leaves_the_page_up(served: tuple[str, int]) -> None:
    with ExitStack() as flood:
        found = [flood.enter_context(connect(served, f"127.0.1.{i % 4 + 1}")) for i in range(80)]
        assert closed(found[48:]) == 32  # of each it takes 12, as many as are left
    wait_for(lambda: answers(served))


def forwarded(served: tuple[str, int], address: str, times: int = 1, path: str = "/healthz") -> socket.socket:
    """A connection of the proxy on this machine, with requests of a stranger of that address."""
    connection = connect(served)
    head = f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Forwarded-For: {address}\r\n\r\n"
    connection.sendall(head.encode() * times)
    return connection


def test_behind_a_proxy_each_connection_counts_for_its_stranger(served: tuple[str, int]) -> None:
    with ExitStack() as flood:
        mine = [flood.enter_context(forwarded(served, "203.0.113.7")) for _ in range(25)]
        for connection in mine:
            assert answer_to(connection).startswith(b"HTTP/1.1 ")
        one_more = flood.enter_context(forwarded(served, "203.0.113.7"))
        one_more.settimeout(20)
        assert one_more.recv(65536) == b""
        others = [flood.enter_context(forwarded(served, f"203.0.113.{i + 100}")) for i in range(9)]
        for connection in others:
            assert answer_to(connection).startswith(b"HTTP/1.1 ")
    wait_for(lambda: answers(served))


def test_answers_that_nobody_reads_are_ended(served: tuple[str, int]) -> None:
    """More than the system buffers; a reader of 5 kB a second is as slow as none."""
    with socket.socket() as slow:
        slow.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        slow.settimeout(60)
        slow.connect(served)
        slow.sendall(b"GET /config HTTP/1.1\r\nHost: 127.0.0.1\r\nAccept-Encoding: identity\r\n\r\n" * 100)
        until = time.monotonic() + 60
        with pytest.raises(ConnectionError):
            while slow.recv(1000):
                assert time.monotonic() < until
                time.sleep(0.2)


def test_broken_http_is_refused(served: tuple[str, int]) -> None:
    first = b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\n"
    for text in (
        b"NOT HTTP AT ALL\r\n\r\n",
        first + b"X: a\r\n b\x00\r\n\r\n",
        first + b"X: a\r\n" * connections.HEAD_LINES + b"\r\n",
    ):
        with socket.create_connection(served, timeout=30) as broken:
            broken.sendall(text)
            assert b" 400 " in broken.recv(4096)


def answer_to(connection: socket.socket) -> bytes:
    """An answer with a Content-Length, whole."""
    got = b""
    while b"\r\n\r\n" not in got:
        got += connection.recv(65536)
    head, _, body = got.partition(b"\r\n\r\n")
    length = int(next(line.split(b":")[1] for line in head.lower().split(b"\r\n") if b"content-length" in line))
    while len(body) < length:
        body += connection.recv(65536)
    return head


def test_the_second_head_of_a_connection_has_no_more_time(served: tuple[str, int]) -> None:
    with socket.create_connection(served, timeout=120) as slow:
        slow.sendall(b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
        assert answer_to(slow).startswith(b"HTTP/1.1 ")
        slow.sendall(b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: ")
        assert read_all(slow) == b""  # once a head has begun, nothing else would end the connection


def test_a_body_that_drips_is_cut_off(served: tuple[str, int]) -> None:
    head = f"POST {UPLOAD} HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: multipart/form-data; boundary=x\r\n"
    with socket.create_connection(served, timeout=120) as slow:
        slow.sendall(f"{head}Content-Length: 1000\r\nConnection: close\r\n\r\n".encode())
        with pytest.raises(OSError):  # long before the whole body has come
            for _ in range(999):
                slow.sendall(b"-")
                time.sleep(0.1)


@elsewhere
def test_thousands_of_connections(served: tuple[str, int]) -> None:
    """One address gets so many and no more, and others are answered meanwhile."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    many = 2500
    if hard != resource.RLIM_INFINITY and hard < 2 * many:
        pytest.skip("this system allows too few open files")
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, 2 * many), hard))
    try:
        with ExitStack() as flood:
            found = [flood.enter_context(connect(served)) for _ in range(many)]
            assert answers(served, "127.0.0.9")
            assert closed(found[25:]) == many - 25
        wait_for(lambda: answers(served))
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def test_files_enough_for_all_connections(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the system allows fewer, fewer connections are taken, so that files can still be opened."""
    given = {"limits": (100, 5000)}
    monkeypatch.setattr(resource, "getrlimit", lambda kind: given["limits"])
    monkeypatch.setattr(resource, "setrlimit", lambda kind, limits: given.update(limits=limits))
    assert with_room_for_files(Settings(connections=1000)).connections == 1000
    assert given["limits"] == (1000 + FILES, 5000)
    given["limits"] = (100, 1024)
    assert with_room_for_files(Settings(connections=1000)).connections == 1024 - FILES
    assert given["limits"] == (1024, 1024)
    given["limits"] = (100, 300)
    assert with_room_for_files(Settings(connections=1000)).connections == 150
    given["limits"] = (100, resource.RLIM_INFINITY)
    assert with_room_for_files(Settings(connections=2000)).connections == 2000


def test_an_address_that_a_stranger_claims(served: tuple[str, int]) -> None:
    """What comes through a proxy from elsewhere is not this machine's, whatever else it says."""
    with socket.create_connection(served, timeout=30) as one:
        one.sendall(
            b"GET /config HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Forwarded-For: 127.0.0.1, 203.0.113.9\r\n"
            b"Connection: close\r\n\r\n"
        )
        assert b" 403 " in read_all(one)[:20]
