"""Plain data about a drivetrain: parts with exact numbers, and what drives it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any

GROUND = "ground"
MEMBERS = {"planetary": ("sun", "ring", "carrier"), "differential": ("cage", "left", "right")}
SINGLE = ("inertia", "lock")


@dataclass(frozen=True)
class Measure:
    """Damping by a measure such as zeta, at a frequency in Hz where it stands for a viscous damper."""

    name: str
    value: Fraction
    at: Fraction | None = None


@dataclass(frozen=True)
class Part:
    """One element: its kind, its name and its entries, numbers as fractions."""

    kind: str
    name: str
    values: Mapping[str, Any] = field(default_factory=dict)

    @cached_property
    def ports(self) -> dict[str, str]:
        """Port to node, the one that defines the sign of the torque first."""
        if self.kind in SINGLE:
            return {"node": self.values["node"]}
        if self.kind in MEMBERS:
            return {member: self.values[member] for member in MEMBERS[self.kind]}
        first, second = self.values["nodes"]
        housing = self.values.get("housing")
        return {"first": first, "second": second} | ({"housing": housing} if housing else {})

    @property
    def internal(self) -> tuple[str, ...]:
        """Nodes inside a shaft of several segments."""
        return tuple(f"{self.name}.{i}" for i in range(1, self.values.get("segments", 1)))

    @property
    def is_rigid(self) -> bool:
        """Whether it holds its row at zero."""
        if self.kind in ("lock", "rigid_coupling", "differential"):
            return True
        return self.kind in ("gear", "planetary") and "stiffness" not in self.values

    @property
    def ratio(self) -> Fraction:
        """Of a gear or planetary set, from its teeth where these are given."""
        if "teeth" in self.values:
            return Fraction(self.values["teeth"][1], self.values["teeth"][0])
        return Fraction(self.values["ratio"])


@dataclass(frozen=True)
class Model:
    """A drivetrain: its parts and its inputs, name to (``torque`` or ``angle``, node)."""

    parts: tuple[Part, ...]
    inputs: Mapping[str, tuple[str, str]] = field(default_factory=dict)

    @cached_property
    def nodes(self) -> tuple[str, ...]:
        """All nodes, those inside shafts included."""
        found = dict.fromkeys(node for part in self.parts for node in (*part.ports.values(), *part.internal))
        return tuple(node for node in found if node != GROUND)

    @cached_property
    def imposed(self) -> dict[str, str]:
        """Input to node of every imposed angle."""
        return {name: node for name, (quantity, node) in self.inputs.items() if quantity == "angle"}


@dataclass(frozen=True)
class Reading:
    """A sensor: angle, velocity, acceleration of a node; twist of a part; torque of a part at one of its ports."""

    quantity: str
    of: str
    port: str = ""

    def __str__(self) -> str:
        return f"{self.quantity}({self.of}{', ' + self.port if self.port else ''})"
