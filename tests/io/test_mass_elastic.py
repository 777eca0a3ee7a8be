"""Makers' mass-elastic sheets: published tables give their frequencies, forms of one table one model, faults a place."""

import json
import random
from pathlib import Path

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.io import mass_elastic_report, read_mass_elastic
from torsionnet.model.sheets.sheet_rows import _quotient
from torsionnet.model.sheets.sheet_values import SheetValue

CASES = Path(__file__).parents[1] / "validation" / "cases"
SHEETS = Path(__file__).parents[1] / "sheets"

MENDES = """\
Station;J [kg m²];k [10^6 Nm/rad];absolute damping [Nms/rad]
Pulley;0,0170;1,106;
Gear train;0,0090;1,631;
Cylinder;0,0467;1,253;2
Cylinder;0,0327;1,253;2
Cylinder;0,0467;1,678;2
Cylinder;0,0467;1,253;2
Cylinder;0,0327;1,253;2
Cylinder;0,0487;1,976;2
Flywheel;2,0750;;
"""
# Propeller, bull gear, and two turbines through two reductions each; speeds over that of the propeller.
GUNTER = """\
mass,inertia [lbf.in.s2],stiffness [10^6 lbf.in/rad],to,speed ratio
propeller,2.454e6,826,bull gear,1
bull gear,0.826e6,,lp pinion,1
lp pinion,0,203.94,lp wheel,-9.4094
lp wheel,1.283e4,rigid,lp turbine pinion,-9.4094
lp turbine pinion,0,30.51,lp turbine,40.0424
lp turbine,1.509e4,,,40.0424
hp pinion,0,rigid,bull gear,-9.4094
hp wheel,2.723e4,24.17,hp pinion,-9.4094
hp turbine pinion,0,,hp wheel,78.2365
hp turbine,261.2,14.26,hp turbine pinion,78.2365
"""


def read(tmp_path, text, name="sheet.csv"):
    (tmp_path / name).write_text(text, encoding="utf-8")
    return read_mass_elastic(tmp_path / name)


def faults(tmp_path, text):
    with pytest.raises(ModelError) as caught:
        read(tmp_path, text)
    return [(one.position.line, one.position.column, one.kind) for one in caught.value.faults]


def case(name):
    return json.loads((CASES / f"{name}.json").read_text(encoding="utf-8"))["expected"]


class TestPublishedTables:
    def test_six_cylinder_engine(self, tmp_path):
        engine = read(tmp_path, MENDES)
        expected = case("mendes_2008_six_cyl_diesel")
        found = engine.modes()
        swings = found.eigenvalues.imag > 0
        np.testing.assert_allclose(found.natural_frequencies[swings], expected["natural_frequencies_hz"], rtol=1e-9)
        np.testing.assert_allclose(found.damping_ratios[swings], expected["damping_ratios"], rtol=1e-8)
        assert engine.nodes[:4] == ("Pulley", "Gear_train", "Cylinder_1", "Cylinder_2")

    def test_turbines_with_two_reductions_in_two_branches(self, tmp_path):
        plant = read(tmp_path, GUNTER)
        expected = case("gunter_chen_8_1_marine_steam_turbine")["undamped_natural_frequencies_hz"]
        np.testing.assert_allclose(plant.modes().natural_frequencies, expected, rtol=1e-9, atol=1e-4)


def test_two_masses_behind_a_gear_by_closed_form(tmp_path):
    """J_1 on k, then a gear of ratio 4, then J_2: omega^2 = k (1/J_1 + 16/J_2), real; the same from referred values."""
    omega = np.sqrt(1e4 * (1 / 2 + 16 / 30))
    real = "mass;J [kg*m^2];k [kN*m/rad];speed ratio\na;2;10;1\nb;30;;0,25\n"
    referred = "Values referred to crank;;;\nmass;J [kg*m^2];k [kN*m/rad];speed ratio\na;2;10;1\nb;1.875;;0.25\n"
    for text in (real, referred, referred.replace("Values referred to crank", "x").replace("J [", "J red. [")):
        modes = read(tmp_path, text).modes()
        assert 2 * np.pi * modes.natural_frequencies[1] == pytest.approx(omega, rel=1e-12)


