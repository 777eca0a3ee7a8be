"""A torque over time as an entry: out of a recording, or sample by sample."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from torsionnet.core.entries.composite import Composite, Listed
from torsionnet.core.entries.nearby import nearby_file
from torsionnet.core.entries.scalars import SCALAR_SCHEMA, Value
from torsionnet.core.entries.spec import EntryError, Schema
from torsionnet.core.errors import Fault, TorsionnetError
from torsionnet.io.recording_files import read_recording

FORM = "{file: shock.csv, channel: T_M} or {rate: 1 kHz, values: [0, 10, ...]}"
_RATE = Value("samples per second", "frequency", exclusive=True)
_VALUES = Listed("torques", Value("a torque", "torque", lower=None), form="a list of torques")


@dataclass(frozen=True)
class TorqueHistory:
    """Torques in N m, ``rate`` of them in a second."""

    rate: float
    values: tuple[float, ...]


class TorqueHistoryEntry(Composite):
    """A channel of a recording beside the file of the study, or a list of torques with their rate."""

    @property
    def example(self) -> str:
        return FORM

    def read(self, raw: Any) -> tuple[TorqueHistory | None, list[Fault]]:
        if isinstance(raw, TorqueHistory):
            return raw, []
        keys = set(raw) if isinstance(raw, Mapping) else set()
        if keys == {"rate", "values"}:
            return self._listed(raw)
        if keys != {"file", "channel"}:
            return None, [Fault(f"expected {FORM}, got {raw!r}")]
        try:
            return _recorded(str(raw["file"]), str(raw["channel"])), []
        except EntryError as error:
            return None, [fault.under("file") for fault in error.faults]
        except TorsionnetError as error:
            return None, [Fault(str(error), ("channel",))]

    def _listed(self, raw: Mapping[str, Any]) -> tuple[TorqueHistory | None, list[Fault]]:
        (rate, wrong), (values, others) = _RATE.read(raw["rate"]), _VALUES.read(raw["values"])
        faults = [fault.under("rate") for fault in wrong] + [fault.under("values") for fault in others]
        if not faults and len(values) < 2:
            faults = [Fault("a torque over time has two samples or more", ("values",))]
        return (None if faults else TorqueHistory(rate, values)), faults

    def plain(self, value: Any) -> Any:
        """The numbers, so that a written study can be read anywhere."""
        return {"rate": value.rate, "values": list(value.values)}

    def schema(self) -> Schema:
        samples = {"type": "array", "items": SCALAR_SCHEMA, "minItems": 2}
        forms = (
            {"file": {"type": "string"}, "channel": {"type": "string"}},
            {"rate": SCALAR_SCHEMA, "values": samples},
        )
        return {
            "description": self.description,
            "anyOf": [
                {"type": "object", "properties": form, "required": list(form), "additionalProperties": False}
                for form in forms
            ],
        }


def _recorded(file: str, channel: str) -> TorqueHistory:
    record = read_recording(nearby_file(file), names=[channel])
    signal = record[channel]
    if signal.quantity != "torque":
        raise EntryError(f'"{channel}" of {file} is no torque, but {signal.quantity or "of unknown quantity"}')
    if record.times is not None:
        raise EntryError(f"{file} was not sampled at even steps; resample it first")
    if not np.isfinite(signal.values).all() or len(signal.values) < 2:
        raise EntryError(f'"{channel}" of {file} has gaps, or less than two samples')
    return TorqueHistory(record.sampling_rate, tuple(signal.values.tolist()))
