"""Files of tracked complex orders: CSV with a row for each time and order, and columns for each channel."""

from __future__ import annotations

import csv
import io
import json
import os
import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from torsionnet.base.atomic import write_text
from torsionnet.base.delimited.dialect import detect_encoding
from torsionnet.base.errors import Fault, ModelError, Position, UsageError, unreadable_file
from torsionnet.base.notes import Note, NoteOrText, note_data, stored_note
from torsionnet.base.units import RPM, UnitError, convert
from torsionnet.linear.frequency_response import Channel
from torsionnet.machinery.excitations.measured_excitation import MeasuredLines, measured_lines, read_order_table
from torsionnet.machinery.orders.order_line import is_sum_name
from torsionnet.signals.orders.tracked_orders import VOLD_KALMAN_POLES, MeasuredOrder, TrackedOrders, TrackingKernel
from torsionnet.signals.recording import QUANTITY_UNITS, FloatArray

LEADING_COLUMNS = ("time [s]", "speed [rpm]", "order")
"""First columns of a file of tracked orders."""
PARTS = ("real", "imag", "half_width", "half_range")
"""Columns of each channel: complex peak amplitude, half width of its interval, half range of the signal."""
_COLUMN = re.compile(r"(?P<name>.*) (?P<part>real|imag|half_width|half_range) \[(?P<unit>[^\]]*)\]")
_TITLE, _REFERENCE, _NOTE, _UNDECIDED, _RELATED = "title", "reference", "note", "sign undecided", "related within [s]"
_TRACKING, _NOTES = "tracking", "notes"
_FILTER = re.compile(r"Vold-Kalman filter of (\d) poles, bandwidth ([\d.e+-]+) (Hz|% of the order's frequency)")
_BLOCKS = re.compile(r"average over blocks of (\d+) cycles of (\d+) turns")
"""Notes that tell how orders were tracked in files without a line of their own for it."""
_KNOWN = "torque, angle, velocity, acceleration or stress"
MOST_FAULTS = 20
"""Most faulty cells of a file that a message lists."""


def write_tracked_orders(orders: Sequence[TrackedOrders], path: str | os.PathLike[str]) -> None:
    """Write tracked orders of channels with common times and orders as a CSV file, in SI units, whole or not at all.

    Raises
    ------
    UsageError
        The channels differ in times, orders or reference.

    Examples
    --------
    >>> import tempfile
    >>> tracked = TrackedOrders(
    ...     "T", "torque", np.array([6.0]), np.array([0.5]), np.array([20.0]), np.array([[3 + 4j]]), np.ones((1, 1)),
    ...     reference="top dead centre of cylinder 1",
    ... )
    >>> path = Path(tempfile.mkdtemp(), "orders.csv")
    >>> write_tracked_orders([tracked], path)
    >>> (again,) = read_tracked_orders(path)
    >>> again.along(6).tolist(), again.reference
    ([(3+4j)], 'top dead centre of cylinder 1')
    """
    write_text(path, tracked_orders_text(orders))


def tracked_orders_text(orders: Sequence[TrackedOrders]) -> str:
    """Text of a file of tracked orders."""
    first = _common(orders)
    out = io.StringIO()
    heads = [(_TITLE, first.title), (_REFERENCE, first.reference)]
    heads += [(_UNDECIDED, ", ".join(f"{order!r}" for order in first.undecided))]
    heads += [(_RELATED, ", ".join(f"{time:.6g}" for time in first.related_within))]
    known = {name: value for name, value in asdict(first.tracking).items() if value}
    heads += [(_TRACKING, json.dumps(known) if first.tracking.known else "")]
    notes = {tracked.name: list(map(note_data, tracked.notes)) for tracked in orders}
    lines = [f"{tracked.name}: {note}" for tracked in orders for note in tracked.notes]
    if all(list(map(note_data, _notes(lines, name, notes))) == own for name, own in notes.items()):
        heads += [(_NOTE, line) for line in lines]
    else:  # names or texts with colons, or a warning about a channel
        heads += [(_NOTES, json.dumps(notes))]
    for key, text in heads:
        if text:
            out.write(f"# {key}: {' '.join(text.split())}\n")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(
        [*LEADING_COLUMNS, *(f"{tracked.name} {part} [{tracked.unit}]" for tracked in orders for part in PARTS)]
    )
    for at, (time, rpm) in enumerate(zip(first.times.tolist(), first.rpm.tolist(), strict=True)):
        for place, order in enumerate(first.orders.tolist()):
            cells: list[float | str] = [time, rpm, order]
            for tracked in orders:
                value, width = complex(tracked.values[place, at]), float(tracked.half_widths[place, at])
                half = "" if tracked.half_range is None else float(tracked.half_range[at])
                cells += [value.real, value.imag, "" if np.isnan(width) else width, half]
            writer.writerow(cells)
    return out.getvalue()


