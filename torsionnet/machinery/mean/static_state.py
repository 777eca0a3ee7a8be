"""Mean torque, twist, stress and power (SI) of every element at one speed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.packages import NotebookResult
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.base.units import RPM


@dataclass(frozen=True, kw_only=True)
class ElementLoad:
    """Mean speed (rad/s), torque (N m), twist (rad) and stress (N/m^2) of an element at one of its ports.

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

    element: Annotated[str, Out("element")]
    port: Annotated[str, Out("at")]
    speed: Annotated[float | None, Out("speed", "rpm", factor=RPM)]
    torque: Annotated[float | None, Out("torque", "N*m")]
    twist: Annotated[float | None, Out("twist", "rad")] = None
    stress: Annotated[float | None, Out("stress", "Pa")] = None

    @property
    def power(self) -> Annotated[float | None, Out("power", "kW", factor=1e-3, after="stress")]:
        """Mean power in W at a port of an element, into it at its first port, out of it at the others."""
        return None if self.torque is None or self.speed is None else self.torque * self.speed


@dataclass(frozen=True)
class ExternalTorque:
    """Mean torque in N m that acts on a node from outside."""

    node: str
    torque: float


@dataclass(frozen=True, repr=False)
class StaticState(NotebookResult):
    """Static state of a drivetrain, mean torque, twist, stress and power (SI) of every element at one speed.

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
    configuration : str
    """

    SHOWN: ClassVar = ("configuration", "title", "reference", "rpm", "external_torques", "loads", "notes")

    reference: Annotated[str, Out(json="speed_of")]
    speed: float
    external: Mapping[str, float]
    loads: Annotated[tuple[ElementLoad, ...], Out(json="elements")]
    title: str = ""
    notes: tuple[str, ...] = ()
    configuration: str = ""

    @property
    def rpm(self) -> Annotated[float, Out(json="speed_rpm")]:
        """Speed of the reference node in r/min."""
        return self.speed * RPM

    @property
    def external_torques(self) -> Annotated[tuple[ExternalTorque, ...], Out(json="external")]:
        """Mean torques in N m from outside, each with its node."""
        return tuple(ExternalTorque(node, torque) for node, torque in self.external.items())

    def of(self, element: str) -> ElementLoad:
        """Mean speed, torque, twist and stress (SI) of an element, by its name, at its first port."""
        return next(one for one in self.loads if one.element == element)

    def table(self, conventions: Conventions = SI) -> Table:
        """Table of mean speed, torque, twist, stress and power with a row for each element and port."""
        acting = ", ".join(f"{node} {torque:.6g} N*m" for node, torque in self.external.items())
        notes = (
            f"{self.reference} at {self.rpm:.6g} rpm; from outside: {acting}",
            "torque: into the element at its first node, out of it at the others, signs of the nodes; power likewise",
            *self.notes,
        )
        return result_table(
            f"{self.title}: mean torques", self.loads, ElementLoad, conventions=conventions, notes=notes
        )


# Balance of the mean powers of a drivetrain at one speed: what drivers give, absorbers take and elements pass on.


@dataclass(frozen=True, eq=False)
class PowerBalance:
    """Mean power in W from outside into each node at one speed, above zero where it drives, else below zero.

    Attributes
    ----------
    state : StaticState
        Mean torques of the elements at this speed.
    powers : mapping of str to float
        By node, power from outside in W: above zero where it drives, below zero where it is taken.
    """

    state: StaticState
    powers: Mapping[str, float]

    @property
    def given(self) -> float:
        """Sum of the powers of all drivers in W."""
        return sum(max(power, 0.0) for power in self.powers.values())

    @property
    def taken(self) -> float:
        """Sum of the powers of all absorbers in W, a positive number."""
        return -sum(min(power, 0.0) for power in self.powers.values())

    @property
    def torque(self) -> float:
        """Torque T = P/omega in N m that all absorbed power P would have at the speed of the reference shaft."""
        return self.taken / abs(self.state.speed)

    @property
    def largest_loss(self) -> float:
        """Largest difference in W between the power into an element at its first port and out of it at other ports.

        Zero but for rounding, as gears and shafts pass on what they get; 0 without elements of several ports.
        """
        balance: dict[str, float] = {}
        ports: dict[str, int] = {}
        for load in self.state.loads:
            power = load.power or 0.0
            balance[load.element] = balance.get(load.element, 0.0) + (-power if load.element in ports else power)
            ports[load.element] = ports.get(load.element, 0) + 1
        return max((abs(rest) for name, rest in balance.items() if ports[name] > 1), default=0.0)