ONE_TABLE = [
    "mass,J [kg*m^2],k [kN*m/rad]\na,1.5,40\nb,2,36\nc,3000,\n",
    "mass;J [kg m²];k [kN·m/rad]\na;1,5;40,0\nb;2;36\nc;3.000;\n",
    "mass\tJ [kgm2]\tk [N.m/rad]\na\t1.5\t40'000\nb\t2\t36 000\nc\t3000\t-\n",
    "mass;Massenträgheitsmoment (kgm²);Drehsteifigkeit in kNm/rad\na;1,5;40\nb;2;36\nc;3000;\n",
    "mass;J;k\n;[kg*m^2];[MN*m/rad]\na;1,5;0,040\nb;2;0,036\nc;3000;\n",
    "mass;GD² [kg m²];Nachgiebigkeit [10⁻⁶ rad/Nm]\na;6;25\nb;8;27,777777777777777\nc;12000;\n",
    "mass,inertia kgm2,compliance 1e-9 rad/Nm\na,1.5,25000\nb,2,27777.777777777777\nc,3000,\n",
    "# comment\nPos,Bezeichnung,Drehmasse [kgm²],k [kNm/rad]\n1,a,1.5,\n,shaft 1,,40\n2,b,2,\n,shaft 2,,36\n3,c,3000,\n",
    "mass;J [kg*m^2];k [kN*m/rad];from\nb;2;;\na;1,5;40;b\nc;3000;36;b\n",
    "name;from;to;J [kg*m^2];k [kN*m/rad]\na;;;1.5;\nb;;;2;\nc;;;3000;\nx;a;b;;40\ny;b;c;;36\n",
    "no;J [kg*m^2];k [kN*m/rad];to\n3;3000;;\n1;1,5;40;2\n2;2;36;3\n",
    'mass,"J\n[kg*m^2]","k\n[kN*m/rad]"\na,"1,5","40"\nb,2,36\nc,3000,\n',
    "mass;J [kg*m^2];k\na;1.5;40 kN*m/rad\nb;2;36 kN*m/rad\nc;3000;\n",
    "mass;J [kg*m^2];k [kN*m/rad]\na;1.5;40\nb;2;36\nc;3000;\nTotal;3003.5;\n",
]


@pytest.mark.parametrize("text", ONE_TABLE)
def test_one_table_in_many_forms(tmp_path, text):
    """Three masses on two springs: poles of the characteristic polynomial, written out."""
    (a, b, c), (k, q) = (1.5, 2.0, 3000.0), (40e3, 36e3)
    half = (k * (1 / a + 1 / b) + q * (1 / b + 1 / c)) / 2
    product = k * q * (a + b + c) / (a * b * c)
    squares = half + np.sqrt(half**2 - product) * np.array([-1, 1])
    found = read(tmp_path, text).modes().natural_frequencies
    np.testing.assert_allclose(2 * np.pi * found[1:], np.sqrt(squares), rtol=1e-12)


def test_an_american_sheet_in_pounds(tmp_path):
    text = """"Mass No.","Item","WR2 (lb-ft2)","Stiffness (10^6 lb-in/rad)","Shaft OD (in)","RPM"
1,"Motor","12,450",58.2,9.5,1785
2,"Gear",310,,,1785
3,"Pinion",94.5,,,7140
"""
    (tmp_path / "sheet.csv").write_text(text)
    sheet = tn.io.mass_elastic_report(tmp_path / "sheet.csv")
    pound, foot, inch = 0.45359237, 0.3048, 0.0254
    assert [float(mass.inertia.si) for mass in sheet.masses] == pytest.approx(
        [value * pound * foot**2 for value in (12450, 310, 94.5)], rel=1e-14
    )
    assert float(sheet.links[0].stiffness.si) == pytest.approx(58.2e6 * pound * 9.80665 * inch, rel=1e-14)
    assert float(sheet.links[0].outer.si) == pytest.approx(9.5 * inch)
    assert [mass.ratio for mass in sheet.masses] == [1, 1, 4]
    (tmp_path / "sheet.csv").write_text(
        text.replace("RPM", "Speed").replace(",1785", ",1785 rpm").replace("7140", "747.69905 rad/s")
    )
    ratios = [float(mass.ratio) for mass in tn.io.mass_elastic_report(tmp_path / "sheet.csv").masses]
    assert ratios == pytest.approx([1, 1, 4])


