"""Dynamic stiffness D(z) of a drivetrain as a pencil, and eigenvalues polished on it by inverse iteration.

Without damping the variable is z = omega^2 and D = K - z M, else z = s and D = z^2 M + z C + K. Stiffness and damping
over frequency are read at the frequency of z itself, ``|Im s|`` or omega: an eigenvalue that is polished is a root of
det D with its own stiffness. The matrices are sparse where the drivetrain is large.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import FloatArray, RowSystem
from torsionnet.linear.dynamic_stiffness.reduction import LARGE_SYSTEM, AnyArray
from torsionnet.linear.modes.spectrum import MAX_OPERATIONS

SAME_EIGENVALUE = 1e-6
"""Relative distance of eigenvalues polished together."""
ONE_EIGENVALUE, LEAST_INDEPENDENCE = 1e-8, 1e-5
"""Relative difference below which eigenvalues are one, and ratio of singular values below which shapes are one, too."""
REFINED_ERROR, LARGEST_REFINED_ERROR = 1e-10, 1e-3
"""Relative errors of an eigenvalue from which on, and up to which, it is solved in many digits."""
POLISHED, POLISHING_STEPS = 1e-14, 4
"""Relative change of an eigenvalue at which polishing ends, and most steps, few since each squares the error."""
STEPS_OVER_FREQUENCY, SECANT_STEPS = 12, 30
"""Most steps of polishing, and most secant steps of one shape's frequency, where stiffness depends on frequency."""
STEP_LEFT = 1e-2
"""Change of an eigenvalue that another step may bring, over the residual of its shape, far above the true square."""
LEAST_SLOPE = 0.05
"""Least slope, downwards, of (frequency met - frequency read) for a secant step, since flatter ones lead too far."""
SLOPE_STEP = 1e-6
"""Relative step of frequency over which the change of an eigenvalue with the frequency of the tables is taken."""
_BESIDE = (1e-13, 1e-11, 1e-9, 1e-7, 1e-5, 1e-3)
"""Relative distances from an eigenvalue at which D is factored in turn, until it is not singular."""
_EPS = float(np.finfo(float).eps)


class NotFoundError(Exception):
    """Failure of a search to find modes with certainty."""


