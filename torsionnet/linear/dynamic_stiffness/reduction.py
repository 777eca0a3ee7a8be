"""First-order equations of a drivetrain in velocities and spring forces, without massless or undriven directions.

With S = diag(sqrt(J)) B, G = diag(sqrt(c)) B and E = diag(sqrt(k)) B the equations of motion are

    S^T S v' + G^T G v + E^T w = 0,    w' = E v,    v = q'

K = E^T E is never formed, and a rigid-body motion (E v = 0) has one zero eigenvalue here instead of two.
All dimensions come from ranks of the *unweighted* normalised rows, never from thresholds on stiffness or eigenvalues:

    N_0 = null(spring, damper)    undamped rigid motion: deflated
    N_2 = null(inertia, damper)   massless, held by springs: N_2^T E^T w = 0, static elimination
    N_1 : rest of null(inertia)   massless, held by dampers: velocity follows from the forces
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.rows import FloatArray, Rows, RowSystem
from torsionnet.linear.dynamic_stiffness.row_algebra import echelon_basis, unresisted_motions, unresisted_within

AnyArray: TypeAlias = NDArray[np.float64] | NDArray[np.complex128]

LARGE_SYSTEM = 60
"""Number of coordinates above which a drivetrain is large, so that methods that follow its graph pay off."""


@dataclass(frozen=True)
class Subspaces:
    """Bases (n_q, n) of the motions that are rigid, that have inertia, and of massless damped and massless held ones.

    Columns are directions in q.

    Attributes
    ----------
    rigid : (n_q, n_rigid) array
        Motions that no spring resists.
    moving : (n_q, n_x) array
        X with X^T M X = I, M-orthogonal to the undamped rigid motions N_0.
    damped, held : arrays
        Massless directions N_1 and N_2.
    springs : (n_k,) index array
        The laws with stiffness.
    spring_rank : int
        Rank of the spring rows.
    undamped_rigid : int
        dim N_0.
    """

    rigid: FloatArray
    moving: FloatArray
    damped: FloatArray
    held: FloatArray
    springs: NDArray[np.intp]
    spring_rank: int
    undamped_rigid: int


@dataclass(frozen=True)
class FirstOrder:
    """First-order form x' = A x of a drivetrain, x = (scaled velocities, spring forces), and the map to q'."""

    matrix: AnyArray
    coupling: AnyArray  # (n_u, n_x): the velocity-to-force block of the matrix
    spaces: Subspaces
    recover: AnyArray  # (n_q, n_x + n_u): v = recover @ x, up to the scale of a mode
    size: float  # norm of the matrix and of the terms that cancelled on the way to it


def orthogonal_complement(columns: AnyArray, size: int) -> AnyArray:
    """Orthonormal basis (size, n) of the vectors z with columns^T z = 0, for ``columns`` of full rank.

    The product is bilinear, also where ``columns`` is complex.
    """
    if not columns.shape[1]:
        return np.eye(size)
    return np.asarray(np.linalg.qr(columns.conj(), mode="complete")[0][:, columns.shape[1] :])


def complement_within(part: FloatArray, whole: FloatArray) -> FloatArray:
    """Orthonormal basis (n_q, n) of the complement of ``part`` within the span of ``whole``.

    The columns of both are orthonormal.
    """
    return np.asarray(whole @ orthogonal_complement(whole.T @ part, whole.shape[1]), dtype=float)


def _mass_basis(scaled_rows: FloatArray, rank: int) -> FloatArray:
    """Basis X (n_q, rank), (S X)^T (S X) = I, of the motions with inertia, for rows S scaled by sqrt(J).

    The scaling is exact where M is diagonal.
    """
    lengths = np.linalg.norm(scaled_rows, axis=0)
    used = np.flatnonzero(lengths)
    basis = np.zeros((scaled_rows.shape[1], rank))
    if np.all(np.count_nonzero(scaled_rows, axis=1) <= 1):
        basis[used, np.arange(rank)] = 1.0 / lengths[used]
        return basis
    unit = scaled_rows[:, used] / lengths[used]
    _, sigma, vt = np.linalg.svd(unit, full_matrices=False)
    basis[used] = vt[:rank].T / sigma[:rank] / lengths[used, None]
    return basis


def without_empty_laws(system: RowSystem) -> RowSystem:
    """Copy of a system without springs, dampers and inertias on clamped nodes alone, which have no effect."""
    rows = system.law_rows
    kept = [index for index, row in enumerate(rows.maps) if row]
    if len(kept) == len(rows):
        return system
    place = {index: number for number, index in enumerate(kept)}
    return RowSystem(
        Rows(tuple(rows.maps[index] for index in kept), rows.n_columns),
        system.inertia[kept],
        system.damping[kept],
        system.stiffness[kept],
        tuple((place[index], law) for index, law in system.dynamic if index in place),
    )


def restrict_to(system: RowSystem, kept: Sequence[int]) -> RowSystem:
    """Copy of a system with the coordinates ``kept`` only, while all others are at rest."""
    if len(kept) == system.n_coordinates:
        return system
    place = {column: number for number, column in enumerate(kept)}
    maps = tuple({place[c]: value for c, value in row.items() if c in place} for row in system.sparse_rows)
    return RowSystem(Rows(maps, len(kept)), system.inertia, system.damping, system.stiffness, system.dynamic)


def stiff_laws(system: RowSystem) -> NDArray[np.bool_]:
    """Mask (n_laws,) of laws that act as springs, with a constant or a frequency-dependent stiffness."""
    stiff = system.stiffness > 0
    stiff[[index for index, _ in system.dynamic]] = True
    return np.asarray(stiff)


def resisted_coordinates(system: RowSystem, laws: NDArray[np.bool_] | None = None) -> list[int]:
    """Numbers of the coordinates to keep, all but one of each motion that none of the laws, mask (n_laws,), resists.

    By default these are inertias and springs.
    """
    floating = unresisted_motions(system, stiff_laws(system) | (system.inertia > 0) if laws is None else laws)
    loose = {next(iter(motion)) for motion in floating.columns}
    return [column for column in range(system.n_coordinates) if column not in loose]


def require_resistance(system: RowSystem, laws: NDArray[np.bool_]) -> None:
    """Raise SolveError if some coordinate is free of all the selected springs, dampers and inertias, mask (n_laws,)."""
    free = unresisted_motions(system, laws).dimension
    if free:
        raise SolveError(
            f"{free} coordinate(s) have neither inertia nor spring nor damper; connect them, or give them an inertia",
            kind="indeterminate-motion",
        )


def subspaces(system: RowSystem, stiff: NDArray[np.bool_], damped: NDArray[np.bool_]) -> Subspaces:
    """Bases of rigid, moving, massless damped and massless held motions of a system, from the ranks of its rows.

    Raises
    ------
    SolveError
        Where some coordinates have neither inertia nor spring nor damper.
    """
    heavy = system.inertia > 0
    require_resistance(system, heavy | stiff | damped)
    # Massless motions twist no row with inertia; those held move none with a damper either, only springs.
    massless, held = (unresisted_motions(system, laws).basis() for laws in (heavy, heavy | damped))
    unsprung = unresisted_motions(system, stiff)
    rigid = echelon_basis(unsprung.basis())
    undamped_rigid = unresisted_within(unsprung, system, damped).basis()
    scaled = np.sqrt(system.inertia[heavy])[:, None] * system.rows[heavy]
    moving = _mass_basis(scaled, system.n_coordinates - massless.shape[1])
    # Free turning that nothing damps has no part in the vibrations: its share, seen by the inertia, is taken out.
    deflated = (scaled @ moving).T @ (scaled @ undamped_rigid)
    if undamped_rigid.shape[1]:
        moving = np.asarray(moving @ orthogonal_complement(deflated, moving.shape[1]), dtype=float)
    return Subspaces(
        rigid=rigid,
        moving=moving,
        damped=complement_within(held, massless),
        held=held,
        springs=np.flatnonzero(stiff),
        spring_rank=system.n_coordinates - rigid.shape[1],
        undamped_rigid=undamped_rigid.shape[1],
    )


def _spring_rows(system: RowSystem, spaces: Subspaces, stiffness: AnyArray) -> AnyArray:
    return np.asarray(np.sqrt(stiffness[spaces.springs])[:, None] * system.rows[spaces.springs])


def _force_basis(springs: AnyArray, held: AnyArray, rank: int) -> AnyArray:
    """Basis Y (n_k, n_u) of scaled spring forces that balance on every massless held motion, Y^T E N_2 = 0.

    It lies in range(E).
    """
    if len(springs) == rank:
        return orthogonal_complement(held, rank)
    inside = np.linalg.svd(springs, full_matrices=False)[0][:, :rank]
    return np.asarray(inside @ orthogonal_complement(inside.T @ held, rank))


def first_order(
    system: RowSystem, spaces: Subspaces, stiffness: AnyArray, damping: FloatArray | None = None
) -> FirstOrder:
    """First-order form x' = A x of a system, with x = (velocities in the basis X, spring forces in the basis Y).

    With G_1 = G N_1 = Q_1 R_1 and H = R_1^-T (E N_1)^T Y

        A = [[-(P G X)^T (P G X), -(Y^T E X - H^T Q_1^T G X)^T],
             [(Y^T Y)^-1 (Y^T E X - H^T Q_1^T G X), -(Y^T Y)^-1 H^T H]],    P = I - Q_1 Q_1^T

    whose symmetric part is -(C^ + D^) <= 0 for real stiffness: no unstable pole, unless a damping is negative.
    """
    damping = system.damping if damping is None else damping
    # Springs as E = K^(1/2) rows, over motions with inertia (X), damped without (N_1) and held by springs alone (N_2).
    E = _spring_rows(system, spaces, stiffness)
    E_x, E_1, E_2 = E @ spaces.moving, E @ spaces.damped, E @ spaces.held
    # Spring forces are coordinates of their own: K is never formed, and slow modes keep the digits of E.
    Y = _force_basis(E, E_2, spaces.spring_rank)
    split = _driven if np.any(damping < 0) else _dissipated
    part = split(system, spaces, damping, E_1.T @ Y)
    forces = Y.T @ E_x - part.cross
    # Y^T Y = I for real springs; loss factors make Y complex, and its basis is not orthonormal under the transpose.
    coupling: Any = forces
    yielding: Any = part.yielding
    if np.iscomplexobj(Y):
        coupling, yielding = (np.linalg.inv(Y.T @ Y) @ block for block in (coupling, yielding))
    matrix = np.block([[-part.drag, -forces.T], [coupling, -yielding]])
    recover = _recover(spaces, E, E_2, -part.followed)
    size = part.size + _norm(E_x) + _norm(matrix)
    return FirstOrder(np.asarray(matrix), np.asarray(coupling), spaces, recover, size)


class _Split(NamedTuple):
    """Damping blocks of motions with inertia and of spring forces, after elimination of massless damped motions.

    F are the forces of springs on them, N_1.
    """

    drag: AnyArray  # C_xx - C_x1 C_11^-1 C_1x
    yielding: AnyArray  # F^T C_11^-1 F
    cross: AnyArray  # F^T C_11^-1 C_1x
    followed: AnyArray  # C_11^-1 [C_1x, F]
    size: float  # norm of what cancelled


def _dissipated(system: RowSystem, spaces: Subspaces, damping: FloatArray, forces: AnyArray) -> _Split:
    """Damping blocks after elimination of the massless damped motions, from square roots of dampings >= 0.

    Square roots cost the fewest digits.
    """
    acting = damping > 0
    G = np.sqrt(damping[acting])[:, None] * system.rows[acting]
    # The same Schur complement by projection: C = G^T G, and what Q_1 spans is taken out of G_x.
    Q_1, R_1 = np.linalg.qr(G @ spaces.damped)
    G_x = G @ spaces.moving
    slip = Q_1.T @ G_x
    H = np.linalg.solve(R_1.T, forces)
    G_p = G_x - Q_1 @ slip
    size = _norm(G_x) * _norm(G_p) + _norm(H) * _norm(slip)
    return _Split(G_p.T @ G_p, H.T @ H, H.T @ slip, np.linalg.solve(R_1, np.hstack([slip, H])), size)


def _driven(system: RowSystem, spaces: Subspaces, damping: FloatArray, forces: AnyArray) -> _Split:
    """Damping blocks after elimination of the massless damped motions, for dampings of which one is negative.

    Raises
    ------
    SolveError
        Where dampers cancel on a motion without inertia.
    """
    G = system.rows
    signed = damping[:, None] * G
    # Schur complement: C_xx - C_x1 C_11^-1 C_1x is what is left where the massless motions follow the others.
    C_x = G.T @ (signed @ spaces.moving)
    C_xx, C_1x = spaces.moving.T @ C_x, spaces.damped.T @ C_x
    C_11 = np.asarray(spaces.damped.T @ (G.T @ (signed @ spaces.damped)), dtype=float)
    try:
        followed = np.linalg.inv(C_11) @ np.hstack([C_1x, forces])
    except np.linalg.LinAlgError:
        raise SolveError(
            "positive and negative damping cancel on a motion without inertia; change one of them or add an inertia",
            kind="indeterminate-motion",
        ) from None
    slip, creep = followed[:, : C_1x.shape[1]], followed[:, C_1x.shape[1] :]
    size = _norm(C_xx) + _norm(C_1x) * _norm(slip)
    return _Split(np.asarray(C_xx - C_1x.T @ slip), forces.T @ creep, forces.T @ slip, followed, size)


def _norm(values: NDArray[np.generic]) -> float:
    return float(np.linalg.norm(values))


def _recover(spaces: Subspaces, E: AnyArray, E_2: AnyArray, slip: AnyArray) -> AnyArray:
    """Matrix (n_q, n_x + n_u) that gives the velocities v of all coordinates from the state x.

    Here v = X x + N_1 z_1 + N_2 z_2 with (E N_2)^T E v = 0.
    """
    n_x = spaces.moving.shape[1]
    moving = np.hstack([spaces.moving, np.zeros((len(spaces.moving), slip.shape[1] - n_x))])
    known = moving + spaces.damped @ slip
    # The held motions follow so that the springs take no torque along them: least squares of E v.
    if not E_2.shape[1]:
        return np.asarray(known)
    if np.isrealobj(E):
        return np.asarray(known - spaces.held @ np.linalg.lstsq(E_2, E @ known, rcond=0.0)[0])
    return np.asarray(known - spaces.held @ np.linalg.solve(E_2.T @ E_2, E_2.T @ (E @ known)))
