"""Order responses of many variants, and their largest values over a range of speeds, whatever the step of speeds."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.dynamic_stiffness.transfer_request import cached_request
from torsionnet.machinery.criticals.resonant_speeds import around_poles
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.order_solution import OrderRequest
from torsionnet.machinery.orders.speed_refinement import fill_speed_gaps, new_speeds, refine_speeds, speeds_to_refine
from torsionnet.study.quantities.variant_block import VariantBlock


def order_responses(
    block: VariantBlock, output: str, speeds: FloatArray, excitations: Sequence[str] | None = None
) -> Iterator[tuple[int, OrderResponse]]:
    """Yield the number and order response of every variant that has one.

    Variants whose parameters follow the operating point are solved one by one, at every speed with its own values.
    """
    question = common_request(block, speeds, excitations)
    if question is None:
        for index in range(len(block)):
            run = block.call(index, lambda model: model.order_response(output, speeds=speeds, excitations=excitations))
            if run is not None:
                yield index, run
        return
    loads = question.loads(speeds)
    channels = tuple(one.channel for one in cached_request(block.model, output, list(loads.inputs), None).outputs)
    frequencies = loads.frequencies
    moving = frequencies[frequencies > 0]
    for which, part in block.parts(len(moving) * len(loads.inputs)):
        solved = part.responses(output, loads.inputs, moving)
        for index, values in zip(range(which.start, which.stop), solved, strict=False):
            gains = np.zeros((len(frequencies), *values.shape[1:]), dtype=complex)
            gains[frequencies > 0] = values
            yield index, loads.response(loads.at_lines(frequencies, gains), channels)


def responses_at(
    block: VariantBlock, output: str, question: OrderRequest, speeds: Sequence[FloatArray]
) -> Iterator[OrderResponse]:
    """Yield the order response of each variant at its own speeds in rad/s."""
    loads = [question.loads(own) for own in speeds]
    moving = [one.frequencies[one.frequencies > 0] for one in loads]
    longest = max(map(len, moving))
    # Rows have one length: the last frequency again and again where there are fewer.
    frequencies = np.stack([np.append(own, np.full(longest - len(own), own[-1])) for own in moving])
    inputs = loads[0].inputs
    channels = tuple(one.channel for one in cached_request(block.model, output, list(inputs), None).outputs)
    first = 0
    for _, part in block.parts(longest * len(inputs)):
        count = len(part)
        solved = part.responses(output, inputs, frequencies[first : first + count])
        for number, values in enumerate(solved, first):
            every = loads[number].frequencies
            gains = np.zeros((len(every), *values.shape[1:]), dtype=complex)
            gains[every > 0] = values[: len(moving[number])]
            yield loads[number].response(loads[number].at_lines(every, gains), channels)
        first += count


def common_request(block: VariantBlock, speeds: FloatArray, excitations: Sequence[str] | None) -> OrderRequest | None:
    """Excitations and speeds (rad/s) that all variants have in common; None where variants differ in them."""
    if block.batch is None or block.model.definition.follows_speed:
        return None
    question = OrderRequest.of(block.model, speeds, excitations=excitations)
    return question if question.drivetrain is block.model else None


Sizes: TypeAlias = Callable[[OrderResponse], FloatArray]
"""Function from an order response to its size at each speed (n_speeds,), such as half the range."""


def largest_orders(
    block: VariantBlock, output: str, speeds: FloatArray, excitations: Sequence[str] | None, sizes: Sizes
) -> Iterator[tuple[int, float]]:
    """Yield the number of each variant with an order response, and the largest of its sizes over the speeds.

    Variants whose parameters follow the operating point are solved one by one.
    """
    question = common_request(block, speeds, excitations)
    if question is None or len(speeds) < 2:
        several = len(speeds) > 1
        for index in range(len(block)):
            run = block.call(
                index,
                lambda model: model.order_response(output, speeds=speeds, excitations=excitations, refine=several),
            )
            if run is not None:
                yield index, float(sizes(run).max())
        return
    first = fill_speed_gaps(speeds)
    places, curves = [], []
    for index, run in order_responses(block, output, first, excitations):
        places.append(index)
        curves.append(_Curve(first, sizes(run)))
    search = _Search(block, output, question, sizes, np.array(places, dtype=np.intp))
    lines = question.loads(first[:1]).lines
    poles = block.every_mode.eigenvalues
    around = [
        new_speeds(first, around_poles(poles[index][np.isfinite(poles[index])], lines, first)) for index in places
    ]
    found = refine_speeds(search.looked(curves, around), _all_wanted, search.looked)
    yield from ((index, float(curve.values.max())) for index, curve in zip(places, found, strict=True))


@dataclass(frozen=True, eq=False)
class _Curve:
    """Sizes (n_speeds,) of a variant's order response at rising speeds in rad/s."""

    speeds: FloatArray
    values: FloatArray

    def with_more(self, speeds: FloatArray, values: FloatArray) -> _Curve:
        """Curve of a variant's sizes over speed in rad/s, with the sizes at further speeds added."""
        both = np.concatenate([self.speeds, speeds])
        order = np.argsort(both, kind="stable")
        return _Curve(both[order], np.concatenate([self.values, values])[order])


def _all_wanted(curves: Sequence[_Curve]) -> list[FloatArray]:
    """Further speeds in rad/s, an array for each variant, that are needed for its largest size.

    An empty list where no variant needs any.
    """
    found = [speeds_to_refine(curve.speeds, curve.values[:, None]) for curve in curves]
    return found if any(len(one) for one in found) else []


@dataclass(frozen=True, eq=False)
class _Search:
    """Order responses of several variants at their own speeds, solved together."""

    block: VariantBlock
    output: str
    question: OrderRequest
    sizes: Sizes
    places: NDArray[np.intp]

    def looked(self, curves: list[_Curve], speeds: list[FloatArray]) -> list[_Curve]:
        """Curves of each variant's sizes over speed in rad/s, with the sizes at further speeds added."""
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
