"""Requests and files that are changed at random: no error of the program's, no hanging, no growing.

``PASDEDEUX_MUTATIONS`` says how many of each; ``make attack`` asks for thousands.
"""

from __future__ import annotations

import copy
import json
import multiprocessing
import os
import random
import resource
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from motion import InputError
from motion.formats.importing import import_motion
from tests.motion.bodies import marching
from tests.motion.formats.arrays import npy, npz
from tests.motion.formats.characters import glb_motion
from tests.motion.formats.rigs import RIGS, bvh_text
from webdemo.inference.story.toml import read_story

from ..clients import FIELDS
from .containers import changed_archive, changed_glb, changed_story
from .known import API
from .target import Target

COUNT = int(os.environ.get("PASDEDEUX_MUTATIONS", "150"))
SLOWEST = 20.0
"""Seconds that any one request or file may take, on a busy machine."""
READER_BYTES = 3 * 2**30
"""Address space of the process that reads files: NumPy, SciPy and pandas take most of it."""
GROWTH = 300.0
"""Megabytes by which the server may grow."""

VALUES: tuple[Any, ...] = (
    *(None, True, 0, -1, 1e308, 10**30, 10**400, "", "x" * 5000, "\0", "\u202e", "${7*7}", "{{7*7}}", "' OR '1'='1"),
    *([], {}, [[]], {"path": "/etc/passwd"}, {"__type__": "update"}, {"path": 7, "meta": "x"}, {"meta": {"_type": []}}),
    *("../../etc/passwd", "\r\nSet-Cookie: a=b", "<img src=x onerror=alert(1)>", "NaN", ["\ud83d"]),
)
HEADERS = ("content-type", "accept", "cookie", "origin", "referer", "range", "accept-encoding", "authorization", "te")
HEADERS += ("x-forwarded-for", "x-forwarded-proto", "if-none-match", "x-gradio-user", "content-encoding")
BYTES = (b"\0", b"\xff", b"-", b"9" * 400, b"nan", b"\n", b"{", b"}", b"ROOT", b"1e400", b"PK\x03\x04", b"\r")
_CALLS = ("queue/join", "call/generate", "call/react", "run/predict", "api/generate", "component_server", "upload")
POSTED = (*(f"{API}/{end}" for end in (*_CALLS, "cancel", "reset")), "/login")
_STREAMS = ("queue/data?session_hash=mutant", "heartbeat/mutant2", "upload_progress?upload_id=x")
READ = (*(f"{API}/{end}" for end in (*_STREAMS, "info", "file=x", "app_id")), "/", "/config", "/theme.css", "/logout")

STORY = b"""seed = 1

[[beat]]
words = "They walk."
seconds = 3.0

[[beat]]
a = "They bow."
b = "They wait."

[[path]]
person = "a"
points = [[0.0, 0.0, 0.0], [3.0, 1.0, 2.0]]
"""


def chosen(dice: random.Random) -> Any:
    """One of the values, which the next change may change: a list that held itself would be no JSON."""
    return copy.deepcopy(dice.choice(VALUES))


def mutated_json(dice: random.Random) -> bytes:
    """The body of a call with some of it replaced, added, left out or repeated."""
    body: dict[str, Any] = {"data": list(FIELDS), "session_hash": "mutant", "fn_index": dice.randrange(4)}
    for _ in range(dice.randint(1, 3)):
        where = dice.choice(["data", "item", "key", "new"])
        if where == "data":
            body["data"] = chosen(dice)
        elif where == "item" and isinstance(body["data"], list) and body["data"]:
            body["data"][dice.randrange(len(body["data"]))] = chosen(dice)
        else:
            keys = ["session_hash", "fn_index", "event_id", "event_data", "trigger_id", "batched", "request"]
            body[dice.choice(keys)] = chosen(dice)
    return mutated(json.dumps(body).encode(), dice) if dice.random() < 0.3 else json.dumps(body).encode()


def mutated(data: bytes, dice: random.Random) -> bytes:
    """Bytes of which some are replaced, left out or repeated."""
    for _ in range(dice.randint(1, 6)):
        start = dice.randrange(max(len(data), 1))
        stop = min(len(data), start + dice.choice((0, 1, 1, 4, 40, 400)))
        middle = dice.choice((b"", dice.choice(BYTES), data[start:stop] * 2, dice.randbytes(3)))
        data = data[:start] + middle + data[stop:]
    return data


