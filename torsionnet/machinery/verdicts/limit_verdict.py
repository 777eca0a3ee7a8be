"""Verdict on one criterion of one limit: worst speed, utilisation, speeds to be barred, and its remarks."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Annotated, ClassVar, TypeAlias

import numpy as np

from torsionnet.base.entries.spec import Schema
from torsionnet.base.errors import comma_list
from torsionnet.base.phrases import phrase
from torsionnet.base.result_rows import Out
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.orders.order_amplitudes import OrderAmplitudes
from torsionnet.machinery.verdicts.speed_spans import (
    WHOLE_RPM_RELATIVE,
    SpeedSpan,
    joined_spans,
    restriction_words,
    rpm_spans,
    spans_above,
    spans_below,
    utilisation_of,
)

# Factors of the rule of a limit, each with where it comes from, and the symbols that a rule writes.


@dataclass(frozen=True)
class RuleSymbol:
    """Symbol of a rule, with its index, its exponent, the argument at which it is taken, and whether it is a root.

    Examples
    --------
    >>> str(RuleSymbol("tau", "C", at="0.8")), str(RuleSymbol("C", "K", root=True)), str(RuleSymbol("d", power="-0.2"))
    ('tau_C(0.8)', 'sqrt(C_K)', 'd^-0.2')
    """

    letter: str
    index: str = ""
    power: str = ""
    at: str = ""
    root: bool = False

    def __str__(self) -> str:
        text = self.letter + (f"_{self.index}" if self.index else "") + (f"^{self.power}" if self.power else "")
        text += f"({self.at})" if self.at else ""
        return f"sqrt({text})" if self.root else text


RuleWords: TypeAlias = tuple[str | RuleSymbol, ...]
"""Words and formulas about a rule, symbols apart from the text between them."""


@dataclass(frozen=True)
class RuleFactor:
    """Factor of a limit's rule, in SI units, with its symbol and where it comes from.

    Attributes
    ----------
    name : tuple of str and RuleSymbol
        What it is, in words.
    symbol : RuleSymbol
        As the rule writes it, such as C_K.
    value : float
        SI units.
    unit : str
        SI unit; "1" for none.
    origin : tuple of str and RuleSymbol
        Where the value comes from: an entry of the model, or the formula or table of the rule.

    Examples
    --------
    >>> origin = ("propeller shaft, keyless taper fitting",)
    >>> RuleFactor(("design feature",), RuleSymbol("C", "K"), 0.55, "1", origin).value
    0.55
    """

    name: RuleWords
    symbol: RuleSymbol
    value: float
    unit: str
    origin: RuleWords


@dataclass(frozen=True)
class RuleText:
    """Text on the rule of a limit, with its source, its formula, what it does not cover, and its factors."""

    source: str
    formula: str
    not_covered: str
    factors: tuple[RuleFactor, ...] = ()


PASS, BARRED, REDUCED, INCOMPLETE, OPEN, FAIL = (
    "pass", "barred range", "reduced speed", "incomplete", "not judged", "fail",
)  # fmt: skip
"""Names of the verdicts on a limit, from best to gravest: it holds at every speed; outside of barred speeds; with a
cylinder out up to a lower speed than rated; at all that was examined; data are missing; it does not hold."""
GRAVITY = (PASS, BARRED, REDUCED, INCOMPLETE, OPEN, FAIL)
"""All verdicts on limits, from best to gravest."""
VERDICT: Schema = {"enum": [*GRAVITY]}
"""JSON Schema of a verdict on a limit."""
MOST_NAMES = 6
"""Largest number of configurations or limits that a sentence names; of more, the first are named."""


def gravest(verdicts: Iterable[str]) -> str:
    """Name of the gravest of some verdicts on limits, "pass" if there are none.

    Examples
    --------
    >>> gravest(["pass", "incomplete", "barred range"])
    'incomplete'
    """
    return max(verdicts, key=GRAVITY.index, default=PASS)


def listed_names(names: Sequence[str]) -> str:
    """Text that lists names of configurations or limits in a sentence, of more than MOST_NAMES only the first."""
    return comma_list(names, MOST_NAMES)


@dataclass(frozen=True, eq=False, kw_only=True)
class LimitVerdict:
    """Verdict on one criterion of one limit, with values and allowed values in SI over speed.

    Attributes
    ----------
    limit : str
        Name of the limit in the model.
    of : str
        Element, node or output that is limited.
    criterion : str
        Symbol of the allowed value, such as tau_C.
    quantity : str
        Quantity that is compared with the allowed value.
    unit : str
        SI unit.
    speeds : (n_speeds,) array
        rad/s, of the reference shaft.
    values, allowed : (n_speeds,) arrays
        ``allowed`` is NaN at speeds that the rule does not cover; both are empty if the limit could not be judged.
    verdict : {"pass", "barred range", "reduced speed", "fail", "not judged"}
    text : RuleText
    barred : tuple of SpeedSpan
        Speeds to be barred so that the limit holds at all others.
    highest : float, optional
        Highest speed permitted in rad/s, where a cylinder is out and the rated or the highest speed would be barred.
    tolerance : float
        Relative error of the tachometer that is in ``barred``.
    in_passing : bool
        Whether no speed may exceed it, not even while it is passed.
    seconds_to_pass : float, optional
        Longest time in s in which ranges in ``passed`` are to be passed.
    remarks : tuple of str
    orders : (n_speeds, n_lines) array, optional
        Amplitudes of the orders behind ``values``, each in its own worst case of excitation.
    absent : bool
        Whether the limit is not judged because its element is switched off, or its speed band is not reached.
    elsewhere : bool
        Whether that is because of the speeds.
    case : str
        Case of excitation that is worst at the worst speed; empty where all are equal.
    steady_temperature : float, optional
        Highest temperature in K by the balance of heat.
    amplitudes : OrderAmplitudes, optional
        The same amplitudes, and those in the case to which ``values`` belong.
    running : SpeedSpan, optional
        Speeds in rad/s at which the machine runs by the limit's speed band; None where it names none.
    not_free : float, optional
        Speed in rad/s that has to stay free, as for safe navigation, and does not.
    unpassed : tuple of SpeedSpan
        Speed ranges (rad/s) that the limit would bar, where another one lets nothing pass in this condition.
    free_above : float, optional
        Speed in rad/s above which the rule lets no range be barred in this condition.
    """

    SHOWN: ClassVar = (
        "limit", "of", "criterion", "quantity", "unit", "verdict", "worst_rpm", "worst_value", "worst_allowed",
        "worst_unit", "worst_utilisation", "judged_rpm", "barred_rpm", "highest_rpm", "values", "allowed",
        "text.source", "text.formula", "text.not_covered", "remarks", "restrictions",
    )  # fmt: skip

    limit: Annotated[str, Out("limit")]
    of: Annotated[str, Out("of")]
    criterion: Annotated[str, Out("criterion")]
    quantity: str
    unit: str
    speeds: FloatArray
    values: FloatArray
    allowed: Annotated[FloatArray, Out(json="allowed_over_speed")]
    verdict: Annotated[str, Out("verdict", schema=VERDICT)]
    text: RuleText
    barred: tuple[SpeedSpan, ...] = ()
    highest: float | None = None
    tolerance: float = 0.0
    in_passing: bool = False
    seconds_to_pass: float | None = None
    remarks: tuple[str, ...] = ()
    orders: FloatArray | None = None
    absent: bool = False
    elsewhere: bool = False
    case: str = ""
    steady_temperature: float | None = None
    amplitudes: OrderAmplitudes | None = None
    running: SpeedSpan | None = None
    not_free: float | None = None
    unpassed: tuple[SpeedSpan, ...] = ()
    free_above: float | None = None

    @property
    def passed(self) -> tuple[SpeedSpan, ...]:
        """Speed ranges (rad/s) barred by a limit below the highest speed permitted, to be passed without stopping."""
        return spans_below(self.barred, self.highest)

    @property
    def harmless(self) -> bool:
        """Whether what exceeds the limit does no harm while it is passed, as flicker of a generator's voltage."""
        # In its band a limit bars nothing else: what others bar lies below.
        band = self.running if self.verdict == FAIL else None
        return band is not None and any(span.high > band.low for span in self.barred)

    @cached_property
    def refused(self) -> tuple[SpeedSpan, ...]:
        """Speed ranges (rad/s) that a limit permits neither to run nor to pass: those exceeded that it does not bar."""
        if self.verdict != FAIL or not len(self.values):
            return ()
        ends = SpeedSpan(float(self.speeds[0]), float(self.speeds[-1]))
        above = spans_above(self.speeds, self.values, self.allowed)
        # A barred range may end where a refused one begins, as the window between them was closed.
        open_ones = [
            span
            for span in above
            if span not in self.barred and not any(barred.low <= span.low < barred.high for barred in self.barred)
        ]
        return joined_spans([*self.unpassed, *(span.widened(self.tolerance).within(ends) for span in open_ones)])

    @property
    def judged(self) -> tuple[SpeedSpan, ...]:
        """Speed ranges (rad/s) in which the limit was judged, which are those with a value allowed."""
        known = np.where(np.isfinite(self.allowed), 1.0, np.nan)
        return spans_above(self.speeds, known, np.zeros(len(known))) if len(known) else ()

    @property
    def judged_rpm(self) -> tuple[tuple[float, float], ...]:
        """Pairs of lowest and highest speed in rpm of the ranges in which the limit was judged."""
        return rpm_spans(self.judged)

    @property
    def restrictions(self) -> Annotated[str | None, Out("to be barred", json=None)]:
        """Text of the speeds in rpm that a limit does not permit, None if there are none."""
        return restriction_words(self.passed, self.highest) or None

    @property
    def utilisation(self) -> FloatArray:
        """Utilisation of a limit, the ratio of value to value allowed, without unit, shape (n_speeds,).

        NaN where no value is allowed.
        """
        return utilisation_of(self.values, self.allowed)

    @property
    def worst(self) -> int | None:
        """Index of the speed with the largest utilisation of a limit; None if there is none."""
        utilisation = self.utilisation
        if not np.isfinite(utilisation).any() and np.isinf(utilisation).any():
            # The largest value, as nothing is allowed.
            utilisation = np.where(np.isinf(utilisation), self.values, np.nan)
        return int(np.nanargmax(utilisation)) if np.isfinite(utilisation).any() else None

    @property
    def worst_rpm(self) -> Annotated[float | None, Out("worst speed", "rpm", digits=5)]:
        """Speed of the reference shaft in r/min with the largest utilisation of a limit; None if there is none."""
        return self._at_worst(self.speeds * RPM)

    @property
    def worst_value(self) -> Annotated[float | None, Out("value", json="value", digits=5, unit_of="unit")]:
        """Value in SI that a limit judges, at the largest utilisation; None if there is none."""
        return self._at_worst(self.values)

    @property
    def worst_allowed(self) -> Annotated[float | None, Out("allowed", json="allowed", digits=5, unit_of="unit")]:
        """Value in SI that a limit allows, at the largest utilisation; None if there is none."""
        return self._at_worst(self.allowed)

    @property
    def worst_unit(self) -> Annotated[str | None, Out("unit", json=None, unit_of="unit")]:
        """SI unit of a limit's value, None without a largest utilisation."""
        return None if self.worst is None else self.unit

    @property
    def worst_utilisation(self) -> Annotated[float | None, Out("utilisation", json="utilisation", digits=4)]:
        """Largest utilisation of a limit over speed, without unit; None if there is none, or nothing is allowed."""
        share = self._at_worst(self.utilisation)
        return share if math.isfinite(share or 0.0) else None

    def _at_worst(self, over_speed: FloatArray) -> float | None:
        return None if self.worst is None else float(over_speed[self.worst])

    @property
    def barred_rpm(self) -> tuple[tuple[float, float], ...]:
        """Pairs of lowest and highest speed in rpm of the ranges to be barred for a limit."""
        return rpm_spans(self.barred)

    @property
    def highest_rpm(self) -> float | None:
        """Highest speed permitted by a limit in rpm where a cylinder is out; None where any speed may be run."""
        return None if self.highest is None else self.highest * RPM


