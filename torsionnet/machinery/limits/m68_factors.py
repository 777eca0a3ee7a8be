"""Factors of IACS UR M68 for one shaft, each with where it comes from."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from torsionnet.machinery.limits.m68_stress import (
    CONSTANT_ABOVE,
    HIGHEST_RATIO,
    NO_BARRED_ABOVE,
    PASSING_FACTOR,
    SCF_OF_UNIT,
    material_factor,
    permissible,
    size_factor,
)
from torsionnet.machinery.limits.shaft_limit import RoundSection
from torsionnet.machinery.verdicts.rule_factors import RuleFactor, RuleSymbol, RuleWords

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
    >>> found = {str(one.symbol): one for one in m68_factors(tail, RoundSection(0.4))}
    >>> found["C_W"].value / 1e6, round(found["C_D"].value, 5), found["C_K"].value, found["C_K"].origin
    (40.0, 0.63059, 0.55, ('propeller shaft: keyless taper fitting of the propeller',))
    """
    size, feature = size_factor(section.outer), limit.feature_factor
    ratios = np.array([1.0, NO_BARRED_ABOVE])
    rated, slow = permissible(limit.strength, feature * size, ratios).tolist()
    own = "entry of the limit" if limit.diameter is not None else "shaft of the model"
    product: RuleWords = (C_W, " ", C_K, " ", C_D)
    continuous = f" = {CONSTANT_ABOVE:g} to {HIGHEST_RATIO:g}"
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
            (*product, " (3 - 2 ", RuleSymbol("lambda", power="2"), "), ", RATIO, f" below {CONSTANT_ABOVE:g}"),
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
                f" up to {NO_BARRED_ABOVE:g}",
            ),
        ),
    )


def _strength(limit: M68Shaft) -> str:
    """Text on the steel and on its tensile strength, if the rule counts less than is specified."""
    steel = f"{limit.material.replace('_', '-')} steel, specified minimum"
    if limit.strength == limit.tensile_strength:
        return steel
    return f"{steel} {limit.tensile_strength / 1e6:g} N/mm^2, of which the rule counts this"


def _feature(limit: M68Shaft) -> str:
    """Text on the design feature that C_K is for, and on how it was found where the table does not give it."""
    words = f"{limit.shaft} shaft: {FEATURE_WORDS[limit.feature]}"
    if limit.stress_concentration is None:
        return words
    return f"{words}, {SCF_OF_UNIT:g}/scf with scf = {limit.stress_concentration:g}"
