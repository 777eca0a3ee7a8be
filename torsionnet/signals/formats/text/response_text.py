"""Frequency responses in CSV files, those written here to the last digit, and tables of magnitude and phase."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, islice
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.base.conventions import ANGLES, FREQUENCIES, Conventions
from torsionnet.base.delimited.dialect import Dialect
from torsionnet.base.delimited.number_rows import NumberRows
from torsionnet.base.errors import Fault, FaultyValueError, ModelError, Position, did_you_mean
from torsionnet.linear.frequency_response import SIGN_NOTE, FloatArray, FrequencyResponse
from torsionnet.signals.formats.text.record_text import description_in, write_columns
from torsionnet.signals.response_description import (
    KEY,
    UNKNOWN_UNIT,
    ResponseMatrix,
    SingleResponse,
    description,
    estimation_in,
    is_key,
    parse_description,
    resolve_units,
    response_from,
    usable_limit_in,
)

# Headings of a table of frequency responses, with quantity and unit of each column.

UNITS = ("rad", "rad/s", "rad/s^2", "N*m", "Pa")
_UNIT = re.compile(r"(?P<what>.*?)\s*(?:\[(?P<unit>[^\]]*)\])?\s*")
_TORQUE = re.compile(r"\bN[.·-]?m\b")
LIKE_UNITS = (UNKNOWN_UNIT, "-")
"""Texts that stand for the unit of a ratio of like signals in a table of frequency responses."""
KNOWN_UNITS = "rad/(N*m), deg/(N*m), (N*m)/rad, N*m/(N*m), 1"
"""Examples of units of frequency responses for error messages."""
_KINDS = (
    ("magnitude", re.compile(r"\|(?P<pair>.+)\|")),
    ("phase", re.compile(r"phase (?P<pair>.+)")),
    ("re", re.compile(r"re (?P<pair>.+)")),
    ("im", re.compile(r"im (?P<pair>.+)")),
    ("coherence", re.compile(r"coherence (?P<pair>.+)")),
)
EXPECTED = "expected frequency [Hz], then |output/input| [rad/(N*m)] and phase output/input [deg], or re and im"
"""Expected headings of a table of frequency responses, as error messages give them."""


@dataclass(frozen=True)
class ColumnHeading:
    """Heading of a column of responses, with kind, pair (output, input), SI units and the factor from SI to values."""

    kind: str
    unit: str = ""
    pair: tuple[str, str] | None = None
    above: str = UNKNOWN_UNIT
    below: str = UNKNOWN_UNIT
    scale: float = 1.0


class _HeadingError(FaultyValueError):
    pass


def headings(line: str, separator: str, place: Position) -> list[ColumnHeading]:
    """Headings of all columns of a table of frequency responses; ModelError lists all that are not understood."""
    columns: list[ColumnHeading] = []
    places: list[Position] = []
    faults: list[Fault] = []
    for column, text in enumerate(next(csv.reader([line], delimiter=separator))):
        start = line.find(text) + 1
        places.append(Position(place.file, place.line, start, start + len(text), line))
        try:
            columns.append(_heading(text.strip(), first=column == 0))
        except _HeadingError as error:
            faults.append(error.fault.at(places[-1]))
    faults += (
        [fault.at(place if at is None else places[at]) for fault, at in _incomplete(columns)] if not faults else []
    )
    if faults:
        raise ModelError(faults, place.file)
    return columns


def _incomplete(columns: list[ColumnHeading]) -> list[tuple[Fault, int | None]]:
    """Faults of responses that lack a column or have one twice, each with the place of their last column."""
    kinds: dict[tuple[str, str], list[str]] = {}
    last: dict[tuple[str, str], int] = {}
    for at, heading in enumerate(columns):
        if heading.pair:
            kinds.setdefault(heading.pair, []).append(heading.kind)
            last[heading.pair] = at
    faults: list[tuple[Fault, int | None]] = []
    if not kinds:
        faults.append((Fault(f"there is no frequency response; {EXPECTED}", kind="wrong-file"), None))
    for pair, have in kinds.items():
        output, driven = pair
        label = f"{output}/{driven}"
        if len(set(have)) < len(have):
            faults.append((Fault(f"{label} has two columns of one kind", kind="repeated-name"), last[pair]))
        elif sorted(set(have) - {"coherence"}) not in (["magnitude", "phase"], ["magnitude"], ["im", "re"]):
            text = f"{label} needs |{label}|, with phase {label} if there is one, or re {label} and im {label}"
            faults.append((Fault(text, kind="missing-column"), last[pair]))
    phases = {"phase" in have or "re" in have for have in kinds.values()}
    if len(phases) > 1 and not faults:
        text = "some responses have a phase and some have not; put them into files of their own"
        faults.append((Fault(text, kind="unlike-results"), None))
    return faults


def _heading(text: str, *, first: bool) -> ColumnHeading:
    match = _UNIT.fullmatch(text)
    what, unit = (match["what"], (match["unit"] or "").strip()) if match else (text, "")
    if first:
        return _frequency(what, unit)
    if what == "conditioning":
        return ColumnHeading("conditioning")
    for kind, pattern in _KINDS:
        named = pattern.fullmatch(what)
        if named:
            return _pair(kind, named["pair"], unit)
    raise _HeadingError(f'"{text}" is no heading of a frequency response; {EXPECTED}', kind="unknown-entry")


def _frequency(what: str, unit: str) -> ColumnHeading:
    if what != "frequency":
        raise _HeadingError(f'the first column is "{what}"; {EXPECTED}', kind="wrong-file")
    if unit not in FREQUENCIES:
        expected = f"expected {', '.join(FREQUENCIES)}"
        raise _HeadingError(
            f'"{unit}" is no unit of frequency{did_you_mean(unit, FREQUENCIES)}; {expected}'.replace("?;", "?"),
            kind="unknown-unit",
        )
    return ColumnHeading("frequency", unit)


def _pair(kind: str, label: str, unit: str) -> ColumnHeading:
    output, slash, driven = label.partition("/")
    if not slash or "/" in driven:
        raise _HeadingError(f'"{label}" is not of the form output/input', kind="wrong-form")
    if kind == "coherence":
        return ColumnHeading(kind, unit, (output, driven))
    if kind == "phase":
        if unit != "deg":
            raise _HeadingError(f'the phase of {label} is in "{unit}"; expected deg', kind="wrong-unit")
        return ColumnHeading(kind, unit, (output, driven))
    if unit.startswith("dB"):
        raise _HeadingError(
            f"{label} is a level in dB; write the table without --db, levels are rounded and have lost their sign",
            kind="wrong-unit",
        )
    return ColumnHeading(kind, unit, (output, driven), *_units_of_ratio(unit, label))


def _units_of_ratio(unit: str, label: str) -> tuple[str, str, float]:
    """SI units of output and input in the unit of their ratio, and the factor from SI to the values shown."""
    if not unit:
        raise _HeadingError(f"{label} has no unit; expected one such as {KNOWN_UNITS}", kind="missing-unit")
    if unit in LIKE_UNITS:
        return UNKNOWN_UNIT, UNKNOWN_UNIT, 1.0
    unit = _TORQUE.sub("N*m", unit)
    for above in UNITS:
        for below in UNITS:
            for written in map(Conventions, ANGLES):
                shown = [written.unit(side) for side in (above, below)]
                ways = {f"{top}/({shown[1]})" for top in (shown[0], f"({shown[0]})")}
                if "/" not in shown[1]:
                    ways |= {f"{top}/{shown[1]}" for top in (shown[0], f"({shown[0]})")}
                if unit in ways:
                    return above, below, written.scale(above) / written.scale(below)
    raise _HeadingError(
        f'"{unit}" is no unit of {label} that is known here; expected one such as {KNOWN_UNITS}', kind="unknown-unit"
    )


_DECIMAL_COMMA = re.compile(r"-?\d+,\d+")
SEPARATORS = (";", "\t", ",")
"""Separators of cells that a table of frequency responses may have."""
CONFIGURATION = "configuration"
"""Heading of the first column of a table of frequency responses that ``torsionnet frf --csv`` writes."""


def write(response: FrequencyResponse, path: Path) -> None:
    """Write a CSV file of a frequency response in SI, with a description, headings, real and imaginary parts."""
    columns: list[tuple[str, FloatArray]] = [("frequency [Hz]", response.frequencies)]
    for o, out in enumerate(response.outputs):
        for i, into in enumerate(response.inputs):
            label, unit = f"{out.name}/{into.name}", response.unit(o, i)
            values = response.values[:, o, i]
            columns += [(f"re {label} [{unit}]", values.real), (f"im {label} [{unit}]", values.imag)]
            if response.coherence is not None:
                columns.append((f"coherence {label} [1]", response.coherence[:, o, i]))
    if response.conditioning is not None:
        columns.append(("conditioning [1]", response.conditioning))
    names, numbers = zip(*columns, strict=True)
    write_columns(path, KEY, description(response), [_quoted(name) for name in names], numbers)


def _quoted(name: str) -> str:
    name = " ".join(name.split())
    return '"' + name.replace('"', '""') + '"' if any(mark in name for mark in ',;"\t') else name


def read(path: Path) -> FrequencyResponse:
    """Frequency response in SI from a CSV file; ModelError lists every fault with its line."""
    comments: list[str] = []
    with path.open(encoding="utf-8-sig") as file:
        configurations: dict[str, None] = {}
        lines = _without_configuration(configurations, _apart_from(comments, file))
        filled = list(islice(((number, line) for number, line in enumerate(lines, 1) if line.strip()), 2))
        if len(filled) < 2:
            place = Position(path.name, 1, 1, 1, next(iter([*comments, *(line for _, line in filled)]), "")[:200])
            raise ModelError(
                [Fault("there are no rows of numbers below a heading", position=place, kind="wrong-file")], path.name
            )
        (number, heading), (start, first) = filled
        heading = heading.rstrip("\n")
        stored = description_in(comments, KEY)
        separator = "," if stored is not None else max(SEPARATORS, key=heading.count)
        place = Position(path.name, number, 1, 1, heading[:200])
        columns = headings(heading, separator, place) if stored is None else []
        names = next(csv.reader([heading], delimiter=separator))
        rows = NumberRows(
            chain([first], lines), path.name, Dialect(separator), len(names), start, names, own=stored is not None,
            other_width=_other_width, no_number=_no_number,
        )  # fmt: skip
        numbers = next(rows.blocks(range(len(names)), 0))
    if len(configurations) > 1:
        text = f"the table holds the configurations {', '.join(configurations)}; keep the rows of one of them"
        raise ModelError([Fault(text, position=place, kind="unlike-results")], path.name)
    if stored is not None:  # the description has the names, whatever characters are in them
        return _own(stored, [name.split(" ")[0] for name in names], np.column_stack(numbers))
    return _foreign(columns, numbers, [comment[1:].strip() for comment in comments], path)


def _apart_from(comments: list[str], lines: Iterable[str]) -> Iterator[str]:
    """Yield the lines of a file with empty ones in place of comments, which are collected in ``comments``."""
    for line in lines:
        if line.startswith("#"):
            comments.append(line.rstrip("\n"))
        yield "\n" if line.startswith("#") else line


def _without_configuration(configurations: dict[str, None], lines: Iterable[str]) -> Iterator[str]:
    """Yield the lines of a table without a first column, whose names are collected in ``configurations``."""
    beginning = ""
    for line in lines:
        if not beginning and line.strip():
            beginning = next((sign for sign in SEPARATORS if line.startswith(f"{CONFIGURATION}{sign}")), "none")
            yield line.removeprefix(f"{CONFIGURATION}{beginning}")
        elif beginning in ("", "none") or not line.strip():
            yield line
        else:
            name, *cells = next(csv.reader([line.rstrip("\n")], delimiter=beginning))
            configurations[name] = None
            yield beginning.join(cells) + "\n" * line.endswith("\n")


def _other_width(cells: int, width: int) -> str:
    return f"{cells} cells under {width} headings"


def _no_number(cell: str) -> str:
    comma = "; write numbers with a decimal point" if _DECIMAL_COMMA.fullmatch(cell) else ""
    return f'expected a number, got "{cell}"{comma}'


def _own(text: str, kinds: list[str], numbers: FloatArray) -> FrequencyResponse:
    columns = {
        kind: numbers[:, [at for at, other in enumerate(kinds) if other == kind]] for kind in dict.fromkeys(kinds)
    }
    said = parse_description(text)
    shape = (len(numbers), len(said["outputs"]), len(said["inputs"]))
    values = np.empty(shape, dtype=complex)
    values.real, values.imag = columns["re"].reshape(shape), columns["im"].reshape(shape)
    whole: dict[str, Any] = {"frequencies": columns["frequency"][:, 0], "values": values}
    if "coherence" in columns:
        whole["coherence"] = columns["coherence"].reshape(shape)
    if "conditioning" in columns:
        whole["conditioning"] = columns["conditioning"][:, 0]
    return response_from(text, whole)


def _foreign(
    columns: Sequence[ColumnHeading], numbers: Sequence[FloatArray], comments: Sequence[str], path: Path
) -> FrequencyResponse:
    matrix = ResponseMatrix(numbers[0] / FREQUENCIES[columns[0].unit])
    parts: dict[tuple[str, str], dict[str, tuple[ColumnHeading, FloatArray]]] = {}
    for at, column in enumerate(columns):
        if column.pair is not None:
            parts.setdefault(column.pair, {})[column.kind] = (column, numbers[at])
    for pair, of_pair in parts.items():
        matrix.pairs[pair] = _single(of_pair)
    notes = resolve_units(matrix.pairs)
    kept = [comment for comment in comments[1:] if comment not in ("", SIGN_NOTE) and not is_key(comment)]
    conditioning = [numbers[at] for at, column in enumerate(columns) if column.kind == "conditioning"]
    more = {
        "conditioning": conditioning[0] if conditioning else None,
        "usable_up_to": usable_limit_in(comments),
        "estimation": estimation_in(comments),
        "has_phase": not any("phase" not in of_pair and "re" not in of_pair for of_pair in parts.values()),
    }
    return matrix.response(path.name, comments[0] if comments else path.stem, (*kept, *notes), **more)


def _single(columns: dict[str, tuple[ColumnHeading, FloatArray]]) -> SingleResponse:
    if "re" in columns:
        heading, real = columns["re"]
        values = np.empty(len(real), dtype=complex)
        values.real, values.imag = real, columns["im"][1]
    else:
        heading, magnitude = columns["magnitude"]
        phase = columns["phase"][1] if "phase" in columns else 0.0  # has_phase says which it is
        with np.errstate(invalid="ignore"):  # an infinite magnitude has no real part
            values = magnitude * np.exp(1j * np.radians(phase))
    coherence = columns["coherence"][1] if "coherence" in columns else None
    with np.errstate(invalid="ignore"):
        scaled = np.asarray(values / heading.scale, dtype=complex)
    return SingleResponse(scaled, heading.above, heading.below, coherence)
