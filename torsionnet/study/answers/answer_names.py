"""What the entries of an answer name: quantities, limits, parameters, configurations; and names that are none."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from torsionnet.core.errors import Fault, Path, unknown_name

QUANTITY, LIMIT, PARAMETER = "quantity", "limit", "parameter"
VARIED, CONFIGURATION = "varied parameter", "configuration of the study"


def misnamed(naming: Mapping[str, str], entries: Mapping[str, Any], known: Mapping[str, Iterable[str]]) -> list[Fault]:
    """Faults of names that nothing has, in entries as they are written or as they were read.

    Parameters
    ----------
    naming : mapping
        Key of an entry -> what it names.
    entries : mapping
        Key -> a name, a list of names, or a table by name; what is anything else has a fault of its own.
    known : mapping
        What is named -> the names that there are.

    Examples
    --------
    >>> faults = misnamed({"limits": LIMIT}, {"limits": ["peak", "peek"]}, {LIMIT: ["peak", "f_2"]})
    >>> [(fault.path, fault.message) for fault in faults]
    [(('limits', 1), 'no limit is named "peek"; did you mean "peak"? there are peak, f_2')]
    """
    found = []
    for key, what in naming.items():
        there = list(known[what])
        rest = f"there are {', '.join(there)}" if there and what != PARAMETER else ""
        for name, path, on_key in _names(key, entries.get(key)):
            if name not in there:
                found.append(unknown_name(what, name, there, path, on_key=on_key, rest=rest))
    return found


def _names(key: str, value: Any) -> Iterator[tuple[str, Path, bool]]:
    """Name, path, and whether it is itself a key."""
    if isinstance(value, str):
        yield value, (key,), False
    elif isinstance(value, Mapping):
        yield from ((str(name), (key, name), True) for name in value)
    elif isinstance(value, list | tuple):
        yield from ((name, (key, place), False) for place, name in enumerate(value) if isinstance(name, str))
