"""JSON in, JSON out: the four questions a page has."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Mapping
from typing import Any

from torsionnet.core.errors import TorsionnetError
from torsionnet.explore.answers import answer, reasons
from torsionnet.explore.session import Session
from torsionnet.explore.state import RequestError, State, read_state

_LOCK = threading.Lock()
"""A drivetrain fills in what it calculates as it goes: one request at a time."""


def _model(session: Session, state: State) -> dict[str, Any]:
    del state
    return session.describe()


def _overlay(session: Session, state: State) -> dict[str, Any]:
    return {"overlay": session.overlaid(state)}


def _save(session: Session, state: State) -> dict[str, Any]:
    return {"file": session.saved_file, "text": session.saved(state)}


QUESTIONS: Mapping[str, Callable[[Session, State], dict[str, Any]]] = {
    "api/model": _model,
    "api/answer": answer,
    "api/overlay": _overlay,
    "api/save": _save,
}


def reply(session: Session, path: str, body: bytes) -> bytes:
    """The answer to one question.

    A state that the model refuses is answered, too, with ``refused``: a slider gets there in the course of things.

    Raises
    ------
    RequestError
        The body is no state.
    """
    state = read_state(_parsed(body))
    with _LOCK:
        try:
            found = QUESTIONS[path](session, state)
        except TorsionnetError as error:
            found = {"refused": reasons(error)}
    return json.dumps(found, separators=(",", ":"), allow_nan=False).encode()


def _parsed(body: bytes) -> Any:
    try:
        return json.loads(body.decode() or "{}", parse_constant=_no_number, object_pairs_hook=_object)
    except RequestError:
        raise
    except (ValueError, RecursionError) as error:  # of bytes, of text, of numbers of thousands of digits
        raise RequestError(f"the request is no JSON text: {error}") from None


def _no_number(text: str) -> Any:
    raise RequestError(f"{text} is no number that a drivetrain can have")


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise RequestError("a name stands twice in the request")
    return found
