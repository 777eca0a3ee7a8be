"""Parameters that follow speed, load and mean torque: against models with the numbers put in by hand."""

from fractions import Fraction

import numpy as np
import pytest

import torsionnet as tn

RPM = np.pi / 30
SHIP = """torsionnet: 1
name: ship
parameters:
  k_cpl: {k_cpl}
  c_prop: {c_prop}
{more}
elements:
  flywheel: {{type: inertia, node: fly, inertia: 1000 kg*m^2}}
  coupling: {{type: spring, nodes: [fly, pin], stiffness: k_cpl, damping: 400 N*m*s/rad}}
  mesh: {{type: gear, nodes: [pin, wheel], ratio: -5}}
  wheel: {{type: inertia, node: wheel, inertia: 640 kg*m^2}}
  prop_shaft: {{type: shaft, nodes: [wheel, prop], outer_diameter: 345 mm, length: 7.2 m}}
  propeller: {{type: inertia, node: prop, inertia: 7936 kg*m^2}}
  prop_damp: {{type: damper, nodes: [prop, ground], damping: c_prop}}
speeds: {{of: fly, range: 400..750 rpm, step: 50 rpm, rated: 750 rpm}}
load: {{absorbed_at: prop, power: 3000 kW, torque_exponent: 2, driven_by: {{fly: 1}}}}
excitations:
  engine: {{type: harmonic, node: fly, orders: {{0.5: {{amplitude: 1 kN*m}}, 3: {{amplitude: 8 kN*m, phase: 20 deg}}}}}}
"""
K, C = "0.3 MN*m/rad", "37 kN*m*s/rad"
K_TABLE = (
    "{by: mean_torque, of: coupling, table: {0 kN*m: 0.2 MN*m/rad, 20 kN*m: 0.25 MN*m/rad, 40 kN*m: 0.4 MN*m/rad}}"
)
C_TABLE = "{by: speed, of: prop, table: {60 rpm: 15 kN*m*s/rad, 160 rpm: 40 kN*m*s/rad}}"
ARCHER = "  Q: {by: load, of: prop}\n  n: {by: speed, of: prop}"


def ship(k_cpl=K, c_prop=C, more=""):
    return tn.loads(SHIP.format(k_cpl=k_cpl, c_prop=c_prop, more=more))


def coupling_stiffness(rpm):
    torque = 3e6 / (750 * RPM) * (rpm / 750) ** 2
    return np.interp(torque, [0, 20e3, 40e3], [0.2e6, 0.25e6, 0.4e6])


class TestOrderResponse:
    OUTPUTS = ("torque(coupling)", "torque(prop_damp)", "wheel")

    def agrees(self, rig, numbers):
        run = rig.order_response(self.OUTPUTS)
        for place, rpm in enumerate(run.rpm):
            fixed = ship().configured(**numbers(rpm)).order_response(self.OUTPUTS, speeds=[rpm * RPM])
            assert run.values[place] == pytest.approx(fixed.values[0], rel=1e-10)

    def test_stiffness_by_mean_torque(self):
        self.agrees(ship(K_TABLE), lambda rpm: {"k_cpl": coupling_stiffness(rpm)})

    def test_damping_by_speed(self):
        self.agrees(ship(K, C_TABLE), lambda rpm: {"c_prop": 15e3 + 25e3 * (rpm / 5 - 60) / 100})

    def test_damping_that_is_none_at_some_speeds(self):
        """The damper is there at some speeds alone, and speeds with equal values stand beside others."""
        rows = "80 rpm: 0 N*m*s/rad, 100 rpm: 0 N*m*s/rad, 130 rpm: 20 kN*m*s/rad, 150 rpm: 20 kN*m*s/rad"
        table = f"{{by: speed, of: prop, table: {{{rows}}}}}"
        self.agrees(ship(K, table), lambda rpm: {"c_prop": np.interp(rpm / 5, [80, 100, 130, 150], [0, 0, 20e3, 20e3])})

    def test_stiffness_that_depends_on_the_frequency_too(self):
        """A complex stiffness that follows the speed, where every speed has frequencies of its own."""
        text = SHIP.format(k_cpl=K_TABLE, c_prop=C, more="").replace("type: spring", "type: hysteretic_spring")
        text = text.replace("damping: 400 N*m*s/rad", "loss_factor: 0.18")
        rig, run = tn.loads(text), tn.loads(text).order_response(self.OUTPUTS)
        for place, rpm in enumerate(run.rpm):
            fixed = rig.configured(k_cpl=coupling_stiffness(rpm)).order_response(self.OUTPUTS, speeds=[rpm * RPM])
            assert run.values[place] == pytest.approx(fixed.values[0], rel=1e-10)

    def test_archer_as_an_expression(self):
        """c = a Q/n follows the speed as the load does: with Q ~ n^2, c ~ n."""
        rated = 30 * 3e6 / (150 * RPM) / 150
        rig = ship(K, "30*Q*pi/30/n", ARCHER)
        self.agrees(rig, lambda rpm: {"c_prop": rated * rpm / 750})
        assert rig.parameters["c_prop"] == pytest.approx(rated)

    def test_only_what_follows_the_speed_is_made_again(self):
        """A speed costs the elements that follow it; a float that equals a fraction is another value."""
        rig = ship(K, C_TABLE)
        first, other = (rig.with_operating_values({"c_prop": value}).assembly.kinematics for value in (2e4, 3e4))
        same = {one: first.made[one] is other.made[one] for one in first.made}
        assert [name for name, kept in same.items() if not kept] == ["prop_damp"]
        assert [one.part.damping for one in other.parts if one.element == "prop_damp"] == [3e4]
        exact, rounded = (rig.configured(k_cpl=value).assembly.kinematics for value in (Fraction(300000), 300000.5))
        assert exact.made["coupling"] is not rounded.made["coupling"]

    def test_speeds_of_another_shaft(self):
        rig = ship(K_TABLE)
        run = rig.order_response("torque(coupling)", speeds=[100 * RPM], speed_of="prop")
        same = rig.order_response("torque(coupling)", speeds=[500 * RPM])
        assert run.values == pytest.approx(-same.values, rel=1e-12)  # now prop turns in the positive sense

    def test_both_at_once_and_twist_under_the_mean_torque(self):
        rig = ship(K_TABLE, C_TABLE)
        run = rig.mean_response("twist(coupling)")
        torque = 3e6 / (750 * RPM) * (run.rpm / 750) ** 2
        assert run.values[:, 0] == pytest.approx(torque / coupling_stiffness(run.rpm), rel=1e-12)


