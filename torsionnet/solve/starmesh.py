"""Readings by elimination on the graph: see :mod:`torsionnet.solve.graph_plan` for the equations.

>>> import numpy as np
>>> from torsionnet.assembly.law_stiffness import LawStiffness
>>> from torsionnet.solve.problem import Excitation, Problem
>>> rows = [{0: 1.0}, {1: 1.0}, {0: 1.0, 1: -1.0}]
>>> free = Problem(rows, 2, (Excitation(load={0: 1.0}),), ({1: 1.0}, {0: 1.0, 1: -1.0}))
>>> J, c, k = (np.array([values]) for values in ([1.0, 3.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1e9]))
>>> motion = respond(free, LawStiffness(J, c, k, omega=np.array([1e-3]))).values
>>> [f"{value.real:.12g}" for value in motion[:, 0, 0]]
['-250000', '7.5e-10']
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from torsionnet.assembly.law_stiffness import LawStiffness
from torsionnet.solve.doubt import Array, lossy
from torsionnet.solve.problem import Problem
from torsionnet.solve.sweep import Sweep, sweep

BLOCK_BYTES = 3 * 2**20
"""Stiffness of all laws at the frequencies solved at once."""
SMALLEST_BLOCK = 512
"""Lanes; with fewer the interpreter takes longer than the arithmetic."""
COMPILED_BLOCK = 2**16
"""Lanes for the compiled loop, which divides them itself; this bounds the memory of the answer."""


def respond(problem: Problem, kappa: LawStiffness) -> Sweep:
    """Outputs and reactions of a problem for dynamic stiffnesses of its laws in n_lanes lanes."""
    by_law: Array = kappa.by_law
    if not (kappa.damping.any() or any(values.imag.any() for _, values in kappa.sampled)):
        by_law = np.ascontiguousarray(by_law.real)
    without_doubt = bool(lossy(kappa).all())
    return _respond(problem, kappa.n_lanes, lambda part: sweep(part.plan, by_law, lossy=without_doubt))


def respond_compiled(problem: Problem, kappa: LawStiffness) -> Sweep:
    """The same in a compiled loop.

    Raises
    ------
    MissingExtraError
        numba is not installed.
    """
    from torsionnet.solve import compiled

    return _respond(problem, kappa.n_lanes, lambda part: compiled.run(part.tape, kappa, part.n_read))


def _respond(problem: Problem, n_lanes: int, run: Callable[[Problem], Sweep]) -> Sweep:
    values = np.zeros((problem.n_read, len(problem.excitations), n_lanes), dtype=complex)
    doubtful = np.zeros(n_lanes, dtype=bool)
    with np.errstate(all="ignore"):
        parts = problem.parts
        for number, part in enumerate(parts):
            found = run(part)
            values[:, slice(None) if len(parts) == 1 else slice(number, number + 1)] = found.values
            doubtful |= found.doubtful
    return Sweep(values, doubtful | ~np.isfinite(values).all(axis=(0, 1)))


def block_size(n_laws: int, method: str = "graph") -> int:
    """Lanes to solve at once."""
    if method == "compiled":
        return COMPILED_BLOCK
    return max(SMALLEST_BLOCK, BLOCK_BYTES // (16 * max(1, n_laws)))
