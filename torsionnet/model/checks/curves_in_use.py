"""Checks of what is read off a curve of an element, at the working point and over the speeds of a model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from torsionnet.core.errors import Fault, Path
from torsionnet.core.units import RPM
from torsionnet.model.definition import Definition
from torsionnet.model.element_base.curves import OnCurve
from torsionnet.model.load.external_torques import ExternalTorques
from torsionnet.model.operating_values import OperatingPoints, operated
from torsionnet.model.parameters import resolve


def beyond_curves(external: ExternalTorques) -> list[Fault]:
    """Working points that leave the rows of a curve, also within the range of speeds; one fault for each entry."""
    faults: dict[Path, Fault] = {}
    for where, values in _working_points(external):
        for path, what in _beyond(external.definition, values):
            faults.setdefault(path, Fault(where + what, path))
    return list(faults.values())


def _working_points(external: ExternalTorques) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """In words where it is, and the values of the parameters there."""
    definition = external.definition
    if not definition.following:
        yield "", external.values
        return
    points = OperatingPoints(external)
    speeds = [external.operating_speed]
    if definition.speeds is not None and (definition.load or not definition.operating_point.torque):
        speeds += [definition.speeds.values[0], definition.speeds.values[-1]]
    for speed in speeds:
        values = resolve(operated(definition, points.at(speed)).parameters)[0]
        yield f"with {external.reference} at {speed * RPM:.6g} rpm, ", values


def _beyond(definition: Definition, values: Mapping[str, Any]) -> Iterator[tuple[Path, str]]:
    for element in (one for one in definition.active if one.reads_off):
        for path, spec, expression, _ in element.expressions():
            if isinstance(spec, OnCurve):
                reason = spec.curve_fault(float(expression.evaluate(values)))
                if reason:
                    yield ("elements", element.name, *path), f"{expression} {reason}"
