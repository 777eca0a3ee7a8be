"""Poles of measured-input transfer functions in general: rates s at which the measured inputs can stay zero.

With unknown excitations u these are the finite eigenvalues of the bordered system

    D(s) q - B u = 0,    L(s) q + d u = 0

solved as a generalised eigenvalue problem in (q, s q, u).
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from torsionnet.assembly.functionals import Functional, Term
from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.assembly.system import Assembly
from torsionnet.drivetrain import Drivetrain
from torsionnet.elements import Law
from torsionnet.elimination import exact, reduce_rows
from torsionnet.errors import UsageError
from torsionnet.kinematics import exact_row
from torsionnet.response import Modes
from torsionnet.response.modes import OSCILLATORY, REAL, RIGID
from torsionnet.solve.eigen import scaled
from torsionnet.solve.question import Question

INFINITE = 1e-12
"""Eigenvalues (alpha, beta) with |beta| below this share are at infinity."""


def measured_poles(drivetrain: Drivetrain, question: Question) -> Modes:
    """Poles against measured inputs that do not cut the drivetrain in two.

    Raises
    ------
    UsageError
        For laws that depend on frequency, or imposed angles as excitation.
    """
    assembly = drivetrain.assembly
    if assembly.system.dynamic or any(excitation.quantity != "torque" for excitation in question.excitations):
        msg = (
            "the measured input does not cut the drivetrain in two, and with frequency-dependent stiffness or imposed "
            "angles the poles are not calculated then"
        )
        raise UsageError(msg)
    zeros = zero_multiplicity(assembly, question)
    eigenvalues, vectors = _finite_pairs(*_pencil(assembly, question), zeros)
    shapes = scaled(assembly.T @ vectors[: assembly.system.n_coordinates]).astype(complex)
    kinds = tuple(RIGID if value == 0 else REAL if value.imag == 0 else OSCILLATORY for value in eigenvalues)
    nothing = np.zeros((len(drivetrain.elements), len(eigenvalues)))
    names = ", ".join(reading.name for reading in question.measured)
    return Modes(
        eigenvalues=eigenvalues,
        kinds=kinds,
        nodes=assembly.nodes,
        shapes=shapes,
        undamped_natural_frequencies=np.zeros(0),
        elements=tuple(drivetrain.elements),
        kinetic=nothing,
        strain=nothing,
        dissipated=nothing,
        converged=np.ones(len(eigenvalues), dtype=bool),
        descriptions=tuple(f"motion that leaves {names} at zero" for _ in eigenvalues),
        title=f"{drivetrain.title}, {names} held at zero",
        notes=(f"{names} does not cut the drivetrain in two; energy shares have no meaning here",),
    )


def _pencil(assembly: Assembly, question: Question) -> tuple[FloatArray, FloatArray]:
    """A x = s E x for x = (q, s q, u), balanced by a reference stiffness and rate."""
    system = assembly.system
    n, m = system.n_coordinates, len(question.excitations)
    rate, stiffness = _references(assembly)
    load = np.array([assembly.rows_of({excitation.of: 1})[0] for excitation in question.excitations]).T
    readings = [_polynomial(assembly, reading) for reading in question.measured]
    direct = np.array([[reading.direct.get(e.of, 0.0) for e in question.excitations] for reading in question.measured])
    E = np.zeros((2 * n + m, 2 * n + m))
    A = np.zeros_like(E)
    q, v, u = slice(0, n), slice(n, 2 * n), slice(2 * n, None)
    E[q, q], A[q, v] = np.eye(n), np.eye(n)
    E[v, v] = system.M * rate**2 / stiffness
    A[v, q], A[v, v], A[v, u] = -system.K / stiffness, -system.C * rate / stiffness, load
    for row, (L0, L1, L2) in enumerate(readings):
        scale = (
            max(float(np.abs(part).max(initial=0.0)) for part in (L0, L1 * rate, L2 * rate**2, direct[row] * stiffness))
            or 1.0
        )
        E[2 * n + row, v] = L2 * rate**2 / scale
        A[2 * n + row, q], A[2 * n + row, v] = -L0 / scale, -L1 * rate / scale
        A[2 * n + row, u] = -direct[row] * stiffness / scale
    return A * rate, E


def _references(assembly: Assembly) -> tuple[float, float]:
    system = assembly.system
    stiffness = float(np.abs(system.K).max(initial=0.0)) or 1.0
    inertia = float(np.abs(system.M).max(initial=0.0)) or 1.0
    return float(np.sqrt(stiffness / inertia)), stiffness


def _polynomial(assembly: Assembly, reading: Functional) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Rows L0, L1, L2 of a reading (L0 + L1 s + L2 s^2) q."""
    parts = np.zeros((3, assembly.system.n_coordinates))
    for term in reading.terms:
        for power, factor in enumerate(_powers(assembly, term)):
            parts[power] += factor * term.row
    return parts[0], parts[1], parts[2]


