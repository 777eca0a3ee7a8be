"""Mean torques under a load: closed forms, and what a user may write wrong."""

import re

import numpy as np
import pytest
from support.command_line import run

import torsionnet as tn

RPM = np.pi / 30
MARINE = """torsionnet: 1
name: ship
parameters: {{c_prop: 37.3 kN*m*s/rad}}
elements:
  ring: {{type: viscous_damper, node: c1, ring_inertia: 145 kg*m^2, damping: 42 kN*m*s/rad}}
  m1: {{type: inertia, node: c1, inertia: 52 kg*m^2}}
  crank: {{type: spring, nodes: [c1, c2], stiffness: 36 MN*m/rad}}
  m2: {{type: inertia, node: c2, inertia: 52 kg*m^2}}
  k2f: {{type: spring, nodes: [c2, fly], stiffness: 42 MN*m/rad}}
  flywheel: {{type: inertia, node: fly, inertia: 780 kg*m^2}}
  coupling: {{type: hysteretic_spring, nodes: [fly, pin], stiffness: 0.3 MN*m/rad, loss_factor: 0.18}}
  mesh: {{type: gear, nodes: [pin, wheel], ratio: -4.94}}
  wheel: {{type: inertia, node: wheel, inertia: 640 kg*m^2}}
  prop_shaft: {{type: shaft, nodes: [wheel, prop], outer_diameter: 345 mm, length: 7.2 m, segments: 4}}
  propeller: {{type: inertia, node: prop, inertia: 7936 kg*m^2}}
  prop_damp: {{type: damper, nodes: [prop, ground], damping: c_prop}}
speeds: {{of: fly, range: 300..780 rpm, step: 60 rpm, rated: 750 rpm}}
{rest}
"""
LOAD = "load: {absorbed_at: prop, power: 3000 kW, torque_exponent: 2, driven_by: {fly: 1}}"
ENGINE = """excitations:
  engine:
    type: reciprocating_engine
    speed_of: fly
    cycle: 4
    cylinders: {1: c1, 2: c2}
    firing_order: [1, 2]
    bore: 320 mm
    stroke: 400 mm
    rod_length: 840 mm
    reciprocating_mass: 78 kg
"""


def ship(rest=LOAD):
    return tn.loads(MARINE.format(rest=rest))


