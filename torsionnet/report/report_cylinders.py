"""Blocks of a report on an engine: firing, mean indicated pressure, harmonics of a cylinder, vector sums, misfire."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.table import result_table
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.excitations.engine_entries import EACH
from torsionnet.machinery.excitations.reciprocating_engine import (
    CylinderHarmonic,
    IndicatedPressure,
    ReciprocatingEngine,
    cylinder_harmonics,
    firing_intervals,
    indicated_pressures,
    lost_harmonics,
)
from torsionnet.machinery.orders.order_solution import shaft_speeds
from torsionnet.machinery.orders.vector_sums import VectorSums, vector_sums
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion, WorstLimit
from torsionnet.model.load.lost_torques import has_lost_cylinders
from torsionnet.report.document_tree import Block, Cell, Heading, NumberText, Paragraph, Picture, TableBlock, TableGroup
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_orders import acting_otherwise
from torsionnet.report.report_tables import results_table, table, with_decimals
from torsionnet.report.report_text import as_words, capital, unit

# Words and tables of a report on conditions with a cylinder out: mean torque left, excitation, the worst of them.

LOST_TORQUE = (
    "Where a cylinder is out, the others keep the pressures of the same speed and nothing makes up for the torque that "
    "is lost. Left of the mean torque at {speed:.6g} rpm: {shares}. Couplings and the reversal of tooth load are "
    "judged by the mean torque of the condition, shares of the rated torque by that with all cylinders working."
)
"""Paragraph on the mean torque of conditions with a cylinder out."""
NOT_SHOWN = 5e-4
"""Share of the mean torque that three digits in per cent do not show."""
LOST_NOTE = (
    "Lost: amplitude that is missing at a cylinder out; alone at one cylinder it excites all orders, the low ones too."
)
"""Note below a cylinder's harmonics on what is lost with it."""
OUT_NOTE = "With a cylinder out: that cylinder {share:g} % of the pressure, all together {whole:.3g} % of the torque."
"""Note below the mean indicated pressure over speed."""

OF_COMPRESSORS = {
    LOST_TORQUE: (
        "Where a cylinder is unloaded, the others keep the pressures of the same speed. Left of the mean torque at "
        "{speed:.6g} rpm: {shares}. Couplings and the reversal of tooth load are judged by the mean torque of the "
        "condition, shares of the rated torque by that with all cylinders loaded."
    ),
    LOST_NOTE: (
        "Lost: amplitude that is missing at an unloaded cylinder; alone at one cylinder it excites all "
        "orders, the low ones too."
    ),
    OUT_NOTE: ("Unloaded: that cylinder {share:g} % of the pressure, all together {whole:.3g} % of the torque."),
    "All cylinders working": "All cylinders loaded",
    "One cylinder out, the largest of all": "One cylinder unloaded, the largest of all",
    "Without cylinder {numbers}": "Cylinders unloaded: {numbers}",
    "{name}: {pressures}, all cylinders working": "{name}: {pressures}, all cylinders loaded",
    "With a cylinder out": "With cylinders unloaded",
    "Misfire and other states of the excitations": "Unloaded and other states of the excitations",
    "Expected with a cylinder out{where}": "Expected with cylinders unloaded{where}",
}
"""Words on compressors, whose cylinders or ends are unloaded by valves, by those on engines that lose a cylinder."""


def in_words_of(excitations: Iterable[Any], words: str) -> str:
    """Words on cylinders that are out, as they are said of the given excitations: of compressors alone, or of engines.

    Examples
    --------
    >>> import torsionnet as tn
    >>> train = tn.load("reciprocating_compressor_train")
    >>> in_words_of(train.definition.excitations.values(), "With a cylinder out")
    'With cylinders unloaded'
    """
    engines = [excitation for excitation in excitations if isinstance(excitation, ReciprocatingEngine)]
    return OF_COMPRESSORS[words] if engines and all(excitation.absorbs for excitation in engines) else words


def all_working(cases: Sequence[Case]) -> Sequence[Case]:
    """Configurations without a cylinder out, all of the given ones where none is without: those of the rated power."""
    return [case for case in cases if not has_lost_cylinders(case.drivetrain.definition)] or cases