def _powers(assembly: Assembly, term: Term) -> tuple[float, float, float]:
    if term.law is None:
        return tuple(float(term.factor) if power == term.power else 0.0 for power in range(3))  # type: ignore[return-value]
    system = assembly.system
    law = (system.stiffness[term.law], system.damping[term.law], system.inertia[term.law])
    return tuple(float(term.factor) * float(value) for value in law)  # type: ignore[return-value]


def zero_multiplicity(assembly: Assembly, question: Question) -> tuple[int, int]:
    """How often s = 0 is a root of det P(s), and how many independent motions belong to it, decided exactly.

    P(s) = P_0 + P_1 s + P_2 s^2 is the bordered system. The solutions of its Taylor equations up to order n,
    sum_i P_i x_(k-i) = 0 for k = 0..n, grow in number until n reaches the multiplicity.

    Raises
    ------
    UsageError
        The determinant vanishes for every s: the excitation does not reach what is measured.
    """
    blocks = _exact_blocks(assembly, question)
    size = len(blocks[0])
    counts: list[int] = []
    for order in range(2 * size + 2):
        rows = [
            {
                (step - power, column): value
                for power in range(min(2, step) + 1)
                for column, value in blocks[power][line].items()
            }
            for step in range(order + 1)
            for line in range(size)
        ]
        names = {(step, column): step * size + column for step in range(order + 1) for column in range(size)}
        counts.append(len(names) - reduce_rows([row for row in rows if row], names).rank)
        if len(counts) > 1 and counts[-1] == counts[-2]:
            return counts[-1], counts[0]
    names_of = ", ".join(reading.name for reading in question.measured)
    msg = f"the excitation does not reach {names_of}: the measured input is zero at every frequency"
    raise UsageError(msg)


def _exact_blocks(assembly: Assembly, question: Question) -> list[list[dict[int, Fraction]]]:
    """P_0, P_1, P_2 as sparse exact rows over (q, u)."""
    index = {name: number for number, name in enumerate(assembly.kinematics.coordinates)}
    n, m = len(index), len(question.excitations)
    blocks: list[list[dict[int, Fraction]]] = [[{} for _ in range(n + m)] for _ in range(3)]
    for law, row in zip(assembly.laws, assembly.exact_rows, strict=True):
        for power, value in enumerate(_law_powers(law)):
            for i in row.keys() & index.keys():
                for j in row.keys() & index.keys():
                    _add(blocks[power][index[i]], index[j], value * row[i] * row[j])
    for column, excitation in enumerate(question.excitations):
        for name, value in exact_row(assembly.kinematics.reduced({excitation.of: 1})).items():
            _add(blocks[0][index[name]], n + column, -value)
    for line, reading in enumerate(question.measured):
        for term in reading.terms:
            powers = (
                [Fraction(term.power == p) for p in range(3)]
                if term.law is None
                else _law_powers(assembly.laws[term.law])
            )
            for power, value in enumerate(powers):
                for name in term.exact.keys() & index.keys():
                    _add(blocks[power][n + line], index[name], term.factor * value * term.exact[name])
        for column, excitation in enumerate(question.excitations):
            _add(blocks[0][n + line], n + column, exact(reading.direct.get(excitation.of, 0)))
    return [[{key: value for key, value in row.items() if value} for row in block] for block in blocks]


def _law_powers(law: Law) -> list[Fraction]:
    return [exact(law.stiffness), exact(law.damping), exact(law.inertia)]


def _add(row: dict[int, Fraction], column: int, value: Fraction) -> None:
    row[column] = row.get(column, Fraction(0)) + value


def _finite_pairs(A: FloatArray, E: FloatArray, zeros: tuple[int, int]) -> tuple[ComplexArray, ComplexArray]:
    """Finite eigenvalues with Im >= 0 in the order of |s|, and their vectors; ``zeros`` as of zero_multiplicity."""
    import scipy.linalg

    (alpha, beta), vectors = scipy.linalg.eig(A, E, homogeneous_eigvals=True)
    size = np.hypot(np.abs(alpha), np.abs(beta))
    finite = np.abs(beta) > INFINITE * size
    values = np.where(finite, alpha / np.where(finite, beta, 1.0), np.inf)
    order = np.argsort(np.abs(values), kind="stable")
    values[order[: zeros[0]]] = 0.0
    values = np.where(np.abs(values.imag) < 1e-10 * np.abs(values), values.real, values)
    moving = [index for index in order[zeros[0] :] if finite[index] and values[index].imag >= 0]
    keep = np.array([*order[: zeros[1]], *moving], dtype=int)
    return values[keep], vectors[:, keep]