class TestAgainstClosedForms:
    def test_tail_shaft(self):
        """3000 kW at 750/4.94 rpm are 188.7 kN m, and 23.4 N/mm^2 in 345 mm; the wheel turns backwards."""
        rig = ship()
        at_rated = rig.mean_response(["torque(prop_shaft)", "torque(coupling)"], [750 * RPM])
        torque = 3e6 / (750 * RPM / 4.94)
        assert torque == pytest.approx(188.7e3, rel=1e-4)
        assert at_rated.values[0] == pytest.approx([-torque, torque / 4.94], rel=1e-12)
        assert 16 * torque / (np.pi * 0.345**3) == pytest.approx(23.4e6, rel=1e-3)

    def test_speeds_of_the_model_and_the_propeller_law(self):
        run = ship().mean_response("torque(coupling)")
        assert run.rpm == pytest.approx(np.arange(300, 781, 60))
        assert run.of("torque(coupling)") == pytest.approx(3e6 / (750 * RPM) * (run.rpm / 750) ** 2)

    def test_twist_is_torque_over_stiffness_and_dampers_take_nothing(self):
        run = ship().mean_response(["twist(coupling)", "torque(prop_damp)", "torque(ring)"], [750 * RPM])
        assert run.values[0] == pytest.approx([3e6 / (750 * RPM) / 0.3e6, 0, 0], rel=1e-12)

    def test_the_torque_of_a_rigid_connection(self):
        run = ship().mean_response(["torque(mesh, pin)", "torque(mesh, wheel)"], [750 * RPM])
        torque = 3e6 / (750 * RPM)
        assert run.values[0] == pytest.approx([torque, -4.94 * torque], rel=1e-12)

    def test_an_engine_drives_at_its_cylinders_evenly(self):
        rig = ship(LOAD.replace(", driven_by: {fly: 1}", "") + "\n" + ENGINE)
        run = rig.mean_response(["torque(crank)", "torque(k2f)"], [750 * RPM])
        torque = 3e6 / (750 * RPM)
        assert run.values[0] == pytest.approx([torque / 2, torque], rel=1e-12)

    def test_branches_share_by_stiffness(self):
        """Two parallel shafts of 1 and 3 MN m/rad behind a rigid flange: a quarter and three quarters."""
        elements = [
            tn.Inertia("a", node="a", inertia=1), tn.Inertia("b", node="b", inertia=1),
            tn.Spring("soft", nodes=("a", "b"), stiffness=1e6), tn.HystereticSpring("stiff", nodes=("a", "b"), stiffness=3e6, loss_factor=0.3),
        ]  # fmt: skip
        rig = tn.Drivetrain(
            "parallel", elements, speeds={"of": "a", "list": [10], "rated": 10},
            load={"absorbed_at": "b", "torque": 400, "torque_exponent": 0, "driven_by": {"a": 1}},
        )  # fmt: skip
        run = rig.mean_response(["torque(soft)", "torque(stiff)", "twist(soft)"])
        assert run.values[0] == pytest.approx([100, 300, 1e-4], rel=1e-12)

    def test_two_drivers_and_two_absorbers(self):
        """Powers, not torques, are shared; a generator behind a step-up gear takes its constant torque."""
        elements = [
            tn.Inertia("port", node="p", inertia=1), tn.Inertia("starboard", node="s", inertia=1),
            tn.Gear("gp", nodes=("p", "w"), ratio=-2), tn.Gear("gs", nodes=("s", "w"), ratio=-3),
            tn.Inertia("wheel", node="w", inertia=1), tn.Spring("shaft", nodes=("w", "screw"), stiffness=1e6),
            tn.Inertia("screw", node="screw", inertia=1),
            tn.Gear("gg", nodes=("w", "g"), ratio=-0.25), tn.Inertia("generator", node="g", inertia=1),
        ]  # fmt: skip
        rig = tn.Drivetrain(
            "two engines", elements, speeds={"of": "w", "list": [10], "rated": 20},
            load={
                "absorbers": {"screw": {"torque": "8 kN*m", "torque_exponent": 2},
                              "g": {"over_speed": {"0 rad/s": 100, "80 rad/s": 300}}},
                "driven_by": {"p": 0.6, "s": "40 %"},
            },
        )  # fmt: skip
        run = rig.mean_response(["torque(shaft)", "torque(gp)", "torque(gs)", "torque(gg, g)"])
        power = 2000 * 10 + 200 * 40
        expected = [2000, -0.6 * power / 20, -0.4 * power / 30, -200]
        assert run.values[0] == pytest.approx(expected, rel=1e-12)

    def test_torques_of_the_operating_point_do_without_a_load(self):
        rig = ship("operating_point: {speed: {fly: 750 rpm}, torque: {fly: 38.2 kN*m, prop: 188.7 kN*m}}")
        run = rig.mean_response("torque(prop_shaft)")
        assert (run.reference, run.rpm.tolist()) == ("fly", [pytest.approx(750)])
        assert run.values[0] == pytest.approx([-188.7e3], rel=2e-4)
        with pytest.raises(tn.UsageError, match="missing-entry"):
            rig.mean_response("torque(prop_shaft)", [50])

    def test_the_operating_point_follows_the_load(self):
        rig = ship(LOAD + "\noperating_point: {speed: {fly: 375 rpm}}")
        assert rig.mean_torques["prop"] == pytest.approx(3e6 / (750 * RPM / 4.94) / 4)

    def test_what_rounding_leaves_is_nothing(self):
        assert ship().mean_response("torque(crank)", [750 * RPM]).values.tolist() == [[0.0]]


