"""Eigenvalues in many digits, as all roots of det P(z) by Ehrlich-Aberth iteration in mpmath.

Double precision leaves an absolute error of about 1e-16 ||A||; with stiffnesses from 1e2 to 1e10 the slow modes are
noise. Here the Ehrlich-Aberth iteration (D. A. Bini, V. Noferini, "Solving polynomial eigenvalue problems by means of
the Ehrlich-Aberth method", Linear Algebra Appl. 439 (2013), doi:10.1016/j.laa.2013.02.024)

    z_j <- z_j - 1 / (p'(z_j)/p(z_j) - sum_{i != j} 1/(z_j - z_i)),    p(z) = det(A_0 + A_1 z + A_2 z^2)

moves the uncertain roots only. Each approximation is repelled by all others, so two starting values
cannot run into the same simple eigenvalue, and clusters keep their count.

Rayleigh quotient iteration in many digits, for an eigenvalue that is isolated from all others.

    q <- P(z)^-1 P'(z) q,    then the root z of q^T P(z) q next to the last one

P is symmetric, so an error of q enters z squared, and next to the solution the error of a step is the third power of
that before (K. Schreiber, "Nonlinear eigenvalue problems: Newton-type methods and nonlinear Rayleigh functionals",
thesis, TU Berlin 2008). Two eliminations are enough where simultaneous iteration takes eight; but two starts
may run to one root, so that this is for isolated roots only.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from heapq import heapify, heappop, heappush
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray, Rows
from torsionnet.linear.dynamic_stiffness.reduction import AnyArray

DIGITS = 80
"""Decimal digits of all sums in the iteration, of which the numerical derivative over `STEP` loses 24."""
STEP = 1e-24
"""Relative step of the numerical derivative of det P, far above the working precision, far below the wanted
accuracy."""
CONVERGED = 1e-15
"""Relative step at which a root counts as found, since the result is rounded to double precision."""
RESTART_DISTANCE = 1e-6
"""Relative distance at which a root starts again after it has met another approximation."""
MAX_ITERATIONS = 120
"""Most steps of the iteration for each root, as clusters converge slowly and other roots in a few."""
MAX_WORK = 120_000
"""Most multiplications and entries of all steps together, some three seconds of mpmath: where nothing of a start is
right, all roots wander for long, and most often in vain."""
ZERO_START = 1e-16
"""Start value, over the largest root, for a nonzero root that double precision has rounded to zero."""

Entry = tuple[int, int, tuple[Any, ...]]
"""Row, column and ascending coefficients of one entry of a matrix polynomial."""


@dataclass(frozen=True)
class MatrixPolynomial:
    """Sparse matrix polynomial P(z) in mpmath numbers, by entries with ascending coefficients.

    The coordinates are renumbered in the order of elimination; `place[j]` is the new number of coordinate j.
    `operations` counts the multiplications of one elimination without pivoting.
    """

    size: int
    entries: tuple[Entry, ...]
    place: tuple[int, ...]
    operations: int

    def matrix_at(self, z: Any) -> list[dict[int, Any]]:
        """Rows of the matrix polynomial at z, each as a map from column to mpmath number."""
        matrix: list[dict[int, Any]] = [{} for _ in range(self.size)]
        for i, j, coefficients in self.entries:
            value = coefficients[-1]
            for coefficient in coefficients[-2::-1]:
                value = value * z + coefficient
            matrix[i][j] = value
        return matrix

    def slope(self, z: Any, vector: Sequence[Any]) -> list[Any]:
        """Derivative of the matrix polynomial at z times a vector, as a list of mpmath numbers."""
        result = [z * 0] * self.size
        for i, j, coefficients in self.entries:
            value = sum(d * c * z ** (d - 1) for d, c in enumerate(coefficients) if d)
            result[i] = result[i] + value * vector[j]
        return result


def polynomial(rows: Rows, coefficients: Sequence[NDArray[np.generic]]) -> MatrixPolynomial:
    """Matrix polynomial sum_d rows^T diag(coefficients[d]) rows z^d with `DIGITS` digits, from exact doubles."""
    import mpmath

    sums: dict[tuple[int, int], list[Any]] = {}
    with mpmath.workdps(DIGITS):
        for law, row in enumerate(rows.maps):
            exact = [_exact(values[law]) for values in coefficients]
            entries = {i: mpmath.mpf(value) for i, value in row.items()}
            for i, a in entries.items():
                for j, b in entries.items():
                    total = sums.setdefault((i, j), [mpmath.mpf(0)] * len(exact))
                    for d, value in enumerate(exact):
                        if value:
                            total[d] = total[d] + a * b * value
    return _renumbered(rows.n_columns, {ij: tuple(total) for ij, total in sums.items() if any(total)})


def exact_polynomial(size: int, entries: Mapping[tuple[int, int], Sequence[Fraction]]) -> MatrixPolynomial:
    """Matrix polynomial in mpmath numbers from the rational coefficients of its entries, perhaps unsymmetric."""
    import mpmath

    with mpmath.workdps(DIGITS):
        kept = {ij: tuple(mpmath.mpf(x.numerator) / x.denominator for x in total) for ij, total in entries.items()}
    return _renumbered(size, kept)


def _renumbered(size: int, entries: Mapping[tuple[int, int], tuple[Any, ...]]) -> MatrixPolynomial:
    place, operations = minimum_degree_order(size, entries)
    moved = tuple((place[i], place[j], total) for (i, j), total in entries.items())
    return MatrixPolynomial(size, moved, place, operations)


def minimum_degree_order(size: int, pattern: Iterable[tuple[int, int]]) -> tuple[tuple[int, ...], int]:
    """Elimination number of each coordinate by minimum degree, and the multiplications of that elimination."""
    neighbours: dict[int, set[int]] = {i: set() for i in range(size)}
    for i, j in pattern:
        if i != j:
            neighbours[i].add(j)
            neighbours[j].add(i)
    place, operations = [0] * size, 0
    waiting = [(len(around), i) for i, around in neighbours.items()]
    heapify(waiting)
    for number in range(size):
        # Entries of the heap with another degree than now are out of date.
        while (leaf := waiting[0])[1] not in neighbours or leaf[0] != len(neighbours[leaf[1]]):
            heappop(waiting)
        around = neighbours.pop(leaf[1])
        # Elimination ties all neighbours to each other.
        for i in around:
            neighbours[i] |= around - {i}
            neighbours[i].discard(leaf[1])
            heappush(waiting, (len(neighbours[i]), i))
        place[leaf[1]] = number
        operations += len(around) * (len(around) + 1)
    return tuple(place), operations


def polynomial_roots(coefficients: Sequence[Fraction]) -> list[complex]:
    """Roots, as complex doubles, of a polynomial with ascending coefficients and without repeated roots."""
    import mpmath

    with mpmath.workdps(DIGITS):
        exact = [mpmath.mpf(x.numerator) / x.denominator for x in reversed(coefficients)]
        return [complex(root) for root in mpmath.polyroots(exact, maxsteps=10 * DIGITS, extraprec=20 * DIGITS)]


def _exact(value: Any) -> Any:
    import mpmath

    return mpmath.mpc(complex(value)) if complex(value).imag else mpmath.mpf(float(np.real(value)))


def eliminate(matrix: list[dict[int, Any]], right: list[Any] | None = None) -> tuple[Any, list[Any]]:
    """Determinant, and solution for a right-hand side, by sparse Gaussian elimination with partial pivoting."""
    determinant: Any = 1
    order: list[int] = []
    holding: list[set[int]] = [set() for _ in matrix]  # rows that are left, by column
    for i, row in enumerate(matrix):
        for j in row:
            holding[j].add(i)
    for column, rows in enumerate(holding):
        holders = sorted(i for i in rows if matrix[i][column])
        for i in rows.difference(holders):
            del matrix[i][column]  # a stored zero
        if not holders:
            return determinant * 0, []
        pivot = max(holders, key=lambda i: size_of(matrix[i][column]))
        determinant = determinant * matrix[pivot][column]
        order.append(pivot)
        for j in matrix[pivot]:
            holding[j].discard(pivot)
        for i in holders:
            if i != pivot:
                _subtract(matrix, right, i, pivot, column)
                for j in matrix[pivot]:
                    if j != column:
                        holding[j].add(i)
    solution = _substitute(matrix, right, order) if right is not None else []
    return determinant if _is_even(order) else -determinant, solution


def _is_even(order: Sequence[int]) -> bool:
    """Whether a permutation takes an even number of exchanges."""
    seen, exchanges = [False] * len(order), 0
    for start in range(len(order)):
        at = start
        while not seen[at]:
            seen[at] = True
            at = order[at]
            exchanges += not seen[at]
    return exchanges % 2 == 0


def size_of(value: Any) -> Any:
    """Sum of the magnitudes of real and imaginary part of a number, as a cheap measure of its size."""
    return abs(value.real) + abs(value.imag)


def _subtract(matrix: list[dict[int, Any]], right: list[Any] | None, i: int, pivot: int, column: int) -> None:
    factor = matrix[i].pop(column) / matrix[pivot][column]
    row = matrix[i]
    for j, value in matrix[pivot].items():
        if j != column:
            row[j] = row.get(j, 0) - factor * value
    if right is not None:
        right[i] = right[i] - factor * right[pivot]


def _substitute(matrix: list[dict[int, Any]], right: list[Any], order: list[int]) -> list[Any]:
    solution: dict[int, Any] = {}
    for column, i in reversed(list(enumerate(order))):
        known = sum((value * solution[j] for j, value in matrix[i].items() if j != column), start=right[i] * 0)
        solution[column] = (right[i] - known) / matrix[i][column]
    return [solution[j] for j in range(len(matrix))]


def _inverse_newton(p: MatrixPolynomial, z: Any) -> Any:
    """Inverse Newton step p'(z)/p(z) of the determinant p = det P at z, or None exactly on a root."""
    here, _ = eliminate(p.matrix_at(z))
    if here == 0:
        return None
    # p(z + step) / p(z) = 1 + step p'(z) / p(z), with digits enough for the difference.
    step = z * STEP
    there, _ = eliminate(p.matrix_at(z + step))
    return (there / here - 1) / step


