"""Universal files, dataset 58 (functions of time), through pyuff."""

from __future__ import annotations

import contextlib
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.atomic import replacing
from torsionnet.signals.files.clock import clock_of
from torsionnet.signals.files.extras import needed
from torsionnet.signals.files.source import Channel, Source, reader_of, sliced
from torsionnet.signals.recording import Recording, Signal

TIME_RESPONSE, TIME_AXIS, GENERAL = 1, 17, 1
WIDTH = 80
_EMPTY = ("", "NONE")
_UNUSED = {
    f"{axis}_{entry}": 0
    for axis in ("abscissa", "ordinate", "orddenom", "z_axis")
    for entry in ("spec_data_type", "len_unit_exp", "force_unit_exp", "temp_unit_exp")
} | {"z_axis_value": 0.0, "orddenom_axis_units_lab": "NONE", "z_axis_axis_units_lab": "NONE"}


@contextlib.contextmanager
def opened(path: Path) -> Iterator[Source]:
    """A universal file; every time response in it is a channel, named by its first line."""
    pyuff = needed("uff")
    found = pyuff.UFF(str(path)).read_sets()
    sets = [item for item in (found if isinstance(found, list) else [found]) if _is_time_response(item)]
    if not sets:
        yield Source((), sliced([], []))
        return
    values = [np.asarray(item["data"], dtype=float) for item in sets]
    channels = [_channel(item, number) for number, item in enumerate(sets)]
    stamps = np.asarray(sets[0]["x"], dtype=float)
    clock = clock_of(stamps, _written_rate(sets[0]))
    readers, lengths = [reader_of(array) for array in [*values, stamps]], [len(array) for array in [*values, stamps]]
    source = Source(
        tuple(channels), sliced(readers, lengths), rate=clock.rate, start=clock.start,
        title=_line(sets[0], "id4") or path.stem, notes=tuple(filter(None, [_line(sets[0], "id5")])),
    )  # fmt: skip
    stamp = Channel("abscissa", len(values), "s", length=len(stamps))
    yield source if clock.times is None else replace(source, time=stamp, stamped=True)


def _is_time_response(item: dict[str, Any]) -> bool:
    return item.get("type") == 58 and item.get("func_type") == TIME_RESPONSE  # noqa: PLR2004


def _line(item: dict[str, Any], key: str) -> str:
    line = str(item.get(key) or "").strip()
    return "" if line in _EMPTY else line


def _channel(item: dict[str, Any], number: int) -> Channel:
    name = _line(item, "id1") or f"{item.get('rsp_ent_name', '')}{item.get('rsp_node', '')}:{item.get('rsp_dir', '')}"
    unit = _line(item, "ordinate_axis_units_lab")
    return Channel(name, number, unit, length=len(item["data"]))


def _written_rate(item: dict[str, Any]) -> float | None:
    words = _line(item, "id3").split()
    with contextlib.suppress(ValueError, IndexError):
        return float(words[2]) if words[:2] == ["sampling", "rate"] else None
    return None


def write(recording: Recording, path: Path) -> None:
    """A universal file of one binary dataset 58 in double precision for every signal."""
    pyuff = needed("uff")
    sets = [_dataset(recording, signal, number) for number, signal in enumerate(recording, 1)]
    with replacing(path) as temporary, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        temporary.unlink()  # pyuff would add to the empty file as if it had an end of a dataset
        for item in sets:
            pyuff.UFF(str(temporary)).write_sets(item, mode="add")


def _dataset(recording: Recording, signal: Signal, number: int) -> dict[str, Any]:
    lines = [signal.name, signal.quantity, f"sampling rate {recording.sampling_rate!r} Hz", recording.title,
             next(iter(recording.notes), "")]  # fmt: skip
    texts = {f"id{at}": " ".join(line.split())[:WIDTH] or "NONE" for at, line in enumerate(lines, 1)}
    even = recording.times is None
    return {
        **_UNUSED, "type": 58, "binary": 1, "func_type": TIME_RESPONSE, **texts, "rsp_node": number, "rsp_dir": 0,
        "ref_node": 0, "ref_dir": 0, "ver_num": 0, "load_case_id": 0, "rsp_ent_name": "NONE", "ref_ent_name": "NONE",
        "data": np.asarray(signal.values), "x": recording.time, "abscissa_spacing": int(even),
        "abscissa_min": recording.start, "abscissa_inc": 1 / recording.sampling_rate if even else 0.0,
        "abscissa_spec_data_type": TIME_AXIS, "abscissa_axis_units_lab": "s", "ordinate_spec_data_type": GENERAL,
        "ordinate_axis_units_lab": signal.unit or "NONE",
    }  # fmt: skip
