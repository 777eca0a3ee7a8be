"""The check of documents from their printed digits: a right one passes, and each kind of wrong digit is noticed."""

import re

import pytest
from support.printed_checks import document_faults
from support.printed_tables import Printed, printed_tables

import torsionnet as tn
from torsionnet.report import make_report
from torsionnet.report.writers.markdown import MarkdownWriter

MODEL = """torsionnet: 1
name: two discs and a heavy shaft
elements:
  fan: {type: inertia, node: a, inertia: 10 kg*m^2}
  line: {type: shaft, nodes: [a, b], outer_diameter: 280 mm, length: 1.9 m, segments: 3, damping: {zeta: 0.02, at: 200 Hz}}
  machine: {type: inertia, node: b, inertia: 1150 kg*m^2}
  ring: {type: viscous_damper, node: b, ring_inertia: 4 kg*m^2, damping: 500 N*m*s/rad}
speeds: {of: a, range: 1000..3000 rpm, step: 20 rpm, rated: 2800 rpm}
operating_point: {speed: {a: 2800 rpm}}
load: {absorbed_at: a, power: 900 kW, torque_exponent: 2, driven_by: {b: 1}}
excitations: {teeth: {type: harmonic, node: b, orders: {5: {amplitude: 40 kN*m}, 6: {amplitude: 30 kN*m}}}}
sensors: {T_line: {torque: line}}
limits: {line: {rule: curve, output: T_line, value: 8 kN*m, source: own}}
configurations: {load: {full: {}, half: {teeth.orders: {5: {amplitude: 20 kN*m}}}}}
report: {kind: approval}
"""


@pytest.fixture(scope="module")
def document():
    return MarkdownWriter(make_report(tn.loads(MODEL), date=None), "figures").page()


def table(document, words):
    return next(one for one in printed_tables(document) if words in one.caption)


class TestPrinted:
    @pytest.mark.parametrize(
        ("text", "value", "half"),
        [
            ("46.7", 46.7, 0.05),
            ("−0.5418", -0.5418, 5e-5),
            ("3.9·10⁶", 3.9e6, 5e4),
            ("388000", 388000, 500),  # to three digits or more
            ("108", 108, 0.5),
        ],
    )
    def test_a_number_with_its_last_digit(self, text, value, half):
        found = Printed.read(text)
        assert (found.value, found.half) == pytest.approx((value, half))

    @pytest.mark.parametrize("text", ["", "–", "normal", "4.1 rpm"])
    def test_what_is_no_number(self, text):
        assert Printed.read(text) is None

    def test_roundings_go_through_products_and_quotients(self):
        length, width = Printed(2.0, 0.05), Printed(30.0, 0.5)
        assert (length * width).agrees(Printed(61.9))
        assert not (length * width).agrees(Printed(63.0))
        assert (width / length).agrees(Printed(15.6))
        assert not (width / length).agrees(Printed(16.0))


def test_tables_are_read_as_they_are_printed(document):
    holzer = table(document, "Holzer")
    assert [row.text("Station") for row in holzer.rows] == ["a", "b"]
    assert holzer.units[holzer.heads.index("Sum")] == "kN·m"
    own, total = (holzer.rows[0].number(head) for head in (r"$J\omega^{2}\theta$", "Sum"))
    assert own.value < total.value == pytest.approx(25.5e6, rel=1e-2)
    assert any(note.startswith("Of J, half of each adjacent shaft") for note in table(document, "Masses").notes)


def test_a_right_document_has_no_faults(document):
    assert document_faults(document) == []
    needed = (
        "Verdict on every",
        "Operating instructions",
        "Masses",
        "Holzer",
        "Critical speeds",
        "Components",
        "along",
    )
    assert all(table(document, words).rows for words in needed)


def changed(document, words, head, row, change):
    """Document in which one cell of the table with these words in its caption has another number."""
    lines = document.splitlines()
    at = next(place for place, line in enumerate(lines) if line.startswith("**Table") and words in line)
    found = table(document, words)
    place = at + 4 + [one for one, line in enumerate(lines[at + 4 :]) if not line.startswith("| **")][row]
    cells = lines[place].split("|")
    column = found.heads.index(head) + 1
    cells[column] = f" {change(cells[column].strip())} "
    lines[place] = "|".join(cells)
    return "\n".join(lines)


def other_digit(text):
    """A number whose second digit is another one."""
    at = next(place for place, letter in enumerate(text) if letter.isdigit() and text[:place].strip("−0."))
    return f"{text[:at]}{(int(text[at]) + 3) % 10}{text[at + 1 :]}"


@pytest.mark.parametrize(
    ("words", "head", "row", "fault"),
    [
        ("Holzer", r"$J\omega^{2}\theta$", 0, "J omega^2 theta of a"),
        ("Holzer", "Shafts", 0, "sum of torques at a"),
        ("Holzer", "Twist", 0, "torque behind a"),
        ("Holzer", r"$\theta$", 1, "theta beyond a"),
        ("Holzer", "$J$", 1, "J of b"),
        ("Masses", "$J$", -1, "sum of $J$"),
        ("Verdict on every", "Utilisation", 0, "utilisation of line"),
        ("Verdict on every", "Value", 0, "value of line"),
        ("in their worst condition", "Worst", 0, "value of line"),
        ("in their worst condition", "Used", 0, "utilisation of line"),
        ("Components in normal", "Used", 0, "utilisation of line"),
        ("Critical speeds in normal", "All orders", 0, "utilisation of teeth"),
        ("along the line", "Power", 0, "power at line"),
        ("Natural frequencies", "Undamped", 0, "mode 1"),
        ("Critical speeds", "Critical speed", 0, "distance of teeth"),
    ],
)
def test_a_wrong_digit_is_noticed(document, words, head, row, fault):
    wrong = changed(document, words, head, row % len(table(document, words).rows), other_digit)
    assert wrong != document
    assert any(fault in one for one in document_faults(wrong)), document_faults(wrong)


