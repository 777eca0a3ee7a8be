"""Structures in MAT files in which test systems export channels: Simcenter Testlab of Siemens (LMS), PULSE of B&K.

Testlab: a structure for each channel, or for several of one block, with ``x_values`` (start_value, increment,
number_of_values) and ``y_values`` (values, and in quantity a label, which is the unit, and the factor to SI), and names
in ``function_record``. PULSE: ``File_Header`` with SampleFrequency, and for each channel ``Channel_1_Data`` and
``Channel_1_Header`` with SignalName and Unit; channels of times hold for those behind them.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from torsionnet.base.delimited.dialect import plain_unit
from torsionnet.base.errors import comma_list, remedy
from torsionnet.base.notes import Note, NoteOrText, warning
from torsionnet.base.units import UnitError, parse_unit
from torsionnet.signals.foreign import StoredArray
from torsionnet.signals.foreign.content import COMPLEX, Blocks, Plain
from torsionnet.signals.records.arrays import by_column, with_table_clocks
from torsionnet.signals.records.source import FileChannel, Source, other_axis, seconds_in

VALUES, ABSCISSA = ".y_values.values", ".x_values"
"""Ends of the names of a Testlab structure's values, and of what tells their times."""
ABSCISSA_FIELDS = ("start_value", "increment", "number_of_values")
"""Fields of a Testlab structure that tell the times of its values: first in s, interval in s, and their number."""
_PULSE_DATA = re.compile(r"Channel_(\d+)_Data")
_PULSE_RATE = "File_Header.SampleFrequency"
_NUMBER = re.compile(r"\d+(?:[.,]\d+)?(?:[eE][+-]?\d+)?")
SAME_FACTOR = 1e-3
"""Relative difference up to which the factor of a Testlab structure agrees with that of the unit in its label."""
MOST_NAMED = 4
"""Number of fields of an unknown structure that a message names at most, so that it stays short."""


@dataclass(frozen=True)
class _Fields:
    """Arrays, single numbers and texts of a MAT file by their names, which are ``structure.field`` in structures."""

    arrays: Mapping[str, tuple[int, StoredArray]]
    texts: Mapping[str, Plain]

    def number(self, name: str) -> float | None:
        stored = self.arrays.get(name)
        return None if stored is None else stored[1].value

    def words(self, name: str) -> list[str]:
        """Text of this name, or the texts of its cells, in their order."""
        if name in self.texts:
            return [str(self.texts[name]).strip()]
        words = list[str]()
        while (cell := f"{name}{{{len(words) + 1}}}") in self.texts:
            words.append(str(self.texts[cell]).strip())
        return words


def structured_source(
    arrays: Sequence[StoredArray], blocks: Blocks, texts: Mapping[str, Plain], title: str
) -> Source | None:
    """Channels of a MAT file with their rates in Hz and starts in s, or None where it has no structures of these kinds.

    Raises
    ------
    ValueError
        A structure lacks what tells the times of its values, or its number of values is another than it says.
    """
    fields = _Fields({item.name: (number, item) for number, item in enumerate(arrays)}, texts)
    structure = _testlab(fields) or _pulse(fields)
    if not structure:
        return None
    channels, places, notes = structure
    renamed = tuple(replace(channel, column=number) for number, channel in enumerate(channels))
    rates = [channel.rate for channel in renamed if channel.rate]
    starts = [channel.start for channel in renamed if channel.start is not None]
    rate, start = rates[0] if rates else None, starts[0] if starts else 0.0
    source = Source(renamed, by_column(blocks, places), rate=rate, start=start, title=title, notes=tuple(notes))
    return with_table_clocks(source).with_time_channel()


def unknown_structures(arrays: Sequence[StoredArray]) -> str:
    """Text on structures of a MAT file that are of no known kind, and which are known; empty where it has none."""
    fields = dict.fromkeys(item.name for item in arrays if "." in item.name)
    if not fields:
        return ""
    listed = comma_list(fields, MOST_NAMED)
    return (
        f"the file has structures with the fields {listed}; known are those of Testlab (x_values with "
        f"{', '.join(ABSCISSA_FIELDS)} and y_values with values), those of PULSE (File_Header with SampleFrequency, "
        "Channel_1_Data), and fields of one length with a field time beside them"
    )


Found = tuple[list[FileChannel], list[tuple[int, int]], list[NoteOrText]]


