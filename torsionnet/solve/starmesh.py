"""Receptances by elimination on the graph: see :mod:`torsionnet.solve.graph_plan` for the equations.

>>> import numpy as np
>>> free = RowSystem(np.array([[1.0, 0.0], [0.0, 1.0], [1.0, -1.0]]), np.array([1.0, 3.0, 0.0]), np.zeros(3),
...     np.array([0.0, 0.0, 1e9]))
>>> s = 1e-3j
>>> kappa = np.array([[s * s, 3 * s * s, 1e9]])
>>> motion = respond(free, kappa, np.array([[[1.0], [0.0]]]), np.array([[0.0, 1.0], [1.0, -1.0]]))
>>> [f"{value.real:.12g}" for value in motion[0, :, 0]]
['-250000', '7.5e-10']
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.rows import ComplexArray, FloatArray, RowSystem, sparse
from torsionnet.solve import dense
from torsionnet.solve.graph_plan import Plan, make_plan
from torsionnet.solve.sweep import Array, sweep

BLOCK_BYTES = 3 * 2**20
"""Stiffness of all laws at the frequencies solved at once."""
SMALLEST_BLOCK = 512
"""Frequencies; with fewer the interpreter takes longer than the arithmetic."""
ALONE = 4
"""Up to so many excitations are solved one by one, each with its own coordinate at the root of the tree."""
EPS = float(np.finfo(float).eps)
SETTLED = 1e-13
"""Residual, relative to the sum of its terms, that needs no LAPACK."""


def respond(system: RowSystem, kappa: ComplexArray, loads: ComplexArray, rows: FloatArray) -> ComplexArray:
    """Motion of ``rows`` under ``loads``: rows @ D(s)^-1 @ loads.

    Parameters
    ----------
    system : RowSystem
    kappa : (n_f, n_laws) array
        Dynamic stiffness of each law, N m/rad; fastest where the frequencies of a law lie next to each other.
    loads : (n_f or 1, n_q, n_exc) array
        Generalised torques, N m.
    rows : (n_rows, n_q) array

    Returns
    -------
    (n_f, n_rows, n_exc) array
    """
    n_exc = loads.shape[2]
    motion = np.zeros((len(rows), n_exc, len(kappa)), dtype=complex)
    with np.errstate(all="ignore"):
        for columns in _groups(n_exc):
            support = np.flatnonzero(np.any(loads[:, :, columns] != 0, axis=(0, 2)))
            if len(support):
                plan = plan_for(system, rows, support)
                for part in _blocks(len(kappa), kappa.shape[1]):
                    here = loads[:, :, columns] if len(loads) == 1 else loads[part, :, columns]
                    motion[:, columns, part] = _solved(system, plan, kappa[part], here, rows, support)
    return np.moveaxis(motion, 2, 0)


def block_size(n_laws: int) -> int:
    """Frequencies to solve at once."""
    return max(SMALLEST_BLOCK, BLOCK_BYTES // (16 * max(1, n_laws)))


def _blocks(n_f: int, n_laws: int) -> Iterator[slice]:
    block = block_size(n_laws)
    return (slice(start, min(start + block, n_f)) for start in range(0, n_f, block))


def _groups(n_exc: int) -> list[slice]:
    return [slice(i, i + 1) for i in range(n_exc)] if n_exc <= ALONE else [slice(0, n_exc)]


def plan_for(system: RowSystem, rows: FloatArray, support: NDArray[np.intp]) -> Plan:
    """The plan for these output rows and loaded coordinates, made once for all systems that share their rows."""
    key = (rows.shape, rows.tobytes(), tuple(support))
    if key not in system.plans:
        last = int(support[0]) if len(support) else None
        system.plans[key] = make_plan(system.sparse_rows, sparse(rows), support.tolist(), last)
    plan: Plan = system.plans[key]
    return plan


def _solved(
    system: RowSystem, plan: Plan, kappa: ComplexArray, loads: ComplexArray, rows: FloatArray, support: NDArray[np.intp]
) -> ComplexArray:
    """Motion (n_rows, n_exc, n_f) of one block."""
    by_law: Array = np.ascontiguousarray(kappa.T)
    if not (any(law.imag.any() for law in by_law) or loads.imag.any()):
        by_law = np.ascontiguousarray(by_law.real)
    found = sweep(plan, by_law, _sparse_loads(loads, support, by_law), loads.shape[2])
    doubtful = ~np.isfinite(found.motion).all(axis=(0, 1))
    if found.doubtful is not None:
        doubtful |= found.doubtful
    if doubtful.any():
        again = loads if len(loads) == 1 else loads[doubtful]
        found.motion = found.motion.astype(complex)
        found.motion[:, :, doubtful] = _again(system, plan, kappa[doubtful], again, rows, support)
    return found.motion


def _sparse_loads(loads: ComplexArray, support: NDArray[np.intp], like: Array) -> dict[int, Array]:
    values = loads if np.iscomplexobj(like) else loads.real
    return {j: np.ascontiguousarray(values[:, j].T) for j in support.tolist()}


def _again(
    system: RowSystem, plan: Plan, kappa: ComplexArray, loads: ComplexArray, rows: FloatArray, support: NDArray[np.intp]
) -> ComplexArray:
    """The few frequencies with a pivot near zero.

    With a rounding error of damping in every law nothing is singular. On a tree that is all; where loops are, the tiny
    pivot has cost digits, which refinement gives back, or LAPACK where it does not.
    """
    by_law = np.ascontiguousarray(kappa.T)
    nearby = by_law + 1j * EPS * np.abs(by_law)
    if plan.is_tree:
        return sweep(plan, nearby, _sparse_loads(loads, support, by_law), loads.shape[2]).motion
    everything = np.arange(system.n_coordinates)
    complete = plan_for(system, np.eye(system.n_coordinates), everything)
    right = np.broadcast_to(np.moveaxis(loads, 0, 2), (*loads.shape[1:], len(kappa)))
    motion = np.zeros(right.shape, dtype=complex)
    for _ in range(3):
        rest, size = _residual(system, by_law, motion, right)
        motion += sweep(complete, nearby, dict(enumerate(rest.copy())), loads.shape[2]).motion
    rest, size = _residual(system, by_law, motion, right)
    settled = (np.abs(rest) <= SETTLED * size).all(axis=(0, 1))
    result = np.tensordot(rows, motion, 1)
    if not settled.all():
        left = ~settled
        by_lapack = dense.respond(system, kappa[left], loads if len(loads) == 1 else loads[left], rows)
        result[:, :, left] = np.moveaxis(by_lapack, 0, 2)
    return np.asarray(result)


def _residual(
    system: RowSystem, kappa: ComplexArray, motion: ComplexArray, right: ComplexArray
) -> tuple[ComplexArray, FloatArray]:
    """Rest f - B^T kappa B q, and the sum of the magnitudes of its terms, (n_q, n_exc, n_f)."""
    rest, size = right.astype(complex), np.abs(right)
    for row, stiffness in zip(system.sparse_rows, kappa, strict=True):
        twist = sum((a * motion[j] for j, a in row.items()), start=np.zeros(1))
        terms = sum((abs(a) * np.abs(motion[j]) for j, a in row.items()), start=np.zeros(1))
        for j, a in row.items():
            rest[j] -= a * (stiffness * twist)
            size[j] += abs(a) * (np.abs(stiffness) * terms)
    return rest, size
