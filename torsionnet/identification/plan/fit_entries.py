"""Entries of a fit file: model, measurements, settings, and unknown parameters with start value, bounds and prior."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any, ClassVar

import numpy as np

from torsionnet.base.entries.composite import Listed, Named, Nested, PairOf
from torsionnet.base.entries.declared import KEY, Declared
from torsionnet.base.entries.scalars import AnyNumber, Band, Bands, QuantityKind, Value
from torsionnet.base.entries.spec import MODEL_NAME, Count, Flag, OneOf, Schema, Text, entry
from torsionnet.base.errors import Fault, UsageError
from torsionnet.base.expressions import Name
from torsionnet.base.units import expected_unit
from torsionnet.identification.orders.parametric_orders import numbers_of_excitations
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.machinery.excitations.speed_range import SpeedBand
from torsionnet.model.parameters import dimensions

# Entries of a fit file: model, measurements, parameters, settings.

_ORDER = Value("vibrations per revolution", "1", exclusive=True, below=10_000)
QUANTITIES = ("torque", "angle", "velocity", "acceleration", "stress")
"""Quantities of channels."""
RANGES = ("band", "from", "to", "start", "stop", "low", "high", "frequencies")
"""Keys of a range of frequencies that users may write in the settings of a fit instead of in a measurement."""


@dataclass(frozen=True, kw_only=True)
class FitSettings(Declared):
    """Settings by which records are averaged; settings that are not given follow from the record."""

    kind: ClassVar[str] = "settings"
    article: ClassVar[str] = "the section settings"

    preset: str | None = entry(OneOf("the settings of Galvagno et al. (2015)", ("paper",)), None)
    window: str | None = entry(Text("name of a window"), None)
    seconds: float | None = entry(Value("length of a segment", "time", exclusive=True), None)
    overlap: float | None = entry(Value("share of a segment that the next one repeats", "1"), None)
    detrend: str | None = entry(Text("mean, linear or none"), None)
    estimator: str | None = entry(Text("H1, H2 or Hr; by default Hr where there is a set-point, else H1"), None)
    decimation: int | None = entry(
        Count("keep every n-th sample; by default as many as the band needs", upper=100_000), None
    )

    @classmethod
    def key_faults(cls, raw: Mapping[Any, Any], name: str = "") -> list[Fault]:
        where = "frequencies are chosen in each measurement, as band: [0.5 Hz, 20 Hz]"
        return [
            replace(fault, message=f'unknown key "{fault.about}"; {where}') if fault.about in RANGES else fault
            for fault in super().key_faults(raw, name)
        ]


@dataclass(frozen=True, kw_only=True)
class FileReading(Declared):
    """Rate, units and the like of a record whose file does not tell them, or tells them wrongly."""

    kind: ClassVar[str] = "reading"
    article: ClassVar[str] = "the section reading"
    form: ClassVar[str] = "{rate: 1 kHz, units: {M1: kNm}}"

    rate: float | None = entry(
        Value("sampling rate, if the file has none, or which of several", "frequency", exclusive=True), None
    )
    quantities: Mapping[str, str] = entry(
        Named("what channels are, where their units do not tell", OneOf("a quantity", QUANTITIES)), None
    )
    units: Mapping[str, str] = entry(Named("units of channels in the file", Text("unit")), None)
    resample: bool = entry(Flag("make uneven time stamps even, and bring other rates to this or the highest"), False)
    separator: str | None = entry(Text("between the cells of a text file"), None)
    decimal: str | None = entry(OneOf("decimal sign of a text file", (".", ",")), None)

    @property
    def dialect(self) -> dict[str, str]:
        """Separator and decimal sign of a text file, as far as they are given."""
        given = {"separator": self.separator, "decimal": self.decimal}
        return {key: value for key, value in given.items() if value}

    @property
    def arguments(self) -> dict[str, Any]:
        """Keyword arguments of :func:`read_recording` that follow from these entries, by name."""
        given = {"sampling_rate": self.rate, "quantities": self.quantities, "units": self.units}
        more = {"resample": True} if self.resample else {}
        return {key: value for key, value in given.items() if value} | more | self.dialect


READING = Nested("how its file is read, where it does not tell", lambda: FileReading, "reading", optional=True)
"""Entry of a record for what its file does not tell."""


@dataclass(frozen=True, kw_only=True)
class FitMeasurement(Declared):
    """Measurement to be fitted: a record of signals, a response already estimated, or orders of turning machinery."""

    kind: ClassVar[str] = "measurement"
    article: ClassVar[str] = "a measurement"
    form: ClassVar[str] = "{record: FILE, output: ..., input: ...}"
    SOURCES: ClassVar[tuple[str, ...]] = ("record", "response", "orders", "stepped")
    NOT_OF_ORDERS: ClassVar[tuple[str, ...]] = (
        "input", "model_input", "excitation", "reference", "settling", "pulses", "between", "equations",
        "moving_inertia", "reading",
    )  # fmt: skip
    ONLY_OF_ORDERS: ClassVar[tuple[str, ...]] = ("orders_used", "speeds", "speed_of", "reference_angle")

    record: str | None = entry(Text("file of signals, from the folder of this file"), None)
    response: str | None = entry(Text("instead of a record: file of a response already estimated"), None)
    orders: str | None = entry(
        Text("instead of a record: file of tracked orders, or a table of speed, order and amplitude"), None
    )
    stepped: str | None = entry(
        Text("instead of a record: file of signals with steps of sines at several amplitudes, for laws of motion"), None
    )
    output: str = entry(Text("channel"))
    input: str = entry(Text("channel"), "")
    configuration: str = entry(Text("of the model; by default the name of the measurement if that is one"), "")
    model_output: str = entry(Text("sensor of the model, if it has another name there"), "")
    model_input: str = entry(Text("input or sensor of the model, if it has another name there"), "")
    excitation: str | None = entry(Text("what drives the model, if it has several inputs"), None)
    band: tuple[float, float] | None = entry(Band("frequencies that are compared", from_zero=True), None)
    excluded: tuple[tuple[float, float], ...] = entry(Bands("bands that are left out"), None)
    delay: bool = entry(Flag("find a delay of the output's channel along"), False)
    gain: bool = entry(Flag("find a gain of the output's channel along"), False)
    reference: str = entry(Text("channel of the set-point; by default the model's input with _set"), "")
    settling: float = entry(Value("time at the start that is left out", "time"), 0.0)
    error: float | None = entry(
        Value("relative standard error of a response instead of its coherence, or of steps or orders without intervals",
            "1", exclusive=True),
        None,
    )  # fmt: skip
    orders_used: tuple[float, ...] = entry(
        Listed("the orders compared; by default all that the model excites", _ORDER, form="a list of orders"), ()
    )
    speeds: tuple[float, float] | None = entry(SpeedBand("speeds at which orders are compared"), None)
    speed_of: str = entry(Text("node whose revolutions the orders count; by default that of the model's speeds"), "")
    reference_angle: bool = entry(Flag("find the angle along at which the reference of the phases stands"), False)
    pulses: Mapping[str, float] = entry(
        Named(
            "channels that are pulse trains, with their pulses per revolution",
            Value("pulses per revolution", "1", exclusive=True),
            form="the steps per revolution of channels, {n1: 60}",
        ),
        None,
    )
    between: str | None = entry(
        OneOf("course of the input between its samples, instead of what its file says",
            ("held", "straight", "band_limited")),
        None,
    )  # fmt: skip
    equations: bool = entry(
        Flag("compare the equation of motion over short times, with laws of motion in full: loops, decays, rattling"),
        False,
    )
    moving_inertia: bool = entry(
        Flag("find the inertia along that moves between torque and twist, of equations of motion"), False
    )
    reading: FileReading | None = entry(READING, None)

    @classmethod
    def key_faults(cls, raw: Mapping[Any, Any], name: str = "") -> list[Fault]:
        """Faults of missing or unknown keys; records and responses need an input, which orders have not."""
        lacks = [] if raw.keys() & {"input", "orders", "equations"} else [cls.missing("input", name)]
        return [*super().key_faults(raw, name), *lacks]

    def contradictions(self) -> list[Fault]:
        given = [key for key in self.SOURCES if getattr(self, key) is not None]
        if len(given) != 1:
            what = dict(self.specs())["record"].description
            text = f"a measurement needs one of record, response, orders and stepped: {what}"
            return [Fault(text, on_key=True, kind="missing-entry", about="record")]
        wrong, why = self.ONLY_OF_ORDERS, "belongs to measured orders"
        if self.orders is not None:
            wrong, why = self.NOT_OF_ORDERS, "does not belong to orders, which the excitations of the model cause"
        defaults = self.defaults()
        return [
            Fault(f"{key} {why}; leave it out", (key,), on_key=True, kind="needless-entry")
            for key in wrong if getattr(self, key) != defaults[key]
        ]  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class FitParameter(Declared):
    """Parameter to be identified."""

    kind: ClassVar[str] = "parameter"
    article: ClassVar[str] = "a parameter"

    start: float | None = entry(AnyNumber("where the search begins; by default the value in the model"), None)
    bounds: tuple[float, float] | None = entry(PairOf("limits of the search", AnyNumber("limit")), None)
    prior: tuple[float, float] | None = entry(
        PairOf("mean and standard deviation known from elsewhere", AnyNumber("value")), None
    )
    per_configuration: bool = entry(Flag("whether every measurement finds a value of its own"), False)


class ParameterTable(Named[FitParameter]):
    """Entry of a fit's parameters by name, or of a list of their names."""

    def read(self, raw: object) -> tuple[Mapping[str, FitParameter], list[Fault]]:
        return super().read(dict.fromkeys(raw) if isinstance(raw, list) and raw else raw)

    def schema(self) -> Schema:
        names: Schema = {"type": "array", "items": {"type": "string"}, "minItems": 1}
        return {"description": self.description, "anyOf": [super().schema(), names]}


