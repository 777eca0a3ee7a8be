"""Transfer functions between sensors, inputs and nodes, also against measured inputs.

For excitations u every reading is y = L(s) q + direct u. Against measured inputs m under the same excitations the
transfer function is Y_out Y_in^-1, equations (8)-(13) and (20) of Galvagno et al. (2015) for any sensor anywhere.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.assembly.functionals import Functional
from torsionnet.assembly.law_stiffness import LawStiffness, law_stiffness
from torsionnet.assembly.rows import ComplexArray, FloatArray, RowSystem
from torsionnet.assembly.system import Assembly
from torsionnet.channels import Input, Sensor
from torsionnet.checks.structure import rigid_motions
from torsionnet.drivetrain import Drivetrain
from torsionnet.errors import TorsionnetWarning, UsageError
from torsionnet.response import Channel, FrequencyResponse
from torsionnet.solve import dense, starmesh
from torsionnet.solve.grid import Adaptive
from torsionnet.solve.question import Question, remembered
from torsionnet.solve.zero import at_zero

Respond: TypeAlias = Callable[[RowSystem, LawStiffness, ComplexArray, FloatArray], ComplexArray]
METHODS: dict[str, Respond] = {
    "graph": starmesh.respond,
    "compiled": starmesh.respond_compiled,
    "dense": dense.respond,
}
POOR = 1e-10
"""A measured input smaller than this share of its own terms is mostly rounding."""


@dataclass(frozen=True)
class Readings:
    """Values (n_f, n_readings, n_exc); where the input is measured, their size against the sum of their terms'."""

    values: ComplexArray
    cancellation: FloatArray


def frequency_response(
    drivetrain: Drivetrain,
    output: str | Sensor | Sequence[str | Sensor],
    input: str | Sensor | Sequence[str | Sensor],
    frequencies: ArrayLike | Adaptive,
    *,
    excitation: str | Sequence[str] | None = None,
    method: str = "graph",
) -> FrequencyResponse:
    """See :meth:`torsionnet.Drivetrain.frequency_response`."""
    known_method(method)
    question = remembered(drivetrain, output, input, excitation)
    f = chosen_frequencies(drivetrain, frequencies, question)
    values, conditioning = responses([drivetrain], question, f, method)
    warn_infinite(values, conditioning, f)
    return FrequencyResponse(
        frequencies=f,
        values=values[0],
        outputs=tuple(Channel(reading.name, reading.unit) for reading in question.outputs),
        inputs=tuple(Channel(reading.name, reading.unit) for reading in question.measured),
        title=drivetrain.title,
        conditioning=conditioning[0] if question.is_measured else None,
        notes=question.notes,
    )


def known_method(method: str) -> None:
    """Refuse a method that does not exist."""
    if method not in METHODS:
        msg = f'no method is named "{method}"; choose {", ".join(METHODS)}'
        raise UsageError(msg)


def chosen_frequencies(drivetrain: Drivetrain, frequencies: ArrayLike | Adaptive, question: Question) -> FloatArray:
    """The frequencies asked for, Hz."""
    return _resolving(drivetrain, frequencies, question) if isinstance(frequencies, Adaptive) else _checked(frequencies)


class Evaluated(NamedTuple):
    """Transfer functions (n_variants, n_f, n_out, n_in), and the conditioning (n_variants, n_f) of measured inputs."""

    values: ComplexArray
    conditioning: FloatArray


def responses(drivetrains: Sequence[Drivetrain], question: Question, f: FloatArray, method: str) -> Evaluated:
    """Transfer functions of drivetrains with the same rows at frequencies >= 0."""
    assemblies, moving = [drivetrain.assembly for drivetrain in drivetrains], f > 0
    if moving.all():
        return evaluate(assemblies, question, f, method)
    shape = (len(drivetrains), len(f))
    found = Evaluated(np.empty((*shape, len(question.outputs), len(question.measured)), dtype=complex), np.ones(shape))
    if moving.any():
        found.values[:, moving], found.conditioning[:, moving] = evaluate(assemblies, question, f[moving], method)
    for number, drivetrain in enumerate(drivetrains):
        found.values[number, ~moving] = _static(drivetrain, question, method)
    return found


def _static(drivetrain: Drivetrain, question: Question, method: str) -> ComplexArray:
    """Values at zero frequency: the static solution where it is finite, else the limit."""
    if not rigid_motions(drivetrain.assembly.kinematics):
        values = evaluate([drivetrain.assembly], question, np.zeros(1), method).values[0]
        if np.isfinite(values).all():
            return np.asarray(values)
    return at_zero(drivetrain, question)


def _resolving(drivetrain: Drivetrain, wanted: Adaptive, question: Question) -> FloatArray:
    """Frequencies that resolve the peaks of the drivetrain and, where inputs are measured, those of their poles."""
    modes = [drivetrain.modes()]
    if question.is_measured and len(question.measured) == 1:
        sensor = question.measured[0].name
        modes.append(drivetrain.modes(measured_input=sensor, excitation=_excitation_node(drivetrain, question)))
    return wanted.frequencies(*modes)


