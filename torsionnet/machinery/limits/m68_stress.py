"""Formulas and numbers of IACS UR M68 on torsional vibration stresses."""

from __future__ import annotations

import numpy as np

from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan

FEATURES: dict[str, dict[str, float]] = {
    "intermediate": {
        "integral_flange": 1.0,
        "shrink_fit": 1.0,
        "tapered_keyway": 0.60,
        "cylindrical_keyway": 0.45,
        "radial_hole": 0.50,
        "longitudinal_slot": 0.30,
    },
    "thrust": {"thrust_collar": 0.85, "roller_bearing": 0.85},
    "propeller": {"flange": 0.55, "keyless": 0.55, "keyed": 0.55, "forward_of_aft_bearing": 0.80},
}
"""Factor C_K of IACS M68 by kind of shaft and design feature."""
STRENGTHS = {"carbon": (400e6, 760e6), "carbon_manganese": (400e6, 760e6), "alloy": (400e6, 950e6)}
"""Smallest and largest tensile strength in Pa of the materials that IACS M68 is for, by material."""
CAPS = {"carbon": 600e6, "carbon_manganese": 600e6, "alloy": 800e6}
"""Largest tensile strength in Pa that IACS M68 counts, by material."""
PROPELLER_CAP = 600e6
"""Largest tensile strength in Pa that IACS M68 counts for propeller shafts."""
NO_BARRED_ABOVE, CONSTANT_ABOVE, HIGHEST_RATIO = 0.8, 0.9, 1.05
"""Speed ratios above which M68 bars no range, tau_C no longer falls, and the rule says nothing."""
STRENGTH_FOR_PASSING = 500e6
"""Tensile strength in Pa that the rule wants of shafts stressed nearly up to tau_T."""
SCF_OF_UNIT = 1.45
"""Stress concentration of a slot at which the factor C_K = 1.45/scf of IACS M68 is 1."""
SLOT_LENGTH, SLOT_BORE, SLOT_WIDTH, HOLE = 0.8, 0.7, 0.15, 0.3
"""Bounds of IACS M68 on slots and holes over the outer diameter: a slot is shorter, its shaft's bore smaller, its width
larger; a hole is no larger."""
SOURCE = (
    "IACS UR M68, torsional vibration stresses and C_K as in KR Rules Part 5 Chapter 4 (2025), 202 and 206, "
    "which carry them"
)
"""Text with the source of IACS M68 as reports print it."""
NOT_COVERED = (
    "speeds above 1.05 rated; crankshafts, shafts of gears, electric machines and turbines; ice class; shafts exposed "
    "to sea water; bending; required diameters (M68.4). With a controllable pitch propeller full and zero pitch are "
    "conditions of their own"
)
"""Text with what IACS M68 does not cover, as reports print it."""

NOT_FOR_SETS = (
    "UR M68 is not for generator shafts (M68.1), and this model is an engine with a generator and no propeller: "
    "give rule: generating_set_shaft, or, if there is a propeller, make it an element of type: propeller"
)
"""Message that IACS M68 does not judge the shafts of a generating set."""


PASSING_FACTOR = 1.7
"""Factor of IACS M68 from tau_C/sqrt(C_K) to tau_T."""


def material_factor(strength: float) -> float:
    """Material factor C_W = (sigma_B + 160 N/mm^2)/18 of IACS M68 in Pa, for a tensile strength in Pa.

    >>> material_factor(560e6) / 1e6
    40.0
    """
    return (strength + 160e6) / 18


def size_factor(diameter: float) -> float:
    """Dimensionless size factor C_D of IACS M68 for an outer diameter in m.

    >>> round(size_factor(0.4), 5)
    0.63059
    """
    return float(0.35 + 0.93 * (1000 * diameter) ** -0.2)


def permissible(strength: float, factors: float, ratio: FloatArray) -> FloatArray:
    """Stress tau_C in Pa that IACS M68 permits at speed ratios lambda, in the shape of ``ratio``.

    NaN above 1.05. ``strength`` is the tensile strength in Pa, ``factors`` is C_K C_D.

    >>> (permissible(600e6, size_factor(0.4), np.array([0.5, 1.0])) / 1e6).round(3).tolist()
    [66.562, 36.742]
    """
    bracket = np.where(ratio < CONSTANT_ABOVE, 3 - 2 * ratio**2, 1.38)
    found = material_factor(strength) * factors * bracket
    return np.asarray(np.where(ratio <= HIGHEST_RATIO * (1 + 1e-12), found, np.nan))


def usual_range(critical: float, rated: float) -> SpeedSpan:
    """Range of speeds in the unit of both arguments that M68 usually bars around a critical speed.

    >>> span = usual_range(0.5, 1.0)
    >>> round(span.low / 0.5, 5), round(span.high / 0.5, 5)
    (0.91429, 1.09375)
    """
    ratio = critical / rated
    return SpeedSpan(16 * critical / (18 - ratio), (18 - ratio) * critical / 16)
