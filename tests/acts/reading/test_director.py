"""The director beside a small server on loopback that answers well, badly, slowly or with ill will."""

from __future__ import annotations

import json
import logging
import threading
import time
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import pytest

from acts import lexicon
from acts.config import DirectorSettings, director_settings
from acts.reading import director
from acts.reading.director import directed
from motion import InputError

GERMAN = "Er umarmt sie, danach winkt sie ihm zu."
HUG = {"id": "1", "act": "hug", "agents": ["a"], "patient": "b", "words": "umarmt sie"}
WAVE = {"id": "2", "act": "wave", "agents": ["b"], "order": [{"kind": "after", "act": "1"}]}
KEY = "s3cret-key"


def chat(content: Any) -> tuple[int, bytes]:
    text = content if isinstance(content, str) else json.dumps(content)
    return 200, json.dumps({"choices": [{"message": {"content": text}}]}).encode()


class Fake:
    """Answers the n-th request as ``answers[n]`` says, the last one from then on, and keeps what was sent."""

    def __init__(self) -> None:
        self.answers: list[Any] = []
        self.seen: list[dict[str, Any]] = []
        self.keys: list[str | None] = []
        fake = self

        class Handler(BaseHTTPRequestHandler):
            def do_POST(self) -> None:
                sent = self.rfile.read(int(self.headers["Content-Length"]))
                fake.seen.append(json.loads(sent))
                fake.keys.append(self.headers.get("Authorization"))
                answer = fake.answers[min(len(fake.seen), len(fake.answers)) - 1]
                state, body = answer(self) if callable(answer) else answer
                self.send_response(state)
                if state == 302:
                    self.send_header("Location", "/v1/chat/completions")
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, *args: Any) -> None:
                pass

        self.server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.url = f"http://127.0.0.1:{self.server.server_port}/v1"
        threading.Thread(target=self.server.serve_forever, args=(0.05,), daemon=True).start()


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> Iterator[Fake]:
    found = Fake()
    for name, value in {"URL": found.url, "MODEL": "small:1b", "KEY": KEY}.items():
        monkeypatch.setenv(f"PASDEDEUX_DIRECTOR_{name}", value)
    director._kept.clear()
    director._form_of.clear()
    yield found
    found.server.shutdown()
    found.server.server_close()


def test_another_language_is_read_once_and_kept(fake: Fake) -> None:
    fake.answers = [chat({"acts": [HUG, WAVE], "people": [{"id": "b", "sex": "f", "words": ["sie"]}]})]
    plan = directed(GERMAN)
    assert plan.reader == "small:1b" and plan.sentence == GERMAN and not plan.notes
    assert [(act.act, act.agents, act.patient) for act in plan.acts] == [("hug", ("a",), "b"), ("wave", ("b",), None)]
    assert plan.acts[0].words is not None and plan.text(plan.acts[0].words) == "umarmt sie"
    assert [[act.id for act in group] for group in plan.beats()] == [["1"], ["2"]]
    assert plan.people[1].sex == "f"
    assert directed(GERMAN) == plan and directed(GERMAN, ask=False) == plan and len(fake.seen) == 1
    form = fake.seen[0]["response_format"]["json_schema"]["schema"]
    assert "hug" in form["$defs"]["Act"]["properties"]["act"]["enum"] and fake.keys == [f"Bearer {KEY}"]


def test_what_the_lexicon_reads_is_not_sent(fake: Fake, monkeypatch: pytest.MonkeyPatch) -> None:
    fake.answers = [chat({"acts": [WAVE | {"order": []}]})]
    assert directed("Two people hug.").reader == "lexicon"
    assert directed(GERMAN, ask=False).reader == "lexicon" and not fake.seen
    monkeypatch.setenv("PASDEDEUX_DIRECTOR_WHEN", "always")
    assert directed("Two people hug.").acts[0].act == "wave"


@pytest.mark.parametrize("state", [400, 500])
def test_a_server_that_refuses_a_schema_is_asked_in_another_form(fake: Fake, state: int) -> None:
    plain = chat(f"Here it is:\n```json\n{json.dumps({'acts': [HUG]})}\n```")
    fake.answers = [(state, b"{}")] * 3 + [plain]
    assert directed(GERMAN).acts[0].act == "hug"
    forms = [sent.get("response_format", {}) for sent in fake.seen]
    assert [form.get("type") for form in forms] == ["json_schema", "json_object", "json_schema", None]
    assert ["max_tokens" in sent for sent in fake.seen] == [True, True, False, False], "not all take a limit"
    assert forms[1]["schema"] == forms[0]["json_schema"]["schema"]
    director._kept.clear()
    assert directed(GERMAN).acts and "response_format" not in fake.seen[4], "what it takes is remembered"


def test_the_list_of_acts_is_short() -> None:
    task = director._task(lexicon())
    assert "\nbeg: pray\n" in task and "\nhug b\n" in task and "\nbow\n" in task
    assert "[" not in task.partition("Acts:")[2] and len(task) < 11_000, "about 2,900 tokens"


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ("no JSON at all", "no JSON object"),
        ({"acts": [HUG | {"act": "teleport"}]}, "there is no act “teleport”"),
        ({"acts": [HUG | {"patient": "a"}]}, "The patient must not be an agent"),
        ({"acts": [HUG, HUG]}, "id is taken"),
        ({"acts": [HUG | {"id": str(i)} for i in range(70)]}, "more than 60 acts"),
    ],
)
def test_a_wrong_answer_may_be_corrected_once(fake: Fake, wrong: Any, said: str) -> None:
    fake.answers = [chat(wrong), chat({"acts": [HUG]})]
    plan = directed(GERMAN)
    assert [act.act for act in plan.acts] == ["hug"] and not plan.notes
    assert said in fake.seen[1]["messages"][-1]["content"]


