"""Likely causes of a power or speed that does not agree with others: a wrong unit, or the shaft of another node."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TypeAlias

from torsionnet.base.errors import question
from torsionnet.base.units import RPM
from torsionnet.machinery.excitations.rating import Rating

LIKELY_POWER_SHARE = 0.35
"""Relative difference up to which two powers count as the same, as an indicated power is up to a third higher. Slips of
a unit differ by far more."""
LIKELY_SPEED_SHARE = 0.005
"""Relative difference up to which two speeds count as equal, as data sheets round to about half a percent."""
_THOUSANDS = {
    1e-6: "a unit a million times larger",
    1e-3: "kW for MW, or W for kW",
    1e3: "MW for kW, or kW for W",
    1e6: "a unit a million times smaller",
}
"""Likely slip of the unit of a power, as text, by the factor between the stated and the expected value."""
_OF_TORQUE = {
    1e-6: "a unit a million times larger",
    1e-3: "N*m for kN*m",
    1e3: "kN*m for N*m",
    1e6: "a unit a million times smaller",
}
"""Likely slip of the unit of a torque, as text, by the factor between the stated and the expected value."""


def power_text(watts: float) -> str:
    """Text of a power given in W, in the unit that suits its size.

    >>> power_text(3e6), power_text(3e3), power_text(2.0)
    ('3000 kW', '3 kW', '2 W')
    """
    return f"{_short(watts / 1e3)} kW" if watts >= 100 else f"{_short(watts)} W"


def _short(value: float) -> str:
    """Text of a number with four digits, in which a difference of 5 % shows."""
    return f"{float(f'{value:.4g}'):.10g}"


Likely: TypeAlias = tuple[str, str]
"""Type of a question on a likely slip and the value that it asks for, both empty where none is likely."""


def likely_speed(stated: float, expected: float, node: str, known: Mapping[str, float]) -> Likely:
    """Question whether a speed in rad/s is that of another node, or in a wrong unit."""
    meant = f"{expected * RPM:.6g} rpm"
    other = next((one for one, speed in known.items() if one != node and _is(stated, speed, LIKELY_SPEED_SHARE)), None)
    if other is not None:
        return f": that is the speed of {other}{question(meant)}", meant
    if _is(stated * RPM, expected, LIKELY_SPEED_SHARE):
        return f': rad/s for rpm? Did you mean "{meant}"?', meant
    if _is(stated, expected * RPM, LIKELY_SPEED_SHARE):
        return f': rpm for rad/s? Did you mean "{meant}"?', meant
    return "", ""


def likely_power(stated: float, expected: float, rating: Rating, ratios: Mapping[str, float]) -> Likely:
    """Question whether a power in W that is stated has a likely slip."""
    of_torque = rating.power is None and rating.shares == (1.0, 1.0)
    share = stated / expected
    slips = _OF_TORQUE if of_torque else _THOUSANDS
    near = LIKELY_POWER_SHARE if rating.shares[0] < 1 else LIKELY_POWER_SHARE / 2
    found = next((text for factor, text in slips.items() if _is(share, factor, near)), None)
    if found is not None:
        if rating.power is None and not of_torque:
            return "; is the load in the right unit?", ""
        right = f"{_short(abs(rating.torque) / share / 1e3)} kN*m" if of_torque else power_text(expected)
        return f'; {found}? Did you mean "{right}"?', right
    if of_torque:
        # A torque on the wrong side of a gear is off by its ratio.
        side = next(
            (node for node, ratio in ratios.items() if _is(share * ratio, 1, 0.01) and not _is(ratio, 1, 0.05)), ""
        )
        if side:
            right = f"{_short(abs(rating.torque) / share / 1e3)} kN*m"
            return f"; that is the torque at {side}{question(right)}", right
    return "; one of them is wrong" if share > 10 or share < 0.1 else "", ""


def likely_load(power: float, share: float, torque: float | None) -> Likely:
    """Question whether a load in W has the right unit, if its power is stated elsewhere as ``share`` times as much."""
    found = next((text for factor, text in (_THOUSANDS if torque is None else _OF_TORQUE).items()
                  if _is(1 / share, factor, LIKELY_POWER_SHARE)), None)  # fmt: skip
    if found is None:
        return "", ""
    factor = 10.0 ** round(math.log10(share))
    right = power_text(power * factor) if torque is None else f"{_short(torque * factor / 1e3)} kN*m"
    return f'; {found}? Did you mean "{right}"?', right


def _is(value: float, other: float, share: float) -> bool:
    return abs(math.log(value / other)) <= math.log1p(share) if value > 0 and other > 0 else False
