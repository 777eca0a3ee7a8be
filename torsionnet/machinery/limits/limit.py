"""Base class of limits, which name a rule and the element or output concerned, and give verdicts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, TypeVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.errors import EntryPath, Fault
from torsionnet.base.phrases import phrase
from torsionnet.base.units import expected_unit
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.limits.evidence import Evidence, LimitSubject
from torsionnet.machinery.orders.order_amplitudes import OrderAmplitudes
from torsionnet.machinery.orders.worst_response import ALL_CASES_EQUAL
from torsionnet.machinery.verdicts.limit_verdict import (
    BARRED,
    FAIL,
    OPEN,
    PASS,
    REDUCED,
    LimitVerdict,
    RuleText,
)
from torsionnet.machinery.verdicts.speed_spans import (
    SpeedSpan,
    joined_spans,
    range_end_remarks,
    spans_above,
    utilisation_of,
)
from torsionnet.model.channels import Sensor
from torsionnet.model.elements import Element

_RULES: dict[str, type[Limit]] = {}
L = TypeVar("L", bound="type[Limit]")
SHARP_PEAK_DROP = 0.1
"""Drop from a peak to its neighbours, as a share of it, above which a remark says that the peak may be higher; a
smaller share would remark on more peaks."""
UNDAMPED_STEP = 1e-6
"""Relative step of speed at which a peak that is still sharp counts as a resonance without damping."""
TOLERANCE = Value("how wrong a tachometer may be, as 2 %: ranges are wider by it", "1", below=0.2)
"""Specification of a limit's entry for the error of a tachometer."""
PASSING_TIME = Value("longest time in which a barred range is to be passed, as 10 s", "time", exclusive=True)
"""Specification of a limit's entry for the time in which the crew has to pass a barred range."""
NO_LIMIT_IN_PASSING = "no limit in passing is given; the one for continuous operation is exceeded"
"""Remark on a limit that is exceeded while speeds are passed, and of which nobody says what it bears then."""
NOT_EXAMINED = ("no lower speed was examined", "no higher speed was examined")
"""Remarks on a barred range of speeds that is cut off at the lowest or the highest speed examined."""


def register_rule(cls: L) -> L:
    """Class decorator that registers a rule of limits under its ``kind``."""
    _RULES[cls.kind] = cls
    return cls


def limit_rules() -> Mapping[str, type[Limit]]:
    """Class of every kind of limit, by the word in ``rule:``."""
    return _RULES


