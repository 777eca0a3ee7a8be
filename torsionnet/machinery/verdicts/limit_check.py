"""Result of a check of limits with worst speed, utilisation and verdict of each criterion, and speeds to be barred."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated, ClassVar

import numpy as np

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.entries.spec import Schema, not_none
from torsionnet.base.equal_remarks import grouped_remarks
from torsionnet.base.errors import UsageError, comma_list, did_you_mean
from torsionnet.base.packages import NotebookResult
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.orders.order_amplitudes import OrderAmplitudes, SummedOrder
from torsionnet.machinery.verdicts.rule_factors import RuleText
from torsionnet.machinery.verdicts.speed_spans import (
    WHOLE_RPM_RELATIVE,
    SpeedSpan,
    in_condition,
    joined_spans,
    restriction_words,
    rpm_spans,
    spans_above,
    spans_below,
    starts_sentence,
    utilisation_of,
)

PASS, BARRED, REDUCED, INCOMPLETE, OPEN, FAIL = (
    "pass", "barred range", "reduced speed", "incomplete", "not judged", "fail",
)  # fmt: skip
"""Names of the verdicts on a limit, from best to gravest: it holds at every speed; outside of barred speeds; with a
cylinder out up to a lower speed than rated; at all that was examined; data are missing; it does not hold."""
GRAVITY = (PASS, BARRED, REDUCED, INCOMPLETE, OPEN, FAIL)
"""All verdicts on limits, from best to gravest."""

VERDICT: Schema = {"enum": [*GRAVITY]}
"""JSON Schema of a verdict on a limit."""
STARTS, STARTS_EXAMINED = "starts and stops not examined", "starts examined from {speed:g} rpm on"
"""Words in every verdict on limits: each start passes speeds below the lowest that was examined, unless a run-up is."""
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


def unexamined_sentence(missing: Sequence[str], known: Sequence[str], examined: Sequence[str]) -> list[str]:
    """List with one sentence on the configurations that were not examined; empty if none is missing.

    Examples
    --------
    >>> unexamined_sentence(["wet", "dry"], ["wet", "dry", "warm"], ["warm"])
    ['2 of 3 configurations not examined: all but warm']
    """
    if not missing:
        return []
    kept = [name for name in known if name not in missing]
    rest = kept or [name or "the model as written" for name in examined]
    names = f"all but {listed_names(rest)}" if len(kept) < len(missing) else listed_names(missing)
    text = "{count} of {all} configurations not examined: {names}"
    return [phrase(text, count=len(missing), all=len(known), names=names)]


def by_range(checks: Sequence[LimitCheck]) -> dict[tuple[float, float], list[LimitCheck]]:
    """Checks of limits by the lowest and highest speed in rpm that they examined, which configurations may change."""
    found: dict[tuple[float, float], list[LimitCheck]] = {}
    for check in checks:
        # Ten digits: the ends of one range may differ in rounding.
        low, high = (float(f"{speed:.10g}") for speed in (check.rpm[0], check.rpm[-1]))
        found.setdefault((low, high), []).append(check)
    return found


def starts_words(checks: Sequence[LimitCheck]) -> str:
    """Words in a verdict on how far starts were examined in all its conditions."""
    lows = [one.run_up.rpm[0] for one in checks if one.run_up]
    return phrase(STARTS) if len(lows) < len(checks) else phrase(STARTS_EXAMINED, speed=max(lows))


def starts_findings(checks: Sequence[LimitCheck], where: Callable[[Sequence[str]], str]) -> Iterator[str]:
    """Sentences on the starts of all conditions; ``where`` makes the end of a sentence of names of configurations."""
    known = [one for one in checks if one.run_up]
    if len(known) < len(checks):
        yield starts_sentence(max(one.rpm[0] for one in checks if not one.run_up), checks[0].reference)
    found: dict[str, list[str]] = {}
    for one in known:
        for sentence in run_up_sentences(not_none(one.run_up)):
            found.setdefault(sentence, []).append(one.configuration)
    yield from (phrase("{sentence}{where}", sentence=text, where=where(names)) for text, names in found.items())


def run_up_sentences(found: RunUpCheck) -> Iterator[str]:
    """Sentences on a run-up: what does not hold, what nobody says, else that all limits in passing hold."""
    (low, high), verdict = found.rpm, found.verdict
    about = {"low": low, "high": high, "shaft": found.reference, "load": 100 * found.load}
    for grave, template in ((FAIL, FAILS_IN_PASSING), (OPEN, OPEN_IN_PASSING)):
        names = found.names(grave)
        if names:
            yield phrase(template, limits=listed_names(names), **about)
    if verdict == PASS:
        yield phrase(HOLDS_IN_PASSING, **about)


FAILS_IN_PASSING = "starts from {low:g} to {high:g} rpm of {shaft} at {load:g} % load: {limits} not kept in passing"
OPEN_IN_PASSING = "starts from {low:g} to {high:g} rpm of {shaft} at {load:g} % load: {limits} not judged in passing"
HOLDS_IN_PASSING = "starts from {low:g} to {high:g} rpm of {shaft} at {load:g} % load: the limits in passing hold"
"""Findings on a run-up."""


def listed_names(names: Sequence[str]) -> str:
    """Text that lists names of configurations or limits in a sentence, of more than MOST_NAMES only the first."""
    return comma_list(names, MOST_NAMES)


ALL_HOLD = "all limits hold{where} at the speeds examined, {low:g} to {high:g} rpm of {shaft}"
ALL_EXAMINED_HOLD = "the limits examined hold{where} at the speeds examined, {low:g} to {high:g} rpm of {shaft}"
"""Findings where no limit restricts the speeds: of all limits, and where some were left out."""


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
    """

    SHOWN: ClassVar = (
        "limit", "of", "criterion", "quantity", "unit", "verdict", "worst_rpm", "worst_value", "worst_allowed",
        "worst_unit", "worst_utilisation", "barred_rpm", "highest_rpm", "values", "allowed", "text.source",
        "text.formula", "text.not_covered", "remarks", "restrictions",
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

    @property
    def passed(self) -> tuple[SpeedSpan, ...]:
        """Speed ranges (rad/s) barred by a limit below the highest speed permitted, to be passed without stopping."""
        return spans_below(self.barred, self.highest)

    @cached_property
    def refused(self) -> tuple[SpeedSpan, ...]:
        """Speed ranges (rad/s) that a limit permits neither to run nor to pass: those exceeded that it does not bar."""
        if self.verdict != FAIL or not len(self.values):
            return ()
        ends = SpeedSpan(float(self.speeds[0]), float(self.speeds[-1]))
        above = spans_above(self.speeds, self.values, self.allowed)
        open_ones = [span for span in above if not any(one.low <= span.low <= one.high for one in self.barred)]
        return joined_spans([span.widened(self.tolerance).within(ends) for span in open_ones])

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
        found = self.utilisation
        if not np.isfinite(found).any() and np.isinf(found).any():
            found = np.where(np.isinf(found), self.values, np.nan)  # the largest value, as nothing is allowed
        return int(np.nanargmax(found)) if np.isfinite(found).any() else None

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
        found = self._at_worst(self.utilisation)
        return found if math.isfinite(found or 0.0) else None

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
        return gravest(one.verdict for one in self.verdicts)

    @property
    def worst(self) -> PassedLimit | None:
        """Verdict with the largest utilisation in the run-up; None where nothing is known."""
        known = [one for one in self.verdicts if one.utilisation is not None]
        return max(known, key=lambda one: one.utilisation or 0.0, default=None)

    def names(self, verdict: str) -> list[str]:
        """Names of the limits with a verdict in the run-up, each once."""
        return list(dict.fromkeys(one.steady.limit for one in self.verdicts if one.verdict == verdict))


@dataclass(frozen=True, eq=False)
class LimitPoint:
    """Value and value allowed in SI of one criterion of a limit at one speed in rpm."""

    limit: Annotated[str, Out("limit")]
    of: Annotated[str, Out("of")]
    criterion: Annotated[str, Out("criterion")]
    speed: Annotated[float, Out("speed", "rpm")]
    value: Annotated[float, Out("value")]
    allowed: Annotated[float, Out("allowed")]
    unit: Annotated[str, Out("unit")]
    utilisation: Annotated[float, Out("utilisation")]


@dataclass(frozen=True, eq=False, repr=False)
class LimitCheck(NotebookResult):
    """Verdicts on all limits of a model in one configuration, over speeds in rad/s.

    Attributes
    ----------
    speeds : (n_speeds,) array
        Speeds of the reference shaft, rad/s: those asked for and those added to resolve peaks and crossings.
    reference : str
        Node of the reference shaft.
    verdicts : tuple of LimitVerdict
    lines : tuple of str
        Names of the orders in ``LimitVerdict.orders``.
    title, configuration : str
    misfiring : bool
        Whether a cylinder misfires in this condition.
    notes : tuple of str
    configurations : tuple of str
        All configurations of the model.
    others : tuple of str
        Configurations that this check is not about.
    left_out : tuple of str
        Limits and excitations that were left out, in words.
    run_up : RunUpCheck, optional
        Verdicts in passing over the speeds of a start; None where the model has no run-up.
    summed : tuple of SummedOrder
        Orders as a test measures them: the sums of those in ``lines`` that have one frequency.
    cases : tuple of str
        Names of the cases of excitation, such as misfires, by their index in ``LimitVerdict.amplitudes``.
    rated : float, optional
        Rated speed of the reference shaft in rad/s.
    propels : bool
        Whether the machinery propels a ship, so that its crew sees the speeds on a tachometer.
    """

    picture: ClassVar[str] = "limit_check"

    speeds: FloatArray
    reference: Annotated[str, Out(json="speed_of")]
    verdicts: Annotated[tuple[LimitVerdict, ...], Out(json="limits")]
    lines: tuple[str, ...] = ()
    title: str = ""
    configuration: str = ""
    misfiring: bool = False
    notes: tuple[str, ...] = field(default=())
    configurations: tuple[str, ...] = ()
    others: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    run_up: Annotated[RunUpCheck | None, Out(optional=True)] = None
    summed: tuple[SummedOrder, ...] = ()
    cases: tuple[str, ...] = ()
    rated: float | None = None
    propels: bool = False

    @property
    def rpm(self) -> Annotated[FloatArray, Out(json="speeds_rpm")]:
        """Speeds of the reference shaft in r/min, shape (n_speeds,)."""
        return np.asarray(self.speeds * RPM)

    @property
    def verdict(self) -> Annotated[str, Out(schema=VERDICT)]:
        """Name of the gravest of all verdicts on the limits in one configuration, such as "pass" or "fail".

        "incomplete" instead of one that permits operation if no configuration was chosen although there are some.
        """
        found = [one.verdict for one in self._concerned]
        found += [self.run_up.verdict] if self.run_up else []
        return gravest([*found, *([INCOMPLETE] if self.others and not self.configuration else [])])

    @property
    def _concerned(self) -> list[LimitVerdict]:
        """Verdicts on limits that concern the speeds of this configuration, where others may concern the rest."""
        here = [one for one in self.verdicts if not one.elsewhere]
        return here if here and self.others else list(self.verdicts)

    @property
    def barred(self) -> tuple[SpeedSpan, ...]:
        """Speed ranges in rad/s to be barred by any limit in one configuration, joined where they overlap."""
        return joined_spans([span for one in self.verdicts for span in one.barred])

    @property
    def barred_rpm(self) -> tuple[tuple[float, float], ...]:
        """Pairs of lowest and highest speed in rpm of the ranges to be barred in one configuration."""
        return rpm_spans(self.barred)

    @cached_property
    def highest(self) -> float | None:
        """Highest speed in rad/s below all ranges that may not be passed; None where every speed is reached.

        It is the low end of the first range that a limit refuses, joined with the barred ranges that overlap it. Where
        that is the lowest speed examined, no speed is permitted.
        """
        top = float(self.speeds[-1])
        refused = [span for one in self.verdicts for span in one.refused]
        refused += [SpeedSpan(one.highest, top) for one in self.verdicts if one.highest is not None]
        ranges = joined_spans([*refused, *self.barred])
        return min((one.low for one in ranges if any(one.holds(span.low) for span in refused)), default=None)

    def permits(self, speed: float) -> bool:
        """Whether a speed in rad/s is reached and may be kept in this configuration."""
        return (self.highest is None or speed < self.highest) and not any(span.holds(speed) for span in self.barred)

    @property
    def restriction(self) -> str:
        """Text of the speeds in rpm that the limits do not permit in one configuration, empty where all are."""
        if self.highest is not None and self.highest <= self.speeds[0] * (1 + WHOLE_RPM_RELATIVE):
            return phrase("no speed of {shaft} is permitted", shaft=self.reference)
        return restriction_words(self.passed, self.highest, phrase(" of {shaft}", shaft=self.reference))

    @property
    def passed(self) -> tuple[SpeedSpan, ...]:
        """Speed ranges (rad/s) barred by any limit below the highest speed permitted, to be passed without stopping."""
        return spans_below(self.barred, self.highest)

    @property
    def conclusion(self) -> str:
        """Sentence that concludes from all verdicts on limits in one configuration, with what was not examined."""
        return joined("; ", self.findings)

    @property
    def findings(self) -> tuple[str, ...]:
        """Texts that conclude from all verdicts on limits, on what was not examined and on what was found."""
        missing = unexamined_sentence(self.others, self.configurations, [self.configuration])
        where = phrase(" in {names}", names=self.configuration or "the model as written") if self.others else ""
        return (*missing, *self.left_out, *starts_findings([self], lambda _: ""), self.finding(where))

    def finding(self, where: str = "") -> str:
        """Sentence that concludes on the limits in one configuration, in which ``where`` names the configuration."""
        failed = list(dict.fromkeys(one.limit for one in self.verdicts if one.verdict == FAIL))
        unjudged = list(dict.fromkeys(one.limit for one in self._concerned if one.verdict == OPEN))
        template = "{limit} do not hold{where}" if len(failed) > 1 else "{limit} does not hold{where}"
        parts = [phrase(template, limit=", ".join(failed), where=where)] if failed else []
        if self.highest is not None:
            parts.append(in_condition(self.restriction, "" if failed else where.removeprefix(" in ")))
        elif self.barred:
            template = "to be barred: {speeds}" if failed else "limits hold with {speeds} barred{where}"
            parts.append(phrase(template, speeds=self.restriction, where=where))
        if unjudged:
            parts.append(phrase("{limit} not judged{where}", limit=", ".join(unjudged), where="" if parts else where))
        if parts:
            return joined("; ", parts)
        template = ALL_EXAMINED_HOLD if self.left_out else ALL_HOLD
        return phrase(template, where=where, low=self.rpm[0], high=self.rpm[-1], shaft=self.reference)

    def of(self, limit: str, criterion: str | None = None) -> LimitVerdict:
        """Verdict on a limit by its name, or on one of its criteria if it has several.

        Raises
        ------
        UsageError
            There is no such limit, or it has several criteria and none is named.
        """
        found = [one for one in self.verdicts if one.limit == limit and criterion in (None, one.criterion)]
        if len(found) == 1:
            return found[0]
        known = [f"{one.limit} {one.criterion}" for one in self.verdicts]
        asked = f"{limit} {criterion}" if criterion else limit
        what = f"say which criterion of {limit}" if found else f'no limit "{asked}"{did_you_mean(asked, known)}'
        raise UsageError(f"{what}; there are {', '.join(known)}")

    def table(self, conventions: Conventions = SI) -> Table:
        """Table of limits with a row for each criterion at its worst speed in rpm, and the rules as notes."""
        notes = [f"speeds of {self.reference}, {self.rpm[0]:g} to {self.rpm[-1]:g} rpm", *self.notes]
        said = ((f"{one.limit}, {one.criterion}", "", text) for one in self.verdicts for text in one.remarks)
        notes += [f"{'; '.join(abouts)}: {text}" for abouts, _, text in grouped_remarks(said)]
        for text, names in self.texts().items():
            notes += [f"{', '.join(names)}: {text.source}", f"  {text.formula}", f"  not covered: {text.not_covered}"]
        columns = (
            "limit", "of", "criterion", "worst_rpm", "worst_value", "worst_allowed", "worst_unit", "worst_utilisation",
            "verdict", "restrictions",
        )  # fmt: skip
        title = f"{self.title}: limits"
        return result_table(title, self.verdicts, LimitVerdict, columns, conventions, tuple(dict.fromkeys(notes)))

    def texts(self) -> dict[RuleText, list[str]]:
        """Lists of the names of the limits, by the text of their rule."""
        found: dict[RuleText, list[str]] = {}
        for one in self.verdicts:
            names = found.setdefault(one.text, [])
            names += [] if one.limit in names else [one.limit]
        return found

    def long_table(self) -> Table:
        """Table of value, allowed value (SI) and utilisation of each criterion of the limits at every speed in rpm."""
        rows = [
            LimitPoint(one.limit, one.of, one.criterion, rpm, value, allowed, one.unit, share)
            for one in self.verdicts
            if len(one.values)
            for rpm, value, allowed, share in np.stack([self.rpm, one.values, one.allowed, one.utilisation]).T.tolist()
        ]
        notes = (f"speeds of {self.reference}",)
        return result_table(f"{self.title}: limits over speed", rows, LimitPoint, notes=notes)