def test_what_is_done_to_somebody_is_done_to_the_other(fake: Fake) -> None:
    carry = {"id": "1", "act": "carry", "agents": ["b"]}
    fake.answers = [chat({"acts": [carry, WAVE | {"order": []}]})]
    assert [act.patient for act in directed(GERMAN).acts] == ["a", None]


def test_what_stays_wrong_is_dropped_with_a_note(fake: Fake) -> None:
    beam = {"id": "9", "act": "beam-up", "agents": ["a"]}
    fake.answers = [chat({"acts": [HUG, beam, WAVE | {"order": [{"kind": "after", "act": "9"}]}]})]
    plan = directed(GERMAN)
    assert [act.act for act in plan.acts] == ["hug", "wave"] and plan.acts[1].order == ()
    assert len(fake.seen) == 2 and "there is no act “beam-up”" in plan.notes[0]


def _slow(handler: Any) -> tuple[int, bytes]:
    time.sleep(1.5)
    return chat({"acts": [HUG]})


def _drips(handler: Any) -> tuple[int, bytes]:
    for _ in range(12):
        handler.wfile.write(b"H")
        handler.wfile.flush()
        time.sleep(0.15)
    return 200, b""


FAILURES: dict[str, tuple[Any, str]] = {
    "redirect": ((302, b""), "answered with HTTP 302"),
    "huge": ((200, b"x" * 1_000_000), "answered with too much"),
    "no chat": ((200, b'{"error": "' + KEY.encode() + b'"}'), "gave no answer of the kind"),
    "deep": (chat('{"acts":' + "[" * 50_000 + "]" * 50_000 + "}"), "gave no act that can be used"),
    "slow": (_slow, "took longer than 0.5 s"),
    "dripping": (_drips, "took longer than 0.5 s|could not be asked"),
}


@pytest.mark.parametrize("case", sorted(FAILURES))
def test_what_fails_leaves_the_reading_of_the_lexicon(
    fake: Fake, case: str, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    answer, said = FAILURES[case]
    fake.answers = [answer]
    limited = case in ("slow", "dripping")
    monkeypatch.setenv("PASDEDEUX_DIRECTOR_SECONDS", "0.5" if limited else "20")
    began = time.monotonic()
    with caplog.at_level(logging.DEBUG):
        plan = directed(GERMAN)
    assert time.monotonic() - began < 1.3 or not limited
    assert plan.reader == "lexicon" and plan.unread
    assert any(part in plan.notes[-1] for part in said.split("|")), plan.notes
    assert KEY not in plan.model_dump_json() + caplog.text
    assert len(fake.seen) <= 4


def test_a_hostile_answer_stays_data(fake: Fake) -> None:
    hostile = HUG | {
        "thing": "../../etc/passwd",
        "part": "<img src=x onerror=alert(1)>",
        "direction": "file:///etc/passwd",
        "manner": ["<b>slowly</b>", "gently"],
        "words": "/etc/passwd",
    }
    more = {"reader": "hand", "sentence": "<script>", "file": "/etc/passwd", "notes": ["<script>"]}
    fake.answers = [chat({"acts": [hostile], "people": [{"id": "a", "words": ["<b>"]}], **more})]
    plan = directed(GERMAN)
    (act,) = plan.acts
    assert (act.thing, act.part, act.direction, act.manner, act.words) == (None, None, None, ("gently",), None)
    assert plan.reader == "small:1b" and plan.sentence == GERMAN
    assert not any(mark in plan.model_dump_json() for mark in ("<", "passwd"))
    fake.answers = [chat({"acts": [HUG | {"<script>" + "x" * 9000: 1}]})]
    director._kept.clear()
    assert directed(GERMAN).reader == "lexicon", "an act with a field of its own is none"


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"URL": "http://lab.example/v1"}, "http:// to another machine"),
        ({"URL": f"https://me:{KEY}@lab.example/v1"}, "director.url must be"),
        ({"URL": "http://127.0.0.1:99999/v1"}, "director.url must be"),
        ({"KEY": f"{KEY}\nX: y"}, "key of plain characters"),
        ({"WHEN": "often"}, "director.when"),
    ],
)
def test_settings_that_do_not_fit_are_said_without_the_key(
    fake: Fake, fields: dict[str, str], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in fields.items():
        monkeypatch.setenv(f"PASDEDEUX_DIRECTOR_{name}", value)
    with pytest.raises(InputError, match=said) as error:
        director_settings()
    plan = directed(GERMAN)
    assert KEY not in str(error.value) + plan.model_dump_json() and said in plan.notes[-1] and not fake.seen


def test_plain_http_to_another_machine_can_be_allowed(fake: Fake, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PASDEDEUX_DIRECTOR_URL", "http://lab.example/v1")
    monkeypatch.setenv("PASDEDEUX_DIRECTOR_PLAIN_HTTP", "1")
    found = director_settings()
    assert isinstance(found, DirectorSettings) and found.plain_http and KEY not in repr(found)


def test_a_request_follows_the_plan_of_the_director(fake: Fake) -> None:
    from webdemo.inference.requests import GenerateRequest
    from webdemo.inference.requests.acting import acted
    from webdemo.inference.story.sentences import as_scene

    fake.answers = [chat({"acts": [HUG | {"part": "nostril", "direction": "sunwise"}, WAVE]})]
    asked = acted(GenerateRequest(prompt=GERMAN))
    assert asked.acts is not None and asked.acts.reader == "small:1b"
    scene = as_scene(asked)
    assert scene is not None and "umarmt" not in " ".join(beat.sentence for beat in scene.beats)
    assert KEY not in json.dumps(asked.to_dict())