@dataclass(frozen=True, kw_only=True)
class Limit(Declared):
    """Base of the limits; a class of its own for each ``rule:``, registered by :func:`register_rule`."""

    article: ClassVar[str] = "a limit"

    @property
    def of(self) -> str:
        """Name of the element, node or output that is limited."""
        raise NotImplementedError

    @property
    def named(self) -> tuple[tuple[EntryPath, str, str], ...]:
        """Path, "element" or "node", and name of every entry of the limit that names an element or node."""
        raise NotImplementedError

    def fitted(self, elements: Mapping[str, Element]) -> Limit:
        """Copy of the limit with the entries that the catalogue of its element gives."""
        del elements
        return self

    def unfit(self, subject: LimitSubject) -> Iterator[Fault]:
        """Faults of a limit on a drivetrain that has every element and node it names."""
        del subject
        yield from ()

    def order_sensors(self, subject: LimitSubject) -> list[Sensor]:
        """Sensors whose orders the limit needs to judge a condition."""
        raise NotImplementedError

    def mean_sensors(self, subject: LimitSubject) -> list[Sensor]:
        """Sensors whose mean values the limit needs to judge a condition."""
        del subject
        return []

    def power_elements(self) -> list[str]:
        """Names of elements whose dissipated power the limit needs."""
        return []

    def rule_text(self, evidence: Evidence) -> RuleText:
        """Text on the source of the rule, its formula with numbers, and what it does not cover."""
        raise NotImplementedError

    def breaks(self, subject: LimitSubject) -> list[float]:
        """Speeds of the reference shaft in rad/s at which the value allowed ends, leaps or bends."""
        del subject
        return []

    def lines(self, evidence: Evidence) -> Iterator[LimitLine]:
        """Lines of values over speed with the values allowed, one for each criterion of the limit.

        Everything named is switched on.
        """
        raise NotImplementedError

    def remarks(self, line: LimitLine, evidence: Evidence) -> tuple[str, ...]:
        """Remarks of the limit on a line as a whole."""
        del line, evidence
        return ()

    def place(self, line: LimitLine, evidence: Evidence) -> str:
        """Name of the element, node or output in which a line is judged; of several the one that is used most."""
        del line, evidence
        return self.of

    def known_lines(self, evidence: Evidence) -> list[LimitLine]:
        """Lines of a condition over speed, one for each criterion of the limit.

        A line that cannot be judged says why.
        """
        off = self.switched_off(evidence.subject)
        if off:
            return [replace(line_without_data("all", f"{off} is switched off in this condition"), absent=True)]
        return list(self.lines(evidence))

    def lines_in_passing(self, evidence: Evidence) -> list[LimitLine]:
        """Lines over speeds that are only passed: of what holds in passing, else of vibration in continuous operation.

        Heat takes longer than a start, and is not among them.
        """
        known = self.known_lines(evidence)
        lasting = [line for line in known if line.why_not or (line.vibratory and line.orders is not None)]
        return [line for line in known if line.in_passing] or lasting

    def passing_sensors(self, criterion: str, subject: LimitSubject) -> tuple[list[Sensor], float] | None:
        """Sensors of which the largest half range is in the value of a criterion, and the factor from SI to its value.

        The value may have a mean part besides. None where vibration is not in it.
        """
        return self.vibratory_sensors(criterion, subject)

    def while_passed(self, line: LimitLine, name: str, evidence: Evidence) -> LimitVerdict:
        """Verdict of the limit on a line over speeds that are only passed.

        It holds, or it does not; above what continuous operation permits it is open where nothing is said of passing.
        """
        if line.why_not:
            return replace(self.open(name, evidence, line.criterion, line.why_not), absent=line.absent)
        verdict = self.peak(line, name, evidence)
        if line.in_passing or verdict.verdict == PASS:
            return verdict
        return replace(verdict, verdict=OPEN, remarks=(*verdict.remarks, NO_LIMIT_IN_PASSING))

    def verdicts(self, name: str, evidence: Evidence, lines: Sequence[LimitLine] | None = None) -> list[LimitVerdict]:
        """Verdicts of the limit on a condition, from its lines if they are given."""
        known = self.known_lines(evidence) if lines is None else lines
        return [verdict for line in known for verdict in self.judged(line, name, evidence)]

    def judged(self, line: LimitLine, name: str, evidence: Evidence) -> Iterator[LimitVerdict]:
        """Verdicts of the limit on one line over speed; none where the rule does not apply to the line."""
        if line.why_not:
            yield replace(self.open(name, evidence, line.criterion, line.why_not), absent=line.absent)
        else:
            yield self.peak(line, name, evidence) if line.in_passing else self.continuous(line, name, evidence)

    def switched_off(self, subject: LimitSubject) -> str:
        """Name of an element or node of the limit that is switched off in this condition; empty if there is none."""
        there = {"element": subject.active, "node": subject.active_nodes}
        return next((what for _, kind, what in self.named if what not in there[kind]), "")

    def open(self, name: str, evidence: Evidence, criterion: str, why: str) -> LimitVerdict:
        """Verdict that a criterion is open because data are missing."""
        empty = np.empty(0)
        return LimitVerdict(
            limit=name, of=self.of, criterion=criterion, quantity="", unit="", speeds=evidence.speeds, values=empty,
            allowed=empty, verdict=OPEN, text=self.rule_text(evidence), remarks=(why,),
        )  # fmt: skip

    def peak(self, line: LimitLine, name: str, evidence: Evidence) -> LimitVerdict:
        """Verdict of the limit on a criterion that no speed may exceed, not even while it is passed."""
        above = spans_above(evidence.speeds, line.values, line.allowed)
        over = tuple(f"exceeded from {span}" for span in above)
        return self._verdict(line, name, evidence, FAIL if above else PASS, (), over)

    @property
    def tolerance(self) -> float:
        """Relative error of the tachometer, by which barred ranges are wider on both sides."""
        return 0.0

    @property
    def of_full_load(self) -> bool:
        """Whether it allows a share of the mean values at rated speed and full load."""
        return False

    def kept_free(self, subject: LimitSubject) -> float | None:
        """Speed in rad/s that has to stay free in the subject's condition, as for safe navigation; None without one."""
        del subject
        return None

    @property
    def seconds_to_pass(self) -> float | None:
        """Longest time in s in which a barred range is to be passed; None where nothing is said."""
        return None

    def vibratory_sensors(self, criterion: str, subject: LimitSubject) -> tuple[list[Sensor], float] | None:
        """Sensors of which the largest half range is judged by a criterion, and the factor from SI to its value.

        None where it judges something else, as a mean value or power.
        """
        del criterion, subject
        return None

    def running(self, line: LimitLine, evidence: Evidence) -> SpeedSpan | None:
        """Speeds in rad/s at which the machine runs by a speed band of the limit; None where it names none."""
        del line, evidence
        return None

    def continuous(self, line: LimitLine, name: str, evidence: Evidence) -> LimitVerdict:
        """Verdict of the limit on a criterion for continuous operation.

        Speeds where it is exceeded are to be barred, if possible.

        In normal firing neither the rated nor the highest speed can be barred.
        """
        above = spans_above(evidence.speeds, line.values, line.allowed)
        wide = [span.widened(self.tolerance).within(evidence.examined) for span in above]
        # In normal firing a machine has to run at these speeds; with a cylinder out it may go slower.
        kept = [evidence.subject.rated, float(evidence.speeds[-1])]
        lost = [span for span, barred in zip(above, wide, strict=True) if barred.marks_any(kept)]
        if lost and not evidence.subject.misfiring:
            others = joined_spans([span for span in wide if not span.marks_any(kept)])
            text = phrase("exceeded from {range}: no range to be barred", range=lost[0])
            return self._verdict(line, name, evidence, FAIL, others, (text,))
        barred = joined_spans(wide)
        ends = [remark for span in barred for remark in range_end_remarks(span, evidence.examined, *NOT_EXAMINED)]
        return self._restricted(line, name, evidence, barred, kept, tuple(ends))

    def _restricted(
        self,
        line: LimitLine,
        name: str,
        evidence: Evidence,
        barred: tuple[SpeedSpan, ...],
        kept: Sequence[float | None],
        remarks: tuple[str, ...],
    ) -> LimitVerdict:
        """Verdict on a criterion that bars speeds, or that holds up to a highest speed.

        Where a cylinder is out, with a highest speed if a speed kept is barred.
        """
        highest = min((span.low for span in barred if span.marks_any(kept)), default=None)
        if highest is None or not evidence.subject.misfiring:
            return self._verdict(line, name, evidence, BARRED if barred else PASS, barred, remarks)
        if highest <= evidence.examined.low * (1 + 1e-9):
            return self._verdict(line, name, evidence, FAIL, (), ("exceeded at all speeds",))
        return replace(self._verdict(line, name, evidence, REDUCED, barred, remarks), highest=highest)

    def _verdict(
        self,
        line: LimitLine,
        name: str,
        evidence: Evidence,
        verdict: str,
        barred: tuple[SpeedSpan, ...],
        remarks: tuple[str, ...],
    ) -> LimitVerdict:
        judged = self.vibratory_sensors(line.criterion, evidence.subject)
        sensors = judged[0] if judged else self.order_sensors(evidence.subject)[:1]
        case, about_case = _worst_case(evidence, line, sensors)
        own = (*self.remarks(line, evidence), *([about_case] if case else []))
        return LimitVerdict(
            limit=name, of=self.place(line, evidence), criterion=line.criterion, quantity=line.quantity, unit=line.unit,
            speeds=evidence.speeds, values=line.values, allowed=line.allowed, verdict=verdict,
            text=self.rule_text(evidence), barred=barred,
            remarks=(*remarks, *line.remarks, *own, *_coarse(evidence, line.values)), case=case,
            orders=line.orders.largest if line.orders else None, amplitudes=line.orders,
            tolerance=self.tolerance, in_passing=line.in_passing,
            seconds_to_pass=self.seconds_to_pass, steady_temperature=line.steady_temperature,
            running=self.running(line, evidence),
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class LimitLine:
    """Values of one criterion over speed with the values allowed, each of shape (n_speeds,).

    Attributes
    ----------
    criterion, quantity, unit : str
    values, allowed : (n_speeds,) arrays
    remarks : tuple of str
    orders : OrderAmplitudes, optional
        Amplitudes of the orders behind the values.
    vibratory : bool
        Whether vibration is in the value, so that it depends on the case of excitation.
    in_passing : bool
        Whether no speed may exceed it, not even while it is passed.
    cases : (n_speeds, n_cases) array, optional
        The values of each case, of which ``values`` are the largest.
    why_not : str
        Why it cannot be judged; empty where it can.
    absent : bool
        Whether that is because what it limits is switched off in this condition.
    steady_temperature : float, optional
        Highest temperature in K by the balance of heat.
    """

    criterion: str
    quantity: str
    unit: str
    values: FloatArray
    allowed: FloatArray
    remarks: tuple[str, ...] = ()
    orders: OrderAmplitudes | None = None
    vibratory: bool = True
    in_passing: bool = False
    cases: FloatArray | None = None
    why_not: str = ""
    absent: bool = False
    steady_temperature: float | None = None

    @property
    def utilisation(self) -> FloatArray:
        """Value of the criterion over the value allowed, dimensionless, shape (n_speeds,).

        NaN where no value is allowed or the rule does not apply.
        """
        return utilisation_of(self.values, self.allowed)

    @property
    def worst(self) -> int:
        """Index of the speed at which the value allowed is used most."""
        return int(np.argmax(np.nan_to_num(self.utilisation, nan=-1.0)))

    @property
    def each(self) -> FloatArray:
        """Values of the criterion in each case of excitation, shape (n_speeds, n_cases).

        A single column where there are no cases.
        """
        return self.values[:, None] if self.cases is None else self.cases


def line_without_data(criterion: str, why: str) -> LimitLine:
    """Line of a criterion for which data are missing, with the reason."""
    return LimitLine(criterion, "", "", np.empty(0), np.empty(0), why_not=why)


def merged_line(parts: Sequence[LimitLine], order: NDArray[np.intp]) -> LimitLine:
    """Line of a criterion merged from the lines of several groups of speeds.

    ``order`` sorts their concatenated speeds.
    """
    values, allowed = (np.concatenate([getattr(part, name) for part in parts]) for name in ("values", "allowed"))
    if parts[0].why_not:
        return parts[0]
    by_case = [part.cases for part in parts if part.cases is not None]
    by_order = [part.orders for part in parts if part.orders is not None]
    return replace(
        parts[0],
        values=values[order],
        allowed=allowed[order],
        orders=OrderAmplitudes.joined(by_order, order) if by_order else None,
        cases=np.concatenate(by_case)[order] if by_case else None,
    )


def _worst_case(evidence: Evidence, line: LimitLine, sensors: Sequence[Sensor]) -> tuple[str, str]:
    """Case of excitation that is worst at the worst speed, as a misfiring cylinder, and a remark on it.

    Empty where all are equal.
    """
    if not line.vibratory:
        return "", ""
    at = line.worst
    case = evidence.worst_case(evidence.largest_of(sensors, at), at)
    return ("", "") if case == ALL_CASES_EQUAL else (case, f"worst at {evidence.run.rpm[at]:g} rpm: {case}")


def _coarse(evidence: Evidence, values: FloatArray) -> tuple[str, ...]:
    """Remark that the highest peak is so sharp that it may be higher between two speeds."""
    at = int(np.argmax(values))
    if at in (0, len(values) - 1):
        return ()
    # At a resolved maximum the neighbours are nearly as high as the top.
    beside = (values[at - 1] + values[at + 1]) / 2
    if beside >= (1 - SHARP_PEAK_DROP) * values[at]:
        return ()
    if evidence.speeds[at + 1] - evidence.speeds[at - 1] < UNDAMPED_STEP * evidence.speeds[at]:
        return (
            f"next to nothing damps the resonance at {evidence.run.rpm[at]:.6g} rpm: the value there is not bounded",
        )
    return (f"the peak at {evidence.run.rpm[at]:g} rpm is sharp; a smaller step of speeds may find it higher",)


# Check of values of one dimension in one limit that are far from each other in size, as a unit was left out.

UNIT_SLIP_RATIO = 100.0
"""Ratio of two values of one limit from which a unit was probably left out, as torques of a coupling differ less: by 10
at most, a forgotten prefix makes 1000."""
PREFIXES = {"torque": (1e3, "kN*m"), "power": (1e3, "kW"), "pressure": (1e6, "MPa")}
"""Factor and name of the unit that is likely meant in a limit, by dimension."""


def unit_slips(limit: Limit) -> Iterator[Fault]:
    """Warnings about values that are less than a hundredth of another of the same limit."""
    kin: dict[str, dict[str, float]] = {}
    for name, spec in limit.specs():
        value = getattr(limit, name)
        if isinstance(spec, Value) and spec.dimension in PREFIXES and isinstance(value, float) and value > 0:
            kin.setdefault(spec.dimension, {})[name] = value
    for dimension, values in kin.items():
        largest = max(values, key=lambda name: values[name])
        for name, value in values.items():
            if value * UNIT_SLIP_RATIO < values[largest]:
                yield _unlike(dimension, name, value, largest, values[largest])


def _unlike(dimension: str, name: str, value: float, largest: str, most: float) -> Fault:
    unit, (factor, likely) = expected_unit(dimension), PREFIXES[dimension]
    text = f"{name} of {value:g} {unit} beside {largest} of {most:g} {unit}"
    meant = f"{value:g} {likely}" if value * factor <= most * UNIT_SLIP_RATIO / 10 else ""
    text += f'; a number without unit is in {unit}: did you mean "{meant}"?' if meant else ""
    return Fault(text, (name,), "warning", meant=meant, kind="implausible-size")
