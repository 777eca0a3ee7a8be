"""What a frequency response is besides its numbers, as one JSON text that goes into a file next to them."""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from torsionnet.core.errors import Fault, ModelError
from torsionnet.response import Channel, FrequencyResponse
from torsionnet.response.estimation import Estimation, read_estimation

KEY = "torsionnet_frequency_response"
NUMBERS = ("frequencies", "values", "coherence", "conditioning")
_LIMIT = re.compile(r"usable up to (\S+) Hz")


def description(response: FrequencyResponse) -> str:
    """JSON text of names, units, title and notes."""
    data: dict[str, Any] = {
        "outputs": [[channel.name, channel.unit] for channel in response.outputs],
        "inputs": [[channel.name, channel.unit] for channel in response.inputs],
        "title": response.title,
        "notes": list(response.notes),
    }
    if response.usable_up_to is not None:
        data["usable_up_to"] = response.usable_up_to
    if response.estimation is not None:
        data["estimation"] = response.estimation.to_data()
    if not response.has_phase:
        data["has_phase"] = False
    return json.dumps(data)


def arrays(response: FrequencyResponse) -> dict[str, Any]:
    """The numbers by name; coherence and conditioning only where there are any."""
    return {name: values for name in NUMBERS if (values := getattr(response, name)) is not None}


def check_members(there: Collection[str], path: Path, whole: str, nothing: str) -> None:
    """Refuse a file of named arrays without those of a response; ``nothing`` is what it does if it holds none."""
    missing = [name for name in (KEY, "frequencies", "values") if name not in there]
    if missing:
        words = f"has {', '.join(there)}" if there else nothing
        text = f"the {whole} has no {', '.join(missing)}: no frequency response of torsionnet; it {words}"
        raise ModelError([Fault(text)], path.name)


@dataclass(frozen=True)
class ResponseWords:
    """A description taken apart."""

    outputs: tuple[Channel, ...]
    inputs: tuple[Channel, ...]
    title: str
    notes: tuple[str, ...]
    usable_up_to: float | None
    estimation: Estimation | None
    has_phase: bool


def words(text: str) -> ResponseWords:
    """A description taken apart; ``ValueError`` where it is damaged."""
    try:
        data = json.loads(text)
        outputs, inputs = (tuple(Channel(str(n), str(u)) for n, u in data[side]) for side in ("outputs", "inputs"))
        limit = data.get("usable_up_to")
        limit = None if limit is None else float(limit)
        estimation = read_estimation(data["estimation"]) if "estimation" in data else None
        title, notes, has_phase = str(data["title"]), tuple(map(str, data["notes"])), bool(data.get("has_phase", True))
        return ResponseWords(outputs, inputs, title, notes, limit, estimation, has_phase)
    except (json.JSONDecodeError, KeyError, TypeError, ValueError) as error:
        raise ValueError(
            f"the description of the response in the file is damaged ({type(error).__name__}: {error})"
        ) from error


def described(text: str, numbers: dict[str, Any]) -> FrequencyResponse:
    """The response made of a description and numbers; ``ValueError`` where the two do not fit each other."""
    said = words(text)
    sizes = (len(numbers["frequencies"]), len(said.outputs), len(said.inputs))
    shapes = {"frequencies": sizes[:1], "values": sizes, "coherence": sizes, "conditioning": sizes[:1]}
    for name, values in numbers.items():
        if values.shape != shapes[name]:
            raise ValueError(f"{name} has shape {values.shape}, its description says {shapes[name]}")
    return FrequencyResponse(
        outputs=said.outputs,
        inputs=said.inputs,
        title=said.title,
        notes=said.notes,
        usable_up_to=said.usable_up_to,
        estimation=said.estimation,
        has_phase=said.has_phase,
        **numbers,
    )


def limit_in(lines: Iterable[str]) -> float | None:
    """What the line about it says, for files that hold nothing but lines of text.

    >>> limit_in(["a title", "usable up to 16.8 Hz"])
    16.8
    """
    found = [match[1] for line in lines if (match := _LIMIT.fullmatch(line))]
    try:
        return float(found[0]) if found else None
    except ValueError:
        return None