def _common(orders: Sequence[TrackedOrders]) -> TrackedOrders:
    if not orders:
        raise UsageError("there are no tracked orders to write", kind="missing-data")
    first, names = orders[0], [tracked.name for tracked in orders]
    for tracked in orders[1:]:
        if names.count(tracked.name) > 1:
            raise UsageError(
                f"two channels are named {tracked.name}: a file needs a name for each", kind="repeated-name"
            )
        alike = tracked.times.shape == first.times.shape and tracked.orders.shape == first.orders.shape
        if not (alike and np.allclose(tracked.times, first.times) and np.allclose(tracked.orders, first.orders)):
            raise UsageError(
                f"{tracked.name} and {first.name} were tracked at other times or orders: write them apart",
                kind="unlike-results",
            )
        if (tracked.reference, tracked.undecided) != (first.reference, first.undecided):
            raise UsageError(
                f"{tracked.name} and {first.name} have other references of phase: write them apart",
                kind="unlike-results",
            )
    return first


def read_tracked_orders(path: str | os.PathLike[str]) -> tuple[TrackedOrders, ...]:
    """Tracked orders of each channel of a file, complex peak amplitudes in SI over time and speed.

    Raises
    ------
    UsageError
        No such file, or its columns are not those of tracked orders.
    ModelError
        Columns that are missing, a unit that is not known, cells without a number, rows that are missing or twice; with
        their place.
    """
    file = Path(path)
    heads, notes, rows = _read(file)
    heading, *body = rows or [(1, [])]
    channels = _channels(file, *heading)
    numbers = _numbers_of_rows(file, heading[1], body)
    times, begins = np.unique(numbers[:, 0], return_index=True)
    orders = np.unique(numbers[:, 2])
    faults = _misplaced(file, numbers, [line for line, _ in body], len(times) * len(orders))
    if faults:
        raise ModelError(faults, str(file))
    # By time, then by order, in whatever order the lines stand.
    sorted_rows = numbers[np.lexsort((numbers[:, 2], numbers[:, 0]))].reshape(len(times), len(orders), -1)
    undecided = tuple(float(text) for text in heads.get(_UNDECIDED, "").split(",") if text.strip())
    related = tuple(float(text) for text in heads.get(_RELATED, "").split(",") if text.strip())
    tracking = _tracking(file, heads.get(_TRACKING, ""), notes)
    stored = _stored_notes(file, heads.get(_NOTES, ""), notes, channels)
    tracked = []
    for name, (quantity, columns) in channels.items():
        parts = {part: sorted_rows[:, :, place] * factor for part, (place, factor) in columns.items()}
        widths = parts.get("half_width", np.full(sorted_rows.shape[:2], np.nan))
        half: FloatArray | None = parts["half_range"][:, 0] if "half_range" in parts else None
        tracked.append(TrackedOrders(
            name, quantity, orders, times, numbers[begins, 1] / RPM, (parts["real"] + 1j * parts["imag"]).T, widths.T,
            None if half is None or np.isnan(half).all() else half, heads.get(_REFERENCE, ""), heads.get(_TITLE, ""),
            stored[name], undecided, related, tracking,
        ))  # fmt: skip
    return tuple(tracked)


def _tracking(file: Path, text: str, notes: Iterable[str]) -> TrackingKernel:
    """Weights with which the orders of a file were tracked, by its own line, or by the notes of an older file."""
    try:
        if text:
            said = {str(name): float(value) for name, value in json.loads(text).items()}
            poles = int(said.pop("poles", VOLD_KALMAN_POLES))
            return TrackingKernel(**said, poles=poles)
    except (ValueError, TypeError, AttributeError) as error:
        raise UsageError(f"the line {_TRACKING} of {file} is damaged: {error}", kind="unreadable-file") from None
    for note in notes:
        if match := _FILTER.search(note):
            poles, width, unit = int(match[1]), float(match[2]), match[3]
            return TrackingKernel(width if unit == "Hz" else 0.0, 0.0 if unit == "Hz" else width / 100, poles)
        if match := _BLOCKS.search(note):
            cycles, turns = int(match[1]), int(match[2])
            return TrackingKernel(revolutions=float(cycles * turns), taper=float(turns))
    return TrackingKernel()


