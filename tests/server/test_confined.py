"""The command of the systemd unit and of the image, as another user without rights and on a read-only root: it serves,
tells systemd how it is, and a full disk makes it unhealthy while its page stays open."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest

from tests.server.lab import ROOT, free_port
from webdemo.server.accounts.accounts import Accounts
from webdemo.server.store.database import Database

UNIT = (ROOT / "docs" / "deploy" / "pas-de-deux.service").read_text()
DATA = "/var/lib/pas-de-deux"
SIZE = 256 * 2**20
"""Bytes of the data's own file system."""
PASSWORD = "a password of ada's"
pytestmark = pytest.mark.slow


class Confined:
    """The program below bubblewrap, which mounts everything that it may write to anew: nothing of this machine."""

    def __init__(self, folder: Path) -> None:
        port = free_port()
        self.url = f"http://127.0.0.1:{port}"
        self.told = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.told.bind(f"\0pas-de-deux {port}")
        self.told.settimeout(60)
        self.log = folder / "log"
        database = Database(folder / "history.db")
        Accounts(database).add("ada", PASSWORD)
        database.close()
        settings = " ".join(re.findall(r"^Environment=(.+)$", UNIT, re.MULTILINE)).replace("%S", "/var/lib")
        given = dict(each.split("=", 1) for each in settings.split())
        given |= {
            "PASDEDEUX_PORT": str(port),
            "PASDEDEUX_FREE_MEGABYTES": "16",
            "PASDEDEUX_HOSTS": '["lab.example"]',
            "PASDEDEUX_GRACE_SECONDS": "5",
            "OMP_NUM_THREADS": "1",
            "NOTIFY_SOCKET": f"@pas-de-deux {port}",
            "HOME": "/nowhere",
        }
        start = re.findall(r"^ExecStart=(\S+) (.+)$", UNIT, re.MULTILINE)
        assert start == [("/opt/pas-de-deux/.venv/bin/python", "app.py")]
        reading, writing = os.pipe()
        packages = str(Path(sys.prefix).resolve())
        mounts = f"--ro-bind / / --dev /dev --tmpfs /tmp --tmpfs /run --size {SIZE} --tmpfs /var/lib --dir {DATA}"
        rights = "--unshare-user --uid 64321 --gid 64321 --cap-drop ALL --die-with-parent"
        words = ["bwrap", *mounts.split(), "--ro-bind", str(ROOT), str(ROOT), "--ro-bind", packages, packages]
        words += ["--file", "9", f"{DATA}/history.db", *rights.split(), "--info-fd", str(writing), "--chdir", str(ROOT)]
        words += [sys.executable, "app.py"]
        with open(folder / "history.db", "rb") as made, open(self.log, "w") as log:
            words[words.index("9")] = str(made.fileno())
            self.process = subprocess.Popen(
                words,
                env={"PATH": os.environ["PATH"], **given},
                stdout=log,
                stderr=log,
                pass_fds=(writing, made.fileno()),
            )
        os.close(writing)
        with os.fdopen(reading) as told:
            text = told.read()
        assert text, self.log.read_text()
        self.pid = int(json.loads(text)["child-pid"])
        self.disk = Path(f"/proc/{self.pid}/root{DATA}")

    def get(self, path: str) -> httpx.Response | None:
        """An answer to somebody on this machine, as a probe of Kubernetes asks."""
        try:
            return httpx.get(f"{self.url}{path}", timeout=10, headers={"host": "localhost"})
        except httpx.TransportError:
            return None

    def wait_for(self, condition: Callable[[], bool]) -> None:
        until = time.monotonic() + 400
        while not condition():
            assert self.process.poll() is None and time.monotonic() < until, self.log.read_text()
            time.sleep(0.2)

    def answers(self, path: str, code: int) -> bool:
        return (answer := self.get(path)) is not None and answer.status_code == code


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Confined]:
    if shutil.which("bwrap") is None:
        pytest.skip("no bubblewrap on this machine")
    trial = ["bwrap", "--ro-bind", "/", "/", "--unshare-user", "--uid", "64321", "--tmpfs", "/tmp", "true"]
    if subprocess.run(trial, capture_output=True).returncode:
        pytest.skip("this machine allows no user namespaces")
    confined = Confined(tmp_path_factory.mktemp("confined"))
    try:
        confined.wait_for(lambda: confined.answers("/healthz", 200))
        yield confined
    finally:
        confined.process.kill()
        confined.process.wait()
        confined.told.close()


def test_it_serves_and_writes_nowhere_else(lab: Confined) -> None:
    status = Path(f"/proc/{lab.pid}/status").read_text()
    assert "\nNoNewPrivs:\t1\n" in status and "\nCapEff:\t0000000000000000\n" in status
    with httpx.Client(base_url=lab.url, timeout=300) as ada:
        ada.headers.update({"host": "lab.example", "origin": "http://lab.example"})
        assert ada.post("/login", data={"username": "ada", "password": PASSWORD}).json() == {"success": True}
        ada.headers["cookie"] = "; ".join(f"{cookie.name}={cookie.value}" for cookie in ada.cookies.jar)
        data = ["Two people bow.", 1, 0, 1, 3, 2, 0, "ddim", "intergen", 1]
        event = ada.post("/gradio_api/call/generate", json={"data": data}).json()["event_id"]
        said = ada.get(f"/gradio_api/call/generate/{event}").text
    assert "event: complete" in said, said
    assert "Read-only file system" not in lab.log.read_text()


def test_a_full_disk_is_told_and_the_page_stays_open(lab: Confined) -> None:
    with open(lab.disk / "big", "wb") as big:
        big.write(b"0" * (shutil.disk_usage(lab.disk).free - 8 * 2**20))
    lab.wait_for(lambda: lab.answers("/healthz", 503))
    answer = lab.get("/healthz")
    assert answer is not None and "disk is full" in json.dumps(answer.json()["checks"])
    assert lab.answers("/login", 200), "what the probes of Kubernetes ask"
    (lab.disk / "big").unlink()
    lab.wait_for(lambda: lab.answers("/healthz", 200))


def test_systemd_is_told_of_start_life_and_stop(lab: Confined) -> None:
    said = [lab.told.recv(100), lab.told.recv(100)]
    assert sorted(said) == [b"READY=1", b"WATCHDOG=1"]
    os.kill(lab.pid, signal.SIGTERM)
    while (word := lab.told.recv(100)) == b"WATCHDOG=1":
        pass
    assert word == b"STOPPING=1"
    assert lab.process.wait(timeout=120) in (0, 128 + signal.SIGTERM)
