"""Rows of what classification societies say on torsional vibration of shafts, each with its source."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from torsionnet.base.entries.spec import EntryError, OneOf


@dataclass(frozen=True)
class GeneratingSetNumbers:
    """Vibratory shear stresses in Pa that a society permits the shafts of a generating set driven by a piston engine.

    Attributes
    ----------
    lowest, highest : float
        Speed ratios between which the set runs continuously.
    continuous, passing : mapping
        Stress in Pa from ``lowest`` to ``highest``, and while lower speeds are passed, by kind of shaft.
    tensile_strength, yield_strength : float
        Pa; of the steel that the stresses are for.
    caps : mapping
        Largest tensile strength in Pa that counts, by kind of steel.
    source : str
    """

    lowest: float
    highest: float
    continuous: Mapping[str, float]
    passing: Mapping[str, float]
    tensile_strength: float
    yield_strength: float
    caps: Mapping[str, float]
    source: str


@dataclass(frozen=True)
class Society:
    """Row of a classification society: names, symbols, words of its form, and the numbers that its text gives.

    Attributes
    ----------
    name : str
    edition : str
        Text that was read, with its edition.
    words : mapping
        What the society calls things, by the words and symbols that limits and reports use of themselves.
    marking : str
        How ranges are marked, and how they are passed.
    asked_for : tuple of (str, str, str)
        Paragraph, what it asks of the calculation, and the section of a report that has it.
    highest_critical_ratio : float, optional
        Speed ratio up to which critical speeds are to be given.
    shafts : str
        Source of the stresses of propulsion shafts; empty where its text was not at hand.
    sets : GeneratingSetNumbers, optional
    remark : str
        What of the society's rules is left out or stands in for its text.
    """

    name: str
    edition: str
    words: Mapping[str, str] = field(default_factory=dict)
    marking: str = ""
    asked_for: tuple[tuple[str, str, str], ...] = ()
    highest_critical_ratio: float | None = None
    shafts: str = ""
    sets: GeneratingSetNumbers | None = None
    remark: str = ""

    def in_words(self, text: str) -> str:
        """Text with the society's words and symbols in place of those that limits and reports use of themselves.

        >>> SOCIETIES["lr"].in_words("barred ranges above tau_C up to lambda = 0.8")
        'restricted speed ranges above tau_c up to r = 0.8'
        """
        if not self.words:
            return text
        said = {
            word.replace("_", mark): other.replace("_", mark) for mark in "_ " for word, other in self.words.items()
        }
        # A name from the model that holds one of the words is longer, and stays.
        known = "|".join(sorted(map(re.escape, said), key=len, reverse=True))
        return re.sub(rf"(?<![\w-])({known})(?=s?(?![\w-]))", lambda match: said[match[1]], text)


SOURCE = (
    "IACS UR M68, torsional vibration stresses and C_K as in KR Rules Part 5 Chapter 4 (2025), 202 and 206, "
    "which carry them"
)
"""Text with the source of IACS M68 as reports print it."""
KR_CHAPTER = "KR Rules for the Classification of Steel Ships, Part 5 Chapter 4 (2025)"
"""Chapter of the Korean Register's rules on torsional vibration, with its edition."""
LR_CHAPTER = (
    "LR Rules for the Classification of Naval Ships (January 2023), Vol 2 Pt 5 Ch 1, 1.1 to 3.1 and Table 1.3.1 in "
    "part; restricted speed range as in Ch 2, 3.3"
)
"""Chapter of the rules of Lloyd's Register that was at hand in part, with its edition."""

