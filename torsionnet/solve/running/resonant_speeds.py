"""Speeds to add around resonances of order lines with modes that are narrower than a step of the speeds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.core.errors import SolveError
from torsionnet.response.frequency_response import ComplexArray, FloatArray
from torsionnet.response.order_line import OrderLine
from torsionnet.response.vibrations.vibration_mode import VibrationMode
from torsionnet.solve.modes.modes import modes
from torsionnet.solve.running.modes_over_speed import ModesOverSpeed

HALF_WIDTHS_AROUND = (-3.0, -1.0, 0.0, 1.0, 3.0)
"""Distances from a critical speed at which speeds are added, in half widths of the resonance.

The sum of a resonance and of all else is largest where their phases agree, up to a few half widths away.
"""
WIDEST_REFINED = 1.5
"""Half width, in steps of speed, from which on a resonance needs no further speeds, as several steps lie within.

A larger value adds speeds around resonances that the steps show already.
"""
SMALLEST_DAMPING_RATIO = 1e-7
"""Damping ratio that a mode is taken to have at least, since the half width of an undamped resonance would be 0."""
MODE_SPEEDS = 9
"""Number of speeds over the range at which modes that follow the speed are calculated, between two of which they are
interpolated."""
LARGEST_FREQUENCY_CHANGE = 0.005
"""Relative change of a natural frequency between two neighbouring speeds up to which modes are interpolated.

A larger value misplaces resonances, a smaller one needs more sets of modes.
"""
Resonance = tuple[float, float]
"""Critical speed and half width of a resonance, both in rad/s of the reference shaft."""


def around_resonances(
    drivetrain: AssembledModel, reference: str, lines: Sequence[OrderLine], speeds: FloatArray
) -> FloatArray:
    """Speeds (n,) in rad/s to add around every resonance that is narrower than a step of the rising ``speeds``."""
    limits = float(speeds[0]), float(speeds[-1])
    over_speed = ModesOverSpeed(drivetrain, reference, limits)
    if over_speed.is_speed_dependent:
        return _around(_following(over_speed, _distinct(lines), limits), speeds)
    return around_poles(modes(drivetrain).eigenvalues, lines, speeds)


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

    Modes are interpolated where they change little, else iterated.
    """
    at = np.linspace(*limits, MODE_SPEEDS)
    for modes_there in zip(*map(over_speed.at, at.tolist()), strict=False):
        damped, natural, width = (
            np.array([value(mode) for mode in modes_there])
            for value in (_damped, _natural, lambda mode: mode.damping_ratio * mode.natural_frequency)
        )
        for line in (one for one in lines if one.relative):
            beyond = damped - np.abs(line.frequency(at))
            for place in np.flatnonzero(beyond[:-1] * beyond[1:] <= 0).tolist():
                ends = slice(place, place + 2)
                if np.ptp(damped[ends]) > LARGEST_FREQUENCY_CHANGE * damped[ends].max():
                    yield from _settled(over_speed, modes_there[place], line, limits)
                    continue
                share = beyond[place] / (beyond[place] - beyond[place + 1]) if np.ptp(beyond[ends]) else 0.0
                met = [
                    float(curve[place] + share * (curve[place + 1] - curve[place]))
                    for curve in (damped, width, natural)
                ]
                yield from _met(line, *met)


def _damped(mode: VibrationMode) -> float:
    return mode.damped_frequency


def _natural(mode: VibrationMode) -> float:
    return mode.natural_frequency


def _settled(
    over_speed: ModesOverSpeed, mode: VibrationMode, line: OrderLine, limits: tuple[float, float]
) -> Iterator[Resonance]:
    def speed_of(one: VibrationMode) -> float:
        found = [speed for speed, _ in _met(line, one.damped_frequency, 0.0, one.damped_frequency)]
        return min(found, key=lambda speed: abs(speed - sum(limits) / 2))

    try:
        found = over_speed.at_critical_speed(mode, speed_of)
    except SolveError:
        return
    yield from _met(
        line, found.damped_frequency, found.damping_ratio * found.natural_frequency, found.natural_frequency
    )
