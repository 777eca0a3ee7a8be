"""Verdicts on what limits permit in passing, over the speeds that every start passes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from torsionnet.base.phrases import phrase
from torsionnet.base.result_rows import Out
from torsionnet.base.units import RPM
from torsionnet.machinery.verdicts.limit_verdict import (
    FAIL,
    OPEN,
    PASS,
    VERDICT,
    LimitVerdict,
    gravest,
    listed_names,
)


def run_up_sentences(check: RunUpCheck) -> Iterator[str]:
    """Sentences on a run-up: what does not hold, what nobody says, else that all limits in passing hold."""
    (low, high), verdict = check.rpm, check.verdict
    about = {"low": low, "high": high, "shaft": check.reference, "load": 100 * check.load}
    for grave, template in ((FAIL, FAILS_IN_PASSING), (OPEN, OPEN_IN_PASSING)):
        names = check.names(grave)
        if names:
            yield phrase(template, limits=listed_names(names), **about)
    if verdict == PASS:
        yield phrase(HOLDS_IN_PASSING, **about)


FAILS_IN_PASSING = "starts from {low:g} to {high:g} rpm of {shaft} at {load:g} % load: {limits} not kept in passing"
OPEN_IN_PASSING = "starts from {low:g} to {high:g} rpm of {shaft} at {load:g} % load: {limits} not judged in passing"
HOLDS_IN_PASSING = "starts from {low:g} to {high:g} rpm of {shaft} at {load:g} % load: the limits in passing hold"
"""Findings on a run-up."""


@dataclass(frozen=True, eq=False)
class PassedLimit:
    """Verdict on one criterion of a limit while a start passes the speeds of a run-up.

    Attributes
    ----------
    steady : LimitVerdict
        By the vibration that each speed would have if it lasted.
    rising : float, optional
        Largest value in SI while the speed rises at the rate of the run-up; where the steady one holds, or no rate is
        given, it is not calculated.
    rising_rpm : float, optional
        Speed in r/min at which that is reached.
    """

    SHOWN: ClassVar = ("steady.limit", "steady.of", "steady.criterion", "verdict", "rpm", "value", "allowed",
                       "steady.unit", "utilisation", "steady_value")  # fmt: skip

    steady: LimitVerdict
    rising: float | None = None
    rising_rpm: float | None = None

    @property
    def rpm(self) -> Annotated[float | None, Out("speed", "rpm", digits=5)]:
        """Speed in r/min of the value that decides."""
        return self.steady.worst_rpm if self.rising is None else self.rising_rpm

    @property
    def value(self) -> Annotated[float | None, Out("value", digits=5, unit_of="steady.unit")]:
        """Value in SI that decides: while the speed rises, else as if each speed lasted."""
        return self.steady.worst_value if self.rising is None else self.rising

    @property
    def steady_value(self) -> Annotated[float | None, Out("steady", digits=5, unit_of="steady.unit")]:
        """Value in SI as if each speed lasted; None where it is not known."""
        return self.steady.worst_value

    @property
    def allowed(self) -> Annotated[float | None, Out("allowed", digits=5, unit_of="steady.unit")]:
        """Value in SI that is allowed at the speed of the value that decides."""
        if self.rising_rpm is None:
            return self.steady.worst_allowed
        return float(np.interp(self.rising_rpm, self.steady.speeds * RPM, self.steady.allowed))

    @property
    def utilisation(self) -> Annotated[float | None, Out("utilisation", digits=4)]:
        """Value over value allowed, without unit; None where it is not known."""
        return None if self.value is None or self.allowed is None else self.value / self.allowed

    @property
    def verdict(self) -> Annotated[str, Out("verdict", schema=VERDICT)]:
        """Name of the verdict: "pass", "fail", or "not judged" where nobody says what is permitted in passing."""
        if self.rising is not None and self.utilisation is not None and self.utilisation <= 1:
            return PASS
        return self.steady.verdict


@dataclass(frozen=True, eq=False)
class RunUpCheck:
    """Verdicts on what the limits permit in passing, over the speeds that every start passes, in one configuration.

    Attributes
    ----------
    low, high : float
        Ends of the run-up in rad/s.
    reference : str
        Node of the reference shaft.
    load : float
        Share of the rated load.
    rate : float, optional
        Rise of the speed in rad/s^2.
    verdicts : tuple of PassedLimit
    """

    SHOWN: ClassVar = ("rpm", "load", "rate", "verdict", "verdicts")

    low: float
    high: float
    reference: str
    load: Annotated[float, Out("load")]
    rate: Annotated[float | None, Out("rate", "rad/s^2")]
    verdicts: Annotated[tuple[PassedLimit, ...], Out(json="limits")]

    @property
    def rpm(self) -> Annotated[tuple[float, float], Out(json="speeds_rpm")]:
        """Lowest and highest speed of the run-up in r/min."""
        return self.low * RPM, self.high * RPM

    @property
    def verdict(self) -> Annotated[str, Out(schema=VERDICT)]:
        """Name of the gravest verdict on a limit in the run-up."""
        return gravest(passed.verdict for passed in self.verdicts)

    @property
    def worst(self) -> PassedLimit | None:
        """Verdict with the largest utilisation in the run-up; None where nothing is known."""
        known = [passed for passed in self.verdicts if passed.utilisation is not None]
        return max(known, key=lambda passed: passed.utilisation or 0.0, default=None)

    def names(self, verdict: str) -> list[str]:
        """Names of the limits with a verdict in the run-up, each once."""
        return list(dict.fromkeys(passed.steady.limit for passed in self.verdicts if passed.verdict == verdict))
