"""The explore page without its browser: what the server answers is what the library calculates."""

import json
import math
import os
import re
import shlex
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path

import numpy as np
import pytest
from support import campaigns
from support.library_cases import library_cases
from support.patience import PATIENCE

import torsionnet as tn
from torsionnet.app.cli import main
from torsionnet.app.explore import Documents, open_session
from torsionnet.app.explore.answers import answer, response_frequencies
from torsionnet.app.explore.api import QUESTIONS, reply
from torsionnet.app.explore.server import STATIC, pages
from torsionnet.app.explore.session import ResponseChoice, choices, default_pair, read_pair
from torsionnet.app.explore.sliders import sliders
from torsionnet.app.explore.state import RequestError, State, read_state
from torsionnet.io import write_frequency_response
from torsionnet.model.files.value_editing import changed_text, place_of

V_360 = State({"gear": "V"}, {"c_O": "360 N*m*s/rad"}, "theta_1", "T_T", band=(0.5, 50.0))
HALF_TURN = 180.0


@pytest.fixture(scope="module")
def amt():
    return open_session("amt_rig", pairs=[ResponseChoice("theta_1", "T_T")])


class TestAnswers:
    def test_response_is_that_of_the_library(self, amt):
        response = answer(amt, V_360)["response"]
        f = np.array(response["frequencies"])
        expected = tn.load("amt_rig").configured("V", c_O=360).frequency_response("theta_1", "T_T", f)
        assert f[0] == 0.5
        assert f[-1] == 50.0
        np.testing.assert_array_equal(response["magnitude"], expected.magnitude[:, 0, 0])
        turns = (np.array(response["phase"]) - expected.phase[:, 0, 0]) / (2 * HALF_TURN)
        np.testing.assert_allclose(turns, np.rint(turns), atol=1e-12)
        assert response["units"] == {"rad": "rad/(N*m)", "deg": "deg/(N*m)"}
        assert response["scales"] == pytest.approx({"rad": 1, "deg": 180 / math.pi})

    def test_modes_and_the_poles_of_the_cut_rig(self, amt):
        found = answer(amt, V_360)
        rig = tn.load("amt_rig").configured("V", c_O=360)
        for key, modes in (("modes", rig.modes()), ("cut", rig.modes(measured_input="T_T"))):
            np.testing.assert_array_equal(found[key]["natural"], modes.natural_frequencies)
            np.testing.assert_array_equal(found[key]["ratio"], modes.damping_ratios)
            assert found[key]["descriptions"] == list(modes.descriptions)
        assert answer(amt, State(output="theta_1", input="T_M"))["cut"] is None

    @pytest.mark.parametrize("quantity", ["mobility", "accelerance"])
    def test_other_quantities(self, amt, quantity):
        found = answer(amt, State(output="theta_1", input="T_M", quantity=quantity, band=(1.0, 20.0)))["response"]
        rig = tn.load("amt_rig")
        expected = getattr(rig.frequency_response("theta_1", "T_M", found["frequencies"]), quantity)()
        np.testing.assert_array_equal(found["magnitude"], expected.magnitude[:, 0, 0])
        assert found["kind"] == quantity

    def test_a_torque_has_no_other_quantity(self, amt):
        found = answer(amt, State(output="T_T", input="T_M", quantity="mobility"))["response"]
        assert not found["is_motion"]
        assert found["kind"] == "torque ratio"

    @pytest.mark.few(5, 6)
    @pytest.mark.parametrize("name", library_cases())
    def test_every_library_model_has_a_page(self, name):
        session = open_session(name)
        for choice in ({}, *({axis: names[-1]} for axis, names in session.base.axes.items())):
            found = answer(session, State(choice))
            assert "refused" not in found
            assert len(found["parameters"]) == len(session.base.parameters)
            assert json.loads(json.dumps(found, allow_nan=False))

    def test_peaks_are_the_largest_values(self, amt):
        found = answer(amt, V_360)["response"]
        (peak,) = found["peaks"]
        assert peak[1] == max(found["magnitude"])
        exact = (
            tn.load("amt_rig").configured("V", c_O=360).frequency_response("theta_1", "T_T", np.linspace(6, 8, 4001))
        )
        assert peak[1] == pytest.approx(exact.magnitude.max(), rel=1e-3)

    def test_undamped_peaks_have_no_height(self):
        session = open_session("planetary_set")
        found = answer(session, session.start)["response"]
        assert [peak[1] for peak in found["peaks"]] == [None, None]
        assert max(found["magnitude"]) < 1e5 * np.median(found["magnitude"])

    def test_a_light_peak_is_resolved(self):
        rig = tn.load("amt_rig").configured(c_1=0.01, c_M=0, c_B=0, c_O=0.01)
        f = response_frequencies((0.2, 200.0), rig.modes())
        zeta, natural = rig.modes().damping_ratios[0], rig.modes().natural_frequencies[0]
        assert zeta < 0.005
        assert np.sum(np.abs(f - natural) < zeta * natural) > 15

    def test_what_the_model_refuses_is_said_in_its_words(self, amt):
        found = answer(amt, State(values={"k_1": "-3 N*m/rad"}))
        assert [*found] == ["refused"]
        assert found["refused"][0].startswith("dmf stiffness: k_1 = -3: ")
        assert "I_F = -0.27" in answer(amt, State(values={"I_MT": 0.5}))["refused"][0]
        assert '"k_1"' in answer(amt, State(values={"k1": 1}))["refused"][0]
        assert "theta_1" in answer(amt, State(output="theta1"))["refused"][0]
        assert "is no finite number" in answer(amt, State(values={"k_1": "nan"}))["refused"][0]

    def test_warnings_come_to_the_page(self, amt):
        assert answer(amt, V_360)["findings"] == []
        text = amt.text.replace("c_O: {value: 170 N*m*s/rad,", "c_O: {value: 170 N*m*s/rad, bounds: [100, 300],")
        session = open_text(text)
        assert answer(session, V_360)["findings"] == ["c_O = 360 is outside its bounds 100 to 300"]


