"""Readings in many decimal digits from the exact values of a model, for the few points where doubles do not suffice.

All numbers are the rationals an author wrote, s may be any complex number. The tape is that of the same plan, made from
exact rows, and a third walk along it does in mpmath what the others do in numpy and numba. What cancels to less than
the digits left of its terms is zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torsionnet.linear.dynamic_stiffness.tape as ops
from torsionnet.base.errors import SolveError
from torsionnet.base.expressions import exact
from torsionnet.linear.assembly.action_laws import ActionLaw, polynomial
from torsionnet.linear.assembly.rows import Assembly
from torsionnet.linear.dynamic_stiffness.response_problem import SolvedTerm, make_reading_problem
from torsionnet.linear.dynamic_stiffness.row_algebra import Accuracy
from torsionnet.linear.dynamic_stiffness.tape import Tape
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest
from torsionnet.model.elements import Law

CALCULATION_DIGITS = 200
"""Decimal digits of a response calculated in many digits, far more than any drivetrain met so far has cancelled."""
TRUSTED_SHARE = 0.55
"""Share of the decimal digits that are trusted in a sum, since the others allow for poles near s and for spreads of the
values."""
KNOWN_SHARE = 0.9
"""Share of the decimal digits that are known of coefficients in rows, as products around a loop lose few."""


class ManyDigits:
    """Transfer functions of a request at single complex values of s, in as many digits as ``mpmath.workdps`` says."""

    def __init__(self, assembly: Assembly, request: TransferRequest) -> None:
        self.request: TransferRequest = request
        self.laws: tuple[Law, ...] = assembly.laws
        self.actions: tuple[ActionLaw, ...] = assembly.system.actions
        measured = request.inputs if request.is_measured else ()
        self.reading_problem = make_reading_problem(
            assembly, request.outputs, measured, request.excitations, in_many_digits, _accuracy()
        )

    def transfer(self, s: Any) -> list[list[Any]] | None:
        """Transfer functions [output][input] at one s as mpmath numbers, None where inputs depend on each other.

        Raises
        ------
        SolveError
            No digits are left.
        """
        kappa = [_dynamic_stiffness(law, s) for law in self.laws]
        readings, n_out = self._readings(kappa, s), len(self.request.outputs)
        return _quotient(readings[:n_out], readings[n_out:]) if self.request.is_measured else readings

    def _readings(self, kappa: Sequence[Any], s: Any) -> list[list[Any]]:
        """Readings of outputs and measured inputs per unit excitation at one s, [reading][excitation]."""
        problem = self.reading_problem.problem
        solved = [[in_many_digits(0)] * len(problem.excitations) for _ in range(problem.n_read)]
        # The tapes of double precision, with numbers of many digits.
        for excitations, part in problem.eliminations:
            plan, tape = part.planned
            slots = [sum(factor * kappa[law] for law, factor in source) for source in plan.sources]
            for value, quantity in run_tape(tape, slots).items():
                reading, place = divmod(value, len(excitations))
                solved[reading][excitations[place]] = quantity
        solved, torques = self._closed(solved, s) if self.actions else (solved, [])
        readings = [
            [_factor(term, kappa, s) * motion for motion in solved[term.solved]]
            for term in self.reading_problem.readings
        ]
        # The torque read at an element has that of its own actions in it.
        for values, driven in zip(readings, self.reading_problem.driven, strict=True):
            for action, factor in driven.items():
                values[:] = [
                    value + in_many_digits(factor) * t for value, t in zip(values, torques[action], strict=True)
                ]
        return readings

    def _closed(self, solved: list[list[Any]], s: Any) -> tuple[list[list[Any]], list[list[Any]]]:
        """Solved motions and reactions with actions at work, and torques of actions in N m, per unit excitation."""
        n, gains = self.reading_problem.n_excitations, [_action_gain(action, s) for action in self.actions]
        sensed = [
            [gain * value for value in solved[row]]
            for gain, row in zip(gains, self.reading_problem.sensed, strict=True)
        ]
        places = range(len(gains))
        # T = (I - kappa Y_T)^-1 kappa Y_u u
        loop = [[_left([in_many_digits(int(i == j)), -sensed[i][n + j]]) for j in places] for i in places]
        transposed = [[loop[j][i] for j in places] for i in places]
        excited = [[sensed[i][e] for i in places] for e in range(n)]
        # The quotient has its inverse on the right, so that both sides are transposed.
        by_excitation = _quotient(excited, transposed)
        if by_excitation is None:
            raise SolveError(
                "the closed loop of a controller has a pole at this frequency; leave the frequency out",
                kind="no-solution",
            )
        torques = [[row[i] for row in by_excitation] for i in places]
        every = [[_left([row[e], *(row[n + i] * torques[i][e] for i in places)]) for e in range(n)] for row in solved]
        return every, torques


def _accuracy() -> Accuracy:
    """Accuracy of row coefficients (tolerance, rounding) at the number of digits that mpmath now has."""
    import mpmath

    digits = round(KNOWN_SHARE * mpmath.mp.dps)
    return Accuracy(mpmath.mpf(10) ** -digits, lambda value: mpmath.nstr(value, digits))


def run_tape(tape: Tape, kappa: Sequence[Any]) -> dict[int, Any]:
    """Output values of a tape by number, as mpmath numbers, from the dynamic stiffness in N m/rad of each slot.

    Raises
    ------
    SolveError
        A pivot vanishes.
    """
    r: list[Any] = [None] * tape.n_registers
    values: dict[int, Any] = {}
    # Each operation as the head of tape.py says, r_t from r_a and r_b.
    for code, t, a, b, slot, factor in tape.steps:
        if code == ops.LAW:
            r[t] = kappa[slot]
        elif code == ops.LAW_SUM:
            r[t] = _left([kappa[slot], factor * r[a] * r[b]])
        elif code == ops.CONSTANT:
            r[t] = in_many_digits(0) + factor
        elif code == ops.SUM:
            r[t] = _left([r[a], factor * r[b]])
        elif code == ops.PRODUCT:
            r[t] = r[a] * r[b]
        elif code in (ops.LAW_SHARE, ops.QUOTIENT, ops.INVERSE):
            above, rest = (kappa[slot], r[a]) if code == ops.LAW_SHARE else (r[a], r[b])
            above, below = (1, r[a]) if code == ops.INVERSE else (above, _left([rest, factor * above]))
            if not below:
                raise SolveError(
                    "the response at this frequency is lost in rounding errors; choose another frequency",
                    kind="no-solution",
                )
            r[t] = above / below
        elif code == ops.OUTPUT:
            values[t] = factor * r[a]
    return values


def _factor(part: SolvedTerm, kappa: Sequence[Any], s: Any) -> Any:
    """Factor that turns a solved motion or reaction into its part of a reading at s, as an mpmath number."""
    if part.term is None:
        return in_many_digits(part.factor)
    return in_many_digits(part.term.factor) * (s**part.term.power if part.term.law is None else kappa[part.term.law])


def _action_gain(action: ActionLaw, s: Any) -> Any:
    """Transfer function torque / sensed angle of an action at s, in N m/rad, as an mpmath number."""
    import mpmath

    above, below = (
        polynomial([in_many_digits(value) for value in part], s) for part in (action.numerator, action.denominator)
    )
    if not below:
        raise SolveError(
            f"the transfer function of {action.owner} has a pole at this frequency; leave the frequency out",
            kind="no-solution",
        )
    return above / below * (mpmath.exp(-s * in_many_digits(action.delay)) if action.delay else 1)


def _dynamic_stiffness(law: Law, s: Any) -> Any:
    import mpmath

    # kappa = k (1 + j eta) + c s + J s^2
    loss = mpmath.mpc(0, in_many_digits(law.loss_factor)) if law.loss_factor else 0
    total = in_many_digits(law.stiffness) * (1 + loss) + s * (
        in_many_digits(law.damping) + s * in_many_digits(law.inertia)
    )
    if law.table is not None:
        total += law.table.in_many_digits(s)
    return total


def in_many_digits(value: Any) -> Any:
    """The mpmath number of a rational or float with all its digits.

    It is a ratio of two integers, so that 10 * 0.1 is 1.
    """
    import mpmath

    fraction = exact(value)
    return mpmath.mpf(fraction.numerator) / fraction.denominator


def _quotient(outputs: list[list[Any]], measured: list[list[Any]]) -> list[list[Any]] | None:
    """Transfer functions, outputs times the inverse of the measured inputs, or None where that inverse does not exist.

    Sums that cancel completely are set to 0.

    By Cramer's rule: an elimination would leave rounding in place of zeros of the inverse.
    """
    places = range(len(measured))
    every = (1 << len(measured)) - 1
    # (M^-1)_kj = (-1)^(k+j) det(M without row j and column k)/det M
    whole = _minors(measured).get(every, in_many_digits(0))
    if not whole:
        return None
    inverse: list[list[Any]] = [[in_many_digits(0)] * len(measured) for _ in places]
    for j in places:
        minors = _minors([*measured[:j], *measured[j + 1 :]])
        for k in places:
            inverse[k][j] = (-1) ** (k + j) * minors.get(every ^ (1 << k), in_many_digits(0)) / whole
    parts = [[[row[k] * inverse[k][j] for k in places] for j in places] for row in outputs]
    return [[_left(terms) for terms in row] for row in parts]


def _minors(rows: Sequence[Sequence[Any]]) -> dict[int, Any]:
    """Determinants of the rows on each choice of as many columns, by the bits of the chosen columns.

    Those missing are 0.
    """
    # Laplace's expansion row by row: the sign is that of the columns already chosen behind the new one.
    minors = {0: in_many_digits(1)}
    for row in rows:
        terms: dict[int, list[Any]] = {}
        for chosen, minor in minors.items():
            for column, value in enumerate(row):
                if value and minor and not chosen >> column & 1:
                    sign = (-1) ** (chosen >> column).bit_count()
                    terms.setdefault(chosen | 1 << column, []).append(sign * value * minor)
        minors = {chosen: _left(parts) for chosen, parts in terms.items()}
    return minors


def _left(terms: Sequence[Any]) -> Any:
    """Sum of mpmath numbers, exactly 0 where all trusted digits of its terms cancel."""
    import mpmath

    total = sum(terms)
    least = mpmath.mpf(10) ** -round(TRUSTED_SHARE * mpmath.mp.dps) * sum(abs(term) for term in terms)
    return total if abs(total) > least else in_many_digits(0)
