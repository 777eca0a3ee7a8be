"""Tables of a report with the orders of propellers and of excitations that are no engines."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from torsionnet.base.number_text import MISSING_TYPESET, NumberText, aligned_numbers
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.units import RPM
from torsionnet.machinery.excitations.harmonic_torque import PropellerTorque
from torsionnet.machinery.excitations.reciprocating_engine import ReciprocatingEngine
from torsionnet.machinery.orders.excitation_lines import excitation_lines
from torsionnet.machinery.orders.order_solution import shaft_speeds
from torsionnet.report.document_tree import Cell, Heading, TableBlock
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, capital, unit

KILO = 1e-3
"""Factor from N m to kN m."""
ORDERS_END = (
    "Orders above these, each of its own shaft, are not in the tables of the excitations and not examined: {orders}."
)
"""Sentence on what no peak and no sum contains."""
MOST_LINES = 20
"""Largest number of orders of other excitations in the table; of more it says how many."""


def propeller_block(case: Case, name: str, condition: str = "") -> TableBlock:
    """Table of a propeller's blade orders, share of its mean torque, amplitude in kN m and phase in degrees."""
    propeller = case.drivetrain.definition.excitations[name]
    assert isinstance(propeller, PropellerTorque)
    lines = excitation_lines(case.drivetrain, name)
    torque, exponent = propeller.law
    columns = (
        Heading("Blade order", numeric=True),
        Heading("Order of the shaft", numeric=True),
        Heading("Share of mean torque", "%", numeric=True),
        Heading("Amplitude", unit("kN*m"), numeric=True),
        Heading("Phase", "deg", numeric=True),
    )
    # The phase of the torque that the propeller takes is half a turn from that of the torque on the shaft.
    taken = [math.degrees(math.remainder(line.phase - math.pi, 2 * math.pi)) for line in lines]
    rows = zip(
        [NumberText(line.order / propeller.blades) for line in lines],
        [NumberText(line.order) for line in lines],
        aligned_numbers([100 * line.share for line in lines], 3),
        aligned_numbers([KILO * line.amplitude for line in lines], 4),
        [NumberText(phase, 4, 1) for phase in taken],
        strict=True,
    )
    state = f", {condition or as_words(propeller.condition)}" if condition or propeller.condition else ""
    law = phrase(
        "mean torque {torque:.4g} {unit} at {speed:.5g} rpm",
        torque=KILO * torque,
        unit=unit("kN*m"),
        speed=propeller.rated * RPM,
    )
    follows = phrase(", with the speed to the power {exponent:g}", exponent=exponent) if exponent else ""
    caption = phrase(
        "{name}{state}: {blades} blades, {law}{exponent}",
        name=capital(as_words(name)),
        state=state,
        blades=propeller.blades,
        law=law,
        exponent=follows,
    )
    return table(
        caption,
        columns,
        list(rows),
        ("Phase of the torque taken; 0 at (firing) top dead centre of the first cylinder.",),
    )


def other_table(others: Sequence[tuple[Case, str]]) -> TableBlock:
    """Table of the orders of excitations that are neither engines nor propellers, at the rated speed."""
    columns = (
        Heading("Excitation"),
        Heading("Type"),
        Heading("Acts on"),
        Heading("Order", numeric=True),
        Heading("Frequency beside it", "Hz", numeric=True),
        Heading("Amplitude", numeric=True),
        Heading("Unit"),
        Heading("Share of mean torque", "%", numeric=True),
        Heading("Phase", "deg", numeric=True),
    )
    rows: list[tuple[Cell, ...]] = []
    for case, name in others:
        excitation = case.drivetrain.definition.excitations[name]
        # Torques in kN m; an imposed motion is an angle.
        factor, shown = (KILO, unit("kN*m")) if excitation.quantity == "torque" else (math.degrees(1), "deg")
        rows += [
            (
                as_words(name),
                as_words(excitation.kind),
                as_words(line.node),
                NumberText(line.order, 6) if line.order else MISSING_TYPESET,
                NumberText(line.fixed, 4) if line.fixed else "",
                NumberText(factor * line.amplitude, 4),
                shown,
                "" if math.isnan(line.share) else NumberText(100 * line.share, 3),
                NumberText(math.degrees(line.phase), 4, 1),
            )
            for line in excitation_lines(case.drivetrain, name)
        ]
    note = "At rated speed; orders of an excitation are multiples of the speed of its own shaft."
    return table("Other excitations", columns, rows, (note,), most=MOST_LINES)


# Where the orders of excitations end: what excites above is left out of all results.


def first_acting(subject: ReportData, name: str) -> Case | None:
    """First configuration in which an excitation acts; None where it never does."""
    return next((case for case in subject.judged_cases if case.drivetrain.definition.excitations[name].enabled), None)


def acting_otherwise(subject: ReportData, name: str, entry: str = "") -> list[Case]:
    """Configurations in which an excitation acts, the first of each of its states, or of each value of one entry."""
    states: list[object] = []
    cases = []
    for case in subject.judged_cases:
        excitation = case.drivetrain.definition.excitations[name]
        state = getattr(excitation, entry) if entry else excitation
        if excitation.enabled and state not in states:
            states.append(state)
            cases.append(case)
    return cases


def highest_orders(subject: ReportData) -> str:
    """Sentence with the highest order that is known of each excitation; empty where none acts by orders."""
    ends = []
    for name in subject.model.definition.excitations:
        case = first_acting(subject, name)
        highest = 0.0 if case is None else _highest_order(case, name)
        ends += [f"{as_words(name)} {highest:g}"] if highest else []
    return phrase(ORDERS_END, orders=joined(", ", ends)) if ends else ""


def _highest_order(case: Case, name: str) -> float:
    excitation = case.drivetrain.definition.excitations[name]
    highest = float(np.max(excitation.torques(np.array([shaft_speeds(case.drivetrain, name)[1]])).orders, initial=0.0))
    if not isinstance(excitation, ReciprocatingEngine) or excitation.gas is None:
        return highest
    # Above a table of tangential pressures masses alone act, where the gas is what is left out.
    known = [order for key, order in excitation.gas.own_orders if key == "harmonics"]
    return min(highest, max(known, default=highest))
