"""Base class of the quantities of a study, which are a number for every variant, or a curve over frequency or speed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, TypeVar

import numpy as np

from torsionnet.base.entries.declared import Declared
from torsionnet.base.errors import Fault
from torsionnet.base.registers import TypeRegister
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
    "torsionnet.study.quantities", {"natural_frequency": ("damping_ratio",), "peak": ("peak_frequency",)}
)
"""Classes of quantities by the word that a study file writes as their ``type``."""


def register_quantity(cls: Q) -> Q:
    """Class decorator that registers a class of quantities by its ``kind``, the ``type`` in a study file."""
    QUANTITIES[cls.kind] = cls
    return cls
