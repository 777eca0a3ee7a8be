"""Error estimates of uncertain frequency points, and their responses in many digits where rounding would show."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from torsionnet.assembly.law_stiffness import LawStiffness
from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.assembly.system import Assembly
from torsionnet.core.errors import SolveError, TorsionnetWarning
from torsionnet.solve.dynamic_stiffness.quotient import FrequencyPoints, transfer_functions
from torsionnet.solve.dynamic_stiffness.transfer_request import TransferRequest

if TYPE_CHECKING:
    from torsionnet.solve.dynamic_stiffness.many_digits import ManyDigits

PROMISED_ERROR = 1e-9
"""Largest relative error of response values that are returned without a warning."""
ACCEPTED_ERROR = PROMISED_ERROR / 5
"""Estimated relative error up to which a value is kept, a fifth of the promised one as the estimate is statistical."""
PERTURBATIONS, PERTURBATION = 4, 8 * float(np.finfo(float).eps)
"""Number of perturbed solutions for an error estimate, and relative perturbation of the stiffnesses, a few
roundings."""
SURE_PERTURBATIONS, SURE_ERROR = 2, ACCEPTED_ERROR / 100
"""Number of perturbed solutions, one in each elimination order, and error below which a point needs no more of them."""
MOST_WORK = 20_000
"""Most laws times points that are solved in many digits for one response, which takes a few seconds."""


def refine_uncertain_points(
    assemblies: Sequence[Assembly],
    request: TransferRequest,
    frequencies: FloatArray,
    kappa: LawStiffness,
    found: FrequencyPoints,
    method: str = "auto",
) -> FrequencyPoints:
    """Transfer functions whose uncertain points are checked, and solved in many digits where rounding shows.

    Parameters
    ----------
    assemblies : sequence of Assembly
        One for each variant.
    request : TransferRequest
    frequencies : (n_f,) or (n_variants, n_f) array
        Hz.
    kappa : LawStiffness
        Of all points.
    found : FrequencyPoints
    method : str
        Solver by which uncertain points are estimated.

    Raises
    ------
    UsageError
        The measured inputs depend on each other at every frequency.
    """
    points = np.flatnonzero(found.uncertain)
    if not len(points):
        return found
    errors = expected_errors(
        lambda some, other_order: transfer_functions(request, some, method, other_order=other_order).values,
        kappa.at(points),
        found.values[points],
    )
    worst = errors.max(axis=(1, 2), initial=0.0)
    order = [place for place in np.argsort(-worst, kind="stable").tolist() if worst[place] > ACCEPTED_ERROR]
    most = max(1, MOST_WORK // max(1, kappa.n_laws))
    values = found.values.copy()
    exact = _ManyPoints(assemblies, request, frequencies)
    uncertain = [(points[place], worst[place]) for place in order[most:]]
    for place in order[:most]:
        known = exact.transfer_function(points[place])
        if known is None:
            uncertain.append((points[place], worst[place]))
        else:
            values[points[place]] = np.where(errors[place] > ACCEPTED_ERROR, known, values[points[place]])
    if uncertain:
        _warn(uncertain, exact.frequencies.ravel())
    return replace(found, values=values)


def expected_errors(
    evaluate: Callable[[LawStiffness, bool], ComplexArray], kappa: LawStiffness, values: ComplexArray
) -> FloatArray:
    """Relative errors of ``values`` (n_points, ...), from solutions with stiffnesses changed by roundings.

    All stiffnesses are moved by a few roundings, with signs by chance. That shows how a value depends on them. Every
    later rounding falls out differently too, the more so in another order of elimination (``True``), which shows what
    elimination itself has lost.
    """
    random = np.random.default_rng(0)
    error = np.where(np.isfinite(values), 0.0, np.inf)
    rows = tuple(range(1, error.ndim))
    unsure = np.arange(len(values))
    for draw in range(PERTURBATIONS):
        if draw == SURE_PERTURBATIONS:
            unsure = np.flatnonzero(error.max(axis=rows, initial=0.0) > SURE_ERROR)
        if not len(unsure):
            break
        by_law = kappa.by_law[:, unsure]
        moved = by_law * (
            1 + PERTURBATION * random.uniform(0.5, 1, by_law.shape) * random.choice([-1.0, 1.0], by_law.shape)
        )
        again = evaluate(kappa.at(unsure).with_sampled_stiffness(moved), draw % 2 > 0)
        with np.errstate(all="ignore"):
            change = np.abs(again - values[unsure]) / np.abs(values[unsure])
        change[again == values[unsure]] = 0.0
        change[np.isnan(change)] = np.inf
        error[unsure] = np.maximum(error[unsure], change)
    return np.asarray(error)


class _ManyPoints:
    """Transfer functions (n_out, n_in) of single frequency points of some variants, in many digits."""

    def __init__(self, assemblies: Sequence[Assembly], request: TransferRequest, frequencies: FloatArray) -> None:
        self.assemblies, self.request = assemblies, request
        self.frequencies = np.broadcast_to(frequencies, (len(assemblies), frequencies.shape[-1]))
        self.asked: dict[int, ManyDigits] = {}

    def transfer_function(self, point: int) -> ComplexArray | None:
        """Transfer functions (n_out, n_in) of a point, exact to double precision, or None if digits run out.

        Raises
        ------
        UsageError
            The measured inputs depend on each other here, and then everywhere: a frequency in Hz is no exact root.
        """
        import mpmath

        from torsionnet.solve.dynamic_stiffness.many_digits import CALCULATION_DIGITS, ManyDigits

        variant, number = divmod(point, self.frequencies.shape[1])
        with mpmath.workdps(CALCULATION_DIGITS):
            if variant not in self.asked:
                self.asked[variant] = ManyDigits(self.assemblies[variant], self.request)
            omega = 2 * mpmath.pi * mpmath.mpf(self.frequencies[variant, number])
            try:
                found = self.asked[variant].transfer(mpmath.mpc(0, omega))
            except SolveError:
                return None
            if found is None:
                raise self.request.dependent_inputs_error()
            return np.array([[complex(value) for value in row] for row in found])


def _warn(uncertain: Sequence[tuple[int, float]], frequencies: FloatArray) -> None:
    point, error = max(uncertain, key=lambda pair: pair[1])
    size = f"{error:.0e} of themselves" if error < 1 else "nothing but their order of magnitude"
    text = (
        f"{len(uncertain)} values next to undamped resonances or antiresonances are rounded; "
        f"near {frequencies[point]:.6g} Hz they are known to {size}"
    )
    warnings.warn(text, TorsionnetWarning, stacklevel=6)
