"""Mean torques through all elements at one speed."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.assembly.functionals import functional
from torsionnet.core.errors import UsageError
from torsionnet.model.channels import Sensor
from torsionnet.model.elements import GROUND, Constraint, Element, Law, Values
from torsionnet.model.elements.shaft import Shaft
from torsionnet.model.load.external_torques import operating_speed, speed_ratios
from torsionnet.response.static_state import ElementLoad, StaticState
from torsionnet.solve.mean_response import external_torques, mean_response, undetermined


def static_state(drivetrain: AssembledModel, speed: float | None = None) -> StaticState:
    """See :meth:`torsionnet.Drivetrain.static_state`."""
    definition, values = drivetrain.definition, drivetrain.exact_values
    if speed is None and definition.load is not None:
        speed = abs(operating_speed(definition, values))
    asked = None if speed is None else [speed]
    reference, at, torques = external_torques(drivetrain, asked)
    ports = [(element, node) for element in drivetrain.elements.values() for node in _ports(element, values)]
    sensors, notes = _readable(drivetrain, ports)
    found = mean_response(drivetrain, sensors, asked)
    known = dict(zip(map(str, sensors), found.values[0].tolist(), strict=True))
    ratios = speed_ratios(definition, values, reference)
    loads = [_load(element, node, known, ratios.get(node), float(at[0]), values) for element, node in ports]
    external = {node: float(one[0]) for node, one in torques.items()}
    return StaticState(
        reference, float(at[0]), external, tuple(loads), drivetrain.title, (*found.notes, *dict.fromkeys(notes))
    )


def _ports(element: Element, values: object) -> list[str]:
    """The nodes at which an element hands on a mean torque; the second end of a spring has what the first one has."""
    parts = element.parts(Values(values))  # type: ignore[arg-type]
    if not any(isinstance(part, Constraint) or (isinstance(part, Law) and part.is_elastic) for part in parts):
        return []
    nodes = [node for node in element.ports.values() if node != GROUND]
    return nodes[:1] if element.glyph in ("spring", "shaft", "coupling", "clamp", "damper") else nodes


def _readable(drivetrain: AssembledModel, ports: Sequence[tuple[Element, str]]) -> tuple[list[Sensor], list[str]]:
    """The torques and twists that are determined, and why others are not."""
    sensors: list[Sensor] = []
    notes: list[str] = []
    for element, node in ports:
        first = node == next(iter(element.ports.values()))
        wanted = [Sensor("torque", element.name, None if first else node)]
        wanted += [Sensor("twist", element.name)] if first and element.glyph not in ("clamp", "gear") else []
        for sensor in wanted:
            try:
                read = functional(drivetrain, sensor)
            except UsageError as error:
                notes.append(str(error))
                continue
            if not undetermined(drivetrain, read):
                sensors.append(sensor)
    return sensors, notes


def _load(
    element: Element, node: str, known: dict[str, float], ratio: float | None, speed: float, values: object
) -> ElementLoad:
    first = node == next(iter(element.ports.values()))
    torque = known.get(str(Sensor("torque", element.name, None if first else node)))
    twist = known.get(str(Sensor("twist", element.name))) if first else None
    stress = None
    if isinstance(element, Shaft) and torque is not None:
        stress = torque / section_modulus(element, Values(values))  # type: ignore[arg-type]
    turning = None if ratio is None else ratio * speed
    return ElementLoad(element=element.name, port=node, speed=turning, torque=torque, twist=twist, stress=stress)


def section_modulus(shaft: Shaft, value: Values) -> float:
    """Torque over nominal shear stress at the surface, m^3."""
    outer, inner = float(value(shaft.outer_diameter)), float(value(shaft.inner_diameter))
    return float(np.pi / 16 * (outer**4 - inner**4) / outer) if outer else math.nan
