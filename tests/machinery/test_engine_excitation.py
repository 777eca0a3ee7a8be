"""Engines: traces from files, harmonics, loads, banks, misfires; against closed forms and second ways to the same."""

import itertools
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from support.command_line import run
from support.forced_plants import plant, reference
from support.report_blocks import blocks, of, rows
from support.running_plants import engine as inline_six

import torsionnet as tn
from torsionnet.base.expression_reading import scalar
from torsionnet.machinery.excitations.engine_entries import banked_phases
from torsionnet.machinery.excitations.engine_faults import engine_remarks
from torsionnet.machinery.excitations.pressure_trace import PressureTrace, inertia_harmonics, read_pressure_file
from torsionnet.machinery.excitations.reciprocating_engine import ReciprocatingEngine
from torsionnet.machinery.orders import worst_case as worst_combination
from torsionnet.machinery.orders.worst_case import Contributions, largest_amplitudes
from torsionnet.model.files.value_editing import ValuePlace, changed_text
from torsionnet.report import make_report
from torsionnet.report.document_tree import TableBlock

ORDERS = np.arange(0.5, 12.1, 0.5)
OMEGA = np.array([60.0, 80.0])


def bar(degrees, revolutions=2):
    """A pressure in bar with its peak 8 degrees after firing top dead centre, smooth over the cycle."""
    x = np.radians(np.asarray(degrees, dtype=float) - 8)
    return 2 + 90 * np.exp(40 * (np.cos(x / revolutions) - 1)) + 8 * np.exp(4 * (np.cos(x) - 1))


def engine(count=2, **entries):
    given = {
        "speed_of": "c1", "cycle": 4, "cylinders": {number: f"c{number}" for number in range(1, count + 1)},
        "bore": 0.1, "stroke": 0.12, "rod_length": 0.24, "reciprocating_mass": 0.0, "orders": ORDERS.tolist(),
    }  # fmt: skip
    if "firing_angles" not in entries:
        given["firing_order"] = list(range(1, count + 1))
    return ReciprocatingEngine(**{**given, **entries})


def torque(one, speeds=OMEGA):
    return one.torques(speeds).amplitudes


def csv(folder, name, degrees, pressures, heading="crank angle [deg];pressure [bar]", decimal=".", end="\n"):
    rows = [f"{angle:.8g};{value!r}".replace(".", decimal) for angle, value in zip(degrees, pressures, strict=True)]
    path = folder / name
    path.parent.mkdir(exist_ok=True)
    path.write_text("\n".join([heading, *rows]) + end, encoding="utf-8")
    return path


def exact(trace, revolutions=2, radius=0.06, rod=0.24, bore=0.1):
    """Harmonics of samples in bar at even steps from firing TDC on, by the sum over them, in N m (complex steps)."""
    phi = 2 * np.pi * revolutions * np.arange(len(trace)) / len(trace)
    ratio = radius / rod

    def way(angle):
        return 1 - np.cos(angle) + (1 - np.sqrt(1 - (ratio * np.sin(angle)) ** 2)) / ratio

    area = np.pi * bore**2 / 4
    acting = (np.asarray(trace) - 1) * 1e5 * area * radius * way(phi + 1e-30j).imag / 1e-30
    return np.array([2 / len(phi) * (acting * np.exp(-1j * order * phi)).sum() for order in ORDERS])