def _stored_notes(
    file: Path, text: str, lines: Iterable[str], names: Collection[str]
) -> dict[str, tuple[NoteOrText, ...]]:
    """Notes on the orders of each channel, from their own line or from lines that begin with its name."""
    try:
        data = json.loads(text) if text else {}
        own = {name: tuple(map(stored_note, data[name])) for name in names if name in data}
    except (ValueError, TypeError, KeyError) as error:
        raise UsageError(f"the line {_NOTES} of {file} is damaged: {error}", kind="unreadable-file") from None
    return {name: own.get(name, tuple(_notes(lines, name, names))) for name in names}


def _notes(lines: Iterable[str], name: str, known: Collection[str]) -> Iterator[NoteOrText]:
    """Notes on the orders of a channel, from lines of a file that begin with its name; twice where it is the subject.

    >>> list(_notes(["T: averaged", "fly: averaged", "fly: fly: 1 pulse missing"], "fly", ["T", "fly"]))
    ['averaged', Note(text='1 pulse missing', severity='note', channel='fly')]
    """
    for line in lines:
        owner = max((channel for channel in known if line.startswith(f"{channel}: ")), key=len, default="")
        text = line.removeprefix(f"{name}: ")
        rest = text.removeprefix(f"{name}: ")
        if owner == name:
            yield stored_note(text) if rest == text else Note(rest, channel=name)


def is_tracked_table(path: str | os.PathLike[str]) -> bool:
    """Whether a file has the leading columns of tracked orders."""
    try:
        rows = _read(Path(path))[2]
    except UsageError:
        return False
    return bool(rows) and tuple(rows[0][1][: len(LEADING_COLUMNS)]) == LEADING_COLUMNS


def _read(file: Path) -> tuple[dict[str, str], list[str], list[tuple[int, list[str]]]]:
    """Heads by key, notes, and rows with the number of their line."""
    try:
        lines = file.read_text(encoding=detect_encoding(file), errors="replace").splitlines()
    except OSError as error:
        raise unreadable_file(file, error) from None
    heads: dict[str, str] = {}
    notes: list[str] = []
    rows: list[tuple[int, list[str]]] = []
    for number, line in enumerate(lines, 1):
        if line.startswith("#"):
            key, _, text = line[1:].strip().partition(": ")
            if key == _NOTE:
                notes.append(text)
            else:
                heads[key] = text
        elif line.strip():
            rows.append((number, next(csv.reader([line]))))
    return heads, notes, rows


def _misplaced(file: Path, numbers: FloatArray, lines: Sequence[int], wanted: int) -> list[Fault]:
    """Fault for each row whose time and order another row has, or one for rows that are missing."""
    seen: dict[tuple[float, float], int] = {}
    faults = []
    for line, (time, order) in zip(lines, numbers[:, [0, 2]].tolist(), strict=True):
        first = seen.setdefault((time, order), line)
        if first != line:
            text = f"order {order:g} at {time:g} s stands in line {first}, too: leave one of the rows out"
            faults.append(Fault(text, position=Position(file.name, line, 1, 2), kind="repeated-name"))
    if not faults and len(numbers) != wanted:
        text = f"{wanted - len(numbers)} of {wanted} rows are missing: each time needs a row for each order"
        faults.append(Fault(text, position=Position(file.name, lines[-1], 1, 2), kind="wrong-count"))
    return faults[:MOST_FAULTS]