def lost_torque_words(subject: ReportData) -> str:
    """Sentence with the rule for the mean torque with a cylinder out, and the share left by condition; or nothing."""
    speeds = subject.model.definition.speeds
    if speeds is None:
        return ""
    speed = float(speeds.rated or speeds.values[-1])
    conditions_by_share: dict[str, list[str]] = {}
    for case in subject.judged_cases:
        # Conditions with equal shares stand together; what keeps its whole torque is not told.
        kept = _kept(case, speed)
        if kept < 1 - NOT_SHOWN:
            conditions_by_share.setdefault(f"{100 * kept:.3g}", []).append(case.configuration)
    every = subject.model.configurations
    shares = [
        phrase("{share} % ({conditions})", share=share, conditions=subject.titles.several(names, every))
        for share, names in conditions_by_share.items()
    ]
    return (
        phrase(
            in_words_of(subject.model.definition.excitations.values(), LOST_TORQUE),
            speed=speed * RPM,
            shares=joined(", ", shares),
        )
        if shares
        else ""
    )


def _kept(case: Case, speed: float) -> float:
    """Share of the mean torque left in a condition at a speed in rad/s, 1 where the load determines none."""
    if not has_lost_cylinders(case.drivetrain.definition):
        return 1.0
    try:
        return case.drivetrain.external_torques.kept_power(speed)
    except UsageError:  # behind an open clutch, or beyond a table: the section on limits says so
        return 1.0


def governing_misfire(subject: ReportData) -> WorstLimit | None:
    """Limit on vibration used most in conditions with a cylinder out, at its worst; None where none was judged."""
    judged = subject.limit_conclusion
    checks = [check for check in judged.checks if check.misfiring] if judged else []
    if not checks:
        return None
    worst = LimitConclusion(tuple(checks)).worst()
    return next(
        (limit for limit in worst if limit.verdict.orders is not None and limit.verdict.worst is not None), None
    )


def engine_out(subject: ReportData, name: str) -> tuple[Case, ReciprocatingEngine] | None:
    """Condition that uses the limits most with cylinders of an engine out, and the engine in it; None without one.

    None as well where all its cylinders are out, as with a compressor that runs unloaded.
    """
    worst = governing_misfire(subject)
    if worst is None:
        return None
    case = subject.judged_case(worst.check)
    engine = case.drivetrain.definition.excitations[name]
    if not isinstance(engine, ReciprocatingEngine) or not engine.has_lost_cylinder or not engine.enabled:
        return None
    return None if len(_out(engine)) == len(engine.numbers) and engine.misfire != EACH else (case, engine)


def _out(engine: ReciprocatingEngine) -> list[int]:
    """Numbers of the cylinders that are out, all that are in turn."""
    silent = engine.numbers if engine.misfire == EACH else engine.misfire
    return sorted({*silent, *engine.gas_off})


def _out_as_in(working: ReciprocatingEngine, out: ReciprocatingEngine) -> ReciprocatingEngine:
    """Engine with the pressures of one condition and the cylinders out as in another."""
    return replace(working, misfire=out.misfire, gas_off=out.gas_off)


def with_lost_torque(
    subject: ReportData, name: str, working: ReciprocatingEngine, speed: float, block: TableBlock, places: Sequence[int]
) -> TableBlock:
    """Table of a cylinder's harmonics with a column in kN m for what is lost where it is out, if a condition has it.

    It is what is lost of the harmonics in the row, those of the engine as it is ``working``.

    ``speed`` in rad/s is that of the crankshaft, ``places`` are the indices of the orders shown.
    """
    case_and_engine = engine_out(subject, name)
    if case_and_engine is None:
        return block
    engine = _out_as_in(working, case_and_engine[1])
    lost = lost_harmonics(engine, speed)[list(places)] * 1e-3
    (group,) = block.groups
    rows = tuple((*row, NumberText(float(lost_torque))) for row, lost_torque in zip(group.rows, lost, strict=True))
    note = phrase(in_words_of([engine], LOST_NOTE))
    return replace(
        block,
        columns=(*block.columns, Heading("Lost", unit("kN*m"), numeric=True)),
        groups=(replace(group, rows=rows),),
        notes=(*block.notes, (note,)),
    )


