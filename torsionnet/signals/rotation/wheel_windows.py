"""Whole revolutions of a wheel, one window after the other: what its pulses show in each order, and in each tooth.

The wheel turns by theta = phi + x(phi), phi the mean angle of rotation, a cubic over the window, x(phi) = Re sum_v X_v
exp(j v phi) its vibration. A pulse of tooth k says theta = 2 pi (n + k/z) + p_k at its time, p_k the tooth's error of
position. Mean rotation and X follow by least squares from all pulses of the window, and depend on p linearly: so a
window is solved once, and a better pattern changes what it shows by one product of matrices.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.signals.recording import FloatArray

MEAN_DEGREE = 3
"""Degree of the polynomial of the mean rotation over a window: a run-up changes its speed smoothly, and a higher one
would take part of the lowest order."""
MEAN_STEPS = 4
"""Repetitions in which mean rotation and vibration are found: each leaves about the square of the vibration in rad."""


@dataclass(frozen=True, eq=False)
class Shown:
    """Solution of the pulses of one pickup over a window of whole revolutions, linear in the errors of the teeth.

    Attributes
    ----------
    solution : (n_terms,) array
        Terms beside the vibration, then its cosines and its sines, rad.
    by_tooth : (n_terms, teeth) array
        Change of the solution per rad of each tooth.
    terms_of_tooth : (teeth, n_terms) array
        Mean of each term over the pulses of a tooth.
    mean_of_tooth : (teeth,) array
        Mean over the pulses of a tooth of the angle beyond the mean rotation, rad; NaN where it has none.
    """

    solution: FloatArray
    by_tooth: FloatArray
    terms_of_tooth: FloatArray
    mean_of_tooth: FloatArray

    def terms(self, positions: FloatArray) -> FloatArray:
        """Terms in rad, shape (n_terms,), with the teeth at these positions beyond their places."""
        return np.asarray(self.solution + self.by_tooth @ positions)

    def orders(self, positions: FloatArray, count: int) -> ComplexArray:
        """Peak amplitudes X of Re X exp(j v phi) in rad, shape (count,), with the teeth at these positions."""
        found = self.terms(positions)
        return np.asarray(found[-2 * count : -count] - 1j * found[-count:])

    def left(self, positions: FloatArray) -> FloatArray:
        """Angle in rad at each tooth that rotation and vibration do not explain, shape (teeth,); NaN without pulses."""
        return np.asarray(self.mean_of_tooth + positions - self.terms_of_tooth @ self.terms(positions))


@dataclass(frozen=True, eq=False)
class Window:
    """A window of whole revolutions of a wheel.

    Attributes
    ----------
    begin, end : float
        s.
    speed : float
        Mean speed of the wheel, rad/s.
    first : Shown
        Of the pickup that says the mean rotation.
    mean : (n,) array
        Coefficients of the mean rotation, rad, of Legendre's polynomials over the window.
    """

    begin: float
    end: float
    speed: float
    first: Shown
    mean: FloatArray

    def mean_rotation(self, times: FloatArray) -> FloatArray:
        """Mean rotation of the wheel in rad at times in s, shape (n,)."""
        return np.asarray(np.polynomial.legendre.legval(self.place(times), self.mean))

    def place(self, times: FloatArray) -> FloatArray:
        """Times as places between -1 and 1 in the window, shape (n,)."""
        return np.asarray((2 * times - self.begin - self.end) / (self.end - self.begin))


def spans(numbers: NDArray[np.intp], length: int, most: int) -> Iterator[slice]:
    """Yield slices of the pulses of windows of ``length`` pitches, at most so many, evenly over the record."""
    starts = np.arange(numbers[0], numbers[-1] - length + 1, length)
    if len(starts) > most:
        starts = starts[np.unique(np.linspace(0, len(starts) - 1, most).round().astype(int))]
    for start in starts:
        yield slice(*np.searchsorted(numbers, [start, start + length]).tolist())


def first_window(
    times: FloatArray, numbers: NDArray[np.intp], teeth: int, orders: FloatArray, positions: FloatArray
) -> Window:
    """Window with mean rotation and orders of the first pickup, teeth at ``positions`` for the mean rotation."""
    begin, end = float(times[0]), float(times[-1])
    place = (2 * times - begin - end) / (end - begin)
    angle = 2 * np.pi * numbers / teeth
    powers = np.polynomial.legendre.legvander(place, MEAN_DEGREE)
    mean: FloatArray = np.asarray(np.linalg.lstsq(powers, angle, rcond=None)[0])
    for step in range(MEAN_STEPS):
        base = powers @ mean
        terms = np.hstack([powers, _waves(orders, base)])
        if step == MEAN_STEPS - 1:
            break
        mean += solved(terms, angle + positions[numbers % teeth] - base)[: MEAN_DEGREE + 1]
    speed = float(powers[-1] @ mean - powers[0] @ mean) / (end - begin)
    return Window(begin, end, speed, shown(terms, angle - base, numbers % teeth, teeth), mean)


def second_shown(
    window: Window, times: FloatArray, numbers: NDArray[np.intp], teeth: int, angle: float, orders: FloatArray
) -> Shown:
    """Solution of the pulses of a second pickup, ``angle`` rad behind the first, in the mean rotation of the first."""
    base = window.mean_rotation(times)
    terms = np.hstack([np.ones((len(times), 1)), _waves(orders, base)])
    return shown(terms, 2 * np.pi * numbers / teeth + angle - base, numbers % teeth, teeth)


def shown(terms: FloatArray, values: FloatArray, tooth: NDArray[np.intp], teeth: int) -> Shown:
    """Solution of the terms for the values (n,) in rad, and what an error of each tooth changes in it."""
    sums = np.zeros((teeth, terms.shape[1]))
    np.add.at(sums, tooth, terms)
    counts = np.bincount(tooth, minlength=teeth)
    with np.errstate(invalid="ignore"):
        means = np.bincount(tooth, values, minlength=teeth) / counts
    both = solved(terms, np.column_stack([values, np.zeros_like(values)]), sums.T)
    return Shown(both[:, 0], both[:, 2:], sums / np.maximum(counts, 1)[:, None], means)


def solved(terms: FloatArray, values: FloatArray, more: FloatArray | None = None) -> FloatArray:
    """Least squares solution for values (n,) or (n, m), and of further right-hand sides of the normal equations."""
    right = terms.T @ values
    if more is not None:
        right = np.hstack([right, more])
    return np.asarray(np.linalg.solve(terms.T @ terms, right))


def _waves(orders: FloatArray, angle: FloatArray) -> FloatArray:
    phases = angle[:, None] * orders
    return np.hstack([np.cos(phases), np.sin(phases)])
