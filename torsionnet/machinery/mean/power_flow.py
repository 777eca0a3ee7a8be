"""Torque and motion sensors through which power flows into an element, and the mean power of a vibration."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.base.errors import warn_user
from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.machinery.orders.order_line import OrderLine, engine_blocks
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.synthesis import common_cycle, cycle_extremes
from torsionnet.machinery.orders.worst_response import WorstResponse
from torsionnet.model.channels import Sensor
from torsionnet.model.elements import GROUND, Element, Law, Values


@dataclass(frozen=True)
class PowerFlow:
    """Torque sensor, motion sensor and sign of a power flow into an element: +1 into the element, -1 out of it."""

    torque: Sensor
    motion: Sensor
    sign: int


def power_flows(element: Element, values: Values) -> tuple[PowerFlow, ...]:
    """Power flows into an element, one for each port or one for its twist.

    Torque on its twist if that is its only law, else torque and motion at each port.

    The rate of a twist is used because the difference of the rates of large angles would lose digits.
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
    """Torque sensors, and angle or twist sensors, that power flows need."""
    return [sensor for flow in flows for sensor in (flow.torque, flow.motion)]


def mean_power(run: OrderResponse, flows: Sequence[PowerFlow]) -> FloatArray:
    """Mean power of a vibration in W over speed, shape (n_speeds,), the largest of all cases.

    Needs the sensors as outputs.
    """
    if isinstance(run, WorstResponse) and run.scattered:
        text = f"{run.title}: dissipated power is that without the spread of cylinders"
        warn_user(text)
    return np.asarray(np.max([_mean_power(case, flows) for case in run.case_responses], axis=0))


def _mean_power(run: OrderResponse, flows: Sequence[PowerFlow]) -> FloatArray:
    """Mean power in W of a case over speed, shape (n_speeds,), with engines of unknown crank angle at the worst angle.

    Power is that of each engine alone and that which every two of them make together, a sum of waves over the angle
    between them. Of more than two the largest values of all pairs are added.
    """
    engines = [_only(run, block.places) for block in engine_blocks(run.lines)]
    total = sum(_power_between(engine, engine, flows).real.sum(axis=1) / 2 for engine in engines)
    for engine, other in itertools.combinations(engines, 2):
        # Delaying one engine turns this product and that of the reverse the other way: with one conjugate they are
        # one wave.
        together = (_power_between(engine, other, flows) + _power_between(other, engine, flows).conj()) / 2
        total = total + _largest_over_angle(together, run.lines)
    return np.asarray(total)


def _only(run: OrderResponse, places: Sequence[int]) -> OrderResponse:
    """Response by order with all lines but those at ``places`` set to zero."""
    kept = np.isin(np.arange(len(run.lines)), places)
    return replace(run, values=run.values * kept[:, None])


def _power_between(torques: OrderResponse, motions: OrderResponse, flows: Sequence[PowerFlow]) -> ComplexArray:
    """Product in W of one response's torques and another's conjugate rates, shape (n_speeds, n_frequencies)."""
    # gamma' = j omega gamma; lines of one frequency are added before power, which is quadratic.
    rates = replace(motions, values=motions.values * (2j * math.pi * motions.frequencies)[:, :, None]).by_frequency()
    amplitudes = torques.by_frequency()
    total = np.zeros(rates.shape[:2], dtype=complex)
    for flow in flows:
        torque, rate = (torques.output(str(sensor)) for sensor in (flow.torque, flow.motion))
        total += flow.sign * amplitudes[:, :, torque] * rates[:, :, rate].conj()
    return total


def _largest_over_angle(values: ComplexArray, lines: Sequence[OrderLine]) -> FloatArray:
    """Largest value, over the angle between two engines, of a sum of waves in W by speed, shape (n_speeds,).

    It is that of Re sum X exp(j r angle), X by frequency and r its vibrations per revolution.
    """
    relatives = list({(line.relative, line.fixed): line.relative for line in lines}.values())
    moving = [at for at in range(len(relatives)) if relatives[at] and values[:, at].any()]
    cycle = common_cycle([relatives[at] for at in moving])
    if cycle is None or not moving:
        # Waves without a common cycle all reach their crests together at some angle, or nearly so.
        return np.asarray(np.abs(values).sum(axis=1))
    return np.asarray(cycle_extremes(values[:, moving, None], [int(relatives[at] * cycle) for at in moving])[0, :, 0])
