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
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray, RowSystem
from torsionnet.linear.dynamic_stiffness.reduction import (
    AnyArray,
    require_resistance,
    resisted_coordinates,
    restrict_to,
    without_empty_laws,
)
from torsionnet.linear.dynamic_stiffness.row_algebra import echelon_basis, unresisted_motions, unresisted_within
from torsionnet.linear.modes.pencil import NotFoundError, Pencil, distinct, polished, refined
from torsionnet.linear.modes.spectrum import Eigenpairs

Apply: TypeAlias = Callable[[FloatArray], FloatArray]

MODES_PER_SPARSE_MODE = 4
"""Number of all modes over number of modes sought, below which the dense solution of all modes is quicker."""
SPARSE_TOLERANCE = 1e-10
"""Estimated relative error of an eigenvalue up to which the sparse result is used."""
LARGEST_DENSE = 2000
"""Number of coordinates beyond which dense arrays of n by n cost hours and gigabytes."""
_RIGID_ECHO = 1e-6
"""Polished over started eigenvalue up to which a mode was a rigid body."""
_KRYLOV_TOLERANCE = 1e-13
"""Relative accuracy of eigenvalues that is asked of ARPACK, which leaves the last digits to polishing."""
_MISSED_MARGIN = 1e-9
"""Relative tolerance by which a later eigenvalue counts as missed before."""
_RESOLVED, _SHIFT_ROUNDS = 0.1, 8
"""Slowest pole over the shift below which poles are not separated, and most changes of shift or number of modes."""


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
        unsprung = unresisted_motions(system, stiff)
        rigid, undamped = unsprung.first(count), unresisted_within(unsprung, system, damped).first(count)
        massless = unresisted_motions(system, heavy).dimension
        return cls(echelon_basis(rigid.basis()), undamped.basis(), system.n_coordinates - massless)


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
            pairs = _search(system, motions, count, undamped=undamped)
    except (NotFoundError, ArpackError, np.linalg.LinAlgError, RuntimeError) as error:  # the last: singular in SuperLU
        if system.n_coordinates <= LARGEST_DENSE:
            return None
        size = system.n_coordinates
        raise SolveError(
            f"a sparse search finds too few of the lowest modes of {size} coordinates; leave out lowest= to get all "
            "modes, which takes long",
            kind="no-solution",
        ) from error
    return pairs if system.n_coordinates > LARGEST_DENSE or np.all(pairs.errors[:count] <= SPARSE_TOLERANCE) else None


def _search(system: RowSystem, motions: RigidMotions, count: int, *, undamped: bool) -> Eigenpairs:
    pencil, starts = _starts(system, motions, count, undamped=undamped)
    parts = []
    for before, forms in starts:
        values, shapes, errors = polished(pencil, before, forms)
        # What polishing carries to zero was a rigid body.
        kept = np.abs(values) > _RIGID_ECHO * np.abs(before)
        parts.append((values[kept], pencil.scale[:, None] * shapes[:, kept], errors[kept]))
    values, shapes, errors = (np.concatenate(part, axis=-1) for part in zip(*parts, strict=True))
    if len(parts) > 1:
        kept = distinct(values, shapes)
        values, shapes, errors = values[kept], shapes[:, kept], errors[kept]
    if len(values) < count:
        raise NotFoundError
    order = np.argsort(np.abs(values), kind="stable")
    values, shapes, errors = values[order], shapes[:, order], errors[order]
    if np.any(errors[:count] > SPARSE_TOLERANCE):
        values, shapes, errors = refined(pencil, values, shapes, errors)
    return _eigenpairs(1j * np.sqrt(values.real) if undamped else values, shapes, errors)


