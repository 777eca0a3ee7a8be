"""Responses of running machinery of many variants: the orders' transfer functions together, their sums one by one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.response.order_response import OrderResponse
from torsionnet.solve.dynamic_stiffness.transfer_request import remembered
from torsionnet.solve.running.order_response import OrderQuestion
from torsionnet.study.quantities.variant_block import VariantBlock


def order_responses(
    block: VariantBlock, output: str, speeds: FloatArray, excitations: Sequence[str] | None = None
) -> Iterator[tuple[int, OrderResponse]]:
    """Number and response of every variant that has one.

    Variants whose parameters follow the operating point are solved one by one, at every speed with its own values.
    """
    question = asked_alike(block, speeds, excitations)
    if question is None:
        for index in range(len(block)):
            run = block.asked(index, lambda model: model.order_response(output, speeds=speeds, excitations=excitations))
            if run is not None:
                yield index, run
        return
    loads = question.loads(speeds)
    channels = tuple(one.channel for one in remembered(block.model, output, list(loads.inputs), None).outputs)
    frequencies = loads.frequencies
    moving = frequencies[frequencies > 0]
    for which, part in block.parts(len(moving) * len(loads.inputs)):
        solved = part.responses(output, loads.inputs, moving)
        for index, values in zip(range(which.start, which.stop), solved, strict=False):
            gains = np.zeros((len(frequencies), *values.shape[1:]), dtype=complex)
            gains[frequencies > 0] = values
            yield index, loads.response(loads.at_lines(frequencies, gains), channels)


def responses_at(
    block: VariantBlock, output: str, question: OrderQuestion, speeds: Sequence[FloatArray]
) -> Iterator[OrderResponse]:
    """Responses of every variant at speeds of its own, rad/s."""
    loads = [question.loads(own) for own in speeds]
    moving = [one.frequencies[one.frequencies > 0] for one in loads]
    longest = max(map(len, moving))
    # Rows have one length: the last frequency again and again where there are fewer.
    frequencies = np.stack([np.append(own, np.full(longest - len(own), own[-1])) for own in moving])
    inputs = loads[0].inputs
    channels = tuple(one.channel for one in remembered(block.model, output, list(inputs), None).outputs)
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


def asked_alike(block: VariantBlock, speeds: FloatArray, excitations: Sequence[str] | None) -> OrderQuestion | None:
    """What acts on all variants alike; None where they have rows or operating points of their own."""
    if block.batch is None or block.model.definition.following:
        return None
    question = OrderQuestion.of(block.model, speeds, excitations=excitations)
    return question if question.held is block.model else None