def open_text(text, name="rig.yaml"):
    """A session of a file that is gone again."""
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, name)
        path.write_bytes(text.encode())
        return open_session(str(path))


class TestSliders:
    def test_units_values_and_ranges(self):
        rig = tn.load("amt_rig")
        found = {one.name: one for one in sliders(rig, rig.configured(k_2="13000"), {"k_2": 13000})}
        k_2, tau, I_F = found["k_2"], found["tau"], found["I_F"]
        assert (k_2.unit, k_2.value, k_2.default, k_2.si, k_2.changed) == ("kN*m/rad", 13.0, 12.3, 13000.0, True)
        assert (k_2.low, k_2.high, k_2.logarithmic) == (pytest.approx(1.23), pytest.approx(123), True)
        assert (tau.unit, tau.shown_unit, tau.expression) == ("", "", "")
        assert (I_F.expression, I_F.shown_unit, I_F.value) == ("I_1 - I_MT", "kg*m^2", pytest.approx(0.152))

    def test_bounds_zero_and_negative(self):
        rig = tn.Drivetrain(
            "x",
            [
                tn.Inertia("a", node="a", inertia="J"),
                tn.Spring("s", nodes=("a", "b"), stiffness="k", damping="c"),
                tn.Gear("g", nodes=("b", "d"), ratio="i"),
                tn.Inertia("e", node="d", inertia=1),
            ],
            parameters={"J": {"value": 2, "bounds": [1, 3]}, "k": 100, "c": 0, "i": -2},
        )
        found = {one.name: one for one in sliders(rig, rig, {})}
        assert (found["J"].low, found["J"].high, found["J"].shown_unit) == (1, 3, "kg*m^2")
        assert (found["c"].low, found["c"].high, found["c"].logarithmic) == (0, 1, False)
        assert (found["i"].low, found["i"].high, found["i"].logarithmic) == (-20, -0.2, True)

    def test_what_an_alternative_makes_of_zero(self):
        rig = tn.load("six_cylinder_diesel")
        eta = sliders(rig, rig, {})[-1]
        assert (eta.name, eta.low, eta.high) == ("eta", 0.0, pytest.approx(0.35))
        text = "{torsionnet: 1, parameters: {k: 9, T: 0}, elements: {J: {type: inertia, node: a, inertia: k}}," + (
            " configurations: {coast: {parameters: {T: -4}}}}"
        )
        load = sliders(coast := tn.loads(text), coast, {})[-1]
        assert (load.name, load.low, load.high) == ("T", 0.0, 40.0)

    def test_a_value_beyond_the_range_widens_it(self):
        rig = tn.load("dmf_rig")
        k_1 = sliders(rig, rig.configured(k_1=1e6), {"k_1": 1e6})[2]
        assert k_1.high == 1000.0


