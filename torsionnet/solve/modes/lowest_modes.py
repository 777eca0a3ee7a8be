"""Lowest modes of large drivetrains, by shift-invert on sparse matrices and inverse iteration for each mode.

The shift sigma > 0 lies where a passive system has no pole, so D(sigma) = sigma^2 M + sigma C + K is positive
definite, massless coordinates included. Without damping the operator is S D^-1 S^T with S = diag(sqrt(J)) B, which is
symmetric; with damping it is the inverse of the companion form in (q, s q), through D(sigma) alone. Rigid bodies, known
from the ranks of the rows, are projected out, and so is every mode that was found: a second run then shows whether
another mode of a multiple eigenvalue was missed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.rows import ComplexArray, FloatArray, RowSystem
from torsionnet.core.errors import SolveError
from torsionnet.solve.dynamic_stiffness.nullspace import unresisted_motions
from torsionnet.solve.dynamic_stiffness.reduction import (
    AnyArray,
    echelon,
    require_resistance,
    resisted_coordinates,
    restrict_to,
    without_empty_laws,
)
from torsionnet.solve.modes.frozen_stiffness import Eigenpairs
from torsionnet.solve.modes.spectrum import MAX_OPERATIONS

Apply: TypeAlias = Callable[[FloatArray], FloatArray]

MODES_PER_SPARSE_MODE = 4
"""Number of all modes over number of modes sought, below which the dense solution of all modes is quicker."""
SPARSE_TOLERANCE = 1e-10
"""Estimated relative error of an eigenvalue up to which the sparse result is used."""
LARGEST_DENSE = 2000
"""Number of coordinates beyond which dense arrays of n by n cost hours and gigabytes."""
_RIGID_ECHO, _LARGEST_REFINED_ERROR = 1e-6, 1e-3
"""Polished over started eigenvalue up to which a mode was a rigid body, and largest start error for many digits."""
_KRYLOV_TOLERANCE = 1e-13
"""Relative accuracy of eigenvalues that is asked of ARPACK, which leaves the last digits to polishing."""
_SAME_EIGENVALUE, _MISSED_MARGIN = 1e-6, 1e-9
"""Relative distance of eigenvalues polished together, and tolerance by which a later one counts as missed before."""
_POLISHED, _POLISHING_STEPS = 1e-14, 4
"""Relative change of an eigenvalue at which polishing ends, and most steps, few since each squares the error."""
_BESIDE = (1e-13, 1e-11, 1e-9, 1e-7, 1e-5, 1e-3)
"""Relative distances from an eigenvalue at which D is factored in turn, until it is not singular."""
_RESOLVED, _SHIFT_ROUNDS = 0.1, 8
"""Slowest pole over the shift below which poles are not separated, and most changes of shift or number of modes."""
_EPS = float(np.finfo(float).eps)


class _NotFoundError(Exception):
    """Failure of a sparse search to find the lowest modes with certainty."""


@dataclass(frozen=True)
class RigidMotions:
    """Rigid-body shapes (n_q, n) without springs, those of them without dampers, and rank of the mass matrix."""

    rigid: FloatArray
    undamped: FloatArray
    dynamic: int  # rank of M

    @classmethod
    def of(cls, system: RowSystem, stiff: NDArray[np.bool_], damped: NDArray[np.bool_], count: int) -> RigidMotions:
        """Rigid-body shapes (n_q, n) of a system without springs and without dampers, at most ``count`` of each kind.

        Raises
        ------
        SolveError
            Where some coordinates have neither inertia nor spring nor damper.
        """
        heavy = system.inertia > 0
        require_resistance(system, heavy | stiff | damped)
        rigid, undamped = (unresisted_motions(system, laws).first(count) for laws in (stiff, stiff | damped))
        massless = unresisted_motions(system, heavy).dimension
        return cls(echelon(rigid.basis()), undamped.basis(), system.n_coordinates - massless)


def lowest_vibrations(system: RowSystem, motions: RigidMotions, count: int, *, undamped: bool) -> Eigenpairs | None:
    """Eigenvalues (rad/s) and shapes of at least ``count`` lowest vibrations, or None where sparse methods fail.

    None with too few degrees of freedom for so many modes, or where the sparse search is not accurate to within
    `SPARSE_TOLERANCE`; beyond `LARGEST_DENSE` uncertain modes are returned with their errors.

    Raises
    ------
    SolveError
        Beyond `LARGEST_DENSE`, where the sparse search finds too few modes.
    """
    from scipy.sparse.linalg import ArpackError

    if count <= 0:
        return _eigenpairs(np.zeros(0, complex), np.zeros((system.n_coordinates, 0)), np.zeros(0))
    if MODES_PER_SPARSE_MODE * (count + MODES_PER_SPARSE_MODE) > motions.dynamic:
        return None
    try:
        with np.errstate(all="ignore"):
            found = _search(system, motions, count, undamped=undamped)
    except (_NotFoundError, ArpackError, np.linalg.LinAlgError, RuntimeError) as error:  # the last: singular in SuperLU
        if system.n_coordinates <= LARGEST_DENSE:
            return None
        size = system.n_coordinates
        raise SolveError(
            f"a sparse search finds too few of the lowest modes of {size} coordinates; leave out lowest= to get all "
            "modes, which takes long"
        ) from error
    return found if system.n_coordinates > LARGEST_DENSE or np.all(found.errors[:count] <= SPARSE_TOLERANCE) else None


def _search(system: RowSystem, motions: RigidMotions, count: int, *, undamped: bool) -> Eigenpairs:
    slowest = _slowest_undamped(system, motions)
    pencil = _Pencil.of(system, undamped=undamped, at=slowest)
    search = _undamped if undamped else _damped
    starts, shapes = search(pencil, motions, count, slowest)
    values, shapes, errors = _polished(pencil, starts, shapes)
    kept = np.abs(values) > _RIGID_ECHO * np.abs(starts)
    values, shapes, errors = values[kept], shapes[:, kept], errors[kept]
    if len(values) < count:
        raise _NotFoundError
    order = np.argsort(np.abs(values), kind="stable")
    values, shapes, errors = values[order], pencil.scale[:, None] * shapes[:, order], errors[order]
    if np.any(errors[:count] > SPARSE_TOLERANCE):
        values, shapes, errors = _refined(system, values, shapes, errors, undamped=undamped)
    return _eigenpairs(1j * np.sqrt(values.real) if undamped else values, shapes, errors)


def _refined(
    system: RowSystem, values: Any, shapes: Any, errors: FloatArray, *, undamped: bool
) -> tuple[Any, Any, Any]:
    """Eigenvalues, shapes and relative errors, the uncertain modes solved in many digits as far as time allows."""
    import torsionnet.solve.modes.ehrlich_aberth as ehrlich_aberth
    from torsionnet.solve.modes.rayleigh_quotient import isolated_root

    laws = [system.stiffness, -system.inertia] if undamped else [system.stiffness, system.damping, system.inertia]
    p = ehrlich_aberth.polynomial(system.law_rows, laws)
    values, errors = values.copy(), errors.copy()
    uncertain = np.flatnonzero((errors > SPARSE_TOLERANCE) & (errors < _LARGEST_REFINED_ERROR))
    for j in uncertain[: MAX_OPERATIONS // max(p.operations, 1)]:
        start = values[j].real if undamped or values[j].imag == 0 else values[j]
        met = isolated_root(p, start.item(), shapes[:, j], _LARGEST_REFINED_ERROR * abs(values[j]))
        if met is not None:
            root, shapes[:, j] = complex(met[0]), met[1]
            values[j], errors[j] = root.real if undamped else root, ehrlich_aberth.CONVERGED
    return values, shapes, errors


def _eigenpairs(values: ComplexArray, shapes: AnyArray, errors: FloatArray) -> Eigenpairs:
    n = len(values)
    return Eigenpairs(
        values, shapes.astype(complex), values.imag == 0, errors, np.ones(n, dtype=bool), np.ones(n, dtype=int)
    )


@dataclass(frozen=True)
class _Pencil:
    """Sparse matrix D(z) of a system over scaled coordinates, q = scale * (those used here).

    Without damping the variable is z = omega^2 and D = K - z M, else z = s and D = z^2 M + z C + K.
    """

    rows: Any  # sparse
    inertia: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    scale: FloatArray
    undamped: bool

    @classmethod
    def of(cls, system: RowSystem, *, undamped: bool, at: float | None = None) -> _Pencil:
        """Sparse matrix D(z) of a system, in coordinates scaled so that the diagonal of D(at) is about 1."""
        from scipy import sparse

        damping = np.zeros_like(system.damping) if undamped else system.damping
        squares = system.law_rows.csr.power(2)
        if at is None:
            lengths = squares.sum(axis=1)  # traces of K and M
            at = float(np.sqrt(system.stiffness @ lengths / (system.inertia @ lengths)))
        sizes = system.stiffness + at * damping + at**2 * system.inertia
        scale = np.exp2(np.round(-0.5 * np.log2(squares.T @ sizes)))  # powers of two, so that rows stay exact
        rows = sparse.csc_array(system.law_rows.csr @ sparse.diags_array(scale))
        return cls(rows, system.inertia, damping, system.stiffness, scale, undamped)

    @cached_property
    def _pattern(self) -> tuple[Any, NDArray[np.intp], NDArray[np.intp]]:
        """Map from coefficients to entries of rows^T diag(coefficients) rows, row numbers, and starts of columns."""
        from scipy import sparse

        rows = sparse.csr_array(self.rows)
        counts, n = np.diff(rows.indptr), rows.shape[1]
        places, laws, products = [], [], []
        for count in np.unique(counts):
            law = np.flatnonzero(counts == count)
            at = rows.indptr[law][:, None] + np.arange(count)
            column, entry = rows.indices[at].astype(np.intp), rows.data[at]
            places.append((column[:, :, None] * n + column[:, None, :]).ravel())
            products.append((entry[:, :, None] * entry[:, None, :]).ravel())
            laws.append(np.repeat(law, count * count))
        place, number = np.unique(np.concatenate(places), return_inverse=True)
        size = (len(place), rows.shape[0])
        sums = sparse.csr_array((np.concatenate(products), (number, np.concatenate(laws))), shape=size)
        return sums, place % n, np.searchsorted(place // n, np.arange(n + 1))

    def gram(self, coefficients: AnyArray) -> Any:
        """Sparse matrix (n_q, n_q) rows^T diag(coefficients) rows, such as the mass or damping matrix."""
        from scipy import sparse

        sums, rows, starts = self._pattern
        n = len(self.scale)
        return sparse.csc_array((sums @ coefficients, rows, starts), shape=(n, n))

    @cached_property
    def M(self) -> Any:  # noqa: N802
        return self.gram(self.inertia)

    @cached_property
    def C(self) -> Any:  # noqa: N802
        return self.gram(self.damping)

    def laws(self, z: Any) -> AnyArray:
        if self.undamped:
            return np.asarray(self.stiffness - z * self.inertia)
        return np.asarray(self.stiffness + z * self.damping + z**2 * self.inertia)

    def slopes(self, z: Any) -> AnyArray:
        return -self.inertia if self.undamped else np.asarray(self.damping + 2 * z * self.inertia)

    def magnitudes(self, z: Any) -> FloatArray:
        size = abs(z)
        if self.undamped:
            return np.asarray(self.stiffness + size * self.inertia)
        return np.asarray(self.stiffness + size * self.damping + size**2 * self.inertia)

    def factor(self, z: Any, *, definite: bool = False) -> Any:
        """LU factors of the sparse matrix D(z), with which linear systems are solved."""
        from scipy.sparse.linalg import splu

        options = {"SymmetricMode": True} if definite else {}
        threshold = 0.0 if definite else 1.0
        return splu(self.gram(self.laws(z)), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=threshold, options=options)

    def value(self, shape: AnyArray, near: Any) -> Any:
        """Eigenvalue z near a given one from a shape, as root of q^T D(z) q, with the square of the shape's error."""
        squares = (self.rows @ shape) ** 2
        m, c, k = self.inertia @ squares, self.damping @ squares, self.stiffness @ squares
        if self.undamped:
            return k / m
        root = np.sqrt(c * c - 4 * m * k) if np.iscomplexobj(shape) else np.sqrt(max(c * c - 4 * m * k, 0.0))
        w = -c - root if abs(c + root) >= abs(c - root) else -c + root
        return min(w / (2 * m) if m else np.inf, 2 * k / w if w else np.inf, key=lambda z: abs(z - near))

    def split(self, shapes: AnyArray, center: Any) -> tuple[AnyArray, AnyArray]:
        """Steps in z from ``center`` to the eigenvalues of a cluster, and combinations of shapes that are theirs."""
        motion = self.rows @ shapes
        here, slope = (motion.T @ (law[:, None] * motion) for law in (self.laws(center), self.slopes(center)))
        steps, mixed = np.linalg.eig(-np.linalg.solve(slope, here))
        # From numpy 2.5 on eig answers in complex numbers; real matrices with real eigenvalues have real combinations.
        return (steps.real, mixed.real) if np.isrealobj(here) and not steps.imag.any() else (steps, mixed)


