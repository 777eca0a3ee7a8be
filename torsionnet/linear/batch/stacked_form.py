"""First-order equations of motion for a stack of variants that share rows.

See :mod:`torsionnet.linear.dynamic_stiffness.reduction` for one system.

The algebra is that of one system; numpy hands every matrix of a stack to LAPACK by itself. Sums over laws are products
of stacked matrices too, not ``einsum`` and no product over the variants, which may add in another order when there
are fewer of them: the bits of a variant do not depend on its neighbours.

Nonzero eigenvalues in rad/s and shapes of a stack of first-order forms, each with an estimate of its error. The error
is estimated as in :mod:`torsionnet.linear.modes.spectrum`, from the size of the form and the condition of the
eigenvalue, which its symmetry gives without left vectors: with x = (velocities, forces) and S = diag(I, -I) the matrix
S A is symmetric, so that S x is the left vector of x.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray, RowSystem
from torsionnet.linear.dynamic_stiffness.reduction import (
    AnyArray,
    complement_within,
    require_resistance,
    stiff_laws,
)
from torsionnet.linear.dynamic_stiffness.row_algebra import echelon_basis, unresisted_motions, unresisted_within
from torsionnet.linear.modes.spectrum import on_real_axis

# Rigid and massless motions that all variants with the same rows and acting laws have in common.


@dataclass(frozen=True, eq=False)
class SharedDirections:
    """Bases (n_q, n) of rigid and massless motions, which follow from rows alone and not from coefficients.

    Attributes
    ----------
    rows : (n_laws, n_q) array
    heavy, stiff, dissipating : index arrays
        Laws with inertia, with stiffness, with damping of either sign.
    rigid, undamped_rigid : arrays
        Motions that no spring resists, and of these the ones that no damper resists either.
    damped, held : arrays
        Massless directions that dampers hold, and those that springs alone hold.
    """

    rows: FloatArray
    heavy: NDArray[np.intp]
    stiff: NDArray[np.intp]
    dissipating: NDArray[np.intp]
    rigid: FloatArray
    undamped_rigid: FloatArray
    damped: FloatArray
    held: FloatArray

    @property
    def n_moving(self) -> int:
        """Number of independent motions that have inertia."""
        return int(self.rows.shape[1] - self.damped.shape[1] - self.held.shape[1])

    @property
    def spring_rank(self) -> int:
        return int(self.rows.shape[1] - self.rigid.shape[1])

    @property
    def vibrations(self) -> int:
        """Number of vibrations that the inertias and springs have without dampers."""
        return int(min(self.n_moving - self.undamped_rigid.shape[1], self.spring_rank - self.held.shape[1]))

    @classmethod
    def of(cls, system: RowSystem) -> SharedDirections:
        """Bases (n_q, n) of rigid and massless motions of a system, of whose coefficients only the signs count.

        Raises
        ------
        SolveError
            Where some coordinates have neither inertia nor spring nor damper.
        """
        moves = system.rows.any(axis=1)  # laws on clamped nodes alone have empty rows
        heavy, stiff, damped = (laws & moves for laws in (system.inertia > 0, stiff_laws(system), system.damping != 0))
        require_resistance(system, heavy | stiff | damped)
        # Massless are motions that no inertia resists, held by springs alone those that no damper resists either.
        massless, held = (unresisted_motions(system, laws).basis() for laws in (heavy, heavy | damped))
        unsprung = unresisted_motions(system, stiff)
        return cls(
            rows=system.rows,
            heavy=np.flatnonzero(heavy),
            stiff=np.flatnonzero(stiff),
            dissipating=np.flatnonzero(damped),
            rigid=echelon_basis(unsprung.basis()),
            undamped_rigid=unresisted_within(unsprung, system, damped).basis(),
            damped=complement_within(held, massless),
            held=held,
        )


class Coefficients(NamedTuple):
    """Coefficients J, c, k and loss k eta of the laws of n variants, in SI units, each (n, n_laws)."""

    inertia: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    loss: FloatArray

    @property
    def n_variants(self) -> int:
        return len(self.inertia)

    def of(self, variants: NDArray[np.generic] | slice) -> Coefficients:
        """Inertia, damping, stiffness and loss of the laws in SI units for the selected variants."""
        return Coefficients(*(part[variants] for part in self))

    def lossless(self) -> Coefficients:
        """Copy of the coefficients of all laws in which hysteretic springs have no loss."""
        return self._replace(loss=np.zeros_like(self.loss))

    def undamped(self) -> Coefficients:
        return self.lossless()._replace(damping=np.zeros_like(self.damping))


@dataclass(frozen=True, eq=False)
class StackedForm:
    """First-order forms x' = A x of n variants in SI units, with x = (scaled velocities, spring forces)."""

    matrix: AnyArray  # (n, n_x + n_u, n_x + n_u), complex with hysteretic springs
    coupling: AnyArray  # (n, n_u, n_x)
    recover: AnyArray  # (n, n_q, n_x + n_u)
    size: FloatArray  # (n,)


