"""Receptances by elimination on the graph: see :mod:`torsionnet.solve.graph_plan` for the equations.

>>> import numpy as np
>>> from torsionnet.assembly.law_stiffness import law_stiffness
>>> rows = Rows.of(np.array([[1.0, 0.0], [0.0, 1.0], [1.0, -1.0]]))
>>> free = RowSystem(rows, np.array([1.0, 3.0, 0.0]), np.zeros(3), np.array([0.0, 0.0, 1e9]))
>>> kappa = law_stiffness([free], np.array([1e-3]))
>>> motion = respond(free, kappa, np.array([[[1.0], [0.0]]]), np.array([[0.0, 1.0], [1.0, -1.0]]))
>>> [f"{value.real:.12g}" for value in motion[0, :, 0]]
['-250000', '7.5e-10']
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.law_stiffness import LawStiffness
from torsionnet.assembly.rows import ComplexArray, FloatArray, Rows, RowSystem
from torsionnet.solve import dense
from torsionnet.solve.graph_plan import Plan, make_plan
from torsionnet.solve.sweep import Array, Sweep, sweep
from torsionnet.solve.tape import make_tape

BLOCK_BYTES = 3 * 2**20
"""Stiffness of all laws at the frequencies solved at once."""
SMALLEST_BLOCK = 512
"""Lanes; with fewer the interpreter takes longer than the arithmetic."""
COMPILED_BLOCK = 2**16
"""Lanes for the compiled loop, which divides them itself; this bounds the memory of the answer."""
ALONE = 4
"""Up to so many excitations are solved one by one, each with its own coordinate at the root of the tree."""
EPS = float(np.finfo(float).eps)
SETTLED = 1e-13
"""Residual, relative to the sum of its terms, that needs no LAPACK."""


def respond(system: RowSystem, kappa: LawStiffness, loads: ComplexArray, rows: FloatArray) -> ComplexArray:
    """Motion of ``rows`` under ``loads``: rows @ D(s)^-1 @ loads.

    Parameters
    ----------
    system : RowSystem
    kappa : LawStiffness
        Dynamic stiffness of each law in n_lanes lanes.
    loads : (n_lanes or 1, n_q, n_exc) array
        Generalised torques, N m.
    rows : (n_rows, n_q) array

    Returns
    -------
    (n_lanes, n_rows, n_exc) array
    """
    return _respond(system, kappa, loads, rows, _by_numpy)


def respond_compiled(system: RowSystem, kappa: LawStiffness, loads: ComplexArray, rows: FloatArray) -> ComplexArray:
    """The same in a compiled loop.

    Raises
    ------
    MissingExtraError
        numba is not installed.
    """
    return _respond(system, kappa, loads, rows, _by_loop)


@dataclass(frozen=True)
class _Task:
    """Some excitations of one system, all of which load the coordinates of ``support`` only."""

    system: RowSystem
    kappa: LawStiffness
    loads: ComplexArray
    rows: FloatArray
    support: list[int]

    @property
    def plan(self) -> Plan:
        return plan_for(self.system, self.rows, self.support)

    @property
    def n_exc(self) -> int:
        return int(self.loads.shape[2])


def _respond(
    system: RowSystem,
    kappa: LawStiffness,
    loads: ComplexArray,
    rows: FloatArray,
    run: Callable[[_Task], Sweep],
) -> ComplexArray:
    motion = np.zeros((len(rows), loads.shape[2], kappa.n_lanes), dtype=complex)
    with np.errstate(all="ignore"):
        for columns in _groups(loads.shape[2]):
            part = loads[:, :, columns]
            support = np.flatnonzero(part.any(axis=(0, 2))).tolist()
            if support:
                motion[:, columns] = _solved(_Task(system, kappa, part, rows, support), run)
    return np.moveaxis(motion, 2, 0)


def block_size(n_laws: int, method: str = "graph") -> int:
    """Lanes to solve at once."""
    if method == "compiled":
        return COMPILED_BLOCK
    return max(SMALLEST_BLOCK, BLOCK_BYTES // (16 * max(1, n_laws)))


def _groups(n_exc: int) -> list[slice]:
    return [slice(i, i + 1) for i in range(n_exc)] if n_exc <= ALONE else [slice(0, n_exc)]


def plan_for(system: RowSystem, rows: FloatArray, support: list[int]) -> Plan:
    """The plan for these output rows and loaded coordinates, made once for all systems that share their rows."""
    key = (rows.shape, rows.tobytes(), tuple(support))
    if key not in system.plans:
        last = support[0] if support else None
        system.plans[key] = make_plan(system.sparse_rows, Rows.of(rows).maps, support, last)
    plan: Plan = system.plans[key]
    return plan


def _by_numpy(task: _Task) -> Sweep:
    imaginary = [task.kappa.damping, task.loads.imag, *(values.imag for _, values in task.kappa.sampled)]
    real = not any(part.any() for part in imaginary)
    by_law: Array = task.kappa.by_law
    if real:
        by_law = np.ascontiguousarray(by_law.real)
    return sweep(task.plan, by_law, _sparse_loads(task, by_law), task.n_exc)


def _by_loop(task: _Task) -> Sweep:
    from torsionnet.solve import compiled

    key = ("tape", task.rows.shape, task.rows.tobytes(), tuple(task.support), task.n_exc)
    plans = task.system.plans
    if key not in plans:
        plans[key] = make_tape(task.plan, task.support, task.n_exc)
    loads = np.ascontiguousarray(np.moveaxis(task.loads[:, task.support], 0, 2))
    return compiled.run(plans[key], task.kappa, loads, len(task.rows))


def _solved(task: _Task, run: Callable[[_Task], Sweep]) -> ComplexArray:
    """Motion (n_rows, n_exc, n_lanes)."""
    found = run(task)
    doubtful = np.asarray(~np.isfinite(found.motion).all(axis=(0, 1)))
    if found.doubtful is not None:
        doubtful |= found.doubtful
    if doubtful.any():
        found.motion = found.motion.astype(complex)
        found.motion[:, :, doubtful] = _again(task, doubtful)
    return found.motion


def _sparse_loads(task: _Task, like: Array) -> dict[int, Array]:
    values = task.loads if np.iscomplexobj(like) else task.loads.real
    return {j: np.ascontiguousarray(values[:, j].T) for j in task.support}


def _again(task: _Task, lanes: NDArray[np.bool_]) -> ComplexArray:
    """The few lanes with a pivot near zero.

    With a rounding error of damping in every law nothing is singular. On a tree that is all; where loops are, the tiny
    pivot has cost digits, which refinement gives back, or LAPACK where it does not.
    """
    system, plan = task.system, task.plan
    by_law = np.ascontiguousarray(task.kappa.by_law[:, lanes])
    nearby = by_law + 1j * EPS * np.abs(by_law)
    loads = task.loads if len(task.loads) == 1 else task.loads[lanes]
    if plan.is_tree:
        return sweep(plan, nearby, _sparse_loads(replace(task, loads=loads), by_law), task.n_exc).motion
    complete = plan_for(system, np.eye(system.n_coordinates), list(range(system.n_coordinates)))
    right = np.broadcast_to(np.moveaxis(loads, 0, 2), (*loads.shape[1:], by_law.shape[1]))
    motion = np.zeros(right.shape, dtype=complex)
    for _ in range(3):
        rest, size = _residual(system, by_law, motion, right)
        motion += sweep(complete, nearby, dict(enumerate(rest.copy())), task.n_exc).motion
    rest, size = _residual(system, by_law, motion, right)
    unsettled = ~(np.abs(rest) <= SETTLED * size).all(axis=(0, 1))
    result = np.tensordot(task.rows, motion, 1)
    if unsettled.any():
        some = loads if len(loads) == 1 else loads[unsettled]
        by_lapack = dense.solve(system, by_law[:, unsettled], some, task.rows)
        result[:, :, unsettled] = np.moveaxis(by_lapack, 0, 2)
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
