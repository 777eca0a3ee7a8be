"""Frequency responses of many variants of one model, over the same frequencies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from torsionnet.base.notes import NoteOrText
from torsionnet.linear.frequency_response import Channel, ComplexArray, FloatArray, FrequencyResponse


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