class TestAtTheOperatingPoint:
    def test_modes_and_responses_have_the_values_at_rated_speed(self):
        rig, fixed = ship(K_TABLE), ship().configured(k_cpl=coupling_stiffness(750))
        assert rig.modes().eigenvalues == pytest.approx(fixed.modes().eigenvalues)
        pair = ("torque(coupling)", "fly", [3.0])
        assert rig.frequency_response(*pair).values == pytest.approx(fixed.frequency_response(*pair).values)

    def test_modes_name_the_speed_for_which_they_hold(self):
        text = "natural frequencies and damping ratios hold with fly at {} rpm: {} follow the operating point"
        rig = ship(K_TABLE, C_TABLE)
        assert rig.modes().notes == (text.format(750, "k_cpl, c_prop"),)
        assert rig.configured(k_cpl=4e5).modes().table().notes[-1] == text.format(750, "c_prop")
        slow = SHIP.format(k_cpl=K_TABLE, c_prop=C, more="") + "operating_point: {speed: {fly: 500 rpm}}\n"
        assert tn.loads(slow).modes().notes == (text.format(500, "k_cpl"),)
        assert ship().modes().notes == ()
        note = ship(K, C_TABLE).critical_speeds().notes[0]
        assert note.startswith(text.format(750, "c_prop"))

    def test_the_operating_point_may_be_another_speed(self):
        text = SHIP.format(k_cpl=K_TABLE, c_prop=C, more="") + "operating_point: {speed: {fly: 500 rpm}}\n"
        assert tn.loads(text).parameters["k_cpl"] == pytest.approx(coupling_stiffness(500))

    def test_a_configuration_changes_the_load(self):
        text = SHIP.format(k_cpl=K_TABLE, c_prop=C, more="") + "configurations: {load: {half: {load.power: 1.5 MW}}}\n"
        half = tn.loads(text).configured("half")
        assert half.parameters["k_cpl"] == pytest.approx(
            np.interp(1.5e6 / (750 * RPM), [0, 20e3, 40e3], [0.2e6, 0.25e6, 0.4e6])
        )

    def test_a_value_by_hand_holds_at_all_speeds(self):
        rig = ship(K_TABLE).configured(k_cpl=3e5)
        run = rig.order_response("torque(coupling)")
        assert run.values == pytest.approx(ship().order_response("torque(coupling)").values)

    def test_what_it_follows_is_shown(self):
        assert "by mean torque of coupling" in ship(K_TABLE)._repr_html_()

    def test_what_is_written_can_be_read_again(self):
        rig = ship(K_TABLE, "30*Q*pi/30/n", ARCHER)
        assert tn.loads(rig.to_yaml()) == rig
        assert "value" not in rig.to_yaml().split("elements:")[0]


