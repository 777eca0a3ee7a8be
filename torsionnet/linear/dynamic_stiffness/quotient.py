"""Transfer functions at frequency points, from readings divided by measured inputs if there are any.

Responses with controllers and fluid couplings at work, calculated from responses without their torques.

An action drives a row by T = kappa(s) y, y the motion it senses. With the responses of the laws alone to excitations u
and to unit torques of the actions, y = Y_u u + Y_T T and z = Z_u u + Z_T T, so

    T = (I - kappa Y_T)^-1 kappa Y_u u

Elimination along the graph stays symmetric.

Rounding is told by the same calculation to seven digits. A point is certain where both agree.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.law_stiffness import LawStiffness
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.response_problem import ReadingProblem, ResponseProblem, eliminate
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest

CERTAIN = 2e-13
"""Relative error of a value that is certain, at which its calculation to seven digits is off by 0.01 %."""
SINGLE_SHARE = 2.0**-29
"""Rounding in double precision over that in single precision, and so what an elimination makes of the one over what it
makes of the other. Where 1e-9 is lost they agree to 0.01 % by chance at one point in five thousand."""
LEAST_SINGLE = 1e-30
"""Size of a value in SI units below which products on the way to it may be too small for single precision."""
NOTHING = float(np.finfo(float).tiny) / float(np.finfo(float).eps)
"""Size of a value in SI units up to which it counts as zero: smaller ones have no digits to lose."""
Evaluate: TypeAlias = Callable[[LawStiffness, bool], ComplexArray]
"""Calculation of values at all points (n_points, ...) from laws, in the other order of elimination if that is asked."""


class ClosedLoops(NamedTuple):
    """Readings (n_read, n_exc, n_points) per unit excitation with controllers at work, and torques of these in N m.

    The torques are (n_act, n_exc, n_points).
    """

    values: ComplexArray
    torques: ComplexArray


def close_loops(reading_problem: ReadingProblem, laws: LawStiffness, values: ComplexArray) -> ClosedLoops:
    """Readings per unit excitation with controllers at work, from ``values`` calculated without their torques.

    These ``values`` are responses to the excitations, then to a unit torque of each action.
    """
    n_exc, n_act = reading_problem.n_excitations, len(reading_problem.sensed)
    if len(laws.actions) != n_act:
        raise SolveError(
            "this calculation does not include the torques of controllers; switch them off", kind="unsupported-law"
        )
    gains = np.array([values_.ravel() for values_ in laws.actions])
    # kappa Y_u and kappa Y_T of the motions that actions sense
    with np.errstate(all="ignore"):
        sensed = gains[:, None, :] * values[list(reading_problem.sensed)]
        by_torque, by_excitation = np.moveaxis(sensed[:, n_exc:], 2, 0), np.moveaxis(sensed[:, :n_exc], 2, 0)
        # T = (I - kappa Y_T)^-1 kappa Y_u u
        torques = np.moveaxis(_action_torques(np.eye(n_act) - by_torque, by_excitation), 0, 2)
        # z = Z_u u + Z_T T
        total = values[:, :n_exc] + np.einsum("rap,aep->rep", values[:, n_exc:], torques)
    return ClosedLoops(total, torques)


def _action_torques(loop: ComplexArray, right: ComplexArray) -> ComplexArray:
    """Torques of the actions (n_points, n_act, n_exc) in N m, nan where the loops have no solution."""
    if loop.shape[1] == 1:
        return np.asarray(right / loop)
    finite = np.isfinite(loop).all(axis=(1, 2)) & np.isfinite(right).all(axis=(1, 2))
    torques: ComplexArray = np.full(right.shape, np.nan + 0j)
    for point in np.flatnonzero(finite):
        with contextlib.suppress(np.linalg.LinAlgError):
            torques[point] = np.linalg.solve(loop[point], right[point])
    return torques


COMPILED_WORK = 1e9
"""Tape operations times frequency points above which the compiled loop saves more than the second or two that starting
it takes."""


def chosen_method(problem: ResponseProblem, n_points: int, method: str) -> str:
    """Name of the solver to use, for ``auto`` the compiled loop for many points wherever numba works, else numpy."""
    if method != "auto":
        return method
    tapes = (part.planned[1] for _, part in problem.eliminations)
    is_large = n_points * sum(len(tape.operations) for tape in tapes) >= COMPILED_WORK
    return "compiled" if is_large and compiled_works() else "graph"


def compiled_works() -> bool:
    """Whether the compiled loop can be used, that is whether numba is installed and works with this numpy.

    numpy can do the same.
    """
    with contextlib.suppress(Exception):
        import torsionnet.linear.dynamic_stiffness.compiled  # noqa: F401

        return True
    return False


def respond(problem: ResponseProblem, laws: LawStiffness) -> ComplexArray:
    """Motions (rad) and reactions (N m) per unit excitation, (n_read, n_exc, n_points), from all ``laws``.

    Large problems take the compiled loop where it works. Only their size decides, so that a result does not depend on
    what was calculated before.
    """
    if chosen_method(problem, laws.n_points, "auto") == "compiled":
        with contextlib.suppress(Exception):
            return respond_compiled(problem, laws)
    return eliminate(problem, laws)


def respond_compiled(problem: ResponseProblem, laws: LawStiffness) -> ComplexArray:
    """Motions (rad) and reactions (N m) per unit excitation by the compiled loop, (n_read, n_exc, n_points).

    Raises
    ------
    MissingExtraError
        numba is not installed.
    """
    import torsionnet.linear.dynamic_stiffness.compiled as compiled

    return eliminate(problem, laws, compiled.sweep)


Respond: TypeAlias = Callable[[ResponseProblem, LawStiffness], ComplexArray]


def _respond_densely(problem: ResponseProblem, laws: LawStiffness) -> ComplexArray:
    from torsionnet.linear.dynamic_stiffness.dense import respond

    return respond(problem, laws)


METHODS: dict[str, Respond] = {
    "auto": respond,
    "graph": eliminate,
    "compiled": respond_compiled,
    "dense": _respond_densely,
}


@dataclass(frozen=True)
class FrequencyPoints:
    """Transfer functions (n_points, n_out, n_in), and conditioning (n_points,) of measured inputs."""

    values: ComplexArray
    conditioning: FloatArray


def transfer_functions(
    request: TransferRequest,
    laws: LawStiffness,
    method: str = "auto",
    *,
    other_order: bool = False,
    values_alone: bool = False,
) -> FrequencyPoints:
    """Transfer functions (n_points, n_out, n_in) of a request at all frequency points of the ``laws``.

    With ``other_order`` another order of elimination is used. ``values_alone`` leaves the conditioning at 1.
    """
    reading_problem, n_out = request.reading_problem, len(request.outputs)
    if other_order:
        reading_problem = reading_problem.in_other_order
    method = chosen_method(reading_problem.problem, laws.n_points, method)
    if method == "compiled" and (whole := _compiled(request, reading_problem, laws)) is not None:
        points = np.flatnonzero(~np.isfinite(whole.values).all(axis=(1, 2)))
        if len(points):  # beyond its range, or infinite
            again = transfer_functions(request, laws.at(points), "graph", other_order=other_order)
            whole.values[points], whole.conditioning[points] = again.values, again.conditioning
        return whole
    loops = ClosedLoops(METHODS[method](reading_problem.problem, laws), np.empty(0, dtype=complex))
    if reading_problem.sensed:
        loops = close_loops(reading_problem, laws, loops.values)
    # Readings y = L(s) q + direct u of all outputs, then measured inputs, per unit excitation.
    readings = np.empty((laws.n_points, len(reading_problem.readings), loops.values.shape[1]), dtype=complex)
    with np.errstate(invalid="ignore"):
        for number, reading in enumerate(reading_problem.readings):
            readings[:, number] = reading.contribution(laws, loops.values).T
            for action, factor in reading_problem.driven[number].items():
                readings[:, number] += float(factor) * loops.torques[action].T
    values, conditioning = readings[:, :n_out], np.ones(laws.n_points)
    if request.is_measured:
        # Y_out Y_in^-1, equations (8)-(13) of Galvagno et al. (2015). Both readings have det D as denominator, which
        # cancels: the poles are the zeros of the measured input (natural_modes.poles_against_measured).
        measured = readings[:, n_out:]
        values, apart = _divide(values, measured)
        if not values_alone:
            # Conditioning: measured inputs over the sum of the magnitudes of their terms, largest of any excitation.
            sizes = np.zeros(measured.shape)
            with np.errstate(all="ignore"):
                for number in range(measured.shape[1]):
                    terms, applied = reading_problem.terms[n_out + number], reading_problem.applied[n_out + number]
                    magnitudes = (np.abs(term.contribution(laws, loops.values)).T for term in terms)
                    sizes[:, number] = sum(magnitudes, start=np.abs(applied))
                shares = np.divide(np.abs(measured), sizes, out=np.zeros(sizes.shape), where=sizes > 0)
            conditioning = shares.max(axis=2).min(axis=1) * apart
    return FrequencyPoints(values, conditioning)


def rounding_errors(evaluate: Evaluate, laws: LawStiffness, values: ComplexArray) -> FloatArray:
    """Relative errors of ``values`` (n_points, ...) by rounding, as ``evaluate`` made them; inf where unknown."""
    with np.errstate(all="ignore"):
        # Laws and actions to seven digits: their elimination is then calculated to seven digits, too.
        J, c, k, omega = (part.astype("f4") for part in (laws.inertia, laws.damping, laws.stiffness, laws.omega))
        sampled: Any = tuple((law, sample.astype("c8")) for law, sample in laws.sampled)
        actions: Any = tuple(sample.astype("c8") for sample in laws.actions)
        short = replace(laws, inertia=J, damping=c, stiffness=k, omega=omega, sampled=sampled, actions=actions)
        again = evaluate(short, False)
        errors = SINGLE_SHARE * np.abs(again - values) / np.maximum(np.abs(values), NOTHING)
    # Beyond the range of single precision its result says nothing.
    beyond = (np.abs(again) < LEAST_SINGLE) & (errors > CERTAIN)
    return np.where(np.isfinite(values) & np.isfinite(errors) & ~beyond, errors, np.inf)


def uncertain_points(errors: FloatArray, n_variants: int) -> NDArray[np.bool_]:
    """Mask (n_points,) of points at which rounding shows, from the errors (n_points, ...) of their values."""
    differ = (errors > CERTAIN).any(axis=tuple(range(1, errors.ndim))).reshape(n_variants, -1)
    # Roundings may agree by chance, at one point next to a resonance in some thousand; at its neighbours they do not.
    beside = differ.copy()
    beside[:, 1:] |= differ[:, :-1]
    beside[:, :-1] |= differ[:, 1:]
    return np.asarray(beside.ravel())


def _compiled(request: TransferRequest, reading_problem: ReadingProblem, laws: LawStiffness) -> FrequencyPoints | None:
    """Transfer functions (n_points, n_out, n_in) by one compiled loop, or None for requests it cannot handle."""
    import torsionnet.linear.dynamic_stiffness.compiled as compiled
    from torsionnet.linear.dynamic_stiffness.compiled import reading_table

    parts, n_out = reading_problem.problem.eliminations, len(request.outputs)
    tables = [reading_table(reading_problem, n_out, len(excitations)) for excitations, _ in parts]
    values = np.empty((laws.n_points, n_out, reading_problem.n_excitations), dtype=complex)
    conditioning = np.ones(laws.n_points)
    for (excitations, part), table in zip(parts, tables, strict=True):
        if table is None:
            return None
        plan, tape = part.planned
        slots = laws.law_sums(len(plan.sources), plan.law_terms)
        block, conditioning = compiled.read(tape, slots, table, laws.only(table.laws))
        if len(parts) == 1:
            values = block
        else:
            values[:, :, excitations] = block
    return FrequencyPoints(values, conditioning)


def _divide(outputs: ComplexArray, measured: ComplexArray) -> tuple[ComplexArray, FloatArray]:
    """Quotient Y_out Y_in^-1, and reciprocal condition of Y_in, at every point.

    The latter is 1 at best and 0 where it does not at all; there the quotient is inf.
    """
    n_points, n_in, _ = measured.shape
    with np.errstate(all="ignore"):
        if n_in == 1:
            quotient = np.where(measured == 0, np.inf + 0j, outputs / measured)
            return quotient, np.ones(n_points)
        # Rows and columns of one size: units of readings and excitations say nothing of the condition.
        rows = np.abs(measured).max(axis=2, keepdims=True)
        columns = (np.abs(measured) / rows).max(axis=1, keepdims=True)
        normed = measured / rows / columns
        normed[~np.isfinite(normed)] = 0.0
        singular = np.linalg.svd(normed, compute_uv=False)
        apart = singular[:, -1] / np.maximum(singular[:, 0], 1e-300)
        scale = 1 / columns.swapaxes(1, 2) / rows.swapaxes(1, 2)
        return outputs @ (_inverse(normed) * scale), apart


def _inverse(matrices: ComplexArray) -> ComplexArray:
    """Inverses (n_points, n, n) of matrices, inf where singular."""
    if matrices.shape[1] == 2:
        (a, b), (c, d) = matrices.transpose(1, 2, 0)
        return np.asarray(np.array([[d, -b], [-c, a]]) / (a * d - b * c)).transpose(2, 0, 1)
    inverse = np.empty(matrices.shape, dtype=complex)
    for number, matrix in enumerate(matrices):
        try:
            inverse[number] = np.linalg.inv(matrix)
        except np.linalg.LinAlgError:
            inverse[number] = np.inf
    return inverse
