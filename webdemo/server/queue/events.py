"""The queue of page events: nobody fills it alone, and people take turns.

Gradio's own queue has one length for everybody and serves each group of events (films, files that are read, the
history) in order of arrival. Runs are admitted at once, since they wait in :mod:`webdemo.server.queue.queue`.
"""

from __future__ import annotations

import asyncio
import contextlib
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from typing import Any, NamedTuple

from fastapi import HTTPException, Request
from gradio.queueing import Event, EventQueue, Queue
from gradio.utils import LRUCache
from starlette.concurrency import run_in_threadpool

from webdemo.server.accounts.quotas import OverQuota, Quota
from webdemo.server.accounts.visitors import Bindings
from webdemo.server.http.health import Figures
from webdemo.ui.components.reading import READING_EVENTS
from webdemo.ui.visitor import visitor_of

from .turns import Accounts

AT_ONCE = 4
"""Events of one person that are worked on at a time, without runs: fewer than any page needs, so that two long ones
leave room for short ones."""
REST = 3.0
"""Times as long as the reading of a text took, its person's next one waits: a sentence takes 20 ms, and the longest
texts, one after the other, would take a core from the runs of others."""
UNREAD_SECONDS = 60.0
"""Time for which an answer that nobody fetches is kept; it counts as an unfinished event. An opened run takes 2 MB."""


class _Answer(NamedTuple):
    """An answer that is to be fetched, and when it is dropped."""

    session: str
    event: str
    owner: tuple[str, str]
    until: float


class _Messages(LRUCache[str, Any]):
    """The messages of each session. Every stream of a session that is cut off deletes them, the second one as well;
    where that failed, what Gradio keeps of a stream stayed for ever. What is said to a session that is not there is
    lost: where that failed, the queue ended for everybody."""

    def __missing__(self, session: str) -> Any:
        return asyncio.Queue()

    def __delitem__(self, session: str) -> None:
        with contextlib.suppress(KeyError):
            super().__delitem__(session)


