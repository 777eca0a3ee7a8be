"""Poles of transfer functions against any measured inputs, that is rates s at which these can stay zero.

With unknown excitations u, the rates s at which the readings L(s) q + d u can stay zero are the roots of det P(s),

    P(s) = [ D(s)  -B ]  =  P_0 + P_1 s + P_2 s^2
           [ L(s)   d ]

the bordered system. As many approximations as there are roots come from a generalised eigenvalue problem in
(q, u, s q); uncertain roots are refined in mpmath. Rounded numbers do not decide how many roots there are, how many are
zero and which are repeated; the determinant modulo large primes does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

import torsionnet.linear.modes.ehrlich_aberth as ehrlich_aberth
from torsionnet.base.errors import UsageError
from torsionnet.base.expressions import exact
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.law_stiffness import powers_of_s
from torsionnet.linear.assembly.rows import Assembly, ComplexArray, FloatArray, refuse_actions
from torsionnet.linear.dynamic_stiffness.reduction import without_empty_laws
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest
from torsionnet.linear.modes.ehrlich_aberth import minimum_degree_order
from torsionnet.linear.modes.eigen import unit_shapes
from torsionnet.linear.modes.mode_shapes import accuracy_warnings
from torsionnet.linear.modes.modes import OSCILLATORY, REAL, RIGID, Modes
from torsionnet.linear.modes.modular_arithmetic import (
    Coefficients,
    determinant,
    interpolating_polynomial,
    primes,
    rational_from_residue,
    residue,
    square_free,
)
from torsionnet.linear.modes.spectrum import MAX_OPERATIONS, REFINE_ABOVE, has_pairs, most_uncertain, on_real_axis
from torsionnet.model.elimination import reduce_rows
from torsionnet.model.kinematics import exact_row

# Bordered matrix P(s) for poles against measured inputs, in rational numbers, with exact counts of its roots.

MAX_PRIMES = 40
"""Most primes of 61 bits that are joined, enough for coefficients of repeated factors of some 700 digits."""

ExactRow: TypeAlias = dict[int, Fraction]


@dataclass(frozen=True)
class Bordered:
    """Bordered matrix P_0 + P_1 s + P_2 s^2 in exact rows over coordinates q and unknown excitations u.

    The first ``n_coordinates`` columns are q.
    """

    powers: tuple[list[ExactRow], list[ExactRow], list[ExactRow]]
    n_coordinates: int

    @classmethod
    def of(cls, assembly: Assembly, request: TransferRequest) -> Bordered:
        """Bordered matrix P(s) for the poles of an assembly against the measured inputs of a request."""
        index = {name: number for number, name in enumerate(assembly.kinematics.coordinates)}
        n, m = len(index), len(request.excitations)
        powers: tuple[list[ExactRow], ...] = tuple([{} for _ in range(n + m)] for _ in range(3))
        # D(s) = sum over the laws of (k + c s + J s^2) a a^T, in fractions
        for law, row in zip(assembly.laws, assembly.exact_rows, strict=True):
            ours = {index[name]: value for name, value in row.items() if name in index}
            for power, value in enumerate((exact(law.stiffness), exact(law.damping), exact(law.inertia))):
                for i, a in ours.items():
                    for j, b in ours.items():
                        _add(powers[power][i], j, value * a * b)
        # -B: a unit of each excitation, on the left side.
        for column, excitation in enumerate(request.excitations):
            for name, value in exact_row(assembly.kinematics.reduction.reduced(excitation.row)).items():
                if name in index:  # the rest of the torque acts on imposed angles, which stand still
                    _add(powers[0][index[name]], n + column, -value)
        # L(s) q + d u: readings by powers of s, and what excitations add to them at once.
        for line, reading in enumerate(request.inputs, start=n):
            for term in reading.terms:
                ours = {index[name]: value for name, value in term.exact.items() if name in index}
                for power, share in enumerate(powers_of_s(assembly, term)):
                    for i, a in ours.items():
                        _add(powers[power][line], i, term.factor * share * a)
            for column, excitation in enumerate(request.excitations):
                _add(powers[0][line], n + column, reading.direct(excitation.row))
        kept = ([{key: value for key, value in row.items() if value} for row in block] for block in powers)
        return cls(tuple(kept), n)  # type: ignore[arg-type]

    @property
    def size(self) -> int:
        """Number of rows of the bordered matrix, which is that of coordinates and excitations together."""
        return len(self.powers[0])

    @property
    def entries(self) -> dict[tuple[int, int], tuple[Fraction, ...]]:
        """Coefficients of s^0, s^1 and s^2 of every nonzero entry of the bordered matrix, by row and column."""
        places = dict.fromkeys((i, j) for block in self.powers for i, row in enumerate(block) for j in row)
        return {(i, j): tuple(block[i].get(j, Fraction(0)) for block in self.powers) for i, j in places}

    def determinant(self, prime: int) -> Coefficients:
        """Coefficients of the bordered matrix's determinant, a polynomial in s, modulo a prime, ascending."""
        # Minimum degree order keeps the elimination sparse and changes at most the sign of the determinant.
        order, _ = minimum_degree_order(self.size, self.entries)
        blocks = [[{order[j]: residue(x, prime) for j, x in row.items()} for row in block] for block in self.powers]
        # det P has the degree 2 n_q at most, which so many values and one more fix.
        return interpolating_polynomial(
            [determinant(_at(blocks, s, prime), prime) for s in range(2 * self.n_coordinates + 1)], prime
        )

    def roots(self) -> tuple[int, int] | None:
        """Number of poles against the measured inputs, and of these at zero, or None if the determinant vanishes."""
        coefficients = self.determinant(next(primes()))
        return (len(coefficients) - 1, _zeros(coefficients)) if coefficients else None

    def repeated(self) -> dict[int, list[Fraction]] | None:
        """Polynomials of the poles that are repeated and not zero, exact and monic, by multiplicity, or None.

        It is None where primes do not suffice.

        The polynomials modulo several primes are joined until one prime more does not change them.
        """
        joined: dict[int, list[int]] = {}
        modulus, last = 1, None
        for prime in islice(primes(), MAX_PRIMES):
            coefficients = self.determinant(prime)
            # Roots at zero are divided out first.
            factors = square_free(coefficients[_zeros(coefficients) :], prime)
            repeated = {multiplicity: factor for multiplicity, factor in factors.items() if multiplicity > 1}
            # Other degrees: the prime before or this one is unlucky, and joining begins again.
            if {m: len(factor) for m, factor in joined.items()} != {m: len(factor) for m, factor in repeated.items()}:
                joined, modulus = repeated, prime
            else:
                # Chinese remainder theorem: the number that leaves x modulo all primes before and y modulo this one.
                inverse = pow(modulus, -1, prime)
                for m, values in joined.items():
                    joined[m] = [
                        x + modulus * ((y - x) * inverse % prime) for x, y in zip(values, repeated[m], strict=True)
                    ]
                modulus *= prime
            now = {m: [rational_from_residue(value, modulus) for value in values] for m, values in joined.items()}
            if now == last and not any(None in values for values in now.values()):
                return now  # type: ignore[return-value]
            last = now
        return None


