"""The largest vibration of running machinery over a range of speeds, of many variants, whatever the step of speeds."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.rows import FloatArray
from torsionnet.response.order_response import OrderResponse
from torsionnet.response.speed_refinement import added, filled, refined, speeds_wanted
from torsionnet.solve.running.order_response import OrderQuestion
from torsionnet.solve.running.resonant_speeds import around_poles
from torsionnet.study.quantities.order_responses import asked_alike, order_responses, responses_at
from torsionnet.study.quantities.variant_block import VariantBlock

Sizes: TypeAlias = Callable[[OrderResponse], FloatArray]
"""What is looked at of a response, (n_speeds,)."""


def largest_orders(
    block: VariantBlock, output: str, speeds: FloatArray, excitations: Sequence[str] | None, sizes: Sizes
) -> Iterator[tuple[int, float]]:
    """Number and largest value of every variant that has one.

    Variants whose parameters follow the operating point are solved one by one.
    """
    question = asked_alike(block, speeds, excitations)
    if question is None or len(speeds) < 2:
        several = len(speeds) > 1
        for index in range(len(block)):
            run = block.asked(
                index,
                lambda model: model.order_response(output, speeds=speeds, excitations=excitations, refine=several),
            )
            if run is not None:
                yield index, float(sizes(run).max())
        return
    first = filled(speeds)
    places, curves = [], []
    for index, run in order_responses(block, output, first, excitations):
        places.append(index)
        curves.append(_Curve(first, sizes(run)))
    search = _Search(block, output, question, sizes, np.array(places, dtype=np.intp))
    lines = question.loads(first[:1]).lines
    poles = block.every_mode.eigenvalues
    around = [added(first, around_poles(poles[index][np.isfinite(poles[index])], lines, first)) for index in places]
    found = refined(search.looked(curves, around), _all_wanted, search.looked)
    yield from ((index, float(curve.values.max())) for index, curve in zip(places, found, strict=True))


@dataclass(frozen=True, eq=False)
class _Curve:
    """Values (n_speeds,) at rising speeds."""

    speeds: FloatArray
    values: FloatArray

    def with_more(self, speeds: FloatArray, values: FloatArray) -> _Curve:
        """Both together."""
        both = np.concatenate([self.speeds, speeds])
        order = np.argsort(both, kind="stable")
        return _Curve(both[order], np.concatenate([self.values, values])[order])


def _all_wanted(curves: Sequence[_Curve]) -> list[FloatArray]:
    """Speeds at which every variant has to be looked at; none at all where all are known."""
    found = [speeds_wanted(curve.speeds, curve.values[:, None]) for curve in curves]
    return found if any(len(one) for one in found) else []


@dataclass(frozen=True, eq=False)
class _Search:
    """Variants that are looked at at speeds of their own, all at once."""

    block: VariantBlock
    output: str
    question: OrderQuestion
    sizes: Sizes
    places: NDArray[np.intp]

    def looked(self, curves: list[_Curve], speeds: list[FloatArray]) -> list[_Curve]:
        """The curves with values at these speeds of each."""
        some = [number for number, those in enumerate(speeds) if len(those)]
        found = list(curves)
        if some:
            own = self._part(self.places[some])
            runs = responses_at(own, self.output, self.question, [speeds[number] for number in some])
            for number, run in zip(some, runs, strict=True):
                found[number] = found[number].with_more(speeds[number], self.sizes(run))
        return found

    def _part(self, places: NDArray[np.intp]) -> VariantBlock:
        values = {name: column[places] for name, column in self.block.values.items()}
        batch = None if self.block.batch is None else self.block.batch.part(places)
        return replace(self.block, values=values, batch=batch, known={})