class TestChoices:
    def test_first_response(self):
        assert default_pair(tn.load("amt_rig")) == ResponseChoice("theta_1", "T_M")
        bare = tn.Drivetrain(
            "x", [tn.Inertia("a", node="n", inertia=1), tn.Spring("k", nodes=("n", "ground"), stiffness=1)]
        )
        assert default_pair(bare) == ResponseChoice("n", "n")
        assert "refused" not in answer(open_text(bare.to_yaml()), State())

    def test_groups(self):
        found = choices(tn.load("amt_rig"), [ResponseChoice("torque(half_shaft)", "T_M")])
        assert [group["label"] for group in found["outputs"]] == ["sensors", "asked for", "angles of nodes"]
        assert [group["label"] for group in found["inputs"]] == ["inputs", "measured", "torques on nodes"]
        assert found["measured"] == ["theta_1", "T_T"]

    @pytest.mark.parametrize("text", ["theta_1", "/T_T", "a/b/c", ""])
    def test_what_is_no_response(self, text):
        with pytest.raises(tn.UsageError, match="OUTPUT/INPUT"):
            read_pair(text)

    def test_several_inputs(self):
        session = open_session("wind_turbine_5mw")
        found = answer(session, State(output="rotor_speed", input="shaft_torque", excitation="T_gen"))
        assert found["excitation"] == "T_gen"
        assert "--driven-by T_gen" in found["command"]
        assert answer(session, State(output="rotor_speed", input="shaft_torque"))["excitation"] == "T_aero"


class TestRequests:
    @pytest.mark.parametrize(
        ("body", "said"),
        [
            ("{", "no JSON text"),
            ("[]", "JSON object"),
            ('{"values": {"k_1": NaN}}', "NaN is far outside the values of drivetrains"),
            ('{"values": {"k_1": 1e999}}', "needs a finite number"),
            ('{"values": {"k_1": true}}', "expected a number"),
            ('{"values": {"k_1": [1]}}', "expected a number"),
            ('{"values": [1]}', "object that gives names their values"),
            ('{"choice": {"gear": 5}}', "expected a text"),
            ('{"choise": {}}', 'did you mean "choice"'),
            ('{"output": 5}', "output is a text"),
            ('{"quantity": "mobilty"}', 'did you mean "mobility"'),
            ('{"band": [5, 1]}', "0 < lowest < highest"),
            ('{"band": [0, 1]}', "0 < lowest < highest"),
            ('{"band": ["a", 1]}', "lowest and highest"),
            ('{"values": {}, "values": {}}', "stands twice"),
            ("[" * 50_000, "no JSON text"),
            ('{"values": {"k_1": ' + "9" * 5000 + "}}", "no JSON text"),
        ],
    )
    def test_what_is_no_state(self, amt, body, said):
        with pytest.raises(RequestError) as caught:
            reply(Documents.of(amt), "api/answer", body.encode())
        assert said in str(caught.value)

    def test_bytes_that_are_no_text(self, amt):
        with pytest.raises(RequestError, match="no JSON text"):
            reply(Documents.of(amt), "api/answer", b"\xff\xfe")

    def test_a_state_comes_back_as_it_went(self):
        assert read_state(json.loads(json.dumps(V_360.to_data()))) == V_360

    @pytest.mark.parametrize("question", QUESTIONS)
    def test_every_question_answers_json(self, amt, question):
        assert isinstance(json.loads(reply(Documents.of(amt), question, b"{}")), dict)

    @pytest.mark.parametrize("question", ["api/answer", "api/values"])
    def test_expressions_of_parameters_are_no_slider_values(self, amt, question):
        found = json.loads(reply(Documents.of(amt), question, b'{"values": {"I_1": "2*I_2"}}'))
        assert "expressions" in found["refused"][0]