def test_a_remark_behind_the_unit_of_a_heading(tmp_path):
    text = """Mass,Inertia [kg m^2] (referred to crankshaft),Elasticity [1e-9 rad/Nm] (referred to crankshaft),Speed ratio
a,5,25,1
b,6,0,1
c,2,50,0.5
d,3,,0.5
"""
    (tmp_path / "sheet.csv").write_text(text)
    sheet = tn.io.mass_elastic_report(tmp_path / "sheet.csv")
    assert sheet.referred
    assert [float(mass.inertia.si) for mass in sheet.masses] == [5, 6, 8, 12]
    assert [float(sheet.links[at].stiffness.si) for at in (0, 2)] == [4e7, 8e7]
    assert sheet.links[0].stiffness.raw == "25e-9 rad/Nm"
    assert ("Elasticity [1e-9 rad/Nm] (referred to crankshaft)", "compliance") in [
        row[:2] for row in sheet.report().rows
    ]


def test_encodings_of_spreadsheet_programs(tmp_path):
    for encoding in ("utf-8-sig", "utf-16", "cp1252"):
        (tmp_path / "x.csv").write_bytes(MENDES.encode(encoding))
        assert read_mass_elastic(tmp_path / "x.csv").nodes[0] == "Pulley"


def test_losses_diameters_and_rigid_shafts(tmp_path):
    text = (
        "mass;J [kg*m^2];k [N*m/rad];psi;magnifier;outer diameter [mm];inner diameter [mm];length [m]\n"
        "a;1;100;0,5;;;;\nb;1;200;;30;80;20;\nc;1;rigid;;;;;\nd;1;;;;100;;2\ne;1;;;;;;\n"
    )
    line = read(tmp_path, text)
    assert line.elements["a_to_b"].to_data()["loss_factor"] == {"psi": 0.5}
    assert line.elements["b_to_c"].to_data()["loss_factor"] == {"magnifier": 30}
    assert line.elements["b_to_c"].to_data()["inner_diameter"] == "20 mm"
    assert line.elements["c_to_d"].kind == "rigid_coupling"
    assert line.elements["d_to_e"].to_data() == {
        "type": "shaft", "nodes": ["d", "e"], "outer_diameter": "100 mm", "length": "2 m", "inertia": "none"
    }  # fmt: skip
    # Stress is torque over the section modulus pi (D^4 - d^4) / (16 D).
    modulus = np.pi * (0.08**4 - 0.02**4) / (16 * 0.08)
    torque, stress = (line.frequency_response(f"{what}(b_to_c)", "a", [1.0]).values for what in ("torque", "stress"))
    np.testing.assert_allclose(stress * modulus, torque, rtol=1e-12)


