"""How much a value changes when the numbers of the model are rounded: what no calculation in doubles can avoid."""

from __future__ import annotations

from copy import copy
from dataclasses import replace
from fractions import Fraction

from oracle.answers import Answer
from oracle.exact import ball, precision
from oracle.solution import Mechanics

STEP = Fraction(1, 2**100)
EPSILON = 2.0**-53
BITS = 512


def unavoidable(answer: Answer, frequency: float, output: int, into: int) -> float:
    """Relative change of one value when every J, c and k is rounded to a double, all in the worst sense."""
    exact, total = answer.at(frequency)[output][into], 0.0
    for changed in perturbed(answer.mechanics):
        moved = Answer(changed, answer.question)
        moved.zeros = answer.zeros
        value = moved.at(frequency)[output][into]
        with precision(BITS):
            total += float((abs(value - exact) / abs(exact) / ball(STEP)).mid()) * EPSILON
    return total


def perturbed(mechanics: Mechanics) -> list[Mechanics]:
    """The same with one coefficient of one law a little larger."""
    found = []
    for number, law in enumerate(mechanics.laws):
        for name in "Jck":
            value = getattr(law, name)
            if value == 0:
                continue
            larger = (lambda value=value: value() * ball(1 + STEP)) if callable(value) else value * (1 + STEP)
            changed = copy(mechanics)
            changed.laws = [*mechanics.laws[:number], replace(law, **{name: larger}), *mechanics.laws[number + 1 :]]
            found.append(changed)
    return found