@dataclass(frozen=True)
class Pencil:
    """Matrix D(z) of a system over scaled coordinates, q = scale * (those used here).

    Attributes
    ----------
    system : RowSystem
    rows : (n_laws, n_q) array
        Rows of the laws over the scaled coordinates, sparse if ``is_sparse``.
    stiffness, damping : (n_laws,) arrays
        Those at rest.
    """

    system: RowSystem
    rows: Any
    inertia: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    scale: FloatArray
    undamped: bool
    is_sparse: bool

    @classmethod
    def of(cls, system: RowSystem, *, undamped: bool, at: float | None = None, sparse: bool | None = None) -> Pencil:
        """Matrix D(z) of a system, in coordinates scaled so that the diagonal of D(at) is about 1.

        It is sparse if so asked, by default where the system is large.
        """
        is_sparse = system.n_coordinates > LARGE_SYSTEM if sparse is None else sparse
        stiffness, damping = system.frozen(0.0)
        there, drag = system.frozen(at or 0.0)
        sizes = np.maximum(np.abs(stiffness), np.abs(there))
        if undamped:
            damping, drag = np.zeros_like(damping), np.zeros_like(drag)
        rows: Any = system.law_rows.csr if is_sparse else system.rows
        squares = rows.power(2) if is_sparse else rows**2
        if at is None:
            lengths = squares.sum(axis=1)  # traces of K and M
            at = float(np.sqrt(sizes @ lengths / (system.inertia @ lengths)))
        # Diagonal of |K| + at |C| + at^2 M
        sizes = sizes + at * np.maximum(np.abs(damping), np.abs(drag)) + at**2 * system.inertia
        diagonal = squares.T @ sizes
        diagonal[diagonal == 0] = 1.0
        scale = np.exp2(np.round(-0.5 * np.log2(diagonal)))  # powers of two, so that rows stay exact
        if is_sparse:
            from scipy import sparse as matrices

            rows = matrices.csc_array(rows @ matrices.diags_array(scale))
        else:
            rows = rows * scale
        return cls(system, rows, system.inertia, damping, stiffness.real, scale, undamped, is_sparse)

    @cached_property
    def _pattern(self) -> tuple[Any, NDArray[np.intp], NDArray[np.intp]]:
        """Map from coefficients to entries of rows^T diag(coefficients) rows, row numbers, and starts of columns."""
        from scipy import sparse

        rows = sparse.csr_array(self.rows)
        counts, n = np.diff(rows.indptr), rows.shape[1]
        places, laws, products = [], [], []
        # Laws with equally many entries are multiplied out together, a_i a_j for all pairs.
        for count in np.unique(counts):
            law = np.flatnonzero(counts == count)
            at = rows.indptr[law][:, None] + np.arange(count)
            column, entry = rows.indices[at].astype(np.intp), rows.data[at]
            places.append((column[:, :, None] * n + column[:, None, :]).ravel())
            products.append((entry[:, :, None] * entry[:, None, :]).ravel())
            laws.append(np.repeat(law, count * count))
        # Entries by column and then by row, as compressed columns have them; ``sums`` adds up the laws on each.
        place, number = np.unique(np.concatenate(places), return_inverse=True)
        size = (len(place), rows.shape[0])
        sums = sparse.csr_array((np.concatenate(products), (number, np.concatenate(laws))), shape=size)
        return sums, place % n, np.searchsorted(place // n, np.arange(n + 1))

    def gram(self, coefficients: AnyArray) -> Any:
        """Matrix (n_q, n_q) rows^T diag(coefficients) rows, such as the mass or damping matrix."""
        return next(self.grams(coefficients[:, None]))

    def grams(self, coefficients: AnyArray) -> Iterator[Any]:
        """Yield the matrix rows^T diag(column) rows of each column of coefficients (n_laws, n)."""
        if not self.is_sparse:
            yield from (self.rows.T @ (column[:, None] * self.rows) for column in coefficients.T)
            return
        from scipy import sparse

        sums, rows, starts = self._pattern
        n = len(self.scale)
        entries = np.ascontiguousarray((sums @ coefficients).T)
        yield from (sparse.csc_array((column, rows, starts), shape=(n, n)) for column in entries)

    @cached_property
    def M(self) -> Any:  # noqa: N802
        return self.gram(self.inertia)

    @cached_property
    def C(self) -> Any:  # noqa: N802
        return self.gram(self.damping)

    def frequencies(self, z: Any) -> FloatArray:
        """Frequencies in rad/s, in the shape of ``z``, at which what depends on frequency is read."""
        return np.asarray(np.sqrt(np.maximum(z.real, 0.0)) if self.undamped else np.abs(z.imag))

    def frozen(self, z: AnyArray) -> tuple[AnyArray, FloatArray]:
        """Stiffness in N m/rad and damping in N m s/rad of the laws, (n_laws, n), read at the frequencies of z (n,)."""
        if not self.system.dynamic:
            return self.stiffness[:, None], self.damping[:, None]
        stiffness, damping = self.system.frozen(self.frequencies(z))
        return (stiffness.real, np.zeros_like(damping)) if self.undamped else (stiffness, damping)

    def laws(self, z: Any) -> AnyArray:
        """Dynamic stiffness (n_laws, n) of the laws in N m/rad at z (n,)."""
        stiffness, damping = self.frozen(z)
        if self.undamped:
            return np.asarray(stiffness - z * self.inertia[:, None])
        return np.asarray(stiffness + z * damping + z**2 * self.inertia[:, None])

    def slopes(self, z: Any) -> AnyArray:
        """Derivatives (n_laws, n) of the laws to z (n,), at the frequencies at which they are read."""
        if self.undamped:
            return np.repeat(-self.inertia[:, None], len(z), axis=1)
        return np.asarray(self.frozen(z)[1] + 2 * z * self.inertia[:, None])

    def magnitudes(self, z: AnyArray) -> FloatArray:
        """Sums (n_laws, n) of the sizes of the terms of the laws at z (n,)."""
        size, (stiffness, damping), inertia = np.abs(z), self.frozen(z), self.inertia[:, None]
        if self.undamped:
            return np.asarray(np.abs(stiffness) + size * inertia)
        return np.asarray(np.abs(stiffness) + size * np.abs(damping) + size**2 * inertia)

    def factor(self, z: Any, *, definite: bool = False) -> Any:
        """LU factors of the sparse matrix D(z), with which linear systems are solved."""
        return _factors(self.gram(self.laws(np.array([z]))[:, 0]), definite=definite)

    def solve(self, z: AnyArray, right: Sequence[AnyArray]) -> list[AnyArray]:
        """Solution (n_q, n) of D x = right at every z, as close to it as D(z) is not singular."""
        solutions: list[Any] = [None] * len(z)
        left = list(range(len(z)))
        for step in _BESIDE:
            again = []
            near = z[left] * (1 + step)
            for place, matrix in zip(left, self.grams(self.laws(near)), strict=True):
                try:
                    load = right[place]
                    solutions[place] = _factors(matrix).solve(load) if self.is_sparse else np.linalg.solve(matrix, load)
                except (RuntimeError, np.linalg.LinAlgError):  # exactly singular
                    again.append(place)
            left = again
            if not left:
                return solutions
        raise NotFoundError

    def values(self, shapes: AnyArray, near: AnyArray) -> AnyArray:
        """Eigenvalues z (n,) near given ones from shapes (n_q, n), as roots of q^T D(z) q.

        Their errors are the squares of those of the shapes. Stiffness and damping are those at the eigenvalue's own
        frequency, which secant steps find.
        """
        squares = (self.rows @ shapes) ** 2
        omega = self.frequencies(near)
        z = self.roots(squares, omega, near)
        if not self.system.dynamic or not omega.any():
            return z
        # Secant steps on (frequency met - frequency read), which is zero at the eigenvalue.
        last, off = omega, self.frequencies(z) - omega
        omega = omega + off
        for _ in range(SECANT_STEPS):
            z = self.roots(squares, omega, z)
            before, off = off, self.frequencies(z) - omega
            if np.all(np.abs(off) <= _EPS * omega):
                break
            slope = (off - before) / (omega - last)
            # Where it does not fall, the frequency met is read next, and so is one beyond a factor of two.
            trial = np.where(slope < -LEAST_SLOPE, omega - off / slope, omega + off)
            trial = np.where((trial > omega / 2) & (trial < 2 * omega), trial, omega + off)
            last, omega = omega, np.where(np.abs(off) <= _EPS * omega, omega, trial)
        return z

    def roots(self, squares: AnyArray, omega: FloatArray, near: AnyArray) -> AnyArray:
        """Roots z (n,) next to ``near`` of q^T D q = 0 with squared motions of the laws (n_laws, n), read at omega."""
        m, k = self.inertia @ squares, self.system.stiffness @ squares
        c = np.zeros_like(k) if self.undamped else self.system.damping @ squares
        for law, table in self.system.dynamic:
            stiffness, damping = table.frozen(omega)
            k = k + (stiffness if stiffness.imag.any() and omega.any() else stiffness.real) * squares[law]
            c = c + damping * squares[law]
        if self.undamped:
            return np.asarray((k / m).real)
        # m z^2 + c z + k = 0: the root without cancellation, and the other from the product k / m.
        root = np.sqrt(np.maximum(c * c - 4 * m * k, 0.0) if np.isrealobj(k) else c * c - 4 * m * k)
        w = np.where(np.abs(c + root) >= np.abs(c - root), -c - root, -c + root)
        first, second = (np.where(below != 0, above / below, np.inf) for above, below in ((w, 2 * m), (2 * k, w)))
        return np.where(np.abs(first - near) <= np.abs(second - near), first, second)

    def pulls(self, shapes: AnyArray, z: AnyArray) -> FloatArray:
        """Changes (n,) of eigenvalues' frequencies with the frequency at which tables are read, dimensionless.

        Below 1 an eigenvalue meets its frequency from above, as every vibration with constant stiffness does.
        """
        squares, omega = (self.rows @ shapes) ** 2, self.frequencies(z)
        high, low = (self.frequencies(self.roots(squares, omega * (1 + step), z)) for step in (SLOPE_STEP, -SLOPE_STEP))
        return np.asarray((high - low) / (2 * SLOPE_STEP * omega))

    def split(self, shapes: AnyArray, center: Any) -> tuple[AnyArray, AnyArray]:
        """Steps in z from ``center`` to the eigenvalues of a cluster, and combinations of shapes that are theirs."""
        motion = self.rows @ shapes
        at = np.array([center])
        # Phi^T (D + step D') Phi y = 0, to first order about the center
        here, slope = (motion.T @ (law * motion) for law in (self.laws(at), self.slopes(at)))
        steps, mixed = np.linalg.eig(-np.linalg.solve(slope, here))
        if self.undamped and not self.system.dynamic and steps.imag.any():
            # Rounding makes pairs off the axis of equal eigenvalues; K - z M and M are symmetric: theirs are real.
            from scipy.linalg import eigh

            steps, mixed = eigh(here + here.T, -(slope + slope.T))
        # From numpy 2.5 on eig answers in complex numbers; real matrices with real eigenvalues have real combinations.
        return (steps.real, mixed.real) if np.isrealobj(here) and not steps.imag.any() else (steps, mixed)


def _factors(matrix: Any, *, definite: bool = False) -> Any:
    from scipy.sparse.linalg import splu

    options = {"SymmetricMode": True} if definite else {}
    return splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0 if definite else 1.0, options=options)


