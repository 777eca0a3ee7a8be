"""Through which torques and motions power flows into an element, and the mean power of a vibration from them."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.core.errors import TorsionnetWarning
from torsionnet.model.channels import Sensor
from torsionnet.model.elements import GROUND, Element, Law, Values
from torsionnet.response.frequency_response import FloatArray
from torsionnet.response.order_response import OrderResponse
from torsionnet.response.worst_response import WorstResponse


@dataclass(frozen=True)
class PowerFlow:
    """A torque, the motion it goes with, and +1 for power into the element, -1 for power out of it."""

    torque: Sensor
    motion: Sensor
    sign: int


def power_flows(element: Element, values: Values) -> tuple[PowerFlow, ...]:
    """The torque on the twist where an element is one law on that; else those at its ports.

    The rate of a twist is no difference of the rates of large angles, which would lose digits.
    """
    parts = element.parts(values)
    name = element.name
    if len(parts) == 1 and isinstance(parts[0], Law):
        return (PowerFlow(Sensor("torque", name), Sensor("twist", name), 1),)
    return tuple(
        PowerFlow(Sensor("torque", name, port), Sensor("angle", node), -1 if place else 1)
        for place, (port, node) in enumerate(element.ports.items())
        if node != GROUND
    )


def power_sensors(flows: Sequence[PowerFlow]) -> list[Sensor]:
    """What has to be measured for it."""
    return [sensor for flow in flows for sensor in (flow.torque, flow.motion)]


def mean_power(run: OrderResponse, flows: Sequence[PowerFlow]) -> FloatArray:
    """W over speed, shape (n_speeds,), the largest of all cases; these sensors are among the outputs."""
    if isinstance(run, WorstResponse) and run.scattered:
        text = f"{run.title}: dissipated power is that without the spread of cylinders"
        warnings.warn(text, TorsionnetWarning, stacklevel=2)
    return np.asarray(np.max([_mean_power(case, flows) for case in run.coherent], axis=0))


def _mean_power(run: OrderResponse, flows: Sequence[PowerFlow]) -> FloatArray:
    rates = replace(run, values=run.values * (2j * math.pi * run.frequencies)[:, :, None]).by_frequency()
    amplitudes = run.by_frequency()
    total = np.zeros(len(run.speeds))
    for flow in flows:
        torque, rate = (run.output(str(sensor)) for sensor in (flow.torque, flow.motion))
        power = amplitudes[:, :, torque] * rates[:, :, rate].conj()
        total += flow.sign * power.real.sum(axis=1) / 2
    return total