# Verdicts on all limits of one condition together: what one of them refuses, no other one bars or reduces.

NOT_PASSED = "{span} is not passed: in this condition no speed above {speed:.5g} rpm is permitted"
"""Remark on a range that a limit would bar, and that another one does not let be passed."""
NOT_KEPT = "another limit is not kept in this condition"
"""Remark on a limit that would hold up to a highest speed in a condition in which another limit does not hold."""


NARROWEST_WINDOW = 0.05
"""Smallest width of speeds between two ranges that are not run, over their lowest speed, in which a speed can be held.

2.5 % are what a governor of the widest class swings by at steady load (ISO 8528-5, class G1), and 2 % what a tachometer
of 1 % leaves open at both ends; together rounded up.
"""
TOO_NARROW = "barred from {low:.5g} to {high:.5g} rpm, too: no speed is held in so narrow a window"
"""Remark on a limit whose barred range was widened up to the next one."""
TOO_HIGH = "the range reaches above {speed:.5g} rpm, where no range may be barred"
"""Remark on a limit that is not kept, since its range reaches the next one only where its rule bars none."""


def without_narrow_windows(
    verdicts: Sequence[LimitVerdict], speeds: FloatArray, kept: Iterable[float | None]
) -> tuple[LimitVerdict, ...]:
    """Verdicts of one condition whose barred ranges reach up to the next range where only a narrow window is between.

    The ranges are those of all limits, whether they are passed or refused. A window with a speed in rad/s that is kept,
    as the rated one, stays open.
    """
    known = [speed for speed in kept if speed]
    ranges = _unpermitted(verdicts, speeds)
    windows = [SpeedSpan(below.high, above.low) for below, above in pairwise(ranges)]
    narrow = {
        window.low: window
        for window in windows
        if window.high <= window.low * (1 + NARROWEST_WINDOW) and not any(map(window.holds, known))
    }
    return tuple(_up_to_next(verdict, narrow) for verdict in verdicts) if narrow else tuple(verdicts)


