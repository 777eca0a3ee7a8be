"""What rules judge by: the responses of one condition over speed, and what the model says about its elements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from torsionnet.model.channels import Sensor
from torsionnet.model.definition import Definition
from torsionnet.model.elements import GROUND, Element, Values
from torsionnet.model.power_flow import mean_power, power_flows
from torsionnet.response.frequency_response import FloatArray
from torsionnet.response.order_response import OrderResponse


@dataclass(frozen=True, eq=False)
class Evidence:
    """Responses of one condition.

    Attributes
    ----------
    run : OrderResponse
        With all that the rules of the model want to see.
    means : mapping
        Sensor -> (n_speeds,) mean values; those that are not known are missing.
    why_no_mean : str
        Why they are.
    definition : Definition
        In this condition.
    values : mapping
        Exact value of every parameter.
    """

    run: OrderResponse
    means: Mapping[Sensor, FloatArray]
    why_no_mean: str
    definition: Definition
    values: Mapping[str, Any]

    @property
    def speeds(self) -> FloatArray:
        """Of the reference shaft, rad/s."""
        return self.run.speeds

    @property
    def rated(self) -> float | None:
        """Rated speed of the reference shaft, rad/s."""
        return None if self.definition.speeds is None else self.definition.speeds.rated

    @cached_property
    def active(self) -> Mapping[str, Element]:
        """Elements that are switched on, by name."""
        return {element.name: element for element in self.definition.active}

    @property
    def misfiring(self) -> bool:
        """Whether a cylinder does not fire in this condition."""
        return is_misfiring(self.definition)

    def size(self, sensors: Sequence[Sensor]) -> FloatArray:
        """Half range of the sum of all orders over speed, the largest of the sensors."""
        return np.asarray(np.max([self.run.half_range[:, self._place(sensor)] for sensor in sensors], axis=0))

    def orders(self, sensors: Sequence[Sensor]) -> FloatArray:
        """Amplitudes (n_speeds, n_lines), of every order the largest of the sensors."""
        return np.asarray(np.max([self.run.sizes[:, :, self._place(one)] for one in sensors], axis=0))

    def weighted_size(self, sensor: Sensor, weights: FloatArray) -> FloatArray:
        """Half range of the sum with every line multiplied by a weight (n_speeds, n_lines)."""
        place = self._place(sensor)
        values = self.run.values[:, :, place : place + 1] * weights[:, :, None]
        return replace(self.run, values=values, outputs=(self.run.outputs[place],)).half_range[:, 0]

    def mean(self, sensor: Sensor) -> FloatArray | None:
        """Mean value over speed; None where it is not known."""
        return self.means.get(sensor)

    def power(self, element: str) -> FloatArray:
        """Mean power in W that vibration dissipates in an element, over speed."""
        return mean_power(self.run, power_flows(self.active[element], Values(self.values)))

    def _place(self, sensor: Sensor) -> int:
        return self.run.output(str(sensor))


def torques_of(element: Element) -> list[Sensor]:
    """The torque at every port that is no ground; at one of them where nothing in between takes any."""
    ports = [port for port, node in element.ports.items() if node != GROUND]
    if element.diameters is None or len(ports) < 2:
        return [Sensor("torque", element.name)]
    return [Sensor("torque", element.name, port) for port in ports]


def is_misfiring(definition: Definition) -> bool:
    """Whether a cylinder of an engine does not fire."""
    from torsionnet.model.excitations.reciprocating_engine import ReciprocatingEngine

    engines = (one for one in definition.excitations.values() if isinstance(one, ReciprocatingEngine))
    return any(bool(engine.misfire) or bool(engine.gas_off) for engine in engines)
