"""Examples of values for entries that a model lacks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from torsionnet.base.entries.spec import Json, Spec
from torsionnet.base.errors import EntryPath
from torsionnet.base.units import expected_unit
from torsionnet.model.element_base.element import ELEMENT_TYPES
from torsionnet.model.element_base.element_entries import NodeName, NodePair, Teeth
from torsionnet.model.files.located_yaml import LocatedDocument
from torsionnet.model.files.reader import entry_at

_FIRST_ELEMENT: dict[str, Json] = {"type": "inertia", "node": "disc", "inertia": "1 kg*m^2"}


def example_values(document: LocatedDocument, path: EntryPath, key: str) -> Iterator[Json]:
    """Values that the entry ``key`` of the table at ``path`` may have, the likeliest first.

    Nodes are those that the model has; a reader has to find out whether a value fits.
    """
    if key == "elements" and len(path) <= 1:
        yield {"disc": _FIRST_ELEMENT}
        return
    if len(path) < 2 or path[-2] not in ("elements", "parameters"):
        return
    if path[-2] == "parameters":
        yield 1
        return
    entries = entry_at(document.data, path)
    kind = entries.get("type") if isinstance(entries, Mapping) else None
    spec = dict(ELEMENT_TYPES[kind].specs()).get(key) if isinstance(kind, str) and kind in ELEMENT_TYPES else None
    if spec is None:
        return
    own = set(_texts(entries))
    nodes = list(dict.fromkeys(_nodes(entry_at(document.data, path[:-1]))))
    yield from _values(spec, [*(node for node in nodes if node not in own), "a", "b"])


def _values(spec: Spec[object], nodes: list[str]) -> Iterator[Json]:
    if isinstance(spec, NodePair):
        yield nodes[:2]
    elif isinstance(spec, NodeName):
        yield from nodes
    elif isinstance(spec, Teeth):
        yield [20, 40]
    dimension = getattr(spec, "dimension", None)
    if isinstance(dimension, str):
        unit = "" if dimension == "1" else expected_unit(dimension)
        for number in ("1", "0.1", "10"):
            yield f"{number} {unit}" if unit else float(number) if "." in number else int(number)
    words = getattr(spec, "options", None)
    if isinstance(words, tuple):
        yield from words


def _nodes(elements: Any) -> Iterator[str]:
    """Nodes that the elements name by ``node`` and ``nodes``."""
    for entries in elements.values() if isinstance(elements, Mapping) else ():
        if isinstance(entries, Mapping):
            named = [entries.get("node"), *(entries["nodes"] if isinstance(entries.get("nodes"), list) else [])]
            yield from (name for name in named if isinstance(name, str) and name != "ground")


def _texts(value: Any) -> Iterator[str]:
    inner = value.values() if isinstance(value, Mapping) else value if isinstance(value, list) else ()
    if isinstance(value, str):
        yield value
    for one in inner:
        yield from _texts(one)
