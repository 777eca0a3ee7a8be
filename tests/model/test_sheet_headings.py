"""Headings and remarks of mass-elastic sheets: factors, GD2, words; all of them are understood, or asked at their place.

The masses of 10 and 20 kg m^2 on 9.8e6 lbf in/rad vibrate at 64.862 Hz, sqrt(k (1/J_1 + 1/J_2))/(2 pi) by hand.
"""

import math
import random

import pytest

import torsionnet as tn
from torsionnet.app.cli import main
from torsionnet.base.delimited.cell_grid import parse_grid
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.model.sheets.mass_elastic_sheet import SheetReading, parse_sheet

LBF_IN = 0.45359237 * 9.80665 * 0.0254
K = 9.8e6 * LBF_IN


def sheet(text, **said):
    return parse_sheet(parse_grid(text.splitlines(), "sheet.csv"), SheetReading(**said))


def of_two(stiffness, cell, inertia="J [kg m2]", cells=("10", "20")):
    return f"No;Name;{inertia};{stiffness}\n1;motor;{cells[0]};{cell}\n2;pump;{cells[1]};\n"


def places(text, **said):
    with pytest.raises(ModelError) as caught:
        sheet(text, **said)
    return [(one.position.line, one.position.column, one.text) for one in caught.value.faults]


BEHIND = """K x 10^-6 (lb-in/rad)|K/10^6 [lb-in/rad]|Stiffness × 10⁶ (lb-in/rad)|K (lb-in/rad x 1E-6)|(lb-in/rad x 1E-6)
K * 1e-06 (lb-in/rad)|Kx10^-6 lb-in/rad|K × 10⁻⁶ [lb·in/rad]|10^-6 x K (lb-in/rad)|K (10^-6) [in-lb/rad]|K (lb-in/rad)/10^6
K x 1,000,000 (lb-in/rad)|Stiffness divided by 10^6 (lbf.in/rad)|K (lb-in/rad) E-6|K [x 10^6 lb-in/rad]|K x 10-6 (lb-in/rad)
Torsional stiffness k of shaft x 10^(-6), lb-in/rad|K times 10**6 (lbs-in/rad)|Stiffness multiplied by 10^6 [lb in/rad]"""
BEFORE = """K [10^6 lb-in/rad]|K (10⁶ lb-in/rad)|K E6 lb-in/rad|10^6 lb-in/rad|Stiffness, millions of lb-in/rad|K in million lb-in/rad
K [lb-in/rad] (millions)|Torsional stiffness to next mass, 1e6 lb-in/rad|K (1,000,000 lb-in/rad)|Steifigkeit in Mio. lb-in/rad"""


@pytest.mark.parametrize("heading", [*BEHIND.replace("\n", "|").split("|"), *BEFORE.replace("\n", "|").split("|")])
def test_a_factor_of_the_stiffness(heading):
    read = sheet(of_two(heading, "9.8"))
    assert float(read.links[0].stiffness.si) == pytest.approx(K, rel=1e-12)
    (factor,) = read.factors.readings
    assert (factor.by == "place") == (heading in BEFORE)
    assert float(factor.scale) == 1e6
    usual = [one for one in read.factors.possible if one.is_usual]
    assert [one.taken for one in usual] == [(factor.taken,)]
    assert usual[0].lowest == pytest.approx(64.862, rel=1e-5)


@pytest.mark.parametrize(
    ("heading", "cell"),
    [("Flexibility x 10^9 [rad/lb-in]", 1e9), ("Flexibility x 10^-9 (rad/lb-in)", 1e9), ("e [rad/10^6 lb-in]", 1e6)],
)
def test_a_factor_of_the_compliance(heading, cell):
    assert float(sheet(of_two(heading, repr(cell / 9.8e6))).links[0].stiffness.si) == pytest.approx(K, rel=1e-12)


@pytest.mark.parametrize(
    ("heading", "cells", "divided"),
    [
        ("J/1000 (kg m2)", "0.01|0.02", 1), ("J x 10^-3 [kg m²]", "0.01|0.02", 1), ("I [x10^3 kgm²]", "0.01|0.02", 1),
        ("J in 10^3 kgm²", "0.01|0.02", 1), ("Inertia, thousands of kg m2", "0.01|0.02", 1), ("GD² [kgm²]", "40|80", 4),
        ("PD2 [kgf m2]", "40|80", 4), ("PD² (kg m²)", "40|80", 4), ("GD²/4 [kgm²]", "10|20", 1), ("PD2/4 [kgm²]", "10|20", 1),
        ("J = GD²/4 [kgfm²]", "10|20", 1), ("Inertia GD^2/4 kgm²", "10|20", 1), ("WR² [kgm²]", "10|20", 1),
        ("GD²/(4g) [kgm²]", "10|20", 1),
    ],
)  # fmt: skip
def test_a_factor_of_the_inertia(heading, cells, divided):
    read = sheet(of_two("K [10^6 lb-in/rad]", "9.8", heading, cells.split("|")))
    assert [float(mass.inertia.si) for mass in read.masses] == pytest.approx([10, 20], rel=1e-12)
    if divided == 4:
        assert read.columns[2].unit.factor == pytest.approx(1 / divided)