class TestElement:
    MODEL = (
        "torsionnet: 1\nname: plant\nelements:\n  engine: {type: mass_elastic, table: engine.csv, at: {flywheel: fly}}\n"
        "  pump: {type: inertia, node: fly, inertia: 100}\nsensors: {T: {torque: engine.Wheel_to_Propeller}}\n"
    )

    def model(self, tmp_path, text=MODEL):
        (tmp_path / "engine.csv").write_bytes((SHEETS / "engine.csv").read_bytes())
        (tmp_path / "model.yaml").write_text(text, encoding="utf-8")
        return tn.load(tmp_path / "model.yaml")

    def test_it_stands_for_elements_with_names(self, tmp_path):
        plant = self.model(tmp_path)
        assert set(plant.nodes) == {
            "fly", "engine.Damper_ring", "engine.Damper_housing", "engine.Cyl_1", "engine.Cyl_2", "engine.Pinion",
            "engine.Wheel", "engine.Propeller",
        }  # fmt: skip
        assert plant.elements["engine.Pinion_to_Wheel"].ratio_value({}) == 4
        assert float(plant.elements["engine.Propeller"].inertia.value) == 6200
        assert float(plant.elements["engine.Damper_ring_to_Damper_housing"].damping.value) == 42000

    def test_it_has_the_modes_of_the_same_model_by_hand(self, tmp_path):
        (tmp_path / "engine.csv").write_bytes((SHEETS / "engine.csv").read_bytes())
        hand = read_mass_elastic(tmp_path / "engine.csv")
        alone = self.MODEL.replace("  pump: {type: inertia, node: fly, inertia: 100}\n", "")
        np.testing.assert_allclose(
            self.model(tmp_path, alone).modes().eigenvalues, hand.modes().eigenvalues, rtol=1e-12, atol=1e-9
        )

    def test_a_written_model_keeps_the_sheet(self, tmp_path):
        plant = self.model(tmp_path)
        assert "engine: {type: mass_elastic, table: engine.csv, at: {flywheel: fly}}" in plant.to_yaml()
        again = tn.loads(plant.to_yaml(), folder=tmp_path)
        assert again.elements == plant.elements

    def test_it_can_be_switched(self, tmp_path):
        extra = "configurations: {plant: {with: {}, without: {off: [engine, pump]}}}\n"
        spare = "  spare: {type: inertia, node: fly, inertia: 1}\nsensors"
        text = self.MODEL.replace("sensors", spare, 1) + extra
        assert self.model(tmp_path, text).configured("without").nodes == ("fly",)

    @pytest.mark.parametrize(
        ("change", "column", "message"),
        [
            (("flywheel: fly", "flywhel: fly"), "flywhel", r':4:56: .*did you mean "Flywheel".*unknown-name'),
            (("{flywheel: fly}", "{flywheel: fly, pinion: fly}"), "fly", r":4:66: .*same-node"),
            (("engine.csv", "engin.csv"), "engin.csv", r":4:39: .*missing-file"),
        ],
    )
    def test_faults_in_the_line_of_the_model(self, tmp_path, change, column, message):
        with pytest.raises(ModelError, match=message) as caught:
            self.model(tmp_path, self.MODEL.replace(*change))
        position = caught.value.faults[0].position
        assert position.line == 4
        assert position.source[position.column - 1 :].startswith(column)

    def test_a_faulty_sheet_is_named_in_both_files(self, tmp_path):
        (tmp_path / "bad.csv").write_text("mass;J [kg*m^2];k [N*m/rad]\na;1;x\nb;1;\n", encoding="utf-8")
        with pytest.raises(ModelError) as caught:
            self.model(tmp_path, self.MODEL.replace("engine.csv", "bad.csv"))
        places = {(one.position.file.rpartition("/")[2], one.position.line) for one in caught.value.faults}
        assert {("bad.csv", 2), ("model.yaml", 4)} <= places


class TestReport:
    def test_it_says_what_was_taken_as_what(self):
        sheet = mass_elastic_report(SHEETS / "engine.csv")
        rows = {row[0]: row[1:3] for row in sheet.report().rows}
        assert rows["Inertia"] == ("inertia", "kgm²")
        assert rows["Rel. damping"] == ("damping of the shaft", "Nms/rad")
        assert rows["Remark"] == ("not understood", "")
        assert "decimal comma" in sheet.notes
        assert "values are real" in sheet.notes
        assert any("Total" in note for note in sheet.notes)

    def test_silence_on_referred_values_is_said(self, tmp_path):
        read(tmp_path, "mass;J [kg*m^2];k [N*m/rad];speed ratio\na;1;2;1\nb;1;;2\n")
        assert any("is not said" in note for note in mass_elastic_report(tmp_path / "sheet.csv").notes)

    def test_real_and_referred_columns_side_by_side(self, tmp_path):
        text = "mass;J [kg*m^2];J red. [kg*m^2];k [N*m/rad];speed ratio\na;1;1;2;1\nb;8;2;;0,5\n"
        assert float(read(tmp_path, text).elements["b"].inertia.value) == 8


HEAD = "mass;J [kg*m^2];k [N*m/rad]\n"