class TestSaving:
    """The saved file gives the numbers of the page, and keeps what its author wrote."""

    @pytest.mark.few(3, 6)
    @pytest.mark.parametrize("name", library_cases())
    def test_every_library_model_comes_back_with_the_same_numbers(self, name):
        session = open_session(name)
        for configuration in ("", *list(session.base.configurations)[:: campaigns.examples(100, 1)]):
            rig = session.base.configured(configuration)
            free = [one for one in sliders(rig, rig, {}) if not one.expression]
            values = {one.name: f"{1.03 * one.default:.6g} {one.unit}".strip() for one in free}
            state = read_state({"choice": dict(rig._state.choice), "values": values})
            expected = session.base.configured(configuration, **state.values)
            assert (
                tn.loads(session.changed_file_text(state)).configured(configuration).parameters == expected.parameters
            )
            # One copy of a part may need a list where the author gave a value for all; that is written anew.
            own = {name: value for name, value in values.items() if "." not in name}
            text = session.changed_file_text(read_state({"choice": dict(rig._state.choice), "values": own}))
            assert text.count("\n") == session.text.count("\n")  # edited in place

    def test_only_the_values_change(self, amt):
        state = State({"gear": "V"}, {"k_1": "0.5 kN*m/rad", "tau": 3.3})
        before, after = amt.text.splitlines(), amt.changed_file_text(state).splitlines()
        changed = [(old, new) for old, new in zip(before, after, strict=True) if old != new]
        assert changed == [
            (
                "  k_1: {value: 0.46 kN*m/rad, description: DMF arc springs}",
                "  k_1: {value: 0.5 kN*m/rad, description: DMF arc springs}",
            ),
            ("    V:   {tau: 3.26}", "    V:   {tau: 3.3}"),
        ]

    def test_nothing_changed(self, amt):
        assert amt.changed_file_text(State()) == amt.text

    def test_one_axis_without_a_name_comments_and_windows_lines(self):
        text = (
            "torsionnet: 1\r\nname: x  # the rig\r\nparameters:\r\n  J: 2  # as weighed\r\n  k: 3 kN*m/rad\r\n"
            "elements:\r\n  a: {type: inertia, node: a, inertia: J}\r\n"
            "  s: {type: spring, nodes: [a, ground], stiffness: k}\r\n"
            "configurations:\r\n  soft: {k: 1 kN*m/rad}\r\n  heavy: {J: 5}\r\n"
        )
        session = open_text(text)
        saved = session.changed_file_text(State({"configuration": "soft"}, {"k": "2 kN*m/rad", "J": 2.5}))
        assert saved == text.replace("soft: {k: 1 kN", "soft: {k: 2 kN").replace("J: 2  #", "J: 2.5  #")

    def test_a_value_that_others_share_is_written_anew(self):
        text = (
            "{torsionnet: 1, name: x, parameters: {J: &J 2, I: *J}, elements: "
            "{a: {type: inertia, node: a, inertia: J}, b: {type: inertia, node: b, inertia: I}, "
            "s: {type: spring, nodes: [a, b], stiffness: 5}}}"
        )
        saved = open_text(text).changed_file_text(State(values={"J": 3}))
        assert tn.loads(saved).parameters == {"J": 3.0, "I": 2.0}

    def test_json_stays_json(self):
        data = tn.load("amt_rig").definition.to_data()
        session = open_text(json.dumps(data, indent=1), "rig.json")
        saved = json.loads(session.changed_file_text(State({"gear": "V"}, {"k_1": "0.5 kN*m/rad", "tau": 3.3})))
        assert saved["parameters"]["k_1"]["value"] == "0.5 kN*m/rad"
        assert saved["configurations"]["gear"]["V"] == {"tau": 3.3}

    def test_a_value_goes_to_the_axis_that_sets_it(self):
        text = (
            "{torsionnet: 1, name: x, parameters: {J: 2, I: 3}, elements: {a: {type: inertia, node: a, inertia: J}, "
            "b: {type: inertia, node: b, inertia: I}, s: {type: spring, nodes: [a, b], stiffness: 5}}, "
            "configurations: {one: {p: {J: 3}, o: {}}, two: {q: {I: 4}}}}"
        )
        session = open_text(text)
        both = {"one": "p", "two": "q"}
        assert place_of(session.base.definition, both, "J").axis == "one"
        assert place_of(session.base.definition, {"one": "o", "two": "q"}, "J").axis == ""
        saved = session.changed_file_text(State(both, {"J": 7, "I": 8}))
        assert saved == text.replace("p: {J: 3}", "p: {J: 7}").replace("q: {I: 4}", "q: {I: 8}")

    def test_text_that_does_not_fit_its_definition_is_written_anew(self, amt):
        assert tn.loads(changed_text("[", amt.base.definition, {})) == amt.base


