"""Entries of a study file with their types and defaults, checks of them against the model, and their faults."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, ClassVar

import numpy as np

from torsionnet.base.entries.composite import Composite, Listed, Named, Nested, Typed
from torsionnet.base.entries.declared import KEY, Declared
from torsionnet.base.entries.spec import MODEL_NAME, Json, Plural, Schema, Text, entry
from torsionnet.base.errors import UNKNOWN_NAMES, Fault, TorsionnetError, did_you_mean, fault_of
from torsionnet.drivetrain import Drivetrain
from torsionnet.model.configurations import ConfigurationName
from torsionnet.model.model import Model
from torsionnet.study.answers.answer import (
    ANSWERS,
    CONFIGURATION,
    LIMIT,
    PARAMETER,
    QUANTITY,
    VARIED,
    AskedStudy,
    StudyAnswer,
    unknown_names,
)
from torsionnet.study.quantities.quantity import QUANTITIES, QuantityLimit, StudyQuantity, wrong_unit
from torsionnet.study.space.correlation import Correlation, name_faults
from torsionnet.study.space.samples import Samples
from torsionnet.study.space.space import CORRELATION, SAMPLING, VARY, Space, SpaceEntries
from torsionnet.study.space.variations.variation import Variation

# Entries of a study file with their types, defaults and descriptions.

ALL = "all"
_NAMES = Listed("configurations of the model", ConfigurationName(""), form="all, or a list of names")


class SomeConfigurations(Composite[tuple[str, ...]], Plural[tuple[str, ...]]):
    """Entry for configurations of a study, ``all``, one name, or a list of names."""

    absent: ClassVar[Any] = ()

    def read(self, raw: object) -> tuple[tuple[str, ...], list[Fault]]:
        names: tuple[tuple[str, ...], list[Fault]] = _NAMES.read(raw if isinstance(raw, list | tuple) else [raw])
        return names

    def plain(self, value: Any) -> Json:
        return list(value)

    def schema(self) -> Schema:
        names = _NAMES.schema()
        return {"description": self.description, "anyOf": [{"type": ["string", "number"]}, names]}


class QuantityOfFileOrPython(Typed[StudyQuantity]):
    """Entry for a quantity of a study, a table of the file, or an object made in Python, such as a user function."""

    def read(self, raw: object) -> tuple[Any, list[Fault]]:
        return (raw, []) if isinstance(raw, StudyQuantity) else super().read(raw)


_QUANTITY = QuantityOfFileOrPython("what is asked of every variant", lambda: QUANTITIES, "quantity", "quantity")
_ANSWER = Typed("what is concluded", lambda: ANSWERS, "answer", "answer")


@dataclass(frozen=True, kw_only=True)
class StudyEntries(Declared):
    """Study of how a drivetrain behaves over tolerances, operating conditions and choices of its parameters."""

    kind: ClassVar[str] = "study"
    article: ClassVar[str] = "a study"
    head: ClassVar[tuple[str, ...]] = (KEY,)

    name: str = entry(Text("title of the study"), "")
    model: str = entry(
        Text("name of a library model, or path of a model file from the folder of this file", MODEL_NAME)
    )
    configurations: tuple[str, ...] = entry(
        SomeConfigurations(
            "in which all is calculated: names, all, or firing=all for an axis; default: the model as it stands"
        ),
        (),
    )
    vary: Mapping[str, Variation] = entry(VARY)
    correlation: tuple[Correlation, ...] = entry(CORRELATION, ())
    sampling: Samples | None = entry(SAMPLING, None)
    quantities: Mapping[str, StudyQuantity] = entry(
        Named(
            "what is asked of every variant, by name",
            _QUANTITY,
            refused=lambda name: None if name.strip() else "a quantity needs a name",
            names={"pattern": r"\S"},
            form="names and what is calculated, f_1: {type: natural_frequency, mode: 1}",
            fewest=1,
        )
    )
    limits: Mapping[str, QuantityLimit] = entry(
        Named(
            "what quantities must stay below or above, by quantity",
            Nested("a limit", lambda: QuantityLimit, "quantity_limit"),
        ),
        None,
    )
    answers: Mapping[str, StudyAnswer] = entry(Named("what is concluded, by name", _ANSWER), None)

    def chosen(self, model: Model) -> tuple[tuple[str, ...], list[Fault]]:
        """Configurations of the model that the study names, and faults of names that the model does not have."""
        return chosen_configurations(self.configurations, model)


def chosen_configurations(asked: Sequence[str], model: Model) -> tuple[tuple[str, ...], list[Fault]]:
    """Configurations of the model by their names in a study file, and faults of names that it does not have."""
    if not asked:
        return ("",), []
    if tuple(asked) == (ALL,):
        return model.configurations or ("",), []
    faults: list[Fault] = []
    names: list[str] = []
    for place, written in enumerate(asked):
        for name in _expanded(written, model.axes):
            try:
                if name:
                    model.configured(name)
                names.append(name)
            except TorsionnetError as error:
                faults.append(replace(fault_of(error, error.kind), path=("configurations", place)))
                break
    return tuple(dict.fromkeys(names)), faults


def _expanded(written: str, axes: Mapping[str, Sequence[str]]) -> Iterator[str]:
    """Yield the names of all configurations that a pattern such as ``gear=all,clutch=open`` stands for."""
    parts = [part.partition("=") for part in written.split(",")]
    choices = [
        [f"{axis.strip()}={name}" for name in axes[axis.strip()]]
        if value.strip() == ALL and axis.strip() in axes
        else [axis + equals + value]
        for axis, equals, value in parts
    ]
    yield from map(",".join, product(*choices))


# Checks of the entries of a study against its model, the sound part of the study, and all faults.

# Checks of a study's quantities and limits against its model in every configuration.

RESERVED = {name: f"what labels of results call the {name}" for name in ("configuration", "variant", "percentile")}


def name_conflicts(quantities: Iterable[Any], parameters: Iterable[Any]) -> list[Fault]:
    """Faults of quantities that are named like another column in the table of variants."""
    meanings = dict.fromkeys(parameters, "a parameter that varies") | RESERVED
    return [
        Fault(
            f'"{name}" is {meanings[name]}; give the quantity another name',
            ("quantities", name),
            on_key=True,
            kind="repeated-name",
        )
        for name in quantities
        if name in meanings
    ]


def unknown_limits(limits: Iterable[Any], quantities: Iterable[Any]) -> list[Fault]:
    """Faults of limits on quantities that the study does not have."""
    known = [str(name) for name in quantities]
    return [
        Fault(
            f'no quantity is named "{name}"{did_you_mean(str(name), known)}; known: {", ".join(known)}',
            ("limits", name),
            on_key=True,
            kind="unknown-name",
        )
        for name in limits
        if str(name) not in known
    ]


def quantity_model_faults(
    model: Drivetrain, configurations: Sequence[str], quantities: Mapping[str, StudyQuantity]
) -> list[Fault]:
    """Faults of quantities that cannot be calculated in a configuration."""
    placed_faults: dict[tuple[object, str], list[tuple[str, Fault]]] = {}
    for configuration in configurations:
        here = model.configured(configuration) if configuration else model
        for name, quantity in quantities.items():
            for fault in quantity.model_faults(here, quantities):
                placed = fault.under("quantities", name)
                placed_faults.setdefault((placed.path, placed.message), []).append((configuration, placed))
    return [_said(same, len(configurations)) for same in placed_faults.values()]


def wrong_units(
    model: Drivetrain,
    configurations: Sequence[str],
    quantities: Mapping[str, StudyQuantity],
    limits: Mapping[str, QuantityLimit],
) -> list[Fault]:
    """Faults of limits whose unit has not the dimension of their quantity."""
    here = model.configured(configurations[0]) if configurations and configurations[0] else model
    faults: list[Fault] = []
    for name, limit in limits.items():
        unit = quantities[name].measured(here, quantities).unit
        for key in ("below", "above"):
            faults += wrong_unit(getattr(limit, key), name, unit, ("limits", name, key))
    return faults


def _said(same: Sequence[tuple[str, Fault]], count: int) -> Fault:
    """Merge equal faults of several configurations into one that names them if some configuration lacks it."""
    names, fault = [name for name, _ in same if name], same[0][1]
    return fault if len(same) == count or not names else replace(fault, configuration=", ".join(names))


def space_faults(space: Space, models: Mapping[str, Model]) -> list[Fault]:
    """Faults of the varied parameters in single configurations, and warnings where configurations have no effect.

    Parameters
    ----------
    space : Space
    models : mapping
        The model in each configuration, by its name.
    """
    known = {(fault.path, fault.message) for fault in space.remarks}
    faults: list[Fault] = []
    spaces: dict[str, Space] = {}
    for name, model in models.items():
        there, wrong = Space.of(space.entries, model)
        faults += [replace(fault, configuration=name) for fault in wrong if (fault.path, fault.message) not in known]
        if there is not None:
            spaces[name] = there
    return faults + _overruled(spaces)


def _overruled(spaces: Mapping[str, Space]) -> list[Fault]:
    """Warnings of parameters whose values in the configurations are all replaced by the same variation."""
    names = next(iter(spaces.values())).names if spaces else ()
    faults = []
    for name in names:
        own = {space.nominal[name] for space in spaces.values()}
        taken = {_typical(space, name) for space in spaces.values()}
        if len(own) > 1 and len(taken) == 1:
            text = f"{name} has values of its own in {', '.join(spaces)}, and this variation gives it the same in all"
            faults.append(
                Fault(
                    f"{text}; in percent, as -10 %, it is relative to each of them",
                    ("vary", name),
                    "warning",
                    kind="contradicting-values",
                )
            )
    return faults


def _typical(space: Space, name: str) -> tuple[float, ...]:
    if name in space.grid:
        axis = space.grid[name]
        return axis.low, axis.high
    return tuple(space.marginals[name].ppf(np.array([0.1, 0.9])).tolist())


@dataclass(frozen=True, eq=False)
class ExaminedStudy:
    """Sound entries of a study and all its faults, so that a fault in one place hides none in another.

    Attributes
    ----------
    model : Drivetrain
    given : mapping
        All entries as written in the file.
    values : mapping
        Entries that could be read, answers among them.
    configurations : tuple of str
    space : Space or None
        Space of the parameters that vary without a fault; None if there are none.
    quantities, limits : mapping
    faults : tuple of Fault
        Faults of all entries but the answers.
    """

    model: Drivetrain
    given: Mapping[str, Any]
    values: Mapping[str, Any]
    configurations: tuple[str, ...]
    space: Space | None
    quantities: Mapping[str, StudyQuantity]
    limits: Mapping[str, QuantityLimit]
    faults: tuple[Fault, ...]

    @property
    def is_sound(self) -> bool:
        return all(fault.severity != "error" for fault in self.faults)

    def names_of(self, key: str) -> list[str]:
        """Names in a table of the study file, such as ``quantities``, sound or not."""
        return table_names(self.given, key)


def table_names(given: Mapping[str, Any], key: str) -> list[str]:
    """Keys of a table of the study file, an empty list where the entry is not a table."""
    table = given.get(key)
    return [str(name) for name in table] if isinstance(table, Mapping) else []


def examine_study(model: Drivetrain, given: Mapping[str, Any]) -> ExaminedStudy:
    """Check of the entries of a study against its model, which returns the sound entries and all faults."""
    values, faults = StudyEntries.read_entries(given)
    model = model.with_entries_named(values.get("vary") or ())
    configurations, further = chosen_configurations(values.get("configurations") or (), model)
    faults += further
    space, further = _space(model, given, values)
    faults += further
    if space is not None and all(fault.severity != "error" for fault in further):
        faults += space_faults(space, {name: model.configured(name) for name in configurations if name})
    asked: Mapping[str, StudyQuantity] = values.get("quantities") or {}
    named = table_names(given, "quantities")
    # A quantity that the file has, but that cannot be read, is not unknown.
    further = [
        fault
        for fault in quantity_model_faults(model, configurations, asked)
        if fault.kind not in UNKNOWN_NAMES or fault.about not in named
    ]
    faults += further
    quantities = _sound_quantities(asked, further)
    faults += name_conflicts(named, table_names(given, "vary"))
    faults += unknown_limits(table_names(given, "limits"), named)
    limits = {name: limit for name, limit in (values.get("limits") or {}).items() if name in quantities}
    faults += wrong_units(model, configurations, quantities, limits)
    return ExaminedStudy(model, given, values, configurations or ("",), space, quantities, limits, tuple(faults))


def _space(model: Drivetrain, given: Mapping[str, Any], values: Mapping[str, Any]) -> tuple[Space | None, list[Fault]]:
    """Space of all varied parameters, or else of those without faults, and all faults found."""
    vary: Mapping[str, Variation] = values.get("vary") or {}
    correlation: tuple[Correlation, ...] = values.get("correlation") or ()
    if not vary:
        return None, []
    unread = [name for name in table_names(given, "vary") if name not in vary]
    is_whole = not unread and len(correlation) == len(given.get("correlation") or ())
    # A matrix of which a part is missing says nothing about the whole, nor do others about what could be drawn.
    sampling = None if unread else values.get("sampling")
    entries = SpaceEntries(vary=vary, correlation=correlation if is_whole else (), sampling=sampling)
    space, faults = Space.of(entries, model)
    if not is_whole:
        random = [*unread, *(name for name, variation in vary.items() if variation.is_random)]
        wrong = name_faults(correlation, random, [name for name in vary if name not in random])
        faults += [fault.under("correlation") for fault in wrong]
    if space is not None:
        return space, faults
    wrong_names = {fault.path[1] for fault in faults if fault.path[:1] == ("vary",) and len(fault.path) > 1}
    sound = {name: variation for name, variation in vary.items() if name not in wrong_names}
    return (Space.of(SpaceEntries(vary=sound), model)[0] if sound else None), faults


def _sound_quantities(asked: Mapping[str, StudyQuantity], faults: list[Fault]) -> dict[str, StudyQuantity]:
    """Quantities of a study that have no fault and are not calculated from one with a fault."""
    wrong = {fault.path[1] for fault in faults if len(fault.path) > 1}
    sound = {name: quantity for name, quantity in asked.items() if name not in wrong}
    while lost := [name for name, quantity in sound.items() if not sound.keys() >= {*quantity.parts}]:
        sound = {name: quantity for name, quantity in sound.items() if name not in lost}
    return sound


def unknown_names_in_answers(read: ExaminedStudy) -> list[Fault]:
    """Faults of answers that name a quantity, limit, parameter or configuration the study does not have.

    A named entry may have faults of its own.
    """
    known = {
        QUANTITY: read.names_of("quantities"),
        LIMIT: read.names_of("limits"),
        VARIED: read.names_of("vary"),
        PARAMETER: list(read.model.parameters),
        CONFIGURATION: list(read.configurations),
    }
    faults = []
    for name, raw in _answers(read.given):
        kind, entries = _kind_and_entries(raw)
        if kind is not None:
            faults += [fault.under("answers", name) for fault in unknown_names(kind.naming, entries, known)]
    return faults


def _answers(given: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    answers = given.get("answers")
    if isinstance(answers, Mapping):
        yield from answers.items()


def _kind_and_entries(raw: object) -> tuple[type[StudyAnswer] | None, Mapping[str, Any]]:
    """Class of an answer, None if its type is unknown, and its entries as written in a file or made in Python."""
    if isinstance(raw, StudyAnswer):
        return type(raw), {key: getattr(raw, key, None) for key in raw.naming}
    if not isinstance(raw, Mapping):
        return None, {}
    kind = raw.get("type")
    return (ANSWERS[kind], raw) if isinstance(kind, str) and kind in ANSWERS else (None, {})


def answer_faults(study: AskedStudy, answers: Mapping[str, StudyAnswer], *, is_whole: bool) -> list[Fault]:
    """Faults of answers that ask for something that the study cannot give.

    Of a study with other faults only faults of single entries are given: what an answer lacks altogether may be an
    entry that has a fault.
    """
    faults = [fault.under("answers", name) for name, answer in answers.items() for fault in answer.study_faults(study)]
    return faults if is_whole else [fault for fault in faults if len(fault.path) > 2]
