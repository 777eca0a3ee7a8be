"""Blocks of a report on an engine: firing, mean indicated pressure, harmonics of a cylinder, vector sums, misfire."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from torsionnet.base.phrases import phrase
from torsionnet.base.table import result_table
from torsionnet.base.units import RPM
from torsionnet.machinery.excitations.cylinder_entries import EACH
from torsionnet.machinery.excitations.cylinder_harmonics import (
    cylinder_harmonics,
    firing_intervals,
    indicated_pressures,
)
from torsionnet.machinery.excitations.reciprocating_engine import ReciprocatingEngine
from torsionnet.machinery.orders.order_solution import shaft_speeds
from torsionnet.machinery.phasors.engine_harmonics import CylinderHarmonic, IndicatedPressure
from torsionnet.machinery.phasors.order_vectors import vector_sums
from torsionnet.machinery.phasors.vector_sums import VectorSums
from torsionnet.report.cylinders_out import pressure_notes, with_lost_torque, with_sums_out
from torsionnet.report.document_tree import Block, Cell, Heading, Paragraph, Picture, TableBlock
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_tables import results_table, table, with_decimals
from torsionnet.report.report_text import as_words, capital, shared_choices, unit

SPEEDS_SHOWN = (0.25, 0.5, 0.75, 0.9, 1.0)
"""Speeds over the rated one at which the mean indicated pressure is given, the usual loads of a trial at sea."""
MOST_ORDERS = 16
"""Largest number of orders in the table of a cylinder's harmonics; of more the smallest are left out."""
MOST_MODES, MOST_MODES_DRAWN, MOST_STARS = 4, 2, 6
"""Largest number of modes with vector sums and with drawn stars, and of stars beside each other: what fits a page."""
DECIMALS = {unit("N/mm^2"): 4, "deg": 1}
"""Decimals of tangential pressures and phases by unit, as makers list them."""
EQUAL_PRESSURES = 1e-9
"""Relative difference up to which mean indicated pressures count as equal, no more than rounding."""
EVEN_INTERVAL = math.radians(0.5)
"""Difference of firing intervals in rad up to which an engine fires evenly, as makers state angles to a degree."""


def engine_blocks(subject: ReportData, case: Case, name: str, engine: ReciprocatingEngine) -> list[Block]:
    """Blocks of a report on one engine: firing, mean indicated pressure, harmonics, vector sums and stars."""
    speed, own = shaft_speeds(case.drivetrain, name)
    blocks: list[Block] = [Paragraph((_firing(name, engine),))]
    blocks += _pressures(subject, case, name, engine, own / speed)
    found = cylinder_harmonics(engine, own)
    largest = sorted(found, key=lambda one: -one.torque)[:MOST_ORDERS]
    kept = tuple(one for one in found if one in largest)
    caption = phrase(
        "{name}: tangential pressure of one cylinder by order at {speed:.5g} r/min", name=_name(name), speed=own * RPM
    )
    notes = ["Over piston area and crank radius, peak values; phase of the cosine from firing top dead centre on."]
    if len(kept) < len(found):
        notes.append(
            phrase(
                "{count} further orders have less than {torque:.3g} kN·m.",
                count=len(found) - len(kept),
                torque=1e-3 * _least(kept),
            )
        )
    made = result_table("", [_shown(one) for one in kept], CylinderHarmonic, notes=notes)
    places = [number for number, one in enumerate(found) if one in largest]
    shown = with_lost_torque(subject, name, own, results_table(made, caption), places)
    blocks.append(with_decimals(shown, {**DECIMALS, **_torque_decimals(found)}))
    return [*blocks, *_vectors(subject, case, name)]


def _torque_decimals(found: Sequence[CylinderHarmonic]) -> dict[str, int]:
    """Decimals of torques in kN m that leave the largest one four digits, by the unit of their column."""
    largest = 1e-3 * max(one.torque for one in found)
    return {unit("kN*m"): max(1, 3 - math.floor(math.log10(largest))) if largest else 1}


def _least(kept: Sequence[CylinderHarmonic]) -> float:
    """Smallest torque amplitude in N m among the orders of a table."""
    return min(one.torque for one in kept)


def _shown(one: CylinderHarmonic) -> CylinderHarmonic:
    return replace(one, phase=math.degrees(one.phase))


def _firing(name: str, engine: ReciprocatingEngine) -> str:
    intervals = firing_intervals(engine)
    degrees = [math.degrees(one) for one in intervals.values()]
    order = "–".join(map(str, intervals))
    even = max(intervals.values()) - min(intervals.values()) < EVEN_INTERVAL
    each = (
        phrase("every {angle:.4g}°", angle=degrees[0])
        if even
        else phrase("at intervals of {angles}°", angles=", ".join(f"{one:.4g}" for one in degrees))
    )
    what = phrase("Top dead centres" if engine.absorbs else "Firing order")
    sizes = phrase("bore {bore:.4g} mm, stroke {stroke:.4g} mm", bore=1e3 * engine.bore, stroke=1e3 * engine.stroke)
    masses = phrase(
        "crank radius over rod length {ratio:.4g}, reciprocating mass {mass:.4g} kg",
        ratio=engine.crank.ratio,
        mass=engine.reciprocating_mass,
    )
    return phrase(
        "{name}: {sizes}, {masses}. {what} {order}, {each} of crank angle.",
        name=_name(name),
        sizes=sizes,
        masses=masses,
        what=what,
        order=order,
        each=each,
    )