# --- without damping ------------------------------------------------------------------------------------------------


def _inertia_rows(pencil: _Pencil) -> Any:
    from scipy import sparse

    heavy = np.flatnonzero(pencil.inertia > 0)
    return sparse.csr_array(sparse.diags_array(np.sqrt(pencil.inertia[heavy])) @ pencil.rows.tocsr()[heavy])


def _slowest_undamped(system: RowSystem, motions: RigidMotions) -> float:
    """Rough lowest nonzero natural frequency in rad/s of a system without damping."""
    kept = resisted_coordinates(system)
    if len(kept) == system.n_coordinates:
        return _slowest(_Pencil.of(system, undamped=True), motions.rigid)
    system = without_empty_laws(restrict_to(system, kept))
    rigid = unresisted_motions(system, system.stiffness > 0).basis()
    return _slowest(_Pencil.of(system, undamped=True), rigid)


def _slowest(pencil: _Pencil, rigid: FloatArray) -> float:
    square = float(np.sum(pencil.stiffness > 0)) and 1e-6 / float(pencil.scale.max() / pencil.scale.min())
    square *= float(pencil.gram(pencil.stiffness).diagonal().sum() / pencil.M.diagonal().sum())
    for _ in range(_SHIFT_ROUNDS):
        problem = _Symmetric(pencil, rigid, square)
        found = problem.squares(problem.run(1, tolerance=1e-3)[0])[0]
        is_close = square / 100 <= found <= square * 1e4
        square = max(found, square * 1e-5)
        if is_close:
            return float(np.sqrt(square))
    raise _NotFoundError