class TestEveryElement:
    def test_torque_stress_and_power(self):
        state = ship().static_state()
        torque = 3e6 / (750 * RPM / 4.94)
        tail = state.of("prop_shaft")
        assert (tail.torque, tail.power) == pytest.approx((-torque, 3e6))
        assert abs(tail.stress) == pytest.approx(23.4e6, rel=1e-3)
        assert tail.speed == pytest.approx(-750 * RPM / 4.94)
        assert [one.port for one in state.loads if one.element == "mesh"] == ["pin", "wheel"]
        assert {one.element for one in state.loads}.isdisjoint({"m1", "prop_damp"})

    def test_what_is_statically_indeterminate_is_said(self):
        """Two rigid paths side by side: nothing tells what each of them carries."""
        elements = [
            tn.Inertia("a", node="a", inertia=1), tn.Inertia("b", node="b", inertia=1),
            tn.RigidCoupling("one", nodes=("a", "b")), tn.RigidCoupling("two", nodes=("a", "b")),
        ]  # fmt: skip
        load = {"absorbed_at": "b", "torque": 4, "torque_exponent": 0, "driven_by": {"a": 1}}
        state = tn.Drivetrain(
            "double", elements, speeds={"of": "a", "list": [10], "rated": 10}, load=load
        ).static_state()
        assert state.of("one").torque is None
        assert "statically indeterminate" in state.table().to_text()

    def test_command(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "ship.yaml").write_text(
            MARINE.format(rest=LOAD + "\nconfigurations: {load: {half: {load.power: 1.5 MW}}}")
        )
        shown = run("static", "ship.yaml").stdout
        assert re.search(r"^prop_shaft +wheel +-151.822 +-188694 +\S+ +-23.403 +3000$", shown, re.MULTILINE)
        assert "fly at 750 rpm; from outside: prop 188694 N*m, fly 38197.2 N*m" in shown
        run("static", "ship.yaml", "-c", "half", "--speed", "375 rpm", "--csv", "static.csv")
        lines = [
            line for line in (tmp_path / "static.csv").read_text().splitlines() if line.startswith("half,prop_shaft")
        ]
        assert float(lines[0].split(",")[4]) == pytest.approx(-188694 / 8, rel=1e-5)
        assert "Hz counts cycles" in run("static", "ship.yaml", "--speed", "1 Hz", code=2).stderr


class TestConfigurations:
    def test_entries_of_the_load(self):
        rig = ship(LOAD + "\nconfigurations: {load: {half: {load.power: 1500 kW}, full: {}}}")
        values = [
            rig.configured(name).mean_response("torque(coupling)", [78]).values[0, 0] for name in ("half", "full")
        ]
        assert values[1] == pytest.approx(2 * values[0])
        assert tn.loads(rig.to_yaml()) == rig

    def test_one_engine_off(self):
        rig = ship(LOAD + "\nconfigurations: {drive: {shaft: {'load.driven_by': {pin: 1}}, both: {}}}")
        assert rig.configured("shaft").mean_response("torque(coupling)", [78]).values[0, 0] == pytest.approx(
            0, abs=1e-6
        )


class TestWhatIsWrong:
    @pytest.mark.parametrize(
        ("old", "new", "what"),
        [
            ("{fly: 1}", "{fly: 0.9}", r":18:74: .*contradicting-values"),
            ("prop,", "porp,", r":18:21: .*unknown-node"),
            ("{fly: 1}", "{flu: 1}", r':18:75: .*did you mean "fly".*unknown-word'),
            ("3000 kW", "3000 kN*m", r":18:34: .*wrong-unit"),
            (", torque_exponent: 2", "", r":18:1: .*missing-entry"),
            ("power: 3000 kW", "power: 3000 kW, torque: 1 kN*m", "here is both"),
            (", driven_by: {fly: 1}", "", r":18:1: .*missing-entry"),
            ("power: 3000 kW, torque_exponent: 2", "over_speed: {50 rpm: 1, 100 rpm: 2}", r":18:1: .*50.*100.*missing-entry"),
            (", driven_by", ", absorbers: {prop: {power: 1 W, torque_exponent: 2}}, driven_by", "here is both"),
        ],
    )  # fmt: skip
    def test_is_said_at_its_place(self, old, new, what):
        with pytest.raises(tn.ModelError, match=what):
            ship(LOAD.replace(old, new))

    def test_a_rated_speed_is_needed(self):
        text = MARINE.format(rest=LOAD).replace(", rated: 750 rpm", "")
        with pytest.raises(tn.ModelError, match="needs the rated speed"):
            tn.loads(text)

    @pytest.mark.parametrize(
        ("torques", "what"),
        [("{fly: 40 kN*m}", r":19:56: .*38197\.2.*40000.*contradicting-entries"),
         ("{c1: 40 kN*m, prop: 188.7 kN*m}", r":19:42: .*3141\.59.*3000.*contradicting-entries")],
    )  # fmt: skip
    def test_an_operating_point_that_contradicts(self, torques, what):
        with pytest.raises(tn.ModelError, match=what):
            ship(f"{LOAD}\noperating_point: {{speed: {{fly: 750 rpm}}, torque: {torques}}}")

    def test_an_operating_point_that_agrees(self):
        ship(LOAD + "\noperating_point: {speed: {fly: 750 rpm}, torque: {fly: 38.2 kN*m, prop: 188.7 kN*m}}")

    def test_independent_parts(self):
        """A driver of one shaft and an absorber on another one do not hold each other."""
        elements = [
            tn.Inertia("cage", node="cage", inertia=1), tn.Inertia("l", node="l", inertia=1),
            tn.Inertia("r", node="r", inertia=1), tn.Differential("diff", cage="cage", left="l", right="r"),
        ]  # fmt: skip
        load = {"absorbed_at": "l", "power": 1000, "torque_exponent": 0, "driven_by": {"cage": 1}}
        with pytest.raises(tn.ModelError, match=r"leave .* over"):
            tn.Drivetrain("open", elements, speeds={"of": "cage", "list": [10], "rated": 10}, load=load)

    @pytest.mark.parametrize("output", ["fly", "velocity(fly)", "twist(ring)"])
    def test_what_turns_freely_has_no_mean(self, output):
        with pytest.raises(tn.UsageError, match="has no mean value"):
            ship().mean_response(output)

    def test_no_torques(self):
        with pytest.raises(tn.UsageError, match="missing-entry"):
            ship("").mean_response("torque(coupling)")

    @pytest.mark.parametrize(
        ("key", "what"), [("load.powr", "no entry of load"), ("load.power", r":19:44: .*wrong-unit")]
    )
    def test_a_wrong_override(self, key, what):
        with pytest.raises(tn.ModelError, match=what):
            ship(f"{LOAD}\nconfigurations: {{load: {{half: {{{key}: 3 kg}}}}}}")