def with_sums_out(subject: ReportData, name: str, sums: VectorSums, block: TableBlock) -> TableBlock:
    """Table of relative vector sums with further rows for a cylinder out, in the condition that uses the limits most.

    Where each cylinder is out in turn, the largest sum of all of them. The cylinder that is out counts as nothing.
    """
    case_and_engine = engine_out(subject, name)
    if case_and_engine is None:
        return block
    case, engine = case_and_engine
    out = _out(engine)
    cases = [(cylinder,) for cylinder in out] if engine.misfire == EACH else [tuple(out)]
    each = [vector_sums(case.drivetrain, name, modes=sums.modes, without=numbers) for numbers in cases]
    (group,) = block.groups
    rows = tuple(
        (row[0], *(NumberText(max(sums_out.of(mode, orders[0]) for sums_out in each), 4, 4) for mode in sums.modes))
        for row, orders in zip(group.rows, sums.groups(), strict=True)
    )
    numbers = ", ".join(map(str, out))
    title = (
        in_words_of([engine], "One cylinder out, the largest of all")
        if engine.misfire == EACH
        else phrase(in_words_of([engine], "Without cylinder {numbers}"), numbers=numbers)
    )
    return replace(
        block, groups=(TableGroup(group.rows, in_words_of([engine], "All cylinders working")), TableGroup(rows, title))
    )


def pressure_notes(subject: ReportData, name: str, working: ReciprocatingEngine, speed: float) -> list[str]:
    """Note on the mean indicated pressure of a cylinder that is out, and the engine's torque, at a speed in rad/s."""
    case_and_engine = engine_out(subject, name)
    if case_and_engine is None:
        return []
    engine = _out_as_in(working, case_and_engine[1])
    cylinder = _out(engine)[0]
    alone = replace(engine, misfire=(cylinder,)) if engine.misfire == EACH else engine
    at = np.array([speed])
    whole = np.mean([*engine.mean_torque_shares(at).values()])
    share = alone.mean_torque_shares(at)[cylinder][0]
    return [phrase(in_words_of([engine], OUT_NOTE), share=round(100 * float(share), 1) + 0.0, whole=100 * whole)]


SPEEDS_SHOWN = (0.25, 0.5, 0.75, 0.9, 1.0)
"""Speeds over the rated one at which the mean indicated pressure is given, the usual loads of a trial at sea."""
MOST_ORDERS = 16
"""Largest number of orders in the table of a cylinder's harmonics; of more the smallest are left out."""
MOST_MODES, MOST_MODES_DRAWN, MOST_STARS = 4, 2, 6
"""Largest number of modes with vector sums and with drawn stars, and of stars beside each other: what fits a page."""
DECIMALS = {unit("N/mm^2"): 4, "deg": 1}
"""Decimals of tangential pressures and phases by unit, as makers list them."""
GRID = 401
"""Number of speeds between which the one of half load is found by straight lines."""
LOADS = (
    "Load: share of the indicated power at rated speed, or at the highest below, with the mechanical efficiency of "
    "full load."
)
"""Note below the mean indicated pressure on its column of the load."""
EQUAL_PRESSURES = 1e-9
"""Relative difference up to which mean indicated pressures count as equal, no more than rounding."""
EVEN_INTERVAL = math.radians(0.5)
"""Difference of firing intervals in rad up to which an engine fires evenly, as makers state angles to a degree."""