def stacked_form(directions: SharedDirections, given: Coefficients) -> StackedForm:
    """First-order forms x' = A x of all variants, x = (scaled velocities, spring forces), from their coefficients.

    Damping may be below zero where no damper holds a massless direction, and springs hysteretic where neither these nor
    loops of springs nor springs alone hold one: see ``is_stackable``.
    """
    # X^T M X = I: scaled velocities have unit inertia.
    moving = _moving(directions, given.inertia)
    stiffness: AnyArray = given.stiffness[:, directions.stiff]
    if given.loss.any():
        stiffness = np.asarray(stiffness + 1j * given.loss[:, directions.stiff], dtype=complex)
    # E^T E = K, with complex roots of k + j k eta where springs are hysteretic.
    E: AnyArray = np.sqrt(stiffness)[:, :, None] * directions.rows[directions.stiff]
    # Motions v = X x + N_1 z_1 + N_2 z_2: with inertia, massless with dampers, massless with springs alone.
    E_x, E_1, E_2 = E @ moving, E @ directions.damped, E @ directions.held
    basis = _force_basis(directions, E, E_2)
    forces: AnyArray = E_x
    pull: AnyArray = E_1.mT
    if basis is not None:
        forces, pull = basis.mT @ E_x, pull @ basis
    part = _dissipated(directions, given.damping[:, directions.dissipating], moving, pull)
    forces = forces - part.cross
    # A = [[-drag, -F^T], [F, -yielding]] over (velocities, forces), with F from springs and damping.
    matrix = np.concatenate(
        [np.concatenate([-part.drag, -forces.mT], axis=2), np.concatenate([forces, -part.yielding], axis=2)], axis=1
    )
    rest = np.zeros((*moving.shape[:2], forces.shape[1]))
    known = np.asarray(np.concatenate([moving, rest], axis=2) - directions.damped @ part.followed)
    # N_2 follows the rest, (E N_2)^T E v = 0, with E N_2 = Q_2 R_2.
    if directions.held.shape[1]:
        Q_2, R_2 = np.linalg.qr(E_2)
        known = known - directions.held @ np.linalg.solve(R_2, Q_2.mT @ (E @ known))
    return StackedForm(matrix, forces, known, part.size + _norm(E_x) + _norm(matrix))


class _Split(NamedTuple):
    """Damping blocks of variants on moving motions and spring forces, once massless ones N_1 are eliminated.

    They are those of ``reduction``.
    """

    drag: AnyArray
    yielding: AnyArray
    cross: AnyArray
    followed: AnyArray
    size: FloatArray


