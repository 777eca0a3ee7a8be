"""Transfer functions between sensors, inputs and nodes, also against measured inputs.

For excitations u every reading is y = L(s) q + direct u. Against measured inputs m under the same excitations the
transfer function is Y_out Y_in^-1, equations (8)-(13) and (20) of Galvagno et al. (2015) for any sensor anywhere.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.assembly.functionals import Functional
from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.assembly.system import Assembly
from torsionnet.channels import Input, Sensor
from torsionnet.checks.structure import rigid_motions
from torsionnet.drivetrain import Drivetrain
from torsionnet.errors import TorsionnetWarning, UsageError
from torsionnet.response import Channel, FrequencyResponse
from torsionnet.solve import dense
from torsionnet.solve.question import Question, ask
from torsionnet.solve.zero import at_zero

POOR = 1e-10
"""A measured input smaller than this share of its own terms is mostly rounding."""


@dataclass(frozen=True)
class Readings:
    """Values (n_f, n_readings, n_exc), and the size of each against the sum of its terms' magnitudes."""

    values: ComplexArray
    cancellation: FloatArray


def frequency_response(
    drivetrain: Drivetrain,
    output: str | Sensor | Sequence[str | Sensor],
    input: str | Sensor | Sequence[str | Sensor],
    frequencies: ArrayLike,
    *,
    excitation: str | Sequence[str] | None = None,
) -> FrequencyResponse:
    """See :meth:`torsionnet.Drivetrain.frequency_response`."""
    f = _checked(frequencies)
    question = ask(drivetrain, output, input, excitation)
    values = np.empty((len(f), len(question.outputs), len(question.measured)), dtype=complex)
    conditioning = np.ones(len(f))
    moving = f > 0
    if moving.any():
        values[moving], conditioning[moving] = evaluate(drivetrain.assembly, question, f[moving])
    if not moving.all():
        values[~moving] = _static(drivetrain, question)
        _warn_infinite(values[~moving], "at 0 Hz: the drivetrain turns freely")
    sound = moving & (conditioning >= POOR)
    _warn_infinite(values[sound], "at a frequency above 0")
    return FrequencyResponse(
        frequencies=f,
        values=values,
        outputs=tuple(Channel(reading.name, reading.unit) for reading in question.outputs),
        inputs=tuple(Channel(reading.name, reading.unit) for reading in question.measured),
        title=drivetrain.title,
        conditioning=conditioning if question.is_measured else None,
        notes=question.notes,
    )


def _static(drivetrain: Drivetrain, question: Question) -> ComplexArray:
    """Values at zero frequency: the static solution where it is finite, else the limit."""
    if not rigid_motions(drivetrain.assembly.kinematics):
        values = evaluate(drivetrain.assembly, question, np.zeros(1))[0]
        if np.isfinite(values).all():
            return values
    return at_zero(drivetrain, question)


def _checked(frequencies: ArrayLike) -> FloatArray:
    try:
        f = np.atleast_1d(np.asarray(frequencies, dtype=float))
    except (TypeError, ValueError):
        f = np.array([np.nan])
    if f.ndim != 1 or not np.isfinite(f).all() or (f < 0).any():
        msg = "frequencies must be a list of finite numbers >= 0, in Hz"
        raise UsageError(msg)
    return f


def evaluate(assembly: Assembly, question: Question, frequencies: FloatArray) -> tuple[ComplexArray, FloatArray]:
    """Transfer functions (n_f, n_out, n_in) at frequencies > 0, and the conditioning (n_f,) of the measured inputs."""
    omega = 2 * np.pi * frequencies
    s = (1j * omega).astype(complex)
    readings = read(assembly, question.readings, question.excitations, omega, s)
    n_out = len(question.outputs)
    outputs, measured = readings.values[:, :n_out], readings.values[:, n_out:]
    if not question.is_measured:
        return outputs, np.ones(len(s))
    return _divide(outputs, measured), _conditioning(measured, readings.cancellation[:, n_out:], question, frequencies)


