"""Attacks as data: who sends what to which server, and what may come back.

``{name}`` in a path, header or value stands for one of the victim's things, see :class:`.victim.Victim`: ada's
upload, download, call, session, run and study, and places on the server's disk.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from ..clients import FIELDS, PREDICT

API = "/gradio_api"
FORM = "multipart/form-data; boundary=x"
NO_COOKIE = {"cookie": 'pasdedeux_session=\x01; a="b'}


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


def get(name: str, path: str, *expected: int, **more: Any) -> Attack:
    return Attack(name=name, path=path, expected=expected, **more)


def post(name: str, path: str, *expected: int, **more: Any) -> Attack:
    return Attack(name=name, path=path, method="POST", expected=expected, **more)


def part(disposition: str, content: str = "HIERARCHY", kind: str = "application/octet-stream") -> bytes:
    """A form of one part."""
    head = f"--x\r\nContent-Disposition: form-data; {disposition}\r\nContent-Type: {kind}\r\n\r\n"
    return f"{head}{content}\r\n--x--\r\n".encode()


def upload(name: str, content: bytes, *expected: int, kind: str = FORM, **more: Any) -> Attack:
    return post(name, f"{API}/upload", *expected, content=content, headers={"content-type": kind}, **more)


def call(name: str, data: Any, *expected: int, **more: Any) -> Attack:
    return post(name, f"{API}/call/generate", *expected, body={"data": data}, **more)


OWN = {"session_hash": "eves own", "fn_index": 1}
OTHER_FILE = {"path": "{upload}", "meta": {"_type": "gradio.FileData"}}

PATHS = [
    get(f"no file by {path}", path, 400, 403, 404)
    for path in (
        f"{API}/file=/etc/passwd",
        f"{API}/file=../../etc/passwd",
        f"{API}/file=%2e%2e/%2e%2e/etc/passwd",
        f"{API}/file=/proc/self/environ",
        f"{API}/file=https://example.invalid/x",
        f"{API}/file=app.py",
        f"{API}/file={{data}}/history.db",
        f"{API}/file={{folder}}/users",
        f"{API}/file={{canary}}",
        f"{API}/file={{data}}/scratch/uploads/../../../../canary.txt",
        f"{API}/file//etc/passwd",
        f"{API}/proxy=https://example.invalid/",
        f"{API}/proxy=http://127.0.0.1:9/",
        "/a%00b",
        f"{API}/stream/x/1/2/playlist.m3u8",
        "/static/../app.py",
        "/static/%2e%2e/%2e%2e/app.py",
        "/..%5c..%5cx",
        "/monitoring",
        "/docs",
        "/openapi.json",
        f"{API}/openapi.json",
        f"{API}/deep_link",
        f"{API}/dev/reload",
        f"{API}/vibe-code/",
        f"{API}/runs",
        f"{API}/run-history/records",
        "/monitoring/x",
        "/svelte/../../../etc/passwd",
        f"{API}/custom_component/1/client/component/../../../../etc/passwd",
    )
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
    post(
        "a run in another's session",
        f"{API}/queue/join",
        403,
        body={"session_hash": "{session}", "fn_index": 1, "data": FIELDS},
    ),
    post(
        "the end of another's session",
        f"{API}/cancel",
        403,
        body={"session_hash": "{session}", "fn_index": 1, "event_id": "x"},
    ),
    post("the end of another's call", f"{API}/cancel", 403, 404, body={**OWN, "event_id": "{call}"}),
    post(
        "another's component",
        f"{API}/component_server",
        403,
        404,
        body={"session_hash": "{session}", "component_id": 1, "fn_name": "x", "data": []},
    ),
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
    post("a function by a text", f"{API}/run/predict", 404, body={"fn_index": "0", "data": []}),
    post("a function by a truth", f"{API}/queue/join", 404, body={**OWN, "fn_index": True, "data": []}),
    post("a session that is a number", f"{API}/queue/join", 400, body={"session_hash": 7, "data": []}),
    post("a session without a name", f"{API}/call/generate", 400, body={"session_hash": "", "data": FIELDS}),
    post("a session of a thousand letters", f"{API}/queue/join", 400, body={"session_hash": "x" * 1000}),
    post("an event that is a list", f"{API}/cancel", 400, body={**OWN, "event_id": []}),
    post("deep JSON", f"{API}/queue/join", 400, 413, content=b"[" * 200_000),
    post("JSON that is none", f"{API}/queue/join", 400, content=b"{"),
    post(
        "JSON in a form",
        f"{API}/component_server",
        400,
        content=part('name="fn_name"', "x"),
        headers={"content-type": FORM},
    ),
    post("a body of three megabytes", f"{API}/queue/join", 413, content=b" " * 3 * 2**20),
    get("an address of 5,000 letters", "/" + "a" * 5000, 414),
    get("sixty parameters", f"{API}/queue/data?" + "&".join(f"a{i}=1" for i in range(60)), 400, holds="many"),
    get("a cookie that is none", "/config", 401, headers=NO_COOKIE, who="stranger", at="closed"),
    get("a cookie that is none", "/config", 200, headers=NO_COOKIE, who="stranger", at="open", holds='"api_prefix"'),
]

UPLOADS = [
    upload("an upload without a name", part('name="files"; filename=""'), 200),
    upload("an upload named by dots", part('name="files"; filename=".."'), 400),
    upload("an upload named by signs", part('name="files"; filename="???"'), 200, 400),
    upload("an upload that is a text", part('name="files"'), 400),
    upload("an upload of another name", part('name="file"; filename="a.bvh"'), 200),
    upload("an upload without a part", b"--x--\r\n", 200),
    upload("an upload that is cut short", part('name="files"; filename="a.bvh"')[:-6], 200),
    upload("an upload that is no form", b"HIERARCHY", 400, kind="text/plain"),
    upload("an upload without a boundary", b"HIERARCHY", 400, kind="multipart/form-data"),
    upload(
        "an upload in another alphabet",
        part('name="files"; filename="\\ud800.bvh"'),
        400,
        kind=FORM + "; charset=unicode_escape",
    ),
    upload("an upload with a long head", part(f'name="files"; filename="{"a" * 20_000}.bvh"'), 400),
    upload("many files", part('name="files"; filename="a.bvh"')[:-7].rstrip(b"-") * 20, 400),
    upload("an upload with a path", part('name="files"; filename="../../../evil.bvh"'), 200, never=("..",)),
    upload("a page as an upload", part('name="files"; filename="a.html"', "<script>alert(1)</script>"), 200),
]

ADMIN = [
    get("the administrators' page", "/admin", 403, at="closed", holds="administrators"),
    post(
        "an act of administrators",
        "/admin",
        403,
        at="closed",
        headers={"origin": "{here}"},
        content=b"act=delete&name=ada&confirm=ada",
    ),
    post("an act of administrators by a program", "/admin", 403, at="closed", content=b"act=delete&name=ada"),
]

OTHER_SITES = [
    post(f"another site's page, {name}", f"{API}/queue/join", 403, headers=headers, body={**OWN, "data": FIELDS})
    for name, headers in {
        "by its origin": {"origin": "https://evil.example"},
        "without an origin": {"origin": "null"},
        "by what the browser says": {"sec-fetch-site": "cross-site"},
        "on another port": {"origin": "http://127.0.0.1:9"},
        "by a longer name": {"origin": "http://127.0.0.1.evil.example"},
    }.items()
] + [
    post(
        "another site signs somebody in",
        "/login",
        403,
        at="closed",
        who="stranger",
        headers={"origin": "https://evil.example"},
        content=b"username=ada&password=x",
    ),
    get("another site reads", "/config", 200, headers={"origin": "http://localhost:3000"}),
    Attack(
        name="another site asks first",
        method="OPTIONS",
        path=f"{API}/queue/join",
        expected=(400, 403, 405),
        headers={"origin": "http://localhost:3000", "access-control-request-method": "POST"},
    ),
    get("another host's name", "/", 421, at="closed", headers={"host": "evil.example"}),
    get("a host that is no address", "/", 400, headers={"host": "["}),
    get(
        "where the page is, by a header",
        "/",
        200,
        headers={"x-forwarded-host": "evil.example", "x-gradio-server": "http://evil.example"},
        never=("evil.example",),
    ),
    get("signing out by a link", "/logout", 405, at="closed", who="ada"),
    get("still signed in", "/config", 200, at="closed", who="ada"),
]

STRANGERS = (
    [
        get(f"a stranger at {path}", path, 401, at="closed", who="stranger")
        for path in (
            "/config",
            f"{API}/info",
            "/theme.css",
            f"{API}/queue/data?session_hash=x",
            f"{API}/file={{upload}}",
            f"{API}/call/generate/{{call}}",
            f"{API}/startup-events",
        )
    ]
    + [
        post(f"a stranger sends to {path}", path, 401, at="closed", who="stranger", body={"data": FIELDS})
        for path in (f"{API}/queue/join", f"{API}/upload", f"{API}/call/generate", f"{API}/cancel", f"{API}/reset")
    ]
    + [
        get(
            "a made-up session",
            "/config",
            401,
            at="closed",
            who="stranger",
            headers={"cookie": "pasdedeux_session=" + "A" * 43},
        ),
        get(
            "a name as a session",
            "/config",
            401,
            at="closed",
            who="stranger",
            headers={"cookie": "pasdedeux_session=user ada"},
        ),
        get(
            "the figures from this machine",
            "/metrics",
            200,
            who="stranger",
            holds="pasdedeux_",
            never=("password", "pasdedeux_session", "SECRET"),
        ),
        get(
            "the figures from another machine",
            "/metrics",
            403,
            who="stranger",
            headers={"x-forwarded-for": "198.51.100.7"},
            never=("pasdedeux_",),
        ),
    ]
)

SCRIPT = "<script>window.hacked=1</script>"
SCRIPTS = [
    get(
        "a script in the sign-in page", f"/login?next=%22%3E{SCRIPT}", 200, at="closed", who="stranger", never=(SCRIPT,)
    ),
    post(
        "a script as a name",
        "/login",
        401,
        at="closed",
        who="stranger",
        never=(SCRIPT,),
        headers={"accept": "text/html", "content-type": "application/x-www-form-urlencoded"},
        content=f"username={SCRIPT}&password=x".encode(),
    ),
    get("a script in a path", f"/{SCRIPT}", 404, headers={"accept": "text/html"}, never=(SCRIPT,)),
    get("a script in a run's key", f"/?run={SCRIPT}", 200, headers={"accept": "text/html"}, never=(SCRIPT,)),
]

OWN_PAGE = {"origin": "{here}"}
VOTE = "/study/{study_key}/vote/0/1"
STUDIES = [
    get("what is compared in a study", "/study/{study_key}", 200, holds="Which is longer?", never=("SECRET",)),
    get("a study by its id", "/study/{study}", 404, holds="no such study"),
    get("a study by another's run", "/study/{run}", 404, holds="no such study"),
    get("a script in a study's key", f"/study/{SCRIPT}", 404, headers={"accept": "text/html"}, never=(SCRIPT,)),
    get("a step out of a study", "/study/..%2f..%2fapp.py", 404),
    get("the motions of studies", f"{API}/file={{data}}/studies/{{study}}/0.npz", 403, 404, never=("PK",)),
    post(
        "what is compared in a pair",
        "/study/{study_key}/next",
        200,
        headers=OWN_PAGE,
        holds='"number"',
        never=("SECRET", "manifest", "damped"),
    ),
    post("a vote by a program", VOTE, 403, holds="own page"),
    post("a pair for a program", "/study/{study_key}/next", 403, holds="own page"),
    post("a vote from another site", VOTE, 403, holds="Another site", headers={"origin": "https://example.invalid"}),
    post("a vote by a stranger", VOTE, 401, who="stranger", at="closed", headers=OWN_PAGE),
    post("a vote without a cookie", VOTE, 403, who="stranger", at="open", headers=OWN_PAGE, holds="cookie"),
    *(
        post(f"a vote that is {vote}", f"/study/{{study_key}}/vote/{vote}", 404, 422, headers=OWN_PAGE)
        for vote in ("x/1", "0/x", "-1/1", "9/1", "1e99/1", "0/..%2f..", "0/1/1")
    ),
]

PUBLIC_PAGES = [
    get(
        "a public page",
        "/share/{public}",
        200,
        who="stranger",
        holds="SECRET",
        never=("user ada", "local", "manifest", "{run}", "{data}"),
    ),
    get("its player alone", "/embed/{public}", 200, who="stranger", holds="SECRET", never=("user ada", "{run}")),
    *(
        get(f"a public page by {name}", f"/{kind}/{{{name}}}", 404, who="stranger", never=("SECRET",))
        for kind in ("share", "embed")
        for name in ("run", "study", "study_key", "session")
    ),
    get(
        "a script in a public page's key",
        f"/share/{SCRIPT}",
        404,
        who="stranger",
        never=(SCRIPT,),
        headers={"accept": "text/html"},
    ),
    post("a change of a public page", "/share/{public}", 401, 404, 405, who="stranger", body={}),
    get("a file of public pages", "/shown/player/main.js", 200, who="stranger", holds="export"),
    *(
        get(f"no file of public pages at {path}", f"/shown/{path}", 401, 404, who="stranger")
        for path in (
            "share/page.html",
            "../app.py",
            "player/../../app.py",
            "%2e%2e/app.py",
            "/etc/passwd",
            "{upload}",
            "{canary}",
            "player",
            "",
        )
    ),
]

BY_HEADER = [
    get(
        "a name by a header that the settings do not name",
        "/config",
        401,
        at="closed",
        who="stranger",
        headers={"x-remote-user": "ada"},
    )
]

OTHER_ROUTES = [
    *(
        get(f"nothing of hers in {path}", path, 200, never=("SECRET", "{data}", "password"))
        for path in (
            "/config/",
            f"{API}/app_id",
            f"{API}/app_id/",
            f"{API}/info/",
            f"{API}/login_check",
            f"{API}/queue/status",
            "/manifest.json",
            "/robots.txt",
            "/favicon.ico",
            "/healthz",
            f"{API}/theme.css",
            f"{API}/user",
            f"{API}/user/",
            f"{API}/login_check/",
            f"{API}/token",
            f"{API}/token/",
        )
    ),
    *(
        Attack(name=f"closed: {method} {path}", method=method, path=path, expected=(404,))
        for method, path in (
            ("GET", f"{API}/custom_component/1/client/component/x.js"),
            ("GET", f"{API}/runs/"),
            ("GET", f"{API}/stream/{{session}}/1/1/playlist-file"),
            ("GET", f"{API}/vibe-code"),
            ("GET", f"{API}/call/v2/generate/{{call}}"),
            ("GET", "/assets/../../app.py"),
            ("GET", "/pwa_icon"),
            ("GET", "/pwa_icon/7"),
            ("GET", "/monitoring/summary"),
            ("HEAD", "/openapi.json"),
            ("HEAD", f"{API}/proxy=http://127.0.0.1:9/"),
            ("POST", f"{API}/process_recording"),
            ("POST", f"{API}/stream/{{call}}"),
            ("POST", f"{API}/stream/{{call}}/close"),
            ("POST", f"{API}/vibe-edit"),
            ("POST", f"{API}/vibe-edit/"),
            ("POST", f"{API}/undo-vibe-edit"),
            ("POST", f"{API}/undo-vibe-edit/"),
            ("POST", f"{API}/vibe-code"),
            ("POST", f"{API}/vibe-code/"),
            ("POST", f"{API}/vibe-starter-queries"),
            ("POST", f"{API}/vibe-starter-queries/"),
            ("POST", f"{API}/call/v2/generate/"),
        )
    ),
    Attack(name="the length of another's upload", method="HEAD", path=f"{API}/file={{upload}}", expected=(403, 404)),
    Attack(name="the page's head", method="HEAD", path="/", expected=(200,)),
    get("the progress of an upload that never was", f"{API}/upload_progress?upload_id={'x' * 3000}", 404),
    *(
        post(f"another's upload, at {path}", f"{API}/{path}", 400, 403, body={"data": [OTHER_FILE, *FIELDS[1:]]})
        for path in ("call/generate/", "api/generate", "api/generate/", "run/generate/")
    ),
    post(
        "another's component, with a slash",
        f"{API}/component_server/",
        403,
        404,
        body={"session_hash": "{session}", "component_id": 1, "fn_name": "x", "data": []},
    ),
    post("the end of another's call, with a slash", f"{API}/reset/", 403, 404, body={**OWN, "event_id": "{call}"}),
    post(
        "a sign-in at Gradio's own address, which knows nobody",
        "/login/",
        302,
        at="closed",
        who="stranger",
        headers={"content-type": "application/x-www-form-urlencoded"},
        content=b"username=ada&password=x",
    ),
    post(
        "another site signs somebody out",
        "/logout",
        403,
        at="closed",
        who="ada",
        headers={"origin": "https://evil.example"},
    ),
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
    post(
        "a live stream from another site",
        "/live",
        403,
        headers={"origin": "https://evil.example"},
        body={"partner": "agent"},
    ),
    post("a live stream of a stranger", "/live", 401, at="closed", who="stranger", body={"partner": "agent"}),
    post("a message to a stream that never was", "/live/x", 404, body={}),
    post("a message to another's run as a stream", "/live/{run}", 404, body={}),
    Attack(name="the end of a stream that never was", method="DELETE", path="/live/x", expected=(404,)),
    Attack(
        name="the end of a stream by another site",
        method="DELETE",
        path="/live/x",
        expected=(403,),
        headers={"origin": "https://evil.example"},
    ),
]

KNOWN = [
    *ADMIN,
    *OTHER_ROUTES,
    *LIVE,
    *PATHS,
    *OTHERS_THINGS,
    *FORGED,
    *UPLOADS,
    *OTHER_SITES,
    *STRANGERS,
    *SCRIPTS,
    *STUDIES,
    *PUBLIC_PAGES,
    *BY_HEADER,
]