class _Symmetric:
    """Symmetric operator P S (K + sigma M)^-1 S^T P for undamped modes, with eigenvalues 1/(omega^2 + sigma)."""

    def __init__(self, pencil: _Pencil, rigid: FloatArray, sigma: float) -> None:
        self.rows, self.sigma = _inertia_rows(pencil), sigma
        self.factors = pencil.factor(-sigma, definite=True)
        self.known = np.linalg.qr(self.rows @ (rigid / pencil.scale[:, None]))[0]

    def run(self, count: int, tolerance: float = _KRYLOV_TOLERANCE) -> tuple[FloatArray, FloatArray]:
        """Largest ``count`` eigenvalues in s^2 of the operator, and their vectors y orthogonal to the known ones."""
        from scipy.sparse.linalg import eigsh

        def project(y: FloatArray) -> FloatArray:
            return np.asarray(y - self.known @ (self.known.T @ y))

        size = self.rows.shape[0]
        operator = _operator(lambda y: project(self.rows @ self.factors.solve(self.rows.T @ project(y))), size)
        first = project(np.random.default_rng(0).standard_normal(size))
        lanczos = min(size, max(2 * count + 1, count + 30))
        values, vectors = eigsh(operator, k=count, which="LA", v0=first, ncv=lanczos, tol=tolerance)
        return values[::-1], vectors[:, ::-1]

    def squares(self, values: FloatArray) -> FloatArray:
        return np.asarray(1 / values - self.sigma)