def polished(pencil: Pencil, values: Any, shapes: Any) -> tuple[Any, Any, FloatArray]:
    """Eigenvalues, shapes and relative errors after inverse iteration on every cluster until nothing changes.

    With constant coefficients an eigenvalue that comes nearer to another start is not certain.
    """
    starts, values, shapes = values, values.copy(), shapes.astype(complex)
    distance = np.abs(starts[:, None] - starts)
    errors, room = np.zeros(len(values)), np.full(len(values), np.inf)
    alone: list[int] = []
    left = list(range(len(values)))
    while left:
        # By themselves, shapes of a cluster would all fall on the one next to the start.
        group = [j for j in left if distance[left[0], j] <= SAME_EIGENVALUE * abs(values[left[0]])]
        left = [j for j in left if j not in group]
        if not pencil.system.dynamic:
            others = np.setdiff1d(np.arange(len(values)), group)
            room[group] = distance[np.ix_(np.array(group), others)].min(initial=np.inf) / 4
        if len(group) == 1:
            alone += group
            continue
        values[group], shapes[:, group], errors[group] = _cluster(pencil, values[group], shapes[:, group])
    # Real eigenvalues apart, in real numbers, so that rounding does not move them off the axis.
    for on_axis in (False, True):
        some = [j for j in alone if bool(values[j].imag == 0) is on_axis]
        if some:
            values[some], shapes[:, some], errors[some] = _singles(pencil, values[some], shapes[:, some])
    errors[np.abs(values - starts) > room] = np.inf
    return values, shapes, np.where(np.isfinite(errors), errors, np.inf)