class TestFiles:
    """Whatever the step, the ends and the dialect: the harmonics are those of the samples."""

    @pytest.mark.parametrize(
        ("degrees", "options"),
        [
            (np.arange(720), {}),
            (np.arange(721), {"decimal": ","}),
            (np.arange(-360, 360, 0.5), {"heading": "Kurbelwinkel [°KW];Druck [bar]", "decimal": ","}),
            (np.arange(-360, 361), {"heading": "angle (deg CA);p / bar"}),
            (np.arange(0, 720, 1.5), {"heading": "# measured on cylinder 3\nangle;pressure\ndeg;bar"}),
            (np.arange(0, 1440) * 0.5, {"end": ""}),
        ],
    )
    def test_even_steps_are_taken_as_they_are(self, tmp_path, degrees, options):
        path = csv(tmp_path, "p.csv", degrees, bar(degrees).tolist(), **options)
        count = round(720 / (degrees[1] - degrees[0]))
        expected = exact(bar(np.arange(count) * 720 / count))
        found = torque(engine(gas={"fired": path}))[0, :, 0]
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-9 * abs(expected).max())

    def test_steps_that_miss_top_dead_centre_keep_their_phase(self, tmp_path):
        """Samples at 0.25, 1.25, ... degrees: the sums over them, at those angles."""
        at = np.arange(720) + 0.25
        path = csv(tmp_path, "p.csv", at - 360, bar(at - 360).tolist())
        phi = np.radians(at)
        rate = np.sin(phi) * (1 + 0.25 * np.cos(phi) / np.sqrt(1 - (0.25 * np.sin(phi)) ** 2))
        acting = (bar(at) - 1) * 1e5 * np.pi * 0.01 / 4 * 0.06 * rate
        expected = [2 / 720 * (acting * np.exp(-1j * order * phi)).sum() for order in ORDERS]
        one = engine(gas={"fired": path})
        assert torque(one)[0, :, 0] == pytest.approx(expected, rel=1e-9, abs=1e-6)
        again = engine(gas=one.gas.to_data())
        assert torque(again) == pytest.approx(torque(one), rel=1e-12, abs=1e-9)

    def test_uneven_steps_are_interpolated_and_that_is_said(self, tmp_path):
        at = np.r_[np.arange(-360, -30, 1.0), np.arange(-30, 60, 0.2), np.arange(60, 361, 1.0)]
        trace = read_pressure_file(csv(tmp_path, "p.csv", at, bar(at).tolist()))
        assert len(trace.values) == 3600
        assert trace.note == "p.csv has uneven steps; it is interpolated linearly at 3600 steps of a cycle"
        assert np.array(trace.values) / 1e5 == pytest.approx(bar(np.arange(3600) * 0.2), rel=2e-3)

    def test_zero_elsewhere_and_pressures_over_atmosphere(self, tmp_path):
        """0 at gas exchange: firing top dead centre is at 360 degrees."""
        at = np.arange(720)
        usual = csv(tmp_path, "usual.csv", at, bar(at).tolist())
        shifted = csv(tmp_path, "shifted.csv", at, (bar(at - 360) - 1.2).tolist())
        plain = engine(gas={"fired": usual, "crankcase": "1.2 bar"})
        other = engine(gas={"fired": shifted, "zero": "360 deg", "reference": "gauge", "crankcase": "1.2 bar"})
        assert torque(other) == pytest.approx(torque(plain), rel=1e-9, abs=1e-7)

    @pytest.mark.parametrize(
        ("degrees", "pressures", "heading", "line", "text"),
        [
            (np.arange(700), None, None, 701, r":701:1: .*699.*720.*unfit-curve"),
            (np.arange(721), lambda at: bar(at) + at / 50, None, 722, "unfit-curve"),
            (np.arange(720), lambda at: bar(at) + at / 50, None, 721, "unfit-curve"),
            (np.arange(720), None, "angle [deg];pressure", 1, r":1:13: .*missing-unit"),
            (np.arange(720), None, "angle;pressure [bar]", 1, r":1:1: .*missing-unit"),
            (np.arange(720), None, "angle [deg];pressure [Nm]", 1, r":1:13: .*wrong-unit"),
            (np.arange(720), None, "time [s];pressure [bar]", 1, r":1:1: .*wrong-unit"),
            (np.arange(720), None, "angle [deg];p [Pa]", 1, r":1:1: .*100.*0\.001.*implausible-size"),
            (np.r_[0:5, 3, 6:720], None, None, 7, r":7:1: .*unordered-rows"),
            (np.arange(720), lambda at: np.where(at == 7, np.nan, bar(at)), None, 9, "a number is missing"),
            (np.arange(0, 720, 36), None, None, 21, r":21:1: .*20.*unfit-curve"),
        ],
    )  # fmt: skip
    def test_a_fault_is_told_with_its_line(self, tmp_path, degrees, pressures, heading, line, text):
        values = (pressures or bar)(degrees).tolist()
        path = csv(tmp_path, "p.csv", degrees, values, **({"heading": heading} if heading else {}))
        with pytest.raises(tn.ModelError, match=text) as caught:
            engine(gas={"fired": path})
        (fault,) = caught.value.faults
        assert (fault.position.file, fault.position.line) == ("p.csv", line)

    @pytest.mark.parametrize(
        ("content", "text"),
        [
            ("angle [deg];p [bar];T [Nm]\n" + "".join(f"{at};1;2\n" for at in range(99)), r":1:1: .*missing-column"),
            ("".join(f"{at};1\n" for at in range(99)), r":1:1: .*missing-column"),
            ("nothing here\n", r":1:1: .*wrong-file"),
            ("", r":1:1: .*wrong-file"),
            ("angle [deg];p [bar]\n" + "".join(f"{at};{1 if at != 40 else 'x'}\n" for at in range(99)), r":42:4: .*not-a-number"),
        ],
    )  # fmt: skip
    def test_no_trace_at_all(self, tmp_path, content, text):
        path = tmp_path / "p.csv"
        path.write_text(content)
        with pytest.raises(tn.ModelError, match=text):
            read_pressure_file(path)

    def test_a_cycle_of_one_revolution_does_not_suit_a_four_stroke(self, tmp_path):
        path = csv(tmp_path, "p.csv", np.arange(360), bar(np.arange(360), 1).tolist())
        with pytest.raises(tn.ModelError, match=r":1:1: .*360.*720.*unfit-curve"):
            engine(gas={"fired": path})
        assert engine(cycle=2, orders=[1, 2], gas={"fired": path}).gas.fired.revolutions == 1


PLANT = """torsionnet: 1
name: two cylinders
elements:
  throw_1: {type: inertia, node: c1, inertia: 0.1}
  crank: {type: spring, nodes: [c1, c2], stiffness: 1 MN*m/rad}
  throw_2: {type: inertia, node: c2, inertia: 0.1}
speeds: {of: c1, range: 600..1200 rpm, step: 100 rpm}
excitations:
  engine:
    type: reciprocating_engine
    speed_of: c1
    cycle: 4
    cylinders: {1: c1, 2: c2}
    firing_order: [1, 2]
    bore: 100 mm
    stroke: 120 mm
    rod_length: 240 mm
    gas: GAS
"""


def in_file(folder, gas, more=""):
    """A model file beside the traces p100.csv (1.0), p50.csv (0.5) and motored.csv (0.2)."""
    at = np.arange(720)
    for name, share in {"p100": 1.0, "p50": 0.5, "motored": 0.2}.items():
        csv(folder, f"{name}.csv", at, (1 + share * (bar(at) - 1)).tolist())
    path = folder / "plant.yaml"
    path.write_text(PLANT.replace("GAS", gas) + more)
    return path