def _channels(file: Path, line: int, heading: list[str]) -> dict[str, tuple[str, dict[str, tuple[int, float]]]]:
    """Quantity of each channel, and the place of each of its columns with the factor to SI."""
    channels: dict[str, tuple[str, dict[str, tuple[int, float]]]] = {}
    faults: list[Fault] = []
    units = {unit: quantity for quantity, unit in QUANTITY_UNITS.items()}
    if tuple(heading[: len(LEADING_COLUMNS)]) != LEADING_COLUMNS:
        raise UsageError(
            f"{file.name} is no file of tracked orders: its columns begin with {', '.join(LEADING_COLUMNS)}; "
            "torsionnet track -o writes such a file",
            kind="wrong-file",
        )
    for place, text in enumerate(heading):
        match = _COLUMN.fullmatch(text)
        if not match:
            continue
        quantity, factor = units.get(match["unit"]), 1.0
        # Another unit of a known quantity, as deg or kN*m, is converted.
        for unit, named in units.items():
            if quantity is None and match["unit"]:
                try:
                    quantity, factor = named, float(convert(1, match["unit"], unit))
                except UnitError:
                    continue
        channels.setdefault(match["name"], (quantity or "", {}))[1][match["part"]] = (place, factor)
        if match["unit"] and not quantity:
            faults.append(
                _heading_fault(file, line, heading, place, f'"{match["unit"]}" is no unit of {_KNOWN}', "unknown-unit")
            )
    for name, (_, parts) in (channels or {"NAME": ("", {})}).items():
        if not {"real", "imag"} <= parts.keys():
            text = f"there are no columns {name} real and {name} imag, with a unit in brackets"
            first = min((place for place, _ in parts.values()), default=0)
            faults.append(_heading_fault(file, line, heading, first, text, "missing-column"))
    if faults:
        raise ModelError(faults[:MOST_FAULTS], str(file))
    return channels


def _heading_fault(file: Path, line: int, heading: Sequence[str], place: int, text: str, kind: str) -> Fault:
    column = len(",".join(heading[:place])) + (place > 0) + 1
    return Fault(text, position=Position(file.name, line, column, column + len(heading[place])), kind=kind)


def _numbers_of_rows(file: Path, heading: list[str], body: list[tuple[int, list[str]]]) -> FloatArray:
    """Numbers of all rows, NaN for empty cells of half widths and half ranges."""
    may_lack = [text.endswith("]") and (" half_width [" in text or " half_range [" in text) for text in heading]
    rows, faults = [], []
    for line, cells in body:
        row = []
        for place, text in enumerate(heading):
            cell = cells[place].strip() if place < len(cells) else ""
            try:
                row.append(float("nan") if not cell and may_lack[place] else float(cell))
                if place < len(LEADING_COLUMNS) and not np.isfinite(row[-1]):
                    raise ValueError(cell)
            except ValueError:
                column = len(",".join(cells[:place])) + (place > 0) + 1
                said = f'"{cell}" is no number' if cell else "there is no number"
                faults.append(
                    Fault(
                        f"{text}: {said}",
                        position=Position(file.name, line, column, column + max(len(cell), 1)),
                        kind="not-a-number",
                    )
                )
                row = [*row[:place], float("nan")]
        rows.append(row)
    if faults:
        raise ModelError(faults[:MOST_FAULTS], str(file))
    if not rows:
        raise UsageError(f"{file.name} has no rows below its headings", kind="missing-data")
    return np.array(rows)


# Reading of measured orders from CSV files, tables of order tracking, or files of ``torsionnet orders --csv``.

EXPECTED_COLUMNS = "speed [rpm], order, amplitude [N*m]"
"""Columns of an order table, as error messages name them."""
LINE_UNITS = {"torque": "N*m", "angle": "rad", "speed": "rad/s", "acceleration": "rad/s^2"}
"""SI unit of the amplitudes in an order table by quantity."""
_OF_OUTPUT = re.compile(r"(?P<name>.*) (?P<part>real|imag) (?P<unit>\[.*\])")
_WRITTEN = ("excitation", "frequency [Hz]")
"""Columns of a file of ``torsionnet orders``, beside speed and order, by which such a file is recognised."""


def read_orders(path: str | os.PathLike[str], output: Channel, configuration: str = "") -> tuple[MeasuredOrder, ...]:
    """Measured orders of an output in a file, with amplitudes in the SI unit of the output over speed in rad/s.

    Parameters
    ----------
    path : path
        Headings with units and rows below: speed, order, and amplitude, rms or peak_to_peak, with or without phase, or
        real and imag, with or without half_width; or a file of ``torsionnet orders`` or of ``torsionnet track``, of
        which the columns of the output are taken, and orders of the reference shaft.
    output : Channel
    configuration : str, optional
        Configuration whose rows are taken from a file with several.

    Raises
    ------
    ModelError
        A line that is no row of numbers, or headings that mean nothing.
    UsageError
        No such file or columns, or amplitudes in a unit of something else.
    """
    if is_tracked_table(path):
        return tracked_channel(path, output).measured()
    rows = _cells(Path(path))
    if _is_written(rows):
        lines = _of_this_package(Path(path).name, rows, output, configuration)
    else:
        columns, numbers = read_order_table(Path(path))
        lines = measured_lines(columns, np.array(numbers))
    if not lines.speeds or lines.by_frequency:
        raise UsageError(
            f"{Path(path).name} has no amplitudes by speed and order; expected {EXPECTED_COLUMNS}",
            kind="missing-column",
        )
    if LINE_UNITS[lines.quantity] != output.unit:
        raise UsageError(
            f"{Path(path).name} is in {LINE_UNITS[lines.quantity]}, but {output.name} is in {output.unit}",
            kind="wrong-unit",
        )
    return tuple(
        MeasuredOrder(
            order,
            lines.speeds[line],
            np.abs(lines.values[line]),
            lines.values[line] if lines.has_phase else None,
            lines.half_widths[line] if lines.half_widths else None,
        )
        for line, order in enumerate(lines.keys.tolist())
    )


