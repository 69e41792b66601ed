"""Signing in by OpenID Connect: the code flow with PKCE, by Authlib.

What a sign-in under way needs (state, nonce, PKCE's verifier, the page that was wanted) is in a cookie of the browser
that began it, so any process can end it, and another browser cannot.
"""

from __future__ import annotations

import base64
import hmac
import json
import secrets
import threading
import time
from typing import Any
from urllib.parse import urlsplit

import httpx
from authlib.common.errors import AuthlibBaseError
from authlib.integrations.httpx_client import OAuth2Client
from fastapi import APIRouter, Request
from joserfc import jwt
from joserfc.errors import JoseError
from joserfc.jwk import KeySet
from starlette.responses import RedirectResponse, Response

from motion import InputError
from webdemo.server.audit import audit
from webdemo.server.http.cookies import set_cookie
from webdemo.server.http.refused import Refused
from webdemo.server.settings import Settings
from webdemo.ui.visitor import visitor_of

from .proxy import NAME
from .users import SignIns, Suspended
from .visitors import SESSION_COOKIE

COOKIE = "pasdedeux_openid"
LASTS = 600
"""Seconds that a sign-in may take at the provider."""
KEPT = 3600.0
"""Seconds for which the provider's addresses and keys are kept."""
ALGORITHMS = ["RS256", "RS384", "RS512", "PS256", "ES256", "ES384", "EdDSA"]
"""Signatures by a key pair alone: "none", and a secret that others know, sign nothing."""
_SECONDS = 10.0
_AWAY = (
    "The sign-in service does not answer as it should: try again, or tell the person who runs this server."
)
_BEGIN = (
    "This sign-in is not one that this browser began, or it took too long: begin again at the sign-in page."
)
_NOT_ALLOWED = "You belong to none of the groups that may use this lab: ask the person who runs it."
_NO_NAME = "The sign-in service gives no name that can be used here: tell the person who runs this server."
_TAKEN = "An account of this lab has your name and a password: sign in by that, or ask for another name."


class Provider:
    """The sign-in service that the settings name; its addresses and keys are read when they are first needed."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self._lock = threading.Lock()
        self._read = (0.0, {}, {})  # type: tuple[float, dict[str, Any], dict[str, Any]]

    def begin(self, back: str) -> tuple[str, dict[str, str]]:
        """The address at which a person signs in, and what the browser must bring back."""
        kept = {name: secrets.token_urlsafe(32) for name in ("state", "nonce", "verifier")}
        known, _ = self._known()
        with self._client(back) as client:
            address, _ = client.create_authorization_url(
                known["authorization_endpoint"], state=kept["state"], nonce=kept["nonce"],
                code_verifier=kept["verifier"],
            )  # fmt: skip
        return address, kept

    def claims(self, back: str, code: str, kept: dict[str, str]) -> dict[str, Any]:
        """The claims about the person whose code it is, checked by the signature.

        Raises:
            Refused: if the code or the token is not good.
        """
        known, keys = self._known()
        try:
            with self._client(back) as client:
                token = client.fetch_token(
                    known["token_endpoint"],
                    code=code,
                    code_verifier=kept["verifier"],
                    grant_type="authorization_code",
                )
            found = jwt.decode(token["id_token"], KeySet.import_key_set(keys), algorithms=ALGORITHMS)  # type: ignore[arg-type]
            jwt.JWTClaimsRegistry(
                iss={"essential": True, "value": known["issuer"]},
                aud={"essential": True, "value": self.settings.openid_client},
                exp={"essential": True}, nonce={"essential": True, "value": kept["nonce"]},
            ).validate(found.claims)  # fmt: skip
        except (AuthlibBaseError, JoseError, httpx.HTTPError, KeyError, TypeError, ValueError):
            raise Refused(403, _AWAY, "openid") from None
        return dict(found.claims)

    def _client(self, back: str) -> OAuth2Client:
        return OAuth2Client(
            self.settings.openid_client, self.settings.openid_secret, scope=self.settings.openid_scope,
            redirect_uri=back, code_challenge_method="S256", timeout=_SECONDS,
        )  # fmt: skip

    def _known(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """The provider's addresses and its keys."""
        with self._lock:
            until, known, keys = self._read
            if time.monotonic() < until:
                return known, keys
            issuer = self.settings.openid_issuer.rstrip("/")
            try:
                known = (
                    httpx.get(f"{issuer}/.well-known/openid-configuration", timeout=_SECONDS)
                    .raise_for_status()
                    .json()
                )
                keys = httpx.get(known["jwks_uri"], timeout=_SECONDS).raise_for_status().json()
                if known["issuer"].rstrip("/") != issuer or not known["token_endpoint"]:
                    raise ValueError
                _ = known["authorization_endpoint"]
            except (httpx.HTTPError, ValueError, KeyError, TypeError, AttributeError):
                raise Refused(503, _AWAY, "openid") from None
            self._read = (time.monotonic() + KEPT, known, keys)
            return known, keys


