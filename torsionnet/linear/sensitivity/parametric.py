"""Transfer functions of a drivetrain as functions of its parameters, with exact derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.base.expressions import ExpressionError
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.law_stiffness import LawStiffness
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.quotient import respond, rounding_errors, uncertain_points
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest, resolve_request
from torsionnet.linear.responses.transfer import ACCEPTED_ERROR, expected_errors, frequency_response
from torsionnet.linear.sensitivity.augmented import Augmented, augmented
from torsionnet.linear.sensitivity.derivative_problem import DerivativeProblem, law_stiffness_of
from torsionnet.linear.sensitivity.unknowns import DUALS, Unknowns, gradient_of, unknowns
from torsionnet.model.channels import Input, Sensor
from torsionnet.model.element_base.round_section import section_modulus
from torsionnet.model.elements import Values
from torsionnet.model.readings import referring_factor


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Transfer functions (n_f, n_out, n_in) for one set of parameters, and derivatives (n_f, n_out, n_in, n_p).

    Both are in SI units.
    """

    values: ComplexArray
    jacobian: ComplexArray


@dataclass(frozen=True, eq=False)
class ParametricResponse:
    """Transfer functions of one drivetrain, with exact derivatives, as functions of some of its parameters.

    Nothing is checked again from one set of values to the next, so a fit can ask thousands of times.

    Examples
    --------
    >>> import torsionnet as tn
    >>> response = parametric_response(tn.load("dmf_rig"), "theta_1", "T_T", [8.0], ["c_2", "k_2"])
    >>> evaluation = response.evaluation([4.0, 460.0])
    >>> bool(abs(evaluation.jacobian[0, 0, 0, 0]) > 0), evaluation.jacobian.shape
    (True, (1, 1, 1, 2))
    """

    drivetrain: AssembledModel
    request: TransferRequest
    frequencies: FloatArray
    unknowns: Unknowns
    sensors: tuple[Sensor, ...]
    loads: tuple[Input, ...]
    _redundant: tuple[int, ...] = field(repr=False, default=())
    _known: list[tuple[Any, DerivativeProblem]] = field(repr=False, default_factory=list)

    @property
    def names(self) -> tuple[str, ...]:
        return self.unknowns.names

    @property
    def unit(self) -> str:
        """SI unit of the first output over the first input of the transfer functions, 1 for a ratio of like signals."""
        output, into = self.request.outputs[0].unit, self.request.inputs[0].unit
        return "1" if output == into else f"{output}/({into})" if "*" in into else f"{output}/{into}"

    @property
    def start(self) -> FloatArray:
        """Parameter values (n_p,) of the drivetrain as given, in SI units."""
        return np.array(self.unknowns.start)

    @cached_property
    def _nodes(self) -> tuple[str, ...]:
        return self.drivetrain.assembly.kinematics.nodes

    def evaluation(self, values: Sequence[float] | FloatArray) -> Evaluation:
        """Transfer functions and derivatives, in SI units, for these parameter values (n_p,).

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
            raise SolveError(
                f"the drivetrain cannot be calculated at {self._given(numbers)}: {error}", kind="no-solution"
            ) from None
        derivatives, omega = self._problem(whole, numbers), 2 * np.pi * self.frequencies
        laws = law_stiffness_of(whole, omega)
        solved = respond(derivatives.problem, laws)
        # The motions under the readings as loads are among those solved: dy = -z^T dK x for all parameters at once.
        y = derivatives.values(solved, laws.s)
        dy = derivatives.slopes(solved, whole, laws.by_law, laws.s, omega)
        evaluation = self._quotient(*self._stressed(y, dy, numbers))
        if np.isfinite(numbers).all():
            self._settle(derivatives, laws, evaluation.values, numbers)
        if not (np.isfinite(evaluation.values).all() and np.isfinite(evaluation.jacobian).all()):
            raise SolveError(f"the response is not finite at {self._given(numbers)}", kind="not-finite")
        return evaluation

    def _problem(self, system: Augmented, numbers: Sequence[float]) -> DerivativeProblem:
        """Response problem that gives readings and derivatives, kept while no parameter changes a row."""
        slopes = (system.law_slopes, system.condition_slopes)
        key = (system.exact_laws, system.exact_conditions, *(part.tobytes() for part in slopes))
        if self._known and self._known[0][0] == key:
            return self._known[0][1]
        elements, names = dict(self.unknowns.definition.elements), self.drivetrain.inputs.items()
        channels = {channel: name for name, channel in names}
        values = self.unknowns.values(numbers)
        # A section and a shaft referred to scale readings and are no part of the equations, which are in torques.
        torques = [replace(at, quantity="torque") if at.quantity == "stress" else at for at in self.sensors]
        torques = [replace(sensor, referred_to=None) for sensor in torques]
        derivatives = DerivativeProblem(system, torques, elements, values, self.loads, channels, self._nodes)
        self._known[:] = [(key, derivatives)]
        return derivatives

    def _stressed(
        self, y: ComplexArray, dy: ComplexArray, numbers: Sequence[float]
    ) -> tuple[ComplexArray, ComplexArray]:
        """Readings and their derivatives, converted from torque to stress or referred to another shaft on request.

        The section is no law, nor is the shaft referred to: they move readings, and nothing in the equations.
        """
        values, elements = Values(self.unknowns.values(numbers), DUALS), self.unknowns.definition.elements
        for place, sensor in enumerate(self.sensors):
            if sensor.quantity == "stress" or sensor.referred_to is not None:
                factor = (
                    1 / section_modulus(elements[sensor.of], values)
                    if sensor.quantity == "stress"
                    else referring_factor(sensor, elements, values)
                )
                # d(f y) = f dy + y df; dy goes first, while y is still the torque.
                moved = gradient_of(factor, dy.shape[-1])
                dy[:, place] = float(factor) * dy[:, place] + y[:, place, :, None] * moved
                y[:, place] *= float(factor)
        return y, dy

    def _given(self, numbers: Sequence[float]) -> str:
        return ", ".join(f"{name} = {x:.6g}" for name, x in zip(self.names, numbers, strict=True))

    def _settle(
        self, derivatives: DerivativeProblem, laws: LawStiffness, values: ComplexArray, numbers: Sequence[float]
    ) -> None:
        """Replace transfer functions (n_f, n_out, n_in) in which rounding shows by those of the drivetrain itself."""

        def evaluate(some: LawStiffness, other_order: bool) -> ComplexArray:
            problem = derivatives.problem.in_other_order if other_order else derivatives.problem
            y = derivatives.values(respond(problem, some), some.s)
            return self._quotient(*self._stressed(y, np.zeros((*y.shape, len(numbers)), dtype=complex), numbers)).values

        rounding = rounding_errors(evaluate, laws, values)
        points = np.flatnonzero(uncertain_points(rounding, 1))
        errors = expected_errors(evaluate, laws.at(points), values[points], rounding[points])
        poor = points[(errors > ACCEPTED_ERROR).any(axis=(1, 2))]
        if len(poor):
            # Rounding would show: the drivetrain is assembled at these values and solved by itself.
            changed = AssembledModel.from_definition(self.unknowns.definition).configured(
                **dict(zip(self.unknowns.parameters, numbers, strict=True))
            )
            n_out = len(self.request.outputs)
            measured = {"input": list(self.sensors[n_out:]), "excitation": list(self.loads)}
            asked = measured if self.request.is_measured else {"input": list(self.loads)}
            f = self.frequencies[poor]
            values[poor] = frequency_response(changed, list(self.sensors[:n_out]), frequencies=f, **asked).values

    def _quotient(self, y: ComplexArray, dy: ComplexArray) -> Evaluation:
        if not self.request.is_measured:
            return Evaluation(y, dy)
        n_out = len(self.request.outputs)
        # H = Y_out Y_in^-1 and dH = (dY_out - H dY_in) Y_in^-1
        with np.errstate(all="ignore"):
            try:
                inverse = np.linalg.inv(y[:, n_out:])
            except np.linalg.LinAlgError:
                inverse = np.full(y[:, n_out:].shape, np.nan, dtype=complex)
            values = y[:, :n_out] @ inverse
            moved = dy[:, :n_out] - np.einsum("fom,fmip->foip", values, dy[:, n_out:])
            return Evaluation(values, np.einsum("foip,fij->fojp", moved, inverse))


def parametric_response(
    drivetrain: AssembledModel,
    output: str | Sensor | Sequence[str | Sensor],
    input: str | Sensor | Sequence[str | Sensor],
    frequencies: ArrayLike,
    parameters: Sequence[str],
    *,
    driven_by: str | Sequence[str] | None = None,
) -> ParametricResponse:
    """Transfer functions of a drivetrain, ready to be evaluated with derivatives at any values of some parameters.

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
        raise UsageError("derivatives are taken at frequencies above 0, in Hz", kind="out-of-range")
    request = resolve_request(drivetrain, output, input, driven_by)
    redundant = drivetrain.assembly.kinematics.reduction.redundant
    return ParametricResponse(
        drivetrain, request, f, unknowns(drivetrain, parameters), request.sensors, request.excitations, redundant
    )