def _excitation_node(drivetrain: Drivetrain, question: Question) -> str:
    names = [name for name, channel in drivetrain.inputs.items() if channel == question.excitations[0]]
    return names[0] if names else question.excitations[0].of


def _checked(frequencies: ArrayLike) -> FloatArray:
    try:
        f = np.atleast_1d(np.asarray(frequencies, dtype=float))
    except (TypeError, ValueError):
        f = np.array([np.nan])
    if f.ndim != 1 or not np.isfinite(f).all() or (f < 0).any():
        msg = "frequencies must be a list of finite numbers >= 0, in Hz"
        raise UsageError(msg)
    return f


def evaluate(
    assemblies: Sequence[Assembly], question: Question, frequencies: FloatArray, method: str = "graph"
) -> Evaluated:
    """Transfer functions at frequencies > 0, and the conditioning of the measured inputs.

    Parameters
    ----------
    assemblies : sequence of Assembly
        Variants with the same rows.
    question : Question
    frequencies : (n_f,) array
        Hz.
    method : str
    """
    kappa = law_stiffness([assembly.system for assembly in assemblies], 2 * np.pi * frequencies)
    readings = read(assemblies[0], question, kappa, method)
    n_out, shape = len(question.outputs), (len(assemblies), len(frequencies))
    values, conditioning = readings.values[:, :n_out], np.ones(kappa.n_lanes)
    if question.is_measured:
        measured, shares = readings.values[:, n_out:], readings.cancellation[:, n_out:]
        values = _divide(values, measured)
        conditioning = _conditioning(measured, shares, question, np.tile(frequencies, len(assemblies)))
    return Evaluated(values.reshape(*shape, *values.shape[1:]), conditioning.reshape(shape))


def read(assembly: Assembly, question: Question, kappa: LawStiffness, method: str) -> Readings:
    """Readings under unit excitations, a block of lanes at a time."""
    size, respond = starmesh.block_size(kappa.n_laws, method), METHODS[method]
    if kappa.n_lanes <= size:
        return _read(assembly, question, kappa, respond)
    parts = [_read(assembly, question, block, respond) for block in kappa.blocks(size)]
    values = np.concatenate([part.values for part in parts])
    return Readings(values, np.concatenate([part.cancellation for part in parts]))


def _read(assembly: Assembly, question: Question, kappa: LawStiffness, respond: Respond) -> Readings:
    rows, imposed = question.rows
    loads, moves = _loads(assembly, question.excitations, kappa)
    motion = respond(assembly.system, kappa, loads, rows)
    if moves.any():
        motion = motion + (imposed @ moves)[None]
    values = np.zeros((kappa.n_lanes, len(question.readings), len(question.excitations)), dtype=complex)
    sizes = np.zeros(values.shape)
    start = 0
    with np.errstate(invalid="ignore"):
        for number, reading in enumerate(question.readings):
            stop = start + len(reading.terms)
            parts = reading.coefficients(kappa)[:, :, None] * motion[:, start:stop]
            direct = np.array([_direct(reading, excitation) for excitation in question.excitations])
            values[:, number] = parts.sum(axis=1) + direct
            if question.is_measured:
                sizes[:, number] = np.abs(parts).sum(axis=1) + np.abs(direct)
            start = stop
        cancellation = np.divide(np.abs(values), sizes, out=sizes, where=sizes > 0) if question.is_measured else sizes
    return Readings(values, cancellation)


def _direct(reading: Functional, excitation: Input) -> float:
    return reading.direct.get(excitation.of, 0.0) if excitation.quantity == "torque" else 0.0


def _loads(assembly: Assembly, excitations: Sequence[Input], kappa: LawStiffness) -> tuple[ComplexArray, FloatArray]:
    """Generalised torques (n_lanes or 1, n_q, n_exc), and the imposed angles (n_x, n_exc) of unit excitations."""
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
    used = np.flatnonzero(assembly.imposed_rows.any(axis=1))
    stiffness = kappa.only(used.tolist()).by_law.T
    following = system.rows[used].T @ (stiffness[:, :, None] * (assembly.imposed_rows[used] @ moves))
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


def warn_infinite(values: ComplexArray, conditioning: FloatArray, f: FloatArray) -> None:
    """Warn of infinite responses that rounding of a vanishing measured input does not explain."""
    finite = np.isfinite(values).all(axis=(2, 3))
    if finite.all():
        return
    for lanes, where in (
        (f == 0, "at 0 Hz: the drivetrain turns freely"),
        ((f > 0) & (conditioning >= POOR), "at a frequency above 0"),
    ):
        if (lanes & ~finite).any():
            warnings.warn(f"the response is infinite {where}", TorsionnetWarning, stacklevel=4)
