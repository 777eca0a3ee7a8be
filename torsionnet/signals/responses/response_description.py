"""Descriptions of frequency responses: all but the arrays as a JSON text beside them; in older files, their notes."""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Iterable
from pathlib import Path
from typing import Any

from torsionnet.base.errors import Fault, ModelError, UsageError
from torsionnet.base.notes import note_data, stored_note
from torsionnet.linear.between_samples import BetweenSamples, check_between
from torsionnet.linear.estimation import Estimation, read_estimation
from torsionnet.linear.frequency_response import Channel, FrequencyResponse

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
        raise ModelError([Fault(text)], path.name)


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
    found = [match[1] for line in lines if (match := _LIMIT.fullmatch(line))]
    try:
        return float(found[0]) if found else None
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
        if found := _ESTIMATION.fullmatch(line):
            try:
                data = json.loads(found[1])
                return read_estimation(dict(zip(_SHORT, data, strict=True)) if isinstance(data, list) else data)
            except (KeyError, TypeError, ValueError):
                return None
    for note in lines:
        found = _OLD_ESTIMATION.fullmatch(note)
        if found:
            seconds, overlap, effective = (float(found[key]) for key in ("seconds", "overlap", "effective"))
            names = found["estimator"], found["window"]
            return Estimation(*names, seconds, overlap / 100, found["detrend"], int(found["averages"]), effective)
    return None
