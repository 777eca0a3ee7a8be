"""Eigenvalues and undamped frequencies of the package beside the roots of det D(s)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from math import inf, nan, pi
from typing import Any

from oracle.calls import TOLERANCE, Context, Outcome, called, failed
from oracle.comparing_shapes import compare_shapes
from oracle.poles import Poles
from oracle.solution import Mechanics


def compare_poles(context: Context, lowest: int = 0) -> list[complex]:
    """All eigenvalues and undamped frequencies, and the lowest asked for alone where ``lowest`` is not 0.

    Gives the eigenvalues other than zero, those with Im >= 0.
    """
    name = "poles, frequency-dependent" if context.mechanics.is_frequency_dependent else "poles"
    outcome = called(context.drivetrain.modes)
    if failed(context, name, outcome):
        return []
    compare_undamped(context, outcome.value)
    if lowest:
        compare_lowest(context, list(outcome.value.eigenvalues), lowest)
    found = compare_modes(context, name, Poles(context.mechanics), outcome)
    every = found + [z.conjugate() for z in found if z.imag > 0]
    if not context.mechanics.is_frequency_dependent and len(every) == Poles(context.mechanics).count.others:
        compare_shapes(context, outcome.value, every)
    return found


def compare_lowest(context: Context, every: Sequence[complex], number: int) -> None:
    """Some modes beside all of them, which are compared for themselves."""
    name = "lowest poles"
    outcome = called(lambda: context.drivetrain.modes(lowest=number))
    if failed(context, name, outcome, f"for lowest={number}"):
        return
    found, right = list(outcome.value.eigenvalues), sorted(every, key=abs)[:number]
    if len(found) != len(right):
        context.wrong(name, f"their number for lowest={number}", str(right), str(found))
        return
    for given, expected in zip(sorted(found, key=abs), right, strict=True):
        off = abs(given - expected) / abs(expected) if expected else 0.0 if given == 0 else inf
        if off <= TOLERANCE:
            context.agreed(name, off)
        elif outcome.warned:
            context.warned(name)
        else:
            context.wrong(name, f"lowest={number}", repr(complex(expected)), repr(complex(given)), off)


def compare_modes(context: Context, name: str, poles: Poles, outcome: Outcome) -> list[complex]:
    """Eigenvalues beside these poles; gives those other than zero, with Im >= 0.

    Where stiffness depends on frequency, each must be a root of det D frozen at its own frequency, but how many there
    are is not known beforehand.
    """
    frozen, modes = poles.mechanics.is_frequency_dependent, outcome.value
    moving = [i for i, kind in enumerate(modes.kinds) if kind != "rigid body"]
    found = [complex(modes.eigenvalues[i]) for i in moving]
    every = found + [z.conjugate() for z in found if z.imag > 0]
    rigid = len(modes.kinds) - len(moving)
    if poles.count.rigid not in (rigid, None):
        context.wrong(name, "number of rigid-body modes", str(poles.count.rigid), str(rigid))
    elif not frozen and len(every) != poles.count.others:
        context.wrong(name, "number of poles", shown(poles), str(found))
    else:
        corrections = [poles.correction(z, abs(z.imag) if frozen else None) if z else nan for z in found]
        settled = [bool(modes.converged[i]) for i in moving]
        _compare_each(context, name, poles, found, corrections, settled, outcome.stated_error)
        if not frozen and not outcome.warned and (missed := crowded(poles, every, found, corrections)):
            context.wrong(name, missed, shown(poles))
    return [z for z in found if z]


def _compare_each(
    context: Context, name: str, poles: Poles, found: Sequence[complex], corrections: Sequence[complex],
    settled: Sequence[bool], known: float,
) -> None:  # fmt: skip
    for z, correction, converged in zip(found, corrections, settled, strict=True):
        off = abs(correction) / abs(z) if z else inf
        if off <= TOLERANCE:
            context.agreed(name, off, 2 if z.imag else 1)
        elif off <= known or not converged:
            context.warned(name)
        else:
            context.wrong(name, f"eigenvalue, error stated {known:.1g}", shown(poles), repr(z), off)


def crowded(poles: Poles, every: list[complex], found: list[complex], corrections: Sequence[complex]) -> str:
    """What is wrong where discs meet: as many poles must be given there as there are; elsewhere each disc holds one."""
    radius = {z: abs(c) * len(every) for z, c in zip(found, corrections, strict=True)}
    radius |= {z.conjugate(): r for z, r in radius.items()}
    for i, z in enumerate(every):
        near = [other for k, other in enumerate(every) if k != i and abs(z - other) <= radius[z] + radius[other]]
        if near:
            spread = max(1e-7 * abs(z), *(3 * abs(z - other) for other in near))
            inside = sum(abs(z - other) < spread for other in every)
            if (number := poles.number_inside(z, spread)) != inside:
                return f"{inside} poles given within {spread:.2g} of {z}, where there are {number}"
    return ""


def shown(poles: Poles) -> str:
    """The true poles with Im >= 0 as text, apart from zero."""
    try:
        roots = [complex(root) for root in poles.roots()]
    except ArithmeticError:
        return "not isolated"
    return ", ".join(f"{z:.12g}" for z in roots if z.imag > -1e-15 * abs(z))


def compare_undamped(context: Context, modes: Any) -> None:
    """Natural frequencies of inertias and stiffnesses alone, where these answer every motion."""
    name, mechanics = "undamped frequencies", context.mechanics
    if any(law.table for law in mechanics.laws) or mechanics.rank_of("Jk") < mechanics.freedom:
        return
    poles = Poles(Undamped(mechanics))
    found = [float(value) for value in modes.undamped_natural_frequencies]
    moving = [value for value in found if value]
    if len(found) - len(moving) != poles.count.rigid or 2 * len(moving) != poles.count.others:
        context.wrong(name, f"their number besides {poles.count.rigid} zeros, in rad/s", shown(poles), str(found))
        return
    for value in moving:
        z = 2j * pi * value
        off = abs(poles.correction(z)) / abs(z)
        if off <= TOLERANCE:
            context.agreed(name, off)
        else:
            context.wrong(name, "in rad/s", shown(poles), repr(abs(z)), off)


class Undamped(Mechanics):
    """The same without any damping."""

    def __init__(self, mechanics: Mechanics) -> None:
        super().__init__(mechanics.model)
        self.laws = [replace(law, c=Fraction(0), eta=Fraction(0)) for law in mechanics.laws]
