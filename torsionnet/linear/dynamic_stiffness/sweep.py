"""Elimination tape run in numpy, where every operation works on a vector of frequency points at once.

Responses by elimination on the graph, which is star-mesh reduction generalised to gears.

>>> import numpy as np
>>> from torsionnet.linear.assembly.law_stiffness import LawStiffness
>>> from torsionnet.linear.dynamic_stiffness.response_problem import Loading, ResponseProblem
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
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

import torsionnet.linear.dynamic_stiffness.tape as ops
from torsionnet.linear.assembly.law_stiffness import LawStiffness
from torsionnet.linear.dynamic_stiffness.response_problem import ResponseProblem
from torsionnet.linear.dynamic_stiffness.tape import MOST_LOST, Array, Tape

BLOCK_BYTES = 24 * 2**20
"""Memory in bytes of the registers that numpy works on at once, since more would leave the processor's cache."""
FEWEST_POINTS, MOST_POINTS = 1024, 4096
"""Fewest and most frequency points that numpy works on at once, as fewer cost more in the interpreter than in
arithmetic and more leave the cache."""


@dataclass
class Sweep:
    """Motions and reactions (n_read, n_exc, n_points) per unit excitation, and mask of uncertain points."""

    values: Array
    uncertain: NDArray[np.bool_]


def sweep(tape: Tape, kappa: LawStiffness) -> tuple[Array, NDArray[np.bool_]]:
    """Output values (n_values, n_points) of a tape by numpy, and mask (n_points,) of points that lost digits.

    Parameters
    ----------
    tape : Tape
    kappa : LawStiffness
        Of the slots of the plan.

    Returns
    -------
    (n_values, n_points) array, (n_points,) boolean array
        Values, and which points have lost digits.
    """
    # Without damping in any law all dynamic stiffnesses are real.
    kind = complex if kappa.damping.any() or any(values.imag.any() for _, values in kappa.sampled) else float
    values = np.zeros((tape.n_values, kappa.n_points), dtype=kind)
    uncertain = np.zeros(kappa.n_points, dtype=bool)
    walk = list(zip(*tape.operations.T.tolist(), tape.factors.tolist(), strict=True))
    start = 0
    for part in kappa.blocks(min(MOST_POINTS, max(FEWEST_POINTS, BLOCK_BYTES // (16 * (tape.n_registers + 1))))):
        here = slice(start, start + part.n_points)
        _walk(walk, part, np.empty((tape.n_registers + 1, part.n_points), dtype=kind), values[:, here], uncertain[here])
        start = here.stop
    return values, uncertain


def _walk(
    walk: list[tuple[int, int, int, int, int, float]],
    kappa: LawStiffness,
    registers: Array,
    values: Array,
    uncertain: NDArray[np.bool_],
) -> None:
    *r, spare = registers
    real_spare = spare.view(float)[: kappa.n_points]
    parts = registers.reshape(len(registers), len(kappa.stiffness), kappa.omega.shape[-1])
    real, imag = list(parts.real), list(parts.imag) if np.iscomplexobj(parts) else [None] * len(parts)
    size = [one.view(float)[: kappa.n_points] for one in r]
    for code, t, a, b, slots, factor in walk:
        if code == ops.PRODUCT:
            np.multiply(r[a], r[b], out=r[t])
        elif code == ops.SUM:
            term: Any = r[b] if factor == 1.0 else np.multiply(r[b], factor, out=spare)
            np.add(r[a], term, out=r[t])
        elif code == ops.TIMES:
            np.multiply(size[a], size[b], out=size[t])
        elif code in (ops.MORE, ops.LARGER):
            other: Any = size[b] if factor == 1.0 else np.multiply(size[b], factor, out=size[t])
            (np.add if code == ops.MORE else np.maximum)(size[a], other, out=size[t])
        elif code == ops.SIZE:
            np.abs(r[a], out=size[t])
        elif code == ops.RATIO:
            np.divide(size[a], size[b], out=size[t])
        elif code == ops.REST:
            np.abs(np.subtract(1.0, np.multiply(r[a], factor, out=spare), out=spare), out=size[t])
        elif code == ops.LAW:
            kappa.write(a, real[t], imag[t])
        elif code == ops.TERMS:
            np.abs(r[a], out=size[t])
            against = kappa.inertial(b)
            if against is not None:
                np.maximum(size[t], against, out=size[t])
        elif code == ops.PASSED:
            ratio = factor * kappa.ratio(*divmod(slots, kappa.n_laws))
            np.multiply(size[a], size[b], out=size[t])
            if not (isinstance(ratio, float) and ratio == 1.0):
                np.multiply(size[t], ratio, out=size[t])
        elif code == ops.OPEN:
            np.abs(
                np.subtract(1.0, np.multiply(r[a], factor, out=spare) if factor != 1.0 else r[a], out=spare),
                out=size[t],
            )
            law, beside = divmod(slots, kappa.n_laws)
            against = kappa.inertial(law)
            if against is not None:
                np.maximum(size[t], np.abs(r[a]) * against / np.abs(kappa.of(beside)), out=size[t])
        elif code == ops.QUOTIENT:
            np.divide(r[a], r[b], out=r[t])
        elif code == ops.INVERSE:
            np.divide(1.0, r[a], out=r[t])
        elif code == ops.MARK:
            uncertain |= ~(np.multiply(size[a], factor / MOST_LOST, out=real_spare) <= size[b])
        elif code in (ops.CONSTANT, ops.LEVEL):
            (r if code == ops.CONSTANT else size)[t].fill(factor)
        else:
            np.multiply(r[a], factor, out=values[t])


Walk: TypeAlias = Callable[[Tape, LawStiffness], tuple[Array, NDArray[np.bool_]]]


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


def respond(problem: ResponseProblem, kappa: LawStiffness) -> Sweep:
    """Motions (rad) and reactions (N m) per unit excitation, (n_read, n_exc, n_points), from ``kappa`` of all laws.

    Large problems take the compiled loop where it works. Only their size decides, so that a result does not depend on
    what was calculated before.
    """
    if chosen_method(problem, kappa.n_points, "auto") == "compiled":
        with contextlib.suppress(Exception):
            return respond_compiled(problem, kappa)
    return eliminate(problem, kappa)


def respond_compiled(problem: ResponseProblem, kappa: LawStiffness) -> Sweep:
    """Motions (rad) and reactions (N m) per unit excitation by the compiled loop, (n_read, n_exc, n_points).

    Raises
    ------
    MissingExtraError
        numba is not installed.
    """
    import torsionnet.linear.dynamic_stiffness.compiled as compiled

    return eliminate(problem, kappa, compiled.sweep)


def eliminate(problem: ResponseProblem, kappa: LawStiffness, walk: Walk = sweep) -> Sweep:
    """Motions (rad) and reactions (N m) per unit excitation, (n_read, n_exc, n_points), by tapes run in numpy.

    Another ``walk`` runs them in another way.
    """
    values = np.zeros((problem.n_read, len(problem.excitations), kappa.n_points), dtype=complex)
    uncertain = np.zeros(kappa.n_points, dtype=bool)
    with np.errstate(all="ignore"):
        for excitations, part in problem.parts:
            found, lost = walk(part.tape, kappa.law_sums(part.plan.sources))
            values[:, excitations] = found.reshape(problem.n_read, len(excitations), kappa.n_points)
            uncertain |= lost | part.plan.subtracts
    return Sweep(values, uncertain | ~np.isfinite(values).all(axis=(0, 1)))