_PARAMETER = Nested("a parameter to be found", lambda: FitParameter, "unknown", shorthand="start", optional=True)
_MEASUREMENT = Nested("one test", lambda: FitMeasurement, "measurement")
_SETTINGS = Nested("how records are averaged", lambda: FitSettings, "settings", optional=True)


@dataclass(frozen=True, kw_only=True)
class FitFile(Declared):
    """A fit of parameters of a model to tests."""

    kind: ClassVar[str] = "fit"
    article: ClassVar[str] = "a fit"
    head: ClassVar[tuple[str, ...]] = (KEY,)

    name: str = entry(Text("title of the fit"), "")
    model: str = entry(
        Text("name of a library model, or path of a model file from the folder of this file", MODEL_NAME)
    )
    parameters: Mapping[str, FitParameter | None] | None = entry(
        ParameterTable("the parameters to be found, by name; a ranking of causes does without", _PARAMETER, fewest=1),
        None,
    )
    measurements: Mapping[str, FitMeasurement] = entry(Named("the tests, by name", _MEASUREMENT, fewest=1))
    settings: FitSettings | None = entry(_SETTINGS, None)
    residual: str | None = entry(Text("how test and model are compared: complex, log or magnitude"), None)
    loss: str | None = entry(Text("linear, or a robust loss: huber, soft_l1, cauchy"), None)
    starts: int | None = entry(Count("how many searches begin, at different values", upper=1000), None)
    true: Mapping[str, float] = entry(Named("true values, where they are known", AnyNumber("value")), None)


