"""What a fit leaves with one freedom more, and which of several freedoms explain a misfit: one rule for all who ask."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.errors import TorsionnetError
from torsionnet.identification.causes import Cause, with_causes
from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.search import RANGE, LeastSquaresSolution
from torsionnet.identification.verdict_words import relative_misfits

MOST = 0.8
"""Share of the misfit, as a sum of squares, that a cause must take away to be named."""
FACTORS, SIGNS = (1.0, 0.5, 2.0), (1.0, -1.0)
"""Multiples from which the search for a value begins, as a resonance may lie in the way (of records only once), and for
a gain, as a channel may be reversed."""
ALIKE = 1.5
"""Sums of squares that are left, of causes that explain a misfit about as well."""
ENDED = 1e-3
"""A value that comes as near to the end of its range, as a factor, has run there."""

Solve = Callable[[FitProblem, FloatArray], LeastSquaresSolution]
"""A local optimum from a start."""


@dataclass(frozen=True, eq=False)
class Tried:
    """A cause, the problem with it, and the optimum of that."""

    cause: Cause
    problem: FitProblem
    values: FloatArray
    squares: float

    @property
    def criterion(self) -> float:
        """Akaike's, in units of noise: of two that leave as much, the one with fewer unknowns comes first."""
        return self.squares + 2 * len(self.values)

    @property
    def misfit(self) -> float:
        """RMS of model minus test over that of the test, of all measurements."""
        return overall_misfit(self.problem, self.values)

    @property
    def ended(self) -> bool:
        """Whether the value ran to zero or without end, which explains nothing."""
        mine = [name.partition("[")[0] == self.cause.unknown for name in self.problem.names]
        begin, value = float(np.mean(self.problem.start[mine])), float(np.mean(self.values[mine]))
        return begin > 0 and not ENDED * RANGE > abs(value / begin) > 1 / (ENDED * RANGE)


def squares(problem: FitProblem, values: FloatArray) -> float:
    """Sum of the squared weighted residuals."""
    return float(np.sum(problem.residuals(values) ** 2))


def overall_misfit(problem: FitProblem, values: FloatArray) -> float:
    """RMS of model minus test over that of the test, of all measurements."""
    return float(np.sqrt(np.mean(relative_misfits(problem, values) ** 2)))


def tried_causes(
    problem: FitProblem, causes: Sequence[Cause], starts: Sequence[FloatArray], solve: Solve
) -> list[Tried]:
    """The best fit with each of the causes, from all starts, the best of them first."""
    best: dict[Cause, Tried] = {}
    found = [
        _tried(problem, cause, start, solve, factor)
        for start in starts
        for cause in causes
        for factor in _factors(problem, cause)
    ]
    for one in sorted((one for one in found if one is not None), key=lambda one: one.criterion):
        best.setdefault(one.cause, one)
    return list(best.values())


def _factors(problem: FitProblem, cause: Cause) -> tuple[float, ...]:
    if cause.kind == "gain" and any(block.form != "magnitude" for block in problem.blocks):
        return SIGNS
    return FACTORS if cause.is_value and not problem.has_records else FACTORS[:1]


def _tried(problem: FitProblem, cause: Cause, start: FloatArray, solve: Solve, factor: float) -> Tried | None:
    """The fit with a cause from a start, the cause from a multiple of its own; None where that cannot be calculated."""
    try:
        with_it = with_causes(problem, [cause], start, instead=True)
        begin = with_it.start.copy()
        begin[[name.partition("[")[0] == cause.unknown for name in with_it.names]] *= factor
        found = solve(with_it, begin).x
        return Tried(cause, with_it, found, squares(with_it, found))
    except (TorsionnetError, np.linalg.LinAlgError):
        return None  # what cannot be calculated explains nothing


def explaining(tried: Sequence[Tried], whole: float) -> list[Tried]:
    """Those of the causes tried that take away most of a misfit and leave about as little as the best of them.

    Parameters
    ----------
    tried : sequence of Tried
        The best first.
    whole : float
        Sum of squares without any of them.
    """
    sound = [one for one in tried if not one.ended and one.squares <= (1 - MOST) * whole]
    if not sound:
        return []
    least, rounding = sound[0], np.finfo(float).eps * whole
    noise = _noise(least.problem)

    def as_good(one: Tried) -> bool:
        alike = one.squares <= ALIKE * least.squares and one.misfit <= np.sqrt(ALIKE) * least.misfit
        return one is least or alike or one.squares <= max(noise, rounding)

    return [one for one in sound if as_good(one)]


def _noise(problem: FitProblem) -> float:
    """Sum of squares that errors make which are stated; 0 where none are."""
    stated = all(block.measurement.error is not None for block in problem.blocks)
    return problem.effective_count if stated else 0.0
