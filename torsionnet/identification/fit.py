"""The result of a fit: values, how certain they are, and what that means in words."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.drivetrain import Drivetrain
from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.fit_result import Compared, FitResult
from torsionnet.identification.lack_of_fit import LackOfFit
from torsionnet.identification.lack_words import lacking
from torsionnet.identification.natures import Nature, nature
from torsionnet.identification.noise_bias import noise_bias
from torsionnet.identification.profile import profile_interval
from torsionnet.identification.saving import dump_fit, read_fit
from torsionnet.identification.search import LeastSquaresSolution, cannot_be_negative, variance
from torsionnet.identification.verdict_words import verdicts
from torsionnet.identification.widening import far_off
from torsionnet.response.recording import Recording

SINGULAR = 1e-9
EXTRA_UNITS = {"delay": "s", "gain": ""}
HEAVY = 1e12
"""Variance of what is not determined at all, over that of what is."""


FAR = 1e3
"""Factor from the start."""
UNSEEN = 0.1
"""Standard deviations of all residuals together by which the data change on the rest of the way."""
ENDLESS = {
    "stiffness": "the data do not show that it gives way; make it rigid",
    "inertia": "the data do not show that it moves; lock its node",
    "damping": "the data do not show that it slips; make it rigid",
}


@dataclass(frozen=True, eq=False)
class Fit(FitResult):
    """Parameters found from measurements.

    Attributes
    ----------
    values, standard_errors : mapping of str to float
        SI; an infinite standard error says that the data do not determine the value, or that the model does not fit.
    correlation : (n, n) array
        In the order of ``values``.
    chi_squared : float
        Sum of the squared weighted residuals, priors included.
    degrees_of_freedom : int
        Independent values that the residuals are worth, less the parameters.
    comparisons : tuple of Compared
    verdicts : tuple of str
        Which values can be trusted, in words.
    notes : tuple of str
    steps : mapping of str to tuple of tuples of float
        By how much the steps of a sensor move a value from each place that it may rest at, for each test that has
        them, SI. The errors contain it.
    lack_of_fit : LackOfFit, optional
        What the residuals hold beyond noise; none of a fit that was read from a file.
    """

    def profile(self, name: str, level: float = 0.95) -> tuple[float, float]:
        """Profile-likelihood interval of one value: how far it can move while the others follow, SI.

        Unlike :meth:`intervals` it may be asymmetric; an end is infinite, or at a bound, where the data set none.
        """
        return profile_interval(self, name, level)

    def to_yaml(self, path: str | None = None) -> str:
        """The result as YAML text, also written to ``path``; :func:`load_fit` reads it."""
        return dump_fit(self, path)


def make_fit(
    model: Drivetrain, problem: FitProblem, found: LeastSquaresSolution, loss: str, lack: LackOfFit | None = None
) -> Fit:
    """Uncertainties and comparisons at the optimum.

    The covariance is that of weighted least squares under correlated noise, A J^T R J A with A = (J^T J)^-1 and the
    correlation R of the residuals, times the reduced chi squared; what the steps of sensors do comes on top, and the
    bias that noise makes. Of a model that does not fit they would be those of wrong values, so they are infinite. The
    noise of records is known from their windows: that lines happen to agree better is no proof of less.
    """
    plain_names = {name: name.partition("[")[0] for name in problem.names}
    natures = {plain: nature(model, plain) for plain in plain_names.values()}
    values, limits = _at_limits(problem, found.x, natures)
    residuals, slopes = problem.both(values)
    free = problem.effective_count - len(values)
    left_over = variance(residuals, len(values), loss, found.scale)
    factor = max(left_over, 1.0) if problem.noise_is_measured and loss == "linear" else left_over
    reach = np.linalg.norm(slopes, axis=0)
    scale = 1 / np.where(reach > 0, reach, 1.0)  # what does nothing where the search ended is not determined
    left, sizes, turned = np.linalg.svd(slopes * scale, full_matrices=False)
    lost = sizes < SINGULAR * sizes[0]
    backward = (turned.T / np.where(lost, np.inf, sizes)) @ left.T
    inverse = problem.under_noise(backward) + problem.under_shared(backward, values) / max(factor, np.finfo(float).tiny)
    covariance = factor * inverse * np.outer(scale, scale)
    undetermined = (np.abs(turned[lost]) > np.sqrt(SINGULAR)).any(axis=0)
    errors = np.where(undetermined, np.inf, np.sqrt(np.diag(covariance)))
    correlation = _correlation(inverse, turned[lost])
    names, moved = problem.names, noise_bias(problem, values)
    told = verdicts(problem, values, errors, correlation, turned[lost], moved, limits)
    rejected = lack is not None and lack.rejected
    doubts, withheld = () if rejected else far_off(problem, values), np.inf if rejected else 0.0
    return Fit(
        values=dict(zip(names, values.tolist(), strict=True)),
        standard_errors=dict(zip(names, (np.hypot(errors, moved) + withheld).tolist(), strict=True)),
        correlation=correlation,
        chi_squared=float(residuals @ residuals),
        degrees_of_freedom=max(int(free), 1),
        comparisons=tuple(_compared(problem, number, values) for number in range(len(problem.blocks))),
        verdicts=(*lacking(lack), *doubts, *limits.values(), *told),
        notes=_notes(problem, loss, left_over, scaled=factor == left_over and not withheld),
        units={name: EXTRA_UNITS.get(plain, natures[plain].unit) for name, plain in plain_names.items()},
        title=f"Fit of {model.name}",
        steps=_steps(problem, backward * scale[:, None]),
        lack_of_fit=lack,
        problem=problem,
        loss=loss,
    )


def _correlation(inverse: FloatArray, lost: FloatArray) -> FloatArray:
    """Of the estimates; where a combination is not determined at all, its members are wholly correlated."""
    heavy = inverse + HEAVY * max(float(np.trace(inverse)), 1.0) * lost.T @ lost
    size = np.sqrt(np.diag(heavy))
    return np.asarray(heavy / np.outer(size, size))


def _steps(problem: FitProblem, backward: FloatArray) -> dict[str, tuple[tuple[float, ...], ...]]:
    tests = [moved.tolist() for moved in problem.under_steps(backward)]
    return {name: tuple(map(tuple, found)) for name, *found in zip(problem.names, *tests, strict=True) if found}


def _compared(problem: FitProblem, number: int, values: FloatArray) -> Compared:
    block, place = problem.blocks[number], problem.places[number]
    predicted, _ = block.predicted(values[place])
    residual, _ = block.residuals(values[place])
    count, size = len(block.frequencies), block.deviations
    return Compared(
        name=block.measurement.label,
        frequencies=block.frequencies,
        measured=block.measured,
        fitted=predicted,
        deviation=np.hypot(size[:count], size[count:]) / np.sqrt(2),
        misfit=float(np.sqrt(np.mean(residual**2))),
        unit=_response_unit(block.response.request.outputs[0].unit, block.response.request.measured[0].unit),
        has_phase=isinstance(block.measurement.data, Recording) or block.measurement.data.has_phase,
    )


def _response_unit(output: str, into: str) -> str:
    return "1" if output == into else f"{output}/({into})" if "*" in into else f"{output}/{into}"


def _notes(problem: FitProblem, loss: str, factor: float, *, scaled: bool) -> tuple[str, ...]:
    labels = [f"{block.measurement.label} ({block.described})" for block in problem.blocks]
    by = ", by which the errors are scaled" if scaled else ""
    robust = "" if loss == "linear" else f", robust loss {loss}"
    first = f"from {', '.join(labels)}{robust}; reduced chi squared {factor:.3g}{by}"
    return (first, *filter(None, (block.remark for block in problem.blocks)))


def load_fit(path: str | os.PathLike[str]) -> Fit:
    """A fit that was written with :meth:`Fit.to_yaml`, without the data needed to profile it.

    Raises
    ------
    UsageError
        There is no such file.
    ModelError
        It holds no fit.
    """
    found = read_fit(path)
    return Fit(**{part.name: getattr(found, part.name) for part in fields(found)})


def _at_limits(
    problem: FitProblem, values: FloatArray, natures: Mapping[str, Nature]
) -> tuple[FloatArray, dict[str, str]]:
    """The values, 0 instead of what is as good as 0, and by name a sentence for what ran to zero or without end."""
    residuals, slopes = problem.both(values)
    spread = np.sqrt(float(residuals @ residuals) / max(len(residuals) - len(values), 1))
    effect = np.linalg.norm(slopes, axis=0) * np.abs(values)
    unseen = cannot_be_negative(problem) & (effect <= UNSEEN * max(spread, np.finfo(float).tiny))
    ended, said = values.copy(), {}
    for index in np.flatnonzero(unseen):
        name, factor = problem.names[index], values[index] / problem.start[index]
        kind = natures.get(name.partition("[")[0], Nature()).dimension
        if factor < 1 / FAR and problem.lower[index] == 0:
            what = kind if kind in ENDLESS else "parameter"
            said[name] = f"{name} runs to zero: the data do not show this {what}; leave it out"
            ended[index] = 0.0
        elif factor > FAR:
            said[name] = f"{name} grows without end: {ENDLESS.get(kind, 'the data set it no upper end; leave it out')}"
    return ended, said
