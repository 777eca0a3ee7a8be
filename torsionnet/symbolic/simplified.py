"""Simplified drivetrains, from which elements are removed before a formula is written, with the error that this makes.

Terms are never dropped from a result. An element is: a spring becomes rigid, a damper goes; and only if the poles that
are kept move less than the tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from torsionnet.base.errors import TorsionnetError, UsageError
from torsionnet.base.expressions import Number
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray
from torsionnet.linear.dynamic_stiffness.transfer_request import resolve_inputs, resolve_request
from torsionnet.linear.modes.natural_modes import modes, modes_against
from torsionnet.linear.responses.transfer import frequency_response
from torsionnet.model.channels import Sensor
from torsionnet.model.definition import Definition
from torsionnet.model.elements import GROUND, Element
from torsionnet.model.elements.gears import Gear, RigidCoupling
from torsionnet.model.elements.masses_and_springs import Damper, Spring
from torsionnet.symbolic.transfer_function import TransferFunction

COMPARISON_POINTS = 400
"""Number of frequencies in the band at which responses are compared, as more find narrower differences but take
longer."""


@dataclass(frozen=True)
class SimplificationRequest:
    """Request for a simplified drivetrain, with output, input, tolerance and frequency band in Hz."""

    output: str | Sensor
    input: str | Sensor
    excitation: str | None
    tolerance: float
    band: tuple[float, float]


@dataclass(frozen=True)
class Errors:
    """Errors of a simplified drivetrain, in natural frequency and damping ratio (relative) and magnitude (dB).

    Attributes
    ----------
    omega, zeta : float
        Largest relative change of natural frequency and of damping ratio over the kept modes.
    decibels : float
        Largest difference of the magnitudes over the band.
    """

    omega: float
    zeta: float
    decibels: float

    def __str__(self) -> str:
        decibels = round(self.decibels, 9)  # of nothing left out, rounding errors
        return f"omega_n {100 * self.omega:.2g} %, zeta {100 * self.zeta:.2g} %, {decibels:.2g} dB over the band"


@dataclass(frozen=True)
class Simplified:
    """Transfer function of a simplified drivetrain, with the elements removed and the errors in poles and magnitude.

    Attributes
    ----------
    transfer_function : TransferFunction
    drivetrain : Drivetrain
        The one it belongs to.
    changes : tuple of str
        What was taken away.
    errors : Errors
        Against the whole drivetrain.
    band : (low, high)
        In Hz; the modes in it are kept.
    """

    transfer_function: TransferFunction
    drivetrain: AssembledModel
    changes: tuple[str, ...]
    errors: Errors
    band: tuple[float, float]

    def __str__(self) -> str:
        changes = "; ".join(self.changes) or "nothing could be left out"
        low, high = self.band
        return f"{self.transfer_function}\n{changes}\nerror {low:g} to {high:g} Hz: {self.errors}"


def simplified(
    drivetrain: AssembledModel,
    output: str | Sensor,
    input: str | Sensor,
    excitation: str | None = None,
    *,
    written: Callable[[AssembledModel], TransferFunction],
    tolerance: float = 0.01,
    band: tuple[float, float] | None = None,
) -> Simplified:
    """Transfer function of a drivetrain without elements whose removal keeps the modes in the band within tolerance.

    Parameters
    ----------
    drivetrain, output, input, excitation
        As for a frequency response.
    written : callable
        The transfer function of a drivetrain in symbols.
    tolerance : float
        Largest relative change of natural frequency and damping ratio of the modes in the band.
    band : (low, high), optional
        In Hz; default: up to twice the lowest natural frequency.

    Raises
    ------
    UsageError
        There is no mode in the band, or the band is none.

    Examples
    --------
    >>> import torsionnet as tn
    >>> short = tn.load("dmf_rig").symbolic().simplified("theta_1", "T_M", tolerance=0.02, band=(0.5, 20))
    >>> short.changes
    ('torque_meter rigid',)
    >>> short.errors.omega < 0.02, short.errors.decibels < 1
    (True, True)
    """
    request = SimplificationRequest(output, input, excitation, tolerance, _band(drivetrain, band))
    current, changes = drivetrain, []
    sensors = resolve_request(drivetrain, output, input, excitation).sensors
    read = {sensor.of for sensor in sensors if sensor.is_on_element}
    reference = _Reference(drivetrain, request)
    candidates = list(_candidates(drivetrain.definition, read))
    costs = {change: reference.cost(_apply(drivetrain, change)) for change in candidates}
    # What moves the poles least goes first, and dampings after whole elements.
    ranked = sorted(candidates, key=lambda change: (change.of_damping, costs[change]))
    for change in ranked:
        shorter = _apply(current, change)
        if shorter is not current and reference.cost(shorter) <= tolerance:
            current = shorter
            changes.append(change.text)
    return Simplified(written(current), current, tuple(changes), reference.errors(current), request.band)


def _band(drivetrain: AssembledModel, band: tuple[float, float] | None) -> tuple[float, float]:
    if band is None:
        moving = [f for f in modes(drivetrain).natural_frequencies if f > 0]
        lowest = min(moving, default=1.0)
        return lowest / 20, 2 * lowest
    low, high = band
    if not 0 < low < high < math.inf:
        raise UsageError(
            f"band must be two frequencies in Hz with 0 < low < high, got {low:g}, {high:g}", kind="unordered-rows"
        )
    return low, high


@dataclass(frozen=True, eq=False)
class Change:
    """Change of a drivetrain by which an element is replaced by a simpler one, or removed."""

    name: str
    replacement: Element | None
    text: str
    of_damping: bool = False


def _candidates(definition: Definition, read: set[str]) -> Iterator[Change]:
    for element in definition.active:
        if isinstance(element, Damper) and element.name not in read:
            yield Change(element.name, None, f"{element.name} left out")
        if isinstance(element, Spring):
            if GROUND not in element.nodes and element.name not in read:
                yield Change(element.name, RigidCoupling(element.name, nodes=element.nodes), f"{element.name} rigid")
            if str(element.damping) != "0":
                undamped = replace(element, damping=Number(0))
                yield Change(element.name, undamped, f"{element.name} without its damping", of_damping=True)
        if isinstance(element, Gear) and element.stiffness is not None and element.name not in read:
            yield Change(element.name, replace(element, stiffness=None, damping=None), f"{element.name} rigid")


def _apply(drivetrain: AssembledModel, change: Change) -> AssembledModel:
    elements = dict(drivetrain.definition.elements)
    present = elements.get(change.name)
    if isinstance(present, RigidCoupling) and change.replacement is not None:
        return drivetrain
    if change.replacement is None:
        elements.pop(change.name, None)
    else:
        elements[change.name] = change.replacement
    return drivetrain.with_definition(replace(drivetrain.definition, elements=elements))


class _Reference:
    """Poles (rad/s) and magnitudes of the whole drivetrain over the band, with which simplified ones are compared."""

    def __init__(self, drivetrain: AssembledModel, request: SimplificationRequest) -> None:
        self.request = request
        low, high = request.band
        self.frequencies = np.geomspace(low, high, COMPARISON_POINTS)
        self.poles = [pole for pole in self._poles(drivetrain) if abs(pole) <= 2 * np.pi * high]
        if not self.poles:
            raise UsageError(
                f"there is no mode of vibration up to {high:g} Hz to be kept; widen band=", kind="unknown-mode"
            )
        self.magnitude = self._magnitude(drivetrain)

    def _poles(self, drivetrain: AssembledModel) -> list[complex]:
        request = resolve_inputs(drivetrain, self.request.input, self.request.excitation)
        solved = modes_against(drivetrain, request if request.is_measured else None)
        pairs = zip(solved.eigenvalues, solved.kinds, strict=True)
        return [complex(value) for value, kind in pairs if kind == "oscillatory"]

    def _magnitude(self, drivetrain: AssembledModel) -> ComplexArray:
        asked = self.request
        response = frequency_response(
            drivetrain, asked.output, asked.input, self.frequencies, driven_by=asked.excitation
        )
        return np.asarray(np.abs(response.values[:, 0, 0]))

    def errors(self, drivetrain: AssembledModel) -> Errors:
        """Errors of a simplified drivetrain in the poles of the kept modes and in the magnitude over the band."""
        poles = self._poles(drivetrain)
        omega = zeta = 0.0
        for pole in self.poles:
            near = min(poles, key=lambda other: abs(other - pole), default=complex(math.inf))
            omega = max(omega, abs(abs(near) / abs(pole) - 1))
            zeta = max(zeta, abs(_zeta(near) - _zeta(pole)) / max(_zeta(pole), 1e-6))
        with np.errstate(divide="ignore", invalid="ignore"):
            apart = np.abs(20 * np.log10(self._magnitude(drivetrain) / self.magnitude))
        return Errors(omega, zeta, float(np.nan_to_num(apart, nan=math.inf).max()))

    def cost(self, drivetrain: AssembledModel) -> float:
        """Largest relative change of natural frequency or damping ratio over the kept modes, inf if unknown."""
        try:
            errors = self.errors(drivetrain)
        except TorsionnetError:
            return math.inf
        return max(errors.omega, errors.zeta)


def _zeta(pole: Any) -> float:
    return -pole.real / abs(pole) if math.isfinite(abs(pole)) else math.inf