def mutated_request(dice: random.Random) -> tuple[str, str, dict[str, Any]]:
    """Method, path and the rest of a request."""
    path = dice.choice((*POSTED, *READ))
    method = "POST" if path in POSTED else "GET"
    if dice.random() < 0.1:
        method = dice.choice(("GET", "POST", "PUT", "DELETE", "HEAD", "OPTIONS", "PATCH", "BREW"))
    if dice.random() < 0.2:
        letters = "".join(chr(dice.randrange(33, 127)) for _ in range(dice.randint(1, 30)))
        path += "?" + letters.replace("#", "")
    form = b'--x\r\nContent-Disposition: form-data; name="files"; filename="a.bvh"\r\n\r\nHIERARCHY\r\n--x--\r\n'
    content = mutated(form, dice) if path.startswith((f"{API}/upload", "/login")) else mutated_json(dice)
    kind = "multipart/form-data; boundary=x" if content.startswith(b"-") else "application/json"
    headers = {"content-type": kind}
    if dice.random() < 0.3:
        headers[dice.choice(HEADERS)] = dice.choice(("", "x" * 3000, "a=b; c", "bytes=5-1", "*/*;q=x", "gzip"))
    return method, path, {"content": content if method not in ("GET", "HEAD") else None, "headers": headers}


@pytest.mark.timeout(300 + COUNT)  # a request takes 0.1 s on an idle machine
def test_requests_end_in_no_error_of_the_programs(target: Target) -> None:
    dice = random.Random(COUNT)
    begun = target.memory()
    for i in range(COUNT):
        method, path, rest = mutated_request(dice)
        lasts = (f"{API}/heartbeat", f"{API}/queue/data", *[f"{API}/upload_progress"] * (i % 10 > 0))
        if path.startswith(lasts) and method == "GET":
            method = "HEAD"  # the answer is a stream, or comes three seconds later
        began = time.monotonic()
        answer = target.ask("eve", method, path, **rest)
        sent = (i, method, path, rest, answer.status_code, answer.text[:300])
        assert answer.status_code < 500, sent
        assert "Traceback" not in answer.text and "root:" not in answer.text, sent
        assert time.monotonic() - began < SLOWEST, sent
        if path.startswith("/logout"):
            target.sign_in_anew("eve")  # what follows is hers as well
    assert target.healthy() and target.memory() - begun < GROWTH
    assert "A request failed." not in target.log()


def samples() -> dict[str, bytes]:
    """A whole file of every kind that is read."""
    import numpy as np

    positions, rotations = marching(30)
    bvh = bvh_text(rotations, positions[:, 0], RIGS["mixamo"], unit=100, frame_time=1 / 30).encode()
    body = b"".join(b"%d.0 %d.5 2.5 0 0 0 0 0 0 0 0 2\n" % (j % 3, j % 5) for j in range(25))
    skeleton = b"5\n" + (b"1\n7 0 0 0 0 0 0 0 0 2\n25\n" + body) * 5
    sbu = b"\n".join(b"%d," % i + b",".join(b"0.%d" % (k % 9 + 1) for k in range(90)) for i in range(5))
    return {
        "a.bvh": bvh,
        "a.npy": npy(positions.astype(np.float32)),
        "a.npz": npz(positions=positions.astype(np.float32), fps=np.array(30.0)),
        "a.skeleton": skeleton,
        "a.txt": sbu,
        "a.glb": glb_motion(rotations, positions[:, 0]),
        "a.toml": STORY,
    }


Change = Callable[[bytes, random.Random], bytes]


def read_mutants(name: str, data: bytes, change: Change, count: int, send: Callable[[str], None]) -> None:
    """Reads changed files in a process of bounded memory; says of the first that was no sentence."""
    statm = Path("/proc/self/statm")  # what the tests before it have taken comes on top
    most = READER_BYTES + (int(statm.read_text().split()[0]) * resource.getpagesize() if statm.exists() else 0)
    resource.setrlimit(resource.RLIMIT_AS, (most, most))
    dice = random.Random(count)
    for i in range(count):
        mutant = change(data, dice)
        began = time.process_time()
        try:
            if name == "a.toml":
                read_story(mutant.decode("utf-8", "replace"))
            else:
                import_motion(mutant, name=name)
        except InputError:
            pass
        except BaseException as error:
            send(f"{name}, mutation {i}: {type(error).__name__}: {error}")
            return
        if time.process_time() - began > SLOWEST:
            send(f"{name}, mutation {i}: {time.process_time() - began:.0f} s")
            return
    send("")


WHOLE = ("a.bvh", "a.npy", "a.npz", "a.skeleton", "a.txt", "a.glb", "a.toml")
INSIDE: tuple[tuple[str, Change], ...] = (("a.npz", changed_archive), ("a.glb", changed_glb), ("a.toml", changed_story))


@pytest.mark.parametrize(("name", "change"), [*((name, mutated) for name in WHOLE), *INSIDE])
def test_files_end_in_a_motion_or_a_sentence(name: str, change: Change) -> None:
    context = multiprocessing.get_context("fork")
    receive, send = context.Pipe(duplex=False)
    reader = context.Process(target=read_mutants, args=(name, samples()[name], change, COUNT, send.send))
    reader.start()
    try:
        assert receive.poll(60 + COUNT), f"{name}: no answer"
        assert receive.recv() == ""
    finally:
        reader.kill()
        reader.join()
