"""Results that conditions share which differ in excitations alone, since a misfire changes torques and not the rows."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from torsionnet.base.notes import NoteOrText
from torsionnet.base.registers import RecentResults, Same
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.frequency_response import Channel, ComplexArray, FloatArray, FrequencyResponse
from torsionnet.linear.responses.transfer import frequency_response
from torsionnet.model.channels import Sensor

T = TypeVar("T")


def mechanics_key(drivetrain: AssembledModel) -> Hashable:
    """Key of all that the equations of motion depend on, equal in conditions that differ only in excitations."""
    definition = drivetrain.definition
    return (
        tuple(map(Same, definition.active)),
        tuple(definition.parameters.items()),
        tuple(drivetrain.exact_values.items()),
        Same(definition.load),
        Same(definition.operating_point),
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
    return shared_by_conditions(drivetrain, FrequencyResponse, question, solved, lambda known: known.values.nbytes)


# Frequency responses of many variants of one model, over the same frequencies.


@dataclass(frozen=True, eq=False)
class FrequencyResponses:
    """Frequency responses in SI of the variants of a model, a sequence of :class:`FrequencyResponse`.

    Attributes
    ----------
    parameters : dict
        By name, values (n_variants,) in SI of the parameters that differ between the variants.
    frequencies : (n_f,) array
        Frequencies, Hz.
    values : (n_variants, n_f, n_out, n_in) complex array
        SI units, rad for angles.
    outputs, inputs : tuple of Channel
    title : str
    conditioning : (n_variants, n_f) array, optional
        As in :class:`FrequencyResponse`.
    notes : tuple of str or Note
    model, configuration : str
    """

    parameters: Mapping[str, FloatArray]
    frequencies: FloatArray
    values: ComplexArray
    outputs: tuple[Channel, ...]
    inputs: tuple[Channel, ...]
    title: str = ""
    conditioning: FloatArray | None = None
    notes: tuple[NoteOrText, ...] = ()
    model: str = ""
    configuration: str = ""

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, variant: int) -> FrequencyResponse:
        settings = ", ".join(f"{name} = {values[variant]:g}" for name, values in self.parameters.items())
        return FrequencyResponse(
            self.frequencies,
            self.values[variant],
            self.outputs,
            self.inputs,
            f"{self.title}, {settings}" if settings else self.title,
            None if self.conditioning is None else self.conditioning[variant],
            notes=self.notes,
            model=self.model,
            configuration=", ".join(filter(None, (self.configuration, settings))),
        )

    def __iter__(self) -> Iterator[FrequencyResponse]:
        return (self[variant] for variant in range(len(self)))

    @property
    def magnitude(self) -> FloatArray:
        """Magnitude of the transfer functions in SI of each variant, shape (n_variants, n_f, n_out, n_in)."""
        return np.abs(self.values)

    def __repr__(self) -> str:
        outputs, inputs = (", ".join(channel.name for channel in side) for side in (self.outputs, self.inputs))
        size = f"{len(self)} variants of {', '.join(self.parameters)}, {len(self.frequencies)} frequencies"
        return f"<FrequencyResponses {outputs} / {inputs}: {size}>"
