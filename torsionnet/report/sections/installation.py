"""Section of a report on the installation: its machines with their data, and power, speed and torque along the line."""

from __future__ import annotations

from dataclasses import replace

from torsionnet.base.equal_remarks import condition_words
from torsionnet.base.errors import TorsionnetError, UsageError
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.units import RPM
from torsionnet.machinery.checks.rating_mismatches import rating_mismatches
from torsionnet.machinery.mean.power_balance import PowerBalance
from torsionnet.report.cylinders_out import all_working
from torsionnet.report.document_tree import Block, Heading, Listing, Paragraph, Section, Strong, TableBlock, Text
from torsionnet.report.report_data import Case, ReportData
from torsionnet.report.report_machines import machines, quantity_text
from torsionnet.report.report_tables import results_table, table
from torsionnet.report.report_text import as_words, capital, first_names

MOST_LOADS = 3
"""Largest number of unlike loads whose torques along the line are listed, half a page each."""
LEAST_TORQUE_SHARE = 1e-9
"""Share of the largest torque below which an element passes none but rounding, and has no row."""
LEAST_POWER_SHARE = 1e-6
"""Share of the power below which a difference is rounding: of six digits, as files give them."""
COLUMNS = ("element", "at", "speed", "torque", "stress", "power")
"""Names of the columns of mean torques that the table along the line shows."""


def installation_section(subject: ReportData) -> Section | None:
    """Section of a report on the installation; None for a model without excitations."""
    if not subject.has_excitations:
        return None
    model = subject.model
    rows = [(one.machine, one.data, one.source) for one in machines(model)]
    columns = (Heading("Machine"), Heading("Data", wide=True), Heading("Source or remark", wide=True))
    notes = [phrase("Where no source is named: {source}.", source=model.source.strip())] if model.source else []
    blocks: list[Block] = [table("Machines, couplings and dampers", columns, rows, notes)] if rows else []
    for case, found in _balances(subject):
        several = len(subject.cases) > 1 and case.configuration
        blocks += [
            _rated(found),
            _line(subject, case, found, f", {condition_words(case.configuration)}" if several else ""),
        ]
    blocks += _ratings(subject)
    return Section("installation", ("Installation",), tuple(blocks)) if blocks else None


def _balances(subject: ReportData) -> list[tuple[Case, PowerBalance]]:
    """Balances of power of configurations without a cylinder out, each once, at rated speed where it is known."""
    found: list[tuple[Case, PowerBalance]] = []
    shown: list[object] = []
    for case in all_working(subject.cases):
        balance = _balance(case)
        if balance is None or balance.taken <= LEAST_POWER_SHARE * balance.given:  # as with a brake on
            continue
        torques = [(one.element, one.port, round(one.torque or 0.0, 6)) for one in balance.state.loads]
        if torques not in shown and len(found) < MOST_LOADS:
            shown.append(torques)
            found.append((case, balance))
    return found


def _balance(case: Case) -> PowerBalance | None:
    """Balance of power at the rated speed, else at the operating point; None where neither is known."""
    speeds = case.drivetrain.definition.speeds
    for speed in dict.fromkeys([speeds.rated if speeds else None, None]):
        try:
            return case.drivetrain.power_balance(speed)
        except UsageError:  # no load over speed, or what drives is switched off in this configuration
            continue
    return None


def _rated(found: PowerBalance) -> Paragraph:
    """Paragraph with power and torque at the speed of the reference shaft, and the sums of power given and taken."""
    state = found.state
    speed = quantity_text(abs(state.speed), "speed")
    balance = phrase(
        "given {power}, absorbed {other}",
        power=quantity_text(found.given, "power"),
        other=quantity_text(found.taken, "power"),
    )
    if abs(found.given - found.taken) <= LEAST_POWER_SHARE * found.given:
        more = phrase(": in balance")
    else:
        more = phrase(", a difference of {power}", power=quantity_text(found.given - found.taken, "power"))
    text = phrase(
        "{power} at {speed} of {node}, torque there {torque} (T = P/ω). Powers: {balance}.",
        power=quantity_text(found.taken, "power"),
        speed=speed,
        node=as_words(state.reference),
        torque=quantity_text(found.torque, "torque"),
        balance=joined("", (balance, more)),
    )
    return Paragraph((Strong("Rated torque"), ": ", text))


def _line(subject: ReportData, case: Case, found: PowerBalance, where: str) -> TableBlock:
    """Table of speed, mean torque, stress and power of every element that passes torque on, along the line."""
    state = found.state
    largest = max((abs(one.torque or 0.0) for one in state.loads), default=0.0)
    whole = state.table(subject.conventions)
    order = _order(case)
    kept = [
        (order.get(one.port, len(order)), row)
        for one, row in zip(state.loads, whole.rows, strict=True)
        if abs(one.torque or 0.0) > LEAST_TORQUE_SHARE * largest
    ]
    rows = tuple(row for _, row in sorted(kept, key=lambda one: one[0]))
    names = [one.name for one in whole.columns]
    chosen = replace(whole, rows=rows).chosen([names.index(name) for name in COLUMNS])
    caption = phrase(
        "Speed, mean torque and power along the line at {speed:.6g} rpm{where}",
        speed=abs(state.speed) * RPM,
        where=where,
    )
    block = results_table(chosen, caption, notes=False)
    return replace(block, notes=((_outside(found),), _checked(found)))


def _order(case: Case) -> dict[str, int]:
    """Number of every node in the mass-elastic table, by node; empty where a controller acts."""
    try:
        return {row.node: row.number for row in case.drivetrain.mass_elastic_table().rows}
    except TorsionnetError:
        return {}


def _outside(found: PowerBalance) -> str:
    """Sentence on the torques that act from outside, equal ones together."""
    equal: dict[str, list[str]] = {}
    for node, torque in found.state.external.items():
        equal.setdefault(quantity_text(torque, "torque"), []).append(as_words(node))
    each = (
        phrase("{torque} each", torque=f"{first_names(nodes)} {text}") if len(nodes) > 1 else f"{nodes[0]} {text}"
        for text, nodes in equal.items()
    )
    return phrase("From outside act: {torques}.", torques=joined("; ", each))


def _checked(found: PowerBalance) -> Text:
    """Sentence on the powers along the line: P = T omega, and whether gears pass on what they get."""
    loads, text = found.state.loads, "P = T ω at every place."
    if len({one.element for one in loads}) == len(loads):
        return (text,)
    loss, share = found.largest_loss, found.largest_loss / (found.given or 1.0)
    if share <= LEAST_POWER_SHARE:
        return text, " Every gear gives as much power as it takes."
    return text, phrase(" A gear gives {power} less or more than it takes.", power=quantity_text(loss, "power"))


def _ratings(subject: ReportData) -> list[Block]:
    """Blocks on whether the ratings that machines and load state agree with each other."""
    external = subject.cases[0].drivetrain.external_torques
    stated = [one.rating for one in external.definition.excitations.values() if one.rating is not None]
    if not stated or not external.rated_speed or external.definition.load is None:
        return []
    faults = [f"{capital(as_words(fault.message))}." for fault in rating_mismatches(external)]
    if faults:
        return [Paragraph(("Ratings that differ:",)), Listing(tuple((text,) for text in faults))]
    text = (
        "The ratings of machines and load agree: speeds through the gear ratios within 0.5 %, powers within 5 %; of an "
        "indicated power 75 to 100 % arrive at the shaft."
    )
    return [Paragraph((text,))]
