"""Section of a report on critical speeds with equilibrium amplitude, generalised force, damping and peak."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import groupby

from torsionnet.base.equal_remarks import condition_words
from torsionnet.base.number_text import aligned_numbers
from torsionnet.base.phrases import phrase
from torsionnet.base.units import RPM
from torsionnet.machinery.criticals.critical_speeds import CriticalSpeed
from torsionnet.machinery.orders.damping_shares import damping_shares
from torsionnet.machinery.verdicts.governing_peaks import GoverningPeaks, line_name
from torsionnet.machinery.verdicts.order_peaks import LEAST_SHARE, OrderPeak
from torsionnet.report.document_tree import Block, Cell, Heading, NumberText, Paragraph, Picture, Section, TableBlock
from torsionnet.report.document_tree import TableGroup as Group
from torsionnet.report.limit_values import DIGITS, component, limit_number, limit_unit
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_text import as_words, first_names, symbol_or_words
from torsionnet.report.sections.separation_margins import separation_margins

MOST_SHARES = 3
"""Number of elements whose share in the damping of a mode is named."""
SMALLEST_SHARE_NAMED = 0.01
"""Share in the damping of a mode below which an element is not named, as it is rounded to nothing."""
MOST_UNJUDGED = 20
"""Largest number of critical speeds shown of a model without limits, those with the largest amplitude at resonance."""
INTRODUCTION = (
    "A critical speed is one at which an order meets a natural frequency of the damped system. The equilibrium "
    "amplitude is the angle, where the mode moves most, if the order acted at rest: generalised force over modal "
    "inertia and square of the natural frequency; at resonance it is multiplied by the magnifier, 1/(2 × damping "
    "ratio). The generalised force is the sum of the torques of the order times the relative amplitudes where they act."
)
PEAK_NOTE = (
    "Peak: amplitude of this order alone, largest near its critical speed. In per cent of the value allowed there: "
    "this order, and all together."
)
MODE_COLUMNS = (
    Heading("Mode"),
    Heading("Order"),
    Heading("Critical speed", "rpm", numeric=True),
    Heading("Equil. ampl.", "mrad", numeric=True),
    Heading("Gen. force", "kN·m", numeric=True),
    Heading("Magnifier", numeric=True),
    Heading("Damping by", wide=True),
)
"""Headings of the columns on the mode and what excites it."""


def resonances_section(subject: ReportData) -> Section | None:
    """Section of a report on critical speeds that matter; None for a model without excitations."""
    if not subject.has_excitations:
        return None
    found = subject.governing_peaks
    blocks: list[Block] = [Paragraph((INTRODUCTION,))]
    case, lines = subject.judged_cases[0], None
    if found is None:
        kept, listed = _without_limits(case)
        blocks.append(listed)
        lines = list(dict.fromkeys(f"{one.excitation} {one.line}" for one in kept))
    else:
        blocks += _with_limits(subject, found)
        if found.peaks:
            case = subject.judged_case(max(found.peaks, key=lambda one: one.share).check)
            lines = list(dict.fromkeys(map(line_name, found.peaks)))
    blocks += separation_margins(subject)
    return Section("resonances", ("Critical speeds",), (*blocks, _diagram(case, lines)))


def _with_limits(subject: ReportData, found: GoverningPeaks) -> list[Block]:
    """Sentence on which critical speeds are listed, and their table, by condition."""
    rule = phrase(
        "Listed are critical speeds at which one order alone uses at least {share:g} % of a limit, each "
        "order in the condition in which it uses most, of {count} examined; of conditions with a "
        "cylinder out only orders that are larger there. ",
        share=100 * LEAST_SHARE,
        count=len(subject.judged_cases),
    )
    rest = phrase(
        "Every other order uses less at all speeds: {names}.", names=first_names(list(map(as_words, found.others)), 30)
    )
    blocks: list[Block] = [Paragraph((rule, *([rest] if found.others else [])))]
    if not found.peaks:
        return blocks
    columns = (
        *MODE_COLUMNS,
        Heading("Most used limit"),
        Heading("Peak"),
        Heading("Order", "%", numeric=True),
        Heading("All", "%", numeric=True),
    )
    groups = []
    for configuration, some in groupby(found.peaks, key=lambda one: one.check.configuration):
        peaks = list(some)
        mode_cells = _mode_cells([one.critical for one in peaks], subject.judged_case(peaks[0].check))
        limit_cells = (_limit_cells(subject, one) for one in peaks)
        rows = tuple((*left, *right) for left, right in zip(mode_cells, limit_cells, strict=True))
        groups.append(Group(rows, condition_words(configuration) if len(subject.judged_cases) > 1 else ""))
    notes = (
        (PEAK_NOTE,),
        *([("A critical speed outside the speed range has the values of its nearer end.",)] if _beyond(found) else []),
        *_distances(subject, found),
    )
    return [*blocks, TableBlock(("Critical speeds that matter",), columns, tuple(groups), notes)]


def _distances(subject: ReportData, found: GoverningPeaks) -> list[tuple[str]]:
    """Sentence on how far the critical speeds listed lie from rated speed, the nearest of each order; or nothing."""
    speeds = subject.model.definition.speeds
    if speeds is None or not speeds.rated:
        return []
    nearest: dict[str, float] = {}
    for one in found.peaks:
        off = one.critical.speed("natural") / speeds.rated - 1
        name = line_name(one)
        if abs(off) < abs(nearest.get(name, math.inf)):
            nearest[name] = off
    closest = sorted(nearest.items(), key=lambda pair: abs(pair[1]))
    shares = [f"{100 * off:+.1f}".replace("-", "\N{MINUS SIGN}") for _, off in closest]
    each = [f"{as_words(name)} {share} %" for (name, _), share in zip(closest, shares, strict=True)]
    return [
        (
            phrase(
                "Distance of the critical speeds from rated speed, {speed:.6g} rpm: {distances}.",
                speed=speeds.rated * RPM,
                distances=", ".join(each),
            ),
        )
    ]


def _beyond(found: GoverningPeaks) -> bool:
    """Whether a critical speed lies outside the speeds examined."""
    return any(not one.check.speeds[0] <= one.critical.speed("natural") <= one.check.speeds[-1] for one in found.peaks)


def _mode_cells(some: Sequence[CriticalSpeed], case: Case) -> Iterable[tuple[Cell, ...]]:
    """Cells on mode, order, speed, amplitude, force and damping of some critical speeds in one condition."""
    shares = [_damping(case, one) for one in some]
    speeds = aligned_numbers([one.speed("natural") * RPM for one in some])
    return (
        (
            str(one.mode.number),
            as_words(line).replace(" ", "\N{NO-BREAK SPACE}"),
            speed,
            NumberText(1e3 * one.equilibrium_amplitude, DIGITS),
            NumberText(1e-3 * one.generalised_force, DIGITS),
            NumberText(one.mode.amplification, DIGITS),
            damping,
        )
        for one, line, speed, damping in zip(
            some, [f"{one.excitation} {one.line}" for one in some], speeds, shares, strict=True
        )
    )


def _damping(case: Case, one: CriticalSpeed) -> str:
    """Largest shares of elements in the damping of a mode as a text, such as "propeller 79 %, tail 12 %"."""
    found = damping_shares(case.drivetrain, one)
    named = [(name, share) for name, share in found.items() if share >= SMALLEST_SHARE_NAMED][:MOST_SHARES]
    return ", ".join(f"{as_words(name)} {100 * share:.0f}\N{NO-BREAK SPACE}%" for name, share in named)


def _limit_cells(subject: ReportData, one: OrderPeak) -> tuple[Cell, ...]:
    """Cells on the limit that an order uses most at its critical speed."""
    limit = one.verdict
    return (
        (component(limit), " ", symbol_or_words(limit.criterion)),
        (
            limit_number(one.amplitude, limit.unit, subject.conventions),
            f"\N{NO-BREAK SPACE}{limit_unit(limit.unit, subject.conventions)}",
        ),
        NumberText(100 * one.share, DIGITS),
        NumberText(100 * one.utilisation, DIGITS),
    )


def _without_limits(case: Case) -> tuple[list[CriticalSpeed], TableBlock]:
    """Critical speeds of a model without limits, those with the largest amplitudes at resonance, and their table."""
    found = case.drivetrain.critical_speeds(reach=0.2)
    acting = [one for one in found.crossings if one.excited and math.isfinite(one.resonant_amplitude)]
    largest = sorted(acting, key=lambda one: -one.resonant_amplitude)[:MOST_UNJUDGED]
    kept = sorted(largest, key=lambda one: (one.mode.number, one.speed("natural")))
    low, high = (speed * RPM for speed in found.speed_range)
    more = len(found.crossings) - len(kept)
    which = phrase(
        "Excited critical speeds up to 20 % outside {low:g} to {high:g} rpm, the largest at resonance",
        low=low,
        high=high,
    )
    notes = (
        [(phrase("{count} further crossings of a mode and an order are smaller or not excited.", count=more),)]
        if more
        else []
    )
    condition = f", {condition_words(case.configuration)}" if case.configuration else ""
    caption = phrase("Critical speeds{where}{few}", where=condition, few="")
    groups = (Group(tuple(_mode_cells(kept, case))),)
    return kept, TableBlock((caption,), MODE_COLUMNS, groups, ((f"{which}.",), *notes))


def _diagram(case: Case, lines: list[str] | None) -> Picture:
    """Interference diagram of one condition with some order lines, or with all."""
    from torsionnet.plot.interference_plot import interference_diagram

    found = case.drivetrain.critical_speeds(lines=lines)
    where = f", {condition_words(case.configuration)}" if case.configuration else ""
    orders = "orders" if lines is None else phrase("the orders listed")
    caption = (
        phrase("Interference diagram{where}: natural frequencies and {orders} over speed.", where=where, orders=orders),
    )
    return Picture("resonances", interference_diagram(found, title=""), caption, f"Interference diagram{where}")
