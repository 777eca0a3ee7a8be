"""Entries of a study file for design parameters, bounds and targets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from torsionnet.base.entries.composite import Listed, Named, Nested, PairOf
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Schema, Text, entry
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import Number
from torsionnet.machinery.design.damper_optimum import DesignParameter
from torsionnet.model.checks.parameter_units import parameter_units
from torsionnet.model.model import Model
from torsionnet.model.parameters import Parameter
from torsionnet.study.answers.answer import AskedStudy
from torsionnet.study.quantities.quantity import QuantityValue
from torsionnet.study.space.variations.variation import NominalReader, ParameterValue, nominals

DEFAULT_BOUND_FACTOR = 10.0
"""Factor between a parameter and either default bound, a decade, for parameters without bounds of their own."""


@dataclass(frozen=True, kw_only=True)
class DesignBounds(Declared):
    """Bounds between which the value of a designed parameter is chosen."""

    kind: ClassVar[str] = "design bounds"
    article: ClassVar[str] = "the bounds of a designed parameter"
    form: ClassVar[str] = "[lowest, highest]"

    bounds: tuple[Number, Number] | None = entry(
        PairOf(
            "lowest and highest value; default: the bounds in the model, else a tenth and ten times",
            ParameterValue("bound"),
        ),
        None,
    )


class DesignedNames(Named[DesignBounds | None]):
    """Entry for design parameters, a table of names and bounds, or a list of names."""

    def read(self, raw: object) -> tuple[Mapping[str, DesignBounds | None], list[Fault]]:
        return super().read(dict.fromkeys(map(str, raw)) if isinstance(raw, list) and raw else raw)

    def schema(self) -> Schema:
        names: Schema = {"type": "array", "items": {"type": "string"}, "minItems": 1}
        return {"description": self.description, "anyOf": [super().schema(), names]}


class OneOrSeveral(Listed[str]):
    """Entry of a study file for one name or a list of names."""

    def read(self, raw: object) -> tuple[tuple[Any, ...], list[Fault]]:
        return super().read([raw] if isinstance(raw, str) else raw)

    def schema(self) -> Schema:
        return {"description": self.description, "anyOf": [self.of.schema(), super().schema()]}


@dataclass(frozen=True, kw_only=True)
class TargetEntry(Declared):
    """Target value that a quantity should have in a design, with its weight."""

    kind: ClassVar[str] = "target"
    article: ClassVar[str] = "a target"
    form: ClassVar[str] = "a value, or {value: ..., weight: ...}"

    value: float = entry(QuantityValue("what the quantity should be"))
    weight: float = entry(Value("how much its relative deviation counts", "1", exclusive=True), 1.0)


DESIGN = DesignedNames(
    "the parameters that are chosen, with their bounds; default, but for a robust optimum: all that vary, within what "
    "the study has them vary",
    Nested("bounds of a parameter", lambda: DesignBounds, "design_bounds", shorthand="bounds", optional=True),
    form="parameters and their bounds, k_1: [10 kN*m/rad, 20 kN*m/rad]",
    fewest=1,
)
TARGETS = Named(
    "values that quantities should have, by quantity",
    Nested("a target", lambda: TargetEntry, "design_target", shorthand="value"),
    form="targets, f_1: 8 Hz",
)
NAMES = Text("a quantity of the study")


def design_parameters(
    model: Model, design: Mapping[str, DesignBounds | None]
) -> tuple[list[DesignParameter], list[Fault]]:
    """Design parameters of a model with bounds in SI, and all faults of their entries."""
    found, faults = [], []
    for name, nominal in nominals(model, [one for one in design if one in model.parameters]).items():
        reader = NominalReader(nominal)
        ends = _ends(design[name], reader, model.parameter_definitions[name])
        # A parameter without a value of its own starts in the middle of its bounds.
        start = reader.value(None, "start") if nominal.value is not None else sum(ends) / 2
        faults += [fault.under(name) for fault in reader.faults]
        if not reader.faults:
            found.append(DesignParameter(name, _unit(model, name), start, *ends, start))
    return found, faults


def chosen_parameters(
    study: AskedStudy, design: Mapping[str, DesignBounds | None] | None
) -> tuple[list[DesignParameter], list[Fault]]:
    """Design parameters of a study with bounds in SI, by default all that vary, and all faults of their entries."""
    if design:
        return design_parameters(study.model, design)
    units, nominal = parameter_units(study.model.definition), study.space.nominal
    box = study.space.box().items()
    return [DesignParameter(name, units[name], nominal[name], *ends, nominal[name]) for name, ends in box], []


def _ends(bounds: DesignBounds | None, reader: NominalReader, parameter: Parameter) -> tuple[float, float]:
    if bounds is None or bounds.bounds is None:
        # Without bounds in the study those of the model hold, else a factor either way from the value.
        nominal = reader.nominal.value
        if parameter.bounds is not None:
            low, high = parameter.bounds
        elif nominal is None or not nominal > 0:
            return reader.fault(f"{reader.nominal.name} is not above 0: give its bounds"), float("nan")
        else:
            low, high = nominal / DEFAULT_BOUND_FACTOR, nominal * DEFAULT_BOUND_FACTOR
    else:
        low, high = (reader.value(one, "bounds", place) for place, one in enumerate(bounds.bounds))
    if not low < high and not reader.faults:
        reader.fault(f"bounds are a lower and a higher value, got {low:g} and {high:g}")
    return low, high


def _unit(model: Model, name: str) -> str:
    return parameter_units(model.definition)[name]