def test_a_lumped_table_is_noticed(document):
    """Halves of the shaft at its ends, the frequency still that of the solver: 28.5 MN m for 25.5."""
    lumped = re.sub(r"^\| a \| 10 \|", "| a | 14.5 |", document, flags=re.MULTILINE)
    assert any("J omega^2 theta of a" in one for one in document_faults(lumped))


def test_a_speed_outside_of_the_range_is_noticed(document):
    wrong = changed(document, "Verdict on every", "Speed", 0, lambda _: "3100")
    assert any("rpm of line" in one and "is not in" in one for one in document_faults(wrong))


def test_two_units_of_a_component_are_noticed(document):
    wrong = changed(document, "in their worst condition", "Unit", 0, lambda _: "N·m")
    assert any("line is told in N·m, kN·m" in one for one in document_faults(wrong))


def test_a_margin_wrongly_called_kept_is_noticed():
    text = (
        "**Table 1** Separation margins\n\n| Mode | Margin \\[%\\] | Required \\[%\\] | Margin kept |\n|---|---:|---:|---|\n"
        "| 1 | 7.2 | 10 | yes |\n| 2 | 12 | 10 | yes |\n"
    )
    assert document_faults(text) == ["Separation margins: margin of 7.2 ± 0.05 against 10 ± 0.5 is called yes"]


CRITICALS = """**Table 1** Critical speeds in normal operation

| Order | Critical speed \\[rpm\\] |
|---|---:|
| **Mode 5, undamped 87.0 Hz** | |
| engine 7 | 746.0 |

{note}

**Table 2** Components in normal operation

| Component | Place | Speed \\[rpm\\] | Made by |
|---|---|---:|---|
| teeth | peak | 746.0 | {maker} |
| teeth | peak | {speed} | |
"""


@pytest.mark.parametrize(
    ("note", "maker", "speed", "faults"),
    [
        ("", "engine 7, mode 5", "752.2", []),
        ("Small: engine 8, mode 5 at 652.7.", "engine 8, mode 5", "752.2", []),
        ("", "engine 8, mode 5", "752.2", ["engine 8, mode 5 makes a peak at 746.0 rpm and is no critical speed of the table"]),
        ("", "engine 7", "746.0", ["Components in normal operation: teeth at 746.0 rpm stands twice"]),
    ],
)  # fmt: skip
def test_peaks_without_a_critical_speed_and_rows_that_stand_twice_are_noticed(note, maker, speed, faults):
    assert document_faults(CRITICALS.format(note=note, maker=maker, speed=speed)) == faults


@pytest.mark.parametrize(
    ("told", "faults"),
    [("engine 7, mode 5: +6.6 %", 0), ("engine 8, mode 5: +6.6 %", 1), ("engine 7, mode 5: +5.6 %", 1)],
)
def test_distances_of_critical_speeds_are_complete_and_right(told, faults):
    text = CRITICALS.format(note="", maker="", speed="752.2")
    rated = f"rated speed 700 rpm\n\nDistance of the critical speeds from rated speed, 700 rpm: {told}.\n\n"
    assert len(document_faults(rated + text)) == faults


PLAN = """**Table 1** Components at rated speed in normal operation, full, and in their worst condition

| Component | Unit | At rated |
|---|---|---:|
| line | N/mm² | 2.085 |

**Table 2** Torque by strain gauges, line; condition {condition}

| Speed \\[rpm\\] | What it is | Half range \\[N/mm²\\] | Judged \\[N/mm²\\] |
|---:|---|---:|---:|
| 746.0 | Peak of order 7 | 2.102 | 2.1022 |
| 750.0 | Rated | 2.051 | {judged} |
"""


@pytest.mark.parametrize(
    ("condition", "judged", "faults"), [("full", "2.0846", 0), ("full", "2.0510", 1), ("half", "1.0423", 0)]
)
def test_two_stresses_at_rated_speed_are_noticed(condition, judged, faults):
    assert len(document_faults(PLAN.format(condition=condition, judged=judged))) == faults


CONDITIONS = """**Table 1** Components at rated speed in normal operation, full, and in their worst condition

| Component | Unit | At rated | Allowed at rated |
|---|---|---:|---:|
| rubber | kN·m | 3.812 | 15 |
| rubber | kN·m | 38.2 | 50 |

**Table 2** Components at rated speed, 750 rpm, by condition

| Condition | rubber $T_{KW}$, kN·m | Used most \\[%\\] |
|---|---:|---:|
| Allowed | ALLOWED | |
| full | VALUE | 25.4 |
| misfire | 5.77 | 38.5 |
"""


@pytest.mark.parametrize(("allowed", "value", "faults"), [("15", "3.81", 0), ("15", "3.9", 1), ("18", "3.81", 1)])
def test_two_values_at_rated_speed_are_noticed(allowed, value, faults):
    assert len(document_faults(CONDITIONS.replace("ALLOWED", allowed).replace("VALUE", value))) == faults