@pytest.mark.parametrize(
    ("text", "line", "column", "kind"),
    [
        ("mass;k [N*m/rad]\na;1\nb;\n", 1, 1, "missing-column"),
        ("mass;J;k [N*m/rad]\na;1;2\nb;1;\n", 1, 6, "missing-unit"),
        ("mass;J [kg];k [N*m/rad];J [kg*m^2]\na;1;2;3\nb;1;;3\n", 1, 6, "wrong-unit"),
        ("mass;Inertia (kgx-m2);k [N*m/rad]\na;1;2\nb;1;\n", 1, 6, "wrong-unit"),
        ("mass;J [kgmm];k [N*m/rad];I kgm2\na;1;2;3\nb;1;;3\n", 1, 6, "wrong-unit"),
        ("mass;J [kg*m^2];inertia [kg*m^2];k [N*m/rad]\na;1;1;2\nb;1;1;\n", 1, 17, "repeated-name"),
        ("mass;J [kg*m^2];Stifness\na;1;5\nb;1;\n", 1, 17, "unknown-entry"),
        ("mass;J [kg*m^2];k [N*m/rad];damping [N*m*s/rad]\na;1;5;2\nb;1;;\n", 1, 29, "ambiguous-name"),
        ("mass;J [kg*m^2];k [N*m/rad];gear ratio\na;1;5;2\nb;1;;\n", 1, 29, "ambiguous-name"),
        ("mass;J [kg*m^2];k [10E-6 Nm/rad]\na;1;5\nb;1;\n", 1, 17, "ambiguous-name"),
        ("mass;J [kg*m^2];k [N*m/rad];relative damping [%]\na;1;5;2\nb;1;;\n", 1, 29, "missing-unit"),
        (HEAD + "a;1;x\nb;1;\n", 2, 5, "not-a-number"),
        (HEAD + "a;1,5;2\nb;1.5;\n", 3, 3, "ambiguous-number"),
        (HEAD + "a;1,500;2\nb;2;\n", 2, 3, "ambiguous-number"),
        (HEAD + "a;1;2 kN*m/rad\nb;2;\n", 2, 5, "wrong-unit"),
        (HEAD + "a;-1;2\nb;2;\n", 2, 3, "out-of-range"),
        (HEAD + "a;1;\nb;2;3\nc;2;\n", 2, 1, "missing-entry"),
        (HEAD + "a;1;0\nb;2;\n", 2, 5, "out-of-range"),
        (HEAD + "a;1;3\nb;2;4\n", 3, 5, "missing-entry"),
        ("mass;J [kg*m^2];k [N*m/rad];to\na;1;3;d\nb;2;;\n", 2, 7, "unknown-name"),
        ("mass;J [kg*m^2];k [N*m/rad];to\na;1;3;b\nb;2;;\nc;2;;\n", 4, 1, "unconnected-nodes"),
        ("mass;J [kg*m^2];k [N*m/rad];to\na;1;3;a\nb;2;;\n", 2, 7, "same-node"),
        ("mass;J [kg*m^2];k [N*m/rad];speed ratio\na;1;3;1\nb;2;;0\n", 3, 6, "out-of-range"),
        ("mass;J [kg*m^2];k [N*m/rad];psi;eta\na;1;3;1;2\nb;2;;;\n", 2, 1, "contradicting-entries"),
        ("mass;J [kg*m^2];k [N*m/rad];D [mm];d i [mm]\na;1;3;10;20\nb;2;;;\n", 2, 10, "contradicting-values"),
        ("no columns here\n", 1, 1, "unreadable-file"),
        ("", 1, 1, "unreadable-file"),
    ],
)
def test_faults_have_their_place(tmp_path, text, line, column, kind):
    assert (line, column, kind) in faults(tmp_path, text)


def test_a_spreadsheet_itself_is_refused(tmp_path):
    (tmp_path / "x.csv").write_bytes(b"PK\x03\x04rest")
    with pytest.raises(ModelError, match=r":1:1: .*wrong-file"):
        read_mass_elastic(tmp_path / "x.csv")
    with pytest.raises(UsageError, match="there is no file"):
        read_mass_elastic(tmp_path / "y.csv")


def test_broken_sheets_are_refused_with_their_place(tmp_path):
    """Random damage gives a model or faults in the sheet, nothing else."""
    chance, read_in, refused = random.Random(17), 0, 0
    pieces = [b";", b"\n", b'"', b"1e999", b"1/0", b"rigid", b"to", b"\x00", b"\xff", b"9" * 300, b"k [deg]", b"10^99 "]
    for _ in range(150):
        text = bytearray(chance.choice([*ONE_TABLE, MENDES, GUNTER]).encode())
        for _ in range(chance.randint(1, 4)):
            at = chance.randrange(len(text))
            text[at : at + chance.randint(0, 4)] = chance.choice(pieces)
        (tmp_path / "x.csv").write_bytes(text)
        try:
            read_mass_elastic(tmp_path / "x.csv")
            read_in += 1
        except ModelError as error:
            places = {one.position.file for one in error.faults if one.position}
            refused += places == {"x.csv"}
    assert refused
    assert read_in


def test_speeds_in_two_units_have_the_ratio_of_their_sizes():
    assert _quotient(SheetValue(4.0, "4 rad/s"), SheetValue(2.0, "0.0333 krpm")) == 2
    assert _quotient(SheetValue(31.4, "300 rpm"), SheetValue(10.5, "100 rpm")) == 3
