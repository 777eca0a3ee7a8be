"""Result of a check of all limits in one configuration, with what they permit in passing at every start."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated, ClassVar

import numpy as np

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.entries.spec import not_none
from torsionnet.base.equal_remarks import grouped_remarks
from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.packages import SavedResult
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.orders.order_amplitudes import SummedOrder
from torsionnet.machinery.verdicts.limit_verdict import (
    FAIL,
    INCOMPLETE,
    OPEN,
    PASS,
    VERDICT,
    LimitVerdict,
    RuleText,
    gravest,
    highest_permitted,
    listed_names,
)
from torsionnet.machinery.verdicts.speed_spans import (
    WHOLE_RPM_RELATIVE,
    SpeedSpan,
    in_condition,
    joined_spans,
    restriction_words,
    rpm_spans,
    spans_below,
    starts_sentence,
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


# Result of a check of all limits in one configuration, with its verdict, speeds to be barred and conclusion.

STARTS, STARTS_EXAMINED = (
    "starts and stops not examined", "starts examined from {speed:g} rpm on, stops not examined",
)  # fmt: skip
"""Words in every verdict on limits: each start passes speeds below the lowest that was examined, unless a run-up is."""


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


def by_range(checks: Sequence[LimitCheck], *, running: bool = False) -> dict[tuple[float, float], list[LimitCheck]]:
    """Checks of limits by the lowest and highest speed in rpm that they examined, which configurations may change.

    With ``running`` those between which the machine runs, where limits have a speed band.
    """
    by_ends: dict[tuple[float, float], list[LimitCheck]] = {}
    for check in checks:
        examined = SpeedSpan(float(check.speeds[0]), float(check.speeds[-1]))
        ((first, last),) = rpm_spans([(check.running if running else None) or examined])
        # Ten digits: the ends of one range may differ in rounding.
        low, high = (float(f"{speed:.10g}") for speed in (first, last))
        by_ends.setdefault((low, high), []).append(check)
    return by_ends


def band_findings(checks: Sequence[LimitCheck], where: Callable[[Sequence[str]], str]) -> Iterator[str]:
    """Sentences on limits that were judged in their speed bands alone, as the machine only passes other speeds.

    ``where`` makes the end of a sentence of names of configurations.
    """
    configurations: dict[str, list[str]] = {}
    for check in checks:
        for sentence in _band_sentences(check):
            configurations.setdefault(sentence, []).append(check.configuration)
    yield from (
        phrase("{sentence}{where}", sentence=text, where=where(names)) for text, names in configurations.items()
    )


def _band_sentences(check: LimitCheck) -> Iterator[str]:
    """Sentences on the speeds in which limits with a speed band were judged, where more speeds were examined."""
    limits_by_span: dict[SpeedSpan, list[str]] = {}
    ends = SpeedSpan(float(check.speeds[0]), float(check.speeds[-1]))
    for verdict in check.verdicts:
        if not verdict.running or not verdict.judged or verdict.running == ends:
            continue
        # Where no speed of the band is permitted, the machine runs below it: those speeds are judged, too.
        if verdict.judged[0].low >= verdict.running.low * (1 - WHOLE_RPM_RELATIVE):
            limits_by_span.setdefault(verdict.judged[0], []).append(f"{verdict.limit} {verdict.criterion}")
    for span, names in limits_by_span.items():
        low, high = span.low * RPM, span.high * RPM
        yield phrase(IN_BAND, low=low, high=high, shaft=check.reference, limits=listed_names(names))


def starts_words(checks: Sequence[LimitCheck]) -> str:
    """Words in a verdict on how far starts were examined in all its conditions."""
    lows = [check.run_up.rpm[0] for check in checks if check.run_up]
    return phrase(STARTS) if len(lows) < len(checks) else phrase(STARTS_EXAMINED, speed=max(lows))


def starts_findings(checks: Sequence[LimitCheck], where: Callable[[Sequence[str]], str]) -> Iterator[str]:
    """Sentences on the starts of all conditions; ``where`` makes the end of a sentence of names of configurations."""
    known = [check for check in checks if check.run_up]
    if len(known) < len(checks):
        yield starts_sentence(max(check.rpm[0] for check in checks if not check.run_up), checks[0].reference)
    configurations: dict[str, list[str]] = {}
    for check in known:
        for sentence in run_up_sentences(not_none(check.run_up)):
            configurations.setdefault(sentence, []).append(check.configuration)
    yield from (
        phrase("{sentence}{where}", sentence=text, where=where(names)) for text, names in configurations.items()
    )


IN_BAND = "{limits} judged in the speed band alone, {low:.6g} to {high:.6g} rpm of {shaft}"
"""Finding on limits that hold in a speed band."""
ALL_HOLD = "all limits hold{where} at the speeds examined, {low:g} to {high:g} rpm of {shaft}"
ALL_EXAMINED_HOLD = "the limits examined hold{where} at the speeds examined, {low:g} to {high:g} rpm of {shaft}"
"""Findings where no limit restricts the speeds: of all limits, and where some were left out."""


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
class LimitCheck(SavedResult):
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
        verdicts = [judged.verdict for judged in self._concerned]
        verdicts += [self.run_up.verdict] if self.run_up else []
        return gravest([*verdicts, *([INCOMPLETE] if self.others and not self.configuration else [])])

    @property
    def _concerned(self) -> list[LimitVerdict]:
        """Verdicts on limits that concern the speeds of this configuration, where others may concern the rest."""
        here = [verdict for verdict in self.verdicts if not verdict.elsewhere]
        return here if here and self.others else list(self.verdicts)

    @property
    def barred(self) -> tuple[SpeedSpan, ...]:
        """Speed ranges in rad/s to be barred by any limit in one configuration, joined where they overlap."""
        return joined_spans([span for verdict in self.verdicts for span in verdict.barred])

    @property
    def barred_rpm(self) -> tuple[tuple[float, float], ...]:
        """Pairs of lowest and highest speed in rpm of the ranges to be barred in one configuration."""
        return rpm_spans(self.barred)

    @cached_property
    def highest(self) -> float | None:
        """Highest speed in rad/s below all ranges that may not be passed; None where every speed is reached.

        Where that is the lowest speed examined, no speed is permitted.
        """
        return highest_permitted(self.verdicts, self.speeds)

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
    def running(self) -> SpeedSpan | None:
        """Speeds in rad/s at which the machine runs by the speed bands of limits; None where there are none.

        Where no speed of them is permitted, it runs below, and there is none either.
        """
        bands = [verdict.running for verdict in self.verdicts if verdict.running]
        low = min((band.low for band in bands), default=0.0)
        high = max((band.high for band in bands), default=0.0)
        reached = self.highest is None or self.highest > low * (1 + WHOLE_RPM_RELATIVE)
        return SpeedSpan(low, high) if bands and reached else None

    @property
    def permitted(self) -> tuple[SpeedSpan, ...]:
        """Speed ranges (rad/s) at which the machine may be run in one configuration, as far as they are examined."""
        low, high = float(self.speeds[0]), float(self.speeds[-1] if self.highest is None else self.highest)
        running = self.running or SpeedSpan(low, high)
        edges = [low, *(edge for span in self.passed for edge in (span.low, span.high)), high]
        spans = [SpeedSpan(*pair).within(running) for pair in zip(edges[::2], edges[1::2], strict=True)]
        return tuple(span for span in spans if span.high > span.low)

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
        return (
            *missing,
            *self.left_out,
            *starts_findings([self], lambda _: ""),
            *band_findings([self], lambda _: ""),
            self.finding(where),
        )

    def finding(self, where: str = "") -> str:
        """Sentence that concludes on the limits in one configuration, in which ``where`` names the configuration."""
        failed = list(dict.fromkeys(verdict.limit for verdict in self.verdicts if verdict.verdict == FAIL))
        unjudged = list(dict.fromkeys(verdict.limit for verdict in self._concerned if verdict.verdict == OPEN))
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
        named = [
            verdict for verdict in self.verdicts if verdict.limit == limit and criterion in (None, verdict.criterion)
        ]
        if len(named) == 1:
            return named[0]
        known = [f"{verdict.limit} {verdict.criterion}" for verdict in self.verdicts]
        asked = f"{limit} {criterion}" if criterion else limit
        what = f"say which criterion of {limit}" if named else f'no limit "{asked}"{did_you_mean(asked, known)}'
        raise UsageError(f"{what}; there are {', '.join(known)}", kind="unknown-name")

    def table(self, conventions: Conventions = SI) -> Table:
        """Table of limits with a row for each criterion at its worst speed in rpm, and the rules as notes."""
        notes = [f"speeds of {self.reference}, {self.rpm[0]:g} to {self.rpm[-1]:g} rpm", *self.notes]
        said = (
            (f"{verdict.limit}, {verdict.criterion}", "", text) for verdict in self.verdicts for text in verdict.remarks
        )
        notes += [f"{'; '.join(abouts)}: {text}" for abouts, _, text in grouped_remarks(said)]
        for text, names in self.texts().items():
            notes += [f"{', '.join(names)}: {text.source}", f"  {text.formula}"]
            notes += [f"  not covered: {text.not_covered}"] if text.not_covered else []
        columns = (
            "limit", "of", "criterion", "worst_rpm", "worst_value", "worst_allowed", "worst_unit", "worst_utilisation",
            "verdict", "restrictions",
        )  # fmt: skip
        title = f"{self.title}: limits"
        return result_table(title, self.verdicts, LimitVerdict, columns, conventions, tuple(dict.fromkeys(notes)))

    def texts(self) -> dict[RuleText, list[str]]:
        """Lists of the names of the limits, by the text of their rule."""
        limits_by_text: dict[RuleText, list[str]] = {}
        for verdict in self.verdicts:
            names = limits_by_text.setdefault(verdict.text, [])
            names += [] if verdict.limit in names else [verdict.limit]
        return limits_by_text

    def long_table(self) -> Table:
        """Table of value, allowed value (SI) and utilisation of each criterion of the limits at every speed in rpm."""
        rows = [
            LimitPoint(verdict.limit, verdict.of, verdict.criterion, rpm, value, allowed, verdict.unit, share)
            for verdict in self.verdicts
            if len(verdict.values)
            for rpm, value, allowed, share in np.stack(
                [self.rpm, verdict.values, verdict.allowed, verdict.utilisation]
            ).T.tolist()
        ]
        notes = (f"speeds of {self.reference}",)
        return result_table(f"{self.title}: limits over speed", rows, LimitPoint, notes=notes)