class TestModelFiles:
    def test_files_are_read_once_and_the_model_is_written_with_their_numbers(self, tmp_path):
        path = in_file(tmp_path, "{fired: p100.csv, motored: motored.csv}")
        rig = tn.load(path)
        for name in ("p100", "motored"):
            (tmp_path / f"{name}.csv").unlink()
        again = tn.loads(rig.to_yaml())
        assert again == rig
        assert torque(again.definition.excitations["engine"]) == pytest.approx(
            torque(rig.definition.excitations["engine"])
        )

    def test_an_alternative_may_name_another_file(self, tmp_path):
        more = "configurations: {load: {full: {}, half: {engine.gas: {fired: p50.csv}}}}\n"
        rig = tn.load(in_file(tmp_path, "{fired: p100.csv}", more))
        full, half = (torque(rig.configured(name).definition.excitations["engine"]) for name in ("full", "half"))
        assert half == pytest.approx(full / 2)
        assert tn.loads(rig.to_yaml()) == rig

    def test_a_changed_parameter_leaves_the_names_of_files(self, tmp_path):
        path = in_file(tmp_path, "{fired: p100.csv}", "parameters: {J: 0.1}\n")
        text = path.read_text().replace("node: c2, inertia: 0.1", "node: c2, inertia: J")
        definition = tn.loads(text, folder=tmp_path).definition
        changed = changed_text(text, definition, {ValuePlace("J"): scalar("0.2 kg*m^2")}, "plant.yaml", tmp_path)
        assert changed == text.replace("{J: 0.1}", "{J: 0.2 kg*m^2}")

    def test_a_folder_below(self, tmp_path):
        csv(tmp_path, "traces/p.csv", np.arange(720), bar(np.arange(720)).tolist())
        assert (
            tn.load(in_file(tmp_path, "{fired: traces/p.csv}")).definition.excitations["engine"].gas.fired.file
            == "p.csv"
        )

    @pytest.mark.parametrize(
        ("name", "kind"),
        [
            ("p10.csv", "missing-file"),
            ("../p100.csv", "forbidden-file"),
            ("traces/../../p100.csv", "forbidden-file"),
            ("/etc/passwd", "forbidden-file"),
            ("'C:\\p100.csv'", "forbidden-file"),
            ("link.csv", "forbidden-file"),
        ],
    )
    def test_files_elsewhere_are_refused(self, tmp_path, name, kind):
        folder = tmp_path / "model"
        folder.mkdir()
        (folder / "link.csv").symlink_to(csv(tmp_path, "p100.csv", np.arange(720), bar(np.arange(720)).tolist()))
        with pytest.raises(tn.ModelError) as caught:
            tn.load(in_file(folder, f"{{fired: {name}}}"))
        (fault,) = caught.value.faults
        assert fault.kind == kind
        assert (fault.position.line, fault.position.column) == (18, 18)

    def test_text_has_no_folder(self, tmp_path):
        text = in_file(tmp_path, "{fired: p100.csv}").read_text()
        with pytest.raises(tn.ModelError, match=r":18:18: .*missing-file"):
            tn.loads(text)
        assert tn.loads(text, folder=tmp_path) == tn.load(tmp_path / "plant.yaml")

    def test_a_fault_in_a_file_comes_with_those_of_the_model(self, tmp_path):
        path = in_file(tmp_path, "{fired: p100.csv}", "inputs: {x: {torque: c9}}\n")
        csv(tmp_path, "p100.csv", np.arange(720), bar(np.arange(720)).tolist(), heading="angle [deg];p")
        with pytest.raises(tn.ModelError) as caught:
            tn.load(path)
        assert {(fault.position.file.split("/")[-1], fault.position.line) for fault in caught.value.faults} == {
            ("p100.csv", 1), ("plant.yaml", 19),
        }  # fmt: skip

    @pytest.mark.parametrize(
        ("old", "new", "where", "text"),
        [
            ("GAS", "{traces: {27: p100.csv}}", (18, 20), r":18:20: .*27.*0\.00027.*missing-unit"),
            ("GAS", "{traces: {27 bar: p100.csv, 9 bar: p50.csv}}", (18, 5), r":18:5: .*missing-entry"),
            ("GAS", "{fired: p100.csv, traces: {9 bar: p50.csv}}", (18, 28), r":18:28: .*contradicting-entries"),
            ("GAS", "{motored: motored.csv}", (18, 5), r":18:5: .*missing-entry"),
            ("GAS", "{harmonics: {0.7: {amplitude: 1 bar, phase: 0 deg}}}", (18, 22), r":18:22: .*0\.5.*0\.7.*contradicting-values"),
            ("GAS", "{harmonics: {1: {amplitude: 1 bar, sine: 1 bar}}}", (18, 23), r":18:23: .*missing-entry"),
            ("GAS", "{fired: p100.csv, zero: tdc}", (18, 34), r":18:34: .*wrong-form"),
            ("GAS", "{fired: p100.csv}\n    misfire: each", (19, 5), "give gas: {motored: compression.csv}"),
            ("GAS", "{fired: p100.csv}\n    load: {power: 10 kW, rated: 900 rpm}", (19, 12), "mechanical_efficiency: 0.92"),
            ("GAS", "{fired: p100.csv}\n    load: {mean_indicated_pressure: 9 bar}", (19, 5), r":19:5: .*needless-entry"),
            ("GAS", "{fired: p100.csv}\n    load: {mean_indicated_pressure: 9}", (19, 37), "write 9 bar"),
            ("GAS", "{fired: p100.csv}\n    factors: {3: 0.8}", (19, 15), r":19:15: .*unknown-name"),
            ("gas: GAS", "spread: 5 %", (18, 5), r":18:5: .*missing-entry"),
            ("gas: GAS", "banks: {A: [1], B: [2]}", (18, 5), "banks need the angle"),
            ("gas: GAS", "banks: {A: [1], B: [3]}\n    bank_angle: 90 deg", (18, 5), "banks miss cylinder 2"),
            ("gas: GAS", "bank_angle: 90 deg", (18, 5), r":18:5: .*missing-entry"),
            ("gas: GAS", "piston_rod: 100 mm", (18, 17), "fills the bore"),
        ],
    )  # fmt: skip
    def test_faults_in_the_model(self, tmp_path, old, new, where, text):
        path = in_file(tmp_path, "{fired: p100.csv}")
        path.write_text(PLANT.replace(old, new))
        with pytest.raises(tn.ModelError, match=text) as caught:
            tn.load(path)
        assert where in [(fault.position.line, fault.position.column) for fault in caught.value.faults]


