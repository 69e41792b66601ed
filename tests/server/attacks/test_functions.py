"""Every function of the page, called by eve with ada's things, with wrong values, and in ada's session.

The calls are made from the functions as they are built and from what their components declare, so that a function
that is new is attacked as well.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from .backend import Backend
from .known import API
from .target import CANARY, SECRETS, Target
from .values import WRONG, event_data, filled, takes_text, usual
from .victim import SECRET, UPLOADED, Victim

Victims = Callable[[Target], Victim]
NAMED = ("run", "study", "study_key", "public", "upload", "download", "stream", "canary")
"""What of ada's stands where a function takes a text."""
STORY = '[[beat]]\nwords = "They wait."\n\n[[pose]]\nperson = "a"\nseconds = 0.0\nfile = "%s"\nframe = 0\n'
TEXTS = (
    *(f"{{{name}}}" for name in NAMED),
    STORY % "{canary}",
    '{"id": "{run}", "run": "{run}", "path": "{upload}", "positions": "{upload}", "partner": "{stream}"}',
)
"""Also in a story and in JSON, which some boxes are read as."""
NEVER = (SECRET, UPLOADED, CANARY)


def calls(backend: Backend, number: int, *, alone: bool) -> Iterator[tuple[list[Any], Any]]:
    """Values and event data of the calls of a function: as the page makes it, and then with what is ada's.

    Args:
        backend: the functions.
        number: of the function.
        alone: False for one whose code another function has as well; that is called as the page does alone.
    """
    function = backend.functions[number]
    data = [usual(component) for component in function.inputs]
    if function.collects_event_data:
        senders = [backend.blocks[sender] for sender, _ in function.targets]
        for text in TEXTS:
            sent = list(event_data(senders[0], text))
            for each in sent if text == TEXTS[0] else sent[:1]:
                yield data, each
    else:
        yield data, None
    if not alone:
        return
    for place, component in enumerate(function.inputs):
        if takes_text(component):
            listed = hasattr(component, "choices") and len(data) > 1
            for text in TEXTS[:1] if listed else TEXTS:
                yield [*data[:place], filled(component, text), *data[place + 1 :]], None


def signature(backend: Backend, number: int) -> tuple[Any, ...]:
    """The code of a function and what it takes."""
    inputs = backend.functions[number].inputs
    return backend.names[number], *((type(each).__name__, each.label) for each in inputs)


def test_none_gives_eve_what_is_ada_s(backend: Backend, closed: Target, victims: Victims) -> None:
    """Every function is reached: it answers one call or more, and no answer and no file of hers holds it."""
    ada, seen, unreached = victims(closed), set(), []
    ada.live()
    logged = len(closed.log())
    for number in backend.functions:
        key, reached = signature(backend, number), 0
        for data, sent in calls(backend, number, alone=key not in seen):
            said = closed.event("eve", number, ada.fill(data), ada.fill(sent))
            answered = '"process_completed"' in said or said.startswith('{"data"')
            assert answered or said.startswith('{"detail"'), (key, data, sent, said)
            assert not [each for each in NEVER if each in said], (key, data, sent, said)
            assert not [each for each in SECRETS if each in said.lower()], (key, data, sent, said)
            reached += answered
        seen.add(key)
        unreached += [key] if not reached else []
    assert not unreached
    assert "Traceback" not in closed.log()[logged:], closed.log()[logged:][-3000:]
    assert not [path for path in closed.files_of("eve") for each in NEVER if closed.holds(path, each)]
    assert [path for path in closed.files_of("ada") if closed.holds(path, SECRET)], "it would be found"
    others = f"SELECT * FROM runs WHERE owner != '{ada.owner}'"
    assert closed.rows(others) and not [row for row in closed.rows(others) if SECRET in str(row)]
    ada.check(backend.number)


def test_none_takes_a_value_that_no_page_sends(backend: Backend, anyone: Target, victims: Victims) -> None:
    """One place after the other gets what it does not take; a refusal or a sentence is the answer."""
    ada, dice, answered = victims(anyone), random.Random(len(WRONG)), 0
    logged = len(anyone.log())
    for number, function in backend.functions.items():
        data = [usual(component) for component in function.inputs]
        tries = [[*data, "more"], data[1:] if data else [None, None], [WRONG[0]] * len(data)]
        for place in range(len(data)):
            tries += [[*data[:place], wrong, *data[place + 1 :]] for wrong in (None, [], *dice.sample(WRONG, 2))]
        for wrong in tries:
            said = anyone.event("eve", number, ada.fill(wrong), ada.fill(dice.choice(WRONG)))
            assert not [each for each in (*NEVER, "Internal Server Error") if each in said], (number, wrong, said)
            assert "Something went wrong inside" not in said and '"error":null' not in said, (number, wrong, said)
            answered += '"process_completed"' in said
    assert answered > 50, "some pass the guard: functions read them"
    assert "Traceback" not in anyone.log()[logged:], anyone.log()[logged:][-3000:]
    assert anyone.healthy()
    ada.check(backend.number)


@pytest.mark.parametrize("path", ["queue/join", "run/predict"])
def test_none_is_called_in_another_s_session(backend: Backend, target: Target, victims: Victims, path: str) -> None:
    """What the page keeps between two events is with the session: eve has none of ada's, ada has her own."""
    ada = victims(target)
    for number in backend.functions:
        data, sent = next(calls(backend, number, alone=False))
        body = {"data": data, "fn_index": number, "event_data": sent, "session_hash": ada.things["session"]}
        answer = target.ask("eve", "POST", f"{API}/{path}", json=body)
        assert (answer.status_code, "somebody else" in answer.text) == (403, True), (number, answer.text)
    ada.check(backend.number)
