"""Power that vibration dissipates in elements: torque times rate, summed over frequencies.

Power is quadratic: orders of one frequency are added as complex amplitudes first, then every frequency gives its own
mean power. Where an element is one law on its twist, rate means that of the twist, which no difference of large angles
is taken for. Else it is what flows in at one port and does not flow out at the others.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.core.errors import UsageError, did_you_mean
from torsionnet.model.channels import Sensor
from torsionnet.model.elements import GROUND, Element, Law, Values
from torsionnet.response.dissipated_power import DissipatedPower
from torsionnet.response.frequency_response import FloatArray
from torsionnet.response.order_response import OrderResponse
from torsionnet.solve.order_response import order_response


@dataclass(frozen=True)
class PowerFlow:
    """A torque, the motion it goes with, and +1 for power into the element, -1 for power out of it."""

    torque: Sensor
    motion: Sensor
    sign: int


def dissipated_power(
    drivetrain: AssembledModel,
    elements: str | Iterable[str],
    *,
    speeds: ArrayLike | None = None,
    speed_of: str | None = None,
    excitations: Iterable[str] | None = None,
) -> DissipatedPower:
    """See :meth:`torsionnet.Drivetrain.dissipated_power`."""
    names = [elements] if isinstance(elements, str) else list(elements)
    for name in names:
        if name not in drivetrain.elements:
            raise UsageError(f'no element is named "{name}"{did_you_mean(name, drivetrain.elements)}')
    flows = {name: power_flows(drivetrain, drivetrain.elements[name]) for name in names}
    outputs = list(dict.fromkeys(sensor for flow in flows.values() for sensor in power_sensors(flow)))
    run = order_response(drivetrain, outputs, speeds=speeds, speed_of=speed_of, excitations=excitations)
    values = np.stack([mean_power(run, flow) for flow in flows.values()], axis=1)
    return DissipatedPower(run.speeds, run.reference, tuple(names), values, run.title)


def power_flows(drivetrain: AssembledModel, element: Element) -> tuple[PowerFlow, ...]:
    """Through which torques and motions power flows into an element."""
    parts = element.parts(Values(drivetrain.exact_values))
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
    """W over speed, shape (n_speeds,), from a response that has these sensors among its outputs."""
    rates = replace(run, values=run.values * (2j * math.pi * run.frequencies)[:, :, None]).by_frequency()
    amplitudes = run.by_frequency()
    total = np.zeros(len(run.speeds))
    for flow in flows:
        torque, rate = (run.output(str(sensor)) for sensor in (flow.torque, flow.motion))
        power = amplitudes[:, :, torque] * rates[:, :, rate].conj()
        total += flow.sign * power.real.sum(axis=1) / 2
    return total
