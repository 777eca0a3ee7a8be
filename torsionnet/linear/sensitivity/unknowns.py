"""Unknowns of a calculation, which are named parameters or fields of elements such as ``oil.damping``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from torsionnet.base.entries.scalars import QuantityKind
from torsionnet.base.errors import ModelError, UsageError, did_you_mean
from torsionnet.base.expressions import ExpressionError, Name, Number
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.sensitivity.dual import DUALS, Dual
from torsionnet.model.damping import DampingMeasure
from torsionnet.model.definition import Definition
from torsionnet.model.elements import Element
from torsionnet.model.parameters import Parameter, evaluation_order


@dataclass(frozen=True)
class Unknowns:
    """Parameters and fields of elements of a drivetrain that are varied, with their present values in SI units.

    Attributes
    ----------
    names : tuple of str
        As the caller named them.
    parameters : tuple of str
        The parameters of ``definition`` that hold them.
    start : tuple of float
        Their values in the drivetrain, SI.
    definition : Definition
        With a parameter for every field that was named by its element.
    """

    names: tuple[str, ...]
    parameters: tuple[str, ...]
    start: tuple[float, ...]
    definition: Definition

    def values(self, at: Sequence[float]) -> dict[str, Any]:
        """Values in SI units of all parameters by name, as dual numbers where they depend on the unknowns.

        Raises
        ------
        ModelError
            A value cannot be calculated there.
        """
        gradients = np.eye(len(self.names))
        varied = {
            name: Dual(float(x), gradients[i]) for i, (name, x) in enumerate(zip(self.parameters, at, strict=True))
        }
        values: dict[str, Any] = {}
        for name in evaluation_order(self.definition.parameters)[0]:
            try:
                values[name] = varied[name] if name in varied else self._evaluated(name, values)
            except (ExpressionError, ZeroDivisionError) as error:
                raise ModelError(f"{name} cannot be calculated: {error}") from None
        return values

    def _evaluated(self, name: str, values: Mapping[str, Any]) -> Any:
        return self.definition.parameters[name].value.value_in(values, DUALS)


def unknowns(drivetrain: AssembledModel, names: Sequence[str]) -> Unknowns:
    """Unknowns of a drivetrain, with present values in SI units, from names of parameters or fields.

    Raises
    ------
    UsageError
        A name means nothing, is given twice, or is a field without a plain value.

    Examples
    --------
    >>> import torsionnet as tn
    >>> unknowns(tn.load("dmf_rig"), ["c_2", "k_2"]).start
    (4.0, 460.0)
    """
    definition = drivetrain.definition
    parameters, start = [], []
    strange = [name for name in names if not isinstance(name, str)]
    if strange:
        raise UsageError(f"a parameter must be given by its name, got {strange[0]!r}")
    twice = sorted({name for name in names if list(names).count(name) > 1})
    if twice:
        raise UsageError(f"{', '.join(twice)} is named twice; name each parameter once")
    for name in names:
        if name in definition.parameters:
            parameters.append(name)
            start.append(float(drivetrain.exact_values[name]))
            continue
        definition, parameter = _with_parameter(definition, name, drivetrain)
        parameters.append(parameter)
        start.append(float(definition.parameters[parameter].value.evaluate(drivetrain.exact_values)))
    if definition.tangents is not None:
        definition = replace(definition, tangents=definition.tangents.of(definition))
    return Unknowns(tuple(names), tuple(parameters), tuple(start), definition)


def _with_parameter(definition: Definition, name: str, drivetrain: AssembledModel) -> tuple[Definition, str]:
    """Definition with a parameter in place of the number ``element.field``, and the parameter's name."""
    element_name, _, field = name.rpartition(".")
    if element_name not in definition.elements:
        known = [*definition.parameters, *(f"{e}.{f}" for e in definition.elements for f in _fields(drivetrain, e))]
        raise UsageError(
            f'no parameter is named "{name}"{did_you_mean(name, known)}; or name a field: element.stiffness'
        )
    element = definition.elements[element_name]
    known_fields = _fields(drivetrain, element_name)
    if field not in known_fields:
        has = ", ".join(known_fields) or "none"
        raise UsageError(
            f'{element_name} has no number "{field}"{did_you_mean(field, known_fields)} to vary; it has {has}'
        )
    value = getattr(element, field)
    if isinstance(value, DampingMeasure) or not isinstance(value, Number):
        raise UsageError(f"{name} is given as {value}; vary the parameters in it, or give it a plain value")
    parameter = f"{element_name}__{field}"
    varied: Any = {field: Name(parameter)}
    changed: Element = replace(element, **varied)
    return (
        replace(
            definition,
            elements={**definition.elements, element_name: changed},
            parameters={**definition.parameters, parameter: Parameter(value, "", None)},
        ),
        parameter,
    )


def _fields(drivetrain: AssembledModel, element: str) -> list[str]:
    """Names of the fields of an element that hold a single number and have a value."""
    scalars = drivetrain.definition.elements[element].scalars()
    return [name for name, (spec, _) in scalars.items() if isinstance(spec, QuantityKind)]
