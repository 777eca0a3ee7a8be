"""Measurement plan of a report: expected amplitudes by hand, and measured orders of a synthetic record beside them."""

import numpy as np
import pytest
from support.command_line import run
from support.report_blocks import blocks, of, rows

import torsionnet as tn
from torsionnet.report import make_report
from torsionnet.report.document_tree import TableBlock
from torsionnet.report.measured_orders import MeasuredFile
from torsionnet.report.plan.report_plan import ReportPlan
from torsionnet.report.report_request import ReportRequest

RPM = np.pi / 30
PLANT = """torsionnet: 1
name: two masses with an engine of one order
elements:
  motor: {type: inertia, node: m, inertia: 0.5 kg*m^2}
  shaft: {type: shaft, nodes: [m, f], outer_diameter: 40 mm, length: 0.5 m, inertia: none, damping: 20 N*m*s/rad}
  fan: {type: inertia, node: f, inertia: 2 kg*m^2}
speeds: {of: m, range: 300..900 rpm, step: 5 rpm, rated: 800 rpm}
excitations:
  motor: {type: harmonic, node: m, orders: {4: {amplitude: 20 N*m}}}
sensors: {phi: {angle: m}, T: {torque: shaft}, T_2: {torque: shaft, at: f}, w: {velocity: m}}
configurations: {motor: {weak: {motor.orders: {4: {amplitude: 5 N*m}}}, rough: {}}}
report: {measure: [phi, T], normal: rough, kind: approval}
"""
SHEAR_MODULUS = 79.3e9
K = SHEAR_MODULUS * np.pi * 0.04**4 / 32 / 0.5
"""Stiffness of the shaft by hand, N m/rad."""


def torque(rpm, load=20.0):
    """Of the shaft in N m by order 4: two masses on a spring, by hand."""
    s = 4j * rpm * RPM
    kappa, motor, fan = K + 20 * s, 0.5 * s**2, 2 * s**2
    return abs(kappa * (load / motor) / (1 + kappa * (1 / motor + 1 / fan)))


def plan(**options):
    return make_report(tn.loads(PLANT.replace("G_", "")), sections=["measurement_plan"], date=None, **options)


def tables(report, words=""):
    return [one for one in of(TableBlock, blocks(report, "measurement_plan")) if words in str(one.caption)]


def headings(one):
    return [str(column.text) for column in one.columns]


def test_a_range_without_a_peak_or_rated_speed_is_planned_where_it_vibrates_most():
    text = PLANT.replace("range: 300..900 rpm, step: 5 rpm, rated: 800 rpm", "range: 850..900 rpm, step: 5 rpm")
    (table,) = tables(make_report(tn.loads(text), sections=["measurement_plan"], date=None), "strain gauges")
    ((rpm, what, order, _, size, *_),) = rows(table)
    assert (float(rpm), what, order) == (850, "Largest half range", "4")
    assert float(size) == pytest.approx(torque(850), rel=1e-3)


def record(folder, name="test.csv", factor=1.1, unit="N*m", speeds=range(300, 901, 10), order=4, scale=1.0):
    lines = [f"{rpm};{order};{scale * factor * torque(rpm)!r}" for rpm in speeds]
    (folder / name).write_text("\n".join([f"speed [rpm];order;amplitude [{unit}]", *lines]), encoding="utf-8")
    return folder / name


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plant.yaml").write_text(PLANT)
    return tmp_path


def test_expected_amplitudes_by_hand():
    """In the condition that the report calls normal: 20 N m, not 5."""
    (table,) = tables(plan(), "strain gauges")
    assert "rough" in str(table.caption)
    speeds = {row[1]: [float(row[0]), float(row[2]), *map(float, row[4:])] for row in rows(table)}
    rpm, order, size, half_range, stress = speeds["Rated"]
    assert (rpm, order) == (800, 4)
    assert size == half_range == pytest.approx(torque(800), rel=1e-3)
    assert stress == pytest.approx(torque(800) * 16 / np.pi / 0.04**3 / 1e6, rel=1e-3)
    peak = max(speeds, key=lambda name: speeds[name][2])
    assert peak == "Peak of order 4"
    found = np.linspace(300, 900, 60001)
    assert speeds[peak][0] == pytest.approx(found[torque(found).argmax()], rel=2e-3)


def test_measured_ten_percent_higher(folder):
    report = plan(measured=[f"rough:T={record(folder)}"])
    table = tables(report, "strain gauges")[0]
    at = headings(table).index("Deviation")
    rated = next(row for row in rows(table) if row[1] == "Rated")
    assert float(rated[at]) == pytest.approx(10, abs=0.05)
    assert float(rated[at - 1]) == pytest.approx(1.1 * torque(800), rel=1e-3)
    (peaks,) = tables(report, "Measured and calculated peaks")
    assert float(rows(peaks)[0][headings(peaks).index("Deviation")]) == pytest.approx(10, abs=0.1)
    assert rows(peaks)[0][headings(peaks).index("Verdict")] == "no interval"
    assert "Measured" not in headings(tables(report, "torsiograph")[0])


def test_measured_in_another_condition(folder):
    report = plan(measured={"weak:T": record(folder)})
    (table,) = tables(report, "Torque by strain gauges")
    assert "weak" in str(table.caption)
    rated = next(row for row in rows(table) if row[1] == "Rated")
    assert float(rated[headings(table).index("Expected")]) == pytest.approx(torque(800, 5), rel=5e-3)