# Unknown parameter of a fit with its start value, bounds and prior.

LARGEST_SIZE = 1e20
"""Largest size in SI of a start value, bound or prior, and the reciprocal of the smallest, beyond which it is a
mistake."""


@dataclass(frozen=True)
class Unknown:
    """Unknown parameter of a fit, with its start value, bounds and prior in SI.

    Attributes
    ----------
    start : float, optional
        SI; by default the value in the model.
    bounds : tuple of float, optional
        SI; by default those of the model file, else 0 and infinity for a value that begins above 0.
    prior : tuple of float, optional
        Mean and standard deviation known from elsewhere, SI; counts like a measurement.
    per_configuration : bool, optional
        Whether every measurement finds a value of its own instead of sharing one.
    """

    start: float | None = None
    bounds: tuple[float, float] | None = None
    prior: tuple[float, float] | None = None
    per_configuration: bool = False

    def __post_init__(self) -> None:
        if self.start is not None and not np.isfinite(self.start):
            raise UsageError(f"a start value is a finite number in SI, got {self.start}", kind="not-finite")
        for size in (self.start, *(self.prior or ()), *(self.bounds or ())):
            if size and np.isfinite(size) and not 1 / LARGEST_SIZE < abs(size) < LARGEST_SIZE:
                raise UsageError(
                    f"{size:g} is out of range for a parameter ({1 / LARGEST_SIZE:g} to {LARGEST_SIZE:g} in SI); "
                    "check its unit",
                    kind="implausible-size",
                )
        if self.bounds is not None and not self.bounds[0] < self.bounds[1]:
            raise UsageError(f"the lower bound must be below the upper bound, got {self.bounds}", kind="unordered-rows")
        if self.prior is not None and not self.prior[1] > 0:
            raise UsageError(
                f"a prior is a mean and a standard deviation above 0, got {self.prior}", kind="out-of-range"
            )


