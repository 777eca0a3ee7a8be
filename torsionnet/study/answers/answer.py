"""Base classes of a study's answers (yield, worst case, ...) and of the conclusions that they draw."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.spec import Json
from torsionnet.base.errors import EntryPath, Fault, UsageError, unknown_name
from torsionnet.base.number_text import json_finite
from torsionnet.base.packages import SavedResult, drawn, imported
from torsionnet.base.registers import TypeRegister
from torsionnet.base.table import Table
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.model.checks.values import parameter_units
from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.quantities.quantity import QuantityForm, QuantityLimit, StudyQuantity, VariantBlock, as_written
from torsionnet.study.reductions.summaries import KeptValues
from torsionnet.study.space.space import Space

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from torsionnet.study.reductions.limit_counts import LimitTotals


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

    def figure(self, **look: Any) -> Figure:
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
        "map_and_scatter": ("map", "scatter", "parallel_coordinates"),
        "sensitivity_answers": ("sobol_indices", "tornado"),
        "worst_case_answer": ("worst_case",),
        "yield_answer": ("yield", "percentile_bands"),
    },
)
"""Classes of answers by the word that a study file writes as their ``type``."""


def register_answer(cls: A) -> A:
    """Class decorator that registers a class of answers by its ``kind``, the ``type`` in a study file."""
    ANSWERS[cls.kind] = cls
    return cls


Conclusions = Mapping[str, Conclusion]
"""Mapping of the name of each answer to its conclusion."""


# Quantities, units and limits of a study that its answers use, and faults in the entries of answers.

QUANTITY, LIMIT, PARAMETER = "quantity", "limit", "parameter"
VARIED, CONFIGURATION = "varied parameter", "configuration of the study"


def unknown_names(
    naming: Mapping[str, str], entries: Mapping[str, Any], known: Mapping[str, Iterable[str]]
) -> list[Fault]:
    """Faults of the names in an answer's entries that the study does not have, the entries as written or as read.

    Parameters
    ----------
    naming : mapping
        Key of an entry -> what it names, such as :data:`LIMIT`.
    entries : mapping
        Key -> a name, a list of names, or a table by name; any other form has a fault of its own.
    known : mapping
        What is named -> the names that exist.

    Examples
    --------
    >>> faults = unknown_names({"limits": LIMIT}, {"limits": ["peak", "peek"]}, {LIMIT: ["peak", "f_2"]})
    >>> [(fault.path, fault.message) for fault in faults]
    [(('limits', 1), 'no limit is named "peek"; did you mean "peak"? there are peak, f_2')]
    """
    faults = []
    for key, what in naming.items():
        there = list(known[what])
        rest = f"there are {', '.join(there)}" if there and what != PARAMETER else ""
        for name, path, on_key in _names(key, entries.get(key)):
            if name not in there:
                faults.append(unknown_name(what, name, there, path, on_key=on_key, rest=rest))
    return faults


def _names(key: str, value: Any) -> Iterator[tuple[str, EntryPath, bool]]:
    """Yield each name in an entry of an answer with its path, and whether it is a key of a table."""
    if isinstance(value, str):
        yield value, (key,), False
    elif isinstance(value, Mapping):
        yield from ((str(name), (key, name), True) for name in value)
    elif isinstance(value, list | tuple):
        yield from ((name, (key, place), False) for place, name in enumerate(value) if isinstance(name, str))


def case_label(configuration: str) -> str:
    """Name of a configuration in tables, or "as given" for the model as it stands."""
    return configuration or "as given"


def measure_of(study: AskedStudy, name: str) -> QuantityForm:
    """Form of a quantity (SI unit, and points of a curve), the same in all configurations."""
    return study.quantities[name].measured(study.model_in(study.configurations[0]), study.quantities)


def units_of(study: AskedStudy) -> dict[str, str]:
    """SI unit of each varied parameter of a study, by its name."""
    known = parameter_units(study.model.definition)
    return {name: known.get(name, "") for name in study.space.names}


def chosen_quantities(study: AskedStudy, names: tuple[str, ...]) -> tuple[str, ...]:
    """Names of the quantities that an answer uses, those given or else all of the study that are single numbers."""
    return names or tuple(name for name in study.quantities if not measure_of(study, name).is_curve)


def limit_words(study: AskedStudy, name: str) -> str:
    """Words for exceeding a limit, such as ``peak above 20 N*m``, or of a curve ``largest H above 2 rad``.

    Values are in the units in which the limit was written.
    """
    limit, form = study.limits[name], measure_of(study, name)
    sides = (("above", "largest", limit.below), ("below", "smallest", limit.above))
    said = [
        (word, f"{which} {name}", as_written(value, form.unit)) for word, which, value in sides if value is not None
    ]
    if form.is_curve:
        return " or ".join(f"{what} {word} {value}" for word, what, value in said)
    return f"{name} " + " or ".join(f"{word} {value}" for word, _, value in said)


def quantity_faults(study: AskedStudy, names: tuple[str, ...], key: str) -> Iterator[Fault]:
    """Yield a fault for each quantity of an answer that is a curve although the answer needs a single number."""
    for place, name in enumerate(names):
        path = (key, place) if key == "quantities" else (key,)
        if name in study.quantities and measure_of(study, name).is_curve:
            yield Fault(
                f"{name} is a curve; name a quantity that is a single number, as its peak", path, kind="not-applicable"
            )
    if not names and not chosen_quantities(study, ()):
        yield Fault(
            "none of the quantities is a single number, as a frequency or a peak", on_key=True, kind="not-applicable"
        )


def limit_faults(study: AskedStudy) -> Iterator[Fault]:
    """Yield a fault if a study gives none of its quantities a limit."""
    if not study.limits:
        yield Fault(
            "no quantity has a limit; give the study limits: {QUANTITY: {below: VALUE}}",
            on_key=True,
            kind="missing-entry",
        )


def distribution_faults(study: AskedStudy) -> Iterator[Fault]:
    """Yield a fault if a study has no random parameter, for answers that draw variants."""
    if not study.space.random_names:
        yield Fault(
            "no parameter has a distribution; this answer draws variants at random", on_key=True, kind="nothing-varies"
        )


# Base class of answers' conclusions whose JSON data are their dataclass fields.

IN_WORDS = {"in_words": True}
"""Metadata of a conclusion's field that is left out of the JSON data, because the sentences contain it."""


