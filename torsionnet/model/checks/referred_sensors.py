"""Check of sensors that are referred to a shaft to which no gear ratio leads."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from torsionnet.base.errors import Fault, UsageError, message_of
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.model.channels import Sensor
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.elements import Values
from torsionnet.model.readings import referring_factor


def unreachable_shafts(definition: Definition, values: Mapping[str, Any]) -> list[Fault]:
    """Faults of sensors whose readings cannot be referred to the shaft they name.

    Those that are switched off are left out.
    """
    referred = {name: sensor for name, sensor in definition.sensors.items() if sensor.referred_to is not None}
    elements = {element.name: element for element in definition.active}
    nodes = all_nodes(definition.active)
    faults = []
    for name, sensor in referred.items():
        if _is_on(sensor, elements, nodes):
            try:
                referring_factor(sensor, elements, Values(values))
            except UsageError as error:
                text = phrase("{}: {}", ModelName(name), message_of(error))
                faults.append(Fault(text, ("sensors", name, "referred_to"), kind="no-ratio"))
    return faults


def _is_on(sensor: Sensor, elements: Mapping[str, Any], nodes: Collection[str]) -> bool:
    return sensor.of in elements if sensor.is_on_element else all(node in nodes for node in sensor.nodes)
