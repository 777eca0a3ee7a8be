"""Section of a report on critical speeds with amplitude, force, damping and peak, and what assumed values move."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

from torsionnet.base.number_text import aligned_numbers
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.units import RPM
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.sensitivity.sensitivities_of_modes import ModeSensitivities, mode_sensitivities
from torsionnet.machinery.criticals.critical_speeds import CriticalSpeed
from torsionnet.machinery.verdicts.limit_verdict import listed_names
from torsionnet.machinery.verdicts.order_peaks import LEAST_SHARE, SMALL_SHARE
from torsionnet.report.condition_tables import damping_cell, further_criticals, normal_criticals
from torsionnet.report.document_tree import (
    Block,
    Cell,
    Details,
    Heading,
    NumberText,
    Paragraph,
    Picture,
    Section,
    TableBlock,
    TableGroup,
)
from torsionnet.report.document_tree import TableGroup as Group
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_orders import highest_orders
from torsionnet.report.report_tables import results_table, table
from torsionnet.report.report_text import (
    DIGITS,
    as_words,
    distinct_choices,
    in_clauses,
    shared_choices,
    symbol_or_words,
)
from torsionnet.report.sections.natural_frequencies import holzer_block

if TYPE_CHECKING:
    from torsionnet.base.table import Table
    from torsionnet.machinery.criticals.critical_speeds import CriticalSpeeds
    from torsionnet.machinery.orders.order_line import OrderLine


# Table of a report on what moves critical speeds where values that were assumed are off by their tolerance.

SAME_FREQUENCY = 1e-3
"""Relative difference up to which a mode at its critical speed is that of the operating point, where derivatives hold;
beyond, the mode follows the speed and is left out."""
LEAST_MOVED, LEAST_DAMPED = 5e-4, 5e-3
"""Relative change of a natural frequency, and of a magnifier, from which on a value has a row."""
ROUNDED = 1e-6
"""Relative change below which 0 is printed: what rounding leaves of a derivative."""
COLUMNS = (
    Heading("Value"),
    Heading("Tolerance", "%", numeric=True),
    Heading("Natural frequency", "%", numeric=True),
    Heading("Magnifier", "%", numeric=True),
    Heading("Critical speeds [rpm]", wide=True),
)
NOTE = (
    "Changes where the value is larger by its tolerance, from exact derivatives; where it is smaller they are the "
    "other way. Together: root of the sum of squares, as for values that do not depend on each other."
)


def assumed_values(case: Case, criticals: Sequence[CriticalSpeed]) -> TableBlock | None:
    """Table of how far each value with a tolerance moves critical speeds and magnifiers, grouped by mode.

    None where no value has a tolerance, or none moves any of these modes.
    """
    drivetrain = case.drivetrain
    tolerances = {
        name: parameter.tolerance for name, parameter in drivetrain.parameter_definitions.items() if parameter.tolerance
    }
    met = [critical for critical in criticals if math.isfinite(critical.natural_speed)]
    if not tolerances or not met:
        return None
    sensitivities = mode_sensitivities(drivetrain, list(tolerances))
    groups = []
    for mode, some in groupby(met, key=lambda critical: critical.mode.number):
        # Each crossing once.
        own = list(
            {(critical.excitation, critical.line, critical.natural_speed): critical for critical in some}.values()
        )
        rows = _rows(sensitivities, tolerances, own)
        if rows:
            title = "Mode {number}, undamped {frequency:.5g} Hz"
            frequency = own[0].mode.undamped_frequency
            groups.append(TableGroup(tuple(rows), phrase(title, number=mode, frequency=frequency)))
    if not groups:
        return None
    where = f", {case.title}" if case.title else ""
    caption = phrase("What values that were assumed move by their tolerance{where}", where=where)
    return TableBlock((caption,), COLUMNS, tuple(groups), ((NOTE,),))


def _rows(
    sensitivities: ModeSensitivities, tolerances: dict[str, float], criticals: Sequence[CriticalSpeed]
) -> list[tuple[Cell, ...]]:
    """Rows of one mode, a value each, and what all of them move together; none where the mode follows the speed."""
    frequency = criticals[0].mode.natural_frequency
    off = abs(sensitivities.natural_frequencies / frequency - 1)
    place = int(off.argmin())
    if off[place] > SAME_FREQUENCY:
        return []
    shares = list(tolerances.values())
    # df/f = (d ln f/d ln p) dp/p, and Q = 1/(2 zeta): dQ/Q = -d zeta/zeta.
    moved: FloatArray = sensitivities.relative_frequencies[place] * shares
    swung: FloatArray = -sensitivities.relative_dampings[place] * shares
    rows: list[tuple[Cell, ...]] = []
    for name, share, change, other in zip(tolerances, shares, moved.tolist(), swung.tolist(), strict=True):
        if abs(change) >= LEAST_MOVED or abs(other) >= LEAST_DAMPED:
            rows.append(row(symbol_or_words(name), NumberText(100 * share, 3), (change, other), criticals))
    if len(rows) > 1:
        both = math.hypot(*moved), math.hypot(*swung)
        rows.append(row(phrase("together"), "", both, criticals))
    return rows


def row(
    name: Cell, tolerance: Cell, moved: tuple[float, float], criticals: Sequence[CriticalSpeed]
) -> tuple[Cell, ...]:
    texts = []
    for critical in criticals if abs(moved[0]) >= LEAST_MOVED else ():
        # An order meets a frequency f = h n + f_0 of its own at n, so that dn = df/h.
        frequency = critical.mode.natural_frequency
        follows = frequency / (frequency - critical.fixed) if critical.fixed else 1.0
        speed = critical.natural_speed * RPM
        template = "{order}: {speed:.1f} ± {moved:.1f}"
        order = as_words(f"{critical.excitation} {critical.line}")
        texts.append(phrase(template, order=order, speed=speed, moved=abs(speed * moved[0] * follows)))
    changes = (NumberText(100 * change if abs(change) >= ROUNDED else 0.0, 3) for change in moved)
    return (name, tolerance, *changes, "; ".join(texts))


# Section of a report on critical speeds with equilibrium amplitude, generalised force, damping and peak.

# Section of a report on critical speeds, with crossings of orders and modes and Holzer tables.

MOST_DRAWN, MOST_HOLZER_TABLES = 3, 4
"""Largest number of drivetrains whose interference diagram is drawn, and of modes whose Holzer table is printed."""
MOST_ROWS = 30
"""Largest number of crossings of orders and modes in a table of the report; of more, those with the largest generalised
force are kept."""
LEFT_OUT_COLUMNS = ("on its shaft", "amplifi- cation")
"""Headings of columns that the report leaves out, as a page has no room for them."""
CROSSINGS = (
    "A critical speed is one at which an order meets a natural frequency. Damping shifts natural frequencies: both the "
    "undamped and the damped one are given. A crossing that is not excited in one condition may be in another, as with "
    "a misfire."
)


def critical_speeds_section(subject: ReportData) -> Section | None:
    """Section of a report on critical speeds, at which orders meet natural frequencies.

    None for a model without excitations.
    """
    if not subject.has_excitations:
        return None
    blocks: list[Block] = [Paragraph((CROSSINGS, *subject.coverage_note))]
    for number, cases in enumerate(subject.distinct_drivetrains, 1):
        blocks += _of_drivetrain(cases, number, several=len(subject.distinct_drivetrains) > 1)
    return Section("critical_speeds", ("Critical speeds",), tuple(blocks))


def _of_drivetrain(cases: tuple[Case, ...], number: int, *, several: bool) -> list[Block]:
    """Tables and diagram of critical speeds of one drivetrain, with the conditions that excite each crossing."""
    names = [case.configuration for case in cases]
    runs = [
        replace(case.drivetrain.critical_speeds(), condition=distinct_choices(case.configuration, names))
        for case in cases
    ]
    speeds = runs[0].in_conditions(runs) if len(runs) > 1 else runs[0]
    where = phrase(" in configuration {name}", name=shared_choices(names)) if several and names[0] else ""
    excited, others = _split(speeds, len(runs))
    blocks: list[Block] = [
        results_table(_reached(speeds), phrase("Natural frequencies without and with damping{where}", where=where))
    ]
    if number <= MOST_DRAWN:
        blocks.append(_crossings_diagram(speeds, number, where))
    chosen = _largest(excited, runs)
    few = (
        phrase(", the {count} with the largest generalised force", count=MOST_ROWS)
        if len(excited.crossings) > MOST_ROWS
        else ""
    )
    blocks.append(results_table(_narrow(chosen), phrase("Critical speeds{where}{few}", where=where, few=few)))
    if others.crossings:
        rest = results_table(
            _narrow(_largest(others, runs)),
            phrase("Crossings that no condition here excites{where}", where=where),
            notes=False,
        )
        count = len(others.crossings)
        instead = (phrase("{count} further crossings are not excited in these conditions.", count=count),)
        blocks.append(Details(("Crossings that are not excited",), (rest,), instead))
    if number == 1:
        blocks += _holzer_tables(cases[0], excited)
    return blocks


def _reached(speeds: CriticalSpeeds) -> Table:
    """Table of modes up to the highest that any order meets, and one more; of overdamped modes those that are met."""
    met = {critical.mode.number for critical in speeds.crossings}
    swings = [mode.number for mode in speeds.modes if not math.isnan(mode.natural_frequency)]
    last = max(met.intersection(swings), default=MOST_HOLZER_TABLES) + 1
    kept = tuple(mode for mode in speeds.modes if mode.number in met or (mode.number in swings and mode.number <= last))
    return replace(speeds, modes=kept).mode_table()


def _largest(speeds: CriticalSpeeds, runs: Sequence[CriticalSpeeds]) -> CriticalSpeeds:
    """Critical speeds with the largest generalised force in any condition, in the order of modes."""
    forces: dict[tuple[object, ...], float] = {}
    for critical in (critical for run in runs for critical in run.crossings):
        forces[_place(critical)] = max(forces.get(_place(critical), 0.0), _force(critical))
    sizes = sorted((forces[_place(critical)] for critical in speeds.crossings), reverse=True)
    least = sizes[MOST_ROWS - 1] if len(sizes) >= MOST_ROWS else 0.0
    return replace(
        speeds, crossings=tuple(critical for critical in speeds.crossings if forces[_place(critical)] >= least)
    )


def _force(critical: CriticalSpeed) -> float:
    """Generalised force of a crossing in N m, infinite for an imposed motion, which has none and is never left out."""
    return math.inf if math.isnan(critical.generalised_force) else critical.generalised_force


def _place(critical: CriticalSpeed) -> tuple[object, ...]:
    return critical.mode.number, critical.excitation, critical.order, critical.fixed


def _narrow(speeds: CriticalSpeeds) -> Table:
    table = speeds.table()
    return table.chosen([index for index, column in enumerate(table.columns) if column.name not in LEFT_OUT_COLUMNS])


def _split(speeds: CriticalSpeeds, conditions: int) -> tuple[CriticalSpeeds, CriticalSpeeds]:
    """Critical speeds that some condition excites, and critical speeds that none excites."""
    acts = [
        critical.excited is not False or (conditions > 1 and bool(critical.excited_in)) for critical in speeds.crossings
    ]
    pairs = list(zip(speeds.crossings, acts, strict=True))
    return (
        replace(speeds, crossings=tuple(critical for critical, excited in pairs if excited)),
        replace(speeds, crossings=tuple(critical for critical, excited in pairs if not excited)),
    )


def _crossings_diagram(speeds: CriticalSpeeds, number: int, where: str) -> Picture:
    from torsionnet.plot.interference_plot import interference_diagram

    caption = (phrase("Interference diagram{where}: natural frequencies and orders over speed.", where=where),)
    alt = f"Interference diagram{where}: {len(speeds.modes)} modes, {len(speeds.crossings)} crossings"
    return Picture(f"interference_{number}", interference_diagram(speeds, title=""), caption, alt)


def _holzer_tables(case: Case, excited: CriticalSpeeds) -> list[Block]:
    """Holzer tables of the lowest modes that any excitation reaches."""
    modes = sorted({critical.mode.number for critical in excited.crossings})[:MOST_HOLZER_TABLES]
    return [holzer_block(case.drivetrain.holzer_table(mode), "N/mm^2") for mode in modes]


# Table of a report with the separation margins of a train from shaft speeds and electrical frequencies.


def separation_margins(subject: ReportData) -> list[Block]:
    """Tables of the margins of low modes from multiples of speeds, line frequencies and all orders, by drivetrain.

    Empty unless the report's ``rules`` name a rule of separation margins and the model has speeds.
    """
    several = len(subject.distinct_drivetrains) > 1
    return [_margins(margins, cases, several=several) for cases, margins in subject.separation_margins]


def _margins(margins: CriticalSpeeds, cases: tuple[Case, ...], *, several: bool) -> TableBlock:
    where = (
        phrase(" in configuration {name}", name=shared_choices([case.configuration for case in cases]))
        if several
        else ""
    )
    columns = (
        Heading("Mode"),
        Heading("Natural frequency", "Hz", numeric=True),
        Heading("Compared with"),
        Heading("From", "Hz", numeric=True),
        Heading("To", "Hz", numeric=True),
        Heading("Margin", "%", numeric=True),
        Heading("Required", "%", numeric=True),
        Heading("Margin kept"),
    )
    rows: list[tuple[Cell, ...]] = []
    for place in range(0, len(margins.crossings), len(margins.lines)):
        pairs = list(zip(margins.crossings[place : place + len(margins.lines)], margins.lines, strict=True))
        told = [_row(margins, critical, line) for critical, line in _telling(pairs)]
        rows += [row if number == 0 else ("", "", *row[2:]) for number, row in enumerate(told)]
    # Every mode meets the same lines; of some a rule requires nothing, as API 618 of half orders.
    compared = [critical for critical in margins.crossings[: len(margins.lines)] if critical.required is not None]
    notes = [
        phrase(
            "Compared are {count} lines: multiples of the speed of each shaft and of electrical frequencies, and every "
            "order of the excitations, as far as the rule requires a margin. Listed are those from which a mode has "
            "less than is required, and the nearest of the others.",
            count=len(compared),
        ),
        "Margin: distance of the nearer of undamped and damped natural frequency from the frequencies compared, "
        "as a share of them; 0 where one of the speeds meets it.",
        phrase("Margins by {rule}.", rule=in_clauses(str(margins.rule))),
    ]
    if any(critical.passes is False for critical in margins.crossings):
        notes.append("Where a margin is not kept, stresses at the critical speed have to show that it does no harm.")
    return table(phrase("Separation margins{where}", where=where), columns, rows, notes)


def _telling(pairs: Sequence[tuple[CriticalSpeed, OrderLine]]) -> list[tuple[CriticalSpeed, OrderLine]]:
    """Lines from which a mode has less than the margin required, and the nearest one of the others."""
    kept = [pair for pair in pairs if pair[0].passes is not False]
    judged = [pair for pair in kept if pair[0].passes] or kept
    nearest = min(judged, key=lambda pair: pair[0].margin / (pair[0].required or 1.0), default=None)
    return [pair for pair in pairs if pair[0].passes is False or pair is nearest]


def compared_words(critical: CriticalSpeed) -> str:
    """Text of the excitation from which a mode has to be apart, as 2 x motor."""
    if critical.order:
        return f"{critical.order:g} x {as_words(critical.excitation)}"
    return f"{critical.fixed:g} Hz, {as_words(critical.excitation)}"


def missed_margins(subject: ReportData) -> list[str]:
    """Sentences on the modes that are nearer to an excitation than the rule of separation margins wants."""
    said = []
    for cases, margins in subject.separation_margins:
        missed: dict[int, list[str]] = {}
        for critical in margins.crossings:
            if critical.passes is False:
                missed.setdefault(critical.mode.number, []).append(compared_words(critical))
        modes = [
            phrase("mode {mode} from {lines}", mode=mode, lines=listed_names(lines)) for mode, lines in missed.items()
        ]
        names = [case.configuration for case in cases]
        several = len(subject.distinct_drivetrains) > 1
        where = phrase(" in configuration {name}", name=shared_choices(names)) if several else ""
        if modes and margins.rule:
            said.append(phrase(MISSED, rule=margins.rule.name, modes=joined(", ", modes), where=where))
    return said


MISSED = "Separation margins by {rule} not kept{where}: {modes}; stresses at these critical speeds have to show no harm"
"""Finding on modes that are too near to an excitation."""


def _row(margins: CriticalSpeeds, critical: CriticalSpeed, line: OrderLine) -> tuple[Cell, ...]:
    low, high = np.abs(line.frequency(np.array(margins.speed_range))).tolist()
    compared = compared_words(critical)
    required = "" if critical.required is None else NumberText(100 * critical.required, 3)
    kept = "" if critical.passes is None else phrase("yes" if critical.passes else "no")
    return (
        str(critical.mode.number), NumberText(critical.mode.undamped_frequency, 4),
        compared, NumberText(low, 3), NumberText(high, 3),
        NumberText(100 * critical.margin, 3), required, kept,
    )  # fmt: skip


MOST_UNJUDGED = 20
"""Largest number of critical speeds shown of a model without limits, those with the largest amplitude at resonance."""
INTRODUCTION = (
    "A critical speed is one at which an order meets a natural frequency of the damped system. The equilibrium "
    "amplitude is the angle, where the mode moves most, if the order acted at rest: generalised force over modal "
    "inertia and square of the natural frequency; at resonance it is multiplied by the magnifier, 1/(2 × damping "
    "ratio). The generalised force is the sum of the torques of the order times the relative amplitudes where they act."
)
NO_TOLERANCE = (
    "No value of the model states a tolerance: how far assumed values, such as the stiffness of a coupling, move "
    "critical speeds is not examined beyond the conditions listed."
)
"""Sentence in place of the table of what values move that were assumed."""
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
    blocks: list[Block] = [Paragraph((INTRODUCTION, " ", highest_orders(subject)))]
    case, peaks = subject.normal_case, subject.normal_peaks
    if peaks is None:
        kept, listed = _without_limits(case)
        blocks.append(listed)
        lines = [f"{critical.excitation} {critical.line}" for critical in kept]
        criticals = kept
    else:
        blocks.append(normal_criticals(subject))
        further = further_criticals(subject)
        blocks += [further] if further else []
        # The diagram shows the orders that use a share of a limit worth drawing.
        lines = [record.name for record in peaks.criticals if record.share >= LEAST_SHARE]
        criticals = [record.critical for record in peaks.criticals if record.share >= SMALL_SHARE]
    moved = assumed_values(case, criticals)
    if moved is not None:
        blocks.append(moved)
    # Tolerances that move nothing need no words; that there are none does.
    elif not any(parameter.tolerance for parameter in case.drivetrain.parameter_definitions.values()):
        blocks.append(Paragraph((NO_TOLERANCE,)))
    blocks += separation_margins(subject)
    return Section("resonances", ("Critical speeds",), (*blocks, _diagram(case, list(dict.fromkeys(lines)) or None)))


def _mode_cells(some: Sequence[CriticalSpeed], case: Case) -> Iterable[tuple[Cell, ...]]:
    """Cells on mode, order, speed, amplitude, force and damping of some critical speeds in one condition."""
    shares = [damping_cell(case, critical) for critical in some]
    speeds = aligned_numbers([critical.natural_speed * RPM for critical in some])
    return (
        (
            str(critical.mode.number),
            as_words(line).replace(" ", "\N{NO-BREAK SPACE}"),
            speed,
            NumberText(1e3 * critical.equilibrium_amplitude, DIGITS),
            NumberText(1e-3 * critical.generalised_force, DIGITS),
            NumberText(critical.mode.amplification, DIGITS),
            damping,
        )
        for critical, line, speed, damping in zip(
            some, [f"{critical.excitation} {critical.line}" for critical in some], speeds, shares, strict=True
        )
    )


def _without_limits(case: Case) -> tuple[list[CriticalSpeed], TableBlock]:
    """Critical speeds of a model without limits, those with the largest amplitudes at resonance, and their table."""
    speeds = case.drivetrain.critical_speeds(reach=0.2)
    acting = [
        critical for critical in speeds.crossings if critical.excited and math.isfinite(critical.resonant_amplitude)
    ]
    # Without limits the amplitude at resonance ranks them; the table goes by mode.
    largest = sorted(acting, key=lambda critical: -critical.resonant_amplitude)[:MOST_UNJUDGED]
    kept = sorted(largest, key=lambda critical: (critical.mode.number, critical.natural_speed))
    low, high = (speed * RPM for speed in speeds.speed_range)
    more = len(speeds.crossings) - len(kept)
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
    condition = f", {case.title}" if case.title else ""
    caption = phrase("Critical speeds{where}{few}", where=condition, few="")
    groups = (Group(tuple(_mode_cells(kept, case))),)
    return kept, TableBlock((caption,), MODE_COLUMNS, groups, ((f"{which}.",), *notes))


def _diagram(case: Case, lines: list[str] | None) -> Picture:
    """Interference diagram of one condition with some order lines, or with all."""
    from torsionnet.plot.interference_plot import interference_diagram

    speeds = case.drivetrain.critical_speeds(lines=lines)
    where = f", {case.title}" if case.title else ""
    orders = "orders" if lines is None else phrase("the orders listed")
    caption = (
        phrase("Interference diagram{where}: natural frequencies and {orders} over speed.", where=where, orders=orders),
    )
    return Picture("resonances", interference_diagram(speeds, title=""), caption, f"Interference diagram{where}")
