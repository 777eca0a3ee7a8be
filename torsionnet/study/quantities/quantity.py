"""Base class of the quantities of a study, and the blocks of variants, solved together, that they are of."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import AnyNumber, read_scalar
from torsionnet.base.entries.spec import entry
from torsionnet.base.equal_remarks import collected_warnings
from torsionnet.base.errors import EntryPath, Fault, TorsionnetError
from torsionnet.base.expressions import Number
from torsionnet.base.registers import Same, TypeRegister
from torsionnet.base.units import CELSIUS, DIMENSIONS, Dimension, UnitError, parse_unit
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.assembly.table_range import told_of_reads
from torsionnet.linear.batch.batch import Batch
from torsionnet.linear.batch.batched_modes import BatchedModes, batched_modes, single_modes
from torsionnet.linear.batch.mode_tracking import TrackedModes, track_modes
from torsionnet.linear.modes.modes import Modes
from torsionnet.linear.modes.natural_modes import natural_modes
from torsionnet.model.channels import Input, Sensor

if TYPE_CHECKING:
    from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest


# Base class of the quantities of a study, which are a number for every variant, or a curve over frequency or speed.

Q = TypeVar("Q", bound="type[StudyQuantity]")


@dataclass(frozen=True, eq=False)
class QuantityForm:
    """SI unit of a quantity, and the points of a curve over frequency or speed.

    Attributes
    ----------
    unit : str
        Unit in SI, such as "Hz" or "rad/(N*m)"; empty for a number without unit.
    over : str
        Axis of a curve, "frequency" or "speed"; empty for a single number.
    points : (n_points,) array
        Hz or rad/s; of a single number one point, 0.
    """

    unit: str = ""
    over: str = ""
    points: FloatArray = field(default_factory=lambda: np.zeros(1))

    @property
    def is_curve(self) -> bool:
        return bool(self.over)


@dataclass(frozen=True, kw_only=True)
class StudyQuantity(Declared):
    """Base class of a study's quantities, one subclass for each ``type`` in a file (:func:`register_quantity`)."""

    article: ClassVar[str] = "a quantity"
    singly: ClassVar[bool] = False
    """Whether variants are solved one by one, as no solver takes many of them together for this quantity."""

    @property
    def words(self) -> str:
        """Quantity in words, with names of the model in them."""
        raise NotImplementedError

    def model_faults(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        """Yield the faults of the quantity with a model in one of its configurations."""
        del model, quantities
        yield from ()

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the quantities in the formula of this one, sorted."""
        return ()

    def measure(self, model: Drivetrain) -> QuantityForm:
        """SI unit and points of a quantity that needs no others."""
        raise NotImplementedError

    def measured(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> QuantityForm:
        """SI unit and points of the quantity, given all quantities of the study."""
        del quantities
        return self.measure(model)

    def evaluate(self, block: VariantBlock) -> FloatArray:
        """Values (n_variants, n_points) of the quantity in SI, NaN where a variant has none."""
        raise NotImplementedError


QUANTITIES: TypeRegister[type[StudyQuantity]] = TypeRegister(
    "torsionnet.study.quantities",
    {
        "critical_speed_margin": ("utilisation",),
        "natural_frequency": ("damping_ratio",),
        "peak": ("peak_frequency",),
        "transfer_quantity": ("response", "band_mean"),
        "transient_peak": ("scenario_peak",),
    },
)
"""Classes of quantities by the word that a study file writes as their ``type``."""


def register_quantity(cls: Q) -> Q:
    """Class decorator that registers a class of quantities by its ``kind``, the ``type`` in a study file."""
    QUANTITIES[cls.kind] = cls
    return cls


# Limits of quantities of a study, their largest and smallest values allowed.


class ValueInUnit(float):
    """Number in SI that knows the dimension and the unit in which it was written; a bare number has neither."""

    dimension: Dimension | None = None
    unit: str = ""


class QuantityValue(AnyNumber):
    """Entry of a study file for a number with the unit of its quantity; stored in SI."""

    def coerce(self, raw: object) -> float:
        if isinstance(raw, ValueInUnit):
            return raw
        written = ValueInUnit(super().coerce(raw))
        value = read_scalar(raw)
        if isinstance(value, Number):
            written.dimension = value.unit_dimension
            written.unit = "" if value.unit_written == CELSIUS else value.unit_written
        return written


def wrong_unit(value: float | None, quantity: str, unit: str, path: EntryPath) -> Iterator[Fault]:
    """Yield a fault for a limit whose unit has not the dimension of its quantity; a bare number is in SI."""
    dimension = value.dimension if isinstance(value, ValueInUnit) else None
    try:
        own = parse_unit(unit).dimension if unit else DIMENSIONS["1"]
    except UnitError:  # dB, and what functions of a user say
        return
    if dimension is not None and dimension != own:
        shown = f"in {unit}" if unit else "a number without unit"
        yield Fault(f"{quantity} is {shown}, not in {dimension}", path, kind="wrong-unit")


def as_written(value: float, unit: str) -> str:
    """Text of a value in the unit in which it was written, else in SI with the unit of its quantity.

    >>> as_written(QuantityValue("limit").coerce("0.5 deg/(N*m)"), "rad/(N*m)"), as_written(0.1, "")
    ('0.5 deg/(N*m)', '0.1')
    """
    written = value.unit if isinstance(value, ValueInUnit) else ""
    shown = value / float(parse_unit(written).factor) if written else value
    return f"{shown:g} {written or unit}".rstrip()


@dataclass(frozen=True, kw_only=True)
class QuantityLimit(Declared):
    """Largest and smallest value in SI that a quantity of a study is allowed.

    Of a curve over frequency or speed it is the largest of its values that must stay below, and the smallest that must
    stay above.

    Examples
    --------
    >>> import numpy as np
    >>> QuantityLimit(below=2.0).exceeded(np.array([1.0, 3.0])).tolist()
    [False, True]
    """

    kind: ClassVar[str] = "limit of a quantity"
    article: ClassVar[str] = "a limit of a quantity"
    form: ClassVar[str] = "{below: value} or {above: value}"

    below: float | None = entry(QuantityValue("largest value allowed"), None)
    above: float | None = entry(QuantityValue("smallest value allowed"), None)

    def contradictions(self) -> list[Fault]:
        if self.below is None and self.above is None:
            return [Fault("a limit of a quantity needs below: or above:", on_key=True, kind="missing-entry")]
        if self.below is not None and self.above is not None and self.above >= self.below:
            return [
                Fault(
                    f"nothing is above {self.above:g} and below {self.below:g}",
                    on_key=True,
                    kind="contradicting-values",
                )
            ]
        return []

    def exceeded(self, values: FloatArray) -> NDArray[np.bool_]:
        """Whether each value in SI is outside the limits; a missing value (NaN) is outside."""
        low = -np.inf if self.above is None else self.above
        high = np.inf if self.below is None else self.below
        return np.asarray(~((values >= low) & (values <= high)))

    def beyond(self, values: FloatArray) -> NDArray[np.bool_]:
        """Whether each variant (n,) is outside the limits, by values (n,) or at any point of curves (n, n_points).

        >>> import numpy as np
        >>> QuantityLimit(below=2.0).beyond(np.array([[1.0, 3.0], [1.0, 1.5]])).tolist()
        [True, False]
        """
        outside = self.exceeded(values)
        return outside if outside.ndim == 1 else np.asarray(outside.any(axis=1))


# Block of variants that are solved together, with modes and responses shared by its quantities.

# Counter of the warnings of a study by their text, with a bound on the number of texts.

MOST_REMARKS, OTHERS = 50, "other remarks, which differ in numbers or names"
"""Most different texts of warnings counted, as texts with numbers could be millions, and the text for the rest."""


def remark(known: Counter[str], text: str, count: int) -> None:
    """Count a warning by its text, or beyond :data:`MOST_REMARKS` texts under :data:`OTHERS`.

    >>> texts = Counter({f"text {number}": 1 for number in range(MOST_REMARKS)})
    >>> remark(texts, "one more", 2)
    >>> texts["one more"], texts[OTHERS]
    (0, 2)
    """
    known[text if text in known or len(known) < MOST_REMARKS else OTHERS] += count


def nominal_modes(model: AssembledModel) -> Modes:
    """Modes of a model with its own parameter values, by which those of variants are tracked, found once for all."""
    memo = model.assembly.system.memo
    return memo.once(Modes, Same(model), lambda: natural_modes(model)[0])


GRAPH = "graph"
"""Default method of the response solver, which needs no compiling."""


def single_response(
    model: AssembledModel, outputs: Any, inputs: Any, frequencies: FloatArray, excitation: str | None = None
) -> ComplexArray:
    """Transfer functions (n_f, n_out, n_in) in SI of one model at frequencies (n_f,) >= 0 in Hz."""
    from torsionnet.linear.dynamic_stiffness.transfer_request import cached_request
    from torsionnet.linear.responses.transfer import responses, warn_infinite

    request = cached_request(model, outputs, inputs, excitation)
    solved = responses([model], request, frequencies, GRAPH)
    warn_infinite(solved.values, solved.conditioning, frequencies)
    return np.asarray(solved.values[0])


Channels = str | Sensor | tuple[str | Sensor, ...]
Driving = str | Sensor | tuple[str | Sensor | Input, ...]
T = TypeVar("T")

NOTHING_READ = (np.inf, -np.inf)
"""Lowest and highest frequency in Hz at which laws over frequency are read, before any is."""
MOST_VALUES = 2_000_000
"""Most complex values of responses that are held at a time, 32 MB, as each worker needs as much memory."""


class BlockQuantity(Protocol):
    """Quantity of a study that can be evaluated for a block of variants."""

    def evaluate(self, block: VariantBlock) -> FloatArray:
        """Values (n_variants, n_points) of the quantity in SI."""
        ...


@dataclass(frozen=True, eq=False)
class VariantBlock:
    """Block of variants of a drivetrain in one configuration, solved together.

    Attributes
    ----------
    model : Drivetrain
        Drivetrain with its own values.
    values : mapping
        Parameter -> (n_variants,) array in SI.
    quantities : mapping
        Name -> quantity, all those of the study; one may be calculated from others.
    batch : Batch or None
        Matrices of all variants, where they have the same coordinates as ``model``; None: variants are solved singly.
    remarks : Counter of str
        Texts of warnings and of reasons for missing values, with the number of times.
    method : str
        Method of frequency responses, the same whatever the number of variants.
    read : (2,) array
        Lowest and highest frequency in Hz at which laws over frequency were read, as by :data:`NOTHING_READ`.
    """

    model: Drivetrain
    values: Mapping[str, FloatArray]
    quantities: Mapping[str, BlockQuantity]
    batch: Batch | None
    known: dict[Any, Any] = field(default_factory=dict)
    remarks: Counter[str] = field(default_factory=Counter)
    method: str = GRAPH
    read: FloatArray = field(default_factory=lambda: np.array(NOTHING_READ))

    def __len__(self) -> int:
        return len(next(iter(self.values.values())))

    def single(self, index: int) -> Drivetrain:
        """Drivetrain with the parameter values of one variant of the block."""
        return self.model.configured(**{name: float(column[index]) for name, column in self.values.items()})

    def of(self, name: str) -> FloatArray:
        """Values (n_variants, n_points) in SI of a quantity of the study, calculated once.

        NaN where the model refuses a variant.
        """
        return self.once(("quantity", name), lambda: self._evaluated(self.quantities[name]))

    def _evaluated(self, quantity: BlockQuantity) -> FloatArray:
        said = Counter[str]()
        with collected_warnings(said):
            values = quantity.evaluate(self)
        for text, count in said.items():
            self.remark(text, count)
        if self.impossible.any():
            values = np.where(self.impossible[:, None], np.nan, values)
        return values

    @property
    def impossible(self) -> NDArray[np.bool_]:
        """Whether the model refuses each variant of the block, (n_variants,)."""
        return np.zeros(len(self), dtype=bool) if self.batch is None else self.batch.impossible

    def parts(self, values_each: int) -> Iterator[tuple[slice, VariantBlock]]:
        """Yield slices of variants and their blocks that fit in memory with ``values_each`` complex values each."""
        together = max(1, MOST_VALUES // max(values_each, 1))
        if together >= len(self):
            yield slice(0, len(self)), self
            return
        for start in range(0, len(self), together):
            which = slice(start, start + together)
            values = {name: column[which] for name, column in self.values.items()}
            batch = None if self.batch is None else self.batch.part(which)
            yield which, replace(self, values=values, batch=batch, known={})

    def remark(self, text: str, count: int = 1) -> None:
        """Count a warning of the block by its text."""
        remark(self.remarks, text, count)

    @property
    def is_over_frequency(self) -> bool:
        """Whether laws of the model depend on frequency."""
        return bool(self.model.assembly.system.dynamic)

    def reads(self, frequencies: ArrayLike) -> None:
        """Widen ``read`` to these frequencies in Hz, where laws of the model depend on frequency."""
        at = np.asarray(frequencies, dtype=float)
        at = at[np.isfinite(at)]
        if at.size and self.is_over_frequency:
            self.read[:] = min(self.read[0], at.min()), max(self.read[1], at.max())

    def one_by_one(self, ask: Callable[[Drivetrain], ArrayLike], n_points: int = 1) -> FloatArray:
        """Results (n_variants, n_points) of a function that is called with the drivetrain of every variant.

        NaN where it fails.
        """
        answers = np.full((len(self), n_points), np.nan)
        for index in range(len(self)):
            answer = self.call(index, ask)
            if answer is not None:
                answers[index] = answer
        return answers

    def call(self, index: int, ask: Callable[[Drivetrain], T]) -> T | None:
        """Result of a function that is called with the drivetrain of one variant.

        None where the variant is refused or the function fails.
        """
        try:
            with told_of_reads(lambda _assembly, frequencies: self.reads(frequencies)):
                return ask(self.single(index))
        except TorsionnetError as error:
            self.remark(str(error))
            return None

    @cached_property
    def every_mode(self) -> BatchedModes:
        """Modes of every variant of the block, in the order of its own eigenvalues."""
        modes = single_modes(self.model, self.values) if self.batch is None else batched_modes(self.batch)
        for _, text in modes.remarks:
            self.remark(text)
        return modes

    @cached_property
    def read_modes(self) -> BatchedModes:
        """Modes of every variant, of which values of quantities are made, so that their frequencies count as read."""
        modes = self.every_mode
        self.reads(np.abs(modes.eigenvalues.imag[modes.eigenvalues != 0]) / (2 * np.pi))
        return modes

    @cached_property
    def modes(self) -> TrackedModes:
        """Modes of every variant in the order of the modes of ``model`` by which they are tracked."""
        return track_modes(self.read_modes, nominal_modes(self.model))

    def responses(
        self, outputs: Channels, inputs: Driving, frequencies: FloatArray, excitation: str | None = None
    ) -> ComplexArray:
        """Transfer functions (n_variants, n_f, n_out, n_in) in SI at frequencies (n_f,) or (n_variants, n_f) in Hz."""
        from torsionnet.linear.dynamic_stiffness.transfer_request import cached_request

        request = cached_request(self.model, outputs, inputs, excitation)
        self.reads(frequencies)
        if self.batch is not None:
            from torsionnet.linear.batch.batched_responses import batched_responses, responses_at_own_frequencies

            if frequencies.ndim == 2:
                return responses_at_own_frequencies(self.batch, request, frequencies, self.method)
            return batched_responses(self.batch, request, frequencies, self.method, self._refused).values
        return self._one_by_one_responses(request, outputs, inputs, frequencies, excitation)

    def _refused(self, error: TorsionnetError) -> None:
        self.remark(str(error))

    def _one_by_one_responses(
        self,
        nominal: TransferRequest,
        outputs: Channels,
        inputs: Driving,
        frequencies: FloatArray,
        excitation: str | None,
    ) -> ComplexArray:
        shape = (len(self), frequencies.shape[-1], len(nominal.outputs), len(nominal.inputs))
        answers = np.full(shape, complex(np.nan, np.nan))
        own = np.broadcast_to(frequencies, shape[:2])
        for index in range(len(self)):
            ask = partial(
                single_response, outputs=outputs, inputs=inputs, frequencies=own[index], excitation=excitation
            )
            answer = self.call(index, ask)
            if answer is not None:
                answers[index] = answer
        return answers

    def once(self, key: Any, work: Callable[[], T]) -> T:
        """Result of ``work``, calculated once for all quantities of the block under a key."""
        if key not in self.known:
            self.known[key] = work()
        known: T = self.known[key]
        return known
