"""Base class of the quantities of a study, which are a number for every variant, or a curve over frequency or speed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, TypeVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import AnyNumber, read_scalar
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import EntryPath, Fault
from torsionnet.base.expressions import Number
from torsionnet.base.registers import TypeRegister
from torsionnet.base.units import CELSIUS, DIMENSIONS, Dimension, UnitError, parse_unit
from torsionnet.linear.assembly.rows import FloatArray

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.study.quantities.variant_block import VariantBlock


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
        "response": ("band_mean",),
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
