"""Matrix of transfer functions put together from single ones, as files hold them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import tau
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.base.errors import Fault, ModelError
from torsionnet.base.notes import NoteOrText
from torsionnet.linear.frequency_response import Channel, ComplexArray, FloatArray, FrequencyResponse
from torsionnet.signals.foreign.content import COMPLEX, StoredArray

UNKNOWN_UNIT = "1"
"""Unit of a channel of a ratio of like signals, of which the file says nothing more."""


@dataclass
class SingleResponse:
    """Transfer function (n_f,) of one output over one input, in SI, with its coherence."""

    values: ComplexArray
    output_unit: str
    input_unit: str
    coherence: FloatArray | None = None


@dataclass
class ResponseMatrix:
    """Transfer functions (n_f,) by output and input, in the order of the file, at frequencies in Hz."""

    frequencies: FloatArray
    pairs: dict[tuple[str, str], SingleResponse] = field(default_factory=dict)

    def response(self, file: str, title: str, notes: tuple[NoteOrText, ...] = (), **more: Any) -> FrequencyResponse:
        """Frequency response (n_f, n_out, n_in) in SI of the whole matrix, or ModelError if pairs or units do not fit.

        ModelError names missing pairs and channels with two units.
        """
        outputs, inputs = (list(dict.fromkeys(pair[side] for pair in self.pairs)) for side in (0, 1))
        missing = [f"{o}/{i}" for o in outputs for i in inputs if (o, i) not in self.pairs]
        faults = [Fault(f"the matrix is not complete: there is no {', '.join(missing)}")] if missing else []
        units: dict[int, dict[str, str]] = {0: {}, 1: {}}
        for pair, single in self.pairs.items():
            for side, unit in ((0, single.output_unit), (1, single.input_unit)):
                known = units[side].setdefault(pair[side], unit)
                if known != unit:
                    faults.append(Fault(f"{pair[side]} is in {known} in one column and in {unit} in another"))
        if faults:
            raise ModelError(faults, file)
        return FrequencyResponse(
            self.frequencies,
            self._stacked(outputs, inputs, lambda single: single.values),
            tuple(Channel(name, units[0][name]) for name in outputs),
            tuple(Channel(name, units[1][name]) for name in inputs),
            title=title,
            coherence=self._coherence(outputs, inputs),
            notes=notes,
            **more,
        )

    def _stacked(self, outputs: list[str], inputs: list[str], of: Callable[[SingleResponse], Any]) -> Any:
        table = [[of(self.pairs[o, i]) for i in inputs] for o in outputs]
        return np.ascontiguousarray(np.moveaxis(np.array(table), 2, 0))

    def _coherence(self, outputs: list[str], inputs: list[str]) -> FloatArray | None:
        """Coherences (n_f, n_out, n_in) of the matrix, NaN for pairs that have none; None where no pair has one."""
        if all(single.coherence is None for single in self.pairs.values()):
            return None
        unknown = np.full(len(self.frequencies), np.nan)
        stacked: FloatArray = self._stacked(
            outputs, inputs, lambda single: unknown if single.coherence is None else single.coherence
        )
        return stacked


def resolve_units(pairs: Mapping[tuple[str, str], SingleResponse]) -> list[str]:
    """Replace unknown units by those that other pairs tell, and return a note for each pair that stays unknown."""
    changed = True
    while changed:
        changed = False
        known = [
            {pair[0]: s.output_unit for pair, s in pairs.items() if s.output_unit != UNKNOWN_UNIT},
            {pair[1]: s.input_unit for pair, s in pairs.items() if s.input_unit != UNKNOWN_UNIT},
        ]
        for (output, driven), single in pairs.items():
            unit = known[0].get(output) or known[1].get(driven)
            if single.output_unit == UNKNOWN_UNIT and unit:
                single.output_unit = single.input_unit = unit
                changed = True
    open_pairs = [f"{o}/{i}" for (o, i), single in pairs.items() if single.output_unit == UNKNOWN_UNIT]
    return [f"{pair}: a ratio of like signals; the file does not tell their unit" for pair in open_pairs]


# Frequency responses in files of named arrays of any origin: frequencies, and complex numbers of the same length.

FREQUENCY_NAMES = frozenset({"f", "freq", "freqs", "frequency", "frequencies", "frequenz", "f_hz", "freq_hz", "hz"})
"""Names of arrays of frequencies in Hz, in lower case."""
ANGULAR_NAMES = frozenset({"w", "omega", "freq_rad", "w_rad"})
"""Names of arrays of angular frequencies in rad/s, in lower case."""
INPUT = "input"
"""Name of the input of responses whose file names none."""


def response_arrays(arrays: Sequence[StoredArray]) -> tuple[int, list[int]] | None:
    """Number of the array of frequencies and those of complex arrays that fit to it; None where there are none.

    >>> response_arrays([StoredArray("Freq", (9, 1)), StoredArray("H", (9, 1), {COMPLEX: True})])
    (0, [1])
    """
    complexes = [number for number, item in enumerate(arrays) if item.attributes.get(COMPLEX)]
    for number, item in enumerate(arrays):
        fitting = [at for at in complexes if item.length > 1 and item.length in arrays[at].shape[:2]]
        if _plain(item.name) in FREQUENCY_NAMES | ANGULAR_NAMES and number not in complexes and fitting:
            return number, fitting
    return None


def refuse_response(arrays: Sequence[StoredArray]) -> None:
    """Refuse to read a record from arrays that are a frequency response without other real arrays than frequencies."""
    response = response_arrays(arrays)
    if response is None:
        return
    axis, values = response
    others = (item for number, item in enumerate(arrays) if number != axis and item.length > 1)
    if not any(not item.attributes.get(COMPLEX) and item.length != arrays[axis].length for item in others):
        names = ", ".join(arrays[number].name for number in (axis, *values))
        raise ValueError(f"{names} are a frequency response, no record over time; fit and report read responses")


def _plain(name: str) -> str:
    return name.rpartition(".")[2].casefold()


def response_of_arrays(axis: tuple[str, FloatArray], found: Mapping[str, Any], path: Path) -> FrequencyResponse:
    """Frequency response of complex arrays by name, (n_f,), (n_f, n_out) or (n_f, n_out, n_in), over an axis.

    Raises
    ------
    ModelError
        The frequencies do not increase.
    """
    name, frequencies = axis[0], np.asarray(axis[1], dtype=float).ravel()
    notes = [f"{name} was taken for the frequencies in Hz"]
    if _plain(name) in ANGULAR_NAMES:
        frequencies, notes = frequencies / tau, [f"{name} was taken for angular frequencies in rad/s"]
    if not np.all(np.diff(frequencies) > 0):
        raise ModelError(
            [Fault(f"the frequencies in {name} do not increase; sort the lines, or export again")], path.name
        )
    columns = {label: _columns(np.asarray(values, dtype=complex), len(frequencies)) for label, values in found.items()}
    inputs = max(values.shape[2] for values in columns.values())
    if any(values.shape[2] != inputs for values in columns.values()):
        raise ModelError([Fault(f"{', '.join(columns)} have different numbers of inputs; keep one of them")], path.name)
    outputs = [
        label if values.shape[1] == 1 else f"{label}_{at + 1}"
        for label, values in columns.items()
        for at in range(values.shape[1])
    ]
    notes.append("the file tells neither input nor units of the responses: values as in the file")
    return FrequencyResponse(
        frequencies,
        np.concatenate(list(columns.values()), axis=1),
        tuple(Channel(output, UNKNOWN_UNIT) for output in outputs),
        tuple(Channel(INPUT if inputs == 1 else f"{INPUT}_{at + 1}", UNKNOWN_UNIT) for at in range(inputs)),
        title=path.stem,
        notes=tuple(notes),
    )


def _columns(values: ComplexArray, count: int) -> ComplexArray:
    """Responses (n_f, n_out, n_in) of an array with ``count`` frequencies along its first or second dimension."""
    turned = values if values.shape[0] == count else np.moveaxis(values, 1, 0)
    return turned.reshape(count, -1, 1) if turned.ndim < 3 else turned
