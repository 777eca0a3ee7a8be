"""Factors of the rule of a limit, each with where it comes from."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class RuleFactor:
    """Factor of a limit's rule, in SI units, with its symbol and where it comes from.

    Attributes
    ----------
    name : str
        What it is, in words.
    symbol : str
        As the rule writes it, such as C_K.
    value : float
        SI units.
    unit : str
        SI unit; "1" for none.
    origin : str
        Where the value comes from: an entry of the model, or the formula or table of the rule.

    Examples
    --------
    >>> RuleFactor("design feature", "C_K", 0.55, "1", "propeller shaft, keyless taper fitting").value
    0.55
    """

    name: str
    symbol: str
    value: float
    unit: str
    origin: str