def tracked_channel(path: str | os.PathLike[str], output: Channel) -> TrackedOrders:
    """Tracked orders (SI) of the channel with the name of an output, or of the only one with its unit."""
    tracked = read_tracked_orders(path)
    named = [channel for channel in tracked if channel.name == output.name]
    fitting = named or [channel for channel in tracked if channel.unit == output.unit]
    names = ", ".join(f"{channel.name} in {channel.unit}" for channel in tracked)
    if len(fitting) != 1:
        which = "several channels" if fitting else "no channel"
        raise UsageError(
            f"{Path(path).name} has {which} for {output.name} in {output.unit}; there are {names}: name the channel as "
            "the output",
            kind="ambiguous-name",
        )
    if fitting[0].unit != output.unit:
        raise UsageError(f"{Path(path).name}: {names}, but {output.name} is in {output.unit}", kind="wrong-unit")
    return fitting[0]


def is_written_table(path: str | os.PathLike[str]) -> bool:
    """Whether a file is of ``torsionnet orders`` or ``torsionnet track``, whose columns name the outputs."""
    return is_tracked_table(path) or _is_written(_cells(Path(path)))


def _is_written(rows: Sequence[list[str]]) -> bool:
    return bool(rows) and all(name in rows[0] for name in _WRITTEN)


def _cells(path: Path) -> list[list[str]]:
    """Cells of every line of an order table that is neither empty nor a comment."""
    try:
        text = path.read_text(encoding=detect_encoding(path), errors="replace")
    except OSError as error:
        raise unreadable_file(path, error) from None
    return list(csv.reader(line for line in text.splitlines() if line.strip() and line[0] != "#"))


def _of_this_package(file: str, rows: Sequence[list[str]], output: Channel, configuration: str) -> MeasuredLines:
    """Orders of the output in a file of ``torsionnet orders``, complex amplitudes in SI, equal frequencies added."""
    heading, *written = rows
    excitation = heading.index("excitation")
    chosen = [cells for cells in written if not is_sum_name(cells[excitation])]
    parts = {}
    for place, name in enumerate(heading):
        match = _OF_OUTPUT.fullmatch(name)
        if match and match["name"] == output.name:
            parts[match["part"]] = (place, match["unit"])
    if len(parts) < 2:
        text = f"{file} has no columns {output.name} real and {output.name} imag"
        raise UsageError(f"{text}; write it with torsionnet orders --csv --output {output.name}", kind="missing-column")
    if "configuration" in heading:
        of = heading.index("configuration")
        known = dict.fromkeys(cells[of] for cells in chosen)
        if len(known) > 1 and configuration not in known:
            raise UsageError(
                f"{file} has the configurations {', '.join(known)}; choose one of them with -c", kind="missing-entry"
            )
        chosen = [cells for cells in chosen if len(known) == 1 or cells[of] == configuration]
    places = [heading.index("speed [rpm]"), heading.index("frequency [Hz]"), parts["real"][0], parts["imag"][0]]
    try:
        numbers = np.array([[float(cells[place]) for place in places] for cells in chosen])
    except (IndexError, ValueError):
        raise UsageError(
            f"{file} has incomplete rows or cells without a number; write it again with torsionnet orders --csv",
            kind="not-a-number",
        ) from None
    sums: dict[tuple[float, float], complex] = {}
    for speed, frequency, real, imag in numbers.tolist():
        # Order 60 f/n with the speed n in r/min; amplitudes of one order add up with their phases.
        key = (speed, round(60 * frequency / speed, 9))
        sums[key] = sums.get(key, 0) + complex(real, imag)
    table = np.array([(speed, order, value.real, value.imag) for (speed, order), value in sums.items()])
    return measured_lines(["speed [rpm]", "order", *(f"{part} {parts[part][1]}" for part in ("real", "imag"))], table)
