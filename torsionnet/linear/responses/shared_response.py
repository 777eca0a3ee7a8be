"""Results that conditions share which differ in excitations alone, since a misfire changes torques and not the rows."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from torsionnet.base.registers import RecentResults
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.frequency_response import FloatArray, FrequencyResponse
from torsionnet.linear.responses.transfer import frequency_response
from torsionnet.model.channels import Sensor

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class _Same:
    """Wrapper of an object for a key of results, equal only to wrappers of the very same object.

    The object need not be hashable.
    """

    entry: object

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and self.entry is other.entry

    def __hash__(self) -> int:
        return id(self.entry)


def mechanics_key(drivetrain: AssembledModel) -> Hashable:
    """Key of all that the equations of motion depend on, equal in conditions that differ only in excitations."""
    definition = drivetrain.definition
    return (
        tuple(map(_Same, definition.active)),
        tuple(definition.parameters.items()),
        tuple(drivetrain.exact_values.items()),
        _Same(definition.load),
        _Same(definition.operating_point),
    )


def shared_by_conditions(
    drivetrain: AssembledModel, kind: type[T], question: Hashable, answer: Callable[[], T], size: Callable[[T], int]
) -> T:
    """Answer to a question about a drivetrain without its excitations, worked out once for all such conditions.

    ``question`` holds all that the answer depends on besides, what excitations contribute included; ``size`` gives
    the bytes of an answer.
    """
    recent = drivetrain.assembly.system.memo.once(RecentResults, None, RecentResults)
    return recent.once(kind, (mechanics_key(drivetrain), question), answer, size)


def named(outputs: str | Sensor | Sequence[str | Sensor]) -> Hashable:
    """Output, or outputs as a tuple, of a request, which can be part of the key of its result."""
    return outputs if isinstance(outputs, str | Sensor) else tuple(outputs)


def shared_response(
    drivetrain: AssembledModel,
    outputs: str | Sensor | Sequence[str | Sensor],
    inputs: Sequence[Any],
    frequencies: FloatArray,
) -> FrequencyResponse:
    """Frequency response in SI units at frequencies (n_f,) in Hz, solved once for repeated requests of equal values."""

    def solved() -> FrequencyResponse:
        return frequency_response(drivetrain, outputs, inputs, frequencies)

    question = (named(outputs), tuple(inputs), frequencies.tobytes())
    return shared_by_conditions(drivetrain, FrequencyResponse, question, solved, lambda found: found.values.nbytes)
