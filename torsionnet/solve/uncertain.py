"""Lanes that have lost digits on the way: how many, and the right values where it matters."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from torsionnet.assembly.law_stiffness import LawStiffness
from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.assembly.system import Assembly
from torsionnet.errors import SolveError, TorsionnetWarning
from torsionnet.solve.many_digits import DIGITS, ManyDigits
from torsionnet.solve.question import Question
from torsionnet.solve.quotient import Lanes, transfer_functions

PROMISED = 1e-9
"""Relative error of every value that is returned without a warning."""
ENOUGH = PROMISED / 5
DRAWS, STEP = 3, 8 * float(np.finfo(float).eps)
MOST_WORK = 20_000
"""Coordinates times lanes that are solved in many digits: a few seconds."""


def settled(
    assemblies: Sequence[Assembly], question: Question, frequencies: FloatArray, kappa: LawStiffness, found: Lanes
) -> Lanes:
    """The same with lanes in doubt estimated, and solved in many digits where rounding would show.

    Parameters
    ----------
    assemblies : sequence of Assembly
        One for each variant.
    question : Question
    frequencies : (n_f,) array
        Hz.
    kappa : LawStiffness
        Of all lanes.
    found : Lanes
    """
    lanes = np.flatnonzero(found.doubtful)
    if not len(lanes):
        return found
    error = _errors(question, kappa.at(lanes), found.values[lanes])
    poor, error = lanes[error > ENOUGH], error[error > ENOUGH]
    worst_first = np.argsort(-error, kind="stable")
    most = max(1, MOST_WORK // max(1, kappa.n_laws))
    values = found.values.copy()
    left = _in_many_digits(assemblies, question, frequencies, values, poor[worst_first[:most]])
    rest = {*left, *poor[worst_first[most:]].tolist()}
    uncertain = [(lane, size) for lane, size in zip(poor.tolist(), error.tolist(), strict=True) if lane in rest]
    if uncertain:
        _warn(uncertain, np.tile(frequencies, len(assemblies)))
    return replace(found, values=values)


def _errors(question: Question, kappa: LawStiffness, values: ComplexArray) -> FloatArray:
    """Relative error (n_lanes,) to be expected: what some rounding of all stiffnesses changes."""
    random, by_law = np.random.default_rng(0), kappa.by_law
    size = np.abs(values)
    error = np.where(np.isfinite(values).all(axis=(1, 2)), 0.0, np.inf)
    for _ in range(DRAWS):
        moved = by_law * (1 + STEP * random.uniform(0.5, 1, by_law.shape) * random.choice([-1.0, 1.0], by_law.shape))
        again = transfer_functions(question, kappa.sampled_as(moved)).values
        with np.errstate(all="ignore"):
            change = np.abs(again - values) / size
        change[again == values] = 0.0
        change[np.isnan(change)] = np.inf
        error = np.maximum(error, change.max(axis=(1, 2)))
    return np.asarray(error)


def _in_many_digits(
    assemblies: Sequence[Assembly], question: Question, frequencies: FloatArray, values: ComplexArray, lanes: FloatArray
) -> list[int]:
    """Put the right values in; returns the lanes in which even that failed."""
    import mpmath

    left: list[int] = []
    with mpmath.workdps(DIGITS):
        asked: dict[int, ManyDigits] = {}
        for lane in lanes.tolist():
            variant, number = divmod(lane, len(frequencies))
            if variant not in asked:
                asked[variant] = ManyDigits(assemblies[variant], question)
            s = mpmath.mpc(0, 2 * mpmath.pi * mpmath.mpf(frequencies[number]))
            try:
                exact = asked[variant].transfer(s)
            except SolveError:
                left.append(lane)
                continue
            values[lane] = [[complex(np.inf) if x is None else complex(x) for x in row] for row in exact]
    return left


def _warn(uncertain: Sequence[tuple[int, float]], frequencies: FloatArray) -> None:
    lane, error = max(uncertain, key=lambda pair: pair[1])
    size = f"{error:.0e} of themselves" if error < 1 else "nothing but their order of magnitude"
    text = (
        f"{len(uncertain)} values next to undamped resonances or antiresonances are rounded; "
        f"near {frequencies[lane]:.6g} Hz they are known to {size}"
    )
    warnings.warn(text, TorsionnetWarning, stacklevel=6)
