"""Frequency response put together from datasets 58 of any origin."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.base.delimited.headings import plain_unit
from torsionnet.base.errors import Fault, ModelError
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.base.units import UnitError, parse_unit
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.signals.formats.uff.datasets import (
    COHERENCE,
    FREQUENCY_AXIS,
    FRF,
    FUNCTION_DATASET,
    GENERAL_FUNCTION,
    PAIR_SEPARATOR,
    TRANSLATIONS,
    TRANSMISSIBILITY,
    UNITS,
    FileUnits,
    abscissa_over,
    contents_of,
    text_in,
    units_of_datasets,
)
from torsionnet.signals.recording import QUANTITY_UNITS
from torsionnet.signals.records.axes import hertz_in
from torsionnet.signals.records.quantities import factor_to_si, quantity_of_dimension
from torsionnet.signals.responses.response_description import estimation_in, is_key, usable_limit_in
from torsionnet.signals.responses.response_matrix import ResponseMatrix, SingleResponse

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
        raise ModelError([Fault(text)], path.name)
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
        return [Fault(f"{label} is over {over}; only responses over frequency are read")]
    try:
        frequencies = np.asarray(item["x"], dtype=float) * hertz_in(text_in(item, "abscissa_axis_units_lab"))
    except UnitError as error:
        return [Fault(f"{label}: {error}; only responses over frequency are read")]
    if not matrix.pairs:
        matrix.frequencies = frequencies
    if not np.array_equal(frequencies, matrix.frequencies):
        return [Fault(f"{label} has other frequencies than the first one; give it a file of its own")]
    if pair in matrix.pairs:
        return [Fault(f"{label} is in the file twice; keep one of them")]
    try:
        (above, up), (below, down) = (
            _unit(item, axis, side, units) for axis, side in (("ordinate", "rsp"), ("orddenom", "ref"))
        )
    except UnitError as error:
        return [Fault(f"{label}: {error}")]
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
                "add the response, or leave it out"
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


def _unit(item: dict[str, Any], axis: str, side: str, units: FileUnits) -> tuple[str, float]:
    """SI unit of output or input and the factor to it, by its label, or by its code and the units of the file."""
    label = text_in(item, f"{axis}_axis_units_lab")
    if not label:
        code = int(item.get(f"{axis}_spec_data_type") or 0)
        if code not in UNITS or abs(int(item.get(f"{side}_dir") or 0)) in TRANSLATIONS:
            raise UnitError(
                f"the {axis} has no unit and is no rotation of a known kind; only rotations and torques are read"
            )
        return UNITS[code], units.factors.get({"N*m": "torque", "Pa": "stress"}.get(UNITS[code], ""), 1.0)
    stress = UNITS.get(int(item.get(f"{axis}_spec_data_type") or 0)) == "Pa"
    quantity = "stress" if stress else quantity_of_dimension(parse_unit(plain_unit(label)).dimension)
    if quantity:
        return QUANTITY_UNITS[quantity], factor_to_si(label, quantity)
    raise UnitError(f'"{label}" is no unit of an angle, angular velocity, angular acceleration or torque')
