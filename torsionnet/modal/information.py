"""Whether poles are worth their unknowns: Schwarz's criterion (BIC)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.modal.residues import expand
from torsionnet.modal.settings import Settings
from torsionnet.modal.spectral_lines import ComplexArray, Lines

ROUND_OFF = 1e-9
MOST_ALIKE = 0.95


def alike(left: ComplexArray) -> float:
    """Correlation of what a fit leaves over, (n_f, ...), at neighbouring lines: a window makes them alike."""
    total = max(float(np.sum(np.abs(left) ** 2)), np.finfo(float).tiny)
    return float(np.clip(np.sum(left[1:] * left[:-1].conj()).real / total, 0, MOST_ALIKE))


@dataclass(frozen=True, eq=False)
class Judge:
    """The criterion for fits of the same lines; the least is the best.

    Attributes
    ----------
    lines : Lines
    noise : (n_f, n_out, n_in) complex array
        What the best fit leaves over, weighted; where it is alike at neighbouring lines they count for less.
    """

    lines: Lines
    noise: ComplexArray

    def criterion(self, left: ComplexArray, poles: int) -> float:
        """Of what a fit with so many poles, both of each pair, leaves over; below the round-off nothing is gained."""
        count, outputs, inputs = left.shape
        size = np.mean(np.abs(self.lines.weights * self.lines.values) ** 2, axis=0)
        squares = np.maximum(np.mean(np.abs(left) ** 2, axis=0), ROUND_OFF**2 * size)
        same = alike(self.noise)
        equations = 2 * count * (1 - same) / (1 + same)
        unknowns = poles * (outputs + inputs)
        return float(equations * np.log(squares).sum() + unknowns * np.log(max(2, equations * squares.size)))


def worth_keeping(lines: Lines, poles: ComplexArray, rows: ComplexArray, settings: Settings) -> list[int]:
    """Places of the poles that stay when the least useful is dropped as long as that lowers the criterion."""
    kept = list(range(len(poles)))
    left = left_over(lines, poles, rows, settings)
    judge = Judge(lines, left)
    best = judge.criterion(left, count_of(poles))
    while len(kept) > 1:
        trials = []
        for place in kept:
            rest = [other for other in kept if other != place]
            trials.append(
                (judge.criterion(left_over(lines, poles[rest], rows[rest], settings), count_of(poles[rest])), place)
            )
        least, place = min(trials)
        if least >= best:
            break
        best = least
        kept.remove(place)
    return kept


def left_over(lines: Lines, poles: ComplexArray, rows: ComplexArray, settings: Settings) -> ComplexArray:
    """What the best residues of given poles leave over, weighted, (n_f, n_out, n_in)."""
    expansion = expand(lines, poles, settings, rows)
    return np.asarray(lines.weights * (lines.values - expansion.values(lines.s, lines.powers)))


def count_of(poles: ComplexArray) -> int:
    """Poles with both of each pair."""
    return int(np.sum(1 + (poles.imag != 0)))


def best_order(lines: Lines, left: list[ComplexArray]) -> int:
    """Place of the order, from 0, with the least criterion; ``left`` is what each order leaves over."""
    squares = [np.log(np.maximum(np.mean(np.abs(each) ** 2, axis=0), np.finfo(float).tiny)).sum() for each in left]
    judge = Judge(lines, left[int(np.argmin(squares))])
    inputs = lines.values.shape[2]
    return int(np.argmin([judge.criterion(each, (place + 1) * inputs) for place, each in enumerate(left)]))