@pytest.mark.parametrize(
    ("heading", "place", "message"),
    [
        ("K x 10E-6 (lb-in/rad)", 19, "ambiguous"), ("K x 106 (lb-in/rad)", 19, "ambiguous"), ("K [106 lb-in/rad]", 19, "ambiguous"),
        ("K reduced by 10 percent (lb-in/rad)", 21, '"reduced", "10", "percent" in the heading'),
        ("Stiffness geared [lb-in/rad]", 29, '"geared" in the heading of stiffness'),
        ("K x 10^-6 / 1000 [lb-in/rad]", 19, "a second unit or factor"), ("K x10^-6", 19, "has no unit beside it"),
        ("Kt (Mlb-in/rad)", 19, '"Mlb" is not a known unit'), ("Dynamic stiffness at 12 Hz [lb-in/rad]", 40, '"12", "hz"'),
    ],
)  # fmt: skip
def test_what_a_heading_says_beside_is_a_fault_at_its_place(heading, place, message):
    found = places(of_two(heading, "9.8"))
    assert any(one[:2] == (1, place) and message in one[2] for one in found), found


@pytest.mark.parametrize(
    ("heading", "message"),
    [
        ("Inertia without water [kgm²]", '"without", "water"'),
        ("J (GD²) [kgm²]", "four times as much"),
        ("MD²/4 [kgm²]", "md²"),
    ],
)
def test_words_of_an_inertia_that_are_not_understood(heading, message):
    assert message in places(of_two("K [10^6 lb-in/rad]", "9.8", heading))[0][2]


class TestMagnitude:
    """64.9 Hz and 0.0649 Hz, by a factor of 1000 twice, are both possible; 6.49e-5 Hz is not."""

    def test_it_is_asked_where_two_readings_are_possible(self):
        text = of_two("K (x1000) [lb-in/rad]", "9800")
        line, column, said = places(text)[0]
        assert (line, column) == (1, 22)
        assert "[1000 lb-in/rad] or [0.001 lb-in/rad]" in said
        assert float(sheet(text, factors="unit").links[0].stiffness.si) == pytest.approx(K)
        read = sheet(text, factors="values")
        assert float(read.links[0].stiffness.si) == pytest.approx(9.8 * LBF_IN)
        assert [one.by for one in read.factors.readings] == ["option"]

    def test_a_unit_that_is_absurd_is_asked_too(self):
        text = of_two("K [10^-6 lb-in/rad]", "9.8")
        assert "lowest vibrations: unit: 6.486e-05 Hz; values: 64.86 Hz" in places(text)[0][2]
        assert float(sheet(text, factors="unit").links[0].stiffness.si) == pytest.approx(9.8e-6 * LBF_IN)

    def test_a_factor_that_no_vibration_shows_is_asked(self):
        text = of_two("k [10^6 lb-in/rad];D x 10^-3 [m]", "9.8;100")
        assert places(text)[0][:2] == (1, 40)

    @pytest.mark.parametrize("seed", range(40))
    def test_random_sheets(self, seed):
        """One reading within 0.1 and 2000 Hz and the others outside by more than ten times, or a question."""
        chance = random.Random(seed)
        masses = [10 ** chance.uniform(-2, 4) for _ in range(2)]
        powers = [chance.choice([-9, -6, -3, 3, 6, 9]), chance.choice([0, -3, 3])]
        stiffness = sum(1 / mass for mass in masses) ** -1 * (2 * math.pi * 10 ** chance.uniform(-2, 4)) ** 2
        printed = stiffness * 10.0 ** (powers[0] * chance.choice([-1, 1]))
        heading = chance.choice(["k x 10^{} [N*m/rad]", "k [N*m/rad * 1e{}]", "k*E{} (Nm/rad)"]).format(powers[0])
        inertia = f"J x 10^{powers[1]} (kg m2)" if powers[1] else "J (kg m2)"
        text = of_two(heading, repr(printed), inertia, [repr(mass) for mass in masses])
        reduced = sum(1 / mass for mass in masses)
        lowest = {}
        for first in (powers[0], -powers[0]):
            for second in {powers[1], -powers[1]}:
                k, factor = printed * 10.0**first, 10.0**second
                lowest[first, second] = math.sqrt(k * reduced / factor) / (2 * math.pi)
        inside = [one for one, value in lowest.items() if 0.1 <= value <= 2000]
        near = [one for one, value in lowest.items() if 0.01 <= value <= 20000]
        if len(inside) == 1 and near == inside:
            read = sheet(text)
            first, second = inside[0]
            assert float(read.links[0].stiffness.si) == pytest.approx(printed * 10.0**first, rel=1e-12)
            assert float(read.masses[0].inertia.si) == pytest.approx(masses[0] * 10.0**second, rel=1e-12)
        else:
            assert {column for _, column, _ in places(text)} >= {text.index(heading) + 1 + heading.index(" ")} or (
                all(line == 1 for line, _, _ in places(text))
            )

    def test_masses_behind_gears_count_as_they_turn(self):
        """Real values: omega^2 = k (1/J_1 + 1/(J_2 n^2)), n = 1/100, on the first shaft."""
        text = "mass;J [kg m2];k x 10^-9 (Nm/rad);speed ratio\na;1;1e-6;1\nb;1e4;;0,01\n"
        read = sheet(text.replace(",", "."))
        expected = math.sqrt(1e3 * (1 + 1)) / (2 * math.pi)
        assert next(one.lowest for one in read.factors.possible if one.is_usual) == pytest.approx(expected, rel=1e-9)


