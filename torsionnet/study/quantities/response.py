"""Response, a quantity of a study, a transfer function at one frequency, or as a curve over frequency."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from torsionnet.base.entries.scalars import SCALAR_SCHEMA, Band, Value
from torsionnet.base.entries.spec import Count, EntryError, Json, OneOf, Schema, Spec, coerce_part, entry, not_none
from torsionnet.base.errors import Fault, got
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.study.quantities.quantity import QuantityForm, register_quantity
from torsionnet.study.quantities.transfer_quantity import TransferQuantity
from torsionnet.study.quantities.variant_block import VariantBlock

_FREQUENCY = Value("a frequency", "frequency", below=1e9)


class FrequencyList(Spec[tuple[float, ...]]):
    """Entry of a study file for one frequency or a rising list of frequencies; stored in Hz."""

    def coerce(self, raw: object) -> tuple[float, ...]:
        if not isinstance(raw, list | tuple):
            return (_FREQUENCY.coerce(raw),)
        frequencies = tuple(coerce_part(place, _FREQUENCY, frequency) for place, frequency in enumerate(raw))
        if not frequencies or any(second <= first for first, second in pairwise(frequencies)):
            raise EntryError(f"expected a frequency or a list of frequencies that rises, {got(raw)}", kind="wrong-form")
        return frequencies

    def plain(self, value: Any) -> Json:
        return [f"{frequency!r} Hz" for frequency in value] if len(value) > 1 else f"{value[0]!r} Hz"

    def schema(self) -> Schema:
        one_or_more: list[Json] = [SCALAR_SCHEMA, {"type": "array", "items": SCALAR_SCHEMA, "minItems": 1}]
        return {"description": f"{self.description} [Hz]", "anyOf": one_or_more}


DEFAULT_POINTS = 200
"""Number of points of a response curve unless given, as fewer may miss a resonance, more take longer."""


def _decibels(values: ComplexArray) -> FloatArray:
    with np.errstate(divide="ignore"):
        return np.asarray(20 * np.log10(np.abs(values)))


PARTS: Mapping[str, Callable[[ComplexArray], FloatArray]] = {
    "magnitude": np.abs,
    "phase": np.angle,
    "real": np.real,
    "imaginary": np.imag,
    "dB": _decibels,
}
"""Functions by name from complex responses to a part (phase in rad from -pi to pi, dB relative to one SI unit)."""
_UNITS = {"phase": "rad", "dB": "dB"}


@register_quantity
@dataclass(frozen=True, kw_only=True)
class ResponseQuantity(TransferQuantity):
    """Magnitude, phase, real or imaginary part of a transfer function, at one frequency or over frequency.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("dmf_rig")
    >>> static = ResponseQuantity(output="theta_1", input="T_T", at="0 Hz")
    >>> block = VariantBlock(rig, {"k_2": np.array([400.0, 500.0])}, {}, None)
    >>> static.evaluate(block).round(6).tolist(), static.measure(rig).unit
    ([[0.002575], [0.002075]], 'rad/(N*m)')
    """

    kind: ClassVar[str] = "response"

    at: tuple[float, ...] | None = entry(FrequencyList("one frequency, or several in a list"), None)
    band: tuple[float, float] | None = entry(Band("instead: frequencies of a curve", from_zero=True), None)
    points: int | None = entry(Count(f"of the curve; default: {DEFAULT_POINTS}", lower=2, upper=100_000), None)
    spacing: str | None = entry(
        OneOf("of the points; default: by equal factors where the band is a decade or more", ("linear", "log")), None
    )
    part: str = entry(OneOf("what of the complex value; dB over one SI unit", tuple(PARTS)), "magnitude")

    def contradictions(self) -> list[Fault]:
        if (self.at is None) == (self.band is None):
            text = "a response is asked for at: a frequency, or as a curve over a band:"
            return [Fault(text, on_key=True, kind="missing-entry" if self.band is None else "contradicting-entries")]
        if self.band is None:
            return [
                Fault(
                    f"{name} belongs to a band, not to single frequencies", (name,), on_key=True, kind="needless-entry"
                )
                for name in ("points", "spacing")
                if getattr(self, name) is not None
            ]
        if self.spacing == "log" and self.band[0] == 0:
            return [Fault("a band from 0 Hz has no points by equal factors", ("spacing",), kind="contradicting-values")]
        return []

    @property
    def frequencies(self) -> FloatArray:
        """Frequencies (n_points,) in Hz at which the response is asked for."""
        if self.at is not None:
            return np.array(self.at)
        low, high = not_none(self.band)
        # Equal factors over a decade or more.
        is_log = self.spacing == "log" or (self.spacing is None and 0 < 10 * low <= high)
        return np.asarray((np.geomspace if is_log else np.linspace)(low, high, self.points or DEFAULT_POINTS))

    @property
    def words(self) -> str:
        what = (
            "size in dB"
            if self.part == "dB"
            else self.part
            if self.part in ("magnitude", "phase")
            else f"{self.part} part"
        )
        if self.at is not None:
            return f"{what} of {self.quotient} at {', '.join(f'{frequency:g}' for frequency in self.at)} Hz"
        low, high = not_none(self.band)
        return f"{what} of {self.quotient} from {low:g} to {high:g} Hz, {len(self.frequencies)} points"

    def measure(self, model: Drivetrain) -> QuantityForm:
        unit = _UNITS.get(self.part) or self.unit(model)
        frequencies = self.frequencies
        return QuantityForm(unit) if len(frequencies) == 1 else QuantityForm(unit, "frequency", frequencies)

    def evaluate(self, block: VariantBlock) -> FloatArray:
        frequencies = self.frequencies
        values = np.empty((len(block), len(frequencies)))
        for which, part in block.parts(len(frequencies)):
            values[which] = PARTS[self.part](self.values(part, frequencies))
        return values


# Band mean, a quantity of a study, the mean magnitude of a transfer function over a frequency band.


@register_quantity
@dataclass(frozen=True, kw_only=True)
class BandMean(TransferQuantity):
    """Mean or root mean square of a transfer function's magnitude at evenly spaced frequencies of a band."""

    kind: ClassVar[str] = "band_mean"

    band: tuple[float, float] = entry(Band("the frequencies", from_zero=True))
    points: int = entry(Count("evenly spaced, both ends among them", lower=2, upper=100_000), 200)
    mean: str = entry(OneOf("root mean square, or mean of the magnitudes", ("rms", "arithmetic")), "rms")

    @property
    def words(self) -> str:
        what = "mean" if self.mean == "arithmetic" else "root mean square"
        return f"{what} of the magnitude of {self.quotient} from {self.band[0]:g} to {self.band[1]:g} Hz"

    def measure(self, model: Drivetrain) -> QuantityForm:
        return QuantityForm(self.unit(model))

    def evaluate(self, block: VariantBlock) -> FloatArray:
        low, high = self.band
        frequencies = np.linspace(low, high, self.points)
        means = np.empty((len(block), 1))
        for which, part in block.parts(self.points):
            sizes = np.abs(self.values(part, frequencies))
            means[which, 0] = sizes.mean(axis=1) if self.mean == "arithmetic" else np.sqrt((sizes**2).mean(axis=1))
        return means