class TestMeanIndicatedPressure:
    def test_of_the_reference_engine(self):
        """The validation file has that of its pressures, from the work of a cycle."""
        data = reference("forced_inline_six")
        made = data["engine"]
        trace = PressureTrace(tuple(made["pressure"]["pressure_Pa"]))
        found = trace.mean_indicated_pressure(made["stroke"] / 2 / made["rod_length"], 2)
        assert found == pytest.approx(data["mean_indicated_pressure_Pa"], rel=1e-9)

    def test_traces_are_interpolated_to_the_load(self):
        at = np.arange(720)
        low, high = (1 + share * (bar(at) - 1) for share in (0.5, 1.0))
        traces = {"8 bar": (low * 1e5).tolist(), "16 bar": (high * 1e5).tolist()}
        load = {"mean_indicated_pressure": "16 bar", "rated": "100 rad/s", "exponent": 1}
        one = engine(gas={"traces": traces}, load=load)
        found = torque(one, np.array([50.0, 75.0, 100.0]))[:, :, 0]
        for row, share in zip(found, (0.5, 0.75, 1.0), strict=True):
            assert row == pytest.approx(share * exact(high), rel=1e-9, abs=1e-6)

    def test_power_and_efficiency_make_a_mean_indicated_pressure(self):
        """3000 kW at 750 rpm, 0.92, of six cylinders 320 x 400: P_i = p_i V n/2, by hand."""
        traces = {f"{pressure} bar": (bar(np.arange(720)) * 1e5).tolist() for pressure in (1, 40)}
        load = {"power": "3000 kW", "rated": "750 rpm", "exponent": 2, "mechanical_efficiency": 0.92}
        one = engine(6, gas={"traces": traces}, load=load, bore=0.32, stroke=0.4, rod_length=0.84)
        expected = 3e6 / 0.92 / (6 * np.pi * 0.32**2 / 4 * 0.4 * 750 / 60 / 2)
        found = one.indicated_pressures(np.array([375, 750]) * np.pi / 30)
        assert found == pytest.approx([expected / 4, expected], rel=1e-12)
        assert expected == pytest.approx(27.03e5, rel=1e-3)

    def test_nothing_is_extrapolated(self, tmp_path):
        gas = "{traces: {9 bar: p100.csv, 6 bar: p50.csv}}"
        load = "\n    load: {mean_indicated_pressure: 9 bar, rated: 1200 rpm, exponent: 2}"
        with pytest.raises(tn.ModelError, match=r":19:11: .*2\.25.*600 rpm.*beyond-table") as caught:
            tn.load(in_file(tmp_path, gas + load))
        assert [(fault.position.line, fault.position.column) for fault in caught.value.faults] == [(19, 11)]
        with pytest.raises(tn.UsageError, match=r"(?s)10.*beyond-table"):
            torque(engine(gas={"traces": {"9 bar": (bar(np.arange(720)) * 1e5).tolist()}},
                          load={"mean_indicated_pressure": "10 bar"}))  # fmt: skip

    def test_a_trace_that_is_not_what_it_is_said_to_be(self, tmp_path):
        at = np.arange(720)
        true = PressureTrace(tuple(bar(at) * 1e5)).mean_indicated_pressure(0.25, 2) / 1e5
        for said, count in ((true * 1.05, 0), (true * 1.3, 1)):
            rig = tn.load(in_file(tmp_path, f"{{traces: {{{said:.4g} bar: p100.csv}}}}"))
            found = [fault.message for fault in rig.check() if "indicated" in fault.message]
            assert len(found) == count
        assert f"p100.csv: its mean indicated pressure is {true:.4g} bar, but it is given under" in found[0]

    @pytest.mark.parametrize(("ratio", "polytropic"), [(8, 1.3), (12, 1.35), (16, 1.3), (22, 1.38)])
    @pytest.mark.parametrize("count", [72, 361, 720])
    def test_a_list_of_half_a_cycle(self, ratio, polytropic, count):
        """Compression and expansion of air alone: gas exchange for a revolution, or left out."""
        turn = np.radians(np.linspace(-180, 180, count))
        stroke = (1 - np.cos(turn) + (1 - np.sqrt(1 - (0.25 * np.sin(turn)) ** 2)) / 0.25) / 2
        half = 2e5 * (ratio / (1 + (ratio - 1) * stroke)) ** polytropic
        whole = [*np.full(count // 2, 2e5), *half[: -1 if count % 2 else None], *np.full(count // 2, 2e5)]
        for pressures, zero, is_half in ((half, 180, True), (whole, 360, False)):
            given = engine(gas={"fired": list(pressures), "zero": f"{zero * (1 + is_half)} deg"})
            found = [
                fault.message for fault in engine_remarks(given, None) if "too long for a cylinder" in fault.message
            ]
            assert len(found) == is_half

    def test_a_peak_far_from_firing_is_asked_about(self, tmp_path):
        rig = tn.load(in_file(tmp_path, "{fired: p100.csv, zero: 360 deg}"))
        (found,) = [fault for fault in rig.check() if "highest" in fault.message]
        assert found.severity == "warning"
        assert re.search("-352 deg .* zero:", found.message)


class TestHarmonics:
    """Tables of tangential pressure, made of a trace, act as the trace does."""

    AMPLITUDES = exact(bar(np.arange(720))) / (np.pi * 0.01 / 4 * 0.06)  # Pa

    def table(self, form):
        forms = {
            "cosine": lambda t: {"amplitude": abs(t), "phase": np.angle(t)},
            "sine": lambda t: {"amplitude": abs(t), "phase": np.angle(t) + np.pi / 2},
            "parts": lambda t: {"cosine": t.real, "sine": -t.imag},
        }
        return {order: forms[form](t) for order, t in zip(ORDERS.tolist(), self.AMPLITUDES, strict=True)}

    @pytest.mark.parametrize("form", ["cosine", "sine", "parts"])
    def test_every_way_to_write_them(self, form):
        gas = {"harmonics": self.table(form), "phase_of": "sine" if form == "sine" else "cosine"}
        one = engine(gas=gas)
        assert torque(one)[0, :, 0] == pytest.approx(exact(bar(np.arange(720))), rel=1e-9, abs=1e-6)
        again = ReciprocatingEngine(**one.to_data())
        assert torque(again) == pytest.approx(torque(one), rel=1e-12)

    def test_tables_by_mean_indicated_pressure(self):
        gas = {
            "harmonics": {
                "5 bar": {1: {"cosine": "1 bar", "sine": 0}},
                "9 bar": {1: {"cosine": "3 bar", "sine": "2 bar"}},
            }
        }
        one = engine(gas=gas, load={"mean_indicated_pressure": "6 bar"}, orders=[1])
        expected = complex(1.5, -0.5) * 1e5 * np.pi * 0.01 / 4 * 0.06
        assert torque(one)[:, 0, 0] == pytest.approx([expected, expected])
        assert ReciprocatingEngine(**one.to_data()).gas.harmonics == one.gas.harmonics

    def test_misfire_by_harmonics_and_orders_of_a_table(self):
        fired, motored = {0.5: {"cosine": "2 bar", "sine": 0}}, {13: {"cosine": "1 bar", "sine": 0}}
        one = engine(1, gas={"harmonics": fired, "motored_harmonics": motored}, misfire=[1], orders=[])
        found = one.torques(OMEGA)
        assert found.orders[-1] == 13
        assert found.amplitudes[0, -1, 0] == pytest.approx(1e5 * np.pi * 0.01 / 4 * 0.06)
        assert abs(found.amplitudes[0, :-1, 0]).max() == 0


V8 = {"B": [2, 4, 6, 8], "A": [1, 3, 5, 7]}


class TestBanks:
    """Sums of phase vectors over a rigid crank; inertia at top dead centre of each bank."""

    def v8(self, **entries):
        """Cross-plane, 1-8-4-3-6-5-7-2, cylinders 1-2, 3-4, 5-6, 7-8 on a pin each."""
        throws = {number: f"c{(number + 1) // 2}" for number in range(1, 9)}
        given = {
            "cylinders": throws,
            "banks": V8,
            "bank_angle": "90 deg",
            "firing_order": [1, 8, 4, 3, 6, 5, 7, 2],
        }
        return engine(8, **{**given, **entries})

    def sums(self, one, orders, numbers=None):
        angles = np.array([one.firing_phases[number] for number in numbers or one.numbers])
        return [abs(np.exp(-1j * order * angles).sum()) for order in orders]

    def test_cross_plane_v8(self):
        """Evenly every 90 degrees: 8 at order 4 and its multiples; a bank alone fires at 0, 270, 450, 540 degrees."""
        one = self.v8()
        degrees = {number: round(np.degrees(angle)) for number, angle in one.firing_phases.items()}
        assert degrees == {1: 0, 8: 90, 4: 180, 3: 270, 6: 360, 5: 450, 7: 540, 2: 630}
        assert self.sums(one, (0.5, 1, 1.5, 2, 4, 8)) == pytest.approx([0, 0, 0, 0, 8, 8], abs=1e-12)
        alone = [abs(1 + 1j**3 + 1j + 1j**2), abs(1 - 1 - 1 + 1)]  # orders 1 and 2
        assert self.sums(one, (1, 2), V8["A"]) == pytest.approx(alone, abs=1e-12)

    def test_order_from_banks_and_even_firing_agree_where_both_are_possible(self):
        evenly = engine(8, cylinders=self.v8().cylinders, firing_order=[1, 8, 4, 3, 6, 5, 7, 2])
        assert self.v8().firing_phases == pytest.approx(evenly.firing_phases, abs=1e-12)

    @pytest.mark.parametrize(("angle", "between"), [(60, [60] * 12), (45, [45, 75] * 6), (90, [90, 30] * 6)])
    def test_v12_fires_by_its_bank_angle(self, angle, between):
        """Two sixes 120 degrees apart, the second a bank angle later: |6 (1 + e^(-j 3 beta))| at order 3."""
        a, b = [1, 5, 3, 6, 2, 4], [7, 11, 9, 12, 8, 10]
        order = [number for pair in zip(a, b, strict=True) for number in pair]
        one = engine(12, cylinders={number: f"c{(number - 1) % 6 + 1}" for number in range(1, 13)}, firing_order=order,
                     banks={"A": sorted(a), "B": sorted(b)}, bank_angle=f"{angle} deg")  # fmt: skip
        angles = np.degrees([one.firing_phases[number] for number in order])
        assert np.diff([*angles, 720]) == pytest.approx(between)
        assert self.sums(one, [3, 6, 1.5]) == pytest.approx(
            [6 * abs(1 + np.exp(-3j * np.radians(angle))), 6 * abs(1 + np.exp(-6j * np.radians(angle))), 0], abs=1e-9
        )

    def test_the_other_bank_may_fire_a_revolution_later(self):
        """The same V12 with bank B 60 + 360 degrees behind the cylinder on its pin."""
        a, b = [1, 5, 3, 6, 2, 4], [12, 8, 10, 7, 11, 9]
        order = [number for pair in zip(a, b, strict=True) for number in pair]
        throws = {number: f"c{(number - 1) % 6 + 1}" for number in range(1, 13)}
        places = {number: np.pi / 3 * (number > 6) for number in throws}
        found = banked_phases(order, 4 * np.pi, throws, places)
        assert np.degrees(found[7] - found[1]) == pytest.approx(420)
        assert np.diff(np.degrees(list(found.values()))) == pytest.approx([60] * 11)

    def test_inertia_acts_at_top_dead_centre_of_each_bank(self):
        """Two pistons 90 degrees apart on a pin: order 2 cancels, order 4 doubles, order 1 is sqrt(2), by closed form."""
        one = engine(cylinders={1: "c1", 2: "c1"}, banks={"A": [1], "B": [2]}, bank_angle="90 deg",
                     firing_angles={1: 0, 2: "450 deg"}, reciprocating_mass=2.0, orders=[0.5, 1, 2, 4])  # fmt: skip
        single = 2.0 * 0.06**2 * OMEGA[0] ** 2 * abs(inertia_harmonics(0.25, np.array([1.0, 2, 4])))
        found = abs(torque(one)[0, :, 0])
        assert found == pytest.approx([0, np.sqrt(2) * single[0], 0, 2 * single[2]], abs=1e-12)

    def test_inertia_orders(self):
        sines = -inertia_harmonics(0.25, np.arange(1.0, 5.0)).imag
        assert sines == pytest.approx([0.063506, -0.500130, -0.192056, -0.016129], abs=5e-7)

    def test_firing_angles_against_the_crank(self):
        angles = {1: 0, 2: "100 deg"}
        with pytest.raises(tn.ModelError, match=r"firing_angles: .*90.*90.*contradicting-values"):  # fmt: skip
            engine(cylinders={1: "c1", 2: "c1"}, banks={"A": [1], "B": [2]}, bank_angle="90 deg", firing_angles=angles)
        engine(cylinders={1: "c1", 2: "c1"}, firing_angles=angles)

    def test_an_order_that_the_pins_do_not_allow(self):
        """The same order with the banks the other way round."""
        with pytest.raises(tn.ModelError, match=r"firing_order: .*contradicting-values"):
            self.v8(banks={"A": V8["A"], "B": V8["B"]})


class TestWorstCase:
    SPRINGS = ("twist(crank3)", "twist(crank5)", "angle(hub)")

    def rig(self, **entries):
        """The inline six of the references with other entries of its engine."""
        rig = plant(reference("forced_inline_six"))
        data = rig.definition.excitations["engine"].to_data()
        changed = {"engine": {"type": "reciprocating_engine", **data, **entries}}
        return tn.Drivetrain("six", rig.elements.values(), speeds=rig.definition.speeds, excitations=changed)

    def half_ranges(self, **entries):
        return self.rig(**entries).order_response(list(self.SPRINGS)).half_range

    @pytest.mark.slow
    def test_misfire_of_each_cylinder_is_the_worst_of_all(self):
        run = self.rig(misfire="each").order_response(list(self.SPRINGS))
        singly = np.array([self.half_ranges(misfire=[number]) for number in range(1, 7)])
        assert run.half_range == pytest.approx(singly.max(axis=0), rel=1e-9)
        assert run.labels == tuple(f"misfire of cylinder {number}" for number in range(1, 7))
        for place, name in enumerate(self.SPRINGS):
            worst = 1 + singly[:, :, place].argmax(axis=0)
            assert run.cases(name) == tuple(f"misfire of cylinder {number}" for number in worst)
        fourth = run.alternatives["misfire of cylinder 4"]
        assert fourth.values == pytest.approx(self.rig(misfire=[4]).order_response(list(self.SPRINGS)).values, rel=1e-9)
        assert run.largest == pytest.approx(
            abs(np.array([one.values for one in run.alternatives.values()])).max(axis=0)
        )

    @pytest.mark.slow
    def test_spread_against_all_combinations(self):
        run = self.rig(spread="5 %").order_response(list(self.SPRINGS))
        sound = self.rig().order_response(list(self.SPRINGS))
        singly = [self.rig(factors={number: 1.05}).order_response(list(self.SPRINGS)) for number in range(1, 7)]
        corners = [
            replace(sound, values=sound.values + sum(sign * (one.values - sound.values) for sign, one in zip(signs, singly, strict=True)))
            for signs in itertools.product((-1, 1), repeat=6)
        ]  # fmt: skip
        assert run.half_range == pytest.approx(np.array([one.half_range for one in corners]).max(axis=0), rel=1e-6)
        assert run.largest == pytest.approx(np.array([abs(one.values) for one in corners]).max(axis=0), rel=1e-9)
        assert (run.half_range > self.half_ranges()).all()

    def test_spread_behind_a_gear_takes_no_longer(self, monkeypatch):
        """Orders of one shaft repeat with it; that the reference shaft needs 34 turns for it does not matter."""
        elements = [
            tn.Inertia("throw_1", node="c1", inertia=4),
            tn.Spring("crank", nodes=("c1", "c2"), stiffness=4e6, damping=60),
            tn.Inertia("throw_2", node="c2", inertia=4),
            tn.Gear("stage", nodes=("c2", "shaft"), teeth=(17, -61)),
            tn.Inertia("disc", node="shaft", inertia=30),
        ]
        two = inline_six(cylinders={1: "c1", 2: "c2"}, firing_order=[1, 2], spread="5 %")
        rig = tn.Drivetrain("geared", elements, excitations={"engine": two})
        places, inner = [], worst_combination._differences
        monkeypatch.setattr(worst_combination, "_differences", lambda *given: places.append(1) or inner(*given))
        own = rig.order_response("torque(crank)", speeds=[80], speed_of="c1").half_range
        count = len(places)
        assert rig.order_response("torque(crank)", speeds=[80 * 17 / 61], speed_of="shaft").half_range == pytest.approx(
            own
        )
        # Rounding may let one start more or less pass its bound.
        assert len(places) == pytest.approx(2 * count, rel=0.1)

    @pytest.mark.parametrize("share", [0.01, 1.0])
    def test_no_start_from_which_the_largest_difference_is_reached_is_left_out(self, share):
        """Three speeds and two outputs, six deviations; against the differences of all pairs of instants."""
        rng = np.random.default_rng(5)
        turns = np.arange(300) / 300 * 2 * np.pi

        def waves():
            parts = zip(rng.normal(size=(8, 3, 2, 1)), rng.uniform(0, 6, size=(8, 3, 2, 1)), strict=True)
            return sum(size * np.cos(order * turns + phase) for order, (size, phase) in enumerate(parts, start=1))

        base, shares = waves(), share * np.array([waves() for _ in range(6)])
        pairs = base[..., :, None] - base[..., None, :]
        pairs = pairs + np.abs(shares[..., :, None] - shares[..., None, :]).sum(axis=0)
        high, low = worst_combination._highest_and_lowest(base, shares)
        assert np.take_along_axis(
            np.take_along_axis(pairs, high[..., None, None], axis=2), low[..., None, None], axis=3
        )[..., 0, 0] == pytest.approx(pairs[..., ::2, :].max(axis=(2, 3)), rel=0.01)

    @pytest.mark.parametrize("seed", [45, 79, 106, 215])
    def test_one_speed_and_one_output_are_searched_from_the_best_start(self, seed):
        """Waves of which the farthest instant lies between two starts."""
        rng = np.random.default_rng(seed)
        turns = np.arange(64) / 64 * 2 * np.pi
        waves = np.array([
            sum(rng.normal() * np.cos(order * turns + rng.uniform(0, 6)) for order in (8, 5)) for _ in range(3)
        ])  # fmt: skip
        pairs = waves[0][:, None] - waves[0] + np.abs(waves[1:, :, None] - waves[1:, None, :]).sum(axis=0)
        high, low = worst_combination._highest_and_lowest(waves[0][None, None], waves[1:, None, None])
        assert pairs[high.item(), low.item()] >= pairs[::2].max() * (1 - 1e-12)

    @pytest.mark.parametrize("count", [1, 2, 5])
    def test_largest_amplitude_is_that_of_the_best_corner(self, count):
        """Also where contributions are parallel or vanish."""
        rng = np.random.default_rng(count)
        shares = rng.normal(size=(count + 2, 4, 3, 2)) + 1j * rng.normal(size=(count + 2, 4, 3, 2))
        shares[-1], shares[-2, 0] = -2 * shares[0], 0
        values = rng.normal(size=(4, 3, 2)) + 0j
        names = tuple(map(str, range(count + 2)))
        corners = [
            abs(values + np.tensordot(signs, shares, 1)) for signs in itertools.product((-1, 1), repeat=count + 2)
        ]
        found = largest_amplitudes(values, [Contributions("engine", names, slice(0, 3), shares, names)])
        assert found == pytest.approx(np.max(corners, axis=0), rel=1e-12)

    def test_spread_on_top_of_a_misfire(self):
        run = self.rig(misfire="each", spread="3 %").order_response("twist(crank3)")
        worst = int(run.half_range[:, 0].argmax())
        label, up = run.cases()[worst].split("; ")
        factors = {
            number: 1.03 if f"cylinder {number}" in up.split(" up")[0].split(", ") else 0.97 for number in range(1, 7)
        }
        again = self.rig(misfire=[int(label[-1])], factors=factors).order_response("twist(crank3)")
        assert run.half_range[worst, 0] == pytest.approx(again.half_range[worst, 0], rel=1e-9)

    def test_one_weak_cylinder(self):
        data = reference("forced_inline_six")["engine"]["pressure"]
        weak = self.rig(factors={3: 0.8}).definition.excitations["engine"]
        sound = self.rig().definition.excitations["engine"]
        gas_only = self.rig(gas_off=[3]).definition.excitations["engine"]
        assert torque(weak) == pytest.approx(
            torque(gas_only) + 0.8 * (torque(sound) - torque(gas_only)), rel=1e-9, abs=1e-9
        )
        assert len(data["pressure_Pa"]) == 720

    @pytest.mark.slow
    def test_parts_of_the_speeds_do_not_matter(self, monkeypatch):
        whole = self.rig(misfire="each", spread="2 %").order_response("twist(crank3)")
        monkeypatch.setattr("torsionnet.machinery.orders.operating_groups.SPEEDS_PER_BLOCK", 2)
        parts = self.rig(misfire="each", spread="2 %").order_response("twist(crank3)")
        assert parts.values == pytest.approx(whole.values, rel=1e-12)
        assert parts.cases() == whole.cases()
        assert parts.alternatives["misfire of cylinder 2"].values.shape == whole.values.shape

    def test_tables_name_the_case(self):
        run = self.rig(misfire="each").order_response("twist(crank3)")
        worst = int(run.half_range[:, 0].argmax())
        assert f"at {run.rpm[worst]:.6g} rpm: {run.cases()[worst]}" in run.table().to_text()
        assert [row[-1] for row in run.long_table().rows[:: len(run.lines)]] == list(
            run.cases()
        )  # no line meets another

    def test_two_engines_misfire_together(self):
        """Every pair of cylinders is a case."""
        elements = [tn.Inertia("a", node="a", inertia=1), tn.Spring("s", nodes=("a", "b"), stiffness=1e5),
                    tn.Inertia("b", node="b", inertia=2)]  # fmt: skip

        def one(node):
            traces = {"fired": (bar(np.arange(720)) * 1e5).tolist(), "motored": (bar(np.arange(720)) * 2e4).tolist()}
            data = engine(cylinders={1: node, 2: node}, speed_of=node, gas=traces, misfire="each").to_data()
            return {"type": "reciprocating_engine", **data}

        rig = tn.Drivetrain("twins", elements, speeds={"of": "a", "list": [60, 70]},
                            excitations={"port": one("a"), "starboard": one("b")})  # fmt: skip
        run = rig.order_response("twist(s)")
        assert run.labels[1] == "port: misfire of cylinder 1, starboard: misfire of cylinder 2"
        assert len(run.labels) == 4


class TestCompressor:
    def test_double_acting_cylinder(self):
        """Constant pressures: (p_head - p_0) A - (p_crank - p_0) (A - A_rod), times r x' by order."""
        one = ReciprocatingEngine(
            speed_of="c", cycle=2, cylinders={1: "c"}, firing_order=[1], bore=0.2, stroke=0.12, rod_length=0.3,
            piston_rod=0.06, orders=[1, 2], gas={"fired": [9e5] * 360, "crank_end": [4e5] * 360, "crankcase": 1e5},
        )  # fmt: skip
        force = 8e5 * np.pi * 0.01 - 3e5 * np.pi * (0.01 - 0.0009)
        phi = 2 * np.pi * np.arange(4096) / 4096
        rate = np.sin(phi) * (1 + 0.2 * np.cos(phi) / np.sqrt(1 - (0.2 * np.sin(phi)) ** 2))
        expected = [force * 0.06 * 2 / 4096 * (rate * np.exp(-1j * order * phi)).sum() for order in (1, 2)]
        assert torque(one)[0, :, 0] == pytest.approx(expected, rel=1e-9, abs=1e-9)

    def test_a_table_without_injection_says_nothing_of_the_lower_side(self):
        """A trace without injection has the pressure below the piston added to it, a table by order had not."""
        gas = {"fired": [9e5] * 360, "crank_end": [4e5] * 360, "motored_harmonics": {1: {"amplitude": 1e5, "phase": 0}}}
        with pytest.raises(tn.ModelError, match=r"gas\.motored_harmonics: .*needless-entry"):
            ReciprocatingEngine(
                speed_of="c", cycle=2, cylinders={1: "c"}, firing_order=[1], bore=0.2, stroke=0.12, rod_length=0.3,
                gas=gas, misfire=[1],
            )  # fmt: skip


class TestWhereItShows:
    MORE = "sensors: {T: {torque: crank}}\nconfigurations: {firing: {normal: {}, misfire: {engine.misfire: each}}}\n"

    @pytest.fixture(autouse=True)
    def folder(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        in_file(tmp_path, "{fired: p100.csv, motored: motored.csv}", self.MORE)

    def test_command(self):
        shown = run("orders", "plant.yaml", "-c", "misfire", "--output", "torque(crank)").stdout
        assert re.search(
            r"at every speed the worst of 2 cases; at \d+ rpm: (misfire of cylinder [12]|all cases alike)", shown
        )
        data = json.loads(run("orders", "plant.yaml", "-c", "all", "--output", "torque(crank)", "--json").stdout)
        normal, misfire = (one["outputs"][0] for one in data)
        assert normal["cases"] is None
        assert len(misfire["cases"]) == len(misfire["half_range"])

    def test_report(self):
        document = make_report(tn.load("plant.yaml"), sections=["excitations"])
        tables = [
            one for one in of(TableBlock, blocks(document, "excitations")) if "Excitation engine" in str(one.caption)
        ]
        values = {row[0]: row[1] for row in rows(tables[0])}
        assert values["gas: fired"] == "720 pressures of p100.csv, 2.003 to 100 bar"

    def test_report_names_the_worst_cylinder(self):
        document = make_report(tn.load("plant.yaml"), sections=["orders"])
        tables = [
            one for one in of(TableBlock, blocks(document, "orders")) if "largest over the speeds" in str(one.caption)
        ]
        shown = [row[0] for row in rows(tables[0])]
        assert shown[0] == "normal"
        assert re.fullmatch(r"misfire: (misfire of cylinder [12]|all cases alike)", shown[1])


class TestPower:
    def test_power_is_that_of_one_case(self):
        """Outputs of different worst cylinders are never multiplied with each other."""
        data = reference("forced_inline_six")
        rig = TestWorstCase().rig(misfire="each")
        name = next(spring["name"] for spring in data["model"]["springs"] if spring.get("damping"))
        singly = [TestWorstCase().rig(misfire=[number]).dissipated_power(name).values for number in range(1, 7)]
        assert rig.dissipated_power(name).values == pytest.approx(np.max(singly, axis=0), rel=1e-9)
        with pytest.warns(tn.TorsionnetWarning, match="spread of cylinders"):
            spread = TestWorstCase().rig(spread="5 %").dissipated_power(name).values
        assert spread == pytest.approx(TestWorstCase().rig().dissipated_power(name).values, rel=1e-12)