class TestCommandText:
    @pytest.mark.parametrize(
        "state",
        [
            V_360,
            State(output="theta_1", input="T_M", quantity="mobility", band=(1.0, 40.0), angle="deg"),
            State({"gear": "II"}, {"tau": 8}, "T_T", "T_M", band=(2.0, 9.0), decibels=True),
        ],
    )
    def test_it_prints_the_same_numbers(self, amt, state, capsys):
        found = answer(amt, state)
        words = shlex.split(found["command"])
        assert main([*words[1:], "--json"]) == 0
        (printed,) = json.loads(capsys.readouterr().out)
        (pair,) = printed["responses"]
        shown = found["response"]
        at = np.interp(shown["frequencies"], printed["frequencies_Hz"], np.hypot(pair["real"], pair["imag"]))
        np.testing.assert_allclose(at, np.multiply(shown["magnitude"], shown["scales"][state.angle]), rtol=2e-3)

    def test_file_names_are_quoted(self, amt):
        from dataclasses import replace

        session = replace(amt, model="my rig.yaml")
        assert shlex.split(answer(session, V_360)["command"])[2] == "my rig.yaml"


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    f = np.linspace(0.5, 40, 80)
    response = tn.load("amt_rig").configured("V").frequency_response("theta_1", "T_T", f)
    path = tmp_path_factory.mktemp("test") / "gear_V.csv"
    write_frequency_response(response, path)
    return open_session("amt_rig", "V", overlay=path)


class TestOverlay:
    def test_the_page_begins_with_the_response_of_the_test(self, session):
        assert (session.start.output, session.start.input) == ("theta_1", "T_T")

    def test_points(self, session):
        found = session.overlay_for(session.start)
        expected = tn.load("amt_rig").configured("V").frequency_response("theta_1", "T_T", found["frequencies"])
        np.testing.assert_allclose(found["magnitude"], expected.magnitude[:, 0, 0], rtol=1e-9)
        np.testing.assert_allclose(found["phase"], expected.phase[:, 0, 0], atol=1e-7)
        assert all(found["trusted"])
        assert session.overlay_for(State(output="T_T", input="T_M")) is None

    def test_misfit(self, session):
        same = answer(session, session.start)["misfit"]
        assert same["decibels"] == pytest.approx(0, abs=1e-9)
        assert same["frac"] == pytest.approx(1)
        other = answer(session, State(session.start.choice, {"c_O": 360}, band=(1.0, 20.0)))["misfit"]
        f = np.array([one for one in session.overlay_for(session.start)["frequencies"] if 1 <= one <= 20])
        rig = tn.load("amt_rig").configured("V")
        two = [one.frequency_response("theta_1", "T_T", f).values for one in (rig, rig.configured(c_O=360))]
        assert other["lines"] == len(f)
        assert other["decibels"] == pytest.approx(np.sqrt(np.mean((20 * np.log10(abs(two[0] / two[1]))) ** 2)))


def test_static_files_are_all_there_and_ask_for_nothing_else():
    assert {
        "index.html",
        "main.js",
        "style.css",
        "icon.svg",
        "vendor/uPlot.iife.min.js",
        "vendor/uPlot.min.css",
    } <= set(pages())
    own = [path for path in STATIC.rglob("*") if path.suffix in {".html", ".js", ".css"} and "vendor" not in path.parts]
    for path in own:
        text = path.read_text(encoding="utf-8")
        assert "http://" not in text.replace("http://www.w3.org/2000/svg", ""), path
        assert "https://" not in text, path
        assert len(text.splitlines()) <= 500, path
    html = (STATIC / "index.html").read_text(encoding="utf-8")
    assert "style=" not in html
    assert "<script>" not in html
    assert "uPlot 1.6" in (STATIC / "vendor" / "README.md").read_text(encoding="utf-8")
    assert "MIT" in (STATIC / "vendor" / "LICENSE-uPlot.txt").read_text(encoding="utf-8")


