"""The parameters of a model on a tape."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from torsionnet.io.fmu.traced_numbers import NumberTape, Traced
from torsionnet.model.parameters import Parameter, evaluation_order


def trace_parameters(
    tape: NumberTape, definitions: Mapping[str, Parameter], values: Mapping[str, Any], settled: Iterable[str]
) -> dict[str, Traced]:
    """Every parameter on a tape; derived ones follow those they are made of, settled ones are constants."""
    traced: dict[str, Traced] = {}
    for name in evaluation_order(definitions)[0]:
        expression = definitions[name].value
        if name in settled:
            traced[name] = tape.number(values[name])
        elif expression.names:
            traced[name] = expression.evaluate(traced, tape.algebra)
        else:
            traced[name] = tape.parameter(name, values[name])
    return {name: tape.number(traced[name]) for name in definitions}
