"""Recordings in universal files, with one dataset 58 for every signal."""

from __future__ import annotations

import contextlib
import re
import warnings
from collections import Counter
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.base.atomic import atomic_replacement
from torsionnet.base.units import parse_unit
from torsionnet.linear.between_samples import check_between
from torsionnet.signals.foreign import Content, StoredArray
from torsionnet.signals.formats.extras import import_extra, open_foreign
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.records.arrays import told_apart
from torsionnet.signals.records.channel_choice import quantity_of_dimension
from torsionnet.signals.records.clock import clock_of
from torsionnet.signals.records.source import FileChannel, Source, other_axis, seconds_in

# Datasets 58 (functions) of universal files, read and written through pyuff.

FUNCTION_DATASET, UNITS_DATASET = 58, 164
"""Numbers of the types of datasets in universal files that hold a function, and the units of what follows."""
GENERAL_FUNCTION, TIME_RESPONSE, FRF, TRANSMISSIBILITY, COHERENCE = 0, 1, 4, 5, 6
"""Codes of the types of functions in dataset 58 (record 6, field 1)."""
ROTATION_ABOUT_X = 4
"""Code of a rotation about +X as a direction in dataset 58 (record 6, fields 7 and 10), negative about -X."""
ROTATIONS = frozenset({4, 5, 6})
"""Codes of rotations about X, Y and Z as directions in dataset 58 (record 6, fields 7 and 10)."""
TRANSLATIONS = frozenset({1, 2, 3})
"""Codes of translations along X, Y and Z as directions in dataset 58 (record 6, fields 7 and 10)."""
GENERAL, TIME_AXIS, FREQUENCY_AXIS = 1, 17, 18
"""Codes of data types in dataset 58 of values in general, and of an abscissa of times and of frequencies."""
ABSCISSAE = {8: "a displacement", TIME_AXIS: "time", FREQUENCY_AXIS: "frequency", 19: "a speed in rpm", 20: "an order"}
"""Words for the codes of data types that the abscissa of a dataset 58 has."""
FUNCTIONS = {
    0: "functions of no known kind", TIME_RESPONSE: "records over time", 2: "auto spectra", 3: "cross spectra",
    FRF: "frequency responses", TRANSMISSIBILITY: "transmissibilities", COHERENCE: "coherences",
    7: "auto correlations", 8: "cross correlations", 9: "power spectral densities", 10: "energy spectral densities",
    12: "spectra", 17: "orbits", 18: "mode indicator functions", 24: "shock response spectra",
}  # fmt: skip
"""Words for the types of functions in dataset 58."""
CONTENTS = {
    15: "nodes of a mesh", 781: "nodes of a mesh", 2411: "nodes of a mesh", 71: "elements of a mesh",
    780: "elements of a mesh", 2412: "elements of a mesh", 82: "lines of a mesh", 2431: "lines of a mesh",
    18: "coordinate systems", 2420: "coordinate systems", 55: "mode shapes or results at nodes",
    2414: "mode shapes or results at nodes", 2400: "a header", 2429: "groups of nodes", 2467: "groups of nodes",
}  # fmt: skip
"""Words for what datasets of universal files hold, by their types; headers and units are left out."""
ID_LINE_WIDTH = 80
"""Most characters of an ID line in dataset 58."""
PAIR_SEPARATOR = " / "
"""Text between the names of output and input in the first ID line of dataset 58."""

DATA_TYPES = {"rad": 8, "rad/s": 11, "rad/s^2": 12, "N*m": 13, "Pa": 2}
"""Codes of data types by SI unit in dataset 58 (records 9, 10, field 1), for rotation, its rates, torque, stress."""
UNITS = {code: unit for unit, code in DATA_TYPES.items()} | {9: "N*m"}
"""SI unit by code of a data type in dataset 58 where the file gives no label, the code 9 being a reaction torque."""
_EMPTY = ("", "NONE")
"""Texts of an ID line in dataset 58 that stand for an empty one."""
_UNUSED = {
    f"{axis}_{entry}": 0
    for axis in ("abscissa", "ordinate", "orddenom", "z_axis")
    for entry in ("spec_data_type", "len_unit_exp", "force_unit_exp", "temp_unit_exp")
} | {"z_axis_value": 0.0, "orddenom_axis_units_lab": "NONE", "z_axis_axis_units_lab": "NONE"}


@dataclass(frozen=True)
class FileUnits:
    """Units of a universal file by its dataset 164: how many of its units of length and force are in a m and a N."""

    length: float = 1.0
    force: float = 1.0
    name: str = ""

    @property
    def factors(self) -> dict[str, float]:
        """Factors to SI by quantity, of those that are not 1."""
        every = {"torque": 1 / (self.length * self.force), "stress": self.length**2 / self.force}
        return {quantity: factor for quantity, factor in every.items() if factor != 1.0}