def _operator(apply: Apply, size: int) -> Any:
    from scipy.sparse.linalg import LinearOperator

    return LinearOperator((size, size), matvec=lambda x: apply(np.asarray(x).ravel()), dtype=float)


def _undamped(pencil: _Pencil, motions: RigidMotions, count: int, slowest: float) -> tuple[FloatArray, FloatArray]:
    """Squares omega^2 in (rad/s)^2 of the lowest natural frequencies and shapes (n_q, n), at least ``count``."""
    problem = _Symmetric(pencil, motions.rigid, slowest**2 / 2)
    values, vectors = problem.run(count + 1)
    for _ in range(count):
        problem.known = np.linalg.qr(np.hstack([problem.known, vectors]))[0]
        more, extra = problem.run(2)
        missed = more >= np.sort(values)[-count] * (1 - _MISSED_MARGIN)
        if not np.any(missed):
            break
        values, vectors = np.concatenate([values, more[missed]]), np.hstack([vectors, extra[:, missed]])
    shapes = problem.factors.solve(problem.rows.T @ vectors)
    return problem.squares(values), np.asarray(shapes)


# --- with damping ---------------------------------------------------------------------------------------------------


class _Companion:
    """Operator (A - sigma E)^-1 E on x = (q, s q / unit) for damped modes, with eigenvalues 1/(lambda - sigma).

    Eigenvectors are orthogonal in the symmetric form x^T G x with G = [[C, M], [M, 0]].
    """

    def __init__(self, pencil: _Pencil, motions: RigidMotions, sigma: float, unit: float) -> None:
        from scipy import sparse

        self.pencil, self.sigma, self.unit = pencil, sigma, unit
        self.factors = pencil.factor(sigma, definite=True)
        self.load = sparse.csr_array(sparse.hstack([pencil.C + sigma * pencil.M, unit * pencil.M]))
        rigid, free = (part / pencil.scale[:, None] for part in (motions.rigid, motions.undamped))
        self.known = np.zeros((2 * len(rigid), rigid.shape[1] + free.shape[1]))
        self.known[: len(rigid), : rigid.shape[1]] = rigid
        self.known[len(rigid) :, rigid.shape[1] :] = free

    def apply(self, x: FloatArray) -> FloatArray:
        n = len(x) // 2
        q = -self.factors.solve(self.load @ x)
        return np.concatenate([q, (x[:n] + self.sigma * q) / self.unit])

    def form(self, x: FloatArray) -> FloatArray:
        n, M = len(x) // 2, self.pencil.M
        return np.concatenate([self.pencil.C @ x[:n] + self.unit * (M @ x[n:]), self.unit * (M @ x[:n])])

    def run(self, count: int) -> tuple[ComplexArray, ComplexArray]:
        """Eigenvalues in rad/s next to sigma and their vectors x outside the known ones, conjugates included."""
        from scipy.sparse.linalg import eigs

        left = self.form(self.known)
        gram = left.T @ self.known

        def project(x: FloatArray) -> FloatArray:
            return np.asarray(x - self.known @ np.linalg.solve(gram, left.T @ x)) if gram.size else x

        size = 2 * len(self.pencil.scale)
        operator = _operator(lambda x: project(self.apply(project(x))), size)
        first = project(np.random.default_rng(0).standard_normal(size))
        arnoldi = min(size, max(2 * count + 1, count + 30))
        values, vectors = eigs(operator, k=count, which="LM", v0=first, ncv=arnoldi, tol=_KRYLOV_TOLERANCE)
        self.radius = 1 / float(np.abs(values).min())
        return self.sigma + 1 / values, vectors

    def add_known(self, values: ComplexArray, vectors: ComplexArray) -> None:
        """Add vectors x to the known modes, which are projected out of the operator."""
        with_pair = vectors[:, values.imag > 0]
        real = vectors[:, values.imag == 0].real
        known = np.hstack([self.known, with_pair.real, with_pair.imag, real])
        self.known = known / np.linalg.norm(known, axis=0)


