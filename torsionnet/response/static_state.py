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
    """Mean load of an element at one of its ports: speed, torque, twist, stress.

    Attributes
    ----------
    element, port : str
        Name of the element, and the node of the port.
    speed : float or None
        Speed of that node, rad/s, positive like the angle; None where it is undetermined.
    torque : float or None
        Torque in N m, as by the sensor ``torque(element, port)``; None where it is statically indeterminate.
    twist : float or None
        Twist in rad; at the first port of elements with stiffness.
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
        """Power in W, torque times speed: into the element at its first port, out of it at the others."""
        return None if self.torque is None or self.speed is None else self.torque * self.speed


@dataclass(frozen=True)
class StaticState:
    """Static state of a drivetrain: mean torque, twist, stress and power of every element at one speed.

    Attributes
    ----------
    reference : str
        Node whose speed is given.
    speed : float
        Speed of that node, rad/s.
    external : mapping
        By node, mean torque from outside, N m.
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
        """Mean load of an element at its first port."""
        return next(one for one in self.loads if one.element == element)

    def table(self, conventions: Conventions = SI) -> Table:
        """Table with a row for each element and port."""
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
        """Static state as plain data in SI."""
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