def _up_to_next(verdict: LimitVerdict, narrow: Mapping[float, SpeedSpan]) -> LimitVerdict:
    """Verdict with barred ranges that reach to the end of narrow windows, given by the speed at which these begin."""
    closed = [narrow[span.high] for span in verdict.barred if span.high in narrow]
    if not closed:
        return verdict
    barred = joined_spans([*verdict.barred, *closed])
    said = [phrase(TOO_NARROW, low=window.low * RPM, high=window.high * RPM) for window in closed]
    top = verdict.highest
    highest = top and next((span.low for span in barred if span.holds(top)), top)
    widened = replace(verdict, barred=barred, highest=highest, remarks=(*verdict.remarks, *said))
    free = verdict.free_above
    if free is None or closed[-1].high <= free * (1 + WHOLE_RPM_RELATIVE):
        return widened
    # The window is left to be passed all the same, but the rule does not let it be barred.
    return replace(widened, verdict=FAIL, remarks=(phrase(TOO_HIGH, speed=free * RPM), *widened.remarks))


def highest_permitted(verdicts: Sequence[LimitVerdict], speeds: FloatArray) -> float | None:
    """Highest speed in rad/s below all ranges that may not be passed; None where every speed is reached.

    It is the low end of the first range that a limit refuses, joined with the barred ranges that overlap it. Where
    that is the lowest speed examined, no speed is permitted.
    """
    refused, ranges = _refused(verdicts, speeds), _unpermitted(verdicts, speeds)
    return min((barred.low for barred in ranges if any(barred.holds(span.low) for span in refused)), default=None)


