"""The four requests of the explore page, from JSON to JSON."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Mapping
from typing import Any

from torsionnet.core.errors import TorsionnetError
from torsionnet.explore.answers import answer, fault_texts
from torsionnet.explore.session import Session
from torsionnet.explore.state import RequestError, State, read_state

_LOCK = threading.Lock()
"""Lock that lets one request calculate at a time: a drivetrain keeps results while it calculates them."""


def _model(session: Session, state: State) -> dict[str, Any]:
    del state
    return session.describe()


def _overlay(session: Session, state: State) -> dict[str, Any]:
    return {"overlay": session.overlay_for(state)}


def _save(session: Session, state: State) -> dict[str, Any]:
    return {"file": session.saved_file_name, "text": session.changed_file_text(state)}


QUESTIONS: Mapping[str, Callable[[Session, State], dict[str, Any]]] = {
    "api/model": _model,
    "api/answer": answer,
    "api/overlay": _overlay,
    "api/save": _save,
}


def reply(session: Session, path: str, body: bytes) -> bytes:
    """JSON text, in bytes, that answers a request of the page.

    A state that the model refuses is answered with its reasons under ``refused``: sliders reach such states.

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
            found = {"refused": fault_texts(error)}
    return json.dumps(found, separators=(",", ":"), allow_nan=False).encode()


def _parsed(body: bytes) -> Any:
    try:
        return json.loads(body.decode() or "{}", parse_constant=_no_number, object_pairs_hook=_object)
    except RequestError:
        raise
    except (ValueError, RecursionError) as error:  # of bytes, of text, of numbers of thousands of digits
        raise RequestError(f"the request is no JSON text: {error}") from None


def _no_number(text: str) -> Any:
    raise RequestError(f"{text} is far outside the values of drivetrains; check the number and its unit")


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise RequestError("a name stands twice in the request; keep one of them")
    return found
