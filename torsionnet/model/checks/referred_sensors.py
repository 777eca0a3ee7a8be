"""Check of sensors that are referred to a shaft to which no gear ratio leads."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from torsionnet.core.errors import Fault, UsageError
from torsionnet.model.channels import Sensor
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.elements import Values


def unreachable_shafts(definition: Definition, values: Mapping[str, Any]) -> list[Fault]:
    """Faults of sensors whose readings cannot be referred to the shaft they name.

    Those that are switched off are left out.
    """
    referred = {name: sensor for name, sensor in definition.sensors.items() if sensor.referred_to is not None}
    if not referred:
        return []
    from torsionnet.model.readings import referring_factor

    elements = {element.name: element for element in definition.active}
    nodes = all_nodes(definition.active)
    faults = []
    for name, sensor in referred.items():
        if _is_on(sensor, elements, nodes):
            try:
                referring_factor(sensor, elements, Values(values))
            except UsageError as error:
                faults.append(Fault(f"{name}: {error}", ("sensors", name, "referred_to")))
    return faults


def _is_on(sensor: Sensor, elements: Mapping[str, Any], nodes: Collection[str]) -> bool:
    return sensor.of in elements if sensor.is_on_element else all(node in nodes for node in sensor.nodes)
