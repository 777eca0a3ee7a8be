"""Who may ask: this page, opened with the address that was printed. Other pages in the same browser may not."""

from __future__ import annotations

import hmac
import secrets
from dataclasses import dataclass, field
from http import HTTPStatus

HOST = "127.0.0.1"
NAMES = (HOST, "localhost")

HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Cache-Control": "no-store",
}
"""Nothing is loaded from elsewhere, nothing is shown within another page, and the address with its token stays here."""


class RefusedError(Exception):
    """A request that gets no answer but a status and a sentence."""

    def __init__(self, status: HTTPStatus, text: str) -> None:
        self.status = status
        super().__init__(text)


@dataclass(frozen=True)
class Guard:
    """The port a server listens on and the token in its address.

    Examples
    --------
    >>> guard = Guard(8000, "secret")
    >>> guard.address
    'http://127.0.0.1:8000/secret/'
    >>> guard.path("/secret/api/answer")
    'api/answer'
    """

    port: int
    token: str = field(default_factory=lambda: secrets.token_urlsafe(24), repr=False)

    @property
    def address(self) -> str:
        return f"http://{HOST}:{self.port}/{self.token}/"

    def check_headers(self, host: str | None, origin: str | None) -> None:
        """Refuse a name that is not this machine's, as after DNS rebinding, and a script of another page."""
        hosts = [f"{name}:{self.port}" for name in NAMES]
        if host not in hosts:
            raise RefusedError(HTTPStatus.FORBIDDEN, "this server answers only under its own address")
        if origin is not None and origin not in [f"http://{name}" for name in hosts]:
            raise RefusedError(HTTPStatus.FORBIDDEN, "a page of another origin asks")

    def path(self, target: str) -> str:
        """What stands behind the token; a query is none of ours."""
        before, _, rest = target.removeprefix("/").partition("/")
        if not (target.startswith("/") and hmac.compare_digest(before.encode(), self.token.encode())):
            raise RefusedError(HTTPStatus.FORBIDDEN, "open the whole address that torsionnet explore printed")
        return rest
