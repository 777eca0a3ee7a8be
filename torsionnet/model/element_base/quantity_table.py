"""Entries with several values of one kind, as ratios by gear, radii by node, stiffnesses of spans."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any, cast

from torsionnet.base.entries.spec import EntryError, Json, Renaming, Schema, list_annotation, name_fault
from torsionnet.base.errors import EntryPath, Fault
from torsionnet.base.expressions import Expression
from torsionnet.model.element_base.element_entries import MultipleValues, One_co


@dataclass(frozen=True, eq=False, repr=False)
class TableByName(MultipleValues[tuple[str, One_co], One_co]):
    """Entry for values by name, as ``{I: 3.77, II: 1.96}``, stored as pairs."""

    names: tuple[str, ...] = ("I", "II")
    """Names of rows that examples in messages use."""

    def coerce(self, raw: object) -> tuple[tuple[str, One_co], ...]:
        if raw == ():
            return ()
        pairs = _pairs(raw)
        if pairs is None or len(pairs) < self.fewest:
            raise self.form_error(raw)
        entries: list[tuple[str, One_co | None]] = []
        faults: list[Fault] = []
        for name, value in pairs:
            unfit = name_fault(str(name))
            faults += [replace(unfit, path=(name,), on_key=True)] if unfit else []
            entry, wrong = self.of.read(value)
            entries.append((str(name), entry))
            faults += [fault.under(name) for fault in wrong]
        if faults:
            raise EntryError(faults)
        return cast("tuple[tuple[str, One_co], ...]", tuple(entries))

    def plain(self, value: Any) -> Json:
        return {name: self.of.plain(entry) for name, entry in value}

    def schema(self) -> Schema:
        return {
            "type": "object",
            "description": self.description,
            "minProperties": self.fewest,
            "additionalProperties": self.of.schema(),
        }

    def expressions(self, value: Any) -> tuple[tuple[EntryPath, Expression, str], ...]:
        return tuple(
            ((name, *path), expression, dimension)
            for name, entry in value
            for path, expression, dimension in self.of.expressions(entry)
        )

    @property
    def accepted(self) -> str:
        of = self.of.accepted
        return f"collections.abc.Mapping[str, {of}] | tuple[tuple[str, {of}], ...]"


class TableByNode(TableByName[One_co]):
    """Entry for values by node, stored as pairs of node and value: ``{crank: 80 mm, pump: 60 mm}``."""

    def renamed(self, value: Any, names: Renaming) -> Any:
        return tuple((names.node(node), names.within(entry)) for node, entry in value)


class ListOf(MultipleValues[One_co, One_co]):
    """Entry for a list of values of one kind, as ``[3 MN/m, 2 MN/m]``."""

    def coerce(self, raw: object) -> tuple[One_co, ...]:
        if not isinstance(raw, list | tuple) or (raw and len(raw) < self.fewest):
            raise self.form_error(raw)
        read = [self.of.read(entry) for entry in raw]
        faults = [fault.under(index) for index, (_, wrong) in enumerate(read) for fault in wrong]
        if faults:
            raise EntryError(faults)
        return cast("tuple[One_co, ...]", tuple(value for value, _ in read))

    def plain(self, value: Any) -> Json:
        return [self.of.plain(entry) for entry in value]

    def schema(self) -> Schema:
        return {
            "type": "array",
            "items": self.of.schema(),
            "minItems": self.fewest,
            "description": self.description,
        }

    def expressions(self, value: Any) -> tuple[tuple[EntryPath, Expression, str], ...]:
        return tuple(
            ((index, *path), expression, dimension)
            for index, entry in enumerate(value)
            for path, expression, dimension in self.of.expressions(entry)
        )

    @property
    def accepted(self) -> str:
        return list_annotation(self.of.accepted)


def _pairs(raw: object) -> Collection[tuple[Any, Any]] | None:
    """Pairs of key and value from a mapping or from a tuple of pairs; None for any other object."""
    if isinstance(raw, Mapping):
        return raw.items()
    stored = isinstance(raw, tuple) and all(isinstance(pair, tuple) and len(pair) == 2 for pair in raw)
    return cast("tuple[tuple[Any, Any], ...]", raw) if stored else None