def _starts(
    system: RowSystem, motions: RigidMotions, count: int, *, undamped: bool
) -> tuple[Pencil, list[tuple[AnyArray, AnyArray]]]:
    """Pencil of a system, and for each of its problems with constant coefficients starts z and shapes (n_q, n).

    With stiffness over frequency these are the problems at rest and at the frequency of the last mode sought. A law
    moves the order of the frequencies by one place at most, so that with one more for each law none is left out.
    """
    if not system.dynamic:
        slowest = _slowest_undamped(system, motions)
        pencil = Pencil.of(system, undamped=undamped, at=slowest, sparse=True)
        return pencil, [(_undamped if undamped else _damped)(pencil, motions, count, slowest)]
    starts: list[tuple[AnyArray, AnyArray]] = []
    omega = 0.0
    for _ in range(2):
        frozen = system.at_frequency(omega)
        most = count + motions.rigid.shape[1]  # all of them, as one left in is found again and again
        own = RigidMotions.of(frozen, frozen.stiffness > 0, frozen.damping != 0, most)
        pencil, parts = _starts(frozen, own, count + min(len(system.dynamic), count), undamped=undamped)
        values, shapes = parts[0]
        kept = values.imag > 0 if omega and not undamped else values != 0  # real poles are those at rest
        starts.append((values[kept], pencil.scale[:, None] * shapes[:, kept]))
        omega = float(np.sort(np.sqrt(np.abs(values)) if undamped else np.abs(values))[count - 1])
    whole = Pencil.of(system, undamped=undamped, at=omega, sparse=True)
    return whole, [(values, shapes / whole.scale[:, None]) for values, shapes in starts]


def _eigenpairs(values: ComplexArray, shapes: AnyArray, errors: FloatArray) -> Eigenpairs:
    n = len(values)
    return Eigenpairs(
        values, shapes.astype(complex), values.imag == 0, errors, np.ones(n, dtype=bool), np.ones(n, dtype=int)
    )


# --- without damping ------------------------------------------------------------------------------------------------


def _inertia_rows(pencil: Pencil) -> Any:
    from scipy import sparse

    heavy = np.flatnonzero(pencil.inertia > 0)
    return sparse.csr_array(sparse.diags_array(np.sqrt(pencil.inertia[heavy])) @ pencil.rows.tocsr()[heavy])


def _slowest_undamped(system: RowSystem, motions: RigidMotions) -> float:
    """Rough lowest nonzero natural frequency in rad/s of a system without damping."""
    kept = resisted_coordinates(system)
    if len(kept) == system.n_coordinates:
        return _slowest(Pencil.of(system, undamped=True, sparse=True), motions.rigid)
    system = without_empty_laws(restrict_to(system, kept))
    rigid = unresisted_motions(system, system.stiffness > 0).basis()
    return _slowest(Pencil.of(system, undamped=True, sparse=True), rigid)


def _slowest(pencil: Pencil, rigid: FloatArray) -> float:
    # A shift far below trace K / trace M first, which the frequency found then corrects.
    square = float(np.sum(pencil.stiffness > 0)) and 1e-6 / float(pencil.scale.max() / pencil.scale.min())
    square *= float(pencil.gram(pencil.stiffness).diagonal().sum() / pencil.M.diagonal().sum())
    for _ in range(_SHIFT_ROUNDS):
        problem = _Symmetric(pencil, rigid, square)
        lowest = problem.squares(problem.eigenpairs(1, tolerance=1e-3)[0])[0]
        is_close = square / 100 <= lowest <= square * 1e4
        square = max(lowest, square * 1e-5)
        if is_close:
            return float(np.sqrt(square))
    raise NotFoundError


class _Symmetric:
    """Symmetric operator P S (K + sigma M)^-1 S^T P for undamped modes, with eigenvalues 1/(omega^2 + sigma)."""

    def __init__(self, pencil: Pencil, rigid: FloatArray, sigma: float) -> None:
        self.rows, self.sigma = _inertia_rows(pencil), sigma
        self.factors = pencil.factor(-sigma, definite=True)
        self.known = np.linalg.qr(self.rows @ (rigid / pencil.scale[:, None]))[0]

    def eigenpairs(self, count: int, tolerance: float = _KRYLOV_TOLERANCE) -> tuple[FloatArray, FloatArray]:
        """Largest ``count`` eigenvalues in s^2 of the operator, and their vectors y orthogonal to the known ones."""
        from scipy.sparse.linalg import eigsh

        def project(y: FloatArray) -> FloatArray:
            return np.asarray(y - self.known @ (self.known.T @ y))

        size = self.rows.shape[0]
        # S (K + sigma M)^-1 S^T with M = S^T S: the largest 1/(omega^2 + sigma) are those of the lowest modes.
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


