"""Peak and peak frequency, two quantities of a study, the largest magnitude of a transfer function in a band.

Search of the largest magnitude in a band for many variants at once, on a grid of frequencies refined at maxima.
Neighbours on the grid are at most 1 % apart; peaks closer together may be taken for one. The sixteen with the highest
estimated peaks are refined with steps of a quarter per cent; around the four highest then, rounds shrink the bracket to
2e-5 of the frequency. The last step is the vertex of a parabola through 1/|H|^2, which near a single resonance is one,
and the value is that of H there. Measured on one mass with damping ratios from 1e-5 to 0.5: 1e-9 of the magnitude, 1e-7
of the frequency.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.scalars import Band
from torsionnet.base.entries.spec import entry
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.quantity import QuantityForm, VariantBlock, register_quantity
from torsionnet.study.quantities.transfer_quantity import TransferQuantity

# Search of the largest magnitude in a band for many variants at once, on a grid of frequencies refined at maxima.

GRID_STEP = 0.01
"""Largest relative step of the grid of frequencies, as peaks closer together than this may count as one."""
CANDIDATES, FOLLOWED = 16, 4
"""Number of local maxima in a band that are refined once, and of those that are refined to the end."""
ROUNDS, POINTS = 4, 9
"""Rounds of refinement of a peak, each of which shrinks its bracket to a quarter, and points in a bracket."""
UNDAMPED_SHARE = 1e-9
"""Share of its shoulders below which the vertex of the parabola through 1/|H|^2 is a peak without damping."""


class BandPeaks(NamedTuple):
    """Largest magnitudes (n,) of n variants in SI and their frequencies (n,) in Hz."""

    magnitude: FloatArray
    frequency: FloatArray


def band_grid(low: float, high: float) -> FloatArray:
    """Frequencies (n_f,) in Hz with equal ratios of at most 1.01 from ``low`` to ``high``, both included."""
    return np.geomspace(low, high, max(math.ceil(math.log(high / low) / GRID_STEP), POINTS) + 1)


def largest(magnitude: Callable[[FloatArray], FloatArray], grid: FloatArray) -> BandPeaks:
    """Search the largest magnitude of every variant between the ends of a grid of frequencies.

    Parameters
    ----------
    magnitude : callable
        Frequencies (n_f,), or (n, n_f), one row for each variant -> magnitudes (n, n_f).
    grid : (n_grid,) array
        Hz, ascending.

    Examples
    --------
    >>> peaks = largest(lambda f: np.atleast_2d(1 / abs(4 - f**2 + 0.04j * f)), band_grid(1, 10))
    >>> round(float(peaks.magnitude[0]), 6), round(float(peaks.frequency[0]), 6)
    (12.500625, 1.9998)
    """
    coarse = magnitude(grid)
    places, there = _candidates(coarse)
    low, high = grid[np.maximum(places - 1, 0)], grid[np.minimum(places + 1, len(grid) - 1)]
    look = _look(magnitude, low, high)
    promise = np.where(there, _taken(_promised(look.values), look.best), -np.inf)
    few = np.argsort(-promise, axis=1, kind="stable")[:, :FOLLOWED]
    low, high = (_rows_of(_taken(look.at, np.clip(look.best + side, 0, POINTS - 1)), few) for side in (-1, 1))
    for _ in range(ROUNDS):
        look = _look(magnitude, low, high)
        low, high = (_taken(look.at, np.clip(look.best + side, 0, POINTS - 1)) for side in (-1, 1))
    at, infinite = _vertex(look)
    known, tops = _taken(look.values, look.best), np.where(infinite, np.inf, magnitude(at))
    # The vertex counts where it is not below the points.
    at = np.where(tops >= known, at, _taken(look.at, look.best))
    tops = np.maximum(tops, known)
    first = np.argmax(tops, axis=1)
    return BandPeaks(_taken(tops, first), _taken(at, first))


class _Look(NamedTuple):
    """Frequencies in Hz and magnitudes in brackets (n, n_intervals, POINTS), index of the largest (n, n_intervals)."""

    at: FloatArray
    values: FloatArray
    best: NDArray[np.intp]


def _look(magnitude: Callable[[FloatArray], FloatArray], low: FloatArray, high: FloatArray) -> _Look:
    at = low[..., None] + (high - low)[..., None] * np.linspace(0, 1, POINTS)
    values = magnitude(at.reshape(len(at), -1)).reshape(at.shape)
    return _Look(at, values, np.argmax(values, axis=-1))


def _candidates(values: FloatArray) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Indices (n, CANDIDATES) of the local maxima with the highest estimates, ends included, and which are maxima."""
    rim = np.full((len(values), 1), -np.inf)
    before, after = np.hstack([rim, values[:, :-1]]), np.hstack([values[:, 1:], rim])
    promise = np.where((values >= before) & (values >= after), _promised(values), -np.inf)
    places = np.argsort(-promise, axis=1, kind="stable")[:, :CANDIDATES]
    return places, _rows_of(promise, places) > -np.inf


