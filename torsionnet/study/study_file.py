"""Entries of a study file with their types, defaults and descriptions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, ClassVar

from torsionnet.base.entries.composite import Composite, Listed, Named, Nested, Typed
from torsionnet.base.entries.declared import KEY, Declared
from torsionnet.base.entries.spec import MODEL_NAME, Json, Plural, Schema, Text, entry
from torsionnet.base.errors import Fault, TorsionnetError, fault_of
from torsionnet.model.configurations import ConfigurationName
from torsionnet.model.model import Model
from torsionnet.study.answers.answer import ANSWERS, StudyAnswer
from torsionnet.study.quantities.quantity import QUANTITIES, QuantityLimit, StudyQuantity
from torsionnet.study.space.correlation import Correlation
from torsionnet.study.space.samples import Samples
from torsionnet.study.space.space_reading import CORRELATION, SAMPLING, VARY
from torsionnet.study.space.variations.variation import Variation

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
