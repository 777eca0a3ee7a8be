"""Base classes of a study's answers (yield, worst case, ...) and of the conclusions that they draw."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, TypeVar

from numpy.typing import ArrayLike

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.spec import Json
from torsionnet.base.errors import Fault
from torsionnet.base.registers import TypeRegister
from torsionnet.base.table import Table
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.quantities.quantity import StudyQuantity
from torsionnet.study.quantities.quantity_limit import QuantityLimit
from torsionnet.study.reductions.kept_values import KeptValues
from torsionnet.study.reductions.limit_counts import LimitTotals
from torsionnet.study.space.space import Space

if TYPE_CHECKING:
    from matplotlib.figure import Figure

A = TypeVar("A", bound="type[StudyAnswer]")


class AskedStudy(Protocol):
    """Properties and methods of :class:`torsionnet.study.study.Study` that answers use."""

    @property
    def model(self) -> Drivetrain: ...
    @property
    def space(self) -> Space: ...
    @property
    def quantities(self) -> Mapping[str, StudyQuantity]: ...
    @property
    def configurations(self) -> tuple[str, ...]: ...
    @property
    def limits(self) -> Mapping[str, QuantityLimit]: ...
    @property
    def title(self) -> str: ...
    @property
    def count(self) -> int: ...
    def model_in(self, configuration: str) -> Drivetrain: ...
    def evaluator(self, configuration: str = "", names: tuple[str, ...] = (), method: str = "") -> Evaluator: ...


class VariantValues(Protocol):
    """Properties and methods of :class:`torsionnet.study.study_result.StudyResult` that answers use."""

    @property
    def kept(self) -> KeptValues: ...
    @property
    def beyond(self) -> LimitTotals | None: ...
    def kept_values(self, quantity: str, configuration: str | None = None) -> FloatArray: ...
    def kept_parameters(self, configuration: str | None = None) -> dict[str, FloatArray]: ...
    def percentiles(self, quantity: str, shares: ArrayLike, configuration: str | None = None) -> FloatArray: ...


class Conclusion(Protocol):
    """Conclusion of a study's answer, shown as sentences, a table, JSON data and a figure."""

    @property
    def sentences(self) -> tuple[str, ...]:
        """Conclusion in words, a tuple of complete statements for a report."""
        ...

    def table(self) -> Table:
        """Conclusion as a table of numbers, with a unit in the heading of each column that has one."""
        ...

    def to_data(self) -> Json:
        """Conclusion as JSON data in full precision, numbers in SI."""
        ...

    def figure(self, plot: ModuleType, **look: Any) -> Figure:
        """Draw the conclusion as a figure by :mod:`torsionnet.plot`.

        ``look``: ``units`` (:func:`shown_units`), ``title``.
        """
        ...


@dataclass(frozen=True, kw_only=True)
class StudyAnswer(Declared):
    """Base class of a study's answers, one subclass for each ``type`` in a file (:func:`register_answer`)."""

    article: ClassVar[str] = "an answer"
    of_variants: ClassVar[bool] = True
    """Whether the answer uses the variants that the study has calculated, rather than choosing its own."""
    naming: ClassVar[Mapping[str, str]] = {}
    """Mapping of each entry that names something of the study to what it names, such as a quantity."""

    def require_extras(self) -> None:
        """Raise :class:`~torsionnet.base.errors.MissingExtraError` where a package of the answer is not installed."""

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        """Yield the faults of an answer that its study cannot give, such as a curve where a number is needed.

        Unknown names are found by ``naming``, and may occur here.
        """
        del study
        yield from ()

    def variants(self, study: AskedStudy) -> int | None:
        """Number of variants that the answer chooses and calculates itself; None where it is not known beforehand."""
        del study
        return None

    def conclude(self, study: AskedStudy, result: VariantValues) -> Conclusion:
        """Draw the conclusion of the answer from the study and the values of its variants.

        ``result`` has the values of all variants of the study, case by case.
        """
        raise NotImplementedError


ANSWERS: TypeRegister[type[StudyAnswer]] = TypeRegister(
    ("torsionnet.study.answers", "torsionnet.study.design"),
    {
        f"{kind}_answer": (kind,)
        for kind in ("map", "parallel_coordinates", "percentile_bands", "scatter", "tornado", "worst_case", "yield")
    },
)
"""Classes of answers by the word that a study file writes as their ``type``."""


def register_answer(cls: A) -> A:
    """Class decorator that registers a class of answers by its ``kind``, the ``type`` in a study file."""
    ANSWERS[cls.kind] = cls
    return cls


Conclusions = Mapping[str, Conclusion]
"""Mapping of the name of each answer to its conclusion."""
