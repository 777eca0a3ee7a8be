"""Frequency responses in universal files, with units (dataset 164), channels as nodes (15), functions (58).

That is one of type 4 for every transfer function, of type 6 for its coherence. Both sides are rotations about the X
axis (direction 4). An output and an input have the number of one node only if they have one name, as programs take such
a pair for a driving point. The first line of a dataset names both, ``output / input``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.base.delimited.dialect import plain_unit
from torsionnet.base.errors import Fault, ModelError, UsageError
from torsionnet.base.notes import NoteOrText, is_warning, warning
from torsionnet.base.units import UnitError, parse_unit
from torsionnet.linear.frequency_response import Channel, FloatArray, FrequencyResponse, usable_limit_text
from torsionnet.signals.formats.extras import open_foreign, require_extra
from torsionnet.signals.formats.record_uff import (
    COHERENCE,
    DATA_TYPES,
    FREQUENCY_AXIS,
    FRF,
    FUNCTION_DATASET,
    GENERAL_FUNCTION,
    ID_LINE_WIDTH,
    PAIR_SEPARATOR,
    ROTATION_ABOUT_X,
    TRANSLATIONS,
    TRANSMISSIBILITY,
    UNITS,
    FileUnits,
    abscissa_over,
    contents_of,
    function_dataset,
    text_in,
    units_of_datasets,
    write_sets,
)
from torsionnet.signals.recording import QUANTITY_UNITS
from torsionnet.signals.records.channel_choice import factor_to_si, quantity_of_dimension
from torsionnet.signals.records.source import hertz_in
from torsionnet.signals.response_description import (
    ResponseMatrix,
    SingleResponse,
    estimation_in,
    is_key,
    short_estimation_text,
    usable_limit_in,
)

# Frequency response put together from datasets 58 of any origin.

SAME_FACTOR = 1e-3
"""Relative difference up to which the label of a torque agrees with the units of the file."""
_DIRECTIONS = {0: "", 1: "X", 2: "Y", 3: "Z", 4: "RX", 5: "RY", 6: "RZ"}


def response_of_datasets(sets: Sequence[dict[str, Any]], path: Path) -> FrequencyResponse:
    """Frequency response in SI of all transfer functions in a universal file.

    ModelError lists the datasets that do not fit.
    """
    numbered = [(number, item) for number, item in enumerate(sets, 1) if item.get("type") == FUNCTION_DATASET]
    functions = [(number, item) for number, item in numbered if item["func_type"] in (FRF, TRANSMISSIBILITY)]
    if not functions:
        text = "there is no frequency response (dataset 58 with function type 4) in the file; it holds "
        text += f"{contents_of(sets)}; export transfer functions"
        raise ModelError([Fault(text, kind="wrong-file")], path.name)
    first, units, faults = functions[0][1], units_of_datasets(sets), list[Fault]()
    matrix = ResponseMatrix(np.empty(0))
    for number, item in functions:
        faults += _add(matrix, number, item, units[number - 1])
    faults += [
        fault for number, item in numbered if item["func_type"] == COHERENCE for fault in _cohere(matrix, number, item)
    ]
    if faults:
        raise ModelError(faults, path.name)
    axis = text_in(first, "abscissa_axis_units_lab")
    converted = f"frequencies converted from {axis}" if hertz_in(axis) != 1.0 else ""
    lines = [text_in(first, "id4"), text_in(first, "id5")]
    kept = (line for line in lines if not is_key(line))
    notes = tuple(line for line in (*kept, converted, *_unit_notes(functions, units)) if line)
    general = [item for _, item in numbered if item["func_type"] == GENERAL_FUNCTION]
    conditioning = [np.asarray(item["data"], dtype=float) for item in general if text_in(item, "id1") == "conditioning"]
    more = {
        "conditioning": conditioning[0] if conditioning else None,
        "usable_up_to": usable_limit_in([text_in(first, "id3")]),
        "estimation": estimation_in(lines),
    }
    return matrix.response(path.name, text_in(first, "id2") or path.stem, notes, **more)


def _add(matrix: ResponseMatrix, number: int, item: dict[str, Any], units: FileUnits) -> list[Fault]:
    pair = _pair(item)
    label = f"dataset {number} ({pair[0]} over {pair[1]})"
    values = np.asarray(item["data"], dtype=complex)
    over = abscissa_over(item, FREQUENCY_AXIS)
    if over:
        return [Fault(f"{label} is over {over}; only responses over frequency are read", kind="wrong-file")]
    try:
        frequencies = np.asarray(item["x"], dtype=float) * hertz_in(text_in(item, "abscissa_axis_units_lab"))
    except UnitError as error:
        return [Fault(f"{label}: {error}; only responses over frequency are read", kind=error.kind)]
    if not matrix.pairs:
        matrix.frequencies = frequencies
    if not np.array_equal(frequencies, matrix.frequencies):
        return [
            Fault(f"{label} has other frequencies than the first one; give it a file of its own", kind="unlike-results")
        ]
    if pair in matrix.pairs:
        return [Fault(f"{label} is in the file twice; keep one of them", kind="repeated-name")]
    try:
        (above, up), (below, down) = (
            _si_unit(item, axis, side, units) for axis, side in (("ordinate", "rsp"), ("orddenom", "ref"))
        )
    except UnitError as error:
        return [Fault(f"{label}: {error}", kind=error.kind)]
    factor = up / down
    matrix.pairs[pair] = SingleResponse(
        np.asarray(values if factor == 1.0 else values * factor, dtype=complex), above, below
    )
    return []


def _unit_notes(functions: Sequence[tuple[int, dict[str, Any]]], units: Sequence[FileUnits]) -> list[NoteOrText]:
    """Notes on torques in the units of the file, and a warning on those whose label says another unit."""
    notes = dict[NoteOrText, None]()
    for number, item in functions:
        own, name = units[number - 1].factors.get("torque", 1.0), units[number - 1].name
        for axis in ("ordinate", "orddenom"):
            label, code = text_in(item, f"{axis}_axis_units_lab"), int(item.get(f"{axis}_spec_data_type") or 0)
            if own == 1.0 or UNITS.get(code) != "N*m":
                continue
            factor = float(parse_unit(plain_unit(label)).factor) if label else own
            text = f"the units of the file are {name}, with torques in {own:.6g} N*m"
            if not label:
                notes[text] = None
            elif abs(factor / own - 1) > SAME_FACTOR:
                notes[warning(f"{text}, but a torque has the label {label}, which was taken")] = None
    return list(notes)


def _cohere(matrix: ResponseMatrix, number: int, item: dict[str, Any]) -> list[Fault]:
    pair, values = _pair(item), np.real(np.asarray(item["data"]))
    if pair not in matrix.pairs or len(values) != len(matrix.frequencies):
        return [
            Fault(
                f"dataset {number}: a coherence of {pair[0]} and {pair[1]} without a response at the same frequencies; "
                "add the response, or leave it out",
                kind="missing-data",
            )
        ]
    matrix.pairs[pair].coherence = np.asarray(values, dtype=float)
    return []


def _pair(item: dict[str, Any]) -> tuple[str, str]:
    """Names of output and input of a dataset 58, as written here in the first line, or else by node and direction."""
    output, between, driven = text_in(item, "id1").partition(PAIR_SEPARATOR)
    return (output, driven) if between else (_place(item, "rsp"), _place(item, "ref"))


def _place(item: dict[str, Any], side: str) -> str:
    direction = int(item.get(f"{side}_dir") or 0)
    sign = "" if direction == 0 else "-" if direction < 0 else "+"
    return f"{text_in(item, f'{side}_ent_name')}{item.get(f'{side}_node')}{sign}{_DIRECTIONS[abs(direction)]}"


def _si_unit(item: dict[str, Any], axis: str, side: str, units: FileUnits) -> tuple[str, float]:
    """SI unit of output or input and the factor to it, by its label, or by its code and the units of the file."""
    label = text_in(item, f"{axis}_axis_units_lab")
    if not label:
        code = int(item.get(f"{axis}_spec_data_type") or 0)
        if code not in UNITS or abs(int(item.get(f"{side}_dir") or 0)) in TRANSLATIONS:
            raise UnitError(
                f"the {axis} has no unit and is no rotation of a known kind; only rotations and torques are read",
                kind="missing-unit",
            )
        return UNITS[code], units.factors.get({"N*m": "torque", "Pa": "stress"}.get(UNITS[code], ""), 1.0)
    stress = UNITS.get(int(item.get(f"{axis}_spec_data_type") or 0)) == "Pa"
    quantity = "stress" if stress else quantity_of_dimension(parse_unit(plain_unit(label)).dimension)
    if quantity:
        return QUANTITY_UNITS[quantity], factor_to_si(label, quantity)
    raise UnitError(
        f'"{label}" is no unit of an angle, angular velocity, angular acceleration or torque', kind="wrong-unit"
    )


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
        raise UsageError(
            "a universal file takes responses at two frequencies or more; write an .npz or .csv file",
            kind="no-counterpart",
        )
    if not response.has_phase:
        raise UsageError(
            "a universal file takes complex responses only; write magnitudes into a .csv, .npz or .mat file",
            kind="no-counterpart",
        )
    functions = list(_datasets(response))
    if not all(np.isfinite(item["data"]).all() for item in functions):
        raise UsageError(
            "a universal file takes finite values only; leave frequencies without them out, as with between()",
            kind="no-counterpart",
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
            curve = np.ascontiguousarray(response.values[:, o, i], dtype=complex)
            yield {**common, **place, "func_type": FRF, "data": curve,
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
            f"a universal file has no room for the names {text}: 80 plain characters, with one slash between them",
            kind="no-counterpart",
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


def _real(values: Any) -> Any:
    return np.ascontiguousarray(values, dtype=float)
