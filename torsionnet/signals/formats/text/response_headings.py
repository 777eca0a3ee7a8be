"""Headings of a table of frequency responses, with quantity and unit of each column."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass

from torsionnet.base.conventions import ANGLES, FREQUENCIES, Conventions
from torsionnet.base.errors import Fault, ModelError, Position, did_you_mean
from torsionnet.signals.responses.response_matrix import UNKNOWN_UNIT

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


class _HeadingError(ValueError):
    pass


def headings(line: str, separator: str, place: Position) -> list[ColumnHeading]:
    """Headings of all columns of a table of frequency responses; ModelError lists all that are not understood."""
    found: list[ColumnHeading] = []
    faults: list[Fault] = []
    for column, text in enumerate(next(csv.reader([line], delimiter=separator))):
        try:
            found.append(_heading(text.strip(), first=column == 0))
        except _HeadingError as error:
            start = line.find(text) + 1
            faults.append(Fault(str(error), position=Position(place.file, place.line, start, start + len(text), line)))
    faults += [Fault(text, position=place) for text in _incomplete(found)] if not faults else []
    if faults:
        raise ModelError(faults, place.file)
    return found


def _incomplete(found: list[ColumnHeading]) -> list[str]:
    kinds: dict[tuple[str, str], list[str]] = {}
    for heading in found:
        if heading.pair:
            kinds.setdefault(heading.pair, []).append(heading.kind)
    faults = [] if kinds else [f"there is no frequency response; {EXPECTED}"]
    for (output, driven), have in kinds.items():
        label = f"{output}/{driven}"
        if len(set(have)) < len(have):
            faults.append(f"{label} has two columns of one kind")
        elif sorted(set(have) - {"coherence"}) not in (["magnitude", "phase"], ["magnitude"], ["im", "re"]):
            faults.append(f"{label} needs |{label}|, with phase {label} if there is one, or re {label} and im {label}")
    phases = {"phase" in have or "re" in have for have in kinds.values()}
    if len(phases) > 1 and not faults:
        faults.append("some responses have a phase and some have not; put them into files of their own")
    return faults


def _heading(text: str, *, first: bool) -> ColumnHeading:
    match = _UNIT.fullmatch(text)
    what, unit = (match["what"], (match["unit"] or "").strip()) if match else (text, "")
    if first:
        return _frequency(what, unit)
    if what == "conditioning":
        return ColumnHeading("conditioning")
    for kind, pattern in _KINDS:
        found = pattern.fullmatch(what)
        if found:
            return _pair(kind, found["pair"], unit)
    raise _HeadingError(f'"{text}" is no heading of a frequency response; {EXPECTED}')


def _frequency(what: str, unit: str) -> ColumnHeading:
    if what != "frequency":
        raise _HeadingError(f'the first column is "{what}"; {EXPECTED}')
    if unit not in FREQUENCIES:
        expected = f"expected {', '.join(FREQUENCIES)}"
        raise _HeadingError(
            f'"{unit}" is no unit of frequency{did_you_mean(unit, FREQUENCIES)}; {expected}'.replace("?;", "?")
        )
    return ColumnHeading("frequency", unit)


def _pair(kind: str, label: str, unit: str) -> ColumnHeading:
    output, slash, driven = label.partition("/")
    if not slash or "/" in driven:
        raise _HeadingError(f'"{label}" is not of the form output/input')
    if kind == "coherence":
        return ColumnHeading(kind, unit, (output, driven))
    if kind == "phase":
        if unit != "deg":
            raise _HeadingError(f'the phase of {label} is in "{unit}"; expected deg')
        return ColumnHeading(kind, unit, (output, driven))
    if unit.startswith("dB"):
        raise _HeadingError(
            f"{label} is a level in dB; write the table without --db, levels are rounded and have lost their sign"
        )
    return ColumnHeading(kind, unit, (output, driven), *_split(unit, label))


def _split(unit: str, label: str) -> tuple[str, str, float]:
    """SI units of output and input in the unit of their ratio, and the factor from SI to the values shown."""
    if not unit:
        raise _HeadingError(f"{label} has no unit; expected one such as {KNOWN_UNITS}")
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
    raise _HeadingError(f'"{unit}" is no unit of {label} that is known here; expected one such as {KNOWN_UNITS}')
