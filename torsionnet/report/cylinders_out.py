"""Words and tables of a report on conditions with a cylinder out: mean torque left, excitation, the worst of them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from torsionnet.base.equal_remarks import condition_words, configurations_in_words
from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import phrase
from torsionnet.base.units import RPM
from torsionnet.machinery.excitations.cylinder_entries import EACH
from torsionnet.machinery.excitations.cylinder_harmonics import lost_harmonics
from torsionnet.machinery.excitations.reciprocating_engine import ReciprocatingEngine
from torsionnet.machinery.phasors.order_vectors import vector_sums
from torsionnet.machinery.phasors.vector_sums import VectorSums
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion, WorstLimit
from torsionnet.model.load.lost_torques import has_lost_cylinders
from torsionnet.report.document_tree import Heading, NumberText, TableBlock, TableGroup
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_text import as_words, unit

LOST_TORQUE = (
    "Where a cylinder is out, the others keep the pressures of the same speed and nothing makes up for the torque that "
    "is lost. Left of the mean torque at {speed:.6g} rpm: {shares}. Couplings and the reversal of tooth load are "
    "judged by the mean torque of the condition, shares of the rated torque by that with all cylinders working."
)
"""Paragraph on the mean torque of conditions with a cylinder out."""
NOT_SHOWN = 5e-4
"""Share of the mean torque that three digits in per cent do not show."""
LOST_NOTE = (
    "Lost: amplitude that is missing at a cylinder out as in {name}; alone at one cylinder it excites all orders, the "
    "low ones too."
)
"""Note below a cylinder's harmonics on what is lost with it."""
OUT_NOTE = (
    "With a cylinder out as in {name}: that cylinder {share:g} % of the pressure, all together {whole:.3g} % of the "
    "torque."
)
"""Note below the mean indicated pressure over speed."""


def all_working(cases: Sequence[Case]) -> Sequence[Case]:
    """Configurations without a cylinder out, all of the given ones where none is without: those of the rated power."""
    return [case for case in cases if not has_lost_cylinders(case.drivetrain.definition)] or cases


def lost_torque_words(subject: ReportData) -> str:
    """Sentence with the rule for the mean torque with a cylinder out, and the share left by condition; or nothing."""
    speeds = subject.model.definition.speeds
    if speeds is None:
        return ""
    speed = float(speeds.rated or speeds.values[-1])
    found: dict[str, list[str]] = {}
    for case in subject.judged_cases:
        kept = _kept(case, speed)
        if kept < 1 - NOT_SHOWN:
            found.setdefault(f"{100 * kept:.3g}", []).append(case.configuration)
    every = subject.model.configurations
    shares = [f"{share} % ({_choices(names, every)})" for share, names in found.items()]
    return phrase(LOST_TORQUE, speed=speed * RPM, shares=", ".join(shares)) if shares else ""


def _choices(names: Sequence[str], every: Sequence[str]) -> str:
    """Text that names configurations by their choices without the axes, such as 'misfire'."""
    return as_words(re.sub(r"[^\s,;=]+=", "", configurations_in_words(names, every)))


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
    found = subject.limit_conclusion
    checks = [one for one in found.checks if one.misfiring] if found else []
    if not checks:
        return None
    worst = LimitConclusion(tuple(checks)).worst()
    return next((one for one in worst if one.verdict.orders is not None and one.verdict.worst is not None), None)


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


def with_lost_torque(
    subject: ReportData, name: str, speed: float, block: TableBlock, places: Sequence[int]
) -> TableBlock:
    """Table of a cylinder's harmonics with a column in kN m for what is lost where it is out, if a condition has it.

    ``speed`` in rad/s is that of the crankshaft, ``places`` are the indices of the orders shown.
    """
    found = engine_out(subject, name)
    if found is None:
        return block
    case, engine = found
    lost = lost_harmonics(engine, speed)[list(places)] * 1e-3
    (group,) = block.groups
    rows = tuple((*row, NumberText(float(one))) for row, one in zip(group.rows, lost, strict=True))
    note = phrase(LOST_NOTE, name=condition_words(case.configuration))
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
    found = engine_out(subject, name)
    if found is None:
        return block
    case, engine = found
    out = _out(engine)
    cases = [(one,) for one in out] if engine.misfire == EACH else [tuple(out)]
    each = [vector_sums(case.drivetrain, name, modes=sums.modes, without=numbers) for numbers in cases]
    (group,) = block.groups
    rows = tuple(
        (row[0], *(NumberText(max(one.of(mode, orders[0]) for one in each), 4, 4) for mode in sums.modes))
        for row, orders in zip(group.rows, sums.groups(), strict=True)
    )
    numbers = ", ".join(map(str, out))
    title = (
        "One cylinder out, the largest of all"
        if engine.misfire == EACH
        else phrase("Without cylinder {numbers}", numbers=numbers)
    )
    return replace(block, groups=(TableGroup(group.rows, "All cylinders working"), TableGroup(rows, title)))


def pressure_notes(subject: ReportData, name: str, speed: float) -> list[str]:
    """Note on the mean indicated pressure of a cylinder that is out, and the engine's torque, at a speed in rad/s."""
    found = engine_out(subject, name)
    if found is None:
        return []
    case, engine = found
    one = _out(engine)[0]
    alone = replace(engine, misfire=(one,)) if engine.misfire == EACH else engine
    at = np.array([speed])
    whole = np.mean([*engine.mean_torque_shares(at).values()])
    share = alone.mean_torque_shares(at)[one][0]
    words = condition_words(case.configuration)
    return [phrase(OUT_NOTE, name=words, share=round(100 * float(share), 1) + 0.0, whole=100 * whole)]