def _singles(pencil: Pencil, values: Any, shapes: Any) -> tuple[Any, Any, FloatArray]:
    """Eigenvalues, shapes and relative errors after inverse iteration on each shape by itself, all real or none."""
    if pencil.undamped or np.all(values.imag == 0):
        values, shapes = values.real, shapes.real
    moved, left = np.full(len(values), np.inf), np.arange(len(values))
    for _ in range(STEPS_OVER_FREQUENCY if pencil.system.dynamic else POLISHING_STEPS):
        z, shape = values[left], shapes[:, left]
        # Inverse iteration q <- D^-1 D' q, then z as the root of q^T D(z) q.
        right = pencil.rows.T @ (pencil.slopes(z) * (pencil.rows @ shape))
        shape = np.stack(pencil.solve(z, list(right.T)), axis=1)
        shapes[:, left] = shape = shape / np.abs(shape).max(axis=0)
        values[left] = pencil.values(shape, z)
        moved[left] = np.abs(values[left] - z) / np.abs(values[left])
        if pencil.system.dynamic:  # the square of what is left of a shape is left of its eigenvalue
            moved[left] = np.minimum(moved[left], _residual(pencil, values[left], shape) * STEP_LEFT)
        left = left[moved[left] > POLISHED]
        if not len(left):
            break
    return values, shapes, moved + _rounding(pencil, values, shapes) + _residual(pencil, values, shapes) ** 2