def _undamped(pencil: Pencil, motions: RigidMotions, count: int, slowest: float) -> tuple[FloatArray, FloatArray]:
    """Squares omega^2 in (rad/s)^2 of the lowest natural frequencies and shapes (n_q, n), at least ``count``."""
    problem = _Symmetric(pencil, motions.rigid, slowest**2 / 2)
    values, vectors = problem.eigenpairs(count + 1)
    # Again without the modes found: a further one of a multiple eigenvalue only shows then.
    for _ in range(count):
        problem.known = np.linalg.qr(np.hstack([problem.known, vectors]))[0]
        more, extra = problem.eigenpairs(2)
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

    def __init__(self, pencil: Pencil, motions: RigidMotions, sigma: float, unit: float) -> None:
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
        # -D(sigma)^-1 ((C + sigma M) q + M s q), and s q from s q = lambda q
        q = -self.factors.solve(self.load @ x)
        return np.concatenate([q, (x[:n] + self.sigma * q) / self.unit])

    def form(self, x: FloatArray) -> FloatArray:
        n, M = len(x) // 2, self.pencil.M
        return np.concatenate([self.pencil.C @ x[:n] + self.unit * (M @ x[n:]), self.unit * (M @ x[:n])])

    def eigenpairs(self, count: int) -> tuple[ComplexArray, ComplexArray]:
        """Eigenvalues in rad/s next to sigma and their vectors x outside the known ones, conjugates included."""
        from scipy.sparse.linalg import eigs

        # Vectors known already are taken out by the pencil's own form: B-orthogonal, x - X (X^T B X)^-1 X^T B x.
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


def _damped(pencil: Pencil, motions: RigidMotions, count: int, slowest: float) -> tuple[ComplexArray, ComplexArray]:
    """Lowest eigenvalues in rad/s and shapes (n_q, n), at least ``count``, one of each conjugate pair."""
    wanted, sigma, n = 2 * count + 8, slowest / 20, len(pencil.scale)
    for _ in range(_SHIFT_ROUNDS):
        if wanted > motions.dynamic:
            raise NotFoundError
        problem = _Companion(pencil, motions, sigma, 20 * sigma)
        values, vectors = problem.eigenpairs(wanted)
        upper = values.imag >= 0
        values, vectors = values[upper], vectors[:, upper]
        sizes = np.sort(np.abs(values))
        # All poles within ``radius`` of sigma are known, and these hold the circle about zero with ``count`` of them.
        enough = len(sizes) >= count and sizes[count - 1] + sigma <= problem.radius * (1 + _MISSED_MARGIN)
        resolved = len(sizes) > 0 and sizes[0] > sigma * _RESOLVED
        if enough and resolved:
            break
        wanted = wanted if enough else wanted + wanted // 2
        sigma = min(sigma, max(float(sizes[0]), sigma / 1000)) if len(sizes) else sigma
    else:
        raise NotFoundError
    for _ in range(count):
        problem.add_known(values, vectors)
        more, extra = problem.eigenpairs(2)
        missed = (np.abs(more) <= np.sort(np.abs(values))[count - 1] * (1 + _MISSED_MARGIN)) & (more.imag >= 0)
        if not np.any(missed):
            break
        values, vectors = np.concatenate([values, more[missed]]), np.hstack([vectors, extra[:, missed]])
        problem.known = problem.known[:, : motions.rigid.shape[1] + motions.undamped.shape[1]]
    return values, vectors[:n]
