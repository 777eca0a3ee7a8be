"""Integer and float arrays that say how every reading is formed, as the compiled loop runs through them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.dynamic_stiffness.reading_problem import ReadingPart, ReadingProblem


@dataclass(frozen=True, eq=False)
class ReadingTable:
    """Arrays that tell the compiled loop how to form every reading, and the size of a measured one, from the solution.

    Attributes
    ----------
    whole : (n, 3) array
        Of each reading, then of each term of the measured one: the number of what is solved, the power of s or -1, the
        place in ``laws`` or -1.
    factors : (n,) array
    laws : tuple of int
        Numbers of the laws that are read.
    applied : float
        Size of the torques applied in the measured reading.
    n_out, n_excitations : int
    is_measured : bool
        Whether the reading after the outputs is one to divide by; there is one excitation then.
    """

    whole: NDArray[np.int64]
    factors: FloatArray
    laws: tuple[int, ...]
    applied: float
    n_out: int
    n_excitations: int
    is_measured: bool


def reading_table(reading_problem: ReadingProblem, n_out: int, n_excitations: int) -> ReadingTable | None:
    """Arrays for the compiled loop to form readings by, or None for several measured inputs or with controllers.

    They are for excitations that are solved together.
    """
    n_measured = len(reading_problem.parts) - n_out
    if reading_problem.sensed or n_measured > 1:
        return None
    parts = [*reading_problem.parts, *(reading_problem.terms[-1] if n_measured else ())]
    laws = tuple(dict.fromkeys(one.term.law for one in parts if one.term is not None and one.term.law is not None))
    return ReadingTable(
        np.array([_entry(one, laws) for one in parts], dtype=np.int64).reshape(-1, 3),
        np.array([float(one.factor if one.term is None else one.term.factor) for one in parts]),
        laws,
        float(np.abs(reading_problem.applied[-1]).sum()) if n_measured else 0.0,
        n_out,
        n_excitations,
        is_measured=bool(n_measured),
    )


def _entry(part: ReadingPart, laws: tuple[int, ...]) -> tuple[int, int, int]:
    if part.term is None:
        return part.solved, -1, -1
    if part.term.law is not None:
        return part.solved, -1, laws.index(part.term.law)
    return part.solved, part.term.power, -1