def _cluster(pencil: Pencil, values: Any, shapes: Any) -> tuple[Any, Any, FloatArray]:
    """Eigenvalues, shapes and relative errors of a cluster after inverse iteration on all its shapes at once."""
    if pencil.undamped or np.all(values.imag == 0):
        values, shapes = values.real, shapes.real
    for _ in range(STEPS_OVER_FREQUENCY if pencil.system.dynamic else POLISHING_STEPS):
        # All shapes about one center; the small eigenvalue problem parts them again.
        center = values.mean()
        slopes = pencil.rows.T @ (pencil.slopes(np.array([center])) * (pencil.rows @ shapes))
        (shapes,) = pencil.solve(np.array([center]), [slopes])
        shapes = shapes / np.abs(shapes).max(axis=0)
        last = values
        steps, mixed = pencil.split(shapes, center)
        values, shapes = center + steps, shapes @ mixed
        if pencil.system.dynamic:
            values = pencil.values(shapes, values)
        if np.all(np.abs(values - last) <= POLISHED * np.abs(values)):
            break
    moved = np.abs(values - last) / np.abs(values)
    return values, shapes, moved + _rounding(pencil, values, shapes) + _residual(pencil, values, shapes)


def _rounding(pencil: Pencil, values: AnyArray, shapes: AnyArray) -> FloatArray:
    """Relative error (n,) of each eigenvalue by rounding in its sums and, squared, in its shape."""
    motion = pencil.rows @ shapes
    terms = np.abs(motion) ** 2 + _EPS * (abs(pencil.rows) @ np.abs(shapes)) ** 2
    # dz = q^T dD q / (q^T D' q)
    slope = np.abs(np.sum(pencil.slopes(values) * motion**2, axis=0) * values)
    return np.asarray(8 * _EPS * np.sum(pencil.magnitudes(values) * terms, axis=0) / slope)


def _residual(pencil: Pencil, values: AnyArray, shapes: AnyArray) -> FloatArray:
    """Residual D(z) q of each shape, over its change if z changed by its own size, shape (n,)."""
    motion = pencil.rows @ shapes
    left = np.linalg.norm(pencil.rows.T @ (pencil.laws(values) * motion), axis=0) * np.linalg.norm(shapes, axis=0)
    return np.asarray(left / np.abs(np.sum(pencil.slopes(values) * motion**2, axis=0) * values))


def distinct(values: AnyArray, shapes: AnyArray) -> list[int]:
    """Numbers of the modes of which no two have the same eigenvalue and the same shape."""
    kept: list[int] = []
    for number, value in enumerate(values):
        same = [known for known in kept if abs(values[known] - value) <= ONE_EIGENVALUE * abs(value)]
        some = shapes[:, [*same, number]]
        sizes = np.linalg.svd(some / np.linalg.norm(some, axis=0), compute_uv=False) if same else np.ones(1)
        if sizes[-1] > LEAST_INDEPENDENCE * sizes[0]:
            kept.append(number)
    return kept


def refined(pencil: Pencil, values: Any, shapes: Any, errors: FloatArray) -> tuple[Any, Any, FloatArray]:
    """Eigenvalues, shapes over q and relative errors, uncertain modes solved in many digits as far as time allows."""
    import torsionnet.linear.modes.ehrlich_aberth as ehrlich_aberth
    from torsionnet.linear.modes.ehrlich_aberth import isolated_root

    values, shapes, errors, left = values.copy(), shapes.copy(), errors.copy(), MAX_OPERATIONS
    for j in np.flatnonzero((errors > REFINED_ERROR) & (errors < LARGEST_REFINED_ERROR)):
        z, shape, room = values[j], shapes[:, j], LARGEST_REFINED_ERROR * abs(values[j])
        z = z.real if pencil.undamped or z.imag == 0 else z
        # The root with coefficients frozen at its frequency, until that frequency is its own.
        for _ in range(STEPS_OVER_FREQUENCY):
            stiffness, damping = (part[:, 0] for part in pencil.frozen(np.array([z])))
            laws = [stiffness, -pencil.inertia] if pencil.undamped else [stiffness, damping, pencil.inertia]
            p = ehrlich_aberth.polynomial(pencil.system.law_rows, laws)
            left -= p.operations
            met = isolated_root(p, z.item(), shape, room) if left > 0 else None
            if met is None:
                break
            last, z, shape = z, np.complex128(complex(met[0])), met[1]
            z = z.real if pencil.undamped else z
            apart = abs(pencil.frequencies(z) - pencil.frequencies(last))
            if not pencil.system.dynamic or apart <= POLISHED * abs(z):
                values[j], shapes[:, j], errors[j] = z, shape, ehrlich_aberth.CONVERGED
                break
    return values, shapes, errors
