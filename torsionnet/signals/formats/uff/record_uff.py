"""Recordings in universal files, with one dataset 58 for every signal."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.base.units import parse_unit
from torsionnet.linear.between_samples import check_between
from torsionnet.signals.foreign import Content, StoredArray
from torsionnet.signals.formats.extras import open_foreign
from torsionnet.signals.formats.uff.datasets import (
    FRF,
    FUNCTION_DATASET,
    FUNCTIONS,
    GENERAL,
    ROTATIONS,
    TIME_AXIS,
    TIME_RESPONSE,
    UNITS,
    FileUnits,
    abscissa_over,
    contents_of,
    function_dataset,
    text_in,
    units_of_datasets,
    write_sets,
)
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.records.arrays import told_apart
from torsionnet.signals.records.axes import other_axis, seconds_in
from torsionnet.signals.records.clock import clock_of
from torsionnet.signals.records.quantities import quantity_of_dimension
from torsionnet.signals.records.source import FileChannel, Source


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
        longer = [f"{one.name} {_place(sets[at])}" for one, at in zip(channels, numbers, strict=True)]
        names = told_apart([one.name for one in channels], longer)
        named = [replace(one, name=name) for one, name in zip(channels, names, strict=True)]
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
    found = FileChannel(
        text_in(entries, "id1") or _place(item), 2 * at, label, length=item.length, over=over, implied=units.factors
    )
    if not label and code in UNITS and abs(direction) in ROTATIONS:
        found = replace(found, quantity=quantity_of_dimension(parse_unit(UNITS[code]).dimension) or None)
    course = _COURSE.search(text_in(entries, "id2"))
    if course is not None:
        rate = float(course[2]) if course[2] else None
        found = replace(found, between=check_between(course[1]), course_rate=rate)
    if over:
        return found
    key = tuple(entries.get(name) for name in ("abscissa_min", "abscissa_inc", "num_pts", "abscissa_axis_units_lab"))
    known = clocks.get(key) if entries.get("abscissa_spacing") == 1 else None
    known = known or _abscissa(entries, 2 * at + 1, content, unit)
    clocks[key] = known
    return replace(found, rate=known.rate, start=known.start, clock=None if known.rate else known)


def _abscissa(entries: Mapping[str, Any], column: int, content: Content, unit: str) -> FileChannel:
    """Abscissa of a dataset, with its rate in Hz and its start in s where it is even."""
    stamps = next(content.blocks([column], 0), [np.empty(0)])[0]
    clock = clock_of(stamps, _written_rate(entries), scale=seconds_in(unit))
    found = FileChannel("abscissa", column, unit or "s", length=len(stamps))
    return found if clock.times is not None else replace(found, rate=clock.rate, start=clock.start)


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
