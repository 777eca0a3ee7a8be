"""Speeds that elements state for themselves beside those that the load or operating point gives their nodes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from torsionnet.core.errors import Fault, UsageError
from torsionnet.core.expressions import Expression
from torsionnet.core.units import RPM
from torsionnet.model.element_base.element import Element
from torsionnet.model.load.external_torques import ExternalTorques
from torsionnet.model.operating_values import OperatingPoints, operated
from torsionnet.model.parameters import resolve

ENTRY, OF_SPEED = "speed", 0.005
"""The entry of an element for the speed of its first node, and the share by which the two may differ."""


def unlike_working_speeds(external: ExternalTorques) -> Iterator[Fault]:
    """Warnings about elements that are calculated at another speed than the load or the operating point gives them."""
    stated = [(one, speed) for one in external.definition.active if (speed := _stated(one))]
    turning = _speeds(external) if stated else {}
    values = _values(external) if turning else {}
    for element, speed in stated if turning else ():
        own, expected = abs(float(speed.evaluate(values))), _turning(element, turning)
        if expected and abs(own - expected) > OF_SPEED * expected:
            reference = external.reference
            where = f" with {reference} at {abs(turning[reference]) * RPM:.6g} rpm" if reference in turning else ""
            text = f"{element.name} is calculated at {own * RPM:.6g} rpm, but turns at {expected * RPM:.6g} rpm{where}"
            yield Fault(text, ("elements", element.name, ENTRY), "warning")


def _speeds(external: ExternalTorques) -> dict[str, float]:
    """Speed in rad/s of nodes about which the model is linear; empty where nothing says one."""
    if external.mean_speeds or not external.definition.load:
        return external.mean_speeds
    try:
        reference = external.operating_speed
    except UsageError:
        return {}
    return {node: ratio * reference for node, ratio in external.ratios.items()}


def _stated(element: Element) -> Expression | None:
    if ENTRY not in dict(element.specs()):
        return None
    found = element.expressions()
    return next((one for path, _, one, dimension in found if path == (ENTRY,) and dimension == ENTRY), None)


def _values(external: ExternalTorques) -> Mapping[str, Any]:
    """Of the parameters, those that follow the operating point at its own speed."""
    definition = external.definition
    if not definition.following:
        return external.values
    at = OperatingPoints(external).at(external.operating_speed)
    return resolve(operated(definition, at).parameters)[0]


def _turning(element: Element, speeds: dict[str, float]) -> float:
    """Speed of its first node in rad/s against its housing, if it has one that turns; 0 where that is not known."""
    housing = getattr(element, "housing", None)
    node = next(iter(element.ports.values()))
    return abs(speeds.get(node, 0.0) - speeds.get(housing, 0.0)) if housing else abs(speeds.get(node, 0.0))
