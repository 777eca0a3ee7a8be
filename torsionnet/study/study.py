"""Study of a drivetrain: its varied parameters, configurations and quantities, and units of its numbers."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.entries.declared import version_faults
from torsionnet.base.entries.spec import Json
from torsionnet.base.errors import Fault, ModelError, UsageError, did_you_mean
from torsionnet.base.expressions import Number
from torsionnet.base.packages import NotebookResult
from torsionnet.base.table import Column, Table
from torsionnet.base.units import CELSIUS, UnitError, parse_unit
from torsionnet.drivetrain import Drivetrain, load
from torsionnet.model.files.fault_places import located_faults, read_document
from torsionnet.model.files.library import library_models, library_studies
from torsionnet.study.answers.answer import AskedStudy, StudyAnswer, measure_of, units_of
from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.quantities.quantity import QuantityLimit, StudyQuantity, ValueInUnit
from torsionnet.study.space.space import Space
from torsionnet.study.space.variations.variation import Variation
from torsionnet.study.study_file import StudyEntries, answer_faults, examine_study, unknown_names_in_answers

# Study of a drivetrain: its varied parameters, configurations and quantities of every variant, and its loading.

FEWEST_COMPILED = 2000
"""Number of variants from which the compiled solver is used, as with fewer, loading it takes longer than it saves."""


@dataclass(frozen=True, eq=False, repr=False)
class Study(NotebookResult):
    """Study of a drivetrain's variants, with the quantities, limits and answers sought; :func:`define` makes one.

    Attributes
    ----------
    model : Drivetrain
    space : Space
        Varied parameters and their distributions; the same in every configuration.
    quantities : mapping
        By name.
    configurations : tuple of str
        Of the model; ``""`` is the model as it stands.
    limits : mapping
        By quantity.
    answers : mapping
        By name.
    name : str
        Title.
    findings : tuple of Fault
        Warnings about the entries.
    """

    model: Drivetrain
    space: Space
    quantities: Mapping[str, StudyQuantity]
    configurations: tuple[str, ...] = ("",)
    limits: Mapping[str, QuantityLimit] = field(default_factory=dict)
    answers: Mapping[str, StudyAnswer] = field(default_factory=dict)
    name: str = ""
    findings: tuple[Fault, ...] = ()

    @property
    def title(self) -> str:
        return self.name or f"study of {self.model.name}"

    def table(self) -> Table:
        """Table of the parameters that vary, the quantities asked of every variant, and the answers."""
        rows = [(name, "varies", "") for name in self.space.names]
        rows += [(name, "quantity", quantity.kind) for name, quantity in self.quantities.items()]
        rows += [(name, "answer", answer.kind) for name, answer in self.answers.items()]
        count = f"{self.count} variants" + (f", seed {self.seed}" if self.seed is not None else "")
        return Table(f"{self.title}: {count}", (Column("name"), Column("is"), Column("type")), tuple(rows))

    @property
    def count(self) -> int:
        """Number of variants of the study in all configurations together."""
        return len(self.configurations) * self.space.count

    @property
    def seed(self) -> int | None:
        """Seed of the random draws, None where nothing is drawn."""
        return self.space.sampling.seed if self.space.sampling and self.space.random_names else None

    @property
    def method(self) -> str:
        """Method of the response solver for all variants, "compiled" if numba works and they are many, else "graph"."""
        if self.count < FEWEST_COMPILED:
            return "graph"
        from torsionnet.linear.dynamic_stiffness.quotient import compiled_works

        return "compiled" if compiled_works() else "graph"

    @cached_property
    def model_text(self) -> str:
        """Complete definition of the model as JSON text, which changes with any number in it."""
        return json.dumps(self.model.definition.flat_data(), default=str, ensure_ascii=False)

    def shown_units(self, conventions: Conventions | None = None) -> ShownUnits:
        """Units in which numbers of the study are shown, those written in the study, else those written in the model.

        Parameters
        ----------
        conventions : Conventions, optional
            Of quantities to which the study gives no limit with a unit; by default angles are in degrees where limits
            of other quantities have them so.

        Examples
        --------
        >>> import torsionnet as tn
        >>> tn.load_study("amt_two_stiffnesses").shown_units().unit("k_1", "N*m/rad")
        'kN*m/rad'
        """
        return shown_units(self, conventions)

    def to_data(self) -> dict[str, Json]:
        """Entries of the study file as JSON data, without the model."""
        return {key: value for key, value in self.entries.written_entries().items() if key != "model"}

    @property
    def entries(self) -> StudyEntries:
        space = self.space.entries
        return StudyEntries(
            name=self.name,
            model="",
            configurations=self.configurations,
            vary=space.vary,
            correlation=space.correlation,
            sampling=space.sampling,
            quantities=self.quantities,
            limits=self.limits,
            answers=self.answers,
        )

    def model_in(self, configuration: str) -> Drivetrain:
        """Model of the study in one of its configurations, or as it stands for an empty name."""
        return self.model.configured(configuration) if configuration else self.model

    def evaluator(self, configuration: str = "", names: tuple[str, ...] = (), method: str = "") -> Evaluator:
        """Evaluator that calculates the quantities of any variants in one configuration.

        ``names`` are the varied parameters, by default those of the space; ``method`` is that of the response solver,
        by default that of the study.
        """
        model = self.model_in(configuration)
        return Evaluator(model, names or self.space.names, self.quantities, method or self.method, configuration)


def define(
    model: Drivetrain,
    vary: Mapping[str, Any],
    quantities: Mapping[str, Any],
    *,
    configurations: str | Sequence[str] = (),
    sampling: Any = None,
    correlation: Sequence[Any] = (),
    limits: Mapping[str, Any] | None = None,
    answers: Mapping[str, Any] | None = None,
    name: str = "",
) -> Study:
    """Define a study of a drivetrain from varied parameters and the quantities asked of every variant.

    Parameters
    ----------
    model : Drivetrain
    vary : mapping
        Parameter, or value of an element (``"dmf.stiffness"``) -> how it varies: ``Normal(deviation="5 %")``, or as
        in a file ``{"type": "normal", ...}``.
    quantities : mapping
        Name -> what is asked: ``{"type": "natural_frequency", "mode": 1}``.
    configurations : str or sequence of str
        Of the model, or ``"all"``; default: the model as it stands.
    sampling : Samples or mapping, optional
        How values are drawn: ``{"method": "sobol", "count": 1024}``.
    correlation : sequence, optional
        ``{"between": ["k_1", "k_2"], "coefficient": 0.6}``.
    limits : mapping, optional
        Quantity -> ``{"below": value}``, ``{"above": value}``, SI.
    answers : mapping, optional
        Name -> ``{"type": "yield"}``.
    name : str
        Title.

    Raises
    ------
    ModelError
        With everything that is wrong.

    Examples
    --------
    >>> import torsionnet as tn
    >>> from torsionnet.study.run.run_chunks import run_study
    >>> study = define(tn.load("dmf_rig"), {"k_2": {"type": "list", "values": [400, 460]}},
    ...     {"f_1": {"type": "natural_frequency", "mode": 1}})
    >>> run_study(study).values("f_1").round(3).tolist()
    [6.627, 7.105]
    """
    given = {
        "name": name,
        "vary": vary,
        "quantities": quantities,
        "configurations": configurations,
        "sampling": sampling,
        "correlation": correlation,
        "limits": limits,
        "answers": answers,
    }
    study, faults = study_of(model, {"model": model.name, **{key: entry for key, entry in given.items() if entry}})
    if study is None:
        raise ModelError([fault for fault in faults if fault.severity == "error"], name or "the study")
    return study


def study_of(model: Drivetrain, given: Mapping[str, Any]) -> tuple[Study | None, list[Fault]]:
    """Study of a model from the entries of a file, None if there is an error, and all faults and warnings."""
    read = examine_study(model, given)
    values = read.values
    faults = [*read.faults, *unknown_names_in_answers(read)]
    study = None
    if read.space is not None:
        answers, name = values.get("answers") or {}, values.get("name") or ""
        study = Study(read.model, read.space, read.quantities, read.configurations, read.limits, answers, name)
        faults += answer_faults(study, answers, is_whole=read.is_sound)
    if study is None or any(fault.severity == "error" for fault in faults):
        return None, faults
    return replace(study, findings=tuple(faults)), faults


# Loading of a study from its file or from the library.


def load_study(path: str | os.PathLike[str]) -> Study:
    """Load a study from a file, or from the library by its name, and return it.

    Parameters
    ----------
    path : str or path
        A file with ``model:``, ``vary:`` and ``quantities:``, or a name out of
        :func:`~torsionnet.model.files.library_studies`.

    Raises
    ------
    ModelError
        With every fault of the file and its place.
    UsageError
        There is no such file or study.

    Examples
    --------
    >>> load_study("amt_tolerances").count
    16384
    """
    file = _find(path)
    document = read_document(file)
    if not isinstance(document.data, dict):
        raise ModelError(
            located_faults([*document.faults, Fault("the file describes no study", kind="wrong-file")], document),
            file.name,
        )
    if "elements" in document.data and "vary" not in document.data:
        text = f"this is a model, no study; a study names it and what varies: model: {file.name}, vary: ..."
        raise ModelError(
            located_faults([*document.faults, Fault(text, ("elements",), on_key=True, kind="wrong-file")], document),
            file.name,
        )
    faults = [*document.faults, *version_faults(document.data, "study")]
    name = document.data.get("model")
    model, further = _model(str(name), file.parent) if isinstance(name, str) else (None, [])
    faults += further
    data = document.data
    study, further = study_of(model, data) if model is not None else (None, StudyEntries.read(data)[1])
    faults += further
    errors = [fault for fault in faults if fault.severity == "error"]
    if errors or study is None:
        raise ModelError(located_faults(errors, document), file.name)
    return replace(study, findings=tuple(located_faults(faults, document)))


def _find(study: str | os.PathLike[str]) -> Path:
    known = library_studies()
    if isinstance(study, str):
        if study in known:
            return known[study]
        if not Path(study).suffix and not Path(study).exists():
            if study in library_models():
                raise UsageError(
                    f'"{study}" is a model, no study; name it in a study file: model: {study}', kind="wrong-file"
                )
            hint = did_you_mean(study, known) or f"; the library has {', '.join(known)}"
            raise UsageError(f'no study is named "{study}"{hint}', kind="unknown-name")
    return Path(study)


def _model(name: str, folder: Path) -> tuple[Drivetrain | None, list[Fault]]:
    """Model of a study by its name or path, None if it cannot be loaded, and faults with their places."""
    try:
        return load(folder / name if Path(name).suffix else name), []
    except UsageError as error:
        return None, [replace(error.fault, path=("model",))]
    except ModelError as error:
        return None, [Fault(f"{name} has {len(error.faults)} errors", ("model",), kind=error.kind), *error.faults]


# Units in which the numbers of a study are shown, those written in the study, else those written in the model.


@dataclass(frozen=True)
class ShownUnits:
    """Units in which parameters and quantities of a study are shown, by their names; others follow the conventions.

    Attributes
    ----------
    written : mapping
        Name -> unit, ``"kN*m/rad"``.
    si : mapping
        Name -> unit in SI, for results that do not say it themselves.
    conventions : Conventions
        Of quantities, as the unit of angles.

    Examples
    --------
    >>> units = ShownUnits({"k_1": "kN*m/rad"}, conventions=Conventions(angle="deg"))
    >>> units.unit("k_1", "N*m/rad"), units.scale("k_1", "N*m/rad")
    ('kN*m/rad', 0.001)
    >>> units.unit("theta", "rad/(N*m)"), round(units.scale("theta", "rad/(N*m)"), 3)
    ('deg/(N*m)', 57.296)
    """

    written: Mapping[str, str] = field(default_factory=dict)
    si: Mapping[str, str] = field(default_factory=dict)
    conventions: Conventions = SI

    def unit(self, name: str, si: str | None = None) -> str:
        """Unit in which a parameter or quantity with the SI unit ``si`` is shown."""
        si = self.si.get(name, "") if si is None else si
        return self.written.get(name) or (self.conventions.unit(si) if si and _factor(si) else si)

    def scale(self, name: str, si: str | None = None) -> float:
        """Factor by which a parameter or quantity in SI is multiplied to be shown in its unit."""
        si = self.si.get(name, "") if si is None else si
        shown = self.unit(name, si)
        factors = [_factor(unit) if unit else 1.0 for unit in (si, shown)]
        return factors[0] / factors[1] if factors[0] and factors[1] else 1.0


IN_SI = ShownUnits()
"""Shown units of results that print every number in SI."""


def _factor(unit: str) -> float | None:
    """Factor from a unit to SI, None if the unit has no factor, such as dB."""
    try:
        return float(parse_unit(unit).factor)
    except UnitError:
        return None


def shown_units(study: AskedStudy, conventions: Conventions | None = None) -> ShownUnits:
    """Shown units of the varied parameters and quantities, by the values in the study, else by those in the model.

    Parameters
    ----------
    study : Study
    conventions : Conventions, optional
        Of quantities to which the study gives no limit with a unit; by default angles are in degrees where limits of
        other quantities have them so.

    Examples
    --------
    >>> import torsionnet as tn
    >>> shown_units(tn.load_study("amt_tolerances")).written["theta_5"]
    'deg/(N*m)'
    """
    written: dict[str, str] = {}
    si = units_of(study) | {name: measure_of(study, name).unit for name in study.quantities}
    for name, variation in study.space.entries.vary.items():
        own = set(_units(variation))
        unit = own.pop() if len(own) == 1 else _unit(study.model.parameter_definitions[name].value)
        if unit and _is_of(unit, si[name]):
            written[name] = unit
    for name, limit in study.limits.items():
        units = [side.unit for side in (limit.below, limit.above) if isinstance(side, ValueInUnit) and side.unit]
        if units and _is_of(units[0], si[name]):
            written[name] = units[0]
    limited = " ".join(written.get(name, "") for name in study.limits)
    usual = Conventions(angle="deg") if "deg" in limited and "rad" not in limited else SI
    return ShownUnits(written, si, conventions or usual)


def _units(variation: Variation) -> Iterator[str]:
    """Yield the units written behind the values of a variation, except percent."""
    for key, _ in variation.specs():
        value = getattr(variation, key)
        for written in value if isinstance(value, tuple) else (value,):
            if (unit := _unit(written)) and unit != "%":
                yield unit


def _unit(value: object) -> str:
    """Unit written behind a value, empty if there is none, or if its zero is not that of SI (degC)."""
    unit = value.unit_written if isinstance(value, Number) else ""
    return "" if unit == CELSIUS else unit


def _is_of(unit: str, si: str) -> bool:
    """Whether a unit has the dimension of the SI unit ``si``, or of rad where ``si`` is empty."""
    try:
        return parse_unit(unit).dimension == parse_unit(si or "rad").dimension
    except UnitError:
        return False
