"""Faults of files as plain data, for JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

from torsionnet.base.entries.spec import Schema
from torsionnet.base.errors import Fault, Position
from torsionnet.base.result_rows import Out

PATH: Schema = {"type": "array", "items": {"type": ["string", "integer"]}}
"""JSON Schema of the path of a model entry, its keys and indices."""


@dataclass(frozen=True)
class PlainFault:
    """Fault, warning or note with its places in files."""

    severity: Literal["error", "warning", "note"]
    kind: str | None
    message: str
    meant: str | None
    configuration: str | None
    path: Annotated[tuple[str | int, ...], Out(schema=PATH)]
    position: Position | None
    used_at: tuple[Position, ...]
    defined_at: Position | None


@dataclass(frozen=True)
class CheckedModel:
    """Faults of one model, as ``torsionnet check --json`` prints them."""

    model: str
    errors: int
    faults: tuple[PlainFault, ...]


def checked_model(model: str, faults: Sequence[Fault]) -> CheckedModel:
    """Record of a model's name, number of errors, and faults as plain data."""
    rows = tuple(
        PlainFault(
            fault.severity, fault.kind, fault.text, fault.meant, fault.configuration, fault.path,  # type: ignore[arg-type]
            fault.position, fault.used_at, fault.defined_at,
        )
        for fault in faults
    )  # fmt: skip
    return CheckedModel(model, sum(fault.severity == "error" for fault in faults), rows)
