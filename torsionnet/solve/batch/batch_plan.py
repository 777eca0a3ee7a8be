"""From arrays of parameters to arrays of coefficients, without a drivetrain for each variant.

What depends on the parameters is evaluated by the elements themselves, in numbers of all variants
(:mod:`torsionnet.solve.batch.variant_numbers`), and checked by the checks of single models.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.core.errors import ModelError, TorsionnetError, UsageError
from torsionnet.model.definition import Definition
from torsionnet.model.element_base.round_section import section_modulus
from torsionnet.model.elements import Law, Part, Values
from torsionnet.model.parameters import evaluation_order
from torsionnet.solve.batch.batch import Batch
from torsionnet.solve.batch.batch_filling import Filling
from torsionnet.solve.batch.moved_parameters import derived_from, operating_point_moves
from torsionnet.solve.batch.planned_element import PlannedElement, planned_elements
from torsionnet.solve.batch.variant_checks import require_possible
from torsionnet.solve.batch.variant_numbers import VARIANTS, Decisions, VariantNumber, passes


@dataclass(frozen=True, eq=False)
class BatchPlan:
    """What of a drivetrain depends on some parameters: made once for any number of variants.

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
        """The variants with these values.

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
            raise UsageError(f"the plan is one for {', '.join(self.names)}, not for {', '.join(values) or 'nothing'}")
        columns = {name: np.array(values[name], dtype=float, ndmin=1) for name in self.names}
        if len({column.shape for column in columns.values()}) > 1:
            raise UsageError("the values of all parameters are as many")
        filling = Filling(self.drivetrain, columns)
        with np.errstate(all="ignore"):
            for places, decisions in passes(filling.count):
                self._pass(filling, places, decisions)
        filling.settle()
        return filling.batch()

    def _pass(self, filling: Filling, places: NDArray[np.intp], decisions: Decisions) -> None:
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
            here.mark_apart()
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
    require_possible(planned.element, parts, value, on=planned.is_on)
    return parts


def numbers_of(
    definition: Definition, derived: Iterable[str], fixed: Mapping[str, Any], varied: Mapping[str, VariantNumber]
) -> dict[str, Any]:
    """All parameters by name; those ``derived`` from the ``varied`` ones are of all variants, too."""
    numbers = {**fixed, **varied}
    for name in derived:
        number = definition.parameters[name].value.evaluate(numbers, VARIANTS)
        number.decisions.unsure |= ~np.isfinite(number.values)
        numbers[name] = number
    return numbers


def batch_plan(drivetrain: AssembledModel, names: Iterable[str]) -> BatchPlan | None:
    """The plan for variants of some parameters; None where a variant has rows of its own and is solved by itself.

    Parameters
    ----------
    drivetrain : AssembledModel
        In one configuration; its own values should be usual ones, since variants with other acting laws are put apart.
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
    derived = tuple(derived_from(definition, chosen, evaluation_order(definition.parameters)[0]))
    moved = frozenset((*chosen, *derived))
    if operating_point_moves(definition, moved, chosen):
        return None
    fixed = {name: value for name, value in drivetrain.exact_values.items() if name not in moved}
    decisions = Decisions(1)
    varied = {name: VariantNumber(np.array([known[name]]), decisions) for name in chosen}
    elements = planned_elements(drivetrain, numbers_of(definition, derived, fixed, varied), moved)
    return None if elements is None else BatchPlan(drivetrain, chosen, derived, elements, fixed)
