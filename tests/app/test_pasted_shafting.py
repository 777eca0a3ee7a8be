"""Shafting of a two-stroke ship pasted from a spreadsheet, in words and numbers of makers: one model each time."""

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.app.explore.api import pasted_model

HEADINGS = {
    "symbols": "No.\tMass\tJ [kgm²]\tk [MNm/rad]\tc_abs [Nms/rad]\tc_rel [kNms/rad]\tOD [mm]\tLength [mm]",
    "words": "Item\tDescription\tMass moment of inertia (kg m2)\tTorsional stiffness (MN.m/rad)\tAbs. damping (N.m.s/rad)"
    "\tRel. damping (kN.m.s/rad)\tShaft diameter (mm)\tShaft length (mm)",
    "German": "Pos.\tBezeichnung\tTrägheitsmoment [kg·m²]\tDrehsteifigkeit [MN·m/rad]\tDämpfung abs. [N·m·s/rad]"
    "\tDämpfung rel. [kN·m·s/rad]\tAußendurchmesser [mm]\tLänge [mm]",
    "units below": "Mass no.\tName\tInertia\tStiffness\tDamping to ground\tShaft damping\tOuter dia.\tLength\n"
    "\t\tkgm2\tMNm/rad\tNms/rad\tkNms/rad\tmm\tmm",
}
ROWS = (
    *((f"Cyl. {number}", 9600, 910 if number < 6 else 1100, 900, 80 if number < 6 else "", "", "") for number in range(1, 7)),
    ("Flywheel", 6200, "", "", 20, 480, 12155),
    ("Flange", 800, "", "", 20, 575, 5674),
    ("Propeller", 39000, "", "", "", "", ""),
)  # fmt: skip


def table(heading, number=str):
    lines = [[at, *(number(cell) if isinstance(cell, int) else cell for cell in row)] for at, row in enumerate(ROWS, 1)]
    return "\n".join([heading, *("\t".join(map(str, line)) for line in lines)])


NUMBERS = {
    "plain": str,
    "decimal point": lambda value: f"{value:,.1f}",
    "decimal comma": lambda value: f"{value:,.1f}".translate(str.maketrans(",.", ".,")),
}


@pytest.mark.parametrize("number", NUMBERS.values(), ids=NUMBERS)
@pytest.mark.parametrize("heading", HEADINGS.values(), ids=HEADINGS)
def test_a_pasted_table_has_the_frequencies_of_the_ship(heading, number):
    found = pasted_model(table(heading, number))
    assert "refused" not in found, found
    built, expected = tn.loads(found["text"]).modes(), tn.load("two_stroke_ship").modes()
    # The one-node mode of the library's model is damped by its propeller, which no table of masses tells.
    one_node, others = 2, slice(3, None)
    np.testing.assert_allclose(built.natural_frequencies[others], expected.natural_frequencies[others], rtol=2e-5)
    assert built.natural_frequencies[one_node] == pytest.approx(5.21, abs=0.005)
    assert found["text"].splitlines()[2] == "source: pasted mass-elastic table"
    assert "damping: 80" in found["text"]
    assert "900" in found["text"]


def test_shafts_in_the_row_of_the_mass_behind_them():
    """As German sheets have them: every shaft one row further down, in all its columns."""
    heading, *rows = [line.split("\t") for line in table(HEADINGS["German"]).splitlines()]
    for before, row in reversed(list(zip([[""] * 8, *rows], rows, strict=False))):
        row[3], row[5:] = before[3], before[5:]
    found = pasted_model("\n".join("\t".join(line) for line in (heading, *rows)))
    assert "each shaft stands in the row of the mass behind it" in found["notes"]
    assert found["text"] == pasted_model(table(HEADINGS["German"]))["text"]


def test_a_unit_that_is_missing_is_asked_for():
    found = pasted_model("mass\tJ [kg*m^2]\tk\na\t1\t2\nb\t3\t")
    assert [(one["line"], one["heading"], one["units"][0]) for one in found["asked"]] == [(1, "k", "N*m/rad")]
