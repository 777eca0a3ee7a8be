"""Matrix of transfer functions put together from single ones, as files hold them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from torsionnet.base.errors import Fault, ModelError
from torsionnet.base.notes import NoteOrText
from torsionnet.linear.frequency_response import Channel, ComplexArray, FloatArray, FrequencyResponse

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
