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
from torsionnet.elimination import reduce_rows
from torsionnet.solve.question import Question

DIGITS = 160
SMALL = 30
"""s is 10^-30 of the slowest rate of the system; a pole of second order leaves 160 - 60 digits."""


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


def _kappa(assembly: Assembly, s: Any) -> list[Any]:
    import mpmath

    system = assembly.system
    kappa = [
        mpmath.mpf(k) + s * (mpmath.mpf(c) + s * mpmath.mpf(j))
        for j, c, k in zip(system.inertia, system.damping, system.stiffness, strict=True)
    ]
    for index, law in system.dynamic:
        kappa[index] += mpmath.mpmathify(complex(law(np.zeros(1))[0]))
    return kappa


def _solve(assembly: Assembly, excitation: Input, s: Any) -> tuple[list[Any], list[Any]]:
    """Coordinates and imposed angles under a unit excitation."""
    imposed: list[Any] = [0.0] * assembly.imposed_rows.shape[1]
    loads: list[Any] = [0.0] * assembly.system.n_coordinates
    if excitation.quantity == "torque":
        loads = [float(value) for value in assembly.rows_of({excitation.of: 1})[0]]
    else:
        imposed = [float(value) for value in assembly.rows_of({excitation.of: 1})[1]]
    equations: list[dict[Any, Any]] = [{"load": -load} if load else {} for load in loads]
    for index, kappa in enumerate(_kappa(assembly, s)):
        row = assembly.system.rows[index]
        used = np.flatnonzero(row)
        follows = sum(float(p) * x for p, x in zip(assembly.imposed_rows[index], imposed, strict=True))
        for i in used:
            for j in used:
                equations[i][j] = equations[i].get(j, 0) + kappa * float(row[i]) * float(row[j])
            if follows:
                equations[i]["load"] = equations[i].get("load", 0) + kappa * float(row[i]) * follows
    solved = reduce_rows(equations, {index: index for index in range(len(loads))}, {"load"}).solved
    return [solved.get(index, {}).get("load", 0) for index in range(len(loads))], imposed


def _readings(
    assembly: Assembly,
    readings: Sequence[Functional],
    excitations: Sequence[Input],
    solutions: Sequence[tuple[list[Any], list[Any]]],
    s: Any,
) -> list[list[Any]]:
    kappa = _kappa(assembly, s)
    table = []
    for reading in readings:
        row = []
        for excitation, (motion, imposed) in zip(excitations, solutions, strict=True):
            total = sum((_term(term, motion, imposed, kappa, s) for term in reading.terms), start=s * 0)
            direct = reading.direct.get(excitation.of, 0.0) if excitation.quantity == "torque" else 0.0
            row.append(total + direct)
        table.append(row)
    return table


def _term(term: Term, motion: list[Any], imposed: list[Any], kappa: list[Any], s: Any) -> Any:
    gamma = sum((float(term.row[i]) * motion[i] for i in np.flatnonzero(term.row)), start=s * 0)
    gamma += sum(float(p) * x for p, x in zip(term.imposed, imposed, strict=True))
    return term.factor * gamma * (s**term.power if term.law is None else kappa[term.law])
