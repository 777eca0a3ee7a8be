"""Units and labels of axes of plots, with large torques in kN m or MN m, stresses in N/mm2 and speeds in rpm."""

from __future__ import annotations

import textwrap

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.number_text import typeset_unit

LARGE_PREFIXES = (("M", 1e7, 1e-6), ("k", 1e4, 1e-3))
"""Prefixes of N m, each as (letter, torque in N m from which it is used, factor from N m to the unit with it)."""


def axis_unit(unit: str, largest: float, conventions: Conventions = SI) -> tuple[float, str]:
    """Factor from an SI unit to the unit of an axis, and text of that unit, for values up to ``largest``.

    Examples
    --------
    >>> axis_unit("N*m", 45e3), axis_unit("N*m", 900.0), axis_unit("rad", 0.1, Conventions(angle="deg"))[1]
    ((0.001, 'kN·m'), (1.0, 'N·m'), 'deg')
    """
    for prefix, least, factor in LARGE_PREFIXES:
        if unit == "N*m" and abs(largest) >= least:
            return factor, typeset_unit(prefix + unit)
    return conventions.scale(unit), typeset_unit(conventions.unit(unit))


def axis_label(name: str, unit: str, width: int = 60) -> str:
    """Text of the label of an axis, the name of its quantity and the unit in brackets, folded to ``width`` characters.

    Examples
    --------
    >>> axis_label("vibratory torque, half range", "kN·m", 20)
    'vibratory torque,\\nhalf range [kN·m]'
    """
    return textwrap.fill(f"{name} [{unit}]", width, break_long_words=False)


def speed_label(node: str) -> str:
    """Text of the label of an axis that shows the speeds of a node in rpm.

    Examples
    --------
    >>> speed_label("flywheel")
    'speed of flywheel [rpm]'
    """
    return axis_label(f"speed of {node}", "rpm")
