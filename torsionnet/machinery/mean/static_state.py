"""Static state of a drivetrain at one speed, torque, twist, stress and power (SI), and what vibration dissipates.

Mean power in W that vibration dissipates in elements, as torque times rate summed over frequencies.

Power is quadratic: orders of one frequency are added as complex amplitudes first, then the mean powers of all
frequencies are added.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.packages import SavedResult
from torsionnet.base.phrases import phrase
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table, result_table
from torsionnet.base.units import RPM
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.law_stiffness import functional
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.mean.mean_solution import external_torques, mean_response, reason_undetermined
from torsionnet.machinery.mean.power_flow import mean_power, power_flows, power_sensors
from torsionnet.machinery.orders.order_solution import orders_at_speeds
from torsionnet.model.channels import Sensor
from torsionnet.model.element_base.round_section import section_fault
from torsionnet.model.elements import GROUND, Constraint, Element, Law, Values
from torsionnet.model.operating_values import law_notes

# Static state of a drivetrain at one speed, mean torque, twist, stress and power (SI) of every element.

SIGNS = phrase(
    "torque: into the element at its first node, out of it at the others, signs of the nodes; power likewise"
)
"""Note on the signs of mean torques."""


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
class StaticState(SavedResult):
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
        return next(load for load in self.loads if load.element == element)

    def table(self, conventions: Conventions = SI) -> Table:
        """Table of mean speed, torque, twist, stress and power with a row for each element and port."""
        acting = ", ".join(f"{node} {torque:.6g} N*m" for node, torque in self.external.items())
        notes = (
            phrase(
                "{node} at {speed:.6g} rpm; from outside: {torques}",
                node=self.reference,
                speed=self.rpm,
                torques=acting,
            ),
            SIGNS,
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


# The static state as what the mean response has at one speed.


def static_state(drivetrain: AssembledModel, speed: float | None = None) -> StaticState:
    """Mean torque, twist, nominal shear stress and power of every element at one speed.

    Parameters
    ----------
    speed : float, optional
        rad/s, of the node of the model's ``speeds:``; default: that of the operating point, else the rated one.

    Raises
    ------
    UsageError
        As for :meth:`mean_response`.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("engine", node="e", inertia=2), tn.Inertia("screw", node="p", inertia=1),
    ...     tn.Shaft("shaft", nodes=("e", "p"), outer_diameter="50 mm", length="2 m")]
    >>> boat = tn.Drivetrain("boat", elements, speeds={"of": "e", "list": [100], "rated": 100},
    ...     load={"absorbed_at": "p", "power": "100 kW", "torque_exponent": 2, "driven_by": {"e": 1}})
    >>> shaft = boat.static_state().of("shaft")
    >>> round(shaft.torque, 6), round(shaft.stress / 1e6, 3)
    (1000.0, 40.744)
    """
    values = drivetrain.exact_values
    external = drivetrain.external_torques
    if speed is None and drivetrain.definition.load is not None:
        speed = external.operating_speed
    asked = None if speed is None else [speed]
    reference, at, torques = external_torques(drivetrain, asked)
    ports = [(element, node) for element in drivetrain.elements.values() for node in _ports(element, values)]
    sensors, notes = _readable(drivetrain, ports)
    means = mean_response(drivetrain, sensors, asked)
    known = dict(zip(map(str, sensors), means.values[0].tolist(), strict=True))
    loads = [_load(element, node, known, external.ratios.get(node), float(at[0])) for element, node in ports]
    acting = {node: float(torque[0]) for node, torque in torques.items()}
    said = tuple(dict.fromkeys((*means.notes, *law_notes(drivetrain.definition), *notes)))
    return StaticState(reference, float(at[0]), acting, tuple(loads), drivetrain.title, said, drivetrain.configuration)


def _ports(element: Element, values: Mapping[str, Any]) -> list[str]:
    """Nodes at which an element passes on a mean torque, of a spring the first end only.

    The torque at its second end is the same.
    """
    parts = element.parts(Values(values))
    # Dampers pass no mean torque: only springs and rigid links have one.
    if not any(isinstance(part, Constraint) or (isinstance(part, Law) and part.is_elastic) for part in parts):
        return []
    nodes = [node for node in element.ports.values() if node != GROUND]
    return (
        nodes[:1]
        if element.glyph in ("spring", "shaft", "coupling", "clamp", "damper", "clearance", "friction")
        else nodes
    )


def _readable(drivetrain: AssembledModel, ports: Sequence[tuple[Element, str]]) -> tuple[list[Sensor], list[str]]:
    """Sensors of torque, twist and stress that mean torques determine, and notes on those that they do not."""
    sensors: list[Sensor] = []
    notes: list[str] = []
    for element, node in ports:
        first = node == next(iter(element.ports.values()))
        wanted = [Sensor("torque", element.name, None if first else node)]
        wanted += [Sensor("twist", element.name)] if first and element.glyph not in ("clamp", "gear") else []
        wanted += [Sensor("stress", element.name)] if first and section_fault(element) is None else []
        for sensor in wanted:
            try:
                read = functional(drivetrain, sensor)
            except UsageError as error:
                notes.append(str(error))
                continue
            if not reason_undetermined(drivetrain, read):
                sensors.append(sensor)
    return sensors, notes


def _load(element: Element, node: str, known: Mapping[str, float], ratio: float | None, speed: float) -> ElementLoad:
    first = node == next(iter(element.ports.values()))
    torque = known.get(str(Sensor("torque", element.name, None if first else node)))
    twist = known.get(str(Sensor("twist", element.name))) if first else None
    stress = known.get(str(Sensor("stress", element.name))) if first else None
    turning = None if ratio is None else ratio * speed
    return ElementLoad(element=element.name, port=node, speed=turning, torque=torque, twist=twist, stress=stress)


# The balance of powers from the torques of a static state.


def power_balance(drivetrain: AssembledModel, speed: float | None = None) -> PowerBalance:
    """Powers that drivers give and absorbers take at one speed, with the mean torques between them.

    Parameters
    ----------
    speed : float, optional
        rad/s, of the node of the model's ``speeds:``; default: as for :meth:`static_state`.

    Raises
    ------
    UsageError
        As for :meth:`mean_response`.

    Examples
    --------
    >>> import torsionnet as tn
    >>> balance = tn.load("bulk_carrier").power_balance()
    >>> round(balance.given / 1e3, 6), round(balance.taken / 1e3, 6), round(balance.torque / 1e3, 2)  # kW, kN*m
    (7000.0, 7000.0, 636.62)
    """
    state = static_state(drivetrain, speed)
    ratios = drivetrain.external_torques.ratios
    # P = T i Omega with the speed of each node, i its ratio to the reference.
    powers = {node: torque * ratios.get(node, 0.0) * state.speed for node, torque in state.external.items()}
    return PowerBalance(state, powers)


# Mean power in W that vibration dissipates in elements, as torque times rate summed over frequencies.

# Mean power that the vibration of running machinery dissipates, by speed and element.

FORMULA = "P = sum over frequencies of Re(T conj(dgamma/dt))/2, T the whole torque of the element, elastic and damping"


@dataclass(frozen=True, eq=False, repr=False)
class DissipatedPower(SavedResult):
    """Mean power in W that the vibration of running machinery dissipates, by speed and element.

    Attributes
    ----------
    speeds : (n_speeds,) array
        Speeds of the reference shaft, rad/s.
    reference : str
        Node of the reference shaft.
    elements : tuple of str
    values : (n_speeds, n_elements) array
        Mean power, W.
    title : str
        Name of the model with its configuration.
    """

    speeds: FloatArray
    reference: str
    elements: tuple[str, ...]
    values: FloatArray
    title: str = ""

    @property
    def rpm(self) -> FloatArray:
        """Speeds of the reference shaft in r/min, shape (n_speeds,)."""
        return np.asarray(self.speeds * RPM)

    def of(self, element: str) -> FloatArray:
        """Mean power that an element dissipates over speed in W, shape (n_speeds,).

        Raises
        ------
        UsageError
            No power of this element was calculated.
        """
        if element not in self.elements:
            hint = did_you_mean(element, self.elements)
            raise UsageError(
                f'no power of "{element}"{hint}; there is {", ".join(self.elements)}', kind="unknown-element"
            )
        return np.asarray(self.values[:, self.elements.index(element)])

    def table(self) -> Table:
        """Table of dissipated power in W with a row for each speed in rpm and a column for each element."""
        columns = (Column("speed", "rpm"), *(Column(name, "W") for name in self.elements))
        rows = tuple((rpm, *row) for rpm, row in zip(self.rpm.tolist(), self.values.tolist(), strict=True))
        notes = (f"speeds of {self.reference}; {FORMULA}", "heat of a steady slip is not in it")
        return Table(f"{self.title}: dissipated power", columns, rows, notes)


def dissipated_power(
    drivetrain: AssembledModel,
    elements: str | Iterable[str],
    *,
    speeds: ArrayLike | None = None,
    speed_of: str | None = None,
    excitation: str | Iterable[str] | None = None,
) -> DissipatedPower:
    """Mean power in W that vibration dissipates in elements, over speed.

    P = sum over frequencies of Re(T conj(dgamma/dt))/2: orders of one frequency are added as complex amplitudes
    first. T is the whole torque of the element, with its elastic and its damping part. Heat of a steady slip
    (a damper to ground in a turning machine) is not in it.

    Parameters
    ----------
    elements : str or iterable of str
        Springs, dampers, shafts, viscous dampers, compliant gears, ...
    speeds, speed_of, excitations
        As for :meth:`order_response`.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=2),
    ...     tn.HystereticSpring("rubber", nodes=("a", "ground"), stiffness=1e4, loss_factor=0.2)]
    >>> fan = tn.Drivetrain("fan", elements, speeds={"of": "a", "list": ["600 rpm"]},
    ...     excitations={"blades": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": "10 N*m"}}}})
    >>> twist = abs(fan.order_response("twist(rubber)").values[0, 0, 0])
    >>> w = 600 * 6.283185307179586 / 60
    >>> bool(abs(fan.dissipated_power("rubber").values[0, 0] - w * 0.2 * 1e4 * twist**2 / 2) < 1e-12)
    True
    """
    names = [elements] if isinstance(elements, str) else list(elements)
    for name in names:
        if name not in drivetrain.elements:
            raise UsageError(
                f'no element is named "{name}"{did_you_mean(name, drivetrain.elements)}', kind="unknown-element"
            )
    values = Values(drivetrain.exact_values)
    flows = {name: power_flows(drivetrain.elements[name], values) for name in names}
    outputs = list(dict.fromkeys(sensor for flow in flows.values() for sensor in power_sensors(flow)))
    run = orders_at_speeds(drivetrain, outputs, speeds=speeds, speed_of=speed_of, excitations=excitation)
    power = np.stack([mean_power(run, flow) for flow in flows.values()], axis=1)
    return DissipatedPower(run.speeds, run.reference, tuple(names), power, run.title)
