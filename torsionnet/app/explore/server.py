"""HTTP server of the explore page for the browser on this machine only."""

from __future__ import annotations

import contextlib
import json
import re
import secrets
from dataclasses import dataclass
from email.errors import MissingHeaderBodySeparatorDefect
from functools import cache
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from io import BufferedReader
from pathlib import Path
from socket import SHUT_WR
from typing import Any

from torsionnet.app.explore.api import PATHS, largest_request, reply
from torsionnet.app.explore.connections import (
    ANSWER,
    BODY,
    HEADERS,
    HOST,
    IDLE,
    REQUEST_SECONDS,
    Guard,
    Incoming,
    Places,
    RefusedError,
    index_headers,
    pass_over,
)
from torsionnet.app.explore.documents import Documents
from torsionnet.app.explore.session import Session
from torsionnet.app.explore.state import RequestError, TooLargeError
from torsionnet.base.errors import UsageError

JSON = "application/json"
"""Media type of JSON requests to the page's server and of its answers."""
_NONCE = re.compile(rb'(?<=<meta name="style-nonce" content=")[^"]*(?=")')
"""Expression of the place in the start page for the word that lets its scripts insert styles."""


STATIC = Path(__file__).parent / "static"
TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}
INDEX = "index.html"


class ExploreServer(ThreadingHTTPServer):
    """Server of the explore page that listens on 127.0.0.1 from the moment it exists; ``serve_forever`` answers.

    Parameters
    ----------
    documents : Documents or Session
        A session has one text and no file that could be stored.
    port : int, optional
        Default: any that is free.

    Raises
    ------
    UsageError
        The port is taken, or may not be used.

    Examples
    --------
    >>> from torsionnet.app.explore import open_session
    >>> with ExploreServer(open_session("dmf_rig")) as server:
    ...     server.address.startswith("http://127.0.0.1:")
    True
    """

    daemon_threads = True
    block_on_close = False
    allow_reuse_address = False
    request_queue_size = 128  # connections that wait to be accepted; one more would be tried again after a second

    def __init__(self, documents: Documents | Session, port: int = 0) -> None:
        self.documents = Documents.of(documents) if isinstance(documents, Session) else documents
        try:
            super().__init__((HOST, port), Handler)
        except (OSError, OverflowError) as error:
            raise UsageError(
                f"port {port} cannot be used ({error}); choose another one with --port, or leave it out",
                kind="out-of-range",
            ) from None
        self.guard = Guard(self.server_address[1])
        self.places = Places()

    @property
    def address(self) -> str:
        """Address of the page to open in a browser, with the token in it."""
        return self.guard.address

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answer a connection in a thread of its own, or with status 503 where too many are open."""
        if self.places.enter(request):
            super().process_request(request, client_address)
            return
        with contextlib.suppress(OSError):
            request.settimeout(0)
            request.send(FULL)
        self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Answer a connection and free its place for another one."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self.places.leave(request)

    def server_close(self) -> None:
        """Stop listening, and end the requests that wait for changes of the file."""
        self.documents.ended.set()
        super().server_close()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Print nothing where a browser closes a connection early."""


