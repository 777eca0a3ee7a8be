"""What is concluded from a study: how likely a limit is met, what matters most, what would be best."""

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
    """What an answer knows of its study, :class:`torsionnet.study.study.Study`."""

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
    """What an answer knows of the results, :class:`torsionnet.study.study_result.StudyResult`."""

    @property
    def kept(self) -> KeptValues: ...
    @property
    def beyond(self) -> LimitTotals | None: ...
    def kept_values(self, quantity: str, configuration: str | None = None) -> FloatArray: ...
    def kept_parameters(self, configuration: str | None = None) -> dict[str, FloatArray]: ...
    def percentiles(self, quantity: str, shares: ArrayLike, configuration: str | None = None) -> FloatArray: ...


class Conclusion(Protocol):
    """What every answer comes to."""

    @property
    def sentences(self) -> tuple[str, ...]:
        """In words, each a sentence an engineer can hand in."""
        ...

    def table(self) -> Table:
        """In numbers."""
        ...

    def to_data(self) -> Json:
        """In full precision, for JSON."""
        ...

    def figure(self, plot: ModuleType, **look: Any) -> Figure:
        """As a picture, by :mod:`torsionnet.plot`; ``look`` are its ``units`` (:func:`shown_units`) and ``title``."""
        ...


@dataclass(frozen=True, kw_only=True)
class StudyAnswer(Declared):
    """Base of the answers; a class of its own for each ``type:``, registered by :func:`register_answer`."""

    article: ClassVar[str] = "an answer"
    of_variants: ClassVar[bool] = True
    """Whether it rests on the variants that the study has calculated, rather than choosing its own."""
    naming: ClassVar[Mapping[str, str]] = {}
    """Keys of the entries that name something of the study, and what that is: see ``answer_names``."""

    def require_extras(self) -> None:
        """Raise :class:`~torsionnet.core.errors.MissingExtraError` where it needs what is not installed."""

    def unfit(self, study: AskedStudy) -> Iterator[Fault]:
        """What does not fit the study: curves, correlated parameters where none may be, ...

        Names that the study does not have are told by ``naming``, and may come here.
        """
        del study
        yield from ()

    def variants(self, study: AskedStudy) -> int | None:
        """How many variants it chooses and calculates, where that is known beforehand."""
        del study
        return None

    def found(self, study: AskedStudy, result: VariantValues) -> Conclusion:
        """The answer; ``result`` has the values of all variants of the study, case by case."""
        raise NotImplementedError


ANSWERS: TypeRegister[type[StudyAnswer]] = TypeRegister(("torsionnet.study.answers", "torsionnet.study.design"))
"""By the word in ``type:``."""


def register_answer(cls: A) -> A:
    """Make an answer known by its ``kind``."""
    ANSWERS[cls.kind] = cls
    return cls


Conclusions = Mapping[str, Conclusion]
