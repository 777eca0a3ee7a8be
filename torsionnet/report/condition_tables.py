"""Tables of a report on critical speeds and peaks by condition: the normal one whole, of others what differs."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from itertools import groupby

from torsionnet.base.entries.spec import not_none
from torsionnet.base.number_text import NumberText
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.units import RPM
from torsionnet.machinery.criticals.critical_speeds import CriticalSpeed
from torsionnet.machinery.limits.shaft_limit import in_all_words
from torsionnet.machinery.orders.operating_groups import damping_shares
from torsionnet.machinery.orders.order_amplitudes import SummedOrder
from torsionnet.machinery.verdicts.condition_peaks import ConditionPeaks, JudgedCritical, JudgedPoint, SumPeak
from torsionnet.machinery.verdicts.limit_check import LimitCheck
from torsionnet.machinery.verdicts.limit_verdict import LimitVerdict
from torsionnet.machinery.verdicts.order_peaks import LEAST_SHARE, SMALL_SHARE, largest_orders
from torsionnet.report.critical_remarks import beside_range, cancelling_sources, notes_on_criticals, places_beside
from torsionnet.report.document_tree import Cell, Heading, Paragraph, TableBlock, Text
from torsionnet.report.document_tree import TableGroup as Group
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_text import DIGITS, as_words, criterion_cell, limit_number, limit_unit

SAME_VALUE = 0.05
"""Relative difference up to which values of two conditions count as the same: readings on board differ by as much."""
MOST_ROWS = 40
"""Largest number of critical speeds of the normal condition in the table, those of which the limits are used most."""
MOST_SHARES, SMALLEST_SHARE_NAMED = 3, 0.05
"""Number of elements whose share in the damping of a mode is named, and the share below which they are summed up."""
MOST_ORDERS = 3
"""Number of largest orders that are named at a peak."""
WORST = "worst"
"""Mark of the condition in which a limit is used most at a peak, of all conditions."""
GENERAL_CRITERIA = {"continuous", "in passing", "tau_W"} | in_all_words("tau_C") | in_all_words("tau_T")
"""Criteria that need no name beside their component, as the headings of the table say them."""
COMMON = (
    Heading("Critical speed", "rpm", numeric=True),
    Heading("Equil. ampl.", "mrad", numeric=True),
    Heading("Gen. force", "kN·m", numeric=True),
    Heading("Magnifier", numeric=True),
)
VALUES = (
    Heading("Peak at", "rpm", numeric=True),
    Heading("Order alone", numeric=True),
    Heading("All orders", numeric=True),
    Heading("Allowed", numeric=True),
    Heading("In passing", numeric=True),
)
NO_CRITICAL = "No order of note meets a natural frequency within the speeds examined."
SUM_NOTE = (
    "Peaks of the sum are its local maxima; the order named makes it, as its amplitude drops most beside it. Orders of "
    "several sources at one frequency are given as their sum, as measured."
)
PHASES = (
    "In brackets the phase of each order in the sum, cos(h φ + phase) of order h with φ the angle of the shaft of its "
    "excitation; 0 at (firing) top dead centre of the first cylinder."
)
"""Note below the table of components in the normal condition on the phases of orders."""


def normal_criticals(subject: ReportData) -> TableBlock | Paragraph:
    """Table of all critical speeds of the normal condition in the range of speeds, grouped by mode.

    A sentence where there is none.
    """
    peaks, case = not_none(subject.normal_peaks), subject.normal_case
    inside = [record for record in peaks.criticals if record.point is not None]
    strong = [record for record in inside if record.share >= SMALL_SHARE]
    ranked = sorted(strong, key=lambda record: -record.share)[:MOST_ROWS]
    shown = [record for record in inside if record in ranked] or inside[:MOST_ROWS]
    if not shown:
        return Paragraph((joined(" ", [NO_CRITICAL, *beside_range(peaks, shown)]),))
    columns = (
        Heading("Order"), *COMMON, Heading("Damping by", wide=True), Heading("Component"), *VALUES,
        Heading("Used at peak", "%", numeric=True), Heading("At rated", "%", numeric=True),
    )  # fmt: skip
    groups = []
    for mode, some in groupby(shown, key=lambda record: record.critical.mode.number):
        records = list(some)
        title = phrase(
            "Mode {number}, undamped {frequency:.5g} Hz",
            number=mode,
            frequency=records[0].critical.mode.undamped_frequency,
        )
        damping = _damping_cells(case, records)
        rows = (
            _normal_row(subject, record, summed, damping[record.critical.natural_speed])
            for record, summed in _with_sums(records)
        )
        groups.append(Group(tuple(rows), title))
    caption = phrase("Critical speeds in normal operation{where}", where=_where(case))
    return without_empty(
        TableBlock((caption,), columns, tuple(groups), tuple(notes_on_criticals(subject, peaks, shown)))
    )


def _with_sums(records: Sequence[JudgedCritical]) -> Iterator[tuple[JudgedCritical, SummedOrder | None]]:
    """Yield records of one mode, and behind those of one frequency the one of the larger order with their sum.

    What a test measures is the sum of the lines of one frequency.
    """
    for number, record in enumerate(records):
        yield record, None
        summed = next(those for those in not_none(record.point).check.summed if record.line in those.places)
        own = [other for other in records if other.line in summed.places and other.key[0] == record.key[0]]
        if len(own) > 1 and all(other not in own for other in records[number + 1 :]):
            yield max(own, key=lambda other: other.share), summed


def _damping_cells(case: Case, records: Sequence[JudgedCritical]) -> dict[float, str]:
    """Cells with the shares in the damping of one mode, by critical speed; between two that agree all are equal."""
    each = {record.critical.natural_speed: record.critical for record in records}
    known = {speed: damping_cell(case, each[speed]) for speed in dict.fromkeys((min(each), max(each)))}
    alike = known[min(each)] if known[min(each)] == known[max(each)] else None
    return {speed: known.get(speed) or alike or damping_cell(case, critical) for speed, critical in each.items()}


def _normal_row(
    subject: ReportData, record: JudgedCritical, summed: SummedOrder | None, damping: str
) -> tuple[Cell, ...]:
    """Row of a critical speed in the normal condition, or of a sum of orders at the peak of the largest of them."""
    rated = math.nan if record.rated is None else 100 * record.rated.utilisation
    return (
        _unbroken(as_words(summed.name if summed else record.name)),
        *_common(record, summed),
        "" if summed else damping,
        *_values(subject, record, summed),
        NumberText(100 * record.utilisation, DIGITS),
        NumberText(rated, DIGITS),
    )


def further_criticals(subject: ReportData) -> TableBlock | Paragraph | None:
    """Table of critical speeds in further conditions, where they differ by more than 5 % from the normal condition.

    A sentence where they differ outside of the speeds examined alone, None where none does.
    """
    first = not_none(subject.normal_peaks).criticals
    normal = {record.key: record for record in first}
    kept = [
        (
            peaks,
            [record for record in peaks.criticals if _matters(record) and not _alike(record, normal.get(record.key))],
        )
        for peaks in subject.further_peaks
    ]
    # The worst of each order at each mode, the normal condition among all others.
    worst = _worst(record for records in (first, *(those for _, those in kept)) for record in records)
    columns = (
        Heading("Order"), *COMMON, Heading("Component"), Heading("Case"), *VALUES,
        Heading("Used at peak", "%", numeric=True), Heading("Worst"),
    )  # fmt: skip
    groups = []
    for peaks, records in kept:
        rows = []
        for record, summed in _with_sums(records):
            component, *values = _values(subject, record, summed)
            order = as_words(summed.name if summed else record.name)
            named = phrase("{order}, mode {mode}", order=order, mode=record.critical.mode.number)
            mark = WORST if record in worst and not summed else ""
            used, case = NumberText(100 * record.utilisation, DIGITS), as_words(not_none(record.point).case)
            rows.append((named, *_common(record, summed), component, case, *values, used, mark))
        if rows:
            groups.append(Group(tuple(rows), subject.titles.of(peaks.check.configuration)))
    beside = tuple((note,) for note in _beside_in(subject))
    if not groups:
        return Paragraph((joined(" ", [note for (note,) in beside]),)) if beside else None
    rule = phrase(
        "Listed where one order uses {share:g} % of a limit or more and a value differs by more than {same:g} % from "
        "normal operation; conditions that differ less from another one are left out.",
        share=100 * LEAST_SHARE,
        same=100 * SAME_VALUE,
    )
    template = "{order}, mode {mode}"
    usual = [
        phrase(template, order=as_words(record.name), mode=record.critical.mode.number)
        for record in first
        if record in worst and _matters(record)
    ]
    rest = phrase("Normal operation is the worst of all conditions at {names}.", names=joined("; ", usual))
    listed = [record for _, records in kept for record in records]
    notes = ((rule,), *([(rest,)] if usual else []), *((note,) for note in cancelling_sources(listed)), *beside)
    return without_empty(TableBlock(("Critical speeds in further conditions",), columns, tuple(groups), notes))


def _beside_in(subject: ReportData) -> Iterator[str]:
    """Yield sentences on critical speeds outside of the speeds examined in further conditions, whose flank matters.

    Conditions with the same ones have one sentence.
    """
    usual = {record.key for record in not_none(subject.normal_peaks).criticals if record.point is None}
    conditions_beyond: dict[tuple[bool, str], list[str]] = {}
    for peaks in subject.further_peaks:
        largest = max((record.critical.resonant_amplitude for record in peaks.criticals), default=0.0)
        beyond = [
            record
            for record in peaks.criticals
            if record.point is None
            and record.key not in usual
            and record.critical.resonant_amplitude >= LEAST_SHARE * largest
        ]
        for passed_and_names in places_beside(peaks, beyond):
            conditions_beyond.setdefault(passed_and_names, []).append(peaks.check.configuration)
    for (passed, names), conditions in conditions_beyond.items():
        where = subject.titles.several(conditions, subject.model.configurations)
        text = "In {conditions}, beside the range and not examined: {names}."
        if passed:
            text = "In {conditions}, beside the range, passed and judged by starts alone: {names}."
        yield phrase(text, conditions=where, names=names)


def _worst(records: Iterator[JudgedCritical]) -> list[JudgedCritical]:
    """Records in which each order uses a limit most at each of its modes, of all conditions."""
    worst: dict[tuple[int, str], JudgedCritical] = {}
    for record in records:
        known = worst.get(record.key)
        if record.point is not None and (known is None or record.utilisation > known.utilisation):
            worst[record.key] = record
    return list(worst.values())


def _matters(record: JudgedCritical) -> bool:
    return record.is_peak and record.share >= LEAST_SHARE


def _alike(record: JudgedCritical, other: JudgedCritical | None) -> bool:
    """Whether a critical speed and its peak agree with those of another condition within ``SAME_VALUE``."""
    if other is None or record.point is None or other.point is None:
        return False
    pairs = [
        (record.critical.natural_speed, other.critical.natural_speed),
        (record.critical.generalised_force, other.critical.generalised_force),
        (record.critical.mode.amplification, other.critical.mode.amplification),
        (record.amplitude, other.amplitude),
        (record.utilisation, other.utilisation),
    ]
    same_place = record.point.verdict.limit == other.point.verdict.limit
    return same_place and all(same_value(*pair) for pair in pairs)


def same_value(value: float, other: float) -> bool:
    """Whether two values agree within ``SAME_VALUE``."""
    return bool(abs(value - other) <= SAME_VALUE * abs(other)) or (math.isnan(value) and math.isnan(other))


def _common(record: JudgedCritical, summed: SummedOrder | None) -> tuple[Cell, ...]:
    """Cells on speed, equilibrium amplitude, generalised force and magnifier; of a sum of orders on speed alone."""
    critical = record.critical
    speed = NumberText(critical.natural_speed * RPM, 4, 1)
    if summed:
        return speed, "", "", ""
    return (
        speed,
        NumberText(1e3 * critical.equilibrium_amplitude, DIGITS),
        NumberText(1e-3 * critical.generalised_force, DIGITS),
        NumberText(critical.mode.amplification, DIGITS),
    )


def _values(subject: ReportData, record: JudgedCritical, summed: SummedOrder | None) -> tuple[Cell, ...]:
    """Cells on the component that an order, or a sum of orders, uses most: name, speed, values and values allowed."""
    point = not_none(record.point)
    sizes = (point.order(summed.places if summed else (record.line,)), point.value, point.continuous, point.in_passing)
    return (
        component_cell(subject, point.verdict),
        NumberText(point.rpm if record.is_peak else math.nan, 4, 1),
        *(limit_number(size, point.verdict.unit, subject.conventions) for size in sizes),
    )


def component_cell(subject: ReportData, verdict: LimitVerdict, *, with_unit: bool = True) -> Text:
    """Cell with the name of a limit, its criterion where that is no general one, and the unit of its values."""
    unit = f", {limit_unit(verdict.unit, subject.conventions)}" if with_unit else ""
    named = () if verdict.criterion in GENERAL_CRITERIA else (" ", criterion_cell(verdict.criterion))
    return (as_words(verdict.limit), *named, *([unit] if unit else []))


def damping_cell(case: Case, critical: CriticalSpeed) -> str:
    """Largest shares of elements in the damping of a mode as a text, such as "propeller 79 %, others 21 %"."""
    shares = damping_shares(case.drivetrain, critical)
    named = [(name, share) for name, share in shares.items() if share >= SMALLEST_SHARE_NAMED][:MOST_SHARES]
    if not shares:
        return ""
    texts = [f"{as_words(name)} {100 * share:.0f}\N{NO-BREAK SPACE}%" for name, share in named]
    rest = 100 * (sum(shares.values()) - sum(share for _, share in named))
    more = [phrase("others {share:.0f} %", share=rest)] if rest >= 1 else []
    return joined(", ", [*texts, *more])


def _unbroken(text: str) -> str:
    """Text in which no line breaks within the name of an order."""
    return " + ".join(part.replace(" ", "\N{NO-BREAK SPACE}") for part in text.split(" + "))


def _where(case: Case) -> str:
    return f", {case.title}" if case.title else ""


def without_empty(block: TableBlock) -> TableBlock:
    """Table without the columns in which no row has anything."""
    rows = [row for group in block.groups for row in group.rows]
    used = [place for place, _ in enumerate(block.columns) if any(map(_is_given, (row[place] for row in rows)))]
    groups = tuple(
        Group(tuple(tuple(row[at] for at in used) for row in group.rows), group.title) for group in block.groups
    )
    return TableBlock(block.caption, tuple(block.columns[at] for at in used), groups, block.notes, block.more)


def _is_given(cell: Cell) -> bool:
    return (
        cell.value is not None and math.isfinite(cell.value) if isinstance(cell, NumberText) else cell not in ("", ())
    )


# Tables of the peaks of the sum of all orders, by component.

LEAST_USE_ELSEWHERE = 0.5
"""Utilisation from which on a peak of the sum in a further condition is listed."""


def normal_response(subject: ReportData) -> TableBlock | None:
    """Table of every component in the normal condition, at rated speed and at the peaks of the sum of all orders.

    None without a limit on vibration.
    """
    peaks = not_none(subject.normal_peaks)
    columns = (Heading("Component"), Heading("Place"), *_response_columns())
    rows: list[tuple[Cell, ...]] = []
    for verdict, those in _by_component(peaks):
        points: list[tuple[str, JudgedPoint, str]] = []
        if peaks.rated is not None:
            points.append((phrase("rated speed"), JudgedPoint(peaks.points, verdict, peaks.rated), ""))
        points += [(phrase("peak" if peak.is_peak else "largest, no peak"), peak.point, maker(peak)) for peak in those]
        rows += [
            (
                component_cell(subject, verdict, with_unit=False),
                place,
                *_response_cells(subject, point, made, phases=True),
            )
            for place, point, made in points
        ]
    if not rows:
        return None
    where = _where(subject.normal_case)
    caption = phrase("Components in normal operation{where}", where=where)
    return without_empty(TableBlock((caption,), columns, (Group(tuple(rows)),), ((SUM_NOTE,), (PHASES,))))


def further_response(subject: ReportData) -> TableBlock | None:
    """Table of the peaks of the sum of all orders in further conditions that differ from the normal one; or None."""
    further = subject.further_peaks
    known = [*not_none(subject.normal_peaks).sums]
    kept: dict[int, list[SumPeak]] = {}
    every = [(place, peak) for place, peaks in enumerate(further) for peak in peaks.sums]
    # The most used first, so that it stands for others that are as large.
    for place, peak in sorted(every, key=lambda pair: -pair[1].point.utilisation):
        if peak.point.utilisation >= LEAST_USE_ELSEWHERE and not any(_alike_peaks(peak, other) for other in known):
            known.append(peak)
            kept.setdefault(place, []).append(peak)
    columns = (Heading("Component"), *_response_columns())
    groups = [
        Group(
            tuple(
                (component_cell(subject, peak.point.verdict, with_unit=False),
                 *_response_cells(subject, peak.point, maker(peak)))
                for peak in further[place].sums if peak in kept[place]
            ),
            subject.titles.of(further[place].check.configuration),
        )
        for place in sorted(kept)
    ]  # fmt: skip
    rule = phrase(
        "Listed where a limit is used by {use:g} % or more, and by over {same:g} % otherwise than in normal operation "
        "and in conditions listed.",
        use=100 * LEAST_USE_ELSEWHERE,
        same=100 * SAME_VALUE,
    )
    caption = ("Peaks of the sum of all orders in further conditions",)
    return without_empty(TableBlock(caption, columns, tuple(groups), ((rule,),))) if groups else None


def _by_component(peaks: ConditionPeaks) -> Iterator[tuple[LimitVerdict, list[SumPeak]]]:
    """Yield each criterion of vibration in continuous operation at the speeds of the peaks, with its peaks."""
    for verdict in peaks.points.verdicts:
        if verdict.orders is not None and not verdict.in_passing and len(verdict.values):
            name = verdict.limit, verdict.criterion
            yield (
                verdict,
                [peak for peak in peaks.sums if (peak.point.verdict.limit, peak.point.verdict.criterion) == name],
            )


def maker(peak: SumPeak) -> str:
    """Text with the order and mode that make a peak of the sum; the order alone where no mode is near."""
    if peak.mode is None:
        return as_words(peak.order)
    return phrase("{order}, mode {mode}", order=as_words(peak.order), mode=peak.mode)


def _response_columns() -> tuple[Heading, ...]:
    return (
        Heading("Speed", "rpm", numeric=True),
        Heading("Value", numeric=True),
        Heading("Allowed", numeric=True),
        Heading("In passing", numeric=True),
        Heading("Unit"),
        Heading("Used", "%", numeric=True),
        Heading("Made by"),
        Heading("Case"),
        Heading("Largest orders there", wide=True),
    )


def _response_cells(subject: ReportData, point: JudgedPoint, made: str, *, phases: bool = False) -> tuple[Cell, ...]:
    sizes = (point.value, point.continuous, point.in_passing)
    return (
        NumberText(point.rpm, 4, 1),
        *(limit_number(size, point.verdict.unit, subject.conventions) for size in sizes),
        limit_unit(point.verdict.unit, subject.conventions),
        NumberText(100 * point.utilisation, DIGITS),
        made,
        as_words(point.case),
        orders_cell(subject, point.check, point.verdict, point.at, phases=phases),
    )


def condition_cell(subject: ReportData, check: LimitCheck, case: str) -> str:
    """Text with the title of a condition and the case of excitation in it, "misfire, full: misfire of cylinder 4"."""
    chosen = subject.titles.of(check.configuration).split(", ")
    lead = ", ".join(title for title in chosen if not title or not case.startswith(title))
    return joined(": ", [text for text in (lead, case) if text])


def orders_cell(subject: ReportData, check: LimitCheck, verdict: LimitVerdict, at: int, *, phases: bool = False) -> str:
    """Text with the largest orders at one speed in the unit of a limit, such as "engine 6: 46.3", also with phases."""
    texts = []
    for name, size in largest_orders(check, verdict, at, MOST_ORDERS):
        number = limit_number(abs(size), verdict.unit, subject.conventions)
        phase = f" ({NumberText(math.degrees(cmath.phase(size)), 3, 0)}°)" if phases else ""
        texts.append(f"{as_words(name)}: {number}{phase}")
    return "; ".join(texts)


def _alike_peaks(peak: SumPeak, other: SumPeak) -> bool:
    """Whether two peaks of the sum are those of one component at one speed and of one size, within ``SAME_VALUE``."""
    first, second = peak.point, other.point
    named = [(point.verdict.limit, point.verdict.criterion) for point in (first, second)]
    return (
        named[0] == named[1] and same_value(first.rpm, second.rpm) and same_value(first.utilisation, second.utilisation)
    )
