"""Frequency responses as files hold them, with a description beside arrays and matrices made of single functions."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import tau
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.base.errors import Fault, ModelError, UsageError
from torsionnet.base.notes import NoteOrText, note_data, stored_note
from torsionnet.linear.between_samples import BetweenSamples, check_between
from torsionnet.linear.estimation import Estimation, read_estimation
from torsionnet.linear.frequency_response import Channel, ComplexArray, FloatArray, FrequencyResponse
from torsionnet.signals.foreign.content import COMPLEX, StoredArray

# Descriptions of frequency responses: all but the arrays as a JSON text beside them; in older files, their notes.

KEY = "torsionnet_frequency_response"
"""Name under which the description of a frequency response stands in a file."""
NUMBERS = ("frequencies", "values", "coherence", "conditioning")
"""Names of the arrays of a frequency response in a file."""
_SHORT = ("estimator", "window", "seconds", "overlap", "detrend", "averages", "effective_averages")
"""Names of averaging data in the order in which a line of a universal file has them."""
_LIMIT = re.compile(r"usable(?:_up_to:| up to) (\S+) Hz")
_ESTIMATION = re.compile(r"estimation: (\{.*\}|\[.*\])")
_OLD_ESTIMATION = re.compile(
    r"(?P<estimator>H\w+)( with .+?)?, Welch, (?P<window>\w+) (?P<seconds>\S+) s, overlap (?P<overlap>[\d.]+)%, "
    r"detrend (?P<detrend>\w+), (?P<averages>\d+) averages worth (?P<effective>[\d.]+)\b.*"
)


def description(response: FrequencyResponse) -> str:
    """JSON text of names, units, title and notes of a frequency response."""
    data: dict[str, Any] = {
        "outputs": [_entries(channel) for channel in response.outputs],
        "inputs": [_entries(channel) for channel in response.inputs],
        "title": response.title,
        "notes": list(map(note_data, response.notes)),
    }
    if response.usable_up_to is not None:
        data["usable_up_to"] = response.usable_up_to
    if response.estimation is not None:
        data["estimation"] = response.estimation.to_data()
    if not response.has_phase:
        data["has_phase"] = False
    return json.dumps(data)


def _entries(channel: Channel) -> list[str | float]:
    """Name and unit of a channel, with its course and rate in Hz unless that is band-limited, as it always was once."""
    course = channel.course
    return [
        channel.name,
        channel.unit,
        *([] if course is None or course.is_band_limited else [course.between, course.rate]),
    ]


def _channel(name: object, unit: object, between: object = None, rate: Any = None) -> Channel:
    course = None if between is None else BetweenSamples(check_between(str(between)), float(rate))
    return Channel(str(name), str(unit), course)


def arrays(response: FrequencyResponse) -> dict[str, Any]:
    """Arrays of a frequency response by name, coherence and conditioning only where there are any."""
    return {name: values for name in NUMBERS if (values := getattr(response, name)) is not None}


def check_members(there: Collection[str], path: Path, whole: str, nothing: str) -> None:
    """Refuse a file of named arrays that lacks those of a frequency response.

    ``nothing`` says what a file without any is.
    """
    missing = [name for name in (KEY, "frequencies", "values") if name not in there]
    if missing:
        words = f"has {', '.join(there)}" if there else nothing
        text = f"the {whole} has no {', '.join(missing)}: no frequency response of torsionnet; it {words}"
        raise ModelError([Fault(text, kind="wrong-file")], path.name)


def parse_description(text: str) -> dict[str, Any]:
    """Arguments of :class:`FrequencyResponse` but for its arrays, read from the JSON text of its description.

    Raises ``ValueError`` for a damaged description.
    """
    try:
        data = json.loads(text)
        sides = {side: tuple(_channel(*entries) for entries in data[side]) for side in ("outputs", "inputs")}
        limit = data.get("usable_up_to")
        return {
            **sides,
            "usable_up_to": None if limit is None else float(limit),
            "estimation": read_estimation(data["estimation"]) if "estimation" in data else None,
            "title": str(data["title"]),
            "notes": tuple(map(stored_note, data["notes"])),
            "has_phase": bool(data.get("has_phase", True)),
        }
    except (json.JSONDecodeError, KeyError, TypeError, ValueError, UsageError) as error:
        raise ValueError(
            f"the description of the response in the file is damaged ({type(error).__name__}: {error})"
        ) from error


def response_from(text: str, numbers: dict[str, Any]) -> FrequencyResponse:
    """Frequency response from its description and its arrays by name.

    Raises ``ValueError`` where the two do not fit.
    """
    said = parse_description(text)
    sizes = (len(numbers["frequencies"]), len(said["outputs"]), len(said["inputs"]))
    shapes = {"frequencies": sizes[:1], "values": sizes, "coherence": sizes, "conditioning": sizes[:1]}
    for name, values in numbers.items():
        if values.shape != shapes[name]:
            raise ValueError(
                f"{name} has shape {values.shape}, but the description in the "
                f"file says {shapes[name]}; write the file again"
            )
    return FrequencyResponse(**said, **numbers)


def short_estimation_text(estimation: Estimation) -> str:
    """Key and main averaging data of a response as a list, for a line of 80 characters.

    >>> short_estimation_text(Estimation("H1", "hann", 8.0, 0.75, "mean", 21, 11.82345678))
    'estimation: ["H1","hann",8.0,0.75,"mean",21,11.8235]'
    """
    values = (getattr(estimation, name) for name in _SHORT)
    rounded = [float(f"{value:.6g}") if isinstance(value, float) else value for value in values]
    return f"estimation: {json.dumps(rounded, separators=(',', ':'))}"


def is_key(line: str) -> bool:
    """Whether a text of a file is the usable limit or the averaging data of a response rather than a note on it.

    >>> is_key("usable_up_to: 16.8 Hz"), is_key("usable in the lab")
    (True, False)
    """
    return _LIMIT.fullmatch(line) is not None or _ESTIMATION.fullmatch(line) is not None


def usable_limit_in(lines: Iterable[str]) -> float | None:
    """Frequency in Hz up to which a response is usable, from its key among the texts of a file; None without one.

    Older files have a sentence in place of the key.

    >>> usable_limit_in(["a title", "usable_up_to: 16.8 Hz"]), usable_limit_in(["usable up to 16.8 Hz"])
    (16.8, 16.8)
    """
    limits = [match[1] for line in lines if (match := _LIMIT.fullmatch(line))]
    try:
        return float(limits[0]) if limits else None
    except ValueError:
        return None


def estimation_in(lines: Iterable[str]) -> Estimation | None:
    """Averaging data of an estimated response, from their key among the texts of a file; None without them.

    Older files have a note in place of the key.

    >>> estimation_in(["a title", 'estimation: ["H1","hann",8.0,0.75,"mean",21,11.8]']).seconds
    8.0
    >>> estimation_in(["H1, Welch, hann 8 s, overlap 75%, detrend mean, 21 averages worth 11.8 without"]).seconds
    8.0
    """
    lines = list(lines)
    for line in lines:
        if match := _ESTIMATION.fullmatch(line):
            try:
                data = json.loads(match[1])
                return read_estimation(dict(zip(_SHORT, data, strict=True)) if isinstance(data, list) else data)
            except (KeyError, TypeError, ValueError):
                return None
    for note in lines:
        match = _OLD_ESTIMATION.fullmatch(note)
        if match:
            seconds, overlap, effective = (float(match[key]) for key in ("seconds", "overlap", "effective"))
            names = match["estimator"], match["window"]
            return Estimation(*names, seconds, overlap / 100, match["detrend"], int(match["averages"]), effective)
    return None


# Matrix of transfer functions put together from single ones, as files hold them.

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
        faults = (
            [Fault(f"the matrix is not complete: there is no {', '.join(missing)}", kind="missing-data")]
            if missing
            else []
        )
        units: dict[int, dict[str, str]] = {0: {}, 1: {}}
        for pair, single in self.pairs.items():
            for side, unit in ((0, single.output_unit), (1, single.input_unit)):
                known = units[side].setdefault(pair[side], unit)
                if known != unit:
                    faults.append(
                        Fault(
                            f"{pair[side]} is in {known} in one column and in {unit} in another",
                            kind="contradicting-values",
                        )
                    )
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


def response_of_arrays(axis: tuple[str, FloatArray], members: Mapping[str, Any], path: Path) -> FrequencyResponse:
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
            [
                Fault(
                    f"the frequencies in {name} do not increase; sort the lines, or export again", kind="unordered-rows"
                )
            ],
            path.name,
        )
    columns = {
        label: _columns(np.asarray(values, dtype=complex), len(frequencies)) for label, values in members.items()
    }
    inputs = max(values.shape[2] for values in columns.values())
    if any(values.shape[2] != inputs for values in columns.values()):
        raise ModelError(
            [
                Fault(
                    f"{', '.join(columns)} have different numbers of inputs; keep one of them",
                    kind="contradicting-values",
                )
            ],
            path.name,
        )
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