def _refused(verdicts: Sequence[LimitVerdict], speeds: FloatArray) -> list[SpeedSpan]:
    """Speed ranges in rad/s that some limit lets neither run nor pass."""
    refused = [span for verdict in verdicts for span in verdict.refused]
    above = [SpeedSpan(verdict.highest, float(speeds[-1])) for verdict in verdicts if verdict.highest is not None]
    return [*refused, *above]


def _unpermitted(verdicts: Sequence[LimitVerdict], speeds: FloatArray) -> tuple[SpeedSpan, ...]:
    """Speed ranges in rad/s in which some limit permits no run, joined where they overlap."""
    barred = [span for verdict in verdicts for span in verdict.barred]
    return joined_spans([*_refused(verdicts, speeds), *barred])


def without_contradictions(verdicts: Sequence[LimitVerdict], speeds: FloatArray) -> tuple[LimitVerdict, ...]:
    """Verdicts of one condition of which none contradicts another one.

    A range barred by one limit is not passed where another one refuses that range or one below it; and no limit is
    kept by a reduced speed in a condition in which another one fails.
    """
    highest = highest_permitted(verdicts, speeds)
    if highest is None:
        return tuple(verdicts)
    # Where no speed is left, a reduced one keeps nothing.
    fails = highest <= speeds[0] or any(verdict.verdict == FAIL and verdict.refused for verdict in verdicts)
    return tuple(_settled(verdict, highest, fails=fails) for verdict in verdicts)


def _settled(verdict: LimitVerdict, highest: float, *, fails: bool) -> LimitVerdict:
    if verdict.verdict not in (BARRED, REDUCED):
        return verdict
    above = tuple(span for span in verdict.barred if span.high > highest)
    kept = tuple(span for span in verdict.barred if span not in above)
    said = [phrase(NOT_PASSED, span=span, speed=highest * RPM) for span in above]
    if fails and verdict.verdict == REDUCED:
        return replace(verdict, verdict=FAIL, barred=kept, unpassed=above, remarks=(NOT_KEPT, *verdict.remarks))
    if not above or verdict.verdict == REDUCED:
        return verdict
    if fails:
        return replace(verdict, verdict=FAIL, barred=kept, unpassed=above, remarks=(*said, *verdict.remarks))
    return replace(verdict, verdict=REDUCED, highest=above[0].low, remarks=(*said, *verdict.remarks))
