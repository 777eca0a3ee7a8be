"""Calls of the package with all that they say, and how far a value is from the exact one."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf, isfinite
from typing import Any

from flint import acb

import torsionnet as tn
from oracle.exact import ball, precision
from oracle.solution import Mechanics
from oracle.tally import Finding, Tally

TOLERANCE = 1e-9
TOLERANCES = {"symbols": 1e-7}
"""Of quantities that are known less well: numbers put into an expression lose digits where its terms cancel."""
HONEST = 10
"""A stated error may be exceeded by this factor: it is an estimate."""
OTHER_DOUBTS = ("infinite", "did not settle")
"""Words of warnings that are not about digits."""
BITS = 512


def tolerance_of(quantity: str) -> float:
    return TOLERANCES.get(quantity, TOLERANCE)


@dataclass(frozen=True)
class Context:
    """One model under comparison."""

    seed: str
    mechanics: Mechanics
    drivetrain: tn.Drivetrain
    tally: Tally

    def wrong(self, quantity: str, what: str, exact: str = "", got: str = "", deviation: float = inf) -> None:
        self.tally.wrong(Finding(self.seed, quantity, what, exact, got, deviation), tolerance_of(quantity))

    def agreed(self, quantity: str, deviation: float, count: int = 1) -> None:
        self.tally.agreed(self.seed, quantity, deviation, tolerance_of(quantity), count)

    def warned(self, quantity: str) -> None:
        self.tally.excused(self.seed, quantity, tolerance_of(quantity))

    def refused(self, quantity: str) -> None:
        self.tally.excused(self.seed, quantity, tolerance_of(quantity), refused=True)


@dataclass(frozen=True)
class Outcome:
    """A value or an error, and the warnings: those of the package, and those of others that slipped through."""

    value: Any
    error: Exception | None
    warned: Sequence[str]
    stray: Sequence[str]

    @property
    def is_refused(self) -> bool:
        return isinstance(self.error, tn.TorsionnetError)

    @property
    def says_infinite(self) -> bool:
        return any("infinite" in text for text in self.warned)

    @property
    def stated_error(self) -> float:
        """The relative error that the warnings allow: 0 without one about digits, infinite where none is named."""
        about_digits = [text for text in self.warned if not any(word in text for word in OTHER_DOUBTS)]
        named = [re.search(r"(?:known to|worst by) ([\d.]+(?:e[+-]?\d+)?) of", text) for text in about_digits]
        return max((HONEST * float(match[1]) if match else inf for match in named), default=0.0)


def called(function: Callable[[], Any]) -> Outcome:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            value, error = function(), None
        except Exception as problem:  # noqa: BLE001  (whatever it is, it is a finding)
            value, error = None, problem
    own = [str(w.message) for w in caught if issubclass(w.category, tn.TorsionnetWarning)]
    stray = [f"{w.category.__name__}: {w.message}" for w in caught if not issubclass(w.category, tn.TorsionnetWarning)]
    return Outcome(value, error, own, stray)


def failed(context: Context, quantity: str, outcome: Outcome, about: str = "") -> bool:
    """Note an error, and warnings that nobody wrote on purpose."""
    for text in outcome.stray:
        context.wrong(quantity, f"{text} {about}")
    if outcome.error is not None:
        context.wrong(quantity, f"{type(outcome.error).__name__}: {outcome.error} {about}")
    return outcome.error is not None


def deviation(got: complex, exact: acb, scale: acb | None = None) -> float:
    """Relative to the exact value; where that is zero to ``scale``, or infinite for any other number."""
    if not (isfinite(got.real) and isfinite(got.imag)):
        return inf
    with precision(BITS):
        reference = abs(exact) if exact != 0 else abs(acb(0) if scale is None else scale)
        if reference == 0:
            return 0.0 if got == 0 else inf
        return float((abs(acb(ball(got.real), ball(got.imag)) - exact) / reference).mid())
