"""Universal files, dataset 58 (functions of time), through pyuff."""

from __future__ import annotations

import contextlib
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.core.atomic import replacing
from torsionnet.io.foreign import Stored, opening
from torsionnet.io.records.clock import clock_of
from torsionnet.io.records.extras import needed, require
from torsionnet.io.records.source import FileChannel, Source
from torsionnet.response.recording import Recording, Signal

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
    require("uff")
    with opening.opened(path, "uff") as content:
        numbers = [at for at, item in enumerate(content.arrays[::2]) if _is_time_response(item)]
        if not numbers:
            yield Source((), content.blocks)
            return
        first, axis = content.arrays[2 * numbers[0]], 2 * numbers[0] + 1
        stamps = next(content.blocks([axis], 0), [np.empty(0)])[0]
        clock = clock_of(stamps, _written_rate(first))
        channels = [_channel(content.arrays[2 * at], 2 * at) for at in numbers]
        source = Source(
            tuple(channels), content.blocks, rate=clock.rate, start=clock.start,
            title=_line(first, "id4") or path.stem, notes=tuple(filter(None, [_line(first, "id5")])),
        )  # fmt: skip
        stamp = FileChannel("abscissa", axis, "s", length=len(stamps))
        yield source if clock.times is None else replace(source, time=stamp, stamped=True)


def _is_time_response(item: Stored) -> bool:
    return item.attributes.get("type") == 58 and item.attributes.get("func_type") == TIME_RESPONSE


def _line(item: Stored, key: str) -> str:
    line = str(item.attributes.get(key) or "").strip()
    return "" if line in _EMPTY else line


def _channel(item: Stored, number: int) -> FileChannel:
    place = [item.attributes.get(key, "") for key in ("rsp_ent_name", "rsp_node", "rsp_dir")]
    name = _line(item, "id1") or "{}{}:{}".format(*place)
    return FileChannel(name, number, _line(item, "ordinate_axis_units_lab"), length=item.length)


def _written_rate(item: Stored) -> float | None:
    words = _line(item, "id3").split()
    with contextlib.suppress(ValueError, IndexError):
        return float(words[2]) if words[:2] == ["sampling", "rate"] else None
    return None


def write(recording: Recording, path: Path) -> None:
    """A universal file of one binary dataset 58 in double precision for every signal; sequence numbers count down."""
    write_sets([_dataset(recording, signal, number) for number, signal in enumerate(recording, 1)], path)


def write_sets(sets: Iterable[dict[str, Any]], path: Path) -> None:
    """Write datasets one behind the other, whole or not at all."""
    pyuff = needed("uff")
    with replacing(path) as temporary, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        temporary.unlink()  # pyuff would add to the empty file as if it had an end of a dataset
        for item in sets:
            try:
                pyuff.UFF(str(temporary)).write_sets(item, mode="add")
            except Exception as error:
                if isinstance(error.__context__, OSError):  # pyuff hides that the disk is full
                    raise error.__context__ from error
                raise


def _dataset(recording: Recording, signal: Signal, number: int) -> dict[str, Any]:
    lines = [signal.name, signal.quantity, f"sampling rate {recording.sampling_rate!r} Hz", recording.title,
             next(iter(recording.notes), "")]  # fmt: skip
    texts = {f"id{at}": " ".join(line.split())[:WIDTH] or "NONE" for at, line in enumerate(lines, 1)}
    even = recording.times is None
    return {
        **_UNUSED, "type": 58, "binary": 1, "func_type": TIME_RESPONSE, **texts, "rsp_node": number, "rsp_dir": 0,
        "ref_node": 0, "ref_dir": 0, "ver_num": len(recording.signals) - number,
        "load_case_id": 0, "rsp_ent_name": "NONE", "ref_ent_name": "NONE",
        "data": np.asarray(signal.values), "x": recording.time, "abscissa_spacing": int(even),
        "abscissa_min": recording.start, "abscissa_inc": 1 / recording.sampling_rate if even else 0.0,
        "abscissa_spec_data_type": TIME_AXIS, "abscissa_axis_units_lab": "s", "ordinate_spec_data_type": GENERAL,
        "ordinate_axis_units_lab": signal.unit or "NONE",
    }  # fmt: skip