def refine_roots(
    p: MatrixPolynomial,
    roots: NDArray[np.float64] | ComplexArray,
    uncertain: NDArray[np.bool_],
    zeros: int,
    spread: FloatArray,
) -> tuple[list[Any], bool]:
    """Roots of det P as mpmath numbers, the uncertain ones iterated to convergence, and whether all converged.

    Parameters
    ----------
    p : MatrixPolynomial
        P(z); det P has exactly the given roots and `zeros` zero roots.
    roots : (n,) array
        All nonzero finite roots with multiplicity, approximately.
    uncertain : (n,) boolean array
        Roots to iterate.
    zeros : int
        Multiplicity of the root zero.
    spread : (n,) array
        Relative uncertainty of each root; coinciding uncertain starting values are set apart by it.

    Returns
    -------
    list of mpmath numbers, bool
        The roots, and whether all of them converged.
    """
    import mpmath

    with mpmath.workdps(DIGITS):
        z = [mpmath.mpmathify(complex(root)) for root in _set_apart(roots, uncertain, spread)]
        if np.isrealobj(roots):
            z = [value.real for value in z]
        moving = [int(j) for j in np.flatnonzero(uncertain)]
        left = MAX_WORK // (p.operations + len(p.entries))
        for _ in range(MAX_ITERATIONS):
            if not moving or len(moving) > left:
                break
            left -= len(moving)
            moving = [j for j in moving if not _move(p, z, j, zeros)]
    return z, not moving