def _dissipated(directions: SharedDirections, damping: FloatArray, moving: FloatArray, pull: AnyArray) -> _Split:
    """Damping blocks of variants, once massless motions are eliminated, by square roots of dampings.

    The ``pull`` (n, n_1, n_u) are the forces of springs on N_1.
    """
    n, n_x, n_u = len(damping), moving.shape[2], pull.shape[2]
    # Rows of dampers by roots of |c|; the sign of one that drives is put back below.
    G = np.sqrt(np.abs(damping))[:, :, None] * directions.rows[directions.dissipating]
    G_x = np.asarray(G @ moving)
    if not directions.damped.shape[1]:
        drag = G_x.mT @ (np.sign(damping)[:, :, None] * G_x)
        return _Split(drag, np.zeros((n, n_u, n_u)), np.zeros(1), np.zeros((n, 0, n_x + n_u)), _norm(G_x) ** 2)
    # Balance on N_1 with G_1 = Q_1 R_1: z_1 = -R_1^-1 (Q_1^T G_x x + H u), H = R_1^-T (E N_1)^T Y.
    Q_1, R_1 = np.linalg.qr(G @ directions.damped)
    slip, H = np.asarray(Q_1.mT @ G_x), np.asarray(np.linalg.solve(R_1.mT, pull))
    # Dampers that N_1 cannot yield to, by the projection I - Q_1 Q_1^T, still resist X.
    G_p = np.asarray(G_x - Q_1 @ slip)
    followed = np.linalg.solve(R_1, np.concatenate([slip, H], axis=2))
    size = np.asarray(_norm(G_x) * _norm(G_p) + _norm(H) * _norm(slip))
    return _Split(G_p.mT @ G_p, H.mT @ H, H.mT @ slip, followed, size)


def is_stackable(directions: SharedDirections, given: Coefficients) -> bool:
    """Whether the first-order forms of these variants can be calculated as one stack."""
    # The elimination of N_1 takes roots of c and has no place for their signs.
    driven = bool((given.damping < 0).any()) and bool(directions.damped.size)
    # QR and SVD orthogonalise by E^H E, while the form of a complex E needs E^T E.
    tied = bool(directions.held.size) or len(directions.stiff) > directions.spring_rank
    return not driven and not (tied and bool(given.loss.any()))


def _moving(directions: SharedDirections, inertia: FloatArray) -> FloatArray:
    """Basis X (n, n_q, n_x) of motions with inertia, X^T M X = I, M-orthogonal to the undamped rigid motions."""
    rows = directions.rows[directions.heavy]
    scaled = np.sqrt(inertia[:, directions.heavy])[:, :, None] * rows
    # Columns of length one, so that small inertias beside large ones keep their digits.
    lengths = np.linalg.norm(scaled, axis=1)
    used, rank = np.flatnonzero(rows.any(axis=0)), directions.n_moving
    basis = np.zeros((len(inertia), rows.shape[1], rank))
    if np.all(np.count_nonzero(rows, axis=1) <= 1):
        # M is diagonal and X = M^(-1/2).
        basis[:, used, np.arange(rank)] = 1.0 / lengths[:, used]
    else:
        # With S^T S = M the right singular vectors over sigma are X.
        _, sigma, vt = np.linalg.svd(scaled[:, :, used] / lengths[:, None, used], full_matrices=False)
        basis[:, used] = vt[:, :rank].mT / sigma[:, None, :rank] / lengths[:, used, None]
    if not directions.undamped_rigid.shape[1]:
        return basis
    # Rigid motions that nothing damps have lambda = 0 and stay out of the form.
    return np.asarray(basis @ _complement((scaled @ basis).mT @ (scaled @ directions.undamped_rigid)))


def _complement(columns: AnyArray) -> AnyArray:
    """Orthonormal bases (n, size, m) of the orthogonal complements of the columns of every matrix in a stack."""
    return np.asarray(np.linalg.qr(columns, mode="complete")[0][:, :, columns.shape[2] :])