def test_text_pane_is_built_from_a_lockfile_without_hosts():
    """The licences name each package in the version that the lockfile has."""
    bundle = STATIC.parent / "bundle"
    lock = (bundle / "package-lock.json").read_text(encoding="utf-8")
    assert "http" not in lock
    licences = (STATIC / "vendor" / "LICENSE-codemirror.txt").read_text(encoding="utf-8")
    packages = {path.removeprefix("node_modules/"): one for path, one in json.loads(lock)["packages"].items() if path}
    bundled = {name: one for name, one in packages.items() if "esbuild" not in name}
    assert "@codemirror/view" in bundled
    for name, one in bundled.items():
        assert f"{name} {one['version']} (MIT)" in licences


class TestCommand:
    @pytest.mark.parametrize(
        ("arguments", "code", "said"),
        [
            (["amt_rog"], 2, "amt_rig.*missing-file"),
            (["amt_rig", "-c", "VI"], 2, '"VI".*unknown-configuration'),
            (["amt_rig", "-c", "all"], 2, "name one with -c"),
            (["amt_rig", "--set", "k_1=-1"], 1, "k_1 = -1.*out-of-range"),
            (["amt_rig", "--tf", "theta_1"], 2, "OUTPUT/INPUT.*wrong-form"),
            (["amt_rig", "--tf", "theta1/T_M"], 2, '"theta_1".*unknown-channel'),
            (["amt_rig", "--band", "5", "1"], 2, "0 < LOW < HIGH"),
            (["amt_rig", "--band", "1", "inf"], 2, r"0 < LOW < HIGH <= 1e\+09 Hz"),
            (["amt_rig", "--overlay", "nothing.csv"], 2, "nothing.csv.*missing-file"),
            (["amt_rig", "--overlay", "nothing.xyz"], 2, "nothing.xyz.*wrong-file"),
        ],
    )
    def test_wrong_use_opens_nothing(self, arguments, code, said, capsys):
        assert main(["explore", "--no-browser", *arguments]) == code
        captured = capsys.readouterr()
        assert captured.out == ""
        assert re.search(said, " ".join(captured.err.split()))
        assert "Traceback" not in captured.err

    def test_a_port_in_use(self, capsys):
        from support.explore_pages import serving

        with serving("dmf_rig") as server:
            port = str(server.server_address[1])
            assert main(["explore", "dmf_rig", "--no-browser", "--port", port]) == 2
        assert f"port {port} cannot be used" in capsys.readouterr().err

    @pytest.mark.slow
    @pytest.mark.skipif(os.name == "nt", reason="Ctrl-C cannot be sent to one process on Windows")
    def test_it_prints_an_address_is_ready_at_once_and_ends_with_ctrl_c(self, pytestconfig):
        import resource

        began = resource.getrusage(resource.RUSAGE_CHILDREN)
        # A run in the background of a shell ignores Ctrl-C, and its children do.
        heard = "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)"
        program = f"{heard}; from torsionnet.app.cli import main; sys.exit(main())"
        done = subprocess.Popen(
            [sys.executable, "-c", program, "explore", "amt_rig", "--no-browser"],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=pytestconfig.rootpath,
        )  # fmt: skip
        try:
            address = done.stdout.readline().strip()
            request = urllib.request.Request(f"{address}api/answer", b"{}", {"Content-Type": "application/json"})
            with urllib.request.urlopen(request, timeout=PATIENCE) as found:
                assert json.load(found)["title"] == "AMT test rig"
            done.send_signal(signal.SIGINT)
            _, messages = done.communicate(timeout=PATIENCE)
        finally:
            done.kill()
        assert done.returncode == 0, messages
        assert "Traceback" not in messages
        ended = resource.getrusage(resource.RUSAGE_CHILDREN)
        assert ended.ru_utime + ended.ru_stime - began.ru_utime - began.ru_stime < 5  # 0.8 s on a quiet machine

    @pytest.mark.slow
    def test_nothing_heavy_on_the_way(self):
        program = (
            "import sys; from torsionnet.app.explore import ExploreServer, open_session;"
            "from torsionnet.app.explore.answers import answer; s = open_session('amt_rig'); answer(s, s.start);"
            "print(sorted({'sympy', 'control', 'matplotlib', 'pandas'} & set(sys.modules)), 'scipy.signal' in sys.modules)"
        )
        found = subprocess.run(
            [sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=PATIENCE
        )
        assert found.stdout.strip() == "[] False"
