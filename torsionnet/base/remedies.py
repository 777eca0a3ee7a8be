"""Names of arguments and functions in messages, as callers in Python write them, or as the command line does."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator, Mapping
from contextvars import ContextVar

VALUE = "*"
"""Mark in a name at which the value stands, instead of behind it."""
_NAMES: ContextVar[Mapping[str, str]] = ContextVar("names of arguments in messages", default={})  # noqa: B039


def remedy(argument: str, value: str | Mapping[str, str] = "") -> str:
    """Argument or function that mends something, with its value, as the caller names it.

    >>> remedy("sampling_rate=", "1000"), remedy("quantities=", {"M1": "torque"})
    ('sampling_rate=1000', 'quantities={"M1": "torque"}')
    >>> with remedies({"sampling_rate=": "--rate", "quantities=": "--quantity"}):
    ...     remedy("sampling_rate="), remedy("sampling_rate=", "1000"), remedy("quantities=", {"M1": "torque"})
    ('--rate', '--rate 1000', '--quantity M1=torque')

    Of a file of entries ``*`` stands for the value.

    >>> with remedies({"sampling_rate=": "reading: {rate: *}", "units=": "reading: {units: *}"}):
    ...     remedy("sampling_rate="), remedy("units=", {"M1": "kNm"})
    ('reading: {rate: ...}', 'reading: {units: {M1: kNm}}')
    """
    name = _NAMES.get().get(argument)
    if name is None:
        return f"{argument}{value if isinstance(value, str) else json.dumps(dict(value), ensure_ascii=False)}"
    if VALUE in name:
        entries = value if isinstance(value, str) else f"{{{', '.join(f'{key}: {one}' for key, one in value.items())}}}"
        return name.replace(VALUE, entries or "...")
    values = [value] if isinstance(value, str) else [f"{key}={word}" for key, word in value.items()]
    return " ".join(f"{name} {one}".strip() for one in values)


@contextlib.contextmanager
def remedies(names: Mapping[str, str]) -> Iterator[None]:
    """Context in which messages name arguments and functions by other names, such as options."""
    before = _NAMES.set(names)
    try:
        yield
    finally:
        _NAMES.reset(before)
