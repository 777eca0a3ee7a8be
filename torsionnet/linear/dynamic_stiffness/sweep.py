"""Elimination tape run in numpy, where every operation works on a vector of frequency points at once.

Responses by elimination on the graph, which is star-mesh reduction generalised to gears.

>>> import numpy as np
>>> from torsionnet.linear.assembly.law_stiffness import LawStiffness
>>> from torsionnet.linear.dynamic_stiffness.response_problem import Loading, ResponseProblem
>>> rows = [{0: 1.0}, {1: 1.0}, {0: 1.0, 1: -1.0}]
>>> free = ResponseProblem(rows, 2, (Loading(load={0: 1.0}),), ({1: 1.0}, {0: 1.0, 1: -1.0}))
>>> J, c, k = (np.array([values]) for values in ([1.0, 3.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1e9]))
>>> motion = respond(free, LawStiffness(J, c, k, omega=np.array([1e-3])))
>>> [f"{value.real:.12g}" for value in motion[:, 0, 0]]
['-250000', '7.5e-10']
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np

import torsionnet.linear.dynamic_stiffness.tape as ops
from torsionnet.linear.assembly.law_stiffness import LawStiffness
from torsionnet.linear.assembly.rows import ComplexArray
from torsionnet.linear.dynamic_stiffness.response_problem import ResponseProblem
from torsionnet.linear.dynamic_stiffness.tape import Array, Tape

BLOCK_BYTES = 16 * 2**20
"""Memory in bytes of the registers that numpy works on at once, since more would leave the processor's cache."""
FEWEST_POINTS, MOST_POINTS = 1024, 16384
"""Fewest and most frequency points that numpy works on at once, as fewer cost more in the interpreter than in
arithmetic and more leave the cache."""


def sweep(tape: Tape, kappa: LawStiffness) -> Array:
    """Output values (n_values, n_points) of a tape by numpy, from the stiffness ``kappa`` of the slots of its plan."""
    # Without damping in any law all dynamic stiffnesses are real.
    is_damped = kappa.damping.any() or any(values.imag.any() for _, values in kappa.sampled)
    kind = np.result_type(kappa.stiffness.dtype, np.complex64 if is_damped else np.float32)
    values = np.zeros((tape.n_values, kappa.n_points), dtype=kind)
    start = 0
    for part in kappa.blocks(
        min(MOST_POINTS, max(FEWEST_POINTS, BLOCK_BYTES // (kind.itemsize * (tape.n_registers + 1))))
    ):
        here = slice(start, start + part.n_points)
        _walk(tape.steps, part, np.empty((tape.n_registers + 1, part.n_points), dtype=kind), values[:, here])
        start = here.stop
    return values


def _walk(walk: list[tuple[int, int, int, int, float]], kappa: LawStiffness, registers: Array, values: Array) -> None:
    *r, spare = registers
    parts = registers.reshape(len(registers), len(kappa.stiffness), kappa.omega.shape[-1])
    real, imag = list(parts.real), list(parts.imag) if np.iscomplexobj(parts) else [None] * len(parts)
    for code, t, a, b, factor in walk:
        if code == ops.PRODUCT:
            np.multiply(r[a], r[b], out=r[t])
        elif code == ops.SUM:
            term: Any = r[b] if factor == 1.0 else np.multiply(r[b], factor, out=spare)
            np.add(r[a], term, out=r[t])
        elif code == ops.LAW:
            kappa.write(a, real[t], imag[t])
        elif code == ops.QUOTIENT:
            np.divide(r[a], r[b], out=r[t])
        elif code == ops.INVERSE:
            np.divide(1.0, r[a], out=r[t])
        elif code == ops.CONSTANT:
            r[t].fill(factor)
        else:
            np.multiply(r[a], factor, out=values[t])


Walk: TypeAlias = Callable[[Tape, LawStiffness], Array]


COMPILED_WORK = 1e9
"""Tape operations times frequency points above which the compiled loop saves more than the second or two that starting
it takes."""


def chosen_method(problem: ResponseProblem, n_points: int, method: str) -> str:
    """Name of the solver to use, for ``auto`` the compiled loop for many points wherever numba works, else numpy."""
    if method != "auto":
        return method
    is_large = n_points * sum(len(part.tape) for _, part in problem.parts) >= COMPILED_WORK
    return "compiled" if is_large and compiled_works() else "graph"


def compiled_works() -> bool:
    """Whether the compiled loop can be used, that is whether numba is installed and works with this numpy.

    numpy can do the same.
    """
    with contextlib.suppress(Exception):
        import torsionnet.linear.dynamic_stiffness.compiled  # noqa: F401

        return True
    return False


def respond(problem: ResponseProblem, kappa: LawStiffness) -> ComplexArray:
    """Motions (rad) and reactions (N m) per unit excitation, (n_read, n_exc, n_points), from ``kappa`` of all laws.

    Large problems take the compiled loop where it works. Only their size decides, so that a result does not depend on
    what was calculated before.
    """
    if chosen_method(problem, kappa.n_points, "auto") == "compiled":
        with contextlib.suppress(Exception):
            return respond_compiled(problem, kappa)
    return eliminate(problem, kappa)


def respond_compiled(problem: ResponseProblem, kappa: LawStiffness) -> ComplexArray:
    """Motions (rad) and reactions (N m) per unit excitation by the compiled loop, (n_read, n_exc, n_points).

    Raises
    ------
    MissingExtraError
        numba is not installed.
    """
    import torsionnet.linear.dynamic_stiffness.compiled as compiled

    return eliminate(problem, kappa, compiled.sweep)


def eliminate(problem: ResponseProblem, kappa: LawStiffness, walk: Walk = sweep) -> ComplexArray:
    """Motions (rad) and reactions (N m) per unit excitation, (n_read, n_exc, n_points), by tapes run in numpy.

    Another ``walk`` runs them in another way.
    """
    values = np.zeros((problem.n_read, len(problem.excitations), kappa.n_points), dtype=complex)
    with np.errstate(all="ignore"):
        for excitations, part in problem.parts:
            solved = walk(part.tape, kappa.law_sums(len(part.plan.sources), part.plan.law_terms))
            values[:, excitations] = solved.reshape(problem.n_read, len(excitations), kappa.n_points)
    return values
