"""What a file can say and the model would overlook: unknown keys of parameters, names without a value, empty lists."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from torsionnet.definition import TABLES
from torsionnet.errors import Fault, Path, did_you_mean
from torsionnet.files.located import Document
from torsionnet.parameters import KEYS as PARAMETER_KEYS


def overlooked(document: Document) -> Iterator[Fault]:
    """Faults of entries that reading the definition passes over in silence."""
    yield from _empty_tables(document.data)
    for path, entry in _entries(document.data, "parameters"):
        yield from _unknown_keys(entry, path)
    for path, entry in _entries(document.data, "elements"):
        yield from _without_value(entry, path)


def _entries(data: dict[str, Any], table: str) -> Iterator[tuple[Path, dict[str, Any]]]:
    entries = data.get(table)
    for name, entry in entries.items() if isinstance(entries, dict) else ():
        if isinstance(entry, dict):
            yield (table, name), entry


def _empty_tables(data: dict[str, Any]) -> Iterator[Fault]:
    for table in TABLES:
        entry = data.get(table)
        if (
            table not in ("elements", "operating_point")
            and not entry
            and entry is not None
            and not isinstance(entry, dict)
        ):
            yield Fault(f"expected entries by name, got {entry!r}", (table,))


def _unknown_keys(entry: dict[str, Any], path: Path) -> Iterator[Fault]:
    for key, value in entry.items():
        if key not in PARAMETER_KEYS:
            # A comma in a description without quotes makes such a key.
            hint = did_you_mean(key, PARAMETER_KEYS) or "; text with a comma needs quotes" * (value is None)
            text = f'unknown key "{key}"{hint}; a parameter has {", ".join(PARAMETER_KEYS)}'
            yield Fault(text, (*path, key), on_key=True)


def _without_value(entry: dict[str, Any], path: Path) -> Iterator[Fault]:
    """An optional entry without a value would count as left out: a mesh with ``stiffness:`` would be rigid."""
    for key, value in entry.items():
        if value is None and key != "type":
            yield Fault(f"{key} has no value; give one, or leave the entry out", (*path, key), on_key=True)
