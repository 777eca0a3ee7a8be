"""Poles of measured-input transfer functions in general: rates s at which the measured inputs can stay zero.

With unknown excitations u these are the finite eigenvalues of the bordered system

    D(s) q - B u = 0,    L(s) q + d u = 0

solved as a generalised eigenvalue problem in (q, s q, u).
"""

from __future__ import annotations

import numpy as np

from torsionnet.assembly.functionals import Functional, Term
from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.assembly.system import Assembly
from torsionnet.drivetrain import Drivetrain
from torsionnet.errors import UsageError
from torsionnet.response import Modes
from torsionnet.response.modes import OSCILLATORY, REAL, RIGID
from torsionnet.solve.eigen import scaled
from torsionnet.solve.question import Question

INFINITE = 1e-12
"""Eigenvalues (alpha, beta) with |beta| below this share are at infinity."""
ZERO = 1e-7
"""Relative to the largest rate: smaller eigenvalues are a double zero torn apart by rounding."""


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
    eigenvalues, vectors = _finite_pairs(*_pencil(assembly, question))
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
        return tuple(term.factor if power == term.power else 0.0 for power in range(3))  # type: ignore[return-value]
    system = assembly.system
    law = (system.stiffness[term.law], system.damping[term.law], system.inertia[term.law])
    return tuple(float(term.factor * value) for value in law)  # type: ignore[return-value]


def _finite_pairs(A: FloatArray, E: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Finite eigenvalues with Im >= 0 in the order of |s|, zeros once, and their vectors."""
    import scipy.linalg

    (alpha, beta), vectors = scipy.linalg.eig(A, E, homogeneous_eigvals=True)
    size = np.hypot(np.abs(alpha), np.abs(beta))
    finite = np.abs(beta) > INFINITE * size
    values = np.where(finite, alpha / np.where(finite, beta, 1.0), np.inf)
    largest = float(np.abs(values[finite]).max(initial=1.0))
    values[np.abs(values) < ZERO * largest] = 0.0
    values = np.where(np.abs(values.imag) < 1e-10 * np.abs(values), values.real, values)
    keep = np.flatnonzero(finite & (values.imag >= 0))
    keep = keep[np.argsort(np.abs(values[keep]), kind="stable")]
    zeros = [index for index in keep if values[index] == 0]
    keep = np.array([*zeros[: (len(zeros) + 1) // 2], *(index for index in keep if values[index] != 0)], dtype=int)
    return values[keep], vectors[:, keep]
