"""Access check of the server of the explore page: only the page opened with the printed address may send requests."""

from __future__ import annotations

import hmac
import secrets
from dataclasses import dataclass, field
from http import HTTPStatus

HOST = "127.0.0.1"
"""IP address that the server of the page listens on: this machine alone."""
NAMES = (HOST, "localhost")
"""Host names that a request to the server of the page may be addressed to."""

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
"""HTTP headers of every answer of the page's server: nothing is loaded from elsewhere, no other page frames this
one, the token stays here."""


def index_headers(nonce: str) -> dict[str, str]:
    """HTTP headers of the start page, whose own scripts may insert styles that carry a word used once.

    >>> "style-src 'self' 'nonce-once';" in index_headers("once")["Content-Security-Policy"]
    True
    """
    rule = "style-src 'self'"
    return HEADERS | {
        "Content-Security-Policy": HEADERS["Content-Security-Policy"].replace(rule, f"{rule} 'nonce-{nonce}'")
    }


class RefusedError(Exception):
    """A request that is answered by an HTTP status and a sentence alone."""

    def __init__(self, status: HTTPStatus, text: str) -> None:
        self.status = status
        super().__init__(text)


@dataclass(frozen=True)
class Guard:
    """Access check of the page's server, with the port it listens on and the secret token in its address.

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
        """Refuse a request for a host name that is not this machine's (DNS rebinding), or from another page."""
        hosts = [f"{name}:{self.port}" for name in NAMES]
        if host not in hosts:
            raise RefusedError(
                HTTPStatus.FORBIDDEN,
                "this is not the address of the server; open the address that torsionnet explore printed",
            )
        if origin is not None and origin not in [f"http://{name}" for name in hosts]:
            raise RefusedError(
                HTTPStatus.FORBIDDEN,
                "the request comes from another web page; use the page at the address that torsionnet explore printed",
            )

    def path(self, target: str) -> str:
        """Path behind the token in the target of a request; RefusedError where the token is another."""
        before, _, rest = target.removeprefix("/").partition("/")
        if not (target.startswith("/") and hmac.compare_digest(before.encode(), self.token.encode())):
            raise RefusedError(HTTPStatus.FORBIDDEN, "open the whole address that torsionnet explore printed")
        return rest
