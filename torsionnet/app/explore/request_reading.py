"""Reading of the JSON requests of the explore page, with a sentence for whatever is wrong with one."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

from torsionnet.app.explore.state import LONGEST_TEXT, RequestError
from torsionnet.model.files.library import MOST_BYTES

_NAME = re.compile("[A-Za-z0-9_-]{1,40}")
MOST_REVISION = 10**12
"""Largest number of a revision; nobody types as long."""


class PageRequest:
    """Entries of a request of the page by their names.

    A newer request takes the place of one that waits if both have the same path, document and ``kind``.

    Examples
    --------
    >>> request = read_request(b'{"document": "tab-1", "text": "a: 1", "at": 3}')
    >>> request.document, request.text("text"), request.number("at")
    ('tab-1', 'a: 1', 3)
    """

    def __init__(self, raw: Mapping[str, Any]) -> None:
        self.document, self.kind = (_name(key, raw.get(key, "")) for key in ("document", "kind"))
        self.entries = {key: value for key, value in raw.items() if key not in ("document", "kind")}

    def only(self, *names: str) -> PageRequest:
        """The request itself, which has entries of these names alone."""
        for key in self.entries:
            if key not in names:
                known = ", ".join(("document", *names))
                raise RequestError(f'"{key[:LONGEST_TEXT]}" is no entry of this request; there are {known}')
        return self

    def text(self, name: str, most: int = MOST_BYTES) -> str:
        """Text of at most so many bytes in UTF-8 code."""
        found = self.entries.get(name)
        if not isinstance(found, str):
            raise RequestError(f"{name} is a text")
        try:
            size = len(found) if found.isascii() else len(found.encode())
        except UnicodeEncodeError:
            raise RequestError(f"{name} holds half of a character, which no file can hold; delete it") from None
        if size > most:
            raise TooLargeError(f"{name} is too large: more than {most:,} bytes".replace(",", " "))
        return found

    def short(self, name: str) -> str:
        """Text of the length of a name."""
        return self.text(name, LONGEST_TEXT)

    def number(self, name: str, most: int = MOST_REVISION) -> int:
        """Whole number from 0."""
        found = self.entries.get(name)
        if not isinstance(found, int) or isinstance(found, bool) or not 0 <= found <= most:
            raise RequestError(f"{name} is a whole number from 0")
        return found

    def flag(self, name: str) -> bool:
        """Truth value, false where it is missing."""
        found = self.entries.get(name, False)
        if not isinstance(found, bool):
            raise RequestError(f"{name} is true or false")
        return found


class TooLargeError(RequestError):
    """A text in a request that is larger than any model file."""


def read_request(body: bytes) -> PageRequest:
    """Entries of a request from its JSON text.

    Raises
    ------
    RequestError
        The bytes are no JSON object.
    """
    try:
        raw = json.loads(body.decode() or "{}", parse_constant=_no_number, object_pairs_hook=_object)
    except RequestError:
        raise
    except (ValueError, RecursionError) as error:  # of bytes, of text, of numbers of thousands of digits
        raise RequestError(f"the request is no JSON text: {error}") from None
    if not isinstance(raw, dict):
        raise RequestError("a request is a JSON object with entries such as values and band")
    return PageRequest(raw)


def _name(key: str, raw: object) -> str:
    if raw == "":
        return ""
    if not isinstance(raw, str) or not _NAME.fullmatch(raw):
        raise RequestError(f"{key} is a name of at most 40 letters, digits, - and _")
    return raw


def _no_number(text: str) -> Any:
    raise RequestError(f"{text} is far outside the values of drivetrains; check the number and its unit")


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise RequestError("a name stands twice in the request; keep one of them")
    return found