def units_of_datasets(sets: Sequence[Mapping[str, Any]]) -> list[FileUnits]:
    """Units that hold for every dataset of a universal file, by the dataset 164 before it."""
    units, now = [], FileUnits()
    for entries in sets:
        if entries.get("type") == UNITS_DATASET:
            length, force = (float(entries.get(key) or 1.0) for key in ("length", "force"))
            now = FileUnits(length, force, text_in(entries, "units_description"))
        units.append(now)
    return units


def abscissa_over(entries: Mapping[str, Any], kind: int) -> str:
    """Words for the abscissa of a dataset 58 that has no unit and a code other than ``kind``; else empty."""
    code = int(entries.get("abscissa_spec_data_type") or 0)
    if text_in(entries, "abscissa_axis_units_lab") or code in (0, GENERAL, kind):
        return ""
    return ABSCISSAE.get(code, f"an abscissa of type {code}")


def function_dataset(lines: Iterable[str], **entries: Any) -> dict[str, Any]:
    """Entries of a binary dataset 58 in double precision, with its five lines of text."""
    texts = {f"id{at}": " ".join(line.split())[:ID_LINE_WIDTH] or "NONE" for at, line in enumerate(lines, 1)}
    return {**_UNUSED, "type": FUNCTION_DATASET, "binary": 1, "load_case_id": 0, **texts, **entries}


def contents_of(sets: Sequence[Mapping[str, Any]]) -> str:
    """Words for what the datasets of a universal file hold.

    >>> contents_of([{"type": 164}, {"type": 15}, {"type": 58, "func_type": 9}, {"type": 58, "func_type": 9}])
    'nodes of a mesh (data set 15) and 2 power spectral densities (58)'
    """
    counts = Counter[tuple[int, str]]()
    for item in sets:
        kind = int(item.get("type") or 0)
        if kind == FUNCTION_DATASET:
            counts[kind, FUNCTIONS.get(int(item.get("func_type") or 0), FUNCTIONS[0])] += 1
        elif kind in CONTENTS:
            counts[kind, CONTENTS[kind]] = 0
    words = [f"{count} {words} ({kind})" if count else f"{words} ({kind})" for (kind, words), count in counts.items()]
    listed = " and ".join(filter(None, [", ".join(words[:-1]), *words[-1:]])) or "neither records nor responses"
    return listed.replace(" (", " (data set ", 1)


def text_in(entries: Mapping[str, Any], key: str) -> str:
    """Text of an entry of a dataset 58, empty where there is none."""
    line = str(entries.get(key) or "").strip()
    return "" if line in _EMPTY else line


def write_sets(sets: Iterable[Mapping[str, Any]], path: Path) -> None:
    """Write datasets one behind the other into a universal file, whole or not at all."""
    pyuff = import_extra("uff")
    with atomic_replacement(path) as temporary, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        temporary.unlink()  # pyuff would add to the empty file as if it had an end of a dataset
        for item in sets:
            try:
                pyuff.UFF(str(temporary)).write_sets(item, mode="add")
            except Exception as error:
                if isinstance(error.__context__, OSError):  # pyuff hides that the disk is full
                    raise error.__context__ from error
                raise


@contextlib.contextmanager
def open_source(path: Path) -> Iterator[Source]:
    """Yield the channels of a universal file, which are its time responses, named by their first line of text."""
    with open_foreign(path, "uff") as content:
        sets = content.arrays[::2]
        numbers = [at for at, item in enumerate(sets) if _is_time_response(item)]
        if not numbers:
            held = contents_of([item.attributes for item in sets])
            read = "; fit and report read frequency responses" if FUNCTIONS[FRF] in held else ""
            raise ValueError(f"the file holds {held}, no record over time{read}; export time histories (58, type 1)")
        first, units = sets[numbers[0]].attributes, units_of_datasets([item.attributes for item in sets])
        clocks = dict[Hashable, FileChannel]()
        channels = [_channel(sets[at], at, content, clocks, units[at]) for at in numbers]
        longer = [f"{channel.name} {_place(sets[at])}" for channel, at in zip(channels, numbers, strict=True)]
        names = told_apart([channel.name for channel in channels], longer)
        named = [replace(channel, name=name) for channel, name in zip(channels, names, strict=True)]
        others = [item.attributes for at, item in enumerate(sets) if at not in numbers and item.length]
        left = f"left out, as no records over time: {contents_of(others)}" if others else ""
        yield Source(
            tuple(named), content.blocks, rate=_written_rate(first), title=text_in(first, "id4") or path.stem,
            notes=tuple(filter(None, [text_in(first, "id5"), left])), stamped=_written_rate(first) is not None,
        )  # fmt: skip


