"""Margins of loops opened at a controller, the modes that check names, and what is refused in words."""

import math

import numpy as np
import pytest
from click.testing import CliRunner
from support.controlled_plants import Plant

import torsionnet as tn
from torsionnet.app.cli.app import app
from torsionnet.linear.responses.loop_margins import _gains, _phases
from torsionnet.linear.sensitivity.parametric import parametric_response


def speed_loop(gain=-30.0, delay=0.05, inertia=2.0):
    elements = [
        tn.Inertia("rotor", node="a", inertia=inertia),
        tn.Controller("governor", sense={"velocity": "a"}, act="a", law=gain, delay=delay),
    ]
    return tn.Drivetrain("governed", elements)


def shaft_loop(law, sensed="b"):
    return [
        tn.Inertia("one", node="a", inertia=2),
        tn.Spring("shaft", nodes=("a", "b"), stiffness=300, damping=1),
        tn.Inertia("two", node="b", inertia=3),
        tn.Spring("hold", nodes=("b", "ground"), stiffness=100, damping=2),
        tn.Controller("governor", sense={"velocity": sensed}, act="a", law=law),
    ]


class TestMargins:
    def test_delayed_integrator_has_the_margins_of_the_textbook(self):
        """L = g e^(-s tau)/(J s): gain pi J/(2 g tau), phase 90 deg - w tau at w = g/J."""
        margins = speed_loop().loop_margins()
        assert margins.gain_increase.value == pytest.approx(math.pi * 2 / (2 * 30 * 0.05), rel=1e-9)
        assert margins.gain_increase.frequency == pytest.approx(1 / (4 * 0.05), rel=1e-9)
        assert margins.phase.value == pytest.approx(90 - math.degrees(15 * 0.05), rel=1e-9)
        assert margins.phase.frequency == pytest.approx(15 / (2 * math.pi), rel=1e-9)
        assert margins.delay.value == pytest.approx((math.pi / 2 - 0.75) / 15, rel=1e-9)
        assert margins.stable

    @pytest.mark.parametrize(
        ("size", "law"), [(12, -12), (4, {"p": -4, "i": -3}), (60, {"numerator": [-60], "denominator": [0.3, 1]})]
    )
    def test_margins_are_those_of_python_control(self, size, law):
        import control

        elements = shaft_loop(law)
        rig = tn.Drivetrain("plant", elements[:-1], inputs={"T": {"torque": "a"}}, sensors={"w": {"velocity": "b"}})
        H = {12: control.tf([-12], [1]), 4: control.tf([-4, -3], [1, 0]), 60: control.tf([-60], [0.3, 1])}[size]
        loop = -control.tf(rig.to_control()) * H
        gains, phases, distances, _, at_phases, _ = control.stability_margins(loop, returnall=True)
        found = tn.Drivetrain("loop", elements).loop_margins("governor")
        increases = gains[(gains > 1) & (gains < 1e9)]  # beyond is rounding of a numerator without that power
        assert found.gain_increase.value == pytest.approx(min(increases, default=np.nan), rel=1e-6, nan_ok=True)
        real = at_phases > 1e-6  # the rest is rounding of a pole and a zero at rest
        nearest = np.argmin(np.abs(phases[real]))
        assert found.phase.value == pytest.approx(phases[real][nearest], rel=1e-5)
        assert found.phase.frequency == pytest.approx(at_phases[real][nearest] / (2 * math.pi), rel=1e-6)
        assert found.modulus.value == pytest.approx(min(distances), rel=1e-3)

    @pytest.mark.few(1, 4)
    @pytest.mark.parametrize("seed", range(10))
    def test_the_loop_is_that_of_dense_matrices_with_all_others_closed(self, seed):
        plant = Plant(seed, delay=True, forms=("polynomials",))
        last = len(plant.laws) - 1
        margins = plant.rig.loop_margins(f"act{last}")
        out, sensed, kappa = plant.laws.pop()
        for number in np.flatnonzero(margins.frequencies > 0.01)[::97]:
            s = 2j * math.pi * margins.frequencies[number]
            rest = plant.dynamic_stiffness(s)
            expected = -kappa(s) * (sensed @ np.linalg.solve(rest, out))
            assert margins.loop[number] == pytest.approx(expected, rel=1e-7, abs=1e-12)

    @pytest.mark.parametrize("change", ["gain", "delay"])
    def test_a_pole_reaches_the_axis_at_the_margin(self, change):
        margins = speed_loop().loop_margins()
        gain = margins.gain_increase.value if change == "gain" else 1
        delay = margins.delay.value if change == "delay" else 0
        for share, grows in ((0.999, False), (1.001, True)):
            rig = speed_loop(-30 * (gain * share if change == "gain" else 1), 0.05 + delay * share)
            assert (rig.modes().eigenvalues.real > 0).any() == grows

    def test_of_an_unstable_loop_they_are_not_called_margins(self):
        """The gain of the textbook's loop is past its limit: -30 may grow by pi/1.5, and no further."""
        kept, lost = (speed_loop(-30 * factor).loop_margins() for factor in (2.0, 2.2))
        assert kept.stable
        assert not lost.stable
        names = [row[0] for row in lost.table().rows]
        assert "phase margin" in [row[0] for row in kept.table().rows]
        assert not [name for name in names if "margin" in name or "may" in name]
        assert lost.table().columns[0].name == "a pole reaches the axis with"
        assert lost.table().title.endswith("UNSTABLE when closed")
        assert "these are no margins" in str(lost.table().notes)
        factor = lost.table().rows[names.index("gain fallen to the factor")][1]
        assert factor == pytest.approx(math.pi / 1.5 / 2.2, rel=1e-9)

    def test_nyquist_shows_the_curve_and_the_point(self):
        margins = speed_loop().loop_margins()
        plane = tn.plot.nyquist(margins).axes[0]
        drawn = plane.lines[0].get_xydata() @ [1, 1j]
        inside = np.abs(margins.loop) <= 3
        assert drawn[inside] == pytest.approx(margins.loop[inside])
        assert plane.lines[3].get_xydata().tolist() == [[-1, 0]]

    def test_nyquist_shows_phases_as_a_line_where_the_loop_matters(self):
        margins = speed_loop().loop_margins()
        _, size, phase = tn.plot.nyquist(margins).axes
        (f, degrees), low, high = phase.lines[0].get_data(), *phase.get_xlim()
        shown = (margins.frequencies >= low) & (margins.frequencies <= high)
        assert 0 < shown.sum() < len(shown)
        left_out = np.abs(margins.loop[~shown])
        assert np.all((left_out > 100) | (left_out < 0.01))
        assert degrees[~np.isnan(f)] == pytest.approx(np.degrees(np.angle(margins.loop[shown])))
        assert np.nanmax(np.abs(np.diff(degrees))) <= 180
        assert phase.lines[0].get_linestyle() == "-"
        assert size.lines[0].get_xdata()[0] == low

    def test_names(self):
        plant = tn.Drivetrain("plain", shaft_loop(-1)[:-1])
        with pytest.raises(tn.UsageError, match="missing-entry"):
            plant.loop_margins()
        with pytest.raises(tn.UsageError, match=r'(?s)did you mean "governor".*unknown-element'):
            speed_loop().loop_margins("governr")


