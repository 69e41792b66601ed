"""Everything that can be set, in one typed place: the environment first, then a file, then the defaults.

``PASDEDEUX_PORT=8000`` sets ``port``; the file is TOML with the same names, ``pasdedeux.toml`` in the working
folder or what ``PASDEDEUX_SETTINGS`` names. ``python -m webdemo serve --print-settings`` shows what holds.
"""

from __future__ import annotations

import ipaddress
import os
import tempfile
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, ValidationError
from pydantic_settings import (
    BaseSettings,
    PydanticBaseSettingsSource,
    SettingsConfigDict,
    SettingsError,
    TomlConfigSettingsSource,
)

from motion import InputError
from motion.cores import usable_cores
from webdemo.inference.own.entries import SETTINGS_FILE, SETTINGS_VARIABLE

PREFIX = "PASDEDEUX_"
PEOPLE = 8
"""People of a small lab, whose room together is all there is; a larger one seldom uses all of everyone's."""
PRIVATE = ("127.0.0.0/8", "10.0.0.0/8", "172.16.0.0/12", "192.168.0.0/16")
"""Private networks: a Space's proxy is in one of them, and nobody else reaches the Space directly. With "*", a visitor
could claim any address, since the first one that is forwarded would count."""


def is_loopback(host: str) -> bool:
    """True if an address or name is this machine's loopback."""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def on_a_space() -> bool:
    """True if this is a Hugging Face Space, which is always public."""
    return "SPACE_ID" in os.environ


def _data_folder() -> Path:
    """The user's data folder; a temporary folder of the user's if there is no home folder."""
    base = os.environ.get("XDG_DATA_HOME")
    try:
        return (Path(base) if base else Path.home() / ".local" / "share") / "pas-de-deux"
    except RuntimeError:
        return Path(tempfile.gettempdir()) / f"pas-de-deux-{os.getuid()}" / "data"