def _is_time_response(item: StoredArray) -> bool:
    return item.attributes.get("type") == FUNCTION_DATASET and item.attributes.get("func_type") == TIME_RESPONSE


def _channel(
    item: StoredArray, at: int, content: Content, clocks: dict[Hashable, FileChannel], units: FileUnits
) -> FileChannel:
    """Channel of a dataset with its own abscissa; ``clocks`` remembers abscissae that are the same."""
    label, entries = text_in(item.attributes, "ordinate_axis_units_lab"), item.attributes
    code, direction = (int(entries.get(key) or 0) for key in ("ordinate_spec_data_type", "rsp_dir"))
    unit = text_in(entries, "abscissa_axis_units_lab")
    over = other_axis(unit, text_in(entries, "abscissa_axis_lab")) or abscissa_over(entries, TIME_AXIS)
    channel = FileChannel(
        text_in(entries, "id1") or _place(item), 2 * at, label, length=item.length, over=over, implied=units.factors
    )
    if not label and code in UNITS and abs(direction) in ROTATIONS:
        channel = replace(channel, quantity=quantity_of_dimension(parse_unit(UNITS[code]).dimension) or None)
    course = _COURSE.search(text_in(entries, "id2"))
    if course is not None:
        rate = float(course[2]) if course[2] else None
        channel = replace(channel, between=check_between(course[1]), course_rate=rate)
    if over:
        return channel
    key = tuple(entries.get(name) for name in ("abscissa_min", "abscissa_inc", "num_pts", "abscissa_axis_units_lab"))
    known = clocks.get(key) if entries.get("abscissa_spacing") == 1 else None
    known = known or _abscissa(entries, 2 * at + 1, content, unit)
    clocks[key] = known
    return replace(channel, rate=known.rate, start=known.start, clock=None if known.rate else known)


def _abscissa(entries: Mapping[str, Any], column: int, content: Content, unit: str) -> FileChannel:
    """Abscissa of a dataset, with its rate in Hz and its start in s where it is even."""
    stamps = next(content.blocks([column], 0), [np.empty(0)])[0]
    clock = clock_of(stamps, _written_rate(entries), scale=seconds_in(unit))
    abscissa = FileChannel("abscissa", column, unit or "s", length=len(stamps))
    return abscissa if clock.times is not None else replace(abscissa, rate=clock.rate, start=clock.start)


def _place(item: StoredArray) -> str:
    return "{}{}:{}".format(*(item.attributes.get(key, "") for key in ("rsp_ent_name", "rsp_node", "rsp_dir")))


def _written_rate(entries: Mapping[str, Any]) -> float | None:
    words = text_in(entries, "id3").split()
    with contextlib.suppress(ValueError, IndexError):
        return float(words[2]) if words[:2] == ["sampling", "rate"] else None
    return None


_COURSE = re.compile(r"; (held|straight) between samples(?: at (\S+) Hz)?$")


def write(recording: Recording, path: Path) -> None:
    """Write a universal file of one binary dataset 58 in SI for every signal of a recording.

    Sequence numbers count down to the last.
    """
    write_sets([_dataset(recording, signal, number) for number, signal in enumerate(recording, 1)], path)


def _dataset(recording: Recording, signal: Signal, number: int) -> dict[str, Any]:
    at = f" at {signal.course_rate!r} Hz" if signal.course_rate else ""
    runs = "" if signal.between == "band_limited" else f"; {signal.between} between samples{at}"
    lines = [signal.name, f"{signal.quantity}{runs}", f"sampling rate {recording.sampling_rate!r} Hz", recording.title,
             str(next(iter(recording.notes), ""))]  # fmt: skip
    return function_dataset(
        lines, func_type=TIME_RESPONSE, rsp_node=number, rsp_dir=0, ref_node=0, ref_dir=0,
        ver_num=len(recording.signals) - number, rsp_ent_name="NONE", ref_ent_name="NONE",
        data=np.asarray(signal.values), x=recording.time,
        abscissa_spacing=int(recording.times is None), abscissa_min=recording.start,
        abscissa_spec_data_type=TIME_AXIS, abscissa_axis_units_lab="s", ordinate_spec_data_type=GENERAL,
        ordinate_axis_units_lab=signal.unit or "NONE",
    )  # fmt: skip