def test_the_nearest_of_several_crossings_is_the_margin():
    """-4 to -1/4 on the axis: 2 and 1/2 reach -1. On the circle 90 deg at 1 Hz are 1/4 s, 60 deg at 2 Hz 1/12 s."""
    f = np.array([1.0, 2.0, 4.0, 8.0])
    assert [margin.value for margin in _gains(f, np.array([-4, -2, -0.5, -0.25], dtype=complex))] == [2.0, 0.5]
    loop = -np.exp(1j * np.radians([90.0, 60.0, 120.0, -20.0]))
    phase, delay = _phases(f, loop)
    assert (phase.value, phase.frequency) == (pytest.approx(-20), 8)
    assert (delay.value, delay.frequency) == (pytest.approx(1 / 12), 2)


class TestCheck:
    MODEL = """
torsionnet: 1
parameters: {g: -2}
elements:
  one: {type: inertia, node: a, inertia: 2}
  shaft: {type: spring, nodes: [a, b], stiffness: 300, damping: 1}
  two: {type: inertia, node: b, inertia: 3}
  hold: {type: spring, nodes: [b, ground], stiffness: 100, damping: 2}
  governor: {type: controller, sense: {velocity: b}, act: a, law: g}
configurations: {mild: {}, push: {g: 20}, idle: {off: [governor]}}
"""

    def test_the_mode_that_grows_is_named_where_it_does(self, tmp_path):
        path = tmp_path / "m.yaml"
        path.write_text(self.MODEL)
        result = CliRunner().invoke(app, ["check", str(path)])
        assert result.exit_code == 0
        (line,) = [line for line in result.output.splitlines() if ": warning:" in line]
        assert "in configuration push: governor makes the mode at" in line
        assert "unstable, it grows: damping ratio -" in line
        assert "strain in" in line
        assert line.endswith("torsionnet margins MODEL shows by how much [unstable-drivetrain]")

    def test_in_python(self):
        rig = tn.loads(self.MODEL)
        assert not [fault for fault in rig.check() if "unstable" in fault.message]
        (fault,) = [fault for fault in rig.configured("push").check() if "unstable" in fault.message]
        modes = rig.configured("push").modes()
        assert f"{np.abs(modes.eigenvalues[modes.eigenvalues.real > 0][0]) / (2 * math.pi):.4g} Hz" in fault.message
        assert fault.path == ("elements", "governor")

    def test_is_not_asked_where_nothing_feeds(self, monkeypatch):
        from torsionnet.linear.modes import unstable_modes

        monkeypatch.setattr(unstable_modes, "natural_modes", lambda _: pytest.fail("modes were calculated"))
        tn.Drivetrain("plain", shaft_loop(-1)[:-1]).check()


