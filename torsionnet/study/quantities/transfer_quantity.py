"""Quantities of one transfer function of a study: base class, value at one frequency or as a curve, and mean."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.scalars import SCALAR_SCHEMA, Band, Value
from torsionnet.base.entries.spec import (
    Count,
    EntryError,
    Json,
    OneOf,
    Schema,
    Spec,
    Text,
    coerce_part,
    entry,
    not_none,
)
from torsionnet.base.errors import Fault, UsageError, got
from torsionnet.base.units import RPM
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.transfer_request import cached_request, named_output, resolve_inputs
from torsionnet.linear.frequency_response import quotient_unit
from torsionnet.machinery.excitations.speed_range import SpeedBand
from torsionnet.study.quantities.quantity import QuantityForm, StudyQuantity, VariantBlock, register_quantity

# Base class of a study's quantities of one transfer function, which have an output, input and excitation.


@dataclass(frozen=True, kw_only=True)
class TransferQuantity(StudyQuantity):
    """Base class of a study's quantities of one transfer function from an input to an output."""

    kind: ClassVar[str] = "transfer function"

    output: str = entry(Text("sensor, node, torque(element), twist(element), stress(shaft), ..."))
    input: str = entry(Text("input or node that is driven, or a sensor: a measured input"))
    excitation: str | None = entry(Text("what drives where the input is measured; default: the only input"), None)

    common: ClassVar[tuple[str, ...]] = ("excitation",)

    def model_faults(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        del quantities
        asked = (
            ("output", lambda: named_output(model, self.output)),
            ("input", lambda: resolve_inputs(model, self.input, self.excitation)),
        )
        faults = [fault for name, ask in asked for fault in usage_faults(ask, name)]
        yield from faults or usage_faults(
            lambda: cached_request(model, self.output, self.input, self.excitation), "input"
        )

    @property
    def quotient(self) -> str:
        """Words for the transfer function, such as "theta_1/T_M"."""
        driven_by = f", driven at {self.excitation}" if self.excitation else ""
        return f"{self.output}/{self.input}{driven_by}"

    def unit(self, model: Drivetrain) -> str:
        """SI unit of the transfer function, that of the output over that of the input, empty if it has none."""
        request = cached_request(model, self.output, self.input, self.excitation)
        unit = quotient_unit(request.outputs[0].unit, request.inputs[0].unit)
        return "" if unit == "1" else unit

    def values(self, block: VariantBlock, frequencies: FloatArray) -> ComplexArray:
        """Transfer function (n_variants, n_f) in SI at frequencies (n_f,) or (n_variants, n_f) in Hz."""
        return block.responses(self.output, self.input, frequencies, self.excitation)[:, :, 0, 0]


def usage_faults(ask: Callable[[], object], *path: str) -> Iterator[Fault]:
    """Yield a fault of the UsageError that a call raises, if it raises one."""
    try:
        ask()
    except UsageError as error:
        yield replace(error.fault, path=path)


# Base class of quantities of a study over the speeds of the machinery.

OWN = ("excitations", "speeds", "every")
"""Names of the entries that every quantity over the speeds of the machinery has."""


@dataclass(frozen=True, kw_only=True)
class SpeedQuantity(StudyQuantity):
    """Base class of the quantities of a study at all speeds of the model, or at some of them."""

    kind: ClassVar[str] = "over speed"

    excitations: tuple[str, ...] = entry(Listed("excitations that act; default: all", Text("an excitation")), None)
    speeds: tuple[float, float] | None = entry(SpeedBand("part of the model's speeds"), None)
    every: int = entry(Count("only every n-th of them, and the last, to save time", upper=10_000), 1)

    common: ClassVar[tuple[str, ...]] = OWN

    def at(self, model: Drivetrain) -> FloatArray:
        """Speeds (n_speeds,) in rad/s at which the quantity is calculated; empty where the model has no speeds."""
        given = model.definition.speeds
        speeds = np.array(given.values if given else ())
        if self.speeds is not None:
            low, high = self.speeds
            speeds = speeds[(speeds >= low * (1 - 1e-9)) & (speeds <= high * (1 + 1e-9))]
        return np.append(speeds[:-1][:: self.every], speeds[-1:])

    @staticmethod
    def is_range(model: Drivetrain) -> bool:
        """Whether the model's speeds are a range, which includes all speeds between them, and not a list."""
        given = model.definition.speeds
        return given is not None and not given.list

    @property
    def range_words(self) -> str:
        """Words for the speeds and excitations of the quantity, such as "at all speeds"."""
        acting = f"under {', '.join(self.excitations)}, " if self.excitations else ""
        over = "at all speeds" if self.speeds is None else speed_words(self.speeds)
        return acting + (over if self.every == 1 else f"{over}, one of {self.every}")

    def empty_range_faults(self, model: Drivetrain) -> Iterator[Fault]:
        """Yield a fault where none of the model's speeds lies in the range of the quantity."""
        if model.definition.speeds is not None and not len(self.at(model)):
            yield Fault("none of the model's speeds lies in this range", ("speeds",), kind="out-of-range")


def speed_words(speeds: tuple[float, float]) -> str:
    """Words in r/min for a range of speeds in rad/s.

    >>> speed_words((62.83185307179586, 157.07963267948966))
    'from 600 to 1500 r/min'
    """
    return f"from {speeds[0] * RPM:.6g} to {speeds[1] * RPM:.6g} r/min"


# Response, a quantity of a study, a transfer function at one frequency, or as a curve over frequency.

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
