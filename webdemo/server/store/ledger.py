"""The lab's own row in the database: how much time has passed, and whose turn it is to change what is stored.

Ages are counted in the lab's time. It moves with the machine's uptime and, between two processes, with the clock. A
clock that is set forwards or backwards by more than a day does not move it, so that no run grows old by a wrong clock.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass

from sqlalchemy import func, select, update
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Mapped, Session, mapped_column

from .database import Database, Run, Table

log = logging.getLogger(__name__)

DAY = 86_400.0
LEAP_SECONDS = DAY
"""A clock that moves further than this from the lab's time has jumped."""
STEADY_SECONDS = DAY
"""A clock that has jumped is believed after so much time without another jump."""


class Ledger(Table):
    """The one row that all processes share.

    Attributes:
        id: always 1.
        elapsed: the lab's time. It began as the seconds since 1970 and never runs backwards.
        wall: what the clock showed when it was last looked at, in seconds since 1970.
        accepted: seconds by which the clock differs from the lab's time for good.
        doubted: the lab's time at which the clock jumped; None while the clock is trusted.
        ahead: by how many seconds it jumped.
        turn: changes with everything that is stored or removed.
    """

    __tablename__ = "ledger"

    id: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    elapsed: Mapped[float]
    wall: Mapped[float]
    accepted: Mapped[float] = mapped_column(default=0.0)
    doubted: Mapped[float | None] = mapped_column(default=None)
    ahead: Mapped[float] = mapped_column(default=0.0)
    turn: Mapped[int] = mapped_column(default=0)


def locked(session: Session, wall: float | None = None) -> Ledger:
    """The row, which no other process can read by this function until the transaction ends.

    Args:
        session: in a transaction.
        wall: what the clock shows; by default what it shows here.
    """
    turn = update(Ledger).where(Ledger.id == 1).values(turn=Ledger.turn + 1)
    if not session.connection().execute(turn).rowcount:
        now = time.time() if wall is None else wall
        newest = session.scalar(select(func.max(Run.created)).where(Run.created > 0)) or now
        # The clock may be wrong while an earlier version's runs are counted for the first time.
        begin = newest if abs(now - newest) > LEAP_SECONDS else max(now, newest)
        try:
            with session.begin_nested():
                session.add(Ledger(id=1, elapsed=begin, wall=now))
        except IntegrityError:  # another process was quicker
            pass
        session.connection().execute(turn)
    return session.get_one(Ledger, 1, populate_existing=True)


@dataclass(frozen=True)
class ClockState:
    """The machine's clock beside the lab's time.

    Attributes:
        clock: what the clock shows, in seconds since 1970.
        lab: the lab's time, in the same unit.
        jump: seconds by which the clock has jumped; 0 while it is trusted.
        steady: seconds without another jump since then.
    """

    clock: float
    lab: float
    jump: float
    steady: float


def _uptime() -> float:
    """Seconds that the machine has been up, asleep as well where the system counts them."""
    return time.clock_gettime(time.CLOCK_BOOTTIME) if hasattr(time, "CLOCK_BOOTTIME") else time.monotonic()


class LabClock:
    """The lab's time, as one process tells it.

    Args:
        database: holds the ledger.
        wall: seconds since 1970, which anyone may set.
        uptime: seconds that always move on at the same speed.
    """

    def __init__(
        self, database: Database, *, wall: Callable[[], float] = time.time, uptime: Callable[[], float] = _uptime
    ) -> None:
        self.database, self.wall, self.uptime = database, wall, uptime
        self._last: tuple[float, float] | None = None
        self.look()

    def now(self) -> float:
        """The lab's time in seconds."""
        assert self._last is not None
        lab, at = self._last
        return lab + self.uptime() - at

    def look(self) -> bool:
        """Compares the clock with the lab's time and writes both down; True if the clock is trusted."""
        wall, at = self.wall(), self.uptime()
        with self.database.session.begin() as session:
            row = locked(session, wall)
            if self._last is None:
                away = wall - row.wall
                lab = row.elapsed + (away if 0 <= away <= LEAP_SECONDS else 0.0)
            else:
                lab = max(row.elapsed, self._last[0] + at - self._last[1])
            ahead = wall - row.accepted - lab
            if abs(ahead) <= LEAP_SECONDS:
                lab += max(ahead, 0.0)
                if row.doubted is not None:
                    log.warning("The clock agrees with the lab's time again: old runs are removed again.")
                    row.doubted = None
            elif row.doubted is None or abs(ahead - row.ahead) > LEAP_SECONDS:
                log.warning(
                    "The clock has jumped by %+.1f days: nothing is removed because of its age until the clock was "
                    "steady for %.0f hours, or `python -m webdemo clock` says that it is right.",
                    ahead / DAY,
                    STEADY_SECONDS / 3600,
                )
                row.doubted, row.ahead = lab, ahead
            elif lab - row.doubted >= STEADY_SECONDS:
                log.warning("The clock was steady for a day: old runs are removed again.")
                row.accepted, row.doubted = row.accepted + ahead, None
            row.elapsed, row.wall = lab, wall
            trusted = row.doubted is None
        self._last = (lab, at)
        return trusted

    def state(self) -> ClockState:
        """Looks at the clock and tells what it found."""
        self.look()
        with self.database.session() as session:
            row = session.get_one(Ledger, 1)
            doubted = row.doubted is not None
            return ClockState(
                clock=row.wall,
                lab=row.elapsed,
                jump=row.ahead if doubted else 0.0,
                steady=row.elapsed - row.doubted if row.doubted is not None else 0.0,
            )

    def confirm(self, *, passed: bool) -> None:
        """Trusts the clock as it is, at all processes.

        Args:
            passed: the time of a jump forwards has really passed, so that runs are older by it; otherwise the clock
                was corrected, and they are as old as before.
        """
        self.look()
        with self.database.session.begin() as session:
            row = locked(session)
            ahead = row.wall - row.accepted - row.elapsed
            if passed and ahead > 0:
                row.elapsed += ahead
            else:
                row.accepted += ahead
            row.doubted = None
        self._last = None
        self.look()
