"""Torques that drive a periodic motion: amplitudes over frequency, or orders of a model's excitations over speed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any, TypeAlias

import numpy as np

from torsionnet.base.errors import UsageError, named_list
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.transfer_request import resolve_inputs
from torsionnet.machinery.orders.operating_groups import own_ratio
from torsionnet.machinery.orders.order_line import has_unknown_angles
from torsionnet.machinery.orders.order_solution import OrderRequest
from torsionnet.model.channels import Input
from torsionnet.motion.driving import acting_means
from torsionnet.motion.motion_plant import placed_plant
from torsionnet.motion.periodic.periodic_problem import PeriodicDrive
from torsionnet.motion.steady_start import nodes_of

Torques: TypeAlias = Mapping[str, complex | Mapping[int, complex]]
"""Torques by input or node: the amplitude of harmonic 1 in N m, or amplitudes by harmonic, 0 being the mean."""
MOST_ORDERS = 200
"""Highest harmonic of the common period of orders that is followed: beyond, orders count as without one."""
MOST_KEPT = 4096
"""Most speeds at which the torques of excitations are kept."""


@dataclass(frozen=True, eq=False)
class Forcing:
    """Periodic torques over a parameter.

    Attributes
    ----------
    drivetrain : AssembledModel
    inputs : tuple of Input
    drive : PeriodicDrive
    parameters : (n,) array
        Frequencies in Hz or speeds in rad/s asked for.
    reference : str
        Node of the speeds, empty over frequency.
    order : float
        Order of harmonic 1 at the reference, 1 over frequency.
    """

    drivetrain: AssembledModel
    inputs: tuple[Input, ...]
    drive: PeriodicDrive
    parameters: FloatArray
    reference: str
    order: float


def over_frequency(drivetrain: AssembledModel, frequencies: Any, torques: Torques | None) -> Forcing:
    """Torques with given amplitudes over frequencies in Hz.

    Raises
    ------
    UsageError
        No frequencies above 0, or no torques.
    """
    if not isinstance(torques, Mapping) or not torques:
        text = 'over frequency excitation= gives torques, as {"T_M": 60} or {"T_M": {0: 40, 1: 60}} in N m by harmonic'
        raise UsageError(text, kind="wrong-form")
    parameters = _parameters(frequencies, "frequencies", "Hz")
    given = {name: _by_harmonic(name, amplitudes) for name, amplitudes in torques.items()}
    # Nodes without a mean of their own keep that of the operating point.
    stated = [nodes_of(drivetrain, name) for name, amplitudes in given.items() if 0 in amplitudes]
    means = acting_means(drivetrain, stated)
    count = 1 + max(max(amplitudes) for amplitudes in given.values())
    loads = np.zeros((max(count, 2), len(given) + len(means)), dtype=complex)
    for place, amplitudes in enumerate(given.values()):
        for harmonic, amplitude in amplitudes.items():
            loads[harmonic, place] = amplitude
    loads[0, len(given) :] = list(means.values())
    if not np.abs(loads[1:]).any():
        raise UsageError("no torque vibrates: give an amplitude at harmonic 1 or above", kind="no-effect")
    # laws in full, since friction that sticks in linear results would lock the node of a torque
    inputs = resolve_inputs(placed_plant(drivetrain).drivetrain, [*given, *means], None).excitations
    return Forcing(drivetrain, inputs, PeriodicDrive(lambda p: 2 * math.pi * p, lambda _: loads), parameters, "", 1.0)


def _parameters(given: Any, what: str, unit: str) -> FloatArray:
    try:
        parameters = np.atleast_1d(np.asarray(given, dtype=float))
    except (TypeError, ValueError):
        parameters = np.array([np.nan])
    if parameters.ndim != 1 or not len(parameters) or not np.isfinite(parameters).all() or (parameters <= 0).any():
        raise UsageError(f"{what} are finite numbers above 0, in {unit}", kind="out-of-range")
    return np.unique(parameters)


def _by_harmonic(name: str, given: Any) -> dict[int, complex]:
    amplitudes = given if isinstance(given, Mapping) else {1: given}
    try:
        by_harmonic = {int(harmonic): complex(amplitude) for harmonic, amplitude in amplitudes.items()}
    except (TypeError, ValueError):
        by_harmonic = {}
    whole = by_harmonic and all(float(harmonic) == int(harmonic) and int(harmonic) >= 0 for harmonic in amplitudes)
    if not whole or not np.isfinite(list(by_harmonic.values())).all() or by_harmonic.get(0, 0j).imag:
        text = "a periodic torque has finite amplitudes in N m by harmonic, 0 being the mean, which is real"
        raise UsageError(f"{name}: {text}; got {given!r}", kind="wrong-form")
    return by_harmonic


def over_speed(
    drivetrain: AssembledModel, speeds: Any, speed_of: str | None, excitation: str | Iterable[str] | None
) -> Forcing:
    """Orders of a model's excitations over speeds in rad/s, with the mean torques of its load there.

    Without a load those of its operating point.

    Raises
    ------
    UsageError
        What :func:`.order_response` refuses; lines that do not follow the speed; imposed angles; parameters that follow
        the operating point.
    """
    if isinstance(excitation, Mapping):
        text = "over speed excitation= names excitations of the model; torques by name go with frequencies="
        raise UsageError(text, kind="wrong-form")
    request = order_request(drivetrain, speeds, speed_of, excitation)
    parameters = _parameters(request.speeds, "speeds", "rad/s")
    first = request.loads(parameters[:1])
    _require_period(first.lines, first.inputs)
    _require_fixed_values(drivetrain)
    relative = [line.relative for line in first.lines]
    # All orders are whole multiples of one: gcd of the numerators over lcm of the denominators.
    base = Fraction(math.gcd(*(h.numerator for h in relative)), math.lcm(*(h.denominator for h in relative)))
    means = acting_means(drivetrain)
    mean_inputs = resolve_inputs(request.drivetrain, list(means), None).excitations if means else ()
    inputs = tuple(dict.fromkeys((*first.inputs, *mean_inputs)))
    harmonics = [int(order / base) for order in relative]
    if max(harmonics) > MOST_ORDERS:
        text = f"orders {', '.join(f'{float(h):.8g}' for h in sorted(set(relative)))} have a period in common only"
        text += f" after {float(1 / base):.6g} turns of {request.reference}; periodic motion needs shorter ones: take"
        raise UsageError(f"{text} fewer excitations together, or simulate", kind="no-period")

    def means_at(speed: float) -> Mapping[str, float]:
        if drivetrain.definition.load is None:
            return means
        return drivetrain.external_torques.at(own_ratio(drivetrain, request.reference) * speed)

    @lru_cache(MOST_KEPT)
    def loads(speed: float) -> ComplexArray:
        orders = request.loads(np.array([speed]))
        torques = np.zeros((max(harmonics) + 1, len(inputs)), dtype=complex)
        for line, harmonic in enumerate(harmonics):
            # Re(v exp(-j h w t)) = Re(v* exp(j h w t)) for lines that turn backward.
            backward = orders.hertz[0, line] < 0
            for place, channel in enumerate(orders.inputs):
                value = orders.loads[0, line, place]
                torques[harmonic, inputs.index(channel)] += value.conjugate() if backward else value
        for channel, node in zip(mean_inputs, means, strict=True):
            torques[0, inputs.index(channel)] += means_at(speed).get(node, 0.0)
        return torques

    drive = PeriodicDrive(lambda speed: float(base) * speed, loads, lambda speed: speed)
    return Forcing(drivetrain, inputs, drive, parameters, request.reference, float(base))


def order_request(
    drivetrain: AssembledModel, speeds: Any, speed_of: str | None, excitation: str | Iterable[str] | None
) -> OrderRequest:
    """Order request of a drivetrain whose laws of motion lock nothing, as friction does that sticks in linear results.

    Raises
    ------
    UsageError
        Cylinders of which any may misfire, or that scatter: each case has motions of its own.
    """
    _ = drivetrain.assembly  # linear about its operating point, whose torques have to balance
    request = OrderRequest.of(placed_plant(drivetrain).drivetrain, speeds, speed_of, excitation)
    several = [
        each.name
        for each in request.loads(request.speeds[:1]).by_excitation
        if each.torques.alternatives is not None or each.torques.scatter is not None
    ]
    if several:
        text = "periodic motion is that of one case of excitation; say which cylinder misfires, without scatter"
        raise UsageError(f"{named_list(several)}: {text}", kind="no-period")
    return request


def _require_fixed_values(drivetrain: AssembledModel) -> None:
    names = list(drivetrain.definition.following)
    if names:
        text = "follows the operating point, and motions over speed are followed with one value: give it a number"
        raise UsageError(f"{', '.join(names)}: {text}", kind="unsupported-law")


def _require_period(lines: Sequence[Any], inputs: Sequence[Input]) -> None:
    fixed = [str(line) for line in lines if line.fixed or not line.order]
    if fixed:
        text = "a line at a fixed frequency has no period in common with orders; leave it out"
        raise UsageError(f"{', '.join(fixed)}: {text}", kind="no-period")
    if has_unknown_angles(lines):
        text = "engines at unknown angles to each other have no one motion; give the angles between them"
        raise UsageError(text, kind="no-period")
    imposed = [str(channel) for channel in inputs if channel.quantity != "torque"]
    if imposed:
        raise UsageError(f"periodic motion is driven by torques; leave out {', '.join(imposed)}", kind="unfit-channel")