class DrawnConclusion(SavedResult):
    """Base class of conclusions that a function of a module of :mod:`torsionnet.plot` draws."""

    drawing: ClassVar[str]
    """Place of the function as ``module:name``, imported when the conclusion is drawn."""

    def figure(self, **look: Any) -> Figure:
        """Draw the conclusion as a figure of matplotlib.

        ``look``: ``units`` (``study.shown_units()``), ``title``, ``ax``.
        """
        figure: Figure = imported(self.drawing)(self, **look)
        return figure

    def _picture(self) -> str:
        return drawn(lambda _: self.figure())


class PlainConclusion(DrawnConclusion):
    """Base class of answers' conclusions that are frozen dataclasses with all results in their fields."""

    @property
    def sentences(self) -> tuple[str, ...]:
        """Conclusion in words, a tuple of complete statements for a report."""
        raise NotImplementedError

    def to_data(self) -> Json:
        """Sentences and fields of the conclusion as JSON data, numbers in SI; null for numbers that JSON lacks."""
        data: Json = json_finite({"sentences": list(self.sentences), **plain_data(self)})
        return data


def plain_data(value: Any) -> Any:
    """Conversion of a value to JSON data, dataclasses and mappings to dictionaries, arrays and tuples to lists."""
    if is_dataclass(value):
        return {
            own.name: plain_data(getattr(value, own.name)) for own in fields(value) if not own.metadata.get("in_words")
        }
    if isinstance(value, Mapping):
        keys = (", ".join(map(str, key)) if isinstance(key, tuple) else str(key) for key in value)
        return dict(zip(keys, map(plain_data, value.values()), strict=True))
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    return [plain_data(entry) for entry in value] if isinstance(value, tuple | list) else value


# Case of an answer, a configuration of a study with its evaluator and space, for answers that choose variants.

OfPoints = Callable[[FloatArray], FloatArray]
"""Function from points (n, d) of the unit cube or of standard normal space to a quantity's values (n,)."""

OfVariants = Callable[[Mapping[str, FloatArray]], FloatArray]
"""Function from the parameters of n variants, (n,) in SI by name, to a quantity's values (n,) in SI."""


@dataclass(frozen=True, eq=False)
class AnswerCase:
    """Configuration of a study with the evaluator of its variants and the space of its varied parameters.

    Parameters that take the values of a list or range keep that of the model where an answer draws at random.
    """

    configuration: str
    evaluator: Evaluator
    space: Space

    @property
    def label(self) -> str:
        """Name of the configuration in tables, "as given" for the model as it stands."""
        return case_label(self.configuration)

    def calculated(self, values: Mapping[str, FloatArray], names: tuple[str, ...]) -> dict[str, FloatArray]:
        """Quantities of n variants by name in SI, each (n,), or (n, n_points) for a curve.

        Parameters that are not given have their values in the model.
        """
        return self.evaluator(self._whole(values), names)

    def singly(self, values: Mapping[str, float], quantity: str) -> float:
        """Value in SI of a quantity of one variant, built and solved as a single model."""
        whole = self._whole({name: np.array([value]) for name, value in values.items()})
        block = VariantBlock(self.evaluator.model, whole, self.evaluator.quantities, None)
        return float(block.of(quantity)[0, 0])

    def nominal(self, name: str) -> float:
        """Value in SI of a varied parameter in the model of this configuration."""
        value = self.space.nominal[name]
        if np.isnan(value):
            raise UsageError(
                f"{name} has no value in the model {self.label}; give it a distribution or a value",
                kind="missing-entry",
            )
        return value

    def _whole(self, values: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        count = len(next(iter(values.values())))
        return {
            name: values[name] if name in values else np.full(count, self.nominal(name)) for name in self.space.names
        }


def answer_cases(study: AskedStudy) -> Iterator[AnswerCase]:
    """Yield every configuration of a study with its evaluator and its space."""
    for configuration in study.configurations:
        evaluator = study.evaluator(configuration)
        yield AnswerCase(configuration, evaluator, study.space.at(evaluator.model))


# Values that a study has calculated in each of its configurations, for answers that use its variants.


@dataclass(frozen=True, eq=False)
class CaseValues:
    """Parameters and quantities (n,) in SI of the n kept variants of one configuration, by name.

    A curve has its smallest and largest value over its points, (n, 2).
    """

    configuration: str
    parameters: Mapping[str, FloatArray]
    quantities: Mapping[str, FloatArray]

    @property
    def label(self) -> str:
        """Name of the configuration in tables, "as given" for the model as it stands."""
        return case_label(self.configuration)


def case_values(study: AskedStudy, result: VariantValues, names: tuple[str, ...]) -> Iterator[CaseValues]:
    """Yield for each configuration the parameters and the quantities ``names`` of its kept variants."""
    for configuration in study.configurations:
        quantities = {name: result.kept_values(name, configuration) for name in names}
        yield CaseValues(configuration, result.kept_parameters(configuration), quantities)
