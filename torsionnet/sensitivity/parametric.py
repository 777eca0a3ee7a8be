"""A transfer function as a function of parameters, with exact derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.channels import Input, Sensor
from torsionnet.drivetrain import Drivetrain
from torsionnet.errors import SolveError, UsageError
from torsionnet.expressions import ExpressionError
from torsionnet.sensitivity.augmented import Augmented, augmented, free_motion
from torsionnet.sensitivity.forms import equation_slopes, reading_slopes
from torsionnet.sensitivity.readings import Reading, condition_owner, reading, rows_of
from torsionnet.sensitivity.unknowns import Unknowns, unknowns
from torsionnet.solve.question import Question, as_sensor, ask

BLOCK_BYTES = 32 * 2**20


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Values (n_f, n_out, n_in) and derivatives (n_f, n_out, n_in, n_p)."""

    values: ComplexArray
    jacobian: ComplexArray


@dataclass(frozen=True, eq=False)
class ParametricResponse:
    """Transfer functions of one drivetrain in some of its parameters.

    Nothing is checked again from one set of values to the next, so a fit can ask thousands of times.

    Examples
    --------
    >>> import torsionnet as tn
    >>> response = parametric_response(tn.load("dmf_rig"), "theta_1", "T_T", [8.0], ["c_2", "k_2"])
    >>> found = response.at([4.0, 460.0])
    >>> bool(abs(found.jacobian[0, 0, 0, 0]) > 0), found.jacobian.shape
    (True, (1, 1, 1, 2))
    """

    drivetrain: Drivetrain
    question: Question
    frequencies: FloatArray
    unknowns: Unknowns
    sensors: tuple[Sensor, ...]
    loads: tuple[Input, ...]
    _redundant: tuple[int, ...] = field(repr=False, default=())

    @property
    def names(self) -> tuple[str, ...]:
        return self.unknowns.names

    @property
    def start(self) -> FloatArray:
        """Values in the drivetrain as it is, SI."""
        return np.array(self.unknowns.start)

    @cached_property
    def _nodes(self) -> tuple[str, ...]:
        return self.drivetrain.assembly.kinematics.nodes

    @cached_property
    def _motion(self) -> tuple[FloatArray, list[int]]:
        """What is solved once for all values."""
        system = augmented(self.unknowns, self.unknowns.start, self._nodes, self._redundant)
        driven = {f"input:{name}" for name in self.drivetrain.inputs}
        return free_motion(system, self._nodes, driven | {condition_owner(sensor) for sensor in self.sensors})

    def at(self, values: Sequence[float] | FloatArray) -> Evaluation:
        """Transfer functions and derivatives for these values of the parameters.

        Raises
        ------
        SolveError
            They are not finite there.
        ModelError
            A derived parameter cannot be calculated.
        """
        numbers = [float(value) for value in values]
        try:
            whole = augmented(self.unknowns, numbers, self._nodes, self._redundant)
        except (ZeroDivisionError, OverflowError, ExpressionError) as error:
            msg = f"the drivetrain cannot be calculated at {self._given(numbers)}: {error}"
            raise SolveError(msg) from None
        known, elements = self.unknowns.values(numbers), dict(self.unknowns.definition.elements)
        T, kept = self._motion
        readings = [reading(sensor, elements, whole, self._nodes, known).on(T, kept) for sensor in self.sensors]
        system, omega = whole.on(T, kept), 2 * np.pi * self.frequencies
        n = T.shape[1] + len(kept)
        block = max(1, BLOCK_BYTES // (16 * n * n))
        parts = [self._block(system, readings, omega[start : start + block]) for start in range(0, len(omega), block)]
        y, dy = (np.concatenate([part[i] for part in parts]) for i in (0, 1))
        found = self._quotient(y, dy)
        if not (np.isfinite(found.values).all() and np.isfinite(found.jacobian).all()):
            msg = f"the response is not finite at {self._given(numbers)}"
            raise SolveError(msg)
        return found

    def _given(self, numbers: Sequence[float]) -> str:
        return ", ".join(f"{name} = {x:.6g}" for name, x in zip(self.names, numbers, strict=True))

    def _block(
        self, system: Augmented, readings: Sequence[Reading], omega: FloatArray
    ) -> tuple[ComplexArray, ComplexArray]:
        """Readings under unit loads (n_f, n_readings, n_loads), and their derivatives."""
        kappa = system.kappa(omega)
        scale = float(np.median(np.abs(kappa[np.abs(kappa) > 0]))) if np.any(kappa) else 1.0
        rows, loads = rows_of(readings, system, kappa, omega), self._loads(system)
        n_nodes = system.laws.values.shape[1]
        right = np.concatenate([np.broadcast_to(loads, (len(omega), *loads.shape)), rows.transpose(0, 2, 1)], axis=2)
        scaled = right.copy()
        scaled[:, n_nodes:] *= scale
        try:
            with np.errstate(all="ignore"):
                solved = np.linalg.solve(system.matrix(kappa, scale), scaled)
        except np.linalg.LinAlgError:
            solved = np.full(right.shape, np.nan, dtype=complex)
        solved[:, n_nodes:] *= scale
        solution: ComplexArray = solved.astype(np.complex128)
        x, z = solution[:, :, : loads.shape[1]], solution[:, :, loads.shape[1] :]
        return rows @ x, _derivatives(system, readings, omega, kappa, x, z)

    def _loads(self, system: Augmented) -> ComplexArray:
        T, kept = self._motion
        n_q = T.shape[1]
        loads = np.zeros((n_q + len(kept), len(self.loads)), dtype=complex)
        names = {channel: name for name, channel in self.drivetrain.inputs.items()}
        for column, load in enumerate(self.loads):
            if load.quantity == "torque":
                loads[:n_q, column] = T[self._nodes.index(load.of)]
            else:
                loads[n_q + system.condition_owners.index(f"input:{names[load]}"), column] = 1.0
        return loads

    def _quotient(self, y: ComplexArray, dy: ComplexArray) -> Evaluation:
        if not self.question.is_measured:
            return Evaluation(y, dy)
        n_out = len(self.question.outputs)
        with np.errstate(all="ignore"):
            try:
                inverse = np.linalg.inv(y[:, n_out:])
            except np.linalg.LinAlgError:
                inverse = np.full(y[:, n_out:].shape, np.nan, dtype=complex)
            values = y[:, :n_out] @ inverse
            moved = dy[:, :n_out] - np.einsum("fom,fmip->foip", values, dy[:, n_out:])
            return Evaluation(values, np.einsum("foip,fij->fojp", moved, inverse))


def _derivatives(
    system: Augmented,
    readings: Sequence[Reading],
    omega: FloatArray,
    kappa: ComplexArray,
    x: ComplexArray,
    z: ComplexArray,
) -> ComplexArray:
    """Of y = c . x: dy = dc . x - z . dD x for every reading and load, (n_f, n_readings, n_loads, n_p)."""
    slopes = {law: list(system.kappa_slopes(law, omega)) for law in range(len(system.law_owners))}
    parts = [
        [
            reading_slopes(system, one, omega, kappa, slopes, x[:, :, load])
            - equation_slopes(system, kappa, slopes, x[:, :, load], z[:, :, number])
            for load in range(x.shape[2])
        ]
        for number, one in enumerate(readings)
    ]
    return np.asarray(np.array(parts).transpose(3, 0, 1, 2))


def parametric_response(
    drivetrain: Drivetrain,
    output: str | Sensor | Sequence[str | Sensor],
    input: str | Sensor | Sequence[str | Sensor],
    frequencies: ArrayLike,
    parameters: Sequence[str],
    *,
    excitation: str | Sequence[str] | None = None,
) -> ParametricResponse:
    """Transfer functions of a drivetrain as a function of some of its parameters.

    Parameters
    ----------
    drivetrain : Drivetrain
        In the configuration wanted; values not varied are taken from it.
    output, input, excitation
        As for :meth:`torsionnet.Drivetrain.frequency_response`.
    frequencies : (n_f,) array
        Hz, above 0.
    parameters : sequence of str
        Names of parameters, or ``element.field`` for a number in an element.

    Raises
    ------
    UsageError
        An unknown name, or a frequency that is not above 0.
    """
    f = np.atleast_1d(np.asarray(frequencies, dtype=float))
    if f.ndim != 1 or not np.all(np.isfinite(f)) or not np.all(f > 0):
        msg = "derivatives are taken at frequencies above 0, in Hz"
        raise UsageError(msg)
    question = ask(drivetrain, output, input, excitation)
    asked = [output] if isinstance(output, str | Sensor) else list(output)
    if question.is_measured:
        asked += [input] if isinstance(input, str | Sensor) else list(input)
    sensors = tuple(_sensor(drivetrain, entry) for entry in asked)
    redundant = tuple(sorted(drivetrain.assembly.kinematics.reduction.redundant))
    return ParametricResponse(
        drivetrain, question, f, unknowns(drivetrain, parameters), sensors, question.excitations, redundant
    )


def _sensor(drivetrain: Drivetrain, entry: str | Sensor) -> Sensor:
    found = as_sensor(drivetrain, entry)
    return Sensor("angle", str(entry)) if found is None else found
