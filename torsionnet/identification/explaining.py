"""Which one freedom more would explain what a fit leaves, and what its values would be then."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.identification.causes import Cause, causes_of, with_causes
from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.lack_of_fit import Explanation, misfits
from torsionnet.identification.search import LeastSquaresSolution
from torsionnet.identification.trying_causes import Solve, Tried, explaining, squares, tried_causes
from torsionnet.response.recording import Recording
from torsionnet.signals.resolution import ENOUGH, resolution

TRIED = 6
"""Causes that are fitted, those first that would take away most by a linear estimate."""
SEEN = 1e-6
"""Part of what a cause does to the data that the parameters cannot do."""

Errors = Callable[[FitProblem, LeastSquaresSolution], Mapping[str, float]]
"""Standard errors at an optimum, by name."""


def explanations(problem: FitProblem, values: FloatArray, solve: Solve, errors: Errors) -> tuple[Explanation, ...]:
    """The best of them first, and others that do about as well; empty if none takes away most of the misfit."""
    whole = squares(problem, values)
    starts = [values, problem.start]  # a wrong model may have led far off
    first = list(dict.fromkeys(cause for start in starts for cause in _promising(problem, start)))
    tried = tried_causes(problem, first, starts, solve)
    good = explaining(tried, whole)
    if not good:  # by a linear estimate they are not what they are
        others = [cause for cause in causes_of(problem) if cause not in first]
        good = explaining(tried_causes(problem, others, [values], solve), whole)
    found = [_explained(one, one.squares / whole, solve, errors) for one in good]
    return tuple(one for one in found if one.complete or not found[0].complete)


def _promising(problem: FitProblem, values: FloatArray) -> list[Cause]:
    """Causes by what a linear step would take away, those that do nothing left out."""
    causes = list(causes_of(problem))
    wide = with_causes(problem, causes, values, instead=False)
    residuals, slopes = _where_each_stands(wide, problem.names)
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


def _where_each_stands(wide: FitProblem, names: tuple[str, ...]) -> tuple[FloatArray, FloatArray]:
    """Residuals and derivatives where every block has what its own configuration says of all but these names."""
    parts, slopes = [], []
    for block, place in zip(wide.blocks, wide.places, strict=True):
        own = dict(zip(block.response.names, block.response.start.tolist(), strict=True))
        at = wide.start[place]
        for number, index in enumerate(place):
            if wide.names[index] not in names:
                at[number] = own.get(wide.names[index], at[number])
        residual, jacobian = block.residuals(at)
        whole = np.zeros((len(residual), len(wide.names)))
        np.add.at(whole.T, place, jacobian.T)
        parts.append(residual)
        slopes.append(whole)
    return np.concatenate(parts), np.concatenate(slopes)


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