def engine_blocks(subject: ReportData, case: Case, name: str, engine: ReciprocatingEngine) -> list[Block]:
    """Blocks of a report on one engine: firing, mean indicated pressure, harmonics, vector sums and stars."""
    speed, own = shaft_speeds(case.drivetrain, name)
    blocks: list[Block] = [Paragraph((_firing(name, engine),))]
    blocks += _pressures(subject, case, name, engine, own / speed)
    # Another load, as at zero pitch, has mean pressures of its own.
    for other in acting_otherwise(subject, name, "load"):
        loaded = other.drivetrain.definition.excitations[name]
        if isinstance(loaded, ReciprocatingEngine) and loaded.load != engine.load:
            there, turning = shaft_speeds(other.drivetrain, name)
            blocks += _pressures(subject, other, name, loaded, turning / there, other.title)
    harmonics = cylinder_harmonics(engine, own)
    # The largest by torque, listed by order.
    largest = sorted(harmonics, key=lambda harmonic: -harmonic.torque)[:MOST_ORDERS]
    kept = tuple(harmonic for harmonic in harmonics if harmonic in largest)
    caption = phrase(
        "{name}: tangential pressure of one cylinder by order at {speed:.5g} rpm", name=_name(name), speed=own * RPM
    )
    notes = ["Over piston area and crank radius, peak values; phase of the cosine from (firing) top dead centre on."]
    if len(kept) < len(harmonics):
        notes.append(
            phrase(
                "{count} further orders have less than {torque:.3g} kN·m.",
                count=len(harmonics) - len(kept),
                torque=1e-3 * _least(kept),
            )
        )
    made = result_table("", [_shown(harmonic) for harmonic in kept], CylinderHarmonic, notes=notes)
    places = [number for number, harmonic in enumerate(harmonics) if harmonic in largest]
    shown = with_lost_torque(subject, name, engine, own, results_table(made, caption), places)
    blocks.append(with_decimals(shown, {**DECIMALS, **_torque_decimals(harmonics)}))
    return [*blocks, *_vectors(subject, case, name)]


def _torque_decimals(harmonics: Sequence[CylinderHarmonic]) -> dict[str, int]:
    """Decimals of torques in kN m that leave the largest one four digits, by the unit of their column."""
    largest = 1e-3 * max(harmonic.torque for harmonic in harmonics)
    return {unit("kN*m"): max(1, 3 - math.floor(math.log10(largest))) if largest else 1}


def _least(kept: Sequence[CylinderHarmonic]) -> float:
    """Smallest torque amplitude in N m among the orders of a table."""
    return min(harmonic.torque for harmonic in kept)


def _shown(harmonic: CylinderHarmonic) -> CylinderHarmonic:
    return replace(harmonic, phase=math.degrees(harmonic.phase))