def _move(p: MatrixPolynomial, z: list[Any], j: int, zeros: int) -> bool:
    """Move root j by one Ehrlich-Aberth step, and return True when it no longer moves."""
    newton = _inverse_newton(p, z[j])
    if newton is None:
        return True
    # Sum of 1 / (z_j - z_i), the root zero with its multiplicity among them.
    others = [other for i, other in enumerate(z) if i != j]
    repulsion = sum((1 / (z[j] - other) for other in others), start=zeros / z[j]) if z[j] not in others else newton
    if newton == repulsion:  # on another approximation, or as far from it as from the root
        z[j] = z[j] * (1 + RESTART_DISTANCE)
        return False
    step = 1 / (newton - repulsion)
    z[j] = z[j] - step
    return bool(size_of(step) <= CONVERGED * size_of(z[j]))


def _set_apart(
    roots: NDArray[np.float64] | ComplexArray, uncertain: NDArray[np.bool_], spread: FloatArray
) -> NDArray[np.generic]:
    """Start values (n,) of roots, pairwise distinct and, if complex, not symmetric to the real axis."""
    # Turns of 2.4 rad never repeat and are not symmetric to the real axis.
    angles = 0.7 + np.arange(len(roots)) * 2.4
    turn = np.cos(angles) if np.isrealobj(roots) else np.exp(1j * angles)
    nonzero = np.where(roots == 0, -ZERO_START * np.max(np.abs(roots)), roots)
    return np.where(uncertain, nonzero * (1 + turn * np.clip(spread, 1e-13, 1e-2)), roots)