SOCIETIES: dict[str, Society] = {
    "m68": Society(
        name="IACS UR M68",
        edition="as carried by KR Part 5 Chapter 4 (2025); of M68 itself the scope",
        shafts=SOURCE,
    ),
    "kr": Society(
        name="Korean Register (KR)",
        edition=KR_CHAPTER,
        words={"tau_C": "tau_1", "tau_T": "tau_2", "C_K": "C_k", "C_D": "C_d", "sigma_B": "T_s"},
        marking="red zones on the engine tachometers; passed as rapidly as possible (206.1)",
        asked_for=(
            (
                "102.1(1)",
                "natural frequencies and modes with one and two nodes, more if need be",
                "natural_frequencies",
            ),
            ("102.1(2)", "stresses at critical speeds up to 120 % of the maximum continuous speed", "resonances"),
            ("102.1(3)", "vibratory torques of shafts, gears and flexible couplings", "forced_response"),
            ("102.1(4)", "stresses of propulsion shafts with any one cylinder misfiring", "components"),
            ("103.2", "measurements that confirm the calculation", "measurement_plan"),
            ("206.1", "barred speed ranges", "conclusion"),
        ),
        highest_critical_ratio=1.2,
        shafts=f"{KR_CHAPTER}, 202 and 206; C_k by Table 5.4.1",
        sets=GeneratingSetNumbers(
            lowest=0.9,
            highest=1.1,
            continuous={"generator": 31e6, "crankshaft_in_line": 21e6, "crankshaft_other": 16e6},
            passing={"generator": 118e6, "crankshaft_in_line": 90e6, "crankshaft_other": 90e6},
            tensile_strength=440e6,
            yield_strength=225e6,
            caps={"carbon": 590e6, "carbon_manganese": 590e6, "alloy": 835e6},
            source=f"{KR_CHAPTER}, 203 and 206, f_m by 201.4",
        ),
        remark="crankshafts of main engines (201) and the avoidance of major criticals (204) are not judged; C_K = "
        "1.45/scf of slots is that of M68, KR wants it agreed; ranges by measurement (206.3) are left to the test",
    ),
    "lr": Society(
        name="Lloyd's Register (LR)",
        edition=LR_CHAPTER,
        words={
            "barred speed range": "restricted speed range",
            "barred range": "restricted speed range",
            "tau_C": "tau_c",
            "tau_T": "tau_t",
            "C_K": "C_k",
            "C_D": "C_d",
            "sigma_B": "sigma_u",
            "lambda =": "r =",
            "lambda above": "r above",
            "lambda^2": "r^2",
        },
        asked_for=(
            ("2.1.1", "vibratory torques and stresses of the whole system", "forced_response"),
            ("2.1.2", "division of power over the speed range; several engines and their phases", "conditions"),
            ("2.1.4", "operating conditions of longer duration: idling, combinator", "conditions"),
            ("2.1.5", "makers' data of dampers and couplings with their vibratory loads and heat", "installation"),
            ("2.1.6", "dimensions of generator and motor shafts, inertia of rotors by the maker", "mass_elastic"),
            ("2.1.7", "monitoring of vibration, where it is required", "measurement_plan"),
        ),
        remark="words, symbols, C_D and the first C_K are those of LR; its formulas of the stresses permitted and its "
        "values for generating sets were not at hand, and limits are judged by the rule that each names",
    ),
}
"""Rows of the classification societies whose text on torsional vibration was at hand, by their short name."""


def in_all_words(word: str) -> frozenset[str]:
    """Words and symbols of all societies for a word or symbol that limits use of themselves, with this one.

    >>> sorted(in_all_words("tau_C"))
    ['tau_1', 'tau_C', 'tau_c']
    """
    return frozenset({word, *(society.in_words(word) for society in SOCIETIES.values())})


NOT_AT_HAND = {
    "lr": "of LR's rules words and symbols were at hand, but not the formulas of its limits (Pt 5 Ch 8 2.5)",
    "dnv": "the text of DNV's rules (DNV-RU-SHIP Pt.4 Ch.2, DNV-CG-0038) on torsional vibration was not at hand",
    "abs": "the text of ABS's rules (4-3-2/7) on torsional vibration was not at hand",
}
"""Reasons that the numbers of a society are missing here, by its short name."""
SHAFT_SOCIETIES = tuple(name for name, row in SOCIETIES.items() if row.shafts)
"""Short names of the societies by which stresses of propulsion shafts are judged."""
SET_SOCIETIES = tuple(name for name, row in SOCIETIES.items() if row.sets)
"""Short names of the societies by which stresses of generating sets are judged."""


class SocietyName(OneOf):
    """Entry of the society whose numbers are meant; says of others why they have none here."""

    def coerce(self, raw: object) -> str:
        if raw in NOT_AT_HAND and raw not in self.options:
            instead = "give the values that its letter of approval states as rule: curve"
            raise EntryError(
                f"{NOT_AT_HAND[str(raw)]}; judge by {' or '.join(self.options)}, or {instead}", kind="unknown-word"
            )
        return super().coerce(raw)