def _promised(values: FloatArray) -> FloatArray:
    """Estimated heights of peaks at each point by a parabola through 1/|H|^2, infinite where it reaches 0."""
    heights = values.copy()
    with np.errstate(all="ignore"):
        inverse = values**-2.0
        before, here, after = inverse[..., :-2], inverse[..., 1:-1], inverse[..., 2:]
        # The parabola through y_1, y_0, y_2 has its vertex at y_0 - (y_1 - y_2)^2/(8 bend), bend = y_1 - 2 y_0 + y_2.
        bend = before - 2 * here + after
        bottom = here - np.where(bend > 0, (before - after) ** 2 / (8 * bend), 0)
        inner = np.where(bottom > 0, bottom**-0.5, np.inf)
    heights[..., 1:-1] = np.where(np.isnan(inner), values[..., 1:-1], inner)
    return heights


def _vertex(look: _Look) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Frequencies in Hz of the vertices of parabolas around the largest points, and whether the peaks are infinite."""
    middle = np.clip(look.best, 1, POINTS - 2)
    f_before, f_here, f_after = (_taken(look.at, middle + side) for side in (-1, 0, 1))
    with np.errstate(all="ignore"):
        before, here, after = (_taken(look.values, middle + side) ** -2.0 for side in (-1, 0, 1))
        bend = before - 2 * here + after
        # The vertex lies (y_1 - y_2)/(2 bend) steps from the middle point.
        shift = np.where(bend > 0, (before - after) / (2 * bend), 0)
        bottom = here - np.where(bend > 0, (before - after) ** 2 / (8 * bend), 0)
        # 1/|H|^2 comes to 0 at a resonance without damping.
        infinite = (look.best == middle) & (bottom < UNDAMPED_SHARE * np.maximum(before, after))
    at = f_here + np.clip(shift, -1, 1) * (f_after - f_before) / 2
    return np.where(look.best == middle, at, _taken(look.at, look.best)), infinite


def _taken(rows: FloatArray, places: NDArray[np.intp]) -> FloatArray:
    """Values (n, n_intervals) at one index of the last axis of an array (n, n_intervals, POINTS) in each row."""
    return np.asarray(np.take_along_axis(rows, places[..., None], axis=-1)[..., 0])


def _rows_of(rows: FloatArray, places: NDArray[np.intp]) -> FloatArray:
    return np.asarray(np.take_along_axis(rows, places, axis=-1))


@dataclass(frozen=True, kw_only=True)
class PeakQuantity(TransferQuantity):
    """Base class of the quantities of the largest magnitude of a transfer function in a band."""

    kind: ClassVar[str] = "peak in a band"

    band: tuple[float, float] = entry(Band("where it is looked for"))

    @property
    def range_words(self) -> str:
        """Words for the band, such as "from 1 to 50 Hz"."""
        return f"from {self.band[0]:g} to {self.band[1]:g} Hz"

    def peaks(self, block: VariantBlock) -> BandPeaks:
        """Largest magnitude (n,) of every variant in SI and its frequency (n,) in Hz."""
        return block.once(("peaks", self.output, self.input, self.excitation, self.band), lambda: self._searched(block))

    def _searched(self, block: VariantBlock) -> BandPeaks:
        grid = band_grid(*self.band)
        peaks = BandPeaks(np.empty(len(block)), np.empty(len(block)))
        for which, part in block.parts(max(len(grid), CANDIDATES * POINTS)):
            peaks.magnitude[which], peaks.frequency[which] = largest(partial(self._magnitude, part), grid)
        return peaks

    def _magnitude(self, block: VariantBlock, frequencies: FloatArray) -> FloatArray:
        return np.abs(self.values(block, frequencies))


@register_quantity
@dataclass(frozen=True, kw_only=True)
class PeakMagnitude(PeakQuantity):
    """Largest magnitude in SI of a transfer function in a band, at a peak or at an end of the band.

    It is found between the points of a grid, to 1e-9 of itself; peaks less than 1 % apart may count as one. Infinite
    where nothing damps.

    Examples
    --------
    >>> import numpy as np
    >>> import torsionnet as tn
    >>> J, k, c = 2.0, 8e4, 40.0
    >>> crank = tn.Drivetrain("crank", [tn.Inertia("mass", node="a", inertia=J),
    ...     tn.Spring("shaft", nodes=("a", "ground"), stiffness=k, damping="c")], parameters={"c": c})
    >>> block = VariantBlock(crank, {"c": np.array([c])}, {}, None)
    >>> top = PeakMagnitude(output="a", input="a", band="1..100 Hz").evaluate(block)
    >>> zeta = c / (2 * (k * J) ** 0.5)
    >>> bool(abs(top[0, 0] * k * 2 * zeta * (1 - zeta**2) ** 0.5 - 1) < 1e-12)
    True
    """

    kind: ClassVar[str] = "peak"

    @property
    def words(self) -> str:
        return f"largest magnitude of {self.quotient} {self.range_words}"

    def measure(self, model: Drivetrain) -> QuantityForm:
        return QuantityForm(self.unit(model))

    def evaluate(self, block: VariantBlock) -> FloatArray:
        return self.peaks(block).magnitude[:, None]


@register_quantity
@dataclass(frozen=True, kw_only=True)
class PeakFrequency(PeakQuantity):
    """Frequency in Hz of the largest magnitude of a transfer function in a band."""

    kind: ClassVar[str] = "peak_frequency"

    @property
    def words(self) -> str:
        return f"frequency of the largest magnitude of {self.quotient} {self.range_words}"

    def measure(self, model: Drivetrain) -> QuantityForm:
        del model
        return QuantityForm("Hz")

    def evaluate(self, block: VariantBlock) -> FloatArray:
        return self.peaks(block).frequency[:, None]
