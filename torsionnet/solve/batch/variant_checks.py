"""What is refused of a single model, asked of all variants at once: the same checks, in numbers of variants."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from torsionnet.core.errors import UsageError
from torsionnet.core.number_range import is_beyond_range
from torsionnet.model.checks.values import is_in_measure, negative_laws, wrong_size
from torsionnet.model.element_base.curves import OnCurve
from torsionnet.model.elements import Element, Law, Part, Values
from torsionnet.solve.batch.variant_numbers import VariantNumber


def require_possible(element: Element, parts: Iterable[Part], value: Values, *, on: bool) -> None:
    """Refuse what the entries of an element, or its laws, must not be; of one that is ``on`` also beyond its curves.

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
            raise UsageError(f"{expression} is not possible")
    if negative_laws(element, [part for part in parts if isinstance(part, Law)]):
        raise UsageError(f"{element.name} has a coefficient below zero")
