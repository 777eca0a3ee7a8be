"""Choices made on the explore page: configuration, values of parameters, the response shown and the frequency band."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, TypeAlias

from torsionnet.base.entries.spec import Json
from torsionnet.base.errors import did_you_mean
from torsionnet.model.files.library import MOST_BYTES
from torsionnet.model.files.located_yaml import plain_value

AXES = ("frequency", "speed")
QUANTITIES = ("", "receptance", "mobility", "accelerance")
ANGLES = ("rad", "deg")
LONGEST_TEXT = 200
"""Largest number of characters of a name or value in a request of the page; none in a real model comes near, and
messages quote them."""
MOST_VALUES = 2000
"""Largest number of values in a table of a request of the page, so many that no model with sliders has more
parameters."""
HIGHEST_FREQUENCY = 1e9
"""Upper bound of the frequency band of the page in Hz, far above any torsional vibration."""

Value: TypeAlias = int | float | str


class RequestError(ValueError):
    """A request that the page would not send; the text says what is wrong with it."""


@dataclass(frozen=True)
class State:
    """Choices made on the page that determine what it shows.

    Attributes
    ----------
    choice : mapping
        Axis -> alternative.
    values : mapping
        Parameter -> SI number or text with unit, in place of what the file and the configuration say.
    output, input, excitation : str
        As for :meth:`torsionnet.Drivetrain.frequency_response`; an empty excitation is the model's first input.
    quantity : str
        ``receptance``, ``mobility``, ``accelerance``, or empty: as the sensor measures.
    band : (float, float)
        Lowest and highest frequency in Hz; (0, 0): what suits the modes.
    angle : str
        ``rad`` or ``deg``; only the command line takes it from here.
    decibels : bool
        Whether magnitudes are in dB; only the command line takes it from here.
    axis : str
        ``frequency``: a response; ``speed``: the vibration of the output over the speed of the machinery.
    rough : bool
        Whether fewer speeds are calculated, as the next state is on its way.
    """

    choice: Mapping[str, str] = field(default_factory=dict)
    values: Mapping[str, Value] = field(default_factory=dict)
    output: str = ""
    input: str = ""
    excitation: str = ""
    quantity: str = ""
    band: tuple[float, float] = (0.0, 0.0)
    angle: str = "rad"
    decibels: bool = False
    axis: str = AXES[0]
    rough: bool = False

    def to_data(self) -> dict[str, Json]:
        """Choices made on the page as JSON data by name."""
        return {entry.name: getattr(self, entry.name) for entry in fields(self)} | {"band": list(self.band)}


def read_state(raw: object) -> State:
    """State of the page from the JSON data of a request.

    Raises
    ------
    RequestError
        An entry is unknown or has a wrong form, whatever the model.

    Examples
    --------
    >>> read_state({"values": {"c_O": "360 N*m*s/rad", "tau": "3.3"}, "band": [1, 50]}).values
    {'c_O': '360 N*m*s/rad', 'tau': 3.3}
    """
    if not isinstance(raw, Mapping):
        raise RequestError("a request is a JSON object with entries such as values and band")
    known = [entry.name for entry in fields(State)]
    for key in raw:
        if key not in known:
            hint = did_you_mean(str(key), known) or f"; there are {', '.join(known)}"
            raise RequestError(f'"{str(key)[:LONGEST_TEXT]}" is no entry of a request{hint}')
    given: dict[str, Any] = {
        key: _text(raw, key) for key in ("axis", "output", "input", "excitation", "quantity", "angle") if key in raw
    }
    given |= {key: _table(raw, key) for key in ("choice", "values") if key in raw}
    _known("axis", given.get("axis", AXES[0]), AXES)
    _known("quantity", given.get("quantity", ""), QUANTITIES)
    _known("angle", given.get("angle", ANGLES[0]), ANGLES)
    given |= {key: _flag(raw, key) for key in ("decibels", "rough") if key in raw}
    if "band" in raw:
        given["band"] = _band(raw["band"])
    return State(**given)


def _text(raw: Mapping[str, Any], key: str) -> str:
    if not isinstance(raw[key], str) or len(raw[key]) > LONGEST_TEXT:
        raise RequestError(f"{key} is a text of at most {LONGEST_TEXT} characters")
    return str(raw[key])


def _flag(raw: Mapping[str, Any], key: str) -> bool:
    if not isinstance(raw[key], bool):
        raise RequestError(f"{key} is true or false")
    return bool(raw[key])


def _known(key: str, value: str, known: tuple[str, ...]) -> None:
    if value not in known:
        raise RequestError(f'no {key} is named "{value}"{did_you_mean(value, known)}')


def _table(raw: Mapping[str, Any], key: str) -> dict[str, Value]:
    table = raw[key]
    if not isinstance(table, Mapping) or len(table) > MOST_VALUES:
        raise RequestError(f"{key} is a JSON object that gives names their values, at most {MOST_VALUES}")
    return {str(name): _value(f'{key} of "{str(name)[:40]}"', value, key) for name, value in table.items()}


def _value(what: str, value: Any, key: str) -> Value:
    if isinstance(value, str) and len(value) <= LONGEST_TEXT:
        number = plain_value(value.strip()) if key == "values" else None
        return number if isinstance(number, int | float) and not isinstance(number, bool) else value
    if key == "values" and isinstance(value, int | float) and not isinstance(value, bool):
        if abs(value) < math.inf:
            return value
        raise RequestError(f"{what}: a parameter needs a finite number, as 360")
    form = "a number, or a text with a unit" if key == "values" else "a text"
    raise RequestError(f"{what}: expected {form}")


def _band(raw: object) -> tuple[float, float]:
    if not (
        isinstance(raw, list | tuple)
        and len(raw) == 2
        and all(isinstance(end, int | float) and not isinstance(end, bool) for end in raw)
    ):
        raise RequestError("a band is a list of its lowest and highest frequency in Hz, as [1, 50]")
    low, high = raw
    if (low, high) != (0, 0) and not 0 < low < high <= HIGHEST_FREQUENCY:
        raise RequestError(
            f"a band of frequencies needs 0 < lowest < highest <= {HIGHEST_FREQUENCY:g} Hz, got {low:g} and {high:g}"
        )
    return float(low), float(high)


# Reading of the JSON requests of the explore page, with a sentence for whatever is wrong with one.

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
        text = self.entries.get(name)
        if not isinstance(text, str):
            raise RequestError(f"{name} is a text")
        try:
            size = len(text) if text.isascii() else len(text.encode())
        except UnicodeEncodeError:
            raise RequestError(f"{name} holds half of a character, which no file can hold; delete it") from None
        if size > most:
            raise TooLargeError(f"{name} is too large: more than {most:,} bytes".replace(",", " "))
        return text

    def short(self, name: str) -> str:
        """Text of the length of a name."""
        return self.text(name, LONGEST_TEXT)

    def number(self, name: str, most: int = MOST_REVISION) -> int:
        """Whole number from 0."""
        number = self.entries.get(name)
        if not isinstance(number, int) or isinstance(number, bool) or not 0 <= number <= most:
            raise RequestError(f"{name} is a whole number from 0")
        return number

    def flag(self, name: str) -> bool:
        """Truth value, false where it is missing."""
        flag = self.entries.get(name, False)
        if not isinstance(flag, bool):
            raise RequestError(f"{name} is true or false")
        return flag


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
    entries = dict(pairs)
    if len(entries) < len(pairs):
        raise RequestError("a name stands twice in the request; keep one of them")
    return entries