def _damped(pencil: _Pencil, motions: RigidMotions, count: int, slowest: float) -> tuple[ComplexArray, ComplexArray]:
    """Lowest eigenvalues in rad/s and shapes (n_q, n), at least ``count``, one of each conjugate pair."""
    wanted, sigma, n = 2 * count + 8, slowest / 20, len(pencil.scale)
    for _ in range(_SHIFT_ROUNDS):
        if wanted > motions.dynamic:
            raise _NotFoundError
        problem = _Companion(pencil, motions, sigma, 20 * sigma)
        values, vectors = problem.run(wanted)
        upper = values.imag >= 0
        values, vectors = values[upper], vectors[:, upper]
        sizes = np.sort(np.abs(values))
        enough = len(sizes) >= count and sizes[count - 1] + sigma <= problem.radius * (1 + _MISSED_MARGIN)
        resolved = len(sizes) > 0 and sizes[0] > sigma * _RESOLVED
        if enough and resolved:
            break
        wanted = wanted if enough else wanted + wanted // 2
        sigma = min(sigma, max(float(sizes[0]), sigma / 1000)) if len(sizes) else sigma
    else:
        raise _NotFoundError
    for _ in range(count):
        problem.add_known(values, vectors)
        more, extra = problem.run(2)
        missed = (np.abs(more) <= np.sort(np.abs(values))[count - 1] * (1 + _MISSED_MARGIN)) & (more.imag >= 0)
        if not np.any(missed):
            break
        values, vectors = np.concatenate([values, more[missed]]), np.hstack([vectors, extra[:, missed]])
        problem.known = problem.known[:, : motions.rigid.shape[1] + motions.undamped.shape[1]]
    return values, vectors[:n]


