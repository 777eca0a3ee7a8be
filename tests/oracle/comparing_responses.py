"""Transfer functions of the package beside the exact ones: numbers, dense, parametric, symbols."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from flint import acb

import torsionnet as tn
from oracle.answers import INFINITE, Answer, SingularInputError
from oracle.calls import BITS, TOLERANCE, Context, Outcome, called, deviation, failed
from oracle.exact import precision
from oracle.package import named
from oracle.questions import Asked
from oracle.rounding import unavoidable
from torsionnet.linear.sensitivity.parametric import parametric_response

EXPLAINED = 2
NEGLIGIBLE = 1e-100
"""At rest, of a value that falls to zero there but is not zero elsewhere: a limit may be taken at a small s."""
LEAST, MOST = 1e-290, 1e290
"""Magnitudes in between are compared; doubles end soon after."""

Call = Callable[[Asked, Sequence[float]], Any]


def respond(drivetrain: tn.Drivetrain, **options: Any) -> Call:
    def call(asked: Asked, f: Sequence[float]) -> Any:
        return drivetrain.frequency_response(asked.outputs, asked.inputs, f, **asked.excited, **options).values

    return call


def compare_responses(
    context: Context, quantity: str, asked: Asked, frequencies: Sequence[float], call: Call, *, exact_zeros: bool = True
) -> None:
    """All outputs over all inputs at frequencies in Hz; at 0 the limit, under a name of its own.

    ``exact_zeros``: what is identically zero must be so; otherwise rounding of the terms is allowed.
    """
    answer = Answer(context.mechanics, asked.question)
    for name, chosen in (
        (quantity, [f for f in frequencies if f]),
        (f"{quantity}, static", [f for f in frequencies if not f]),
    ):
        if not chosen:
            continue
        outcome = called(lambda chosen=chosen: call(asked, chosen))
        try:
            exact = [answer.at(f) if f else answer.at_rest() for f in chosen]
        except SingularInputError:
            _always_singular(context, name, asked, outcome)
            continue
        if not failed(context, name, outcome, f"for {asked}"):
            table = _Table(context, name, asked, answer, call, outcome, exact_zeros)
            for f, got, right in zip(chosen, np.asarray(outcome.value), exact, strict=True):
                table.compare(f, got, right)


def _always_singular(context: Context, name: str, asked: Asked, outcome: Outcome) -> None:
    """A measured input that is always zero has to be refused; of several that are dependent a warning may tell."""
    if outcome.is_refused:
        context.refused(name)
    elif len(asked.inputs) > 1 and outcome.warned:
        context.warned(name)
    else:
        got = repr(outcome.error or np.asarray(outcome.value).ravel()[:3])
        what = f"{asked.inputs}, excitation {asked.excitations}: always zero or dependent"
        context.wrong(name, what, "refused", f"{got}, warnings {outcome.warned}")


@dataclass
class _Table:
    """One call of the package, compared value by value."""

    context: Context
    name: str
    asked: Asked
    answer: Answer
    call: Call
    outcome: Outcome
    exact_zeros: bool
    explained: int = 0

    def compare(self, f: float, got: Any, exact: list[list[Any]]) -> None:
        zeros = any(value == 0 for row in exact for value in row)
        scales = self.answer.sizes(f) if f and zeros and not self.exact_zeros else None
        for i, row in enumerate(exact):
            for j, right in enumerate(row):
                if right == INFINITE:
                    self.expect_infinite(f, i, j, complex(got[i, j]))
                elif right == 0 or LEAST < _size(right) < MOST:
                    self.expect(f, i, j, complex(got[i, j]), right, scales[i][j] if scales else None)

    def expect_infinite(self, f: float, i: int, j: int, got: complex) -> None:
        if np.isinf(abs(got)) and self.outcome.says_infinite:
            self.context.agreed(self.name, 0.0)
        else:
            said = f"{got}, warnings {self.outcome.warned}"
            self.context.wrong(self.name, self.asked.words(i, j, f), "infinite, with a warning", said)

    def expect(self, f: float, i: int, j: int, got: complex, exact: acb, scale: acb | None) -> None:
        off = deviation(got, exact, scale)
        if not f and exact == 0 and abs(got) < NEGLIGIBLE and not (self.exact_zeros and self.answer.zeros[i][j]):
            off = 0.0
        if off <= TOLERANCE:
            self.context.agreed(self.name, off)
        elif off <= self.outcome.stated_error and off <= self.stated_error(f, i):
            self.context.warned(self.name)
        else:
            what = self.asked.words(i, j, f) + self.explanation(f, i, j, exact)
            self.context.wrong(self.name, what, _text(exact), repr(got), off)

    def stated_error(self, f: float, i: int) -> float:
        """What is said about this output at this frequency alone."""
        return called(lambda: self.call(self.asked.only(i), [f])).stated_error

    def explanation(self, f: float, i: int, j: int, exact: acb) -> str:
        """What rounding the model's numbers alone would do, for the first findings of a call."""
        self.explained += 1
        if self.explained > EXPLAINED or exact == 0 or not f:
            return ""
        return f" [rounding the numbers of the model alone: {unavoidable(self.answer, f, i, j):.1g}]"


def _size(exact: acb) -> float:
    with precision(BITS):
        return float(abs(exact).mid())


def _text(exact: acb) -> str:
    with precision(BITS):
        return "0" if exact == 0 else exact.str(18, radius=False)


# --- other ways to the same values ----------------------------------------------------------------------------------


def parametric(context: Context, chance: random.Random) -> Call | None:
    """The response as a function of some numbers of the model, at their own values."""
    numbers = list(context.drivetrain.parameters) or list(_plain_numbers(context))
    if not numbers:
        return None
    chosen = chance.sample(numbers, min(2, len(numbers)))

    def call(asked: Asked, f: Sequence[float]) -> Any:
        found = parametric_response(context.drivetrain, asked.outputs, asked.inputs, f, chosen, **asked.excited)
        return found.evaluation(found.start).values

    return call


def _plain_numbers(context: Context) -> Iterator[str]:
    for part in context.mechanics.model.parts:
        for field in ("inertia", "stiffness", "damping"):
            if isinstance(part.values.get(field), Fraction):
                yield f"{part.name}.{field}"


def symbols(context: Context) -> Call:
    """Transfer functions in symbols, one at a time, with the model's own numbers put in."""
    symbolic = named(context.mechanics.model).symbolic()

    def call(asked: Asked, f: Sequence[float]) -> Any:
        source = asked.excitations[0] if asked.excitations else None
        found = [
            [symbolic.transfer_function(output, entry, source).evaluate(f).values[:, 0, 0] for entry in asked.inputs]
            for output in asked.outputs
        ]
        return np.array(found).transpose(2, 0, 1)

    return call
