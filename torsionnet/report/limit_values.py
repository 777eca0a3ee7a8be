"""Values of limits in a report: torques in kN m, stresses in N/mm2, angles in the unit of the report."""

from __future__ import annotations

from torsionnet.base.conventions import Conventions
from torsionnet.machinery.verdicts.limit_check import LimitVerdict
from torsionnet.report.document_tree import Cell, NumberText
from torsionnet.report.engineering_units import engineering_unit
from torsionnet.report.report_text import as_words, unit

DIGITS = 3
"""Significant digits of stresses, torques and shares: a torsional calculation is not known better."""


def limit_scale(si_unit: str, conventions: Conventions) -> float:
    """Factor from the SI unit of a limit to the unit in which a report shows its values."""
    return engineering_unit(si_unit, conventions)[0]


def limit_unit(si_unit: str, conventions: Conventions) -> str:
    """Name of the unit in which a report shows values of an SI unit.

    >>> limit_unit("N*m", Conventions()), limit_unit("Pa", Conventions())
    ('kN·m', 'N/mm²')
    """
    return unit(engineering_unit(si_unit, conventions)[1])


def limit_number(value: float, si_unit: str, conventions: Conventions) -> NumberText:
    """Number of a value in SI in the unit in which a report shows it."""
    return NumberText(value * limit_scale(si_unit, conventions), DIGITS)


def component(one: LimitVerdict) -> str:
    """Words for the component that a limit is about, by the name of the limit in the model."""
    return as_words(one.limit)


def order_list(orders: list[tuple[str, float]], one: LimitVerdict, conventions: Conventions) -> Cell:
    """Names of orders with their amplitudes in the unit of a limit as one text, such as "engine 6: 46.3"."""
    numbers = ((name, limit_number(size, one.unit, conventions)) for name, size in orders)
    return "; ".join(f"{as_words(name)}: {number}" for name, number in numbers)