class TestTurnsFreely:
    """The note of check counts the motions that modes count: a torque that follows an angle may hold one."""

    @pytest.mark.parametrize(
        ("sense", "act", "law", "free"),
        [
            ({"velocity": "a"}, "a", {"p": -3}, 1),
            ({"velocity": "a"}, "b", {"p": -3, "i": -2}, 0),
            ({"angle": "a"}, "a", {"numerator": [-1], "denominator": [1, 0]}, 0),
            ({"angle": "b"}, "a", {"numerator": [-1, 0], "denominator": [1, 5]}, 1),
            ({"velocity": "a"}, ("a", "b"), {"p": -3, "i": -2}, 1),
            ({"velocity": ("a", "b")}, "a", {"p": -3, "i": -2}, 1),
        ],
    )
    def test_is_said_where_it_does(self, sense, act, law, free):
        governor = tn.Controller("governor", sense=sense, act=act, law=law)
        rig = tn.Drivetrain("free", [*shaft_loop(-1)[:3], governor])
        said = [fault.message for fault in rig.check() if "turn freely" in fault.message]
        assert len(said) == free
        assert rig.modes().kinds.count("rigid body") == free

    def test_one_of_two_bodies_is_held(self):
        elements = [
            *shaft_loop(-1)[:3],
            tn.Damper("slip", nodes=("b", "c"), damping=2),
            tn.Inertia("load", node="c", inertia=1),
            tn.Controller("first", sense={"velocity": "a"}, act="a", law={"p": -3, "i": -2}),
            tn.Controller("second", sense={"velocity": "b"}, act="b", law={"p": -3, "i": -4}),
        ]
        rig = tn.Drivetrain("two", elements)
        (said,) = [fault.message for fault in rig.check() if "freely" in fault.message]
        assert said.endswith("one rigid-body mode")
        assert rig.modes().kinds.count("rigid body") == 1


