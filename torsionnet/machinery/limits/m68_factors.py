"""Factors of IACS UR M68 for one shaft, each with where it comes from."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from torsionnet.base.phrases import phrase
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.limits.shaft_limit import RoundSection
from torsionnet.machinery.verdicts.limit_verdict import RuleFactor, RuleSymbol, RuleWords
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan

# Formulas and numbers of IACS UR M68 on torsional vibration stresses.

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
NOT_COVERED = (
    "speeds above 1.05 rated; crankshafts, shafts of gears, electric machines and turbines; ice class; shafts exposed "
    "to sea water; bending; required diameters (M68.4)"
)
OF_PITCH = ". With a controllable pitch propeller full and zero pitch are conditions of their own"
"""Texts with what IACS M68 does not cover, as reports print them; of a propeller of fixed pitch the first alone."""

NOT_FOR_SETS = (
    "UR M68 is not for generator shafts (M68.1), and this model is an engine with a generator and no propeller: "
    "give rule: generating_set_shaft, or, if there is a propeller, make it an element of type: propeller"
)
"""Message that IACS M68 does not judge the shafts of a generating set."""
NOT_FOR_CRANKSHAFTS = (
    "UR M68 is not for crankshafts (M68.1), and {name} is part of one: give the limit of its maker, rule: curve"
)
"""Message that IACS M68 does not judge a part of a crankshaft."""
NOT_FOR_GEARS = (
    "UR M68 is not for shafts that are integral to gearing (M68.1), and {name} lies between two gears: give the limit "
    "of its maker, rule: curve or rule: fatigue"
)
"""Message that IACS M68 does not judge a shaft of a gearbox."""
GEARING = ("gear", "planetary", "gearbox", "final_drive")
"""Types of elements that mesh; a shaft with one at either end is part of a gearbox."""


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
    # tau_C = C_W C_K C_D (3 - 2 lambda^2) below lambda = 0.9, 1.38 C_W C_K C_D from there to 1.05.
    bracket = np.where(ratio < CONSTANT_ABOVE, 3 - 2 * ratio**2, 1.38)
    stress = material_factor(strength) * factors * bracket
    return np.asarray(np.where(ratio <= HIGHEST_RATIO * (1 + 1e-12), stress, np.nan))


def usual_range(critical: float, rated: float) -> SpeedSpan:
    """Range of speeds in the unit of both arguments that M68 usually bars around a critical speed.

    >>> span = usual_range(0.5, 1.0)
    >>> round(span.low / 0.5, 5), round(span.high / 0.5, 5)
    (0.91429, 1.09375)
    """
    # 16 n_c/(18 - lambda) <= n <= (18 - lambda) n_c/16.
    ratio = critical / rated
    return SpeedSpan(16 * critical / (18 - ratio), (18 - ratio) * critical / 16)


BORE = RuleSymbol("d", "i")
"""Symbol of the inner diameter of a shaft."""
C_W, C_K, C_D, SIGMA_B = RuleSymbol("C", "W"), RuleSymbol("C", "K"), RuleSymbol("C", "D"), RuleSymbol("sigma", "B")
RATIO = RuleSymbol("lambda")
"""Symbol of the speed ratio, speed over rated speed."""
FEATURE_WORDS = {
    "integral_flange": "integral coupling flange",
    "shrink_fit": "shrink fit coupling",
    "tapered_keyway": "keyway, tapered connection",
    "cylindrical_keyway": "keyway, cylindrical connection",
    "radial_hole": "radial hole",
    "longitudinal_slot": "longitudinal slot",
    "thrust_collar": "on both sides of the thrust collar",
    "roller_bearing": "roller bearing used as thrust bearing",
    "flange": "flange mounted propeller",
    "keyless": "keyless taper fitting of the propeller",
    "keyed": "propeller fitted with a key",
    "forward_of_aft_bearing": "forward of the aft bearing",
}
"""Design feature of a shaft in the words of the table of C_K, by its name in ``feature:``."""


class M68Shaft(Protocol):
    """Protocol of a shaft that IACS M68 is for, by its entries in SI units and the strength that counts."""

    @property
    def diameter(self) -> float | None: ...

    @property
    def material(self) -> str: ...

    @property
    def tensile_strength(self) -> float: ...

    @property
    def strength(self) -> float: ...

    @property
    def shaft(self) -> str: ...

    @property
    def feature(self) -> str: ...

    @property
    def feature_factor(self) -> float: ...

    @property
    def stress_concentration(self) -> float | None: ...


def m68_factors(limit: M68Shaft, section: RoundSection) -> tuple[RuleFactor, ...]:
    """Factors of IACS UR M68 for a shaft, in SI units: section, strength, C_W, C_D, C_K, tau_C and tau_T.

    Parameters
    ----------
    limit : M68Shaft
        The limit of the shaft.
    section : RoundSection
        Where the stress is judged, m.

    Returns
    -------
    tuple of RuleFactor
        tau_C at rated speed, at lambda = 0.8 and, there, tau_T.

    Examples
    --------
    >>> from torsionnet.machinery.limits.iacs_m68 import IacsM68
    >>> from torsionnet.machinery.limits.shaft_limit import RoundSection
    >>> tail = IacsM68(element="tail", shaft="propeller", feature="keyless", material="carbon",
    ...     tensile_strength="560 MPa")
    >>> factors = {str(factor.symbol): factor for factor in m68_factors(tail, RoundSection(0.4))}
    >>> factors["C_W"].value / 1e6, round(factors["C_D"].value, 5), factors["C_K"].value, factors["C_K"].origin
    (40.0, 0.63059, 0.55, ('propeller shaft: keyless taper fitting of the propeller',))
    """
    size, feature = size_factor(section.outer), limit.feature_factor
    ratios = np.array([1.0, NO_BARRED_ABOVE])
    rated, slow = permissible(limit.strength, feature * size, ratios).tolist()
    own = "entry of the limit" if limit.diameter is not None else "shaft of the model"
    product: RuleWords = (C_W, " ", C_K, " ", C_D)
    continuous = phrase(" = {low:g} to {high:g}", low=CONSTANT_ABOVE, high=HIGHEST_RATIO)
    return (
        RuleFactor(("outer diameter",), RuleSymbol("d"), section.outer, "m", (own,)),
        RuleFactor(("inner diameter",), BORE, section.inner, "m", (own,)),
        RuleFactor(
            ("polar section modulus",),
            RuleSymbol("W", "p"),
            section.modulus,
            "m^3",
            ("π (", RuleSymbol("d", power="4"), " - ", RuleSymbol("d", "i", "4"), ")/(16 d)"),
        ),
        RuleFactor(("tensile strength",), SIGMA_B, limit.strength, "Pa", (_strength(limit),)),
        RuleFactor(("material factor",), C_W, material_factor(limit.strength), "Pa", ("(", SIGMA_B, " + 160)/18")),
        RuleFactor(("size factor",), C_D, size, "1", ("0.35 + 0.93 ", RuleSymbol("d", power="-0.2"), ", d in mm")),
        RuleFactor(("design feature",), C_K, feature, "1", (_feature(limit),)),
        RuleFactor(
            ("permissible at rated speed",),
            RuleSymbol("tau", "C", at="1"),
            rated,
            "Pa",
            (*product, " 1.38, ", RATIO, continuous),
        ),
        RuleFactor(
            ("permissible at ", RATIO, f" = {NO_BARRED_ABOVE:g}"),
            RuleSymbol("tau", "C", at=f"{NO_BARRED_ABOVE:g}"),
            slow,
            "Pa",
            (
                *product,
                " (3 - 2 ",
                RuleSymbol("lambda", power="2"),
                "), ",
                RATIO,
                phrase(" below {low:g}", low=CONSTANT_ABOVE),
            ),
        ),
        RuleFactor(
            ("in quick passage at ", RATIO, f" = {NO_BARRED_ABOVE:g}"),
            RuleSymbol("tau", "T", at=f"{NO_BARRED_ABOVE:g}"),
            PASSING_FACTOR * slow / math.sqrt(feature),
            "Pa",
            (
                f"{PASSING_FACTOR:g} ",
                RuleSymbol("tau", "C"),
                "/",
                RuleSymbol("C", "K", root=True),
                ", ",
                RATIO,
                phrase(" up to {high:g}", high=NO_BARRED_ABOVE),
            ),
        ),
    )


def _strength(limit: M68Shaft) -> str:
    """Text on the steel and on its tensile strength, if the rule counts less than is specified."""
    steel = phrase("{steel}, specified minimum", steel=phrase(f"{limit.material.replace('_', '-')} steel"))
    if limit.strength == limit.tensile_strength:
        return steel
    given = limit.tensile_strength / 1e6
    return phrase("{steel} {given:g} N/mm^2, of which the rule counts this", steel=steel, given=given)


def _feature(limit: M68Shaft) -> str:
    """Text on the design feature that C_K is for, and on how it was found where the table does not give it."""
    shaft = phrase(f"{limit.shaft} shaft")
    words = phrase("{shaft}: {feature}", shaft=shaft, feature=phrase(FEATURE_WORDS[limit.feature]))
    if limit.stress_concentration is None:
        return words
    template = "{words}, {unit:g}/scf with scf = {factor:g}"
    return phrase(template, words=words, unit=SCF_OF_UNIT, factor=limit.stress_concentration)