def _add(row: ExactRow, column: int, value: Fraction) -> None:
    row[column] = row.get(column, Fraction(0)) + value


def _at(blocks: Sequence[Sequence[dict[int, int]]], point: int, prime: int) -> list[dict[int, int]]:
    rows: list[dict[int, int]] = [{} for _ in blocks[0]]
    for power, block in enumerate(blocks):
        for row, part in zip(rows, block, strict=True):
            for column, value in part.items():
                row[column] = (row.get(column, 0) + point**power * value) % prime
    return [{column: value for column, value in row.items() if value} for row in rows]


def _zeros(coefficients: Coefficients) -> int:
    return next(power for power, value in enumerate(coefficients) if value)


BALANCING_ROUNDS = 10
"""Number of rounds that bring the largest entries of rows and columns to one, as each takes the root of the
distance."""
ERROR_FACTOR = 10.0
"""Assumed backward error of the eigenvalue problem in units of rounding, a larger value of which refines more roots in
mpmath."""
_EPS = float(np.finfo(float).eps)


@dataclass(frozen=True)
class Roots:
    """Nonzero roots of det P(s) in rad/s with conjugates, vectors (q, u), and estimated relative errors."""

    values: ComplexArray
    vectors: ComplexArray
    errors: FloatArray


def measured_poles(drivetrain: AssembledModel, request: TransferRequest) -> tuple[Modes, tuple[str, ...]]:
    """Modes whose poles let the measured inputs stay zero, where these cut no drivetrain in two, and warnings.

    Raises
    ------
    UsageError
        For laws that depend on frequency, imposed angles as excitation, or an excitation that reaches no reading.
    """
    assembly = drivetrain.assembly
    refuse_actions(
        assembly.system.actions, "poles against a measured input that does not cut the drivetrain in two are"
    )
    if without_empty_laws(assembly.system).dynamic or any(
        excitation.quantity != "torque" for excitation in request.excitations
    ):
        raise UsageError(
            "the measured input does not cut the drivetrain in two; then poles are calculated only without "
            "frequency-dependent stiffness and with torques as excitation",
            kind="unsupported-law",
        )
    names = ", ".join(reading.name for reading in request.inputs)
    bordered = Bordered.of(assembly, request)
    counts = bordered.roots()
    if counts is None:
        raise UsageError(
            f"the excitation does not reach {names}: the measured input is zero at every frequency; choose another",
            kind="zero-reading",
        )
    # Roots at zero have shapes at rest, P_0 v = 0, which fractions give exactly.
    still = _motions_at_rest(bordered) if counts[1] else np.zeros((bordered.size, 0))
    roots = _refined(bordered, _approximate(bordered, _rate(assembly), counts[0] - counts[1], counts[1]), counts[1])
    real = on_real_axis(roots.values)
    # One of every conjugate pair, and all real poles.
    kept = np.flatnonzero(real | (roots.values.imag > 0))
    kept = kept[np.argsort(np.abs(roots.values[kept]), kind="stable")]
    values = np.where(real[kept], roots.values[kept].real, roots.values[kept])
    eigenvalues = np.concatenate([np.zeros(still.shape[1]), values]).astype(complex)
    vectors = np.hstack([still, roots.vectors[:, kept]])[: bordered.n_coordinates]
    kinds = (RIGID,) * still.shape[1] + tuple(REAL if value.imag == 0 else OSCILLATORY for value in values)
    nothing = np.zeros((len(drivetrain.elements), len(eigenvalues)))
    modes = Modes(
        eigenvalues=eigenvalues,
        kinds=kinds,
        nodes=assembly.nodes,
        shapes=unit_shapes(assembly.T @ vectors).astype(complex),
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
    return modes, accuracy_warnings(roots.errors[kept])


def _rate(assembly: Assembly) -> float:
    """Frequency in rad/s typical of the drivetrain, which balances inertia against stiffness."""
    system = assembly.system
    # sqrt(trace K / trace M)
    lengths = np.array([sum(value * value for value in row.values()) for row in system.sparse_rows])
    stiff, heavy = float(system.stiffness @ lengths), float(system.inertia @ lengths)
    return float(np.sqrt(stiff / heavy)) if stiff and heavy else 1.0


def _motions_at_rest(bordered: Bordered) -> FloatArray:
    """Basis (size, n) of motions and torques at rest that leave the measured inputs at zero, found exactly."""
    solved = reduce_rows([row for row in bordered.powers[0] if row], {i: i for i in range(bordered.size)}).solved
    free = [column for column in range(bordered.size) if column not in solved]
    # P(0) x = 0: one vector for each free unknown, with the solved ones that follow it.
    basis = np.zeros((bordered.size, len(free)))
    for number, column in enumerate(free):
        basis[column, number] = 1.0
        for name, row in solved.items():
            basis[name, number] = float(row.get(column, 0))
    return basis


def _dense(block: list[dict[int, Fraction]]) -> FloatArray:
    array = np.zeros((len(block), len(block)))
    for i, row in enumerate(block):
        array[i, list(row)] = [float(value) for value in row.values()]
    return array


def _approximate(bordered: Bordered, rate: float, count: int, zeros: int) -> Roots:
    """Approximate nonzero roots of det P(s) in rad/s, ``count`` of them, in double precision with estimated errors."""
    import scipy.linalg

    # s = rate z, so that P_0, P_1 rate and P_2 rate^2 are of one size.
    powers = [_dense(block) * rate**power for power, block in enumerate(bordered.powers)]
    left, right = _balance(np.sum(np.abs(powers), axis=0))
    P_0, P_1, P_2 = (left[:, None] * power * right for power in powers)
    n, size = bordered.n_coordinates, bordered.size
    # A x = z E x over x = (q, u, z q): P_2 z (z q) = -P_1 (z q) - P_0 (q, u), excitations in P_0 alone.
    E, A = np.zeros((n + size, n + size)), np.zeros((n + size, n + size))
    E[:n, :n], A[:n, size:] = np.eye(n), np.eye(n)
    E[n:, size:], A[n:, size:] = P_2[:, :n], -P_1[:, :n]
    A[n:, :size] = -P_0
    solution: Any = scipy.linalg.eig(A, E, left=True, right=True, homogeneous_eigvals=True)
    (alpha, beta), lefts, rights = solution
    with np.errstate(all="ignore"):
        values = alpha / beta
        # Condition by y^H E x of both vectors, times a backward error eps (||A|| + |z| ||E||).
        slopes = np.abs(np.sum(lefts.conj() * (E @ rights), axis=0) * values)
        errors = _EPS * (np.linalg.norm(A) + np.abs(values) * np.linalg.norm(E)) / slopes
    errors = ERROR_FACTOR * errors * np.linalg.norm(lefts, axis=0) * np.linalg.norm(rights, axis=0)
    # The singular P_2 has infinite eigenvalues, which are no roots: they go behind all others.
    far = ~np.isfinite(values)
    values[far] = 2 * np.abs(values[~far]).max(initial=1.0)
    # The eigenvalues next to zero are its exact roots.
    chosen = np.lexsort((np.abs(values), far))[zeros : zeros + count]
    errors = np.where(far | ~np.isfinite(errors), np.inf, errors)
    vectors = (right[:, None] * rights[:size, chosen]).astype(complex)
    return Roots(rate * values[chosen], vectors, errors[chosen])


def _balance(sizes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Factors (n,) of rows and of columns that bring the largest entry of each to about one."""
    left, right = np.ones(len(sizes)), np.ones(len(sizes))
    for _ in range(BALANCING_ROUNDS):
        scaled_sizes = left[:, None] * sizes * right
        left = left / np.sqrt(scaled_sizes.max(axis=1, initial=0.0))
        right = right / np.sqrt(scaled_sizes.max(axis=0, initial=0.0))
    return left, right


def _refined(bordered: Bordered, roots: Roots, zeros: int) -> Roots:
    """Roots of det P(s) in rad/s with the uncertain ones solved in mpmath, as far as the limit on work allows."""
    if not np.any(roots.errors > REFINE_ABOVE):
        return roots
    repeated = bordered.repeated()
    if repeated is None:
        return roots
    # Repeated roots are taken from their exact polynomials; iteration would converge badly on them.
    values, known = _repeated(roots.values, repeated)
    p = ehrlich_aberth.exact_polynomial(bordered.size, bordered.entries)
    chosen = (roots.errors > REFINE_ABOVE) & ~known
    chosen = most_uncertain(chosen, roots.errors, MAX_OPERATIONS // max(p.operations, 1))
    refined, done = ehrlich_aberth.refine_roots(p, values, chosen, zeros, roots.errors)
    values = np.where(chosen, ehrlich_aberth.to_complex(refined, square_root=False), values)
    errors = np.where(chosen | known, ehrlich_aberth.CONVERGED, roots.errors)
    # Roots of a real determinant come in conjugate pairs: otherwise one has gone to a neighbour.
    if not (done and has_pairs(values)):
        return roots
    vectors = roots.vectors.copy()
    for j in np.flatnonzero(chosen | known):
        start = (
            np.cos(np.arange(bordered.size) + 2.4 * j) + 0j
        )  # any vector: that of an uncertain root may have no motion
        vectors[:, j] = ehrlich_aberth.refine_vector(p, refined[j], start)
    return Roots(values, vectors, errors)


def _repeated(values: ComplexArray, repeated: dict[int, list[Fraction]]) -> tuple[ComplexArray, NDArray[np.bool_]]:
    """Roots in rad/s with the nearest ones replaced by exact repeated roots, and a mask of those replaced."""
    values, known = values.copy(), np.zeros(len(values), dtype=bool)
    for multiplicity, polynomial in repeated.items():
        for root in ehrlich_aberth.polynomial_roots(polynomial):
            distance = np.where(known, np.inf, np.abs(values - root))
            nearest = np.argsort(distance, kind="stable")[:multiplicity]
            values[nearest], known[nearest] = root, True
    return values, known
