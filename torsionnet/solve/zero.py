"""Transfer functions in the limit of zero frequency, also where the drivetrain turns freely.

There the static stiffness is singular while ratios of readings may still have a finite limit. The readings are
evaluated at two very small real s with many digits, which tells a finite limit from one that grows without bound.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from torsionnet.assembly.functionals import Functional, Term
from torsionnet.assembly.rows import ComplexArray
from torsionnet.assembly.system import Assembly, smallest_rate
from torsionnet.channels import Input
from torsionnet.drivetrain import Drivetrain
from torsionnet.elimination import exact, reduce_rows
from torsionnet.kinematics import exact_row, pseudo_node
from torsionnet.solve.question import Question

DIGITS = 160
SMALL = 30
"""s is 10^-30 of the slowest rate of the system; a pole of second order leaves 160 - 60 digits."""

LOAD = "load"


def at_zero(drivetrain: Drivetrain, question: Question) -> ComplexArray:
    """Limit (n_out, n_in) for s -> 0; inf where it grows without bound."""
    import mpmath

    assembly = drivetrain.assembly
    with mpmath.workdps(DIGITS):
        start = mpmath.mpf(smallest_rate(assembly.system)) * mpmath.mpf(10) ** -SMALL
        first, second = (_transfer(assembly, question, s) for s in (start, start / 10))
        return np.array(
            [[_limit(a, b) for a, b in zip(*rows, strict=True)] for rows in zip(first, second, strict=True)]
        )


def _limit(first: Any, second: Any) -> complex:
    """The value two steps agree on: ten times larger at a tenth of s is a pole, ten times smaller a zero."""
    if first is None or second is None or abs(second) > 5 * abs(first):
        return complex(np.inf, 0.0)
    return 0j if abs(second) < abs(first) / 5 else complex(second)


def _transfer(assembly: Assembly, question: Question, s: Any) -> list[list[Any]]:
    import mpmath

    solutions = [_solve(assembly, excitation, s) for excitation in question.excitations]
    outputs = _readings(assembly, question.outputs, question.excitations, solutions, s)
    if not question.is_measured:
        return outputs
    measured = _readings(assembly, question.measured, question.excitations, solutions, s)
    try:
        quotient = mpmath.matrix(outputs) * mpmath.inverse(mpmath.matrix(measured))
    except ZeroDivisionError:
        return [[None] * len(question.measured) for _ in outputs]
    return [[quotient[row, column] for column in range(len(measured))] for row in range(len(outputs))]


def _number(value: Any) -> Any:
    """A rational or float with all its digits; the ratio of two integers keeps 10 * 0.1 at 1."""
    import mpmath

    fraction = exact(value)
    return mpmath.mpf(fraction.numerator) / fraction.denominator


def _kappa(assembly: Assembly, s: Any) -> list[Any]:
    import mpmath

    kappa = [
        (0 if law.loss_factor else _number(law.stiffness)) + s * (_number(law.damping) + s * _number(law.inertia))
        for law in assembly.laws
    ]
    for index, law in assembly.system.dynamic:
        kappa[index] += mpmath.mpmathify(complex(law(np.zeros(1))[0]))
        table = assembly.laws[index].table
        if table is not None:
            kappa[index] += s * _number(table.damping[0])
    return kappa


def _solve(assembly: Assembly, excitation: Input, s: Any) -> dict[str, Any]:
    """Every coordinate and imposed angle under a unit excitation, by name."""
    kinematics = assembly.kinematics
    motion = {pseudo_node(name): _number(0) for name in kinematics.imposed}
    equations: dict[str, dict[str, Any]] = {name: {} for name in kinematics.coordinates}
    effect = exact_row(kinematics.reduced({excitation.of: 1}))
    if excitation.quantity == "torque":
        for name in effect.keys() & equations.keys():
            equations[name][LOAD] = -_number(effect[name])
    else:
        motion |= {name: _number(share) for name, share in effect.items()}
    for kappa, row in zip(_kappa(assembly, s), assembly.exact_rows, strict=True):
        follows = sum((_number(row[name]) * motion[name] for name in row.keys() & motion.keys()), start=_number(0))
        free = [name for name in row if name in equations]
        for i in free:
            for j in free:
                _add(equations[i], j, kappa * _number(row[i] * row[j]))
            _add(equations[i], LOAD, kappa * _number(row[i]) * follows)
    order = {name: index for index, name in enumerate(equations)}
    solved = reduce_rows(list(equations.values()), order, {LOAD}).solved
    return motion | {name: solved.get(name, {}).get(LOAD, _number(0)) for name in equations}


def _add(row: dict[str, Any], name: str, value: Any) -> None:
    row[name] = row.get(name, 0) + value


def _readings(
    assembly: Assembly,
    readings: Sequence[Functional],
    excitations: Sequence[Input],
    solutions: Sequence[dict[str, Any]],
    s: Any,
) -> list[list[Any]]:
    kappa = _kappa(assembly, s)
    table = []
    for reading in readings:
        row = []
        for excitation, motion in zip(excitations, solutions, strict=True):
            total = sum((_term(term, motion, kappa, s) for term in reading.terms), start=s * 0)
            direct = reading.direct.get(excitation.of, 0.0) if excitation.quantity == "torque" else 0.0
            row.append(total + direct)
        table.append(row)
    return table


def _term(term: Term, motion: dict[str, Any], kappa: list[Any], s: Any) -> Any:
    gamma = sum((_number(share) * motion[name] for name, share in term.exact.items()), start=s * 0)
    return _number(term.factor) * gamma * (s**term.power if term.law is None else kappa[term.law])
