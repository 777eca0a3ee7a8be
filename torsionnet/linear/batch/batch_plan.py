"""Plan that turns arrays of parameters into arrays of coefficients, without a drivetrain for each variant.

What depends on the parameters is evaluated by the elements themselves, in numbers of all variants
(:mod:`torsionnet.linear.batch.variant_numbers`), and checked by the checks of single models.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.errors import ModelError, TorsionnetError, UsageError
from torsionnet.base.expressions import is_beyond_range
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.batch.batch import Batch
from torsionnet.linear.batch.batch_builder import BatchBuilder
from torsionnet.linear.batch.planned_element import PlannedElement, planned_elements
from torsionnet.linear.batch.variant_numbers import VARIANTS, Decisions, VariantNumber, passes
from torsionnet.model.checks.values import is_in_measure, negative_laws, wrong_size
from torsionnet.model.definition import Definition
from torsionnet.model.element_base.curves import OnCurve
from torsionnet.model.element_base.round_section import section_modulus
from torsionnet.model.elements import Element, Law, Part, Values
from torsionnet.model.parameters import evaluation_order


@dataclass(frozen=True, eq=False)
class BatchPlan:
    """Elements of a drivetrain that depend on some parameters, found once for any number of variants.

    Attributes
    ----------
    drivetrain : AssembledModel
    names : tuple of str
        The parameters.
    derived : tuple of str
        Parameters that follow them, each after those that it uses.
    elements : sequence of PlannedElement
    """

    drivetrain: AssembledModel
    names: tuple[str, ...]
    derived: tuple[str, ...]
    elements: list[PlannedElement]
    _fixed: Mapping[str, Any] = field(repr=False)

    def batch(self, values: Mapping[str, ArrayLike]) -> Batch:
        """Batch of variants with these parameter values (n,) in SI units.

        Parameters
        ----------
        values : mapping
            Parameter -> (n,) array in SI, of exactly the names of the plan.

        Raises
        ------
        UsageError
            Other names, or arrays of different lengths.
        """
        if set(values) != set(self.names):
            raise UsageError(
                f"this plan varies {', '.join(self.names)}; give values for these, not {', '.join(values) or 'none'}"
            )
        columns = {name: np.array(values[name], dtype=float, ndmin=1) for name in self.names}
        if len({column.shape for column in columns.values()}) > 1:
            raise UsageError("give the same number of values for every parameter")
        filling = BatchBuilder(self.drivetrain, columns)
        with np.errstate(all="ignore"):
            for places, decisions in passes(filling.count):
                self._pass(filling, places, decisions)
        filling.settle()
        return filling.batch()

    def _pass(self, filling: BatchBuilder, places: NDArray[np.intp], decisions: Decisions) -> None:
        varied = {name: VariantNumber(column[places], decisions) for name, column in filling.values.items()}
        try:
            value = Values(numbers_of(self.drivetrain.definition, self.derived, self._fixed, varied), VARIANTS)
            found = [(planned, _checked(planned, value)) for planned in self.elements]
        except (TorsionnetError, ArithmeticError):
            filling.impossible[places[decisions.follows & ~decisions.unsure]] = True
            return
        alike = all(planned.has_rows_of(parts) for planned, parts in found if planned.is_on)
        moduli = {one.element.name: section_modulus(one.element, value) for one in self.elements if one.is_stressed}
        here = filling.followed(places, decisions)
        if not alike:
            here.mark_separate()
            return
        for planned, parts in found:
            if planned.is_on:
                laws = (part for part in parts if isinstance(part, Law))
                for law, number in zip(laws, planned.laws, strict=True):
                    here.take(law, number)
        for name, modulus in moduli.items():
            here.take_modulus(name, modulus)


def _checked(planned: PlannedElement, value: Values) -> tuple[Part, ...]:
    parts = planned.element.parts(value)
    _require_possible(planned.element, parts, value, on=planned.is_on)
    return parts


def numbers_of(
    definition: Definition, derived: Iterable[str], fixed: Mapping[str, Any], varied: Mapping[str, VariantNumber]
) -> dict[str, Any]:
    """Values of all parameters by name, in SI units.

    A parameter that follows varied ones holds a value for each variant.
    """
    numbers = {**fixed, **varied}
    for name in derived:
        number = definition.parameters[name].value.evaluate(numbers, VARIANTS)
        number.decisions.unsure |= ~np.isfinite(number.values)
        numbers[name] = number
    return numbers


def batch_plan(drivetrain: AssembledModel, names: Iterable[str]) -> BatchPlan | None:
    """Plan for variants of some parameters, or None where variants differ in rows and each is solved by itself.

    Parameters
    ----------
    drivetrain : AssembledModel
        In one configuration; its own values should be usual ones: variants with other acting laws become separate.
    names : iterable of str
        Parameters.

    Raises
    ------
    UsageError
        No such parameter, or none at all.

    Examples
    --------
    >>> import torsionnet as tn
    >>> plan = batch_plan(tn.load("dmf_rig"), ["k_2"])
    >>> plan.batch({"k_2": [400.0, -1.0]}).impossible.tolist()
    [False, True]
    >>> batch_plan(tn.load("amt_rig"), ["tau"]) is None
    True
    """
    chosen = tuple(dict.fromkeys(names))
    if not chosen:
        raise UsageError("name at least one parameter to vary")
    known, definition = drivetrain.parameters, drivetrain.definition
    try:
        drivetrain.configured(**{name: known.get(name, 0.0) for name in chosen})
    except ModelError:  # also as a plain number, which has no unit
        return None
    derived = tuple(_derived_from(definition, chosen, evaluation_order(definition.parameters)[0]))
    moved = frozenset((*chosen, *derived))
    if _operating_point_moves(definition, moved, chosen):
        return None
    fixed = {name: value for name, value in drivetrain.exact_values.items() if name not in moved}
    decisions = Decisions(1)
    varied = {name: VariantNumber(np.array([known[name]]), decisions) for name in chosen}
    elements = planned_elements(drivetrain, numbers_of(definition, derived, fixed, varied), moved)
    return None if elements is None else BatchPlan(drivetrain, chosen, derived, elements, fixed)


def _derived_from(definition: Definition, names: Collection[str], order: Collection[str]) -> Iterator[str]:
    """Names of parameters that depend on the given ones, in the ``order`` of evaluation."""
    moved = set(names)
    for name in order:
        if name not in moved and definition.parameters[name].value.names & moved:
            moved.add(name)
            yield name


def _operating_point_moves(definition: Definition, moved: Collection[str], names: Collection[str]) -> bool:
    """Whether mean speeds and torques, tangents or values of curves there, depend on the varied parameters.

    ``moved`` are all parameters that do, ``names`` those of them that are varied themselves.
    """
    point, moving = definition.operating_point, frozenset(moved)
    if definition.tangents is not None and definition.tangents.depends_on(moving):
        return True
    if any(value.names & moving for table in (point.speed, point.torque) for value in table.values()):
        return True
    if definition.following.keys() <= set(names):
        return False
    return any(
        isinstance(spec, OnCurve) and expression.names & moving
        for element in definition.active
        for _, spec, expression, _ in element.expressions()
    )


def _require_possible(element: Element, parts: Iterable[Part], value: Values, *, on: bool) -> None:
    """Raise UsageError for impossible entries of an element, negative laws, and if ``on`` values beyond its curves.

    Raises
    ------
    UsageError
        As the first variant has it.
    """
    for path, spec, expression, wanted in element.expressions():
        number: Any = value(expression)
        if not isinstance(number, VariantNumber):
            continue
        wrong: Any = is_beyond_range(number) or wrong_size(
            spec, number, measure=is_in_measure(spec, path), wanted=wanted
        )
        if wrong or (on and isinstance(spec, OnCurve) and spec.curve_fault(number)):
            raise UsageError(f"{expression} is not possible for {element.name}; check the range of what is varied")
    faults = element.value_faults(value)
    if faults:
        raise UsageError(f"{element.name}: {faults[0].message}; check the range of what is varied")
    if negative_laws(element, [part for part in parts if isinstance(part, Law)]):
        raise UsageError(
            f"{element.name} has a stiffness, damping or inertia below zero; check the range of what is varied"
        )