def _pressures(subject: ReportData, case: Case, name: str, engine: ReciprocatingEngine, ratio: float) -> list[Block]:
    speeds = case.drivetrain.definition.speeds
    assert speeds is not None
    low, high = float(speeds.values[0]), float(speeds.values[-1])
    rated = float(speeds.rated) if speeds.rated else high
    chosen = sorted({low, high, rated, *(rated * share for share in SPEEDS_SHOWN if low <= rated * share <= high)})
    found = indicated_pressures(engine, np.array(chosen) * ratio)
    if not found:
        return []
    what = "mean indicated pressure over speed"
    if max(one.pressure for one in found) - min(one.pressure for one in found) <= EQUAL_PRESSURES * abs(
        found[0].pressure
    ):
        found, what = (found[chosen.index(rated)],), "mean indicated pressure, the same at all speeds"
    made = result_table("", found, IndicatedPressure, notes=pressure_notes(subject, name, rated * ratio))
    block = results_table(
        made, phrase("{name}: {pressures}, all cylinders working", name=_name(name), pressures=phrase(what))
    )
    return [with_decimals(block, {"bar": 2, "kW": 0, "r/min": 1})]


def _name(name: str) -> str:
    return capital(as_words(name))


def _vectors(subject: ReportData, case: Case, name: str) -> list[Block]:
    """Table of relative vector sums by order and mode, and the phase stars of the lowest modes."""
    from torsionnet.plot.phase_stars import phase_stars

    modes = subject.excited_modes[:MOST_MODES]
    sums = vector_sums(case.drivetrain, name, modes=modes)
    if len(next(iter(sums.stars.values())).labels) < 2:
        return []
    note = "Sum of the cylinders' amplitudes with their firing angles over the largest of them; all cylinders alike."
    made = replace(sums.table(), notes=(note,))
    drawn, groups = modes[:MOST_MODES_DRAWN], _largest(sums)
    caption = (
        phrase(
            "{name}: phase stars; numbers are cylinders, black is their sum, the circle one cylinder at the "
            "largest amplitude. Of orders with equal sums the first is drawn.",
            name=_name(name),
        ),
    )
    alt = phrase("Phase stars of {name} on modes {numbers}", name=as_words(name), numbers=", ".join(map(str, drawn)))
    return [
        with_sums_out(
            subject, name, sums, results_table(made, phrase("{name}: relative vector sums", name=_name(name)))
        ),
        Picture(f"phase_stars_{name.replace('.', '_')}", phase_stars(sums, modes=drawn, groups=groups), caption, alt),
    ]


def _largest(sums: VectorSums) -> list[tuple[float, ...]]:
    """Groups of orders with the largest vector sums, in their order."""
    groups = sums.groups()
    sizes = {group: max(sums.of(mode, group[0]) for mode in sums.modes) for group in groups}
    kept = sorted(groups, key=lambda group: -sizes[group])[:MOST_STARS]
    return [group for group in groups if group in kept]


def state_table(subject: ReportData) -> TableBlock | None:
    """Table of the states of excitations that differ from normal: misfire, gas off, factors, propeller conditions.

    None where there are none.
    """
    found: dict[tuple[str, str, str], list[str]] = {}
    for case in subject.judged_cases:
        for name, one in case.drivetrain.definition.excitations.items():
            states = [("all", "does not act")] if not one.enabled else []
            if isinstance(one, ReciprocatingEngine) and one.enabled:
                states += _states(one)
            for cylinders, state in states:
                found.setdefault((as_words(name), cylinders, state), []).append(case.configuration)
    if not found:
        return None
    columns = (
        Heading("Configuration"),
        Heading("Excitation"),
        Heading("Cylinders"),
        Heading("Gas pressure", wide=True),
    )
    rows: list[tuple[Cell, ...]] = [(shared_choices(names), *state) for state, names in found.items()]
    return table("Misfire and other states of the excitations", columns, rows)


def _states(engine: ReciprocatingEngine) -> list[tuple[str, str]]:
    """Cylinders and what their gas does, for every state of an engine that is not normal."""
    without = "unloaded: the pressure given without delivery" if engine.absorbs else "no injection: compression only"
    states = []
    if engine.misfire:
        each = engine.misfire == EACH
        cylinders = "each in turn, the worst counts" if each else ", ".join(map(str, engine.misfire))
        states.append((cylinders, without))
    if engine.gas_off:
        states.append((", ".join(map(str, engine.gas_off)), "none (factor 0), the mass moves on"))
    states += [
        (number, phrase("factor {factor:.4g}", factor=factor))
        for number, factor in (engine.factors or {}).items()
        if factor != 1
    ]
    if engine.spread:
        states.append(("all", phrase("factor 1 ± {spread:.3g}, the worst combination", spread=engine.spread)))
    return states
