"""Units of a physical quantity that may follow its number."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

from torsionnet.base.units import CELSIUS, DIMENSIONS, KNOWN_UNITS, UnitError, expected_unit, parse_unit

_MULTIPLES = {
    "N": ("kN", "MN"), "Pa": ("MPa", "GPa", "bar"), "W": ("kW", "MW"), "m": ("mm",), "s": ("ms",),
    "kg*m^2": ("kg*mm^2", "t*m^2", "lbf*in*s^2", "lb*ft^2"), "N*m": ("lbf*in", "lbf*ft"),
}  # fmt: skip
"""Units that engineers write in place of the beginning of a product of SI units."""
_SHARES = ("%", "ppm", "J", "kJ", "MJ")


@lru_cache(maxsize=64)
def units_of(dimension: str) -> tuple[str, ...]:
    """Units of a named dimension, that of SI first, then its multiples and other units of the same dimension.

    Examples
    --------
    >>> units_of("inertia")[:2], "N*m" in units_of("inertia")
    (('kg*m^2', 'kg*mm^2'), False)
    >>> units_of("speed")[:2]
    ('rad/s', 'rpm')
    """
    if dimension == "1":
        return ("%",)
    first = expected_unit(dimension)
    found = [first, *([CELSIUS] if dimension == "temperature" else [])]
    # A moment without rad could be a torque that was meant to be a stiffness.
    atoms = [] if "/rad" in first else [one for one in KNOWN_UNITS if one not in _SHARES and _fits(one, dimension)]
    variants = [unit for unit in _variants(first) if _fits(unit, dimension)]
    found += [*atoms, *variants] if dimension in ("speed", "frequency") else [*variants, *atoms]
    found += [unit for name in KNOWN_UNITS for unit in _joined(name, first) if _fits(unit, dimension)]
    return tuple(dict.fromkeys(found))


def _variants(text: str) -> Iterator[str]:
    for unit, others in _MULTIPLES.items():
        if text == unit or text.startswith((f"{unit}*", f"{unit}/", f"{unit}^")):
            yield from (other + text[len(unit) :] for other in others)
    if text.startswith("N") and text.endswith("/rad"):
        yield from (f"{start}{text[:-3]}deg" for start in ("", "k"))
    if text == "rad/s":
        yield "rev/s"


def _joined(name: str, text: str) -> Iterator[str]:
    """Unit with the product at its beginning written without signs, as ``kNm/rad``."""
    product, slash, rest = text.partition("/")
    if slash and product.startswith("N*m") and name.endswith("Nm" if product == "N*m" else "Nms"):
        yield f"{name}/{rest}"


def _fits(unit: str, dimension: str) -> bool:
    try:
        return parse_unit(unit).dimension == DIMENSIONS[dimension]
    except UnitError:
        return False


@lru_cache(maxsize=1)
def usual_units() -> tuple[str, ...]:
    """Units of all dimensions of a drivetrain, those that are usual for each, for values of any dimension."""
    rarest_last = sorted((name for name in DIMENSIONS if name != "1"), key=lambda name: name == "cubic stiffness")
    return tuple(dict.fromkeys(unit for name in rarest_last for unit in units_of(name)[:3]))