class FairEvents(Queue):
    """Gradio's queue with a cap for each person, and turns: the person served least goes first.

    A group of events that may run several at a time gives one person, or one address where people have no accounts, at
    most half of its places.

    Args:
        quota: of unfinished events.
        figures: metrics to update.
        bindings: learns whose event each one is.
        options: of Gradio's queue.
    """

    def __init__(self, *, quota: Quota, figures: Figures, bindings: Bindings, **options: Any) -> None:
        super().__init__(**options, max_size=None)
        self.pending_messages_per_session = _Messages(self.pending_messages_per_session.max_size)
        self.quota, self.figures, self.bindings = quota, figures, bindings
        self.accounts = Accounts()
        self._begun: dict[Event, float] = {}
        self._rests: dict[str, float] = {}
        self._answers: list[_Answer] = []

    async def push(self, body: Any, request: Request, username: str | None) -> Any:
        """Takes an event in.

        Raises:
            HTTPException: 429 with a sentence, if the person or the address has too many unfinished ones; 503 if
                everybody together has.
        """
        who = visitor_of(request)
        known = list(self._unfinished())
        try:
            self.quota.check(who.person, who.address, known)
        except OverQuota as over:
            self.figures.refused.labels(f"events of {over.whose}").inc()
            raise HTTPException(503 if over.whose == "everybody" else 429, str(over)) from None
        self.accounts.meet(who.person, {person for person, _ in known})
        taken, event, state = await super().push(body, request, username)
        if taken:
            self.bindings.check(event, who.person, who.source, begin=True)
        return taken, event, state

    def get_events(self) -> tuple[list[Event], bool, str] | None:
        """The next event: of those that may begin, the first one of the person served least."""
        now = time.monotonic()
        running = list(self._running())
        busy = Counter(visitor_of(event.request).person for event in running if not self._waits_elsewhere(event))
        spent: defaultdict[str, float] = defaultdict(float)
        for event, began in self._begun.items():
            spent[visitor_of(event.request).person] += now - began
        chosen: Event | None = None
        least: tuple[float, float] = (0.0, 0.0)
        for group in self.event_queue_per_concurrency_id.values():
            for event in self._able(group, running, busy):
                person = visitor_of(event.request).person
                due = (self.accounts.served.get(person, 0.0) + spent[person], event.enqueue_time)
                if chosen is None or due < least:
                    chosen, least = event, due
        if chosen is None:
            return None
        self.event_queue_per_concurrency_id[chosen.concurrency_id].queue.remove(chosen)
        return [chosen], False, chosen.concurrency_id

    async def process_events(self, events: list[Event], *rest: Any, **more: Any) -> None:
        """Works on an event and charges its seconds to its person; the time of a run is charged where it waits."""
        (event,) = events
        began, who = time.monotonic(), visitor_of(event.request)
        if not self._waits_elsewhere(event):
            self._begun[event] = began
        try:
            await super().process_events(events, *rest, **more)
        finally:
            now, owner = time.monotonic(), (who.person, who.address)
            self._answers.append(_Answer(event.session_hash, event._id, owner, now + UNREAD_SECONDS))
            asyncio.get_running_loop().call_later(UNREAD_SECONDS, self._drop_answers)
            if self._begun.pop(event, None) is not None:
                self._charge(event, now - began)

    # ---- parts -----------------------------------------------------------------------------------

    def _charge(self, event: Event, seconds: float) -> None:
        """Charges an event's seconds to its person, who rests after a reading."""
        self.accounts.charge(visitor_of(event.request).person, seconds)
        if event.concurrency_id == READING_EVENTS:
            now = time.monotonic()
            self._rests = {source: until for source, until in self._rests.items() if until > now}
            self._rests[visitor_of(event.request).source] = now + REST * seconds

    def _able(self, group: EventQueue, running: list[Event], busy: Counter[str]) -> Iterator[Event]:
        """The events of a group that may begin now, in order of arrival."""
        limit = group.concurrency_limit
        if limit is None:
            yield from group.queue[:1]
            return
        if group.current_concurrency >= limit:
            return
        share, now = max(1, limit // 2), time.monotonic()
        here = Counter(visitor_of(one.request).source for one in running if one.concurrency_id == group.concurrency_id)
        for event in group.queue:
            who = visitor_of(event.request)
            rests = event.concurrency_id == READING_EVENTS and self._rests.get(who.source, 0.0) > now
            if not rests and busy[who.person] < AT_ONCE and here[who.source] < share:
                yield event

    def _waits_elsewhere(self, event: Event) -> bool:
        return self.event_queue_per_concurrency_id[event.concurrency_id].concurrency_limit is None

    def _running(self) -> Iterator[Event]:
        for job in self.active_jobs:
            yield from job or ()

    def _unfinished(self) -> Iterator[tuple[str, str]]:
        """The person and the address of each event that waits, goes on, or whose answer nobody has fetched."""
        waiting = (event for group in self.event_queue_per_concurrency_id.values() for event in group.queue)
        for event in (*self._running(), *waiting):
            who = visitor_of(event.request)
            yield who.person, who.address
        self._drop_answers()
        yield from (answer.owner for answer in self._answers)

    def _drop_answers(self) -> None:
        """Forgets answers that were fetched, and drops those that nobody has fetched for too long."""
        now, pending = time.monotonic(), self.pending_event_ids_session
        for answer in list(self._answers):
            events = pending.get(answer.session, set())
            there = answer.event in events and answer.session in self.pending_messages_per_session
            if there and now < answer.until:
                continue
            self._answers.remove(answer)
            events.discard(answer.event)
            if there:
                self.bindings.forget(answer.event)
            if not events:
                pending.pop(answer.session, None)
                messages = self.pending_messages_per_session.get(answer.session)
                while messages and not messages.empty():  # a stream that has begun waits for what follows
                    messages.get_nowait()


async def close_in_a_thread(closing: Any, timeout: float = 60.0, pause: float = 0.05) -> None:
    """Ends the generator of an event whose page is gone, with the signature of ``SyncToAsyncIterator.aclose``.

    Gradio (6.31) closes it on the event loop: what it does at its end, such as writing down a run, kept all others
    waiting. One that is at a step is tried again.
    """
    until = time.monotonic() + timeout
    while True:
        try:
            return await run_in_threadpool(closing.iterator.close)
        except ValueError as error:
            if "already executing" not in str(error) or time.monotonic() > until:
                raise
        await asyncio.sleep(pause)