def _force_basis(directions: SharedDirections, springs: AnyArray, held: AnyArray) -> AnyArray | None:
    """Bases of spring forces that balance on massless held motions, (n, n_k, n_u), or None if all forces do.

    See ``reduction``.
    """
    rank = directions.spring_rank
    if springs.shape[1] == rank:
        return _complement(held) if held.shape[2] else None
    # In loops of springs only forces in the range of E come from twists.
    inside = np.linalg.svd(springs, full_matrices=False)[0][:, :, :rank]
    return np.asarray(inside @ _complement(inside.mT @ held)) if held.shape[2] else inside


def _norm(stack: AnyArray) -> FloatArray:
    return np.asarray(np.linalg.norm(stack, axis=(1, 2)))


# Nonzero eigenvalues in rad/s and shapes of a stack of first-order forms, each with an estimate of its error.

_EPS = float(np.finfo(float).eps)
ERROR_SAFETY = 4.0
"""Safety factor on the error estimate of eigenvalues, a larger value of which sends more variants to the single
solver."""
ERROR_SAFETY_MASSLESS = 100.0
"""Safety factor on the error estimate with massless motions, whose elimination adds rounding errors."""


class StackedVibrations(NamedTuple):
    """Nonzero eigenvalues (n, m) in rad/s by size, their shapes (n, n_q, m), and relative errors (n, m)."""

    values: ComplexArray
    vectors: ComplexArray
    errors: FloatArray

    def columns_of(self, some: NDArray[np.intp], columns: NDArray[np.intp]) -> StackedVibrations:
        """Eigenvalues, shapes and relative errors of some variants in these columns (n, m)."""
        return StackedVibrations(
            np.take_along_axis(self.values[some], columns, axis=1),
            np.take_along_axis(self.vectors[some], columns[:, None, :], axis=2),
            np.take_along_axis(self.errors[some], columns, axis=1),
        )


Some: TypeAlias = tuple[NDArray[np.intp], StackedVibrations]


def undamped_vibrations(directions: SharedDirections, given: Coefficients) -> StackedVibrations:
    """Eigenvalues (n, m) in rad/s and shapes (n, n_q, m) of variants without damping, by rising frequency."""
    form = stacked_form(directions, given)
    # A = [[0, -F^T], [F, 0]] has the eigenvalues +-j sigma(F).
    _, sigma, vt = np.linalg.svd(form.coupling, full_matrices=False)
    rates, states = sigma[:, ::-1], vt.mT[:, :, ::-1]
    # A is skew-symmetric, so that |d lambda| <= ||dA||, a few roundings of its entries.
    errors = _safety(directions) * _EPS * form.size[:, None] / rates
    return StackedVibrations(1j * rates, (form.recover[:, :, : states.shape[1]] @ states).astype(complex), errors)


def damped_vibrations(directions: SharedDirections, given: Coefficients) -> Iterator[Some]:
    """Yield indices of variants and their damped modes (eigenvalues, shapes, errors), grouped by number of modes."""
    vibrations = _every(directions, given)
    real = on_real_axis(vibrations.values)
    # One of every conjugate pair and all real poles; the others are sorted to the end.
    kept = (vibrations.values.imag > 0) | real
    order = np.argsort(np.where(kept, np.abs(vibrations.values), np.inf), axis=1, kind="stable")
    values = _settling(vibrations.values, given)
    values.imag[real] = 0.0
    vibrations = vibrations._replace(values=values)
    # Beyond critical damping a vibration is two real poles, so that variants differ in their number of modes.
    counts = kept.sum(axis=1)
    for count in sorted(set(counts.tolist())):
        some = np.flatnonzero(counts == count)
        yield some, vibrations.columns_of(some, order[some, :count])