class TestLoadCutOff:
    """A clutch that some configurations open."""

    TEXT = """torsionnet: 1
name: fan
elements:
  engine: {type: inertia, node: e, inertia: 2}
  clutch: {type: rigid_coupling, nodes: [e, d]}
  disc: {type: inertia, node: d, inertia: 0.1}
  shaft: {type: spring, nodes: [d, p], stiffness: 1e6}
  fan: {type: inertia, node: p, inertia: 1}
speeds: {of: e, list: [50, 100], rated: 100}
load: {absorbed_at: p, power: 100 kW, torque_exponent: 2, driven_by: {e: 1}}
configurations:
  closed: {}
  open: {off: [clutch]}
"""
    WHY = "p turns independently when e turns, so that it can neither drive nor absorb"

    def test_it_is_a_note_that_names_the_configuration(self):
        (note,) = (fault for fault in tn.loads(self.TEXT).check() if fault.path == ("load",))
        assert (note.severity, note.configuration) == ("note", "open")
        assert note.message.startswith(self.WHY)

    def test_the_other_configurations_have_mean_torques(self):
        rig = tn.loads(self.TEXT)
        assert rig.configured("closed").mean_response("torque(shaft)").values[:, 0] == pytest.approx([250, 1000])
        assert rig.configured("open").mean_torques == {}

    def test_there_it_is_said_why_there_are_none(self):
        rig = tn.loads(self.TEXT).configured("open")
        for ask in (rig.static_state, lambda: rig.mean_response("torque(shaft)")):
            with pytest.raises(tn.UsageError, match=self.WHY):
                ask()

    def test_a_load_that_is_cut_off_everywhere_is_an_error(self):
        always = self.TEXT.replace("[e, d]}", "[e, d], enabled: false}")
        with pytest.raises(tn.ModelError, match=self.WHY):
            tn.loads(always)
        with pytest.raises(tn.ModelError, match=self.WHY):
            tn.loads(always[: always.index("configurations")])
        assert tn.loads(always.replace("closed: {}", "closed: {on: [clutch]}")).configured("closed").mean_torques

    def test_all_configurations_at_once(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "fan.yaml").write_text(self.TEXT, encoding="utf-8")
        done = run("static", "fan.yaml", "-c", "all")
        assert "1000" in done.stdout
        assert f"left out open: {self.WHY}" in done.stderr
        assert self.WHY in run("static", "fan.yaml", "-c", "open", code=2).stderr

    def test_the_car(self):
        """Gear III: 200 N m of the engine at 1500 rpm, times half of 1.257 x 3.45 at each wheel."""
        car = tn.load("front_wheel_drive_car")
        state = car.configured("gear=III,clutch=closed").static_state()
        assert {one.element: one.torque for one in state.loads}["left.shaft"] == pytest.approx(
            200 * 1.257 * 3.45 / 2, rel=1e-5
        )
        with pytest.raises(tn.UsageError, match="turns independently"):
            car.configured("gear=N").static_state()
