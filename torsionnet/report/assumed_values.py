"""Table of a report on what moves critical speeds where values that were assumed are off by their tolerance."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby

from torsionnet.base.phrases import phrase
from torsionnet.base.units import RPM
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.sensitivity.sensitivities_of_modes import ModeSensitivities, mode_sensitivities
from torsionnet.machinery.criticals.critical_speeds import CriticalSpeed
from torsionnet.report.document_tree import Cell, Heading, NumberText, TableBlock, TableGroup
from torsionnet.report.report_data import Case
from torsionnet.report.report_text import as_words, symbol_or_words

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
            rows.append(_row(symbol_or_words(name), NumberText(100 * share, 3), (change, other), criticals))
    if len(rows) > 1:
        both = math.hypot(*moved), math.hypot(*swung)
        rows.append(_row(phrase("together"), "", both, criticals))
    return rows


def _row(
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