class TestRefused:
    """Whatever does not know of controllers says so; nothing leaves them out in silence."""

    RIG = tn.Drivetrain(
        "rig",
        shaft_loop({"p": "g", "i": -3}),
        parameters={"g": -2},
        inputs={"T": {"torque": "a"}},
        sensors={"w": {"velocity": "b"}},
        operating_point={"speed": {"a": 0}, "torque": {"a": 5, "b": -5}},
    )

    @pytest.mark.parametrize(
        "ask",
        [
            lambda rig: rig.holzer_table(1),
            lambda rig: rig.mean_response("torque(shaft)"),
            lambda rig: rig.modes(measured_input="w"),
            lambda rig: parametric_response(rig, "w", "T", [1.0], ["g"]).evaluation([-2.0]),
        ],
    )
    def test_in_words(self, ask):
        with pytest.raises(tn.UsageError, match="unsupported-law"):
            ask(self.RIG)

    def test_equations_of_motion_hold_the_torque(self):
        import sympy

        system = self.RIG.symbolic()
        s, g = sympy.symbols("s g")
        D = system.dynamic_stiffness(s)
        expected = self.RIG.frequency_response(["a", "b"], ["a", "b"], [1.0]).values[0]
        values = {**system.values, s: 2j * math.pi}
        order = [system.coordinates.index(node) for node in ("a", "b")]
        found = np.linalg.inv(np.array(D.subs(values).evalf().tolist(), dtype=complex))[np.ix_(order, order)]
        assert found == pytest.approx(expected, rel=1e-10)
        assert D.has(g)
        assert system.equations()[0].endswith("= T + T_governor")
        (law,) = system.laws()
        assert law.startswith("T_governor = ")
        assert law.endswith("(theta_b)")
        assert "governor:" in CliRunner().invoke(app, ["equations", "-"], input=self.RIG.to_yaml()).output


class TestFaults:
    @pytest.mark.parametrize(
        ("entries", "message"),
        [
            ({"sense": {"torque": "a"}}, r"elements\.c\.sense\.torque: .*unknown-word"),
            ({"sense": {"velocity": ["a", "b", "c"]}}, "expected two nodes"),
            ({"act": "ground"}, "ground does not move"),
            ({"act": ["ground", "a"]}, r"elements\.c\.act\.0: .*grounded-node"),
            ({"law": {"p": "3 kg"}}, "it follows the velocity"),
            ({"law": {"frob": 3}}, r"elements\.c\.law\.frob: .*unknown-word"),
            ({"law": {"p": 3, "numerator": [1]}}, r"elements\.c\.law: .*contradicting-entries"),
            ({"law": {"filter": 3}}, r"elements\.c\.law\.filter: .*missing-entry"),
            ({"law": {"numerator": [1]}}, "needs denominator"),
            ({"law": {"numerator": [1], "denominator": [0]}}, "the denominator is zero"),
            ({"law": {"A": [[1, 2]], "B": [1], "C": [1]}}, r"elements\.c\.law: .*wrong-count"),
            ({"law": "30 N*m"}, r"elements\.c\.law: .*wrong-unit"),
            ({"delay": -1}, r"elements\.c\.delay: .*out-of-range"),
        ],
    )
    def test_are_told(self, entries, message):
        given = {"sense": {"velocity": "a"}, "act": "a", "law": -3, **entries}
        with pytest.raises(tn.ModelError, match=message):
            tn.Drivetrain("x", [tn.Inertia("one", node="a", inertia=1), tn.Controller("c", **given)])

    def test_sampled_laws_are_refused(self):
        import control

        self.test_are_told({"law": control.tf([1], [1, 1], 0.1)}, "continuous in time")

    def test_objects_of_python_control(self):
        import control

        system = -control.tf([900, 3], [1, 12, 400])
        for law in (system, control.ss(system)):
            rig = tn.Drivetrain("loop", shaft_loop(law))
            plain = tn.Drivetrain("loop", shaft_loop({"numerator": [-900, -3], "denominator": [1, 12, 400]}))
            first, second = (one.frequency_response("b", "a", [0.3, 2.0]).values for one in (rig, plain))
            assert first == pytest.approx(second, rel=1e-10)

    def test_a_file_gives_back_what_was_written(self):
        for law in (
            -3,
            {"p": -1, "filter": "10 ms"},
            {"gain": 2, "poles": [-1, [-2, 3]]},
            {"A": [[-1]], "B": [1], "C": [2], "D": 0},
        ):
            rig = tn.Drivetrain("loop", shaft_loop(law))
            assert tn.loads(rig.to_yaml()).definition == rig.definition
