"""What a study asks of every variant: one number, or a curve over frequency or speed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, TypeVar

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.entries.declared import Declared
from torsionnet.core.errors import Fault
from torsionnet.core.type_register import TypeRegister

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.study.quantities.variant_block import VariantBlock

Q = TypeVar("Q", bound="type[StudyQuantity]")


@dataclass(frozen=True, eq=False)
class QuantityForm:
    """What a quantity comes out as.

    Attributes
    ----------
    unit : str
        As shown, "Hz", "rad/(N m)"; empty for a number without unit.
    over : str
        What its points lie over, "frequency" or "speed"; empty for a single number.
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
    """Base of the quantities; a class of its own for each ``type:``, registered by :func:`register_quantity`."""

    article: ClassVar[str] = "a quantity"
    singly: ClassVar[bool] = False
    """Whether every variant is a model of its own, as nothing solves many of them together."""

    @property
    def asked(self) -> str:
        """What it is, in words with names of the model in them."""
        raise NotImplementedError

    @property
    def made_of(self) -> frozenset[str]:
        """Names of the other quantities that it is calculated from."""
        return frozenset()

    def unfit(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        """What does not fit a model in one of its configurations."""
        del model, quantities
        yield from ()

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the quantities that it is made of."""
        return ()

    def measure(self, model: Drivetrain) -> QuantityForm:
        """Unit and points."""
        raise NotImplementedError

    def measured(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> QuantityForm:
        """Unit and points, by what the quantities are that it is made of; whoever asks has all of them."""
        del quantities
        return self.measure(model)

    def evaluate(self, block: VariantBlock) -> FloatArray:
        """Values (n_variants, n_points), SI units; NaN where a variant has none."""
        raise NotImplementedError


QUANTITIES: TypeRegister[type[StudyQuantity]] = TypeRegister(
    "torsionnet.study.quantities", ("natural_frequency", "peak")
)
"""By the word in ``type:``."""


def register_quantity(cls: Q) -> Q:
    """Make a quantity known by its ``kind``."""
    QUANTITIES[cls.kind] = cls
    return cls
