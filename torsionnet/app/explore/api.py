"""Requests of the explore page, from JSON to JSON."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

from torsionnet.app.explore.answers import answer, fault_texts
from torsionnet.app.explore.document import Answer
from torsionnet.app.explore.documents import Documents
from torsionnet.app.explore.line_ends import plain_line_ends
from torsionnet.app.explore.picture_requests import motion_answer, schematic_answer
from torsionnet.app.explore.request_reading import PageRequest, read_request
from torsionnet.app.explore.session import Session
from torsionnet.app.explore.state import State, read_state
from torsionnet.app.explore.text_requests import TEXT_QUESTIONS
from torsionnet.base.errors import TorsionnetError
from torsionnet.model.files.library import MOST_BYTES

LARGEST_REQUEST = 100_000
"""Largest number of bytes of a request without a text; a state of 2000 parameters has about that many."""
LARGEST_TEXT_REQUEST = 2 * MOST_BYTES + LARGEST_REQUEST
"""Largest number of bytes of a request with a text, in which JSON writes a line feed as two."""


def _overlay(session: Session, state: State) -> dict[str, Any]:
    return {"overlay": session.overlay_for(state)}


def _values(session: Session, state: State) -> dict[str, Any]:
    return {"text": plain_line_ends(session.changed_file_text(state))}


QUESTIONS: Mapping[str, Callable[[Session, State], dict[str, Any]]] = {
    "api/answer": answer,
    "api/overlay": _overlay,
    "api/values": _values,
}
"""Calculations for a state of the page by their paths; each waits for the one before it of the same document."""

PICTURES: Mapping[str, Callable[[Session, State], dict[str, Any]]] = {
    "api/schematic": schematic_answer,
    "api/motion": motion_answer,
}
"""Pictures of a state of the page by their paths; they wait for one another, and for no response."""


def _model(documents: Documents, request: PageRequest, is_closed: Callable[[], bool]) -> Answer:
    del is_closed
    read_state(request.entries)
    return documents.named(request.document).described()


def _open(documents: Documents, request: PageRequest, is_closed: Callable[[], bool]) -> Answer:
    del is_closed
    return documents.open(request.only().document)


def _changes(documents: Documents, request: PageRequest, is_closed: Callable[[], bool]) -> Answer:
    disk = request.only("disk").short("disk")
    return documents.changes(documents.named(request.document), disk, is_closed)


def _store(documents: Documents, request: PageRequest, is_closed: Callable[[], bool]) -> Answer:
    del is_closed
    request.only("text", "disk", "force")
    text, disk = request.text("text"), request.short("disk")
    # Whoever insists names the version that was shown; an older one is refused all the same.
    request.flag("force")
    return documents.store(documents.named(request.document), text, disk)


OF_THE_FILE: Mapping[str, Callable[[Documents, PageRequest, Callable[[], bool]], Answer]] = {
    "api/open": _open,
    "api/model": _model,
    "api/changes": _changes,
    "api/store": _store,
}
"""Answers to requests on the file and its model by their paths; the last argument tells whether the asker has gone."""
PATHS = (*OF_THE_FILE, *TEXT_QUESTIONS, *QUESTIONS, *PICTURES)
"""Paths of all requests of the page."""


def largest_request(path: str) -> int:
    """Largest number of bytes of a request to a path."""
    return LARGEST_TEXT_REQUEST if path in TEXT_QUESTIONS or path == "api/store" else LARGEST_REQUEST


def reply(documents: Documents, path: str, body: bytes, is_closed: Callable[[], bool] = lambda: False) -> bytes:
    """JSON text, in bytes, that answers a request of the page.

    A state that the model refuses is answered with its reasons under ``refused``: sliders reach such states.

    Raises
    ------
    RequestError
        The body is no such request.
    """
    request = read_request(body)
    try:
        found = _found(documents, path, request, is_closed)
    except TorsionnetError as error:
        found = {"refused": fault_texts(error)}
    return json.dumps(found, separators=(",", ":"), allow_nan=False).encode()


def _found(documents: Documents, path: str, request: PageRequest, is_closed: Callable[[], bool]) -> Answer:
    if path in OF_THE_FILE:
        return OF_THE_FILE[path](documents, request, is_closed)
    document = documents.named(request.document)
    if path == "api/text":  # takes its turn by itself, as the text counts before it is examined
        return TEXT_QUESTIONS[path](document, request)
    kind = f"{path} {request.kind}"
    if path in TEXT_QUESTIONS:
        return document.in_turn(kind, lambda: TEXT_QUESTIONS[path](document, request))
    state = read_state(request.entries)
    if path in PICTURES:
        return document.drawn(kind, lambda session: _calculated(PICTURES[path], session, state))
    return document.calculated(kind, lambda session: _calculated(QUESTIONS[path], session, state))


def _calculated(question: Callable[[Session, State], Answer], session: Session, state: State) -> Answer:
    try:
        return question(session, state)
    except TorsionnetError as error:
        return {"refused": fault_texts(error)}