class TestWhatIsWrong:
    @pytest.mark.parametrize(
        ("k_cpl", "what"),
        [
            ("{by: mean_torque, of: coupling, table: {0 kN*m: 1 MN*m/rad, 20 kN*m: 2 MN*m/rad}}",
             r":4:3: .*38197\.2.*750.*out-of-range"),
            ("{by: speed, of: prop, table: {100 rpm: 1 MN*m/rad, 160 rpm: 2 MN*m/rad}}",
             r":4:3: .*80.*400.*out-of-range"),
            ("{by: speed, of: porp, table: {60 rpm: 1 MN*m/rad, 160 rpm: 2 MN*m/rad}}", r':4:26: .*did you mean "prop".*unknown-node'),
            ("{by: mean_torque, of: cuopling}", r':4:32: .*did you mean "coupling".*unknown-element'),
            ("{by: mean_torque}", r":4:3: .*missing-entry"),
            ("{by: speed, of: prop, table: {1 kN*m: 1 MN*m/rad, 2 kN*m: 2 MN*m/rad}}", "begin with a speed"),
            ("{by: speed, of: prop, table: {60 rpm: 1 MN*m/rad}}", "two rows or more"),
            ("{by: speed, of: prop, table: {60 rpm: 1 MN*m/rad, 160 rpm: 2 kg}}", "units of one kind"),
            ("{by: speed, of: prop, table: {60 rpm: 1 MN*m*s/rad, 160 rpm: 2 MN*m*s/rad}}", "stiffness"),
            ("{by: speed, of: prop, value: 3 MN*m/rad}", r":4:32: .*needless-entry"),
            ("{of: prop, value: 3 MN*m/rad}", "of needs by:"),
            ("{by: load, of: wheel, table: {0 kN*m: 1 MN*m/rad, 200 kN*m: 2 MN*m/rad}}", r":4:3: .*unknown-node"),
            ("{by: mean_torque, of: prop_damp, table: {0 kN*m: 1 MN*m/rad, 200 kN*m: 2 MN*m/rad}}", r":4:3: .*indeterminate-torque"),
        ],
    )  # fmt: skip
    def test_is_said_at_its_place(self, k_cpl, what):
        with pytest.raises(tn.ModelError, match=what):
            ship(k_cpl)

    def test_a_shared_torque_cannot_be_followed(self):
        text = SHIP.format(k_cpl=K_TABLE, c_prop=C, more="")
        text = text.replace("  mesh:", "  beside: {type: spring, nodes: [fly, pin], stiffness: 1 MN*m/rad}\n  mesh:")
        with pytest.raises(tn.ModelError, match=r":4:3: .*indeterminate-torque"):
            tn.loads(text)

    def test_a_speed_outside_the_table_is_not_extrapolated(self):
        with pytest.raises(tn.UsageError, match=r"(?s)20.*100.*out-of-range"):
            ship(K, C_TABLE).order_response("torque(coupling)", speeds=[100 * RPM])

    def test_nothing_says_the_speed(self):
        text = SHIP.format(k_cpl=K, c_prop=C_TABLE, more="").replace(", rated: 750 rpm", "").replace(
            "load: {absorbed_at: prop, power: 3000 kW, torque_exponent: 2, driven_by: {fly: 1}}\n", "")  # fmt: skip
        with pytest.raises(tn.ModelError, match="needs the rated speed"):
            tn.loads(text)


def by_vibration(stop="400 kN*m", last="0.5 MN*m/rad"):
    return f"{{by: vibratory_torque, of: coupling, table: {{0 kN*m: 0.3 MN*m/rad, {stop}: {last}}}}}"


