"""In which unit an axis shows its values: torques of large machines in kN m, all others as they are."""

from __future__ import annotations

from torsionnet.core.number_text import typeset_unit
from torsionnet.response.conventions import SI, Conventions

PREFIXES = (("M", 1e7, 1e-6), ("k", 1e4, 1e-3))
"""Prefix, the torque in N m from which on it is used, and its factor."""


def axis_unit(unit: str, largest: float, conventions: Conventions = SI) -> tuple[float, str]:
    """Factor from an SI unit to that of an axis, and its text, for values up to a largest one.

    Examples
    --------
    >>> axis_unit("N*m", 45e3), axis_unit("N*m", 900.0), axis_unit("rad", 0.1, Conventions(angle="deg"))[1]
    ((0.001, 'kN·m'), (1.0, 'N·m'), 'deg')
    """
    for prefix, least, factor in PREFIXES:
        if unit == "N*m" and abs(largest) >= least:
            return factor, typeset_unit(prefix + unit)
    return conventions.scale(unit), typeset_unit(conventions.unit(unit))
