"""Mean speeds and torques about which a linear model holds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from torsionnet.core.errors import Fault, unknown_key
from torsionnet.core.expressions import Expression
from torsionnet.model.elements.fields import FieldError, plain_scalar, read_scalar

TABLES = ("speed", "torque")


@dataclass(frozen=True)
class OperatingPoint:
    """Mean speeds (rad/s) and mean external torques (N m) by node, as given in the model."""

    speed: Mapping[str, Expression] = field(default_factory=dict)
    torque: Mapping[str, Expression] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in TABLES:
            given = {node: read_scalar(value, name) for node, value in getattr(self, name).items()}
            object.__setattr__(self, name, given)

    def __bool__(self) -> bool:
        return bool(self.speed or self.torque)

    def to_data(self) -> dict[str, Any]:
        tables = {"speed": self.speed, "torque": self.torque}
        return {
            name: {node: plain_scalar(value) for node, value in table.items()}
            for name, table in tables.items()
            if table
        }

    def overlaid(self, other: OperatingPoint | None) -> OperatingPoint:
        """A point with the entries of ``other`` replacing its own."""
        if other is None:
            return self
        return OperatingPoint({**self.speed, **other.speed}, {**self.torque, **other.torque})


def read_operating_point(raw: Any, path: tuple[str, ...] = ("operating_point",)) -> tuple[OperatingPoint, list[Fault]]:
    """Operating point from ``{speed: {node: 1500 rpm}, torque: {node: 80 N*m}}`` and its faults."""
    if isinstance(raw, OperatingPoint):
        return raw, []
    if raw is None:
        return OperatingPoint(), []
    if not isinstance(raw, Mapping):
        return OperatingPoint(), [Fault(f"expected {{speed: {{node: 1500 rpm}}}}, got {raw!r}", path)]
    faults = [unknown_key(key, TABLES, (*path, key), "expected speed or torque") for key in raw if key not in TABLES]
    tables: dict[str, dict[str, Expression]] = {name: {} for name in TABLES}
    for name in TABLES:
        entries = {} if raw.get(name) is None else raw[name]
        if not isinstance(entries, Mapping):
            faults.append(Fault(f"expected {{node: value}}, got {entries!r}", (*path, name)))
            continue
        for node, value in entries.items():
            try:
                tables[name][node] = read_scalar(value, name)
            except FieldError as error:
                faults.append(error.fault.under(*path, name, node))
    return OperatingPoint(tables["speed"], tables["torque"]), faults
