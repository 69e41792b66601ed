"""Attacks as data: who sends what to which server, and what may come back.

``{name}`` in a path, header or value stands for one of the victim's things, see :class:`.victim.Victim`: ada's
upload, download, call, session, run and study, and places on the server's disk.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from ..clients import FIELDS, PREDICT

API = "/gradio_api"
FORM, FIELDS_OF_A_FORM = "multipart/form-data; boundary=x", {"content-type": "application/x-www-form-urlencoded"}
NO_COOKIE = {"cookie": 'pasdedeux_session=\x01; a="b'}
EVIL, OWN_PAGE, HTML = {"origin": "https://evil.example"}, {"origin": "{here}"}, {"accept": "text/html"}
STRANGER: dict[str, Any] = {"who": "stranger"}
SIGNED_OUT = STRANGER | {"at": "closed"}


@dataclass(frozen=True, kw_only=True)
class Attack:
    """One request.

    Attributes:
        name: of the test.
        who: "ada", "eve" or "stranger", who has neither an account nor a cookie.
        at: "closed" (with accounts), "open", or "both".
        method, path, headers: of the request.
        body: sent as JSON.
        content: sent as it is.
        expected: status codes of which the answer must have one.
        never: what the answer must not hold, in any letters' case; the server's secrets are always among it.
        holds: what the answer must hold.
    """

    name: str
    expected: tuple[int, ...]
    who: str = "eve"
    at: str = "both"
    method: str = "GET"
    path: str = "/"
    headers: dict[str, str] = field(default_factory=dict)
    body: Any = None
    content: bytes | None = None
    never: tuple[str, ...] = ()
    holds: str = ""


def asked(name: str, line: str, *expected: int, **more: Any) -> Attack:
    """A request by its method and path."""
    method, path = line.split(" ", 1)
    return Attack(name=name, method=method, path=path, expected=expected, **more)


def get(name: str, path: str, *expected: int, **more: Any) -> Attack:
    return asked(name, f"GET {path}", *expected, **more)


def post(name: str, path: str, *expected: int, **more: Any) -> Attack:
    return asked(name, f"POST {path}", *expected, **more)


def part(disposition: str, content: str = "HIERARCHY", kind: str = "application/octet-stream") -> bytes:
    """A form of one part."""
    head = f"--x\r\nContent-Disposition: form-data; {disposition}\r\nContent-Type: {kind}\r\n\r\n"
    return f"{head}{content}\r\n--x--\r\n".encode()


def upload(name: str, content: bytes, *expected: int, kind: str = FORM, path: str = "upload", **more: Any) -> Attack:
    return post(name, f"{API}/{path}", *expected, content=content, headers={"content-type": kind}, **more)


def call(name: str, data: Any, *expected: int, **more: Any) -> Attack:
    return post(name, f"{API}/call/generate", *expected, body={"data": data}, **more)


OWN, HERS = ({"session_hash": session, "fn_index": 1} for session in ("eves own", "{session}"))
HER_COMPONENT = {"session_hash": "{session}", "component_id": 1, "fn_name": "x", "data": []}
OTHER_FILE = {"path": "{upload}", "meta": {"_type": "gradio.FileData"}}

PATHS = [
    get(f"no file by {path}", path, 400, 403, 404)
    for path in f"""
        {API}/file=/etc/passwd {API}/file=../../etc/passwd {API}/file=%2e%2e/%2e%2e/etc/passwd {API}/file//etc/passwd
        {API}/file=/proc/self/environ {API}/file=https://example.invalid/x {API}/file=app.py {API}/file={{canary}}
        {API}/file={{data}}/history.db {API}/file={{data}}/scratch/uploads/../../../../canary.txt
        {API}/file={{folder}}/users {API}/proxy=https://example.invalid/ {API}/proxy=http://127.0.0.1:9/ /a%00b
        {API}/stream/x/1/2/playlist.m3u8 /static/../app.py /static/%2e%2e/%2e%2e/app.py /..%5c..%5cx
        /monitoring /monitoring/x /docs /openapi.json {API}/openapi.json {API}/deep_link {API}/dev/reload
        {API}/vibe-code/ {API}/runs {API}/run-history/records /svelte/../../../etc/passwd
        {API}/custom_component/1/client/component/../../../../etc/passwd {{here}}// {{here}}//config /static//x
    """.split()
]

OTHERS_THINGS = [
    get("another's upload by its path", f"{API}/file={{upload}}", 403, 404, never=("HIERARCHY",)),
    get("another's download by its path", f"{API}/file={{download}}", 403, 404),
    get("the folder of another's files", f"{API}/file={{folder_of_ada}}", 403, 404),
    call("another's upload as a prompt", [OTHER_FILE, *FIELDS[1:]], 400, 403),
    post("another's upload as a past", f"{API}/call/predict", 403, body={"data": [OTHER_FILE, *PREDICT]}),
    get("what another's call ends with", f"{API}/call/generate/{{call}}", 403, 404, never=("SECRET",)),
    get("another's session as a call", f"{API}/call/generate/{{session}}", 403, 404, never=("SECRET",)),
    get("another's call as a session", f"{API}/queue/data?session_hash={{call}}", 403, never=("SECRET",)),
    get("another's session", f"{API}/queue/data?session_hash={{session}}", 403, never=("SECRET",)),
    get("two sessions", f"{API}/queue/data?session_hash=x&session_hash={{session}}", 403, never=("SECRET",)),
    get("another's heartbeat", f"{API}/heartbeat/{{session}}", 403),
    get("a call that never was", f"{API}/call/generate/{'0' * 32}", 404),
    post("a run in another's session", f"{API}/queue/join", 403, body={**HERS, "data": FIELDS}),
    post("the end of another's session", f"{API}/cancel", 403, body={**HERS, "event_id": "x"}),
    post("the end of another's call", f"{API}/cancel", 403, 404, body={**OWN, "event_id": "{call}"}),
    post("another's component", f"{API}/component_server", 403, 404, body=HER_COMPONENT),
]

FORGED = [
    call("a prompt that is a list", [["x"], *FIELDS[1:]], 400),
    call("a prompt that is an object", [{"x": 1}, *FIELDS[1:]], 400),
    call("a prompt that is a number", [7, *FIELDS[1:]], 400),
    call("half a character", ["\ud800", *FIELDS[1:]], 400, holds="character"),
    call("half a character in a list", [*FIELDS[:7], ["\udfff"]], 400),
    call("too few values", FIELDS[:3], 400),
    call("too many values", [*FIELDS, 1], 400),
    call("a megabyte of empty lists", [[] for _ in range(400_000)], 413),
    call("no values", None, 400),
    call("no list", {"0": "x"}, 400),
    post("an empty batch", f"{API}/call/generate", 400, body={"data": FIELDS, "batched": True}),
    post("no such endpoint", f"{API}/call/nosuch", 404, body={"data": []}),
    post("a private endpoint", f"{API}/call/refresh", 404, body={"data": [None]}),
    post("the second kind of calls", f"{API}/call/v2/generate", 404, body={"prompt": "x"}),
    post("another function's values", f"{API}/call/render", 400, body={"data": ["/etc/passwd"], "fn_index": 6}),
    post("no such function", f"{API}/queue/join", 404, body={**OWN, "fn_index": 99_999, "data": []}),
    post("a function before the first", f"{API}/queue/join", 404, body={**OWN, "fn_index": -1, "data": []}),
    post("no such function by its name", f"{API}/run/nosuch", 404, body={"data": []}),
    post("a function by a text", f"{API}/run/predict", 404, body={"fn_index": "0", "data": []}),
    post("a function by a truth", f"{API}/queue/join", 404, body={**OWN, "fn_index": True, "data": []}),
    post("a session that is a number", f"{API}/queue/join", 400, body={"session_hash": 7, "data": []}),
    post("a session without a name", f"{API}/call/generate", 400, body={"session_hash": "", "data": FIELDS}),
    post("a session of a thousand letters", f"{API}/queue/join", 400, body={"session_hash": "x" * 1000}),
    post("an event that is a list", f"{API}/cancel", 400, body={**OWN, "event_id": []}),
    post("deep JSON", f"{API}/queue/join", 400, 413, content=b"[" * 200_000),
    post("JSON that is none", f"{API}/queue/join", 400, content=b"{"),
    upload("JSON in a form", part('name="fn_name"', "x"), 400, path="component_server"),
    post("a body of three megabytes", f"{API}/queue/join", 413, content=b" " * 3 * 2**20),
    get("an address of 5,000 letters", "/" + "a" * 5000, 414),
    get("sixty parameters", f"{API}/queue/data?" + "&".join(f"a{i}=1" for i in range(60)), 400, holds="many"),
    get("a cookie that is none", "/config", 401, headers=NO_COOKIE, **SIGNED_OUT),
    get("a cookie that is none", "/config", 200, headers=NO_COOKIE, **STRANGER, at="open", holds='"api_prefix"'),
]

FILES = 'name="files"; filename='
UPLOADS = [
    upload("an upload without a name", part(f'{FILES}""'), 200),
    upload("an upload named by dots", part(f'{FILES}".."'), 400),
    upload("an upload named by signs", part(f'{FILES}"???"'), 200, 400),
    upload("an upload that is a text", part('name="files"'), 400),
    upload("an upload of another name", part('name="file"; filename="a.bvh"'), 200),
    upload("an upload without a part", b"--x--\r\n", 200),
    upload("an upload that is cut short", part(f'{FILES}"a.bvh"')[:-6], 200),
    upload("an upload that is no form", b"HIERARCHY", 400, kind="text/plain"),
    upload("an upload without a boundary", b"HIERARCHY", 400, kind="multipart/form-data"),
    upload("an upload in another alphabet", part(f'{FILES}"\\ud800.bvh"'), 400, kind=f"{FORM}; charset=unicode_escape"),
    upload("an upload with a long head", part(f'{FILES}"{"a" * 20_000}.bvh"'), 400),
    upload("many files", part(f'{FILES}"a.bvh"')[:-7].rstrip(b"-") * 20, 400),
    upload("an upload with a path", part(f'{FILES}"../../../evil.bvh"'), 200, never=("..",)),
    upload("a page as an upload", part(f'{FILES}"a.html"', "<script>alert(1)</script>"), 200),
]

DELETE = b"act=delete&name=ada&confirm=ada"
ADMIN = [
    get("the administrators' page", "/admin", 403, at="closed", holds="administrators"),
    post("an act of administrators", "/admin", 403, at="closed", headers=OWN_PAGE, content=DELETE),
    post("an act of administrators by a program", "/admin", 403, at="closed", content=DELETE),
]

ELSEWHERE = {"x-forwarded-host": "evil.example", "x-gradio-server": "http://evil.example"}
SIGN_IN = b"username=ada&password=x"
OTHER_SITES = [
    post(
        f"another site's page, {name}",
        f"{API}/queue/join",
        403,
        headers=headers,
        body={**OWN, "data": FIELDS},
        holds="Another site's page",
    )
    for name, headers in {
        "by its origin": EVIL,
        "without an origin": {"origin": "null"},
        "by what the browser says": {"sec-fetch-site": "cross-site"},
        "on another port": {"origin": "http://127.0.0.1:9"},
        "by a longer name": {"origin": "http://127.0.0.1.evil.example"},
    }.items()
] + [
    post("another site signs somebody in", "/login", 403, **SIGNED_OUT, headers=EVIL, content=SIGN_IN),
    get("another site reads", "/config", 200, headers={"origin": "http://localhost:3000"}),
    asked(
        "another site asks first",
        f"OPTIONS {API}/queue/join",
        400,
        403,
        405,
        headers={"origin": "http://localhost:3000", "access-control-request-method": "POST"},
    ),
    get("another host's name", "/", 421, at="closed", headers={"host": "evil.example"}),
    get("a host that is no address", "/", 400, headers={"host": "["}, holds="not an address"),
    post("an origin that is none", f"{API}/queue/join", 400, headers={"origin": "http://["}, body={}, holds="address"),
    *(
        get(f"where {path} is, by a header", path, 200, headers=ELSEWHERE, never=("evil.example",))
        for path in ("/", "/config")
    ),
    get("signing out by a link", "/logout", 405, at="closed", who="ada"),
    get("still signed in", "/config", 200, at="closed", who="ada"),
]

FIGURES_NEVER, FORWARDED = ("password", "pasdedeux_session", "SECRET"), {"x-forwarded-for": "198.51.100.7"}
STRANGERS = [
    *(
        get(f"a stranger at {path}", path, 401, **SIGNED_OUT)
        for path in f"""
            /config {API}/info /theme.css {API}/queue/data?session_hash=x {API}/file={{upload}}
            {API}/call/generate/{{call}} {API}/startup-events
        """.split()
    ),
    *(
        post(f"a stranger sends to {API}/{path}", f"{API}/{path}", 401, **SIGNED_OUT, body={"data": FIELDS})
        for path in ("queue/join", "upload", "call/generate", "cancel", "reset")
    ),
    *(
        get(name, "/config", 401, **SIGNED_OUT, headers={"cookie": f"pasdedeux_session={session}"})
        for name, session in {"a made-up session": "A" * 43, "a name as a session": "user ada"}.items()
    ),
    get("the figures from this machine", "/metrics", 200, **STRANGER, holds="pasdedeux_", never=FIGURES_NEVER),
    get("the figures from another machine", "/metrics", 403, **STRANGER, headers=FORWARDED, never=("pasdedeux_",)),
]

SCRIPT = "<script>window.hacked=1</script>"
SCRIPTS = [
    get("a script in the sign-in page", f"/login?next=%22%3E{SCRIPT}", 200, **SIGNED_OUT, never=(SCRIPT,)),
    post(
        "a script as a name",
        "/login",
        401,
        **SIGNED_OUT,
        never=(SCRIPT,),
        headers=HTML | FIELDS_OF_A_FORM,
        content=f"username={SCRIPT}&password=x".encode(),
    ),
    get("a script in a path", f"/{SCRIPT}", 404, headers=HTML, never=(SCRIPT,)),
    get("a script in a run's key", f"/?run={SCRIPT}", 200, headers=HTML, never=(SCRIPT,)),
]

VOTE, NEXT = "/study/{study_key}/vote/0/1", "/study/{study_key}/next"
PAIR_NEVER = ("SECRET", "manifest", "damped")
STUDIES = [
    get("what is compared in a study", "/study/{study_key}", 200, holds="Which is longer?", never=("SECRET",)),
    get("a study by its id", "/study/{study}", 404, holds="no such study"),
    get("a study by another's run", "/study/{run}", 404, holds="no such study"),
    get("a script in a study's key", f"/study/{SCRIPT}", 404, headers=HTML, never=(SCRIPT,)),
    get("a step out of a study", "/study/..%2f..%2fapp.py", 404),
    get("the motions of studies", f"{API}/file={{data}}/studies/{{study}}/0.npz", 403, 404, never=("PK",)),
    post("what is compared in a pair", NEXT, 200, headers=OWN_PAGE, holds='"number"', never=PAIR_NEVER),
    post("a vote by a program", VOTE, 403, holds="own page"),
    post("a pair for a program", NEXT, 403, holds="own page"),
    post("a vote from another site", VOTE, 403, holds="Another site", headers={"origin": "https://example.invalid"}),
    post("a vote by a stranger", VOTE, 401, **SIGNED_OUT, headers=OWN_PAGE),
    post("a vote without a cookie", VOTE, 403, **STRANGER, at="open", headers=OWN_PAGE, holds="cookie"),
    *(
        post(f"a vote that is {vote}", f"/study/{{study_key}}/vote/{vote}", 404, 422, headers=OWN_PAGE)
        for vote in ("x/1", "0/x", "-1/1", "9/1", "1e99/1", "0/..%2f..", "0/1/1")
    ),
]

OUTSIDE = "share/page.html ../app.py player/../../app.py %2e%2e/app.py /etc/passwd {upload} {canary} player"
PUBLIC_NEVER = ("user ada", "local", "manifest", "{run}", "{data}")
PUBLIC_PAGES = [
    *(
        get(f"a public page, at {path}", f"{path}/{{public}}", 200, **STRANGER, holds="SECRET", never=PUBLIC_NEVER)
        for path in ("/share", "/embed")
    ),
    *(
        get(f"a public page by {name}", f"/{kind}/{{{name}}}", 404, **STRANGER, never=("SECRET",))
        for kind in ("share", "embed")
        for name in ("run", "study", "study_key", "session")
    ),
    get("a script in a public page's key", f"/share/{SCRIPT}", 404, **STRANGER, never=(SCRIPT,), headers=HTML),
    post("a change of a public page", "/share/{public}", 401, 404, 405, **STRANGER, body={}),
    get("a file of public pages", "/shown/player/main.js", 200, **STRANGER, holds="export"),
    *(
        get(f"no file of public pages at {path}", f"/shown/{path}", 401, 404, **STRANGER)
        for path in (*OUTSIDE.split(), "")
    ),
    get("a name by a header of no setting's", "/config", 401, **SIGNED_OUT, headers={"x-remote-user": "ada"}),
]

CLOSED = {
    "GET": f"""
        {API}/custom_component/1/client/component/x.js {API}/runs/ {API}/stream/{{session}}/1/1/playlist-file
        {API}/vibe-code {API}/call/v2/generate/{{call}} /assets/../../app.py /pwa_icon /pwa_icon/7 /monitoring/summary
    """,
    "HEAD": f"/openapi.json {API}/proxy=http://127.0.0.1:9/",
    "POST": f"""
        {API}/process_recording {API}/stream/{{call}} {API}/stream/{{call}}/close {API}/vibe-edit {API}/vibe-edit/
        {API}/undo-vibe-edit {API}/undo-vibe-edit/ {API}/vibe-code {API}/vibe-code/ {API}/vibe-starter-queries
        {API}/vibe-starter-queries/ {API}/call/v2/generate/
    """,
}
OTHER_ROUTES = [
    *(
        get(f"nothing of hers in {path}", path, 200, never=("SECRET", "{data}", "password"))
        for path in f"""
            /config/ {API}/app_id {API}/app_id/ {API}/info/ {API}/login_check {API}/queue/status /manifest.json
            /robots.txt /favicon.ico /healthz {API}/theme.css {API}/user {API}/user/ {API}/login_check/ {API}/token
            {API}/token/
        """.split()
    ),
    *(
        asked(f"closed: {method} {path}", f"{method} {path}", 404)
        for method, paths in CLOSED.items()
        for path in paths.split()
    ),
    asked("the length of another's upload", f"HEAD {API}/file={{upload}}", 403, 404),
    asked("the page's head", "HEAD /", 200),
    get("the progress of an upload that never was", f"{API}/upload_progress?upload_id={'x' * 3000}", 404),
    *(
        post(f"another's upload, at {path}", f"{API}/{path}", 400, 403, body={"data": [OTHER_FILE, *FIELDS[1:]]})
        for path in ("call/generate/", "api/generate", "api/generate/", "run/generate/")
    ),
    post("another's component, with a slash", f"{API}/component_server/", 403, 404, body=HER_COMPONENT),
    post("the end of another's call, with a slash", f"{API}/reset/", 403, 404, body={**OWN, "event_id": "{call}"}),
    post("a sign-in where nobody is known", "/login/", 302, **SIGNED_OUT, headers=FIELDS_OF_A_FORM, content=SIGN_IN),
    post("another site signs somebody out", "/logout", 403, at="closed", who="ada", headers=EVIL),
]

LIVE = [
    *(
        post(f"a live stream with {fields!r:.60}", "/live", 422, body=fields, never=("Traceback",))
        for fields in (
            {},
            [],
            {"partner": "nobody"},
            {"partner": ["agent"]},
            {"partner": "agent", "seed": 2**32},
            {"partner": "agent", "seed": True},
        )
    ),
    post("a live stream of half a megabyte", "/live", 422, content=b"[" * 2**19),
    post("a live stream from another site", "/live", 403, headers=EVIL, body={"partner": "agent"}),
    post("a live stream of a stranger", "/live", 401, **SIGNED_OUT, body={"partner": "agent"}),
    post("a message to a stream that never was", "/live/x", 404, body={}),
    post("a message to another's run as a stream", "/live/{run}", 404, body={}),
    asked("the end of a stream that never was", "DELETE /live/x", 404),
    asked("the end of a stream by another site", "DELETE /live/x", 403, headers=EVIL),
]

_FIRST = [*ADMIN, *OTHER_ROUTES, *LIVE, *PATHS, *OTHERS_THINGS, *FORGED, *UPLOADS, *OTHER_SITES, *STRANGERS]
KNOWN = [*_FIRST, *SCRIPTS, *STUDIES, *PUBLIC_PAGES]
