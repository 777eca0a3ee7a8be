"""Responses by elimination on the graph, which is star-mesh reduction generalised to gears.

The equations are in :mod:`torsionnet.solve.dynamic_stiffness.graph_plan`.

>>> import numpy as np
>>> from torsionnet.assembly.law_stiffness import LawStiffness
>>> from torsionnet.solve.dynamic_stiffness.response_problem import Loading, ResponseProblem
>>> rows = [{0: 1.0}, {1: 1.0}, {0: 1.0, 1: -1.0}]
>>> free = ResponseProblem(rows, 2, (Loading(load={0: 1.0}),), ({1: 1.0}, {0: 1.0, 1: -1.0}))
>>> J, c, k = (np.array([values]) for values in ([1.0, 3.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1e9]))
>>> motion = respond(free, LawStiffness(J, c, k, omega=np.array([1e-3]))).values
>>> [f"{value.real:.12g}" for value in motion[:, 0, 0]]
['-250000', '7.5e-10']
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.law_stiffness import LawStiffness
from torsionnet.solve.dynamic_stiffness.lost_digits import Array
from torsionnet.solve.dynamic_stiffness.response_problem import ResponseProblem
from torsionnet.solve.dynamic_stiffness.sweep import Sweep, sweep
from torsionnet.solve.dynamic_stiffness.tape import Tape

Walk: TypeAlias = Callable[[Tape, LawStiffness], tuple[Array, NDArray[np.bool_]]]


COMPILED_WORK = 1e9
"""Tape operations times frequency points above which the compiled loop saves more than the second or two that starting
it takes."""


def chosen_method(problem: ResponseProblem, n_points: int, method: str) -> str:
    """Name of the solver to use, for ``auto`` the compiled loop for many points wherever numba works, else numpy."""
    if method != "auto" or n_points * sum(len(part.tape) for _, part in problem.parts) < COMPILED_WORK:
        return method
    return "compiled" if compiled_works() else "graph"


def compiled_works() -> bool:
    """Whether the compiled loop can be used, that is whether numba is installed and works with this numpy.

    numpy can do the same.
    """
    with contextlib.suppress(Exception):
        import torsionnet.solve.dynamic_stiffness.compiled  # noqa: F401

        return True
    return False


def respond(problem: ResponseProblem, kappa: LawStiffness) -> Sweep:
    """Motions (rad) and reactions (N m) per unit excitation, (n_read, n_exc, n_points), from ``kappa`` of all laws.

    Large problems take the compiled loop where it works. Only their size decides, so that a result does not depend on
    what was calculated before.
    """
    if chosen_method(problem, kappa.n_points, "auto") == "compiled":
        with contextlib.suppress(Exception):
            return respond_compiled(problem, kappa)
    return respond_in_numpy(problem, kappa)


def respond_in_numpy(problem: ResponseProblem, kappa: LawStiffness) -> Sweep:
    """Motions (rad) and reactions (N m) per unit excitation by numpy, shape (n_read, n_exc, n_points)."""
    return _respond(problem, kappa, sweep)


def respond_compiled(problem: ResponseProblem, kappa: LawStiffness) -> Sweep:
    """Motions (rad) and reactions (N m) per unit excitation by the compiled loop, (n_read, n_exc, n_points).

    Raises
    ------
    MissingExtraError
        numba is not installed.
    """
    import torsionnet.solve.dynamic_stiffness.compiled as compiled

    return _respond(problem, kappa, compiled.sweep)


def _respond(problem: ResponseProblem, kappa: LawStiffness, walk: Walk) -> Sweep:
    values = np.zeros((problem.n_read, len(problem.excitations), kappa.n_points), dtype=complex)
    uncertain = np.zeros(kappa.n_points, dtype=bool)
    with np.errstate(all="ignore"):
        for excitations, part in problem.parts:
            found, lost = walk(part.tape, kappa.law_sums(part.plan.sources))
            values[:, excitations] = found.reshape(problem.n_read, len(excitations), kappa.n_points)
            uncertain |= lost | part.plan.subtracts
    return Sweep(values, uncertain | ~np.isfinite(values).all(axis=(0, 1)))