class TestVibration:
    def test_value_and_vibration_agree(self):
        """At every speed a model with the settled stiffness vibrates as much as that stiffness belongs to."""
        rig = ship(by_vibration("20 kN*m", "0.2 MN*m/rad"))
        run = rig.order_response("torque(coupling)")
        for place, rpm in enumerate(run.rpm):
            stiffness = 0.3e6 - 0.1e6 * run.half_range[place, 0] / 20e3
            fixed = ship().configured(k_cpl=float(stiffness)).order_response("torque(coupling)", speeds=[rpm * RPM])
            assert run.values[place] == pytest.approx(fixed.values[0], rel=1e-6)
        assert np.ptp(run.half_range) > 100  # or nothing would depend on it

    def test_one_mass_in_closed_form(self):
        """A mass driven above resonance, k = k0 - b T: T = k A/(J w^2 - k) solved by hand, a quadratic."""
        J, w, A, k0, b = 2.0, 100.0, 500.0, 5e3, 2.0
        rig = tn.Drivetrain(
            "mass", [tn.Inertia("J", node="a", inertia=J), tn.Spring("s", nodes=("a", "ground"), stiffness="k")],
            parameters={"k": {"by": "vibratory_torque", "of": "s", "table": {"0 N*m": k0, "1000 N*m": k0 - 1000 * b}}},
            speeds={"of": "a", "list": [w], "rated": w},
            excitations={"e": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": A}}}},
        )  # fmt: skip
        run = rig.order_response("torque(s)")
        # T (J w^2 - k0 + b T) = (k0 - b T) A
        p, q = J * w**2 - k0 + b * A, -k0 * A
        torque = (-p + np.sqrt(p**2 - 4 * b * q)) / (2 * b)
        assert run.half_range[0, 0] == pytest.approx(torque, rel=1e-6)
        assert rig.parameters["k"] == k0  # modes have the value of the smallest vibration

    def test_a_swinging_iteration_settles_in_closed_form(self):
        """Near the resonance the next k is that of now times -1.8: whole steps go to and fro between the table's ends.

        Far above it they do not swing, at the same time.
        """
        J, A, k0, b = 2.0, 1e3, 5e3, 4.0
        speeds = np.sqrt(np.array([6e3, 6e4]) / J)
        rig = tn.Drivetrain(
            "mass", [tn.Inertia("J", node="a", inertia=J), tn.Spring("s", nodes=("a", "ground"), stiffness="k")],
            parameters={"k": {"by": "vibratory_torque", "of": "s", "table": {"0 N*m": k0, "1000 N*m": k0 - 1000 * b}}},
            speeds={"of": "a", "list": list(speeds), "rated": speeds[0]},
            excitations={"e": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": A}}}},
        )  # fmt: skip
        p, q = J * speeds**2 - k0 + b * A, -k0 * A
        torque = (-p + np.sqrt(p**2 - 4 * b * q)) / (2 * b)
        slope = -b * A * J * speeds**2 / (J * speeds**2 - k0 + b * torque) ** 2
        assert slope == pytest.approx([-1.83, -0.08], abs=0.01)
        assert rig.order_response("torque(s)").half_range[:, 0] == pytest.approx(torque, rel=1e-6)

    def test_beyond_the_table(self):
        with pytest.raises(tn.UsageError, match=r"(?s)2497\.52.*650.*beyond-table"):
            ship(by_vibration("1 N*m")).order_response("torque(coupling)")

    def test_peaks_of_single_orders_are_refused(self):
        """One excitation alone makes another vibration, and so another stiffness."""
        rig = ship(by_vibration("20 kN*m", "0.2 MN*m/rad"))
        assert rig.critical_speeds().crossings
        with pytest.raises(tn.UsageError, match="no-solution"):
            rig.critical_speeds("torque(coupling)")

    def test_what_does_not_settle_is_said(self):
        """A stiffness that jumps across the resonance with the vibration has no value that fits in double precision."""
        J, w = 2.0, 100.0
        rows = {"0 N*m": J * w**2 * 1.02, "1000 N*m": J * w**2 * 1.02, "1000.0000000001 N*m": 100.0, "1e6 N*m": 100.0}
        rig = tn.Drivetrain(
            "mass", [tn.Inertia("J", node="a", inertia=J), tn.Spring("s", nodes=("a", "ground"), stiffness="k", damping=1)],
            parameters={"k": {"by": "vibratory_torque", "of": "s", "table": rows}},
            speeds={"of": "a", "list": [w], "rated": w},
            excitations={"e": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": 500.0}}}},
        )  # fmt: skip
        with pytest.raises(tn.UsageError, match=r"(?s)08.*954\.93.*no-solution"):
            rig.order_response("torque(s)")


class TestCriticalSpeeds:
    def test_a_mode_meets_its_order_with_the_stiffness_of_that_speed(self):
        """Two masses with k = k0 (n/n0)^2 over speed in closed form: the mode follows n, and a table is near it."""
        keys = np.linspace(100, 1000, 19)
        rows = {f"{n:g} rpm": 2e5 * (0.25 + 0.75 * n / 1000) for n in keys}
        rig = tn.Drivetrain(
            "two", [tn.Inertia("A", node="a", inertia=20), tn.Inertia("B", node="b", inertia=30),
                    tn.Spring("s", nodes=("a", "b"), stiffness="k")],
            parameters={"k": {"by": "speed", "of": "a", "table": rows}},
            speeds={"of": "a", "range": ["100 rpm", "1000 rpm"], "step": "50 rpm", "rated": "1000 rpm"},
            excitations={"e": {"type": "harmonic", "node": "a", "orders": {2: {"amplitude": 1}}}},
        )  # fmt: skip
        (one,) = rig.critical_speeds().crossings
        # (2 w)^2 = k(w) (1/20 + 1/30), k linear in w: 4 w^2 - c w/w0 * 0.75 - 0.25 c = 0
        c, top = 2e5 / 12, 1000 * RPM
        b = 0.75 * c / top
        expected = (b + np.sqrt(b**2 + 4 * c)) / 8
        assert one.natural_speed == pytest.approx(expected, rel=1e-6)
        assert rig.modes().natural_frequencies[-1] * 2 * np.pi == pytest.approx(np.sqrt(c))