def openid_routes(settings: Settings, sign_ins: SignIns) -> APIRouter:
    """``/login/openid``, which sends a person to the provider, and ``/login/openid/back``, to which they return."""
    router, provider, root = APIRouter(), Provider(settings), settings.root_path

    def keep(response: Response, request: Request, cookie: str, value: str, seconds: float) -> None:
        set_cookie(response, cookie, value, seconds=seconds, root=root, secure=request.url.scheme == "https")

    @router.get("/login/openid")
    def begin(request: Request, next: str = "/") -> Response:
        address, kept = provider.begin(_back(request))
        response = RedirectResponse(address, status_code=303)
        packed = base64.urlsafe_b64encode(json.dumps(kept | {"next": _local(next)}).encode()).decode()
        keep(response, request, COOKIE, packed, LASTS)
        return response

    @router.get("/login/openid/back")
    def back(request: Request, state: str = "", code: str = "") -> Response:
        kept = _kept(request.cookies.get(COOKIE, ""))
        if not code or not kept or not hmac.compare_digest(kept["state"].encode(), state.encode()):
            audit("sign-in", ok=False, person="(unknown)", how="openid", reason="not begun here")
            raise Refused(403, _BEGIN, "openid")
        name = ""
        try:
            claims = provider.claims(_back(request), code, kept)
            name = _person(settings, sign_ins, claims)
            token = _begun(settings, sign_ins, name, claims)
        except Refused as refused:
            audit("sign-in", ok=False, person=name or "(unknown)", how="openid", reason=str(refused))
            raise
        audit("sign-in", person=name, how="openid")
        response = RedirectResponse(f"{root}{_local(kept['next'])}", status_code=303)
        keep(response, request, SESSION_COOKIE, token, sign_ins.seconds)
        keep(response, request, COOKIE, "", 0)
        return response

    return router


def _person(settings: Settings, sign_ins: SignIns, claims: dict[str, Any]) -> str:
    """The account's name; raises Refused for one that cannot be used here."""
    if settings.groups and not set(settings.groups) & _groups(claims):
        raise Refused(403, _NOT_ALLOWED, "openid")
    name = str(claims.get(settings.openid_name) or "").lower()
    if not NAME.match(name) or (settings.openid_name == "email" and claims.get("email_verified") is not True):
        raise Refused(403, _NO_NAME, "openid")
    try:
        taken = sign_ins.users.entry(name) is not None
    except InputError as error:
        raise Refused(503, str(error), "accounts") from None
    if taken:
        raise Refused(403, _TAKEN, "openid")
    return name


def _begun(settings: Settings, sign_ins: SignIns, name: str, claims: dict[str, Any]) -> str:
    """A new session's token; raises Refused for a suspended person."""
    admin = bool(set(settings.admin_groups) & _groups(claims)) if settings.admin_groups else None
    try:
        return sign_ins.begin_outside(name, admin=admin)
    except Suspended as error:
        raise Refused(403, str(error), "suspended") from None


def _groups(claims: dict[str, Any]) -> set[str]:
    groups = claims.get("groups")
    return {group for group in groups if isinstance(group, str)} if isinstance(groups, list) else set()


def _back(request: Request) -> str:
    return f"{visitor_of(request).base}login/openid/back"


def _kept(cookie: str) -> dict[str, str]:
    """The cookie of a sign-in under way, unpacked; empty for anything else."""
    try:
        found = json.loads(base64.urlsafe_b64decode(cookie[:4000]))
    except ValueError:
        return {}
    names = {"state", "nonce", "verifier", "next"}
    whole = (
        isinstance(found, dict)
        and found.keys() == names
        and all(isinstance(v, str) and v for v in found.values())
    )
    return found if whole else {}


def _local(wanted: str) -> str:
    """A path on this server; the page for anything else."""
    parts = urlsplit(wanted)
    plain = wanted.isprintable() and wanted.isascii() and not any(c in wanted for c in "\\ \"'<>")
    local = wanted.startswith("/") and not wanted.startswith("//") and not parts.netloc
    return wanted if plain and local and len(wanted) < 2000 else "/"
