"""The part of a complex amplitude that stays the same over speed, with an interval from revolutions and speeds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.signals.recording import FloatArray

CONFIDENCE = 0.95
"""Confidence of the intervals of a wheel's pitch pattern, as of all measured orders."""
NORMAL = 10**6
"""Degrees of freedom of what is known without an estimate."""
SAME_SPEED = 0.02
"""Relative width of the speeds that count as one: a governed speed wanders less, and steps of a test are wider."""


@dataclass(frozen=True)
class ConstantPart:
    """Constant part of a complex amplitude over speed, in the unit of the amplitude.

    Attributes
    ----------
    value : complex
    half_width : float
        Half width of the 95 % interval of real and of imaginary part; infinite where nothing is left to judge by.
    change : float
        Largest distance of the part that varies from its mean.
    scatter : float
        Standard deviation of what neither explains, from window to window.
    between : bool
        Whether the speeds scatter more than the windows at one speed, and the interval is from the speeds.
    """

    value: complex
    half_width: float
    change: float
    scatter: float
    between: bool = False


def speed_groups(speeds: FloatArray) -> NDArray[np.intp]:
    """Number of the group of about equal speeds that each belongs to, shape (n,), counted over rising speed.

    >>> speed_groups(np.array([100.0, 50, 100.5, 101, 49.5])).tolist()
    [1, 0, 1, 1, 0]
    """
    groups, group, start = np.zeros(len(speeds), dtype=np.intp), -1, 0.0
    for place in np.argsort(speeds, kind="stable"):
        if group < 0 or speeds[place] > start * (1 + SAME_SPEED):
            group, start = group + 1, float(speeds[place])
        groups[place] = group
    return groups


def constant_part(
    values: ComplexArray, columns: ComplexArray, groups: NDArray[np.intp], repeating: FloatArray | None = None
) -> ConstantPart:
    """Constant part of values (n,) of which the rest is a sum of columns (n, m), each with a complex factor.

    The scatter of the means of the groups, of which each is a speed, counts where an F test at 5 % finds it larger than
    that of single values; else the interval would be too narrow. ``repeating`` (n,) is a standard deviation of real and
    imaginary part that all values of a group have in common; where the scatter of the speeds counts, it is in that.

    Examples
    --------
    >>> speed = np.array([1.0, 2.0, 4.0, 5.0])
    >>> found = constant_part(3j + 2 / speed**2, (1 / speed**2)[:, None].astype(complex), np.arange(4))
    >>> bool(abs(found.value - 3j) < 1e-9), bool(found.half_width < 1e-9)
    (True, True)
    """
    sizes = np.abs(columns).max(axis=0, initial=0.0)
    columns = columns[:, sizes > 0] / sizes[sizes > 0]
    terms = np.column_stack([np.ones(len(values), dtype=complex), columns])
    unknown = terms.shape[1]
    count = np.bincount(groups)
    if len(count) < unknown:  # the speeds are too few to part what is constant from what varies
        return ConstantPart(complex(values.mean()), np.inf, 0.0, float(np.std(values)))
    factors, error, freedom = _fit(terms, values, np.ones(len(values)))
    varying = columns @ factors[1:]
    change = float(np.abs(varying - varying.mean()).max())
    if freedom <= 0:
        return ConstantPart(complex(factors[0]), np.inf, change, 0.0)
    scatter, spread = np.sqrt(error), _spread(terms, np.ones(len(values)))
    value, between = complex(factors[0]), False
    places = np.array([terms[groups == group].mean(axis=0) for group in range(len(count))])
    if unknown < len(count) < len(values):
        means = np.array([values[groups == group].mean() for group in range(len(count))])
        _, of_speeds, few = _fit(places, means, count.astype(float))
        rest = max(error * freedom - of_speeds * few, 0.0)
        inside = rest / (len(values) - len(count))
        if inside == 0 or of_speeds / inside > _fisher(2 * few, 2 * (len(values) - len(count))):
            error, freedom, between = of_speeds, few, True
    half = student(2 * freedom) * np.sqrt(error / 2) * spread
    if repeating is not None and not between:
        half = np.hypot(half, student(NORMAL) * np.sqrt(np.mean(repeating**2)) * _spread(places, np.ones(len(count))))
    return ConstantPart(value, float(half), change, float(scatter), between)


def _fit(terms: ComplexArray, values: ComplexArray, weights: FloatArray) -> tuple[ComplexArray, float, int]:
    """Factors of the terms, the variance of a single complex value about them, and its degrees of freedom."""
    root = np.sqrt(weights)
    factors = np.linalg.lstsq(terms * root[:, None], values * root, rcond=None)[0]
    freedom = len(values) - terms.shape[1]
    left = float((weights * np.abs(values - terms @ factors) ** 2).sum())
    return np.asarray(factors), left / max(freedom, 1), freedom


def _spread(terms: ComplexArray, weights: FloatArray) -> float:
    """Standard deviation of the constant per standard deviation of a value."""
    inverse = np.linalg.pinv((terms.conj().T * weights) @ terms)
    return float(np.sqrt(inverse[0, 0].real))


def student(freedom: int | NDArray[np.intp]) -> FloatArray:
    """Half width of the 95 % interval of a mean over its standard error, by degrees of freedom.

    >>> student(10).round(3).item()
    2.228
    """
    from scipy.special import stdtrit

    return np.asarray(stdtrit(freedom, 0.5 + CONFIDENCE / 2))


def _fisher(above: int, below: int) -> float:
    from scipy.special import fdtri

    return float(fdtri(above, below, CONFIDENCE))
