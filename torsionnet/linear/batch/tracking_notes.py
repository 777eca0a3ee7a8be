"""Sentences on tracked modes that come near each other, become overdamped, or get lost.

>>> here, there = np.array([2j, 3j]), np.array([[2j, 3j], [2.9j, 3.1j]])
>>> mixed = np.array([[False, False], [True, True]])
>>> tracking_notes(here, there, mixed, np.array([[1, 0], [1, 0]]))
('modes 1 and 2 share or exchange their shapes in 1 of 2 variants; they come within 6.5 % of each other',)
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.conventions import OSCILLATORY, REAL, mode_numbers
from torsionnet.linear.assembly.rows import ComplexArray


def tracking_notes(
    home: ComplexArray, followed: ComplexArray, veering: NDArray[np.bool_], partners: NDArray[np.intp]
) -> tuple[str, ...]:
    """Sentences on which tracked modes of variants share shapes, become overdamped or get lost.

    Parameters
    ----------
    home : (m,) complex array
        Eigenvalues of the drivetrain itself.
    followed : (n, m) complex array
        Of the same modes of the variants; NaN where one lacks it.
    veering : (n, m) boolean array
        Modes that resemble another one of the drivetrain too.
    partners : (n, m) integer array
        That other one.
    """
    numbers = mode_numbers([OSCILLATORY if value.imag > 0 else REAL for value in home])
    there = ~np.isnan(followed).all(axis=1)
    return (*_near(numbers, followed, veering, partners), *_lost(numbers, home, followed[there]))


def _near(
    numbers: Sequence[int | None], followed: ComplexArray, veering: NDArray[np.bool_], partners: NDArray[np.intp]
) -> Iterator[str]:
    pairs: dict[tuple[int, int], set[int]] = {}
    for variant, mode in zip(*(part.tolist() for part in np.nonzero(veering)), strict=True):
        pair = sorted((mode, int(partners[variant, mode])))
        pairs.setdefault((pair[0], pair[1]), set()).add(variant)
    for (a, b), variants in sorted(pairs.items()):
        some = sorted(variants)
        distance = np.abs(followed[some, a] - followed[some, b]) / np.abs(followed[some, b])
        near = distance[~np.isnan(distance)]
        how = f"; they come within {100 * near.min():.2g} % of each other" if near.size else ""
        yield f"{_both(numbers[a], numbers[b])} share or exchange their shapes in {_of(len(some), followed)}{how}"


def _lost(numbers: Sequence[int | None], home: ComplexArray, followed: ComplexArray) -> Iterator[str]:
    for mode, value in enumerate(home):
        column = followed[:, mode]
        real = int(np.sum((column.imag == 0) & (np.abs(column) > 0) & (value.imag > 0)))
        if real:
            yield (
                f"{_name(numbers[mode])} is damped beyond critical damping in {_of(real, followed)}; "
                "there it is the slower one of two real poles"
            )
        lost = int(np.sum(np.isnan(column)))
        if lost:
            yield f"{_name(numbers[mode])} has no successor in {_of(lost, followed)}"


def _of(count: int, followed: ComplexArray) -> str:
    return f"{count} of {len(followed)} variants"


def _name(number: int | None) -> str:
    return "a real pole" if number is None else f"mode {number}"


def _both(first: int | None, second: int | None) -> str:
    """Text for two modes, such as ``modes 1 and 2``."""
    return f"{_name(first)} and {_name(second)}" if None in (first, second) else f"modes {first} and {second}"
