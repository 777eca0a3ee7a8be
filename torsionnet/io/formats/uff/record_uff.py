"""Recordings in universal files, with one dataset 58 for every signal."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.io.foreign import StoredArray
from torsionnet.io.formats.extras import open_foreign
from torsionnet.io.formats.uff.datasets import FUNCTION_DATASET, TIME_RESPONSE, function_dataset, text_in, write_sets
from torsionnet.io.records.clock import clock_of
from torsionnet.io.records.source import FileChannel, Source
from torsionnet.response.recording import Recording, Signal

TIME_AXIS, GENERAL = 17, 1
"""Data types in dataset 58 of the abscissa (time) and of the values (general) of a recording."""


@contextlib.contextmanager
def open_source(path: Path) -> Iterator[Source]:
    """Yield the channels of a universal file, which are its time responses, named by their first line of text."""
    with open_foreign(path, "uff") as content:
        numbers = [at for at, item in enumerate(content.arrays[::2]) if _is_time_response(item)]
        if not numbers:
            yield Source((), content.blocks)
            return
        first, axis = content.arrays[2 * numbers[0]].attributes, 2 * numbers[0] + 1
        stamps = next(content.blocks([axis], 0), [np.empty(0)])[0]
        clock = clock_of(stamps, _written_rate(first))
        channels = [_channel(content.arrays[2 * at], 2 * at) for at in numbers]
        source = Source(
            tuple(channels), content.blocks, rate=clock.rate, start=clock.start,
            title=text_in(first, "id4") or path.stem, notes=tuple(filter(None, [text_in(first, "id5")])),
        )  # fmt: skip
        stamp = FileChannel("abscissa", axis, "s", length=len(stamps))
        yield source if clock.times is None else replace(source, time=stamp, stamped=True)


def _is_time_response(item: StoredArray) -> bool:
    return item.attributes.get("type") == FUNCTION_DATASET and item.attributes.get("func_type") == TIME_RESPONSE


def _channel(item: StoredArray, number: int) -> FileChannel:
    place = [item.attributes.get(key, "") for key in ("rsp_ent_name", "rsp_node", "rsp_dir")]
    name = text_in(item.attributes, "id1") or "{}{}:{}".format(*place)
    return FileChannel(name, number, text_in(item.attributes, "ordinate_axis_units_lab"), length=item.length)


def _written_rate(entries: Mapping[str, Any]) -> float | None:
    words = text_in(entries, "id3").split()
    with contextlib.suppress(ValueError, IndexError):
        return float(words[2]) if words[:2] == ["sampling", "rate"] else None
    return None


def write(recording: Recording, path: Path) -> None:
    """Write a universal file of one binary dataset 58 in SI for every signal of a recording.

    Sequence numbers count down to the last.
    """
    write_sets([_dataset(recording, signal, number) for number, signal in enumerate(recording, 1)], path)


def _dataset(recording: Recording, signal: Signal, number: int) -> dict[str, Any]:
    lines = [signal.name, signal.quantity, f"sampling rate {recording.sampling_rate!r} Hz", recording.title,
             next(iter(recording.notes), "")]  # fmt: skip
    return function_dataset(
        lines, func_type=TIME_RESPONSE, rsp_node=number, rsp_dir=0, ref_node=0, ref_dir=0,
        ver_num=len(recording.signals) - number, rsp_ent_name="NONE", ref_ent_name="NONE",
        data=np.asarray(signal.values), x=recording.time,
        abscissa_spacing=int(recording.times is None), abscissa_min=recording.start,
        abscissa_spec_data_type=TIME_AXIS, abscissa_axis_units_lab="s", ordinate_spec_data_type=GENERAL,
        ordinate_axis_units_lab=signal.unit or "NONE",
    )  # fmt: skip
