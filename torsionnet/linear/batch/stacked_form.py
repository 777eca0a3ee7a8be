"""First-order equations of motion for a stack of variants that share rows.

See :mod:`torsionnet.linear.dynamic_stiffness.reduction` for one system.

The algebra is that of one system; numpy hands every matrix of a stack to LAPACK by itself. Sums over laws are products
of stacked matrices too, not ``einsum`` and no product over the variants, which may add in another order when there
are fewer of them: the bits of a variant do not depend on its neighbours.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.batch.shared_directions import SharedDirections
from torsionnet.linear.dynamic_stiffness.reduction import AnyArray


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
    moving = _moving(directions, given.inertia)
    stiffness: AnyArray = given.stiffness[:, directions.stiff]
    if given.loss.any():
        stiffness = np.asarray(stiffness + 1j * given.loss[:, directions.stiff], dtype=complex)
    E: AnyArray = np.sqrt(stiffness)[:, :, None] * directions.rows[directions.stiff]
    E_x, E_1, E_2 = E @ moving, E @ directions.damped, E @ directions.held
    basis = _force_basis(directions, E, E_2)
    forces: AnyArray = E_x
    pull: AnyArray = E_1.mT
    if basis is not None:
        forces, pull = basis.mT @ E_x, pull @ basis
    part = _dissipated(directions, given.damping[:, directions.dissipating], moving, pull)
    forces = forces - part.cross
    matrix = np.concatenate(
        [np.concatenate([-part.drag, -forces.mT], axis=2), np.concatenate([forces, -part.yielding], axis=2)], axis=1
    )
    rest = np.zeros((*moving.shape[:2], forces.shape[1]))
    known = np.asarray(np.concatenate([moving, rest], axis=2) - directions.damped @ part.followed)
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
    G = np.sqrt(np.abs(damping))[:, :, None] * directions.rows[directions.dissipating]
    G_x = np.asarray(G @ moving)
    if not directions.damped.shape[1]:
        drag = G_x.mT @ (np.sign(damping)[:, :, None] * G_x)
        return _Split(drag, np.zeros((n, n_u, n_u)), np.zeros(1), np.zeros((n, 0, n_x + n_u)), _norm(G_x) ** 2)
    Q_1, R_1 = np.linalg.qr(G @ directions.damped)
    slip, H = np.asarray(Q_1.mT @ G_x), np.asarray(np.linalg.solve(R_1.mT, pull))
    G_p = np.asarray(G_x - Q_1 @ slip)
    followed = np.linalg.solve(R_1, np.concatenate([slip, H], axis=2))
    size = np.asarray(_norm(G_x) * _norm(G_p) + _norm(H) * _norm(slip))
    return _Split(G_p.mT @ G_p, H.mT @ H, H.mT @ slip, followed, size)


def is_stackable(directions: SharedDirections, given: Coefficients) -> bool:
    """Whether the first-order forms of these variants can be calculated as one stack."""
    driven = bool((given.damping < 0).any()) and bool(directions.damped.size)
    tied = bool(directions.held.size) or len(directions.stiff) > directions.spring_rank
    return not driven and not (tied and bool(given.loss.any()))


def _moving(directions: SharedDirections, inertia: FloatArray) -> FloatArray:
    """Basis X (n, n_q, n_x) of motions with inertia, X^T M X = I, M-orthogonal to the undamped rigid motions."""
    rows = directions.rows[directions.heavy]
    scaled = np.sqrt(inertia[:, directions.heavy])[:, :, None] * rows
    lengths = np.linalg.norm(scaled, axis=1)
    used, rank = np.flatnonzero(rows.any(axis=0)), directions.n_moving
    basis = np.zeros((len(inertia), rows.shape[1], rank))
    if np.all(np.count_nonzero(rows, axis=1) <= 1):
        basis[:, used, np.arange(rank)] = 1.0 / lengths[:, used]
    else:
        _, sigma, vt = np.linalg.svd(scaled[:, :, used] / lengths[:, None, used], full_matrices=False)
        basis[:, used] = vt[:, :rank].mT / sigma[:, None, :rank] / lengths[:, used, None]
    if not directions.undamped_rigid.shape[1]:
        return basis
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
    inside = np.linalg.svd(springs, full_matrices=False)[0][:, :, :rank]
    return np.asarray(inside @ _complement(inside.mT @ held)) if held.shape[2] else inside


def _norm(stack: AnyArray) -> FloatArray:
    return np.asarray(np.linalg.norm(stack, axis=(1, 2)))
