"""Explanations of a misfit, each one additional unknown with which the model would fit, and the values it then has."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from torsionnet.identification.cause_fits import (
    CauseFit,
    Solve,
    explaining_fits,
    fit_causes,
    starts_of_causes,
    sum_of_squares,
    under_own_noise,
)
from torsionnet.identification.causes import BETWEEN, Cause, possible_causes, with_causes
from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.fit_search import LeastSquaresSolution
from torsionnet.identification.lack_of_fit import Explanation, misfits
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.signals.recording import Recording
from torsionnet.signals.sensor_resolution import ENOUGH_STEPS, resolution

CAUSES_FITTED_FIRST = 6
"""Number of causes of a misfit that are fitted first, those that would reduce it most by a linear estimate, to save
time."""
LEAST_INDEPENDENT_EFFECT = 1e-6
"""Share of a cause's effect on the residuals that the parameters must be unable to reproduce, as less is rounding; a
cause below it is ignored."""

Errors = Callable[[FitProblem, LeastSquaresSolution], Mapping[str, float]]
"""Function that returns the standard errors (SI) at an optimum of a fit problem by name of the unknown."""


def explanations(problem: FitProblem, values: FloatArray, solve: Solve, errors: Errors) -> tuple[Explanation, ...]:
    """Explanations of the misfit of a fit, the best first, with others about as good; empty if none removes most."""
    whole = sum_of_squares(problem, values)
    starts = starts_of_causes(problem, values)
    # No linear step shows a reference angle, which is found from afar, nor a course between samples, which jumps.
    turned = [cause for cause in possible_causes(problem) if cause.kind in ("reference_angle", BETWEEN)]
    first = list(dict.fromkeys([*turned, *(cause for start in starts for cause in _promising(problem, start))]))
    tried = fit_causes(problem, first, starts, solve, whole)
    good = explaining_fits(tried, whole)
    if not good:  # the linear estimate may have picked the wrong causes
        others = [cause for cause in possible_causes(problem) if cause not in first]
        good = explaining_fits(fit_causes(problem, others, starts, solve, whole), whole)
    found = [_explained(one, one.sum_of_squares / whole, solve, errors) for one in good]
    return tuple(one for one in found if one.complete or not found[0].complete)


def _promising(problem: FitProblem, values: FloatArray) -> list[Cause]:
    """Causes of a misfit that a linear step predicts to reduce it most, the best first."""
    causes = [cause for cause in possible_causes(problem) if cause.kind != BETWEEN]
    wide = with_causes(problem, causes, values, instead=False)
    residuals, slopes = _residuals_by_configuration(wide, problem.names)
    own = [wide.names.index(name) for name in problem.names]
    basis, _ = np.linalg.qr(_scaled(slopes[:, own]))
    gains = []
    for cause in causes:
        columns = [index for index, name in enumerate(wide.names) if name.partition("[")[0] == cause.unknown]
        more = _scaled(slopes[:, columns])
        rest = more - basis @ (basis.T @ more)
        seen = np.linalg.norm(rest, axis=0) > LEAST_INDEPENDENT_EFFECT
        fresh, _ = np.linalg.qr(rest[:, seen])
        gains.append(float(np.sum((fresh.T @ residuals) ** 2)))
    order = np.argsort(gains)[::-1][:CAUSES_FITTED_FIRST]
    return [causes[place] for place in order if gains[place] > 0]


def _residuals_by_configuration(wide: FitProblem, names: tuple[str, ...]) -> tuple[FloatArray, FloatArray]:
    """Residuals and derivatives where unknowns other than ``names`` have the values of each test's configuration."""
    parts, slopes = [], []
    for block, place in zip(wide.blocks, wide.unknown_indices, strict=True):
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


def _explained(one: CauseFit, left: float, solve: Solve, errors: Errors) -> Explanation:
    cause, tried = one.cause, one.problem
    found = under_own_noise(one, solve)
    at = found.x
    before = tried.start[tried.names.index(cause.unknown)] if cause.is_value else None
    return Explanation(
        kind=cause.kind,
        of=cause.place(tried),
        unknown=cause.unknown,
        values=dict(zip(tried.names, at.tolist(), strict=True)),
        standard_errors=errors(tried, found),
        before=None if before is None else float(before),
        complete=not any(one.rejected for one in misfits(tried, at)),
        left=left,
        between=cause.between,
    )


def coarse_sensor_remarks(problem: FitProblem) -> tuple[str, ...]:
    """Remarks on records compared at frequencies where the sensor moves by few of its steps, one sentence each."""
    found = []
    for block in problem.blocks:
        one = block.measurement
        if isinstance(one.data, Recording):
            steps = resolution(one.data, one.output, one.input)
            if steps is not None and steps.enough_up_to < block.frequencies[-1]:
                limit = f"{steps.enough_up_to:.3g} Hz"
                found.append(
                    f"{one.output} moves by less than {ENOUGH_STEPS:g} of its steps above {limit}: end the band there"
                )
    return tuple(dict.fromkeys(found))
