"""Frequency responses in universal files, with units (dataset 164), channels as nodes (15), functions (58).

That is one of type 4 for every transfer function, of type 6 for its coherence. Both sides are rotations about the X
axis (direction 4). An output and an input have the number of one node only if they have one name, as programs take such
a pair for a driving point. The first line of a dataset names both, ``output / input``.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.notes import is_warning
from torsionnet.linear.frequency_response import Channel, FloatArray, FrequencyResponse, usable_limit_text
from torsionnet.signals.formats.extras import open_foreign, require_extra
from torsionnet.signals.formats.uff.datasets import (
    COHERENCE,
    DATA_TYPES,
    FREQUENCY_AXIS,
    FRF,
    FUNCTION_DATASET,
    GENERAL_FUNCTION,
    ID_LINE_WIDTH,
    PAIR_SEPARATOR,
    ROTATION_ABOUT_X,
    function_dataset,
    write_sets,
)
from torsionnet.signals.formats.uff.response_reading import response_of_datasets
from torsionnet.signals.responses.response_description import short_estimation_text

ENTITY_WIDTH, LABEL_WIDTH = 10, 20
"""Most characters of the name of an entity, and of the label of a unit, in a dataset 58."""
_SI = {
    "type": 164, "units_code": 1, "units_description": "SI", "temp_mode": 1, "length": 1.0, "force": 1.0, "temp": 1.0,
    "temp_offset": 273.15,
}  # fmt: skip
"""Dataset 164 of a universal file, which says that its units are SI."""


def read(path: Path) -> FrequencyResponse:
    """Frequency response in SI of all transfer functions in a universal file."""
    with open_foreign(path, "uff") as content:
        sets: list[dict[str, Any]] = [dict(item.attributes) for item in content.arrays[::2]]
        for number, item in enumerate(sets):
            if item.get("type") == FUNCTION_DATASET:
                data, axis = (next(content.blocks([2 * number + at], 0), [np.empty(0)])[0] for at in (0, 1))
                item |= {"data": data, "x": axis}
    return response_of_datasets(sets, path)


def write(response: FrequencyResponse, path: Path) -> None:
    """Write a universal file of a frequency response in SI as binary datasets 58 in double precision."""
    require_extra("uff")
    if len(response.frequencies) < 2:
        raise UsageError("a universal file takes responses at two frequencies or more; write an .npz or .csv file")
    if not response.has_phase:
        raise UsageError(
            "a universal file takes complex responses only; write magnitudes into a .csv, .npz or .mat file"
        )
    functions = list(_datasets(response))
    if not all(np.isfinite(item["data"]).all() for item in functions):
        raise UsageError(
            "a universal file takes finite values only; leave frequencies without them out, as with between()"
        )
    # Sequence numbers say how many follow: a file that ends early is known by it.
    counted = [{**item, "ver_num": len(functions) - number} for number, item in enumerate(functions, 1)]
    write_sets([_SI, _nodes(response), *counted], path)


def _numbers(response: FrequencyResponse) -> dict[str, int]:
    """Number of the node in a universal file of every channel, by name."""
    names = dict.fromkeys(channel.name for channel in (*response.outputs, *response.inputs))
    return {name: number for number, name in enumerate(names, 1)}


def _nodes(response: FrequencyResponse) -> dict[str, Any]:
    """Dataset of nodes of a universal file, the channels one behind the other on the x axis."""
    numbers = list(_numbers(response).values())
    aside = np.zeros(len(numbers))
    return {"type": 15, "node_nums": numbers, "x": np.arange(len(numbers), dtype=float), "y": aside, "z": aside}


def _datasets(response: FrequencyResponse) -> Iterator[dict[str, Any]]:
    common, numbers = _common(response), _numbers(response)
    for o, out in enumerate(response.outputs):
        for i, into in enumerate(response.inputs):
            place = {"id1": _first_line(out, into), "rsp_node": numbers[out.name], "rsp_dir": ROTATION_ABOUT_X,
                     "ref_node": numbers[into.name], "ref_dir": ROTATION_ABOUT_X,
                     "rsp_ent_name": _entity(out), "ref_ent_name": _entity(into)}  # fmt: skip
            yield {**common, **place, "func_type": FRF, "data": _complex(response.values[:, o, i]),
                   **_side("ordinate", out), **_side("orddenom", into)}  # fmt: skip
            if response.coherence is not None:
                yield {**common, **place, "func_type": COHERENCE, "data": _real(response.coherence[:, o, i])}
    if response.conditioning is not None:
        yield {**common, "id1": "conditioning", "rsp_node": 0, "ref_node": 0, "rsp_dir": 0, "ref_dir": 0,
               "rsp_ent_name": "NONE", "ref_ent_name": "NONE", "func_type": GENERAL_FUNCTION,
               "data": _real(response.conditioning)}  # fmt: skip


def _common(response: FrequencyResponse) -> dict[str, Any]:
    # A fit needs to know how it was estimated; where that leaves room for one note, a warning goes first.
    notes, own = list(map(str, response.notes)), []
    if response.estimation is not None:
        own = [short_estimation_text(response.estimation)]
        notes = list(map(str, sorted(response.notes, key=lambda note: not is_warning(note))))
    lines = ("", response.title, usable_limit_text(response), *own, *notes, "", "")[:5]
    frequencies = np.asarray(response.frequencies, dtype=float)
    return function_dataset(
        lines, x=frequencies, abscissa_spacing=int(_is_even(frequencies)), abscissa_min=float(frequencies[0]),
        abscissa_inc=float(frequencies[1] - frequencies[0]), abscissa_spec_data_type=FREQUENCY_AXIS,
        abscissa_axis_units_lab="Hz", ordinate_axis_units_lab="NONE",
    )  # fmt: skip


def _is_even(frequencies: FloatArray) -> bool:
    """Whether a start and a step of six digits, all that even spacing has room for, give these frequencies in Hz."""
    start, step = (float(f"{value:.5e}") for value in (frequencies[0], frequencies[1] - frequencies[0]))
    return bool(np.array_equal(start + np.arange(len(frequencies)) * step, frequencies))


def _first_line(output: Channel, input: Channel) -> str:
    text = f"{output.name}{PAIR_SEPARATOR}{input.name}"
    if len(text) > ID_LINE_WIDTH or text.count(PAIR_SEPARATOR) > 1 or not text.isascii():
        raise UsageError(
            f"a universal file has no room for the names {text}: 80 plain characters, with one slash between them"
        )
    return text


def _entity(channel: Channel) -> str:
    fits = len(channel.name) <= ENTITY_WIDTH and " " not in channel.name
    return channel.name if fits else "NONE"


def _side(axis: str, channel: Channel) -> dict[str, Any]:
    return {
        f"{axis}_spec_data_type": DATA_TYPES.get(channel.unit, 0),
        f"{axis}_axis_units_lab": channel.unit[:LABEL_WIDTH] or "NONE",
    }


def _complex(values: Any) -> Any:
    return np.ascontiguousarray(values, dtype=complex)


def _real(values: Any) -> Any:
    return np.ascontiguousarray(values, dtype=float)
