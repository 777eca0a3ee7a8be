"""Entry for a pressure trace: a list of pressures, or the name of a file."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.base.entries.composite import Composite
from torsionnet.base.entries.declared import nearby_file
from torsionnet.base.entries.scalars import SCALAR_SCHEMA, Value
from torsionnet.base.entries.spec import EntryError, Json, Schema, not_none
from torsionnet.base.errors import Fault, ModelError, got
from torsionnet.machinery.excitations.pressure_file import read_pressure_file
from torsionnet.machinery.excitations.pressure_trace import (
    CLOSING_RTOL,
    LEAST_SAMPLES,
    WHOLE_CYCLE,
    PressureTrace,
    peak_pressure_fault,
)

PRESSURE = Value("a pressure", "pressure", lower=None)
_ANGLE = Value("crank angle of the first pressure", "angle", lower=None)


class TraceEntry(Composite[PressureTrace]):
    """Entry for a pressure trace of a cylinder over one cycle.

    A list at even steps, a list with its first angle, or the name of a file.
    """

    @property
    def example(self) -> str:
        return "p100.csv, or a list of pressures"

    def read(self, raw: object) -> tuple[Any, list[Fault]]:
        if isinstance(raw, PressureTrace):
            return raw, []
        try:
            return self._read(raw)
        except EntryError as error:
            return None, error.faults
        except ModelError as error:
            return None, list(error.faults)

    def _read(self, raw: object) -> tuple[Any, list[Fault]]:
        if isinstance(raw, str | Path):
            return read_pressure_file(raw if isinstance(raw, Path) else nearby_file(raw)), []
        start = 0.0
        if isinstance(raw, Mapping):
            if set(raw) != {"start", "pressures"}:
                raise EntryError(f"expected {{start: 0.5 deg, pressures: [...]}}, {got(raw)}")
            start, raw = _ANGLE.coerce(raw["start"]), raw["pressures"]
        if not isinstance(raw, Sequence | np.ndarray):
            raise EntryError(f"expected a list of pressures or the name of a file, {got(raw)}")
        values, faults = _numbers(raw)
        faults = faults or [Fault(text, on_key=True) for text in _wrong(values)]
        return PressureTrace(tuple(values[:-1] if len(values) % 2 else values), start), faults

    def plain(self, value: Any) -> Json:
        """Plain list of pressures in Pa instead of the file name, so that a written model can be read anywhere."""
        return list(value.values) if not value.start else {"start": value.start, "pressures": list(value.values)}

    def schema(self) -> Schema:
        several: Schema = {"type": "array", "items": SCALAR_SCHEMA}
        begun: Schema = {
            "type": "object",
            "properties": {"start": SCALAR_SCHEMA, "pressures": several},
            "required": ["start", "pressures"],
            "additionalProperties": False,
        }
        return {"description": self.description, "anyOf": [several, {"type": "string"}, begun]}


def _numbers(raw: Sequence[Any] | np.ndarray[Any, Any]) -> tuple[list[float], list[Fault]]:
    """Pressures of a list in Pa, and the faults of entries that are no pressures."""
    values: list[float] = []
    faults: list[Fault] = []
    for index, one in enumerate(raw.tolist() if isinstance(raw, np.ndarray) else raw):
        plain = isinstance(one, float) and math.isfinite(one)
        value, wrong = (one, []) if plain else PRESSURE.read(one)
        faults += [fault.under(index) for fault in wrong]
        values += [] if wrong else [not_none(value)]
    return values, faults


def _wrong(values: Sequence[float]) -> Iterator[str]:
    """Messages on a list of too few pressures, or one that does not close.

    An odd list has both ends of the cycle: 721 values at 0 to 720 degrees are 720 steps.
    """
    if len(values) < LEAST_SAMPLES:
        yield f"{len(values)} pressures are too few for a cycle; give {LEAST_SAMPLES} or more"
        return
    if len(values) % 2 and abs(values[0] - values[-1]) > CLOSING_RTOL * max(map(abs, values)):
        text = f"the trace does not close: it begins with {values[0]:.6g} Pa and ends with {values[-1]:.6g} Pa"
        yield f"{text}; give the whole cycle, with or without its last point: {WHOLE_CYCLE}"
    elif text := peak_pressure_fault(PressureTrace(tuple(values))):
        yield text