def test_several_files(folder):
    record(folder, "phi.csv", unit="mrad")
    report = plan(measured=["rough:T=" + str(record(folder)), "rough=phi.csv"])
    planned = [one for one in tables(report, "; condition") if "Expected" in headings(one)]
    assert ["Measured" in headings(one) for one in planned] == [True, True]


@pytest.mark.parametrize(
    ("more", "given", "words"),
    [
        ({"unit": "rad/s"}, "rough=test.csv", ("test.csv is in rad/s", "phi in rad, T in N*m", "measure: [...]")),
        (
            {"speeds": range(100, 250, 10)},
            "rough:T=test.csv",
            ("test.csv: none of the measured", "from 300 to 900 rpm"),
        ),
        ({"order": 7}, "rough:T=test.csv", ("test.csv: none of the measured orders of m (7)",)),
        ({}, "rough:w=test.csv", ("test.csv: w is no place", "measure: [phi, T, w]")),
        ({}, "test.csv", ("a measurement is of one configuration", "CONFIGURATION=test.csv", "rough, weak")),
        ({}, "calm=test.csv", ('measured orders "calm=test.csv"', "write CONFIGURATION=FILE")),
        ({}, "rough=none.csv", ("cannot read", "none.csv")),
    ],
)
def test_what_is_wrong_is_told(folder, more, given, words):
    record(folder, **more)
    with pytest.raises(tn.UsageError) as caught:
        plan(measured=[given])
    for text in words:
        assert text in str(caught.value)


def test_all_files_that_cannot_be_read_are_told_at_once():
    with pytest.raises(tn.UsageError, match=r"(?s)none\.csv: .*; .*nil\.csv: .*unreadable-file"):
        plan(measured=["rough=none.csv", "weak=nil.csv"])


def test_places_of_one_unit_are_not_guessed(folder):
    record(folder)
    model = tn.loads(PLANT.replace("measure: [phi, T]", "measure: [T, T_2]"))
    with pytest.raises(tn.UsageError, match="ambiguous-name"):
        make_report(model, sections=["measurement_plan"], measured=["rough=test.csv"])


def test_a_file_of_the_orders_command_names_its_places():
    run("orders", "plant.yaml", "-c", "rough", "--output", "T", "--output", "phi", "--csv", "all.csv")
    report = plan(measured=["rough=all.csv"])
    for words in ("torsiograph", "Torque by strain gauges"):
        (table, *_) = tables(report, words)
        at = headings(table).index("Deviation")
        assert [float(row[at]) for row in rows(table)] == pytest.approx([0] * len(rows(table)), abs=0.15)


def test_command_refuses_what_it_would_ignore(folder):
    record(folder)
    arguments = ["report", "plant.yaml", "-o", "x.md", "--measured", "rough:T=test.csv"]
    text = run(*arguments, "--section", "schematic", code=2).stderr
    assert "test.csv" in text
    assert "--section measurement_plan" in text.replace("\n  ", " ")
    run(*arguments, "--section", "measurement_plan")
    assert "10.0" in (folder / "x.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(("sections", "wanted"), [((), True), (("schematic",), False)])
def test_measured_orders_bring_their_section_unless_others_are_chosen(folder, sections, wanted):
    files = (MeasuredFile(record(folder), "rough", "T"),)
    rig = ReportPlan(kind="rig", sections=sections)
    assert ReportRequest(rig, measured=files).wants("measurement_plan") is wanted
    assert not ReportRequest(rig).wants("measurement_plan")


def test_wrong_sensor_is_told_with_its_place():
    with pytest.raises(tn.ModelError, match=r":12:25: .*unknown-channel"):
        tn.loads(PLANT.replace("measure: [phi, T]", "measure: [phi, T_x]"))


def test_default_places_are_the_free_end_and_the_shaft_used_most():
    report = make_report("bulk_carrier", sections=["measurement_plan"], date=None)
    assert [str(one.caption[0]).partition(";")[0] for one in tables(report)] == [
        "Angle by torsiograph or encoder, c1",
        "Torque by strain gauges, int shaft",
        "Expected with a cylinder out",
    ]
    assert any("Barred" in str(row[1]) for row in rows(tables(report)[0]))


@pytest.mark.parametrize(("limit", "place"), [("", "shaft"), ("quill", "quill")])
def test_the_shaft_that_a_limit_judges_comes_before_one_with_a_sensor(limit, place):
    quill = "quill: {type: shaft, nodes: [f, e], outer_diameter: 50 mm, length: 0.3 m, inertia: none}"
    text = PLANT.replace("speeds:", f"  {quill}\n  wheel: {{type: inertia, node: e, inertia: 1 kg*m^2}}\nspeeds:")
    if limit:
        entry = "{rule: fatigue, element: quill, fatigue_strength: 150 MPa, mean_stress: none}"
        text += f"limits: {{{limit}: {entry}}}\n"
    report = make_report(tn.loads(text.replace("measure: [phi, T], ", "")), sections=["measurement_plan"], date=None)
    assert str(tables(report, "strain gauges")[0].caption[0]).startswith(f"Torque by strain gauges, {place};")


@pytest.mark.slow
def test_a_speed_reduced_by_a_misfire_is_no_barred_range():
    report = make_report("two_stroke_ship", sections=["measurement_plan"], date=None)
    reasons = [row[1] for row in rows(tables(report)[0]) if row[1]]
    assert not any("arred" in reason for reason in reasons)
    out = [row[2] for row in rows(tables(report, "with a cylinder out")[0])]
    assert out == ["Highest permitted", "Worst of tail, not permitted"] * 2
