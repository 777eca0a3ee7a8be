"""Connections to the page's server: who may send requests, and the time that each has to come in."""

from __future__ import annotations

import contextlib
import hmac
import secrets
import socket
import time
from dataclasses import dataclass, field
from http import HTTPStatus
from io import RawIOBase
from threading import Lock
from typing import Any

# Places of connections to the page's server, and the time that each request has to come in.

MOST_CONNECTIONS = 32
"""Largest number of connections to the page's server at a time; a browser opens six."""
REQUEST_SECONDS = 20.0
"""Longest time in seconds for the body of a request to come in, and for an answer to go out."""
HEADER_SECONDS = 5.0
"""Longest time in seconds for the header of a request to come in, from its first byte."""
IDLE_SECONDS = 60.0
"""Longest time in seconds that a connection waits for its next request."""
PASSED_OVER_SECONDS = 2.0
"""Longest time in seconds for which the rest of a request that is too large is read and forgotten."""
GRACE_SECONDS = 0.25
"""Seconds before a new connection without a request counts as waiting; its request is on its way."""
END_OF_HEADER = b"\r\n\r\n"

IDLE, HEADER, BODY, ANSWER = range(4)
"""Stages of a connection: no byte of a request yet, its header, its body, its answer."""


class Place:
    """Place of a connection, with the stage of its request and the time since when it lasts."""

    def __init__(self, connection: socket.socket) -> None:
        self.connection = connection
        # Looking never waits, also where the thread of the connection takes the bytes in the same moment.
        self._look = connection.dup()
        self._look.setblocking(False)
        self.enter(IDLE)

    def enter(self, stage: int) -> None:
        """Begin a stage of a request."""
        self.stage, self.since = stage, time.monotonic()

    @property
    def has_request(self) -> bool:
        """Whether the whole header of a request is there to be read."""
        try:
            return END_OF_HEADER in self._look.recv(1 << 16, socket.MSG_PEEK)
        except OSError:
            return False

    @property
    def is_closed(self) -> bool:
        """Whether the other side has closed the connection."""
        try:
            return not self._look.recv(1, socket.MSG_PEEK)
        except BlockingIOError:
            return False
        except OSError:
            return True

    def leave(self) -> None:
        """Give the place up."""
        self._look.close()


class Places:
    """Places of the connections that are open.

    Where all are taken, the connection that has waited longest for a request to come gives up its place, and after
    those the one whose request takes longest to come in. A connection whose request is being answered keeps its place.
    """

    def __init__(self) -> None:
        self._places: dict[socket.socket, Place] = {}
        self._lock = Lock()

    def enter(self, connection: socket.socket) -> bool:
        """Whether there is a place for a new connection, which it has then."""
        with self._lock:
            if len(self._places) >= MOST_CONNECTIONS and not self._one_left():
                return False
            self._places[connection] = Place(connection)
            return True

    def leave(self, connection: socket.socket) -> None:
        """Free the place of a connection that has ended."""
        with self._lock:
            place = self._places.pop(connection, None)
        if place is not None:
            place.leave()

    def of(self, connection: socket.socket) -> Place:
        """Place of a connection; ConnectionError where it has just been sent away."""
        with self._lock:
            place = self._places.get(connection)
        if place is None:
            raise ConnectionResetError
        return place

    def _one_left(self) -> bool:
        """Send the least busy connection away; False where all are being answered."""
        waiting = sorted(
            (connection for connection in self._places.values() if connection.stage != ANSWER), key=_patience
        )
        gone = next((connection for connection in waiting if not connection.has_request), None)
        if gone is None:
            return False
        del self._places[gone.connection]
        with contextlib.suppress(OSError):
            gone.connection.shutdown(socket.SHUT_RDWR)
        gone.leave()
        return True


def _patience(place: Place) -> tuple[bool, float]:
    """Order in which connections are sent away: those that wait for a request, then others by the time they take."""
    waits = place.stage == IDLE and time.monotonic() - place.since > GRACE_SECONDS
    return not waits, place.since


class Incoming(RawIOBase):
    """Stream of the bytes of a connection that ends with TimeoutError when the time of its request is over."""

    def __init__(self, place: Place) -> None:
        self._place = place
        self._last = b""

    def readable(self) -> bool:
        """True, as for every stream that is read."""
        return True

    def readinto(self, buffer: Any) -> int:
        """Number of bytes read into a buffer, 0 at the end."""
        place = self._place
        left = place.since + SECONDS[place.stage]() - time.monotonic()
        if left <= 0:
            raise TimeoutError("a request has taken too long to come in")
        place.connection.settimeout(left)
        count = place.connection.recv_into(buffer)
        if place.stage == IDLE and count:
            place.enter(HEADER)
        if place.stage == HEADER:
            # What has come in as a whole is answered, however many connections wait.
            seen = self._last + bytes(buffer[:count])
            if END_OF_HEADER in seen:
                place.enter(ANSWER)
            self._last = seen[-3:]
        return count


def pass_over(connection: socket.socket) -> None:
    """Read what still comes in, for a short time, and forget it."""
    until = time.monotonic() + PASSED_OVER_SECONDS
    with contextlib.suppress(OSError):
        while (left := until - time.monotonic()) > 0:
            connection.settimeout(left)
            if not connection.recv(1 << 16):
                return


SECONDS = {
    IDLE: lambda: IDLE_SECONDS,
    HEADER: lambda: HEADER_SECONDS,
    BODY: lambda: REQUEST_SECONDS,
    ANSWER: lambda: REQUEST_SECONDS,
}
"""Longest time in seconds of each stage in which bytes come in."""


# Access check of the server of the explore page: only the page opened with the printed address may send requests.

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