class Settings(BaseSettings):
    """The server's settings; each field's description gives its purpose and unit."""

    model_config = SettingsConfigDict(
        env_prefix=PREFIX, extra="forbid", frozen=True, validate_default=True, env_ignore_empty=True
    )

    # ---- where it listens
    host: str = Field(
        default_factory=lambda: "0.0.0.0" if on_a_space() else "127.0.0.1", description="address to listen on"
    )
    port: int = Field(7860, ge=1, le=65535, description="port to listen on")
    root_path: str = Field("", pattern=r"^(/[\w.~-]+)*$", description="path under which a proxy serves the page")
    proxies: list[str] = Field(
        default_factory=lambda: [*PRIVATE] if on_a_space() else ["127.0.0.1", "::1"],
        description="addresses of proxies whose X-Forwarded headers are trusted",
    )
    hosts: list[str] = Field(
        [], description="host names that browsers may use; by default only its own on loopback, otherwise any"
    )

    # ---- who may use it
    accounts: bool = Field(False, description="people sign in; `python -m webdemo user add NAME` makes accounts")
    proxy_user: str = Field(
        "",
        pattern=r"^[A-Za-z0-9-]*$",
        description="header by which a trusted proxy says who signed in there, as X-Remote-User; empty: none",
    )
    open: bool = Field(default_factory=on_a_space, description="serve other machines without accounts")
    session_hours: float = Field(24 * 14, gt=0, le=24 * 365, description="how long a sign-in lasts")
    metrics_token: str = Field(
        "", description="bearer token for /metrics from other machines; empty: only this machine"
    )

    # ---- what is kept
    data: Path = Field(default_factory=_data_folder, description="folder that holds the history")
    keep_days: float = Field(30, gt=0, description="age in days at which a run is removed unless it is a favourite")
    keep_megabytes: float = Field(
        2000, gt=0, description="total size of all people's runs and studies; none is removed for another person's"
    )
    person_megabytes: float | None = Field(
        None,
        gt=0,
        description="room of one person for runs, studies, uploads and downloads together; by default an eighth of "
        "keep_megabytes and scratch_megabytes, or all of it where there is one history",
    )
    publish_days: float = Field(
        30, ge=0, le=3650, description="days for which a public page lasts at most; 0: no public pages"
    )
    free_megabytes: float = Field(100, ge=0, description="free disk space below which runs and uploads are refused")
    scratch_megabytes: float = Field(2000, gt=0, description="total size of all people's uploads and download files")

    # ---- the queue
    running: int = Field(2, ge=1, description="runs of one person at the same time")
    waiting: int = Field(4, ge=1, description="runs of one person that may wait")
    queue: int = Field(64, ge=1, le=1000, description="runs of all people that may wait")
    events: int = Field(
        16, ge=8, le=1000, description="unfinished events of one person: runs, films, files that are read"
    )
    run_seconds: float = Field(600, ge=0, description="time that one run may take once it has begun; 0: any")
    grace_seconds: float = Field(60, ge=0, description="how long runs may take to finish at a shutdown")

    # ---- when something is stuck
    stuck_seconds: float = Field(
        300, gt=0, description="time without progress after which a run counts as stuck, and /healthz says so"
    )
    exit_when_stuck: bool = Field(
        False, description="end the process when it is stuck, for a supervisor that starts it again"
    )

    # ---- live streams
    live: int = Field(
        default_factory=lambda: 2 * usable_cores(), ge=0, le=200, description="live streams at the same time; 0: none"
    )

    # ---- where the networks run
    engine: Literal["local", "ray"] = Field(
        "local", description="local: in this process; ray: in replicas of Ray Serve"
    )
    ray_address: str = Field("", description="address of the Ray cluster to join; empty: start one on this machine")
    ray_replicas: int = Field(2, ge=1, le=64, description="largest number of replicas of the default model")
    ray_cores: float = Field(1, gt=0, le=256, description="cores per replica")

    # ---- models of the lab's own
    models: dict[str, Any] = Field(
        {}, description="released checkpoints and Python classes, one table for each: see docs/own-model.md"
    )

    # ---- limits
    rate: int = Field(240, ge=1, description="requests per person and minute that change something")
    address_people: int = Field(8, ge=1, description="on an open server: how many people's share one address may take")
    upload_megabytes: float = Field(50, gt=0, le=50, description="largest upload")
    body_megabytes: float = Field(2, gt=0, description="largest body of any other request")
    body_seconds: float = Field(60, gt=0, description="time for a request's body to arrive")
    header_seconds: float = Field(10, gt=0, description="time for a request's headers to arrive")
    answer_seconds: float = Field(
        20, gt=0, description="time in which the next 48 kB of an answer must be read, or what is left of it"
    )
    connections: int = Field(1000, ge=1, description="open connections")
    address_connections: int = Field(
        400, ge=1, description="open connections per address, behind a trusted proxy of the one it forwards"
    )

    # ---- logs
    log_level: str = Field("info", pattern="^(debug|info|warning|error)$", description="lowest level that is logged")
    log_content: bool = Field(False, description="let logs contain prompts and what errors say about them")

    @classmethod
    def settings_customise_sources(
        cls,
        settings_cls: type[BaseSettings],
        init_settings: PydanticBaseSettingsSource,
        env_settings: PydanticBaseSettingsSource,
        dotenv_settings: PydanticBaseSettingsSource,
        file_secret_settings: PydanticBaseSettingsSource,
    ) -> tuple[PydanticBaseSettingsSource, ...]:
        """The environment first, then the settings file, then the defaults."""
        file = Path(os.environ.get(SETTINGS_VARIABLE) or SETTINGS_FILE)
        return init_settings, env_settings, TomlConfigSettingsSource(settings_cls, file)

    @property
    def local(self) -> bool:
        """True if only this machine can reach the server."""
        return is_loopback(self.host)

    @property
    def sign_in(self) -> bool:
        """True if people sign in, here or at a proxy."""
        return self.accounts or bool(self.proxy_user)

    @property
    def person_bytes(self) -> float:
        """Bytes that one person may store."""
        if self.person_megabytes is not None:
            return self.person_megabytes * 2**20
        people = PEOPLE if self.sign_in or self.open else 1
        return (self.keep_megabytes + self.scratch_megabytes) * 2**20 / people

    @property
    def url(self) -> str:
        """The page's address, for the person who started the server."""
        host = "127.0.0.1" if self.host in ("0.0.0.0", "::") else self.host
        return f"http://{f'[{host}]' if ':' in host else host}:{self.port}{self.root_path}/"

    @property
    def database(self) -> Path:
        """The database's file."""
        return self.data / "history.db"

    @property
    def motions(self) -> Path:
        """Folder of the runs' motion files."""
        return self.data / "motions"

    def check(self) -> None:
        """Raises InputError if the server would be open to others without anybody having said so."""
        if self.proxy_user and "*" in self.proxies:
            raise InputError(
                f"With {PREFIX}PROXY_USER, {PREFIX}PROXIES cannot be *, or anybody could claim to be anybody: name the "
                "addresses of the proxies."
            )
        if not self.local and not self.sign_in and not self.open:
            raise InputError(
                f"{self.host} can be reached from other machines and there are no accounts: make some with "
                f"`python -m webdemo user add NAME` and set {PREFIX}ACCOUNTS=1, or let anyone in, {PREFIX}OPEN=1."
            )

    def shown(self) -> dict[str, Any]:
        """The settings as plain values, secrets left out."""
        plain = self.model_dump(mode="json")
        plain["person_megabytes"] = self.person_bytes / 2**20
        plain["metrics_token"] = "set" if self.metrics_token else ""
        return plain


def read_settings(**given: Any) -> Settings:
    """The settings in force; what is given here (and is not None) goes before environment and file.

    Raises:
        InputError: one sentence naming the setting that does not fit, and the reason.
    """
    named = os.environ.get(SETTINGS_VARIABLE)
    if named and not Path(named).is_file():
        raise InputError(f"There is no settings file {named}: correct {SETTINGS_VARIABLE} or make the file.")
    try:
        return Settings(**{name: value for name, value in given.items() if value is not None})
    except ValidationError as error:
        first = error.errors()[0]
        name = ".".join(str(part) for part in first["loc"]) or "the settings"
        if first["type"] == "extra_forbidden":
            raise InputError(f"There is no setting {name!r}: see `python -m webdemo serve --print-settings`.") from None
        raise InputError(
            f"The setting {name} ({PREFIX}{name.upper()}) cannot be {first['input']!r:.60}: "
            f"{first['msg'][:1].lower()}{first['msg'][1:]}."
        ) from None
    except SettingsError as error:
        raise InputError(f"The settings cannot be read ({error}): lists are written as JSON.") from None
    except ValueError as error:  # the file is not TOML
        raise InputError(f"The settings file {named or SETTINGS_FILE} cannot be read: {error}.") from None


def settings_of_history() -> Settings:
    """The settings in force; raises InputError where they name no lab that has been started."""
    settings = read_settings()
    if not settings.database.is_file():
        raise InputError(f"There is no history of a lab in {settings.data}: name its folder with {PREFIX}DATA.")
    return settings