def _firing(name: str, engine: ReciprocatingEngine) -> str:
    intervals = firing_intervals(engine)
    degrees = [math.degrees(angle) for angle in intervals.values()]
    order = "–".join(map(str, intervals))
    even = max(intervals.values()) - min(intervals.values()) < EVEN_INTERVAL
    each = (
        phrase("every {angle:.4g}°", angle=degrees[0])
        if even
        else phrase("at intervals of {angles}°", angles=", ".join(f"{angle:.4g}" for angle in degrees))
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


def _pressures(
    subject: ReportData, case: Case, name: str, engine: ReciprocatingEngine, ratio: float, condition: str = ""
) -> list[Block]:
    speeds = case.drivetrain.definition.speeds
    assert speeds is not None
    low, high = float(speeds.values[0]), float(speeds.values[-1])
    rated = min(float(speeds.rated), high) if speeds.rated else high
    shown = {low, high, rated, *(rated * share for share in SPEEDS_SHOWN if low <= rated * share <= high)}
    (full,) = indicated_pressures(engine, np.array([rated * ratio])) or (None,)
    if full is None:
        return []
    half = None if engine.absorbs else _speed_of_half_load(engine, np.linspace(low, rated, GRID) * ratio, full)
    wanted = sorted([*(speed * ratio for speed in shown), *([half] if half else [])])
    chosen = [speed for speed, before in zip(wanted, [0.0, *wanted], strict=False) if not math.isclose(speed, before)]
    pressures = [*indicated_pressures(engine, np.array(chosen))]
    what = "mean indicated pressure over speed"
    if max(pressure.pressure for pressure in pressures) - min(
        pressure.pressure for pressure in pressures
    ) <= EQUAL_PRESSURES * abs(full.pressure):
        pressures, what = [full], "mean indicated pressure, the same at all speeds"
        if not engine.absorbs:  # half the work of a cycle at rated speed, as a generating set has it
            pressures.insert(0, replace(full, pressure=full.pressure / 2, torque=full.torque / 2))
    notes = [*pressure_notes(subject, name, engine, full.speed), *([] if engine.absorbs else [LOADS])]
    made = result_table("", pressures, IndicatedPressure, notes=notes)
    caption = phrase(
        in_words_of([engine], "{name}: {pressures}, all cylinders working"), name=_name(name), pressures=phrase(what)
    )
    caption = joined(", ", (caption, condition)) if condition else caption
    block = with_decimals(results_table(made, caption), {"bar": 2, "kW": 0, "rpm": 1})
    if engine.absorbs:
        return [block]
    (group,) = block.groups
    rows = tuple(
        (*row, NumberText(100 * pressure.power / full.power, 3, 1))
        for row, pressure in zip(group.rows, pressures, strict=True)
    )
    columns = (*block.columns, Heading("Load", "%", numeric=True))
    return [replace(block, columns=columns, groups=(replace(group, rows=rows),))]


def _speed_of_half_load(engine: ReciprocatingEngine, speeds: FloatArray, full: IndicatedPressure) -> float | None:
    """Speed in rad/s at which an engine has half of its indicated power, between rising speeds; None where it has not.

    None as well where the pressure does not follow the speed: there half the load is half the pressure.
    """
    powers = np.array([pressure.power for pressure in indicated_pressures(engine, speeds)])
    pressures = powers / speeds
    if np.ptp(pressures) <= EQUAL_PRESSURES * abs(pressures).max() or powers[0] > full.power / 2:
        return None
    return float(np.interp(full.power / 2, np.maximum.accumulate(powers), speeds))


def _name(name: str) -> str:
    return capital(as_words(name))


def _vectors(subject: ReportData, case: Case, name: str) -> list[Block]:
    """Table of relative vector sums by order and mode, and the phase stars of the lowest modes."""
    from torsionnet.plot.interference_plot import phase_stars

    modes = subject.excited_modes[:MOST_MODES]
    sums = vector_sums(case.drivetrain, name, modes=modes)
    # One cylinder alone has no sum.
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
    conditions_by_state: dict[tuple[str, str, str], list[str]] = {}
    for case in subject.judged_cases:
        for name, excitation in case.drivetrain.definition.excitations.items():
            states = [("all", "does not act")] if not excitation.enabled else []
            if isinstance(excitation, ReciprocatingEngine) and excitation.enabled:
                states += _states(excitation)
            for cylinders, state in states:
                conditions_by_state.setdefault((as_words(name), cylinders, state), []).append(case.configuration)
    if not conditions_by_state:
        return None
    columns = (
        Heading("Configuration"),
        Heading("Excitation"),
        Heading("Cylinders"),
        Heading("Gas pressure", wide=True),
    )
    rows: list[tuple[Cell, ...]] = [
        (subject.titles.several(names, subject.model.configurations) or "all", *state)
        for state, names in conditions_by_state.items()
    ]
    excitations = subject.model.definition.excitations.values()
    return table(in_words_of(excitations, "Misfire and other states of the excitations"), columns, rows)


def _states(engine: ReciprocatingEngine) -> list[tuple[str, str]]:
    """Cylinders and what their gas does, for every state of an engine that is not normal."""
    without = "unloaded: the pressure given without delivery" if engine.absorbs else "no injection: compression only"
    if engine.is_unloaded_evenly:
        without = "all unloaded alike, a load of its own: the pressure given without delivery"
    states = []
    if engine.misfire:
        each = engine.misfire == EACH
        cylinders = phrase("each in turn, the worst counts") if each else ", ".join(map(str, engine.misfire))
        states.append((cylinders, phrase(without)))
    if engine.gas_off:
        states.append((", ".join(map(str, engine.gas_off)), phrase("none (factor 0), the mass moves on")))
    states += [
        (number, phrase("factor {factor:.4g}", factor=factor))
        for number, factor in (engine.factors or {}).items()
        if factor != 1
    ]
    if engine.spread:
        states.append((phrase("all"), phrase("factor 1 ± {spread:.3g}, the worst combination", spread=engine.spread)))
    return states
