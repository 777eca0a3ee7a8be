"""Mean torques, twists and stresses of all elements of a drivetrain at one speed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.law_stiffness import functional
from torsionnet.machinery.mean.mean_solution import external_torques, mean_response, reason_undetermined
from torsionnet.machinery.mean.static_state import ElementLoad, PowerBalance, StaticState
from torsionnet.model.channels import Sensor
from torsionnet.model.element_base.round_section import section_fault
from torsionnet.model.elements import GROUND, Constraint, Element, Law, Values
from torsionnet.model.operating_values import law_notes


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
    found = mean_response(drivetrain, sensors, asked)
    known = dict(zip(map(str, sensors), found.values[0].tolist(), strict=True))
    loads = [_load(element, node, known, external.ratios.get(node), float(at[0])) for element, node in ports]
    acting = {node: float(one[0]) for node, one in torques.items()}
    said = tuple(dict.fromkeys((*found.notes, *law_notes(drivetrain.definition), *notes)))
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


# Balance of the mean powers of a drivetrain at one speed.


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
    >>> found = tn.load("bulk_carrier").power_balance()
    >>> round(found.given / 1e3, 6), round(found.taken / 1e3, 6), round(found.torque / 1e3, 2)  # kW, kN*m
    (7000.0, 7000.0, 636.62)
    """
    state = static_state(drivetrain, speed)
    ratios = drivetrain.external_torques.ratios
    # P = T i Omega with the speed of each node, i its ratio to the reference.
    powers = {node: torque * ratios.get(node, 0.0) * state.speed for node, torque in state.external.items()}
    return PowerBalance(state, powers)
