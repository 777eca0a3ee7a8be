"""Which one freedom more would explain what a fit leaves, and what its values would be then."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.errors import TorsionnetError
from torsionnet.identification.causes import Cause, causes_of, with_causes
from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.lack_of_fit import Explanation, misfits
from torsionnet.identification.search import LeastSquaresSolution
from torsionnet.response.recording import Recording
from torsionnet.signals.resolution import ENOUGH, resolution

TRIED = 6
"""Causes that are fitted, those first that would take away most by a linear estimate."""
MOST = 0.8
"""Share of the misfit, as a sum of squares, that a cause must take away to be named."""
FACTORS = (1.0, 0.5, 2.0)
"""Multiples of a value from which the search for it begins, as a resonance may lie in the way; of records only once."""
SEEN = 1e-6
"""Part of what a cause does to the data that the parameters cannot do."""
ALIKE = 1.5
"""Sums of squares that are left, of causes that explain a misfit about as well."""

Solve = Callable[[FitProblem, FloatArray], LeastSquaresSolution]
"""A local optimum from a start."""
Errors = Callable[[FitProblem, LeastSquaresSolution], Mapping[str, float]]
"""Standard errors at an optimum, by name."""


def explanations(problem: FitProblem, values: FloatArray, solve: Solve, errors: Errors) -> tuple[Explanation, ...]:
    """The best of them first, and others that do about as well; empty if none takes away most of the misfit."""
    whole = squares(problem, values)
    tried = [
        tried_with(problem, cause, start, solve, factor)
        for start in (values, problem.start)  # a wrong model may have led far off
        for cause in _promising(problem, start)
        for factor in (FACTORS if cause.is_value and not problem.has_records else FACTORS[:1])
    ]
    best: dict[Cause, Tried] = {}
    for one in sorted((one for one in tried if one is not None), key=lambda one: one.criterion):
        best.setdefault(one.cause, one)
    listed = list(best.values())
    good = [one for one in listed if one.squares < min((1 - MOST) * whole, ALIKE * listed[0].squares)]
    found = [_explained(one, one.squares / whole, solve, errors) for one in good]
    return tuple(one for one in found if one.complete or not found[0].complete)


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


def tried_with(problem: FitProblem, cause: Cause, start: FloatArray, solve: Solve, factor: float = 1.0) -> Tried | None:
    """The fit with a cause from a start, the cause from a multiple of its own; None where that cannot be calculated."""
    try:
        with_it = with_causes(problem, [cause], start, instead=True)
        begin = with_it.start.copy()
        begin[[name.partition("[")[0] == cause.unknown for name in with_it.names]] *= factor
        found = solve(with_it, begin).x
        return Tried(cause, with_it, found, squares(with_it, found))
    except (TorsionnetError, np.linalg.LinAlgError):
        return None  # what cannot be calculated explains nothing


def squares(problem: FitProblem, values: FloatArray) -> float:
    """Sum of the squared weighted residuals."""
    return float(np.sum(problem.residuals(values) ** 2))


def _promising(problem: FitProblem, values: FloatArray) -> list[Cause]:
    """Causes by what a linear step would take away, those that do nothing left out."""
    causes = list(causes_of(problem))
    wide = with_causes(problem, causes, values, instead=False)
    residuals, slopes = wide.both(wide.start)
    own = [wide.names.index(name) for name in problem.names]
    basis, _ = np.linalg.qr(_scaled(slopes[:, own]))
    gains = []
    for cause in causes:
        columns = [index for index, name in enumerate(wide.names) if name.partition("[")[0] == cause.unknown]
        more = _scaled(slopes[:, columns])
        rest = more - basis @ (basis.T @ more)
        seen = np.linalg.norm(rest, axis=0) > SEEN
        fresh, _ = np.linalg.qr(rest[:, seen])
        gains.append(float(np.sum((fresh.T @ residuals) ** 2)))
    order = np.argsort(gains)[::-1][:TRIED]
    return [causes[place] for place in order if gains[place] > 0]


def _scaled(columns: FloatArray) -> FloatArray:
    return np.asarray(columns / np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny))


def _explained(one: Tried, left: float, solve: Solve, errors: Errors) -> Explanation:
    cause, tried = one.cause, one.problem
    tried.learn_noise(one.values)
    found = solve(tried, one.values)
    at = found.x
    outputs = dict.fromkeys(block.measurement.output for block in tried.blocks)
    before = tried.start[tried.names.index(cause.unknown)] if cause.is_value else None
    return Explanation(
        kind=cause.kind,
        of=" and ".join(outputs) if cause.is_of_channel else cause.unknown if cause.is_value else cause.element,
        unknown=cause.unknown,
        values=dict(zip(tried.names, at.tolist(), strict=True)),
        standard_errors=errors(tried, found),
        before=None if before is None else float(before),
        complete=not any(one.rejected for one in misfits(tried, at)),
        left=left,
    )


def too_coarse(problem: FitProblem) -> tuple[str, ...]:
    """Records that are compared beyond where the steps of their sensor are small against its motion."""
    found = []
    for block in problem.blocks:
        one = block.measurement
        if isinstance(one.data, Recording):
            steps = resolution(one.data, one.output, one.input)
            if steps is not None and steps.enough_up_to < block.frequencies[-1]:
                limit = f"{steps.enough_up_to:.3g} Hz"
                found.append(
                    f"{one.output} moves by less than {ENOUGH:g} of its steps above {limit}: end the band there"
                )
    return tuple(dict.fromkeys(found))
