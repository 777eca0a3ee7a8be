"""Schwarz criterion (BIC) of fits with different numbers of poles, misfit against number of unknowns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.modal.residues import expand
from torsionnet.modal.settings import Settings
from torsionnet.modal.spectral_lines import ComplexArray, Lines

ROUND_OFF = 1e-9
"""RMS residual over RMS response below which a fit counts as exact, as a smaller one is rounding and must not favour
more poles."""
LARGEST_CORRELATION = 0.95
"""Largest correlation of residuals at neighbouring lines that is assumed, as at 1 the number of equations would be
0."""


def line_correlation(left: ComplexArray) -> float:
    """Correlation, 0 to 0.95, of a fit's residuals (n_f, ...) at neighbouring lines, which windows cause."""
    total = max(float(np.sum(np.abs(left) ** 2)), np.finfo(float).tiny)
    return float(np.clip(np.sum(left[1:] * left[:-1].conj()).real / total, 0, LARGEST_CORRELATION))


@dataclass(frozen=True, eq=False)
class BicCriterion:
    """Schwarz criterion (BIC) for fits of the same lines, of which the one with the lowest value is the best.

    Attributes
    ----------
    lines : Lines
    noise : (n_f, n_out, n_in) complex array
        Weighted residuals of the best fit; where neighbouring lines are correlated they count for less.
    """

    lines: Lines
    noise: ComplexArray

    def value(self, left: ComplexArray, poles: int) -> float:
        """Schwarz criterion of a fit from its weighted residuals and its number of poles (both of each pair)."""
        count, outputs, inputs = left.shape
        size = np.mean(np.abs(self.lines.weights * self.lines.values) ** 2, axis=0)
        squares = np.maximum(np.mean(np.abs(left) ** 2, axis=0), ROUND_OFF**2 * size)
        same = line_correlation(self.noise)
        equations = 2 * count * (1 - same) / (1 + same)
        residues = outputs if self.lines.drive is None else 2 * outputs  # of a record, and those of its transients
        unknowns = poles * (residues + inputs)
        return float(equations * np.log(squares).sum() + unknowns * np.log(max(2, equations * squares.size)))


def significant_poles(lines: Lines, poles: ComplexArray, rows: ComplexArray, settings: Settings) -> list[int]:
    """Indices of the poles kept when the least useful pole is dropped again and again while that lowers the BIC."""
    kept = list(range(len(poles)))
    left = weighted_residuals(lines, poles, rows, settings)
    criterion = BicCriterion(lines, left)
    best = criterion.value(left, pole_count(poles))
    while len(kept) > 1:
        trials = []
        for place in kept:
            rest = [other for other in kept if other != place]
            trials.append(
                (
                    criterion.value(
                        weighted_residuals(lines, poles[rest], rows[rest], settings), pole_count(poles[rest])
                    ),
                    place,
                )
            )
        least, place = min(trials)
        if least >= best:
            break
        best = least
        kept.remove(place)
    return kept


def weighted_residuals(lines: Lines, poles: ComplexArray, rows: ComplexArray, settings: Settings) -> ComplexArray:
    """Weighted residuals (n_f, n_out, n_in) of a fit with given poles and their best residues, complex."""
    expansion = expand(lines, poles, settings, rows)
    return np.asarray(lines.weights * (lines.values - expansion.values(lines.s, lines.powers)))


def pole_count(poles: ComplexArray) -> int:
    """Number of poles with both of each conjugate pair counted, from a list with one of each."""
    return int(np.sum(1 + (poles.imag != 0)))


def best_order(lines: Lines, left: list[ComplexArray]) -> int:
    """Index (from 0) of the order of a fit with the lowest BIC, from the weighted residuals of each order."""
    squares = [np.log(np.maximum(np.mean(np.abs(each) ** 2, axis=0), np.finfo(float).tiny)).sum() for each in left]
    criterion = BicCriterion(lines, left[int(np.argmin(squares))])
    inputs = lines.values.shape[2]
    return int(np.argmin([criterion.value(each, (place + 1) * inputs) for place, each in enumerate(left)]))
