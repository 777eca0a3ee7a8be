"""A document calculated again from its printed digits: what does not close, contradicts itself or leaves its range."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Sequence

from support.printed_tables import SI, Printed, PrintedRow, PrintedTable, printed_tables

RPM = math.pi / 30
VERDICT_HEADS = ("Value", "All orders", "Worst")
USED_HEADS = ("Utilisation", "Used", "Used at peak")
CONDITION_HEADS = ("Condition", "Worst condition")
VERDICT_SPEEDS = ("Speed", "Peak at")
SPEED_HEADS = (*VERDICT_SPEEDS, "From", "To")
HOLZER_DIGITS, MASS_DIGITS = 6, 4
"""Significant digits of stiffnesses and inertias in a Holzer table and of inertias in the mass-elastic table."""
HOLZER = re.compile(r"Holzer table of mode (\d+), ([\d.]+) Hz, ω² = ([\d.e+]+) 1/s²")
HOUSED = re.compile(
    "(?:the twist|behind the rigid mesh) of (.*?) (?:counts|the angle counts) the motion of the housing"
)
"""Gears across which angles do not follow from the stations alone."""
EVERY_SPEED = re.compile(r"Speeds in every condition: ([\d.]+) to ([\d.]+) rpm of")
RATED = re.compile(r"rated speed ([\d.]+) rpm")
OTHER_SPEEDS = ("in passing", "Passage", "run-up", "Start", "idling")
"""Words of captions of tables whose speeds are not those of steady running."""


def document_faults(text: str) -> list[str]:
    """Sentences on what in a document in Markdown does not follow from its own printed digits; empty if all does."""
    text = text.replace("\N{NO-BREAK SPACE}", " ")
    tables = printed_tables(text)
    faults: list[str] = []
    for table in tables:
        for check in (holzer_faults, sum_faults, utilisation_faults, power_faults, speed_margin_faults):
            faults += [f"{table.caption}: {fault}" for fault in check(table)]
    faults += range_faults(text, tables)
    faults += twice_faults(tables)
    faults += unit_faults(tables)
    faults += distance_faults(text, tables)
    faults += repeated_faults(tables)
    faults += made_faults(tables)
    faults += rated_stress_faults(tables)
    faults += rated_condition_faults(tables)
    return faults


def _differs(what: str, printed: Printed, expected: Printed) -> Iterator[str]:
    if not printed.agrees(expected):
        yield f"{what} is printed as {printed}, its digits give {expected}"


def holzer_faults(table: PrintedTable) -> Iterator[str]:
    """J omega^2 theta, sums of torques, torque over stiffness and differences of angles in a Holzer table."""
    match = HOLZER.search(table.caption)
    if match is None:
        return
    square, frequency = (Printed.read(match[place]) or Printed(float(match[place])) for place in (3, 2))
    root = Printed(math.sqrt(square.value), square.half / (2 * math.sqrt(square.value)))
    yield from _differs("2 pi f", frequency.times(2 * math.pi), root)
    housed = {name for note in table.notes for names in HOUSED.findall(note) for name in names.split(", ")}
    angles = {row.text("Station"): row.number(r"$\theta$") for row in table.rows}
    for rows in table.groups():
        carried = Printed(0.0)
        for row, after in itertools.zip_longest(rows, rows[1:]):
            yield from _station_faults(row, carried, square)
            total = row.number("Sum")
            carried = Printed(0.0) if total is None else total
            joins = re.search(r" to (.*), which it joins", row.group)
            beyond = after.number(r"$\theta$") if after is not None else angles.get(joins[1]) if joins else None
            twist, here = row.number("Twist"), row.number(r"$\theta$")
            free = housed.isdisjoint(row.text("Link").removesuffix(" (rigid)").split(", "))
            if free and here is not None and beyond is not None:
                what = f"theta beyond {row.text('Station')}"
                yield from _differs(what, beyond, here if twist is None else here - twist)


def _station_faults(row: PrintedRow, carried: Printed, square: Printed) -> Iterator[str]:
    station = row.text("Station")
    inertia, angle = row.number("$J$", digits=HOLZER_DIGITS), row.number(r"$\theta$")
    own, total = row.number(r"$J\omega^{2}\theta$"), row.number("Sum")
    if inertia is not None and angle is not None and own is not None:
        yield from _differs(f"J omega^2 theta of {station}", own, inertia * square * angle)
    if total is not None:
        parts = [row.number(head) for head in (r"$J\omega^{2}\theta$", "Shafts", "Joined")]
        expected = sum((one for one in parts if one is not None), carried)
        # A balance that rounding leaves is printed as 0.
        yield from _differs(f"sum of torques at {station}", total, expected)
    stiffness, twist = row.number("$k$", digits=HOLZER_DIGITS), row.number("Twist")
    if stiffness is not None and twist is not None and total is not None:
        yield from _differs(f"torque behind {station}", total, stiffness * twist)


def sum_faults(table: PrintedTable) -> Iterator[str]:
    """Rows called "Sum" against the rows above."""
    for row in table.rows:
        if "Sum" not in row.cells:
            continue
        for at, cell in enumerate(row.cells):
            total = Printed.read(cell, MASS_DIGITS)
            column = [Printed.read(one.cells[at], MASS_DIGITS) for one in table.rows if one is not row]
            if total is not None:
                expected = sum((one for one in column if one is not None), Printed(0.0))
                yield from _differs(f"sum of {table.heads[at]}", total, expected)


def utilisation_faults(table: PrintedTable) -> Iterator[str]:
    """Utilisation in percent against value over the value allowed."""
    for row in table.rows:
        heads = (VERDICT_HEADS, ("Allowed",), USED_HEADS)
        value, allowed, used = (row.number(*names, trimmed=not table.keeps_zeros(*names)) for names in heads)
        if value is not None and allowed is not None and used is not None:
            yield from _differs(f"utilisation of {row.cells[0]}", used, (value / allowed).times(100))


def power_faults(table: PrintedTable) -> Iterator[str]:
    """P = T omega where a row has the speed, the torque and the power of a place."""
    for row in table.rows:
        speed, power = row.number("Speed"), row.number("Power", "Indicated power")
        torque = row.number("Torque", "Indicated torque")
        if speed is not None and power is not None and torque is not None:
            yield from _differs(f"power at {row.cells[0]}", power, torque * speed.times(RPM))


def speed_margin_faults(table: PrintedTable) -> Iterator[str]:
    """Verdicts on separation margins, and margins against the frequencies compared."""
    for row in table.rows:
        margin, required = row.number("Margin"), row.number("Required")
        if margin is None or required is None:
            continue
        kept = row.text("Margin kept")
        if kept != ("yes" if margin.value >= required.value else "no") and not margin.agrees(required):
            yield f"margin of {margin} against {required} is called {kept}"


def range_faults(text: str, tables: Sequence[PrintedTable]) -> Iterator[str]:
    """Speeds of verdicts outside of the range of their condition."""
    match = EVERY_SPEED.search(text)
    if match is None:
        return
    low, high = (Printed.read(match[place], 9) or Printed(0.0) for place in (1, 2))
    for table in tables:
        if any(word in table.caption for word in OTHER_SPEEDS):
            continue
        for row, head in itertools.product(table.rows, SPEED_HEADS):
            speed = row.number(head)
            if speed is None or row.unit(head) != "rpm" or not _condition(table, row):
                continue
            if speed.value + speed.half < low.value - low.half or speed.value - speed.half > high.value + high.half:
                yield f"{table.caption}: {head.lower()} {speed} rpm of {row.cells[0]} is not in {low} to {high} rpm"


def twice_faults(tables: Sequence[PrintedTable]) -> Iterator[str]:
    """Numbers that stand in two tables and differ: natural frequencies, inertias, values of verdicts."""
    yield from _frequency_faults(tables)
    yield from _inertia_faults(tables)
    yield from _verdict_faults(tables)


def _frequency_faults(tables: Sequence[PrintedTable]) -> Iterator[str]:
    listed = next(
        (one for one in tables if one.caption.startswith("Natural frequencies") and "Mode" in one.heads), None
    )
    if listed is None:
        return
    known = {row.text("Mode"): row.number("Undamped") for row in listed.rows if row.text("Mode")}
    one_drivetrain = not any(one.caption.startswith("Natural frequencies of all") for one in tables)
    for table in tables:
        match = HOLZER.search(table.caption)
        printed = {match[1]: Printed.read(match[2])} if match else {}
        if one_drivetrain and table.caption.startswith("Separation margins"):
            printed |= {row.text("Mode"): row.number("Natural frequency") for row in table.rows if row.text("Mode")}
        for mode, value in printed.items():
            expected = known.get(mode)
            if value is not None and expected is not None:
                yield from (f"{table.caption}: {fault}" for fault in _differs(f"mode {mode}", value, expected))


def _inertia_faults(tables: Sequence[PrintedTable]) -> Iterator[str]:
    """J of a Holzer table, that of the masses alone, against the mass-elastic table less what shafts have of it."""
    listed = next((one for one in tables if one.caption.startswith("Masses and shafts")), None)
    if listed is None or "$n$" in listed.heads:
        return
    note = next((one for one in listed.notes if one.startswith("Of J, half of each adjacent shaft")), "")
    parts = re.findall(r"([^,]+) (\d+(?:\.\d+)?)(?=,|\.?$)", note.rpartition(": ")[2])
    shares = {name.strip(): Printed.read(size, 5) or Printed(0.0) for name, size in parts}
    known = {row.text("Mass"): row.number("$J$", digits=MASS_DIGITS) for row in listed.rows}
    for table in tables:
        if HOLZER.search(table.caption) is None:
            continue
        for row in table.rows:
            station, mass = row.text("Station"), row.number("$J$", digits=HOLZER_DIGITS)
            whole = known.get(station)
            if mass is not None and whole is not None:
                share = shares.get(station, Printed(0.0))
                yield from (f"{table.caption}: {fault}" for fault in _differs(f"J of {station}", mass + share, whole))


def _verdict_faults(tables: Sequence[PrintedTable]) -> Iterator[str]:
    """Values of one component in one condition at one speed against one value allowed."""
    rows = [
        (row, condition, row.number(*VERDICT_SPEEDS), _in_si(row, "Allowed"), _in_si(row, *VERDICT_HEADS))
        for table in tables
        for row in table.rows
        if "Component" in table.heads and (condition := _condition(table, row))
    ]
    judged = [(row, *about, at, allowed, value) for row, *about, at, allowed, value in rows if at and allowed and value]
    names = sorted({_component(one[0], ()) for one in judged}, key=len)
    for one, other in itertools.combinations(judged, 2):
        what = _component(one[0], names), one[1]
        # At a resonance some tenths of an rpm tell: 863 rpm, of three digits, may not be the 862.6 rpm beside it.
        finer = min(one[2].half, other[2].half)
        if what != (_component(other[0], names), other[1]) or abs(one[2].value - other[2].value) > finer * (1 + 1e-6):
            continue
        if one[3].agrees(other[3]):
            yield from _differs(f"value of {what[0]}, {what[1]},", one[4], other[4])


def _condition(table: PrintedTable, row: PrintedRow) -> str:
    """Condition of a row, from its own column, the caption or the title of its group; empty where none is told."""
    match = re.search("in normal operation, ([^,]*(?:, (?!and )[^,]*)*)", table.caption)
    grouped = "further conditions" in table.caption or table.caption.startswith("Verdict on every")
    group = row.group if grouped and not row.group.startswith("Worst of") else ""
    return (row.text(*CONDITION_HEADS) or (match[1] if match else "") or group).lower()


def _in_si(row: PrintedRow, *heads: str) -> Printed | None:
    """Number of a row whose unit may stand behind the name of its component, in the unit without prefix."""
    number, match = row.number(*heads, trimmed=True), re.search(r", (\S+)$", row.text("Component"))
    return number.times(SI.get(match[1], 1.0)) if number is not None and match else number


def _component(row: PrintedRow, names: Sequence[str]) -> str:
    """Name of a component without what stands in brackets or as a formula behind it; the shortest one that begins it."""
    name = re.sub(r"\(.*|\$.*|, \S+$", "", row.text("Component")).strip()
    return next((one for one in names if f"{name} ".startswith(f"{one} ")), name)


def unit_faults(tables: Sequence[PrintedTable]) -> Iterator[str]:
    """Components whose torques or powers have more than one unit in the document."""
    units: dict[tuple[str, str], set[str]] = {}
    rows = [row for table in tables if "Component" in table.heads for row in table.rows]
    names = sorted({_component(row, ()) for row in rows if row.text("Component")}, key=len)
    for row in rows:
        for head in VERDICT_HEADS:
            behind = re.search(r", (\S+)$", row.text("Component"))
            unit = row.unit(head) or (behind[1] if behind else "")
            if unit in SI and unit not in ("deg", "mrad"):
                units.setdefault((_component(row, names), unit.lstrip("kM")), set()).add(unit)
    for table in tables:
        for row in table.rows if table.caption.startswith(("Operating instructions", "Passage")) else ():
            unit, component = row.text("Unit"), row.text("Limit").partition(",")[0]
            if unit in SI and (component, unit.lstrip("kM")) in units:
                units[component, unit.lstrip("kM")].add(unit)
    for (component, _), units_told in units.items():
        if len(units_told) > 1:
            yield f"{component} is told in {', '.join(sorted(units_told))}"


def distance_faults(text: str, tables: Sequence[PrintedTable]) -> Iterator[str]:
    """Distances of critical speeds from rated speed in percent, against the critical speeds."""
    rated = RATED.search(text)
    sentence = re.search(r"Distance of the critical speeds from rated speed, .*? rpm: (.*)\.", text)
    if rated is None or sentence is None:
        return
    speeds: dict[str, list[Printed]] = {}
    told: set[str] = set()
    for table in tables:
        for row in table.rows:
            if (critical := row.number("Critical speed")) is not None:
                speeds.setdefault(row.text("Order").partition(",")[0], []).append(critical)
    for order, share in re.findall(r"([^;]+?), mode \d+: \+?([−\d.]+)\s%", sentence[1]):
        printed = Printed.read(share)
        expected = [
            (one / Printed(float(rated[1]))).times(100) - Printed(100.0) for one in speeds.get(order.strip(), [])
        ]
        if printed is not None and expected and not any(printed.agrees(one) for one in expected):
            yield f"distance of {order.strip()} is printed as {printed}, its critical speed gives {expected[0]}"
        told.add(order.strip())
    for row in (row for table in tables if table.caption.startswith("Critical speeds in normal") for row in table.rows):
        # The sum of orders of one frequency has the critical speed of each of them.
        if " + " not in row.text("Order") and row.text("Order") not in told:
            yield f"distance of {row.text('Order')} is not told"


def repeated_faults(tables: Sequence[PrintedTable]) -> Iterator[str]:
    """Rows that stand twice: one component at one speed, as a peak with two names."""
    for table in tables:
        if not table.caption.startswith(("Components in normal", "Peaks of the sum")):
            continue
        seen: set[tuple[str, ...]] = set()
        for row in table.rows:
            place = row.group, row.text("Component"), row.text("Place"), row.text("Speed")
            if place in seen:
                yield f"{table.caption}: {row.text('Component')} at {row.text('Speed')} rpm stands twice"
            seen.add(place)


def made_faults(tables: Sequence[PrintedTable]) -> Iterator[str]:
    """Peaks whose mode and order are not among the critical speeds, listed or named below their table."""
    listed = next((one for one in tables if one.caption.startswith("Critical speeds in normal")), None)
    peaks = next((one for one in tables if one.caption.startswith("Components in normal")), None)
    if listed is None or peaks is None:
        return
    known = {f"{order}, {row.group.partition(',')[0].lower()}" for row in listed.rows for order in _orders(row)}
    for row in peaks.rows:
        made = row.text("Made by")
        order, _, mode = made.partition(", mode ")
        names = [f"{one}, mode {mode}" for one in order.split(" + ")]
        if mode and not any(name in known or name in note for name in names for note in [*listed.notes, ""]):
            yield f"{made} makes a peak at {row.text('Speed')} rpm and is no critical speed of the table"


def _orders(row: PrintedRow) -> list[str]:
    """Orders of a row of critical speeds, each of a sum."""
    return row.text("Order").split(" + ")


def rated_stress_faults(tables: Sequence[PrintedTable]) -> Iterator[str]:
    """Stress judged at rated speed in the measurement plan, where it is none of the shafts' stresses at rated speed."""
    normal = next((one for one in tables if "at rated speed in normal operation" in one.caption), None)
    for table in tables if normal is not None else ():
        condition = table.caption.partition("; condition ")[2]
        if "Judged" not in table.heads or (condition and f", {condition}," not in normal.caption):
            continue
        known = [
            one for row in normal.rows if (one := row.number("At rated")) is not None and row.text("Unit") == "N/mm²"
        ]
        for row in table.rows:
            stress = row.number("Judged")
            if stress is not None and "Rated" in row.text("What it is") and not any(map(stress.agrees, known)):
                yield f"{table.caption}: stress of {stress} judged at rated speed is no component's there"


def rated_condition_faults(tables: Sequence[PrintedTable]) -> Iterator[str]:
    """Values at rated speed in the normal condition, and those allowed, that two tables print differently."""
    normal = next((one for one in tables if "at rated speed in normal operation" in one.caption), None)
    by_condition = [one for one in tables if one.caption.endswith(", by condition")]
    for table in by_condition if normal is not None else ():
        for row, head in zip(table.rows[:2], ("Allowed at rated", "At rated"), strict=True):
            for column, cell in zip(table.heads, row.cells, strict=True):
                component, _, unit = column.rpartition(", ")
                known = [
                    one.number(head)
                    for one in normal.rows
                    if component.split(" $")[0] == one.text("Component") and unit == one.text("Unit")
                ]
                number, others = Printed.read(cell), [one for one in known if one is not None]
                if number is not None and others and not any(map(number.times(SI.get(unit, 1.0)).agrees, others)):
                    yield f"{table.caption}: {column} is {number}, no value {head.lower()} of it elsewhere"