class Handler(BaseHTTPRequestHandler):
    """HTTP handler that answers GET for the files of the page and POST for its requests, and refuses other methods."""

    server: ExploreServer
    protocol_version = "HTTP/1.1"
    server_version, sys_version = "torsionnet", ""
    disable_nagle_algorithm = True  # else small answers wait for the acknowledgement of the one before

    def setup(self) -> None:
        """Read requests with a time limit for the whole of each, not for every few bytes of it."""
        self._place = self.server.places.of(self.request)
        super().setup()
        self.rfile.close()
        self.rfile = BufferedReader(Incoming(self._place))

    def handle_one_request(self) -> None:
        """Answer one request, for which the connection waits from now on."""
        self._place.enter(IDLE)
        super().handle_one_request()

    def parse_request(self) -> bool:
        """Whether the header of a request could be read, which is answered now."""
        readable = super().parse_request()
        self._place.enter(ANSWER)
        return readable

    def do_GET(self) -> None:
        self._guarded(self._page)

    def do_POST(self) -> None:
        self._guarded(self._answer)

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """Send the refusal of a request that the base class could not read: another method, or no HTTP."""
        del explain
        self.close_connection = True
        is_method = code == HTTPStatus.NOT_IMPLEMENTED
        status = HTTPStatus.METHOD_NOT_ALLOWED if is_method else HTTPStatus(code)
        text = "only GET and POST are answered" if is_method else message or status.phrase
        self._send(status, _words(text), JSON, **({"Allow": "GET, POST"} if is_method else {}))

    def _guarded(self, respond: Any) -> None:
        try:
            self._check_end()
            self.server.guard.check_headers(self._only("Host"), self._only("Origin"))
            respond(self.server.guard.path(self.path))
        except RefusedError as refused:
            self.close_connection = True  # a body that was not read would be taken for the next request
            self._send(refused.status, _words(str(refused)), JSON)
            if self.command == "POST":
                self._place.enter(BODY)
                # A browser reads no answer before it has sent everything, and bytes left unread would reset it.
                with contextlib.suppress(OSError):
                    self.connection.shutdown(SHUT_WR)
                pass_over(self.connection)
        except TooLargeError as error:
            self._send(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, _words(str(error)), JSON)
        except RequestError as error:
            self._send(HTTPStatus.BAD_REQUEST, _words(str(error)), JSON)
        except (ConnectionError, TimeoutError):
            self.close_connection = True
        except Exception as error:  # noqa: BLE001
            text = f"unexpected {type(error).__name__} (a bug in torsionnet; report it with the model file): {error}"
            self._send(HTTPStatus.INTERNAL_SERVER_ERROR, _words(text), JSON)

    def _check_end(self) -> None:
        """Refuse a header that leaves open where the request ends: its rest would be taken for the next request."""
        has_body = self.headers.get_all("Content-Length", ["0"]) != ["0"] or "Transfer-Encoding" in self.headers
        is_broken = any(isinstance(defect, MissingHeaderBodySeparatorDefect) for defect in self.headers.defects)
        is_folded = any("\n" in value or "\r" in value for value in self.headers.values())
        if is_broken or is_folded or (self.command == "GET" and has_body):
            raise RefusedError(HTTPStatus.BAD_REQUEST, "the header of the request is not sound, or GET has a body")

    def _only(self, header: str) -> str | None:
        values = self.headers.get_all(header, [])
        return (values[0] if len(values) == 1 else "") if values else None

    def _page(self, path: str) -> None:
        page = pages().get(path)
        if page is None:
            raise RefusedError(HTTPStatus.NOT_FOUND, "the page has no such file; open the address that was printed")
        if path in ("", INDEX):
            nonce = secrets.token_urlsafe(16)
            content = _NONCE.sub(nonce.encode(), page.content)
            self._send(HTTPStatus.OK, content, page.media_type, **index_headers(nonce))
            return
        self._send(HTTPStatus.OK, page.content, page.media_type)

    def _answer(self, path: str) -> None:
        if path not in PATHS:
            raise RefusedError(HTTPStatus.NOT_FOUND, f"no such request; there are {', '.join(PATHS)}")
        if (self.headers.get_content_type() if "Content-Type" in self.headers else "") != JSON:
            raise RefusedError(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, f"the content type of a request is {JSON}")
        body = self._body(largest_request(path))
        answer = reply(self.server.documents, path, body, lambda: self._place.is_closed)
        self._send(HTTPStatus.OK, answer, JSON)

    def _body(self, most: int) -> bytes:
        length = self._only("Content-Length") or ""
        if "Transfer-Encoding" in self.headers or not (length.isascii() and length.isdigit()):
            raise RefusedError(HTTPStatus.LENGTH_REQUIRED, "a request needs its Content-Length")
        if len(length) > len(str(most)) or int(length) > most:
            raise RefusedError(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"a request has at most {most} bytes")
        self._place.enter(BODY)
        body = self.rfile.read(int(length))
        self._place.enter(ANSWER)
        return body

    def _send(self, status: HTTPStatus, content: bytes, media_type: str, **headers: str) -> None:
        """Send an answer in one write, so that it goes out in one piece."""
        more = {"Content-Type": media_type, "Content-Length": str(len(content))}
        more |= {"Connection": "close"} if self.close_connection else {}
        lines = [f"{name}: {value}" for name, value in (HEADERS | more | headers).items()]
        self.connection.settimeout(REQUEST_SECONDS)
        head = "\r\n".join([f"{self.protocol_version} {status.value} {status.phrase}", *lines, "", ""])
        self.wfile.write(head.encode("latin-1") + content)

    def log_message(self, format: str, *args: Any) -> None:
        """Print no line in the terminal for a request."""


FULL = (
    f"HTTP/1.1 {HTTPStatus.SERVICE_UNAVAILABLE.value} {HTTPStatus.SERVICE_UNAVAILABLE.phrase}\r\n"
    "Content-Length: 0\r\nRetry-After: 1\r\nConnection: close\r\n\r\n"
).encode()


def _words(text: str) -> bytes:
    return json.dumps({"error": text}).encode()


@dataclass(frozen=True)
class Page:
    """Content of a file of the page and its media type."""

    content: bytes
    media_type: str


@cache
def pages() -> dict[str, Page]:
    """Content and media type of every file of the explore page by URL path, the start page also by the empty path.

    >>> sorted(path for path in pages() if path.endswith((".html", ".css")))
    ['index.html', 'panes.css', 'style.css', 'vendor/uPlot.min.css']
    """
    files = [path for path in sorted(STATIC.rglob("*")) if path.suffix in TYPES]
    contents = {path.relative_to(STATIC).as_posix(): Page(path.read_bytes(), TYPES[path.suffix]) for path in files}
    return contents | {"": contents[INDEX]}
