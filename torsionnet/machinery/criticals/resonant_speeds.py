"""Speeds to add around resonances of order lines with modes that are narrower than a step of the speeds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.table_range import told_of_reads
from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.linear.modes.natural_modes import modes
from torsionnet.machinery.criticals.line_meetings import LineOverModes
from torsionnet.machinery.criticals.modes_over_speed import DAMPED, ModesOverSpeed
from torsionnet.machinery.orders.order_line import OrderLine

HALF_WIDTHS_AROUND = (-3.0, -1.0, 0.0, 1.0, 3.0)
"""Distances from a critical speed at which speeds are added, in half widths of the resonance.

The sum of a resonance and of all else is largest where their phases agree, up to a few half widths away.
"""
WIDEST_REFINED = 8.0
"""Half width, in steps of speed, from which on a resonance needs no further speeds: half a step beside its top it has
lost a fifth of a per cent. Around wider resonances than a step no speed but its own is added.

A larger value adds speeds to resonances that the steps show already.
"""
SMALLEST_DAMPING_RATIO = 1e-7
"""Damping ratio that a mode is taken to have at least, since the half width of an undamped resonance would be 0."""
NEAR_RESONANCE = 0.1
"""Relative distance of a line from a mode up to which their nearest place counts as a resonance, without a crossing."""
FOLLOWED_ABOVE = 1.1
"""Ratio of a mode's frequency to the highest of any line above which the mode has no resonance here."""
Resonance = tuple[float, float]
"""Critical speed and half width of a resonance, both in rad/s of the reference shaft."""


def around_resonances(
    drivetrain: AssembledModel, reference: str, lines: Sequence[OrderLine], speeds: FloatArray
) -> FloatArray:
    """Speeds (n,) in rad/s to add around every resonance that is narrower than a step of the rising ``speeds``."""
    limits = float(speeds[0]), float(speeds[-1])
    highest = FOLLOWED_ABOVE * max((float(np.abs(line.frequency(np.array(limits))).max()) for line in lines), default=0)
    over_speed = ModesOverSpeed(drivetrain, reference, limits, highest=highest)
    if over_speed.is_speed_dependent:
        return _around(_following(over_speed, _distinct(lines), limits), speeds)
    with told_of_reads(None):
        poles = modes(drivetrain).eigenvalues
    return around_poles(poles, lines, speeds)


def around_poles(poles: ComplexArray, lines: Sequence[OrderLine], speeds: FloatArray) -> FloatArray:
    """Speeds (n,) in rad/s to add around resonances with poles (rad/s) that are the same at every speed."""
    found = (
        resonance
        for pole in poles[poles.imag > 0].tolist()
        for line in _distinct(lines)
        for resonance in _met(line, pole.imag / (2 * math.pi), -pole.real / (2 * math.pi), abs(pole) / (2 * math.pi))
    )
    return _around(found, speeds)


def _distinct(lines: Sequence[OrderLine]) -> list[OrderLine]:
    return list({(line.relative, line.fixed): line for line in lines}.values())


def _around(resonances: Iterable[Resonance], speeds: FloatArray) -> FloatArray:
    found: list[float] = []
    for speed, width in resonances:
        after = min(max(int(np.searchsorted(speeds, speed)), 1), len(speeds) - 1)
        step = float(speeds[after] - speeds[after - 1])
        if speeds[0] <= speed <= speeds[-1] and width < WIDEST_REFINED * step:
            found += [speed + width * times for times in HALF_WIDTHS_AROUND if width * abs(times) < step]
    return np.array(found)


def _met(line: OrderLine, damped: float, width: float, natural: float) -> Iterator[Resonance]:
    """Yield resonances of an order line with a mode of this damped frequency, half width, natural frequency, in Hz.

    Each is a critical speed with a half width, in rad/s.
    """
    rate = float(line.relative) / (2 * math.pi)
    for frequency in (damped, -damped) if rate else ():
        yield (frequency - line.fixed) / rate, max(abs(width), SMALLEST_DAMPING_RATIO * natural) / abs(rate)


def _following(
    over_speed: ModesOverSpeed, lines: Sequence[OrderLine], limits: tuple[float, float]
) -> Iterator[Resonance]:
    """Yield resonances of order lines with modes that follow the speed, as speed and half width in rad/s.

    A line that comes near a mode and turns away has a resonance where it is nearest.
    """
    numbers = sorted({number for piece in over_speed.pieces for number in piece.numbers})
    for line in lines:
        beside = LineOverModes(line, over_speed.pieces, limits)
        for number in numbers:
            for one in beside.approaches(number, DAMPED):
                if one.meets or abs(one.offset) < NEAR_RESONANCE:
                    yield one.speed, max(one.width, SMALLEST_DAMPING_RATIO * one.speed if one.width else 0.0)