def refine_vector(p: MatrixPolynomial, z: Any, vector: ComplexArray) -> ComplexArray:
    """Null vector (n,) of P at a root z, scaled to a largest component of 1, by inverse iteration.

    One step solves P(z (1 + tiny)) q' = P'(z) q.
    """
    import mpmath

    with mpmath.workdps(DIGITS):
        start = [mpmath.mpmathify(vector[j].item()) for j in np.argsort(p.place)]
        _, solution = eliminate(p.matrix_at(z + z * STEP), p.slope(z, start))
        largest = max(solution, key=size_of, default=None)
        if not largest:
            return vector
        return np.array([complex(solution[j] / largest) for j in p.place])


def to_complex(roots: Sequence[Any], *, square_root: bool) -> ComplexArray:
    """Eigenvalues (n,) in double precision from roots in mpmath, z itself, or j sqrt(z) where z = omega^2."""
    import mpmath

    with mpmath.workdps(DIGITS):
        return np.array([1j * float(mpmath.sqrt(abs(z))) if square_root else complex(z) for z in roots], dtype=complex)


# Rayleigh quotient iteration in many digits, for an eigenvalue that is isolated from all others.

ISOLATION = 1e3
"""Least distance of an isolated root from every other root, zero included, in uncertainties of either, so that the
others do not disturb it."""
MOST_STEPS = 6
"""Most steps of the iteration for an isolated root, since each triples the number of right digits and more mean a wrong
start."""


def isolation_radii(roots: AnyArray, errors: FloatArray) -> FloatArray:
    """Radius (n,) in rad/s around each root that certainly holds no other, 0 where the root is too uncertain.

    That is where its uncertainty is near the distance.

    Parameters
    ----------
    roots : (n,) array
        All nonzero roots.
    errors : (n,) array
        Relative errors of the roots.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        # Ample room for the uncertainty of a root, which others and zero must be farther off than.
        blur = np.nan_to_num(ISOLATION * np.abs(roots) * errors, nan=np.inf)
        between = np.abs(np.subtract.outer(roots, roots)) - blur
    np.fill_diagonal(between, np.inf)
    space = np.minimum(between.min(axis=1, initial=np.inf), np.abs(roots))
    return np.where(space > blur, space, 0.0)


def isolated_root(
    p: MatrixPolynomial, start: complex, shape: ComplexArray, space: float
) -> tuple[Any, ComplexArray] | None:
    """Root of det P, as an mpmath number, near a start and alone within ``space``, and its shape (n,), or None.

    It is None where not reached. P is symmetric.
    """
    import mpmath

    with mpmath.workdps(DIGITS):
        z = first = mpmath.mpmathify(start)
        vector: list[Any] = [mpmath.mpmathify(shape[j].item()) for j in np.argsort(p.place)]
        for _ in range(MOST_STEPS):
            # q <- P(z)^-1 P'(z) q
            _, followed = eliminate(p.matrix_at(z), p.slope(z, vector))
            largest = max(followed, key=size_of, default=None)
            if not largest:
                return None
            vector = [value / largest for value in followed]
            last, z = z, _quotient(p, vector, z)
            # Farther than a third of the room around the start another root may be met.
            if z is None or size_of(z - first) > space / 3:
                return None
            if size_of(z - last) <= CONVERGED * size_of(z):
                return z, np.array([complex(vector[j]) for j in p.place])
    return None


def _quotient(p: MatrixPolynomial, vector: list[Any], z: Any) -> Any:
    """Root of q^T P(z) q next to z by Newton's iteration, as an mpmath number, or None without convergence."""
    # q^T P(z) q = sum of powers[d] z^d
    powers: list[Any] = [0] * max(len(coefficients) for _, _, coefficients in p.entries)
    for i, j, coefficients in p.entries:
        product = vector[i] * vector[j]
        for d, value in enumerate(coefficients):
            powers[d] += value * product
    for _ in range(MOST_STEPS):
        slope = sum(d * value * z ** (d - 1) for d, value in enumerate(powers) if d)
        if not slope:
            return None
        step = sum(value * z**d for d, value in enumerate(powers)) / slope
        z = z - step
        if size_of(step) <= CONVERGED * size_of(z):
            return z
    return None