ROWS = "1;Engine;100;5;1\n2;Pinion;4;;1\n3;Wheel;10;2;0.25\n4;Propeller;60;;0.25\n"
GEARED = f"No;Name;J [kg m2];k [MNm/rad];Speed ratio\n{ROWS}"


class TestRemarks:
    """Referred values are J n^2: the propeller of 60 kg m^2 at n = 1/4 is one of 960."""

    @pytest.mark.parametrize(
        ("remark", "propeller"),
        [
            ("Values referred to crank", 960), ("All values are referred to engine speed.", 960), ("Referred values", 960),
            ("Mass-elastic data reduced to crankshaft speed, 120 rpm", 960), ("Werte auf Kurbelwelle reduziert", 960),
            ("Trägheitsmomente und Steifigkeiten bezogen auf Motordrehzahl", 960), ("Geared engine", 60), ("geared", 60),
            ("Ratio of gear 4:1", 60), ("All values are real", 60), ("Ref. 12-345", 60), ("Values not reduced", 60),
        ],
    )  # fmt: skip
    @pytest.mark.parametrize("place", ["{};;;;\n{}", "# {}\n{}", "{1};{0};;;\n"])
    def test_sentences(self, remark, propeller, place):
        read = sheet(place.format(remark, GEARED))
        assert float(read.masses[3].inertia.si) == propeller
        assert [one.text for one in read.remarks] == [remark]
        if "alues" not in remark and propeller == 60:
            assert any(remark in note and "not used" in note for note in read.notes)

    @pytest.mark.parametrize(
        "remark",
        [
            "Stiffnesses reduced by 10 percent", "Drawing referred to: 12-345", "Values referred to drawing 12", "reduced",
            "Equivalent system", "Reduced power 80 %", "Values referred to propeller", "Inertias given as GD2",
            "K values times 10^6",
        ],
    )  # fmt: skip
    @pytest.mark.parametrize(
        ("place", "line", "column"), [("{};;;;\n{}", 1, 1), ("# {}\n{}", 1, 3), ("{1};{0};;;\n", 6, 2)]
    )
    def test_words_without_their_context_are_asked(self, remark, place, line, column):
        text = place.format(remark, GEARED)
        assert [one[:2] for one in places(text)] == [(line, column)]
        if "GD2" not in remark and "10^6" not in remark:
            assert float(sheet(text, values="real").masses[3].inertia.si) == 60
            assert float(sheet(text, values="referred").masses[3].inertia.si) == 960

    def test_at_one_speed_the_word_changes_nothing_and_is_said(self):
        read = sheet("Stiffnesses reduced by 10 percent;;;\n" + of_two("K [10^6 lb-in/rad]", "9.8"))
        assert any("reduced by 10 percent" in note for note in read.notes)

    def test_cells_without_a_meaning_are_read_too(self):
        text = GEARED.replace("Speed ratio", "Speed ratio;Remark").replace("2;0.25\n", "2;0.25;reduced by 3 %\n")
        assert places(text)[0][:2] == (4, 19)


def test_gears_put_between_branches_listed_in_sequence_are_in_the_report():
    read = sheet(GEARED + "5;Engine 2;90;4;1\n6;Clutch;3;;1\n")
    assert [(gear.first, gear.second, gear.ratio, gear.has_shaft) for gear in read.gears] == [
        ("Pinion", "Wheel", 4, False), ("Propeller", "Engine_2", tn.units.Fraction(1, 4), False)
    ]  # fmt: skip
    assert any("between Propeller and Engine_2 a gear of ratio 0.25 was put" in note for note in read.report().notes)


