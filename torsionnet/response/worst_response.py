"""An order response of which several cases were calculated: each output has that of its worst at every speed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.response.conventions import SI, Conventions
from torsionnet.response.frequency_response import FloatArray
from torsionnet.response.order_response import OrderResponse
from torsionnet.response.table import Column, Table


@dataclass(frozen=True, eq=False)
class WorstResponse(OrderResponse):
    """The largest half range of several cases: by output and speed the amplitudes of the case that has it.

    Attributes
    ----------
    labels : tuple of str
        The cases, as ``misfire of cylinder 4``.
    chosen : (n_speeds, n_out) array of int
        Which case the amplitudes are of.
    alternatives : mapping
        Label -> response of that case alone.
    scattered : tuple of str
        What differs from its rated value, up or down.
    signs : (n_speeds, n_out, n_scattered) array of int
        1 where that is up in the worst combination, -1 where it is down.
    largest : (n_speeds, n_lines, n_out) array
        Largest amplitude that each order has in any case and combination, which may be another than the one chosen.
    """

    labels: tuple[str, ...] = ()
    chosen: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 0), dtype=np.int64))
    alternatives: Mapping[str, OrderResponse] = field(default_factory=dict)
    scattered: tuple[str, ...] = ()
    signs: NDArray[np.int8] = field(default_factory=lambda: np.zeros((0, 0, 0), dtype=np.int8))
    largest: FloatArray = field(default_factory=lambda: np.zeros((0, 0, 0)))

    def cases(self, output: str | None = None) -> tuple[str, ...]:
        """What is worst for an output at each speed."""
        place = self.output(output)
        return tuple(self._case(at, place) for at in range(len(self.speeds)))

    def _case(self, at: int, place: int) -> str:
        parts = [self.labels[self.chosen[at, place]]] if self.labels else []
        if self.scattered:
            high = [name for name, sign in zip(self.scattered, self.signs[at, place], strict=True) if sign > 0]
            parts.append(f"{', '.join(high)} up, the others down" if high else "all down")
        return "; ".join(parts)

    def table(self, output: str | None = None, conventions: Conventions = SI, most: int = 6) -> Table:
        """As of any order response, with the case that is worst at the worst speed."""
        found = super().table(output, conventions, most)
        worst = int(np.argmax(self.half_range[:, self.output(output)]))
        count = f" of {len(self.labels)} cases" if self.labels else ""
        note = f"at every speed the worst{count}; at {self.rpm[worst]:.6g} rpm: {self.cases(output)[worst]}"
        return replace(found, notes=(*found.notes, note))

    def long_table(self) -> Table:
        """As of any order response, with the case of each output."""
        found = super().long_table()
        names = [channel.name for channel in self.outputs]
        by_output = [self.cases(name) for name in names]
        rows = tuple(
            (*row, *(cases[number // len(self.lines)] for cases in by_output)) for number, row in enumerate(found.rows)
        )
        columns = (*found.columns, *(Column(f"{name} case") for name in names))
        return replace(found, columns=columns, rows=rows)


def joined(parts: Sequence[OrderResponse], speeds: FloatArray, title: str) -> OrderResponse:
    """One response out of those at parts of the speeds."""
    values = np.concatenate([part.values for part in parts])
    whole = replace(parts[0], speeds=speeds, values=values, title=title)
    worst = [part for part in parts if isinstance(part, WorstResponse)]
    if not isinstance(whole, WorstResponse):
        return whole
    return replace(
        whole,
        chosen=np.concatenate([part.chosen for part in worst]),
        alternatives={
            label: joined([part.alternatives[label] for part in worst], speeds, title) for label in whole.alternatives
        },
        signs=np.concatenate([part.signs for part in worst]),
        largest=np.concatenate([part.largest for part in worst]),
    )