# --- accuracy -------------------------------------------------------------------------------------------------------


def _polished(pencil: _Pencil, values: Any, shapes: Any) -> tuple[Any, Any, FloatArray]:
    """Eigenvalues, shapes and relative errors after inverse iteration on every cluster until nothing changes."""
    values, shapes = values.copy(), shapes.astype(complex)
    distance = np.abs(values[:, None] - values)
    errors = np.zeros(len(values))
    left = list(range(len(values)))
    while left:
        group = np.array([j for j in left if distance[left[0], j] <= _SAME_EIGENVALUE * abs(values[left[0]])])
        left = [j for j in left if j not in group]
        others = np.setdiff1d(np.arange(len(values)), group)
        room = distance[np.ix_(group, others)].min(initial=np.inf) / 4
        before = values[group]
        values[group], shapes[:, group], errors[group] = _inverse_iteration(pencil, before, shapes[:, group])
        if np.any(np.abs(values[group] - before) > room):
            errors[group] = np.inf
    return values, shapes, np.where(np.isfinite(errors), errors, np.inf)


def _inverse_iteration(pencil: _Pencil, values: Any, shapes: Any) -> tuple[Any, Any, FloatArray]:
    """Eigenvalues, shapes and relative errors of a cluster after inverse iteration on all its shapes at once."""
    alone = len(values) == 1
    if pencil.undamped or np.all(values.imag == 0):
        values, shapes = values.real, shapes.real
    for _ in range(_POLISHING_STEPS):
        center = values.mean()
        slopes = pencil.rows.T @ (pencil.slopes(center)[:, None] * (pencil.rows @ shapes))
        shapes = _beside(pencil, center).solve(slopes)
        shapes = shapes / np.abs(shapes).max(axis=0)
        last = values
        if alone:
            values = np.array([pencil.value(shapes[:, 0], center)])
        else:
            steps, mixed = pencil.split(shapes, center)
            values, shapes = center + steps, shapes @ mixed
        if np.all(np.abs(values - last) <= _POLISHED * np.abs(values)):
            break
    moved = np.abs(values - last) / np.abs(values)
    return values, shapes, moved + _rounding(pencil, values, shapes) + _residual(pencil, values, shapes) ** (1 + alone)


def _beside(pencil: _Pencil, z: Any) -> Any:
    """LU factors of D(z) as close to an eigenvalue as D can be factored."""
    for step in _BESIDE:
        try:
            return pencil.factor(z * (1 + step))
        except RuntimeError:  # exactly singular
            continue
    raise _NotFoundError


def _rounding(pencil: _Pencil, values: AnyArray, shapes: AnyArray) -> FloatArray:
    """Relative error (n,) of each eigenvalue by rounding in its sums and, squared, in its shape."""
    motion = pencil.rows @ shapes
    terms = np.abs(motion) ** 2 + _EPS * (abs(pencil.rows) @ np.abs(shapes)) ** 2
    sizes = np.stack([pencil.magnitudes(z) for z in values], axis=1)
    slopes = np.stack([pencil.slopes(z) for z in values], axis=1)
    slope = np.abs(np.sum(slopes * motion**2, axis=0) * values)
    return np.asarray(8 * _EPS * np.sum(sizes * terms, axis=0) / slope)


def _residual(pencil: _Pencil, values: AnyArray, shapes: AnyArray) -> FloatArray:
    """Residual D(z) q of each shape, over its change if z changed by its own size, shape (n,)."""
    motion = pencil.rows @ shapes
    laws = np.stack([pencil.laws(z) for z in values], axis=1)
    slopes = np.stack([pencil.slopes(z) for z in values], axis=1)
    left = np.linalg.norm(pencil.rows.T @ (laws * motion), axis=0) * np.linalg.norm(shapes, axis=0)
    return np.asarray(left / np.abs(np.sum(slopes * motion**2, axis=0) * values))