def hysteretic_vibrations(directions: SharedDirections, given: Coefficients) -> Iterator[Some]:
    """Yield indices of variants and their modes (eigenvalues, shapes, errors) with hysteretic springs, grouped.

    They are grouped by number of real poles, and defined as in ``frozen_stiffness``.

    Real poles are those of the elastic springs. There are as many vibrations as these have; of the eigenvalues above
    the real axis they are the least damped ones, since the loss moves real poles off that axis.
    """
    elastic = given.lossless()
    vibrations = _every(directions, given)
    # The larger Im lambda / |lambda|, the less a vibration is damped.
    damping = np.where(vibrations.values.imag > 0, -vibrations.values.imag / np.abs(vibrations.values), np.inf)
    least = np.argsort(damping, axis=1, kind="stable")
    if directions.dissipating.size:
        rest = _every(directions, elastic)
        real = on_real_axis(rest.values)
    else:
        rest, real = vibrations, np.zeros(vibrations.values.shape, dtype=bool)
    first_real = np.argsort(~real, axis=1, kind="stable")
    counts = real.sum(axis=1)
    # Every vibration takes two eigenvalues of the form, every real pole one.
    total = 2 * directions.vibrations if not directions.dissipating.size else vibrations.values.shape[1]
    for count in sorted(set(counts.tolist())):
        some = np.flatnonzero(counts == count)
        vibrating = vibrations.columns_of(some, least[some, : (total - count) // 2])
        still = rest.columns_of(some, first_real[some, :count])
        still.values.imag[:] = 0.0
        both = StackedVibrations(*(np.concatenate(pair, axis=-1) for pair in zip(vibrating, still, strict=True)))
        both = both._replace(values=_settling(both.values, given.of(some)))
        yield some, both.columns_of(np.arange(len(some)), np.argsort(np.abs(both.values), axis=1, kind="stable"))


def _settling(values: ComplexArray, given: Coefficients) -> ComplexArray:
    """Eigenvalues (n, m) in rad/s in which the growth of passive variants, which is rounding, is set to zero."""
    passive = ((given.damping >= 0) & (given.loss >= 0)).all(axis=1, keepdims=True)
    return np.asarray(np.where(passive, np.minimum(values.real, 0.0), values.real) + 1j * values.imag)


def _every(directions: SharedDirections, given: Coefficients) -> StackedVibrations:
    """All nonzero eigenvalues in rad/s of the first-order forms, with shapes and errors, conjugates included."""
    form = stacked_form(directions, given)
    values, states = (np.asarray(part, dtype=complex) for part in np.linalg.eig(form.matrix))
    # S = diag(I, -I) makes S A symmetric: S x is the left vector and cond = ||x||^2 / |x^T S x|.
    sign = np.where(np.arange(states.shape[1]) < form.coupling.shape[2], 1.0, -1.0)[:, None]
    condition = np.sum(np.abs(states) ** 2, axis=1) / np.abs(np.sum(sign * states**2, axis=1))
    errors = _safety(directions) * _EPS * form.size[:, None] * condition / np.abs(values)
    return StackedVibrations(values, form.recover @ states, errors)


def _safety(directions: SharedDirections) -> float:
    return ERROR_SAFETY_MASSLESS if directions.damped.size or directions.held.size else ERROR_SAFETY


def residuals(rows: FloatArray, given: Coefficients, vibrations: StackedVibrations) -> FloatArray:
    """Residual torques (n, m) of each mode's equation of motion, over the sum of the magnitudes of their terms."""
    z, motion, sizes = vibrations.values[:, None, :], rows @ vibrations.vectors, np.abs(rows)
    J, c, elastic, loss = (part[:, :, None] for part in given)
    k: AnyArray = elastic
    if given.loss.any():  # real poles are those of elastic springs
        k = np.asarray(elastic + 1j * np.where(z.imag > 0, loss, 0.0), dtype=complex)
    # D(lambda) q = B^T (k + c lambda + J lambda^2) B q
    left = rows.T @ ((k + c * z + J * z**2) * motion)
    size = np.abs(z)
    # The same sum of magnitudes, in which nothing cancels.
    terms = sizes.T @ ((np.abs(k) + np.abs(c) * size + J * size**2) * (sizes @ np.abs(vibrations.vectors)))
    return np.asarray(np.linalg.norm(left, axis=1) / np.linalg.norm(terms, axis=1))
