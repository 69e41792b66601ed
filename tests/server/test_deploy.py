"""The files that a lab runs it by say what the program understands."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from ipaddress import ip_address, ip_network
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.server.clients import wait_for
from webdemo.server.process import SILENT_SECONDS
from webdemo.server.settings import PREFIX, read_settings

from .lab import ROOT

DOCKERFILE = (ROOT / "Dockerfile").read_text().replace("\\\n", "")
UNIT = ROOT / "docs" / "deploy" / "pas-de-deux.service"
CHECK_PORT = "127.0.0.1:7860"


def instructions(name: str) -> list[str]:
    """What follows each of an instruction's words in the image's last stage."""
    last = DOCKERFILE[DOCKERFILE.rindex("\nFROM ") + 1 :]
    return [line.removeprefix(f"{name} ") for line in last.splitlines() if line.startswith(f"{name} ")]


def settings_in(text: str) -> dict[str, str]:
    return dict(re.findall(rf"({PREFIX}[A-Z_]+)=(\S+)", text))


def test_the_image_runs_without_rights_and_has_what_it_needs() -> None:
    assert instructions("USER") == ["10001:10001"]
    assert "--uid 10001" in DOCKERFILE and "--gid 10001" in DOCKERFILE and "-o lab -g lab -m 700 /data" in DOCKERFILE
    copied = [line.split()[0] for line in instructions("COPY") if not line.startswith("--from")]
    assert copied and all((ROOT / name).exists() for name in copied)
    let_in = (ROOT / ".dockerignore").read_text().splitlines()
    assert all(f"!{name}" in let_in for name in [*copied, *LOCKS])
    index = re.search(r"--extra-index-url (\S+/cpu)\b", DOCKERFILE)
    assert index is not None and f"--index-url {index[1]}" in (ROOT / "docs" / "using.md").read_text()


LOCKS = ("requirements.lock", "requirements-ray.lock")
IMAGE = {"python_version": "3.11", "sys_platform": "linux", "platform_machine": "x86_64"}


def locked_in(name: str) -> dict[str, str]:
    """The versions by package in a lock, each of whose lines must have a hash and none the address of an index."""
    text = (ROOT / name).read_text()
    blocks = re.findall(
        r"^([a-z0-9-]+)(?:\[\S+\])?==(\S+) \\\n((?: +--hash=sha256:[0-9a-f]{64}(?: \\)?\n)+)", text, re.MULTILINE
    )
    lines = [line for line in text.splitlines() if not line.startswith(("#", " "))]
    assert len(lines) == len(blocks) > 50 and "://" not in text
    return {name: version for name, version, _ in blocks}


def test_the_image_installs_what_is_locked() -> None:
    """Everything by its hash and nothing else, and what the requirements ask for."""
    locked, rays = (locked_in(name) for name in LOCKS)
    installs = re.findall(r"pip install (.+?) &&", DOCKERFILE)
    assert len(installs) == 1 and {"--require-hashes", "--no-deps"} <= set(installs[0].split())
    assert "curl" not in DOCKERFILE and "wget" not in DOCKERFILE and "apt" not in DOCKERFILE
    assert locked["torch"] == "2.13.0+cpu" and "ray" in rays
    assert all(locked.get(name, version) == version for name, version in rays.items())
    for line in (ROOT / "requirements.txt").read_text().splitlines():
        if line.startswith("#"):
            continue
        wanted = Requirement(line)
        assert re.search("<|==", line), f"{line} has no upper bound"
        here = wanted.marker is None or wanted.marker.evaluate(IMAGE)
        if here:
            assert wanted.specifier.contains(locked[canonicalize_name(wanted.name)]), line


def test_compose_takes_every_right_away(monkeypatch: pytest.MonkeyPatch) -> None:
    compose = yaml.safe_load((ROOT / "compose.yaml").read_text())
    if command := shutil.which("docker-compose"):  # needs no engine
        checked = subprocess.run([command, "config", "--quiet"], cwd=ROOT, capture_output=True, text=True)
        assert checked.returncode == 0, checked.stderr
    (lab,) = compose["services"].values()
    assert [lab["user"]] == instructions("USER") and lab["read_only"] is True and lab["cap_drop"] == ["ALL"]
    assert lab["security_opt"] == ["no-new-privileges:true"]
    assert all(port.startswith("127.0.0.1:") for port in lab["ports"])
    for name, value in {**settings_in(DOCKERFILE), **lab["environment"]}.items():
        monkeypatch.setenv(name, value)
    settings = read_settings()
    settings.check()  # it is not open
    (network,) = compose["networks"].values()
    (addresses,) = network["ipam"]["config"]
    assert lab["networks"] == list(compose["networks"]) and settings.proxies == [addresses["gateway"]]
    assert ip_address(addresses["gateway"]) in ip_network(addresses["subnet"])
    assert settings.exit_when_stuck and lab["restart"] == "unless-stopped"
    written = {mount.split(":")[1] for mount in lab["volumes"]}
    assert str(settings.data) in written and settings.accounts
    assert int(lab["stop_grace_period"].removesuffix("s")) > settings.grace_seconds


def test_the_health_check_asks_the_server(served: tuple[str, int]) -> None:
    (check,) = instructions("HEALTHCHECK")
    command = json.loads(check[check.index("[") :])
    assert command[0] == "python" and CHECK_PORT in command[-1]

    def status(port: int) -> int:
        script = command[-1].replace(CHECK_PORT, f"127.0.0.1:{port}")
        return subprocess.run([sys.executable, *command[1:-1], script], capture_output=True).returncode

    wait_for(lambda: status(served[1]) == 0)
    assert status(1) != 0


def test_the_unit_is_understood(tmp_path: Path) -> None:
    text = UNIT.read_text()
    assert settings_in(text)[f"{PREFIX}ACCOUNTS"] == "1" and "User=root" not in text
    assert "Restart=on-failure" in text and settings_in(text)[f"{PREFIX}EXIT_WHEN_STUCK"] == "1"
    assert "Type=notify" in text and int(text.split("WatchdogSec=")[1].split()[0]) > SILENT_SECONDS
    fields = set(type(read_settings()).model_fields)
    assert {name.removeprefix(PREFIX).lower() for name in settings_in(text)} <= fields
    if (analyze := shutil.which("systemd-analyze")) is None:
        pytest.skip("no systemd-analyze on this machine")
    # It looks for the programs and folders that it names, which are elsewhere here.
    here = text.replace("/opt/pas-de-deux/.venv/bin/python", sys.executable)
    unit = tmp_path / UNIT.name
    unit.write_text(here.replace("/opt/pas-de-deux", str(ROOT)))
    env = {**os.environ, "SYSTEMD_LOG_LEVEL": "warning"}
    said = subprocess.run([analyze, "verify", str(unit)], capture_output=True, text=True, env=env)
    assert said.returncode == 0 and not said.stderr.strip(), said.stderr
    exposed = subprocess.run(
        [analyze, "security", "--offline=true", "--threshold=20", str(unit)], capture_output=True, text=True
    )
    assert exposed.returncode == 0, exposed.stdout