def read_unknowns(parameters: str | Sequence[str] | Mapping[str, Unknown | float | None]) -> dict[str, Unknown]:
    """Unknown parameters of a fit by name, from names alone, or names with a start value or an :class:`Unknown`.

    >>> read_unknowns({"c_O": 100, "c_B": None})["c_O"].start
    100.0
    """
    if isinstance(parameters, str):
        parameters = [parameters]
    if not isinstance(parameters, Mapping):
        unknowns = {name: Unknown() for name in parameters}
    else:
        unknowns = {name: _one(name, given) for name, given in parameters.items()}
    if not unknowns:
        raise UsageError("name at least one parameter to be found", kind="missing-entry")
    return unknowns


def _one(name: str, given: Unknown | float | None) -> Unknown:
    if isinstance(given, Unknown):
        return given
    if given is None:
        return Unknown()
    try:
        return Unknown(float(given))
    except (TypeError, ValueError):
        raise UsageError(
            f"{name}: expected a start value in SI or Unknown(...), got {given!r}", kind="wrong-form"
        ) from None


# Unit, dimension and physical bounds of a parameter, from the elements of a model that use it.


@dataclass(frozen=True)
class ParameterQuantity:
    """Unit, dimension and physical bounds of a parameter or a field of an element.

    Attributes
    ----------
    unit : str
        SI; empty for a plain number.
    dimension : str
        ``"damping"``, ``"stiffness"``, ...; empty if no element uses the parameter as such.
    bounds : tuple of float
        Lowest and highest value that is physically possible, SI.
    """

    unit: str = ""
    dimension: str = ""
    bounds: tuple[float, float] = (-inf, inf)


def parameter_quantity(model: AssembledModel, name: str) -> ParameterQuantity:
    """Unit, dimension and bounds of a parameter of a model, of ``element.field`` or of a number of an excitation.

    >>> import torsionnet as tn
    >>> parameter_quantity(tn.load("dmf_rig"), "k_2")
    ParameterQuantity(unit='N*m/rad', dimension='stiffness', bounds=(0.0, inf))
    """
    number = numbers_of_excitations(model, [name]).get(name)
    if number is not None:
        return ParameterQuantity(number.unit, number.dimension, number.bounds)
    element, _, field = name.rpartition(".")
    if name not in model.definition.parameters and element in model.definition.elements:
        spec, _ = model.definition.elements[element].scalars().get(field, (None, None))
        return _of(spec, spec.dimension) if isinstance(spec, QuantityKind) else ParameterQuantity()
    for element_in in model.definition.elements.values():
        for _, spec, expression, dimension in element_in.expressions():
            if isinstance(expression, Name) and expression.name == name and isinstance(spec, QuantityKind):
                return _of(spec, dimension)
    dimension_of = dimensions(model.definition.parameters)[0].get(name)
    return ParameterQuantity("" if dimension_of is None else str(dimension_of).removeprefix("1"))


def _of(spec: QuantityKind[object], dimension: str) -> ParameterQuantity:
    unit = expected_unit(dimension)
    # A measure of damping, such as a damping ratio, is as positive as the damping that it stands for.
    return ParameterQuantity("" if unit == "1" else unit, dimension, (-inf if spec.lower is None else spec.lower, inf))