ALIGNED = """Data of shafting                            2020
Values referred to crank shaft

{}

End of the table of masses
"""


def aligned(rows, sides, gap):
    widths = [max(len(row[at]) for row in rows) for at in range(len(rows[0]))]
    put = {"<": str.ljust, ">": str.rjust, "^": str.center}
    lines = (
        gap.join(put[side](cell, width) for cell, width, side in zip(row, widths, sides, strict=True)) for row in rows
    )
    return ALIGNED.format("\n".join(line.rstrip() for line in lines))


@pytest.mark.parametrize("sides", ["<<<<<", ">>>>>", "^^^^^", "><>>>"])
@pytest.mark.parametrize("gap", ["  ", "     "])
@pytest.mark.parametrize("decimal", [".", ","])
def test_tables_aligned_by_blanks(sides, gap, decimal):
    rows = [["No", "Name", "J [kg m2]", "K x 10^-6 (Nm/rad)", "Speed ratio"], ["", "", "", "", "-"],
            ["1", "Cyl. 1", "10.5", "5", "1"], ["2", "Cyl. 2", "4", "", "1"], ["3", "main wheel", "0.625", "0.25", "0.25"],
            ["14", "pump", "60", "", "0.25"]]  # fmt: skip
    numbers = [
        rows[0],
        *([cell.replace(".", decimal) if cell[:1].isdigit() else cell for cell in row] for row in rows[1:]),
    ]
    read = sheet(aligned(numbers, sides, gap))
    assert [mass.label for mass in read.masses] == ["Cyl. 1", "Cyl. 2", "main wheel", "pump"]
    assert [float(mass.inertia.si) for mass in read.masses] == [10.5, 4, 10, 960]
    assert [float(read.links[at].stiffness.si) for at in (0, 2)] == [5e6, 4e6]
    assert read.referred


def test_long_headings_are_refused():
    """Expressions for headings see at most 150 characters; of thousands some would take minutes."""
    for text in ("K" + " x" * 70, "K " + "(" * 140, "x 10^" * 29, "stiffness " + "of the mass " * 11 + "zz", "1" * 150):
        assert places(of_two(text, "9.8"))
    assert places(of_two("K " + "x " * 3000, "9.8"))[0] == (
        1,
        19,
        "the heading is longer than 150 characters; shorten it",
    )
    sheet("Values referred " + "to the crank " * 3000 + ";;;\n" + of_two("K [10^6 lb-in/rad]", "9.8"))


def test_a_number_below_no_heading_is_a_fault():
    assert places(of_two("K [10^6 lb-in/rad]", "9.8;7"))[0][:2] == (2, 16)


def test_options_of_the_command(tmp_path, capsys):
    (tmp_path / "x.csv").write_text("Stiffnesses reduced by 10 percent;;;;\n" + GEARED, encoding="utf-8")
    assert main(["import", str(tmp_path / "x.csv")]) == 1
    assert "x.csv:1:1: error" in capsys.readouterr().err
    assert main(["import", str(tmp_path / "x.csv"), "--values", "referred"]) == 0
    assert "inertia: 960" in capsys.readouterr().out
    (tmp_path / "y.csv").write_text(of_two("K (x1000) [Nm/rad]", "9.8"), encoding="utf-8")
    assert main(["import", str(tmp_path / "y.csv"), "--factors", "unit"]) == 0
    assert "stiffness: 9.8e3 Nm/rad" in capsys.readouterr().out
    assert main(["import", str(tmp_path / "x.tors"), "--values", "real"]) == 2
    assert "[needless-entry]" in capsys.readouterr().err
    with pytest.raises(UsageError, match=r'(?s)did you mean "values".*unknown-word'):
        tn.io.read_mass_elastic(tmp_path / "y.csv", factors="value")


def test_choices_in_a_model(tmp_path):
    (tmp_path / "x.csv").write_text("Stiffnesses reduced by 10 percent;;;;\n" + GEARED, encoding="utf-8")
    text = "torsionnet: 1\nname: x\nelements:\n  line: {type: mass_elastic, table: {file: x.csv, values: referred}}\n"
    model = tn.loads(text, folder=tmp_path)
    assert float(model.elements["line.Propeller"].inertia.value) == 960
    assert "table: {file: x.csv, values: referred}" in model.to_yaml()
    with pytest.raises(ModelError, match="expected real or referred"):
        tn.loads(text.replace("values: referred", "values: reel"), folder=tmp_path)
    with pytest.raises(ModelError, match=r":4:51: .*unknown-entry"):
        tn.loads(text.replace("values: referred", "value: real"), folder=tmp_path)