def read(
    assembly: Assembly, readings: Sequence[Functional], excitations: Sequence[Input], omega: FloatArray, s: ComplexArray
) -> Readings:
    """Readings under unit excitations."""
    kappa = assembly.law_stiffness(omega, s)
    terms = [term for reading in readings for term in reading.terms]
    rows = np.array([term.row for term in terms]).reshape(len(terms), assembly.system.n_coordinates)
    imposed = np.array([term.imposed for term in terms]).reshape(len(terms), len(assembly.kinematics.imposed))
    loads, moves = _loads(assembly, excitations, kappa)
    motion = dense.respond(assembly.system, kappa, loads, rows) + (imposed @ moves)[None]
    values = np.zeros((len(s), len(readings), len(excitations)), dtype=complex)
    sizes = np.zeros(values.shape)
    start = 0
    with np.errstate(invalid="ignore"):
        for number, reading in enumerate(readings):
            stop = start + len(reading.terms)
            parts = reading.coefficients(kappa, s)[:, :, None] * motion[:, start:stop]
            direct = np.array([_direct(reading, excitation) for excitation in excitations])
            values[:, number] = parts.sum(axis=1) + direct
            sizes[:, number] = np.abs(parts).sum(axis=1) + np.abs(direct)
            start = stop
        cancellation = np.divide(np.abs(values), sizes, out=np.zeros(sizes.shape), where=sizes > 0)
    return Readings(values, cancellation)


def _direct(reading: Functional, excitation: Input) -> float:
    return reading.direct.get(excitation.of, 0.0) if excitation.quantity == "torque" else 0.0


def _loads(assembly: Assembly, excitations: Sequence[Input], kappa: ComplexArray) -> tuple[ComplexArray, FloatArray]:
    """Generalised torques (n_f or 1, n_q, n_exc), and the imposed angles (n_x, n_exc) of unit excitations."""
    system = assembly.system
    moves = np.zeros((len(assembly.kinematics.imposed), len(excitations)))
    torques = np.zeros((1, system.n_coordinates, len(excitations)), dtype=complex)
    for column, excitation in enumerate(excitations):
        if excitation.quantity == "torque":
            torques[0, :, column] = assembly.rows_of({excitation.of: 1})[0]
        else:
            node = assembly.rows_of({excitation.of: 1})[1]
            moves[:, column] = node
    if not moves.any():
        return torques, moves
    following = system.rows.T @ (kappa[:, :, None] * (assembly.imposed_rows @ moves))
    return torques - following, moves


def _divide(outputs: ComplexArray, measured: ComplexArray) -> ComplexArray:
    """Y_out Y_in^-1 for every frequency; inf where the measured inputs do not tell the excitations apart."""
    if measured.shape[1:] == (1, 1):
        with np.errstate(divide="ignore", invalid="ignore"):
            quotient = outputs / measured
        return np.where(measured == 0, np.inf + 0j, quotient)
    result = np.empty((len(outputs), outputs.shape[1], measured.shape[1]), dtype=complex)
    for number, (above, below) in enumerate(zip(outputs, measured, strict=True)):
        try:
            result[number] = np.linalg.solve(below.T, above.T).T
        except np.linalg.LinAlgError:
            result[number] = np.inf
    return result


def _conditioning(
    measured: ComplexArray, cancellation: FloatArray, question: Question, frequencies: FloatArray
) -> FloatArray:
    """Worst share a measured input is of its terms; with several, also how well they tell the excitations apart."""
    scale = np.abs(measured).max(axis=2, keepdims=True)
    independent = np.ones(len(measured))
    if measured.shape[1] > 1:
        with np.errstate(divide="ignore", invalid="ignore"):
            normed = measured / scale
        normed[~np.isfinite(normed)] = 0.0
        singular = np.linalg.svd(normed, compute_uv=False)
        independent = singular[:, -1] / np.maximum(singular[:, 0], 1e-300)
    worst = np.asarray(cancellation.max(axis=2).min(axis=1) * independent)
    poor = np.flatnonzero(worst < POOR)
    if len(poor):
        names = ", ".join(reading.name for reading in question.measured)
        where = f"{len(poor)} frequencies, the first {frequencies[poor[0]]:.6g} Hz"
        text = f"{names}: the measured input vanishes or is mostly rounding at {where}"
        warnings.warn(text, TorsionnetWarning, stacklevel=5)
    return worst


def _warn_infinite(values: ComplexArray, where: str) -> None:
    if len(values) and not np.isfinite(values).all():
        warnings.warn(f"the response is infinite {where}", TorsionnetWarning, stacklevel=4)