def _testlab(fields: _Fields) -> Found | None:
    prefixes = [name.removesuffix(VALUES) for name in fields.arrays if name.endswith(VALUES)]
    channels, places, notes = list[FileChannel](), list[tuple[int, int]](), list[NoteOrText]()
    faults = list[str]()
    names = [fields.words(f"{prefix}.function_record.name") for prefix in prefixes]
    often = Counter(name for some in names for name in some)
    for prefix, given in zip(prefixes, names, strict=True):
        number, item = fields.arrays[f"{prefix}{VALUES}"]
        axis = [*fields.words(f"{prefix}{ABSCISSA}.quantity.label"), ""][0]
        over = other_axis(axis)
        if item.attributes.get(COMPLEX) and not over:
            notes.append(f"{prefix} was left out: its values are complex, no record over time")
            continue
        fault = _abscissa_fault(fields, prefix, item)
        if fault:
            faults.append(fault)
            continue
        scale = 1.0 if over else seconds_in(axis)
        interval, start = (fields.number(f"{prefix}{ABSCISSA}.{key}") or 0.0 for key in ("increment", "start_value"))
        columns = (*item.shape, 1)[1]
        units = fields.words(f"{prefix}.y_values.quantity.label")
        for column in range(columns):
            name = given[column] if len(given) == columns else ""
            if not name or often[name] > 1:
                name = prefix if columns == 1 else f"{prefix}_{column + 1}"
            unit = "" if not units else units[column] if len(units) == columns else units[0]
            notes += _factor_notes(fields, prefix, name, unit)
            own = FileChannel(name, 0, unit, None, item.length, over=over)
            channels.append(own if over else replace(own, rate=1 / (interval * scale), start=start * scale))
            places.append((number, column))
    if faults:
        raise ValueError("; ".join(faults))
    return (channels, places, notes) if prefixes else None


def _abscissa_fault(fields: _Fields, prefix: str, item: StoredArray) -> str:
    numbers = {key: fields.number(f"{prefix}{ABSCISSA}.{key}") for key in ABSCISSA_FIELDS}
    there = [name.removeprefix(f"{prefix}.") for name in fields.arrays if name.startswith(f"{prefix}{ABSCISSA}.")]
    missing = [key for key in ("increment", "number_of_values") if numbers[key] is None]
    if missing:
        held = comma_list(there, MOST_NAMED, none="none of its fields")
        return f"structure {prefix} has y_values, but in x_values no {' and no '.join(missing)}; found {held}"
    interval, count = numbers["increment"] or 0.0, numbers["number_of_values"] or 0.0
    if not 0 < interval < float("inf"):
        return f"structure {prefix} has an increment of {interval:g} in its x_values, which is no sampling interval"
    if count != item.length:
        return f"structure {prefix} has {item.length} values, its number_of_values says {count:.0f}; export it again"
    return ""


def _factor_notes(fields: _Fields, prefix: str, name: str, unit: str) -> list[Note]:
    """Warning where the factor of a structure does not fit the unit in its label; empty where it does, or has none."""
    factor = fields.number(f"{prefix}.y_values.quantity.unit_transformation.factor")
    try:
        known = float(parse_unit(plain_unit(unit)).factor)
    except UnitError:
        return []
    if factor is None or min(abs(factor - 1), abs(factor / known - 1)) <= SAME_FACTOR:
        return []
    text = f'{name} has the unit "{unit}", {known:g} in SI, and a factor of {factor:g} in its structure'
    return [warning(f"{text}; the unit was taken: give {remedy('units=')} if that is wrong")]


def _pulse(fields: _Fields) -> Found | None:
    data = {name: _PULSE_DATA.fullmatch(name) for name in fields.arrays}
    numbers = {name: match[1] for name, match in data.items() if match}
    headed = any(name.startswith("File_Header.") for name in (*fields.arrays, *fields.texts))
    if not numbers or not headed:
        return None
    written = [*fields.words(_PULSE_RATE), ""][0]
    match = _NUMBER.match(written)
    rate = fields.number(_PULSE_RATE) or (float(match[0].replace(",", ".")) if match else 0.0)
    if not rate > 0:
        raise ValueError(f'File_Header has the SampleFrequency "{written}", which is no rate in Hz; export it again')
    channels, places = list[FileChannel](), list[tuple[int, int]]()
    for data_name, number in numbers.items():
        place, item = fields.arrays[data_name]
        name, unit = ([*fields.words(f"Channel_{number}_Header.{key}"), ""][0] for key in ("SignalName", "Unit"))
        channels.append(FileChannel(name or data_name, 0, unit, None, item.length, rate=rate, start=0.0))
        places.append((place, 0))
    often = Counter(channel.name for channel in channels)
    named = [
        channel if often[channel.name] == 1 else replace(channel, name=f"{channel.name} {number}")
        for channel, number in zip(channels, numbers.values(), strict=True)
    ]
    return named, places, []
