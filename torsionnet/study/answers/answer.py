"""Base classes of the answers of a study and of their conclusions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, TypeVar

from numpy.typing import ArrayLike

from torsionnet.assembly.rows import FloatArray
from torsionnet.core.entries.declared import Declared
from torsionnet.core.entries.spec import Json
from torsionnet.core.errors import Fault
from torsionnet.core.type_register import TypeRegister
from torsionnet.drivetrain import Drivetrain
from torsionnet.response.table import Table
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
    """Part of :class:`torsionnet.study.study.Study` that answers use."""

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
    """Part of :class:`torsionnet.study.study_result.StudyResult` that answers use."""

    @property
    def kept(self) -> KeptValues: ...
    @property
    def beyond(self) -> LimitTotals | None: ...
    def kept_values(self, quantity: str, configuration: str | None = None) -> FloatArray: ...
    def kept_parameters(self, configuration: str | None = None) -> dict[str, FloatArray]: ...
    def percentiles(self, quantity: str, shares: ArrayLike, configuration: str | None = None) -> FloatArray: ...


class Conclusion(Protocol):
    """Conclusion of an answer: sentences, a table, data and a figure."""

    @property
    def sentences(self) -> tuple[str, ...]:
        """Conclusion in words, each a complete statement for a report."""
        ...

    def table(self) -> Table:
        """Conclusion as a table of numbers."""
        ...

    def to_data(self) -> Json:
        """Conclusion as JSON data in full precision."""
        ...

    def figure(self, plot: ModuleType, **look: Any) -> Figure:
        """Figure of the conclusion by :mod:`torsionnet.plot`; ``look``: ``units`` (:func:`shown_units`), ``title``."""
        ...


@dataclass(frozen=True, kw_only=True)
class StudyAnswer(Declared):
    """Base class of the answers, one class for each ``type:``, registered by :func:`register_answer`."""

    article: ClassVar[str] = "an answer"
    of_variants: ClassVar[bool] = True
    """Whether the answer uses the variants that the study has calculated, rather than choosing its own."""
    naming: ClassVar[Mapping[str, str]] = {}
    """Keys of the entries that name something of the study -> what they name, such as a quantity."""

    def require_extras(self) -> None:
        """Raise :class:`~torsionnet.core.errors.MissingExtraError` where a package of the answer is not installed."""

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        """Faults of the answer with its study: curves, correlated parameters where none may be, ...

        Unknown names are found by ``naming``, and may occur here.
        """
        del study
        yield from ()

    def variants(self, study: AskedStudy) -> int | None:
        """Number of variants that the answer chooses and calculates; None where it is not known beforehand."""
        del study
        return None

    def conclude(self, study: AskedStudy, result: VariantValues) -> Conclusion:
        """Conclusion of the answer; ``result`` has the values of all variants of the study, case by case."""
        raise NotImplementedError


ANSWERS: TypeRegister[type[StudyAnswer]] = TypeRegister(("torsionnet.study.answers", "torsionnet.study.design"))
"""Classes of answers by the word in ``type:``."""


def register_answer(cls: A) -> A:
    """Class decorator that registers an answer by its ``kind``."""
    ANSWERS[cls.kind] = cls
    return cls


Conclusions = Mapping[str, Conclusion]
"""Name of an answer -> its conclusion."""
