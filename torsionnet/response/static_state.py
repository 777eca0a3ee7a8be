"""Mean torque, twist, stress and power of every element at one speed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from torsionnet.core.entries.spec import Json
from torsionnet.core.units import RPM
from torsionnet.response.conventions import SI, Conventions
from torsionnet.response.table import Column, Table


@dataclass(frozen=True, kw_only=True)
class ElementLoad:
    """What an element carries at one of its ports.

    Attributes
    ----------
    element, port : str
        ``port`` is the node there.
    speed : float or None
        Of that node, rad/s, positive like the angle; None where nothing determines it.
    torque : float or None
        N m, as the sensor ``torque(element, port)`` reads it; None where it is statically indeterminate.
    twist : float or None
        rad; at the first port of what has stiffness.
    stress : float or None
        Nominal shear stress in N/m^2; at the first port of a shaft with diameters.
    """

    element: str
    port: str
    speed: float | None
    torque: float | None
    twist: float | None = None
    stress: float | None = None

    @property
    def power(self) -> float | None:
        """Torque times speed in W: into the element at its first port, out of it at the others."""
        return None if self.torque is None or self.speed is None else self.torque * self.speed


@dataclass(frozen=True)
class StaticState:
    """A drivetrain under its mean torques.

    Attributes
    ----------
    reference : str
        The node whose speed is given.
    speed : float
        rad/s.
    external : mapping
        Node -> mean torque from outside, N m.
    loads : tuple of ElementLoad
    title : str
    notes : tuple of str
    """

    reference: str
    speed: float
    external: Mapping[str, float]
    loads: tuple[ElementLoad, ...]
    title: str = ""
    notes: tuple[str, ...] = ()

    def of(self, element: str) -> ElementLoad:
        """What an element carries at its first port."""
        return next(one for one in self.loads if one.element == element)

    def table(self, conventions: Conventions = SI) -> Table:
        """One row an element and port."""
        columns = (
            Column("element"),
            Column("at"),
            Column("speed", "rpm"),
            Column("torque", "N*m"),
            Column("twist", conventions.unit("rad")),
            Column("stress", "N/mm^2"),
            Column("power", "kW"),
        )
        scale = conventions.scale("rad")
        rows = tuple(
            (
                one.element,
                one.port,
                _times(one.speed, RPM),
                one.torque,
                _times(one.twist, scale),
                _times(one.stress, 1e-6),
                _times(one.power, 1e-3),
            )
            for one in self.loads
        )
        acting = ", ".join(f"{node} {torque:.6g} N*m" for node, torque in self.external.items())
        notes = (
            f"{self.reference} at {self.speed * RPM:.6g} rpm; from outside: {acting}",
            "torque: into the element at its first node, out of it at the others, signs of the nodes; power likewise",
            *self.notes,
        )
        return Table(f"{self.title}: mean torques", columns, rows, notes)

    def to_data(self) -> dict[str, Json]:
        """Plain values in SI."""
        names = ("element", "port", "speed", "torque", "twist", "stress", "power")
        return {
            "title": self.title,
            "speed_of": self.reference,
            "speed_rpm": self.speed * RPM,
            "external": [{"node": node, "torque": torque} for node, torque in self.external.items()],
            "elements": [{name: getattr(one, name) for name in names} for one in self.loads],
            "notes": list(self.notes),
        }


def _times(value: float | None, factor: float) -> float | None:
    return None if value is None else value * factor
