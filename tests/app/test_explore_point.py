"""The operating point as sliders of the explore page, and as settings of a model, against closed forms."""

import json
import shlex

import numpy as np
import pytest
from support.explore_texts import CRANK, ENGINE, GEARS, LINE, MOWER, RATIO, VEHICLE, WHEEL

import torsionnet as tn
from torsionnet.app.cli import main
from torsionnet.app.explore import open_session
from torsionnet.app.explore.answers import answer
from torsionnet.app.explore.state import State
from torsionnet.base.errors import ModelError, UsageError

FIRST, SECOND, CORNER = 450.0, 1800.0, 0.1
"""Stiffness of both stages in N m/rad, and the twist in rad at which the second one begins, under 45 N m."""

TAKE_OFF = LINE.replace("wheel: -80 N*m}", "wheel: -60 N*m, mower: -5 N*m}").replace(
    "operating_point",
    """  pto: {type: spring, nodes: [box, mower], stiffness: 6000}
  mower: {type: inertia, node: mower, inertia: 0.4 kg*m^2}
operating_point""",
)
SHIP = """torsionnet: 1
name: ship
elements:
  engine: {type: inertia, node: fly, inertia: 50 kg*m^2}
  coupling: {type: spring, nodes: [fly, prop], stages: [{stiffness: 20 kN*m/rad, to: 0.1 rad}, {stiffness: 80 kN*m/rad}]}
  propeller: {type: inertia, node: prop, inertia: 200 kg*m^2}
speeds: {of: fly, range: 300..1000 rpm, step: 50 rpm, rated: 900 rpm}
load: {absorbed_at: prop, power: 300 kW, torque_exponent: 2, driven_by: {fly: 1}}
"""


def opened(text, **options):
    return open_session("line.yaml", text=text, **options)


def rows(found):
    return {one["name"]: one for one in found["operating_point"]}


def vibration(stiffness, first=ENGINE, second=VEHICLE / RATIO**2):
    """The natural frequency in Hz of two inertias with a spring between them."""
    return np.sqrt(stiffness * (1 / first + 1 / second)) / (2 * np.pi)


class TestSliders:
    def test_of_the_operating_point_of_the_file(self):
        session = opened(LINE)
        found = rows(answer(session, session.start))
        assert list(found) == [CRANK, WHEEL]
        wheel = found[WHEEL]
        assert [wheel[key] for key in ("value", "default", "low", "high", "unit")] == [-80, -80, -160, 80, "N*m"]
        assert not wheel["changed"]
        labels = [(row["name"], row["label"]) for row in session.describe()["operating_point"]["rows"]]
        assert labels == [(CRANK, "torque on crank"), (WHEEL, "torque on wheel")]

    @pytest.mark.parametrize(("torque", "stiffness"), [(20, FIRST), (44.9, FIRST), (45.1, SECOND), (-60, SECOND)])
    def test_modes_follow_the_torque(self, torque, stiffness):
        found = answer(opened(LINE), State(values={CRANK: f"{torque} N*m"}))
        assert found["modes"]["natural"][1] == pytest.approx(vibration(stiffness), rel=1e-12)
        assert rows(found)[WHEEL]["value"] == pytest.approx(-RATIO * torque, rel=1e-11)

    def test_response_follows_the_torque(self):
        state = State(values={CRANK: 90}, output="crank", input="crank", band=(2.0, 30.0))
        response = answer(opened(LINE), state)["response"]
        w = 2 * np.pi * np.array(response["frequencies"])
        second = VEHICLE / RATIO**2
        expected = (SECOND - second * w**2) / (w**2 * (ENGINE * second * w**2 - SECOND * (ENGINE + second)))
        np.testing.assert_allclose(response["magnitude"], np.abs(expected), rtol=1e-8)

    def test_torques_notchange_by_one_factor(self):
        found = rows(answer(opened(TAKE_OFF), State(values={CRANK: "40 N*m"})))
        assert [found[name]["value"] for name in (CRANK, WHEEL, MOWER)] == pytest.approx([40, -120, -10], rel=1e-11)
        assert [found[name]["remark"] != "" for name in (CRANK, WHEEL, MOWER)] == [False, True, True]
        assert [found[name]["changed"] for name in (CRANK, WHEEL, MOWER)] == [True, False, False]

    def test_only_those_that_nobody_hasfollow(self):
        found = rows(answer(opened(TAKE_OFF), State(values={CRANK: 40, MOWER: -10})))
        assert found[WHEEL]["value"] == pytest.approx(-120, rel=1e-11)
        found = rows(answer(opened(TAKE_OFF), State(values={CRANK: 40, WHEEL: -40})))
        assert found[MOWER]["value"] == pytest.approx(-30, rel=1e-11)

    def test_torques_that_cancel_take_the_smallest_relative_changes(self):
        text = TAKE_OFF.replace("crank: 20 N*m, wheel: -60 N*m, mower: -5 N*m", "crank: 0, wheel: -80, mower: 20")
        found = rows(answer(opened(text), State(values={CRANK: 8})))
        wheel, mower = found[WHEEL]["value"], found[MOWER]["value"]
        assert 8 + wheel / RATIO + mower == pytest.approx(0, abs=1e-9)
        assert (wheel + 80) / -80 == pytest.approx(-(mower - 20) / 20, rel=1e-9)  # both shares in the balance are 20
        assert mower == pytest.approx(16, rel=1e-9)

    def test_out_of_balance_the_message_and_the_sliders_come(self):
        found = answer(opened(LINE), State(values={CRANK: 20, WHEEL: -100}))
        (said,) = found["refused"]
        assert said.startswith("operating point torque: ")
        assert "crank 20 N*m, wheel -100 N*m" in said
        assert "-5 N*m" in said
        assert rows(found)[WHEEL]["value"] == -100
        assert rows(found)[WHEEL]["changed"]

    def test_a_file_out_of_balance_has_a_page(self):
        session = opened(LINE.replace("-80", "-8"))
        found = answer(session, session.start)
        assert "leave 18 N*m over" in found["refused"][0]
        assert rows(found)[WHEEL]["value"] == -8
        assert "refused" not in answer(session, State(values={CRANK: 20, WHEEL: -80}))
        found = rows(answer(session, State(values={CRANK: 3})))
        assert found[WHEEL]["value"] == pytest.approx(-12, rel=1e-11)

    def test_what_rounding_leaves_over_stays(self):
        found = rows(answer(opened(LINE.replace("-80", "-79")), State(values={CRANK: 40})))
        assert found[WHEEL]["value"] == pytest.approx(-159, rel=1e-11)

    def test_a_configuration_out_of_balance_does_not_close_the_page(self):
        session = opened(LINE + GEARS.replace("-400", "-300"))
        assert "refused" not in answer(session, session.start)
        assert "leave 25 N*m over" in answer(session, State({"configuration": "low"}))["refused"][0]

    def test_a_configuration_has_its_own_torques(self):
        session = opened(LINE + GEARS)
        found = answer(session, State({"configuration": "low"}))
        assert [one["default"] for one in rows(found).values()] == [100, -400]
        assert found["modes"]["natural"][1] == pytest.approx(vibration(SECOND), rel=1e-12)

    def test_a_slider_that_a_configuration_lacks_does_nothing_there(self):
        session, box = opened(LINE + GEARS.replace("wheel: -400", "box: 0, wheel: -400")), "operating_point.torque.box"
        assert box in {row["name"] for row in session.describe()["operating_point"]["rows"]}
        assert answer(session, State(values={box: 30})) == answer(session, State())
        found = rows(answer(session, State({"configuration": "low"}, {box: -20})))
        assert found[box]["value"] == -20
        assert found[CRANK]["value"] + found[WHEEL]["value"] / RATIO == pytest.approx(20, rel=1e-9)
        with pytest.raises(ModelError, match=r"operating_point\.torque\.bax: .*unknown-node"):
            session.model_for(State(values={"operating_point.torque.bax": 30}))

    def test_torques_by_parameters_follow_these(self):
        text = LINE.replace("  J:", "  T: 20 N*m\n  J:").replace(
            "crank: 20 N*m, wheel: -80 N*m", "crank: T, wheel: -4*T"
        )
        found = answer(opened(text), State(values={"T": "60 N*m"}))
        assert [one["expression"] for one in rows(found).values()] == ["T", "-4*T"]
        assert [one["value"] for one in rows(found).values()] == [60, -240]
        assert found["modes"]["natural"][1] == pytest.approx(vibration(SECOND), rel=1e-12)

    def test_a_drag_that_rises_with_the_speed_takes_a_torque_by_itself(self):
        text = LINE.replace("wheel: -80 N*m", "wheel: -40 N*m").replace(
            "operating_point",
            "  drag: {type: friction, nodes: [wheel, ground], torque_over_slip: [[0 rad/s, 10 N*m], [100 rad/s, 110 N*m]]}\n"
            "operating_point",
        )
        found = answer(opened(text), State(values={CRANK: 25}))
        assert "refused" not in found, found
        assert rows(found)[WHEEL]["value"] == -40
        assert "slips at 50 rad/s, 60 N*m" in found["modes"]["notes"][0]

    def test_friction_at_its_limit_takes_nothing_more(self):
        text = LINE.replace("wheel: -80 N*m}", "wheel: -40 N*m}, speed: {wheel: 30 rad/s}").replace(
            "operating_point", "  rub: {type: friction, nodes: [wheel, ground], torque: 40 N*m}\noperating_point"
        )
        found = answer(opened(text), State(values={CRANK: 25}))
        assert rows(found)[WHEEL]["value"] == pytest.approx(-60, rel=1e-11)

    def test_without_a_point_the_page_says_how_to_give_one(self):
        text = LINE[: LINE.index("operating_point")]
        assert opened(text).describe()["operating_point"]["rows"] == []
        assert "--set" in opened(text).describe()["operating_point"]["hint"]
        session = opened(text, settings={CRANK: "60 N*m", WHEEL: "-240 N*m"})
        assert [one["default"] for one in rows(answer(session, session.start)).values()] == [60, -240]

    def test_linear_models_have_none(self):
        session = open_session("dmf_rig")
        assert answer(session, session.start)["operating_point"] == []

    def test_what_is_no_torque_is_refused(self):
        assert answer(opened(LINE), State(values={CRANK: "J"}))["refused"][0].startswith(f"{CRANK}: expected")
        assert answer(opened(LINE), State(values={CRANK: "20 m"}))["refused"][0].startswith(
            'operating point torque crank: "20 m" '
        )


class TestLoad:
    POWER, SPEED = "load.power", "operating_point.speed.fly"

    def test_power_and_speed_have_sliders(self):
        session = opened(SHIP)
        found = rows(answer(session, session.start))
        assert list(found) == [self.POWER, self.SPEED]
        assert [found[self.POWER][key] for key in ("value", "low", "high", "unit")] == [300, 0, 600, "kW"]
        assert found[self.SPEED]["value"] == pytest.approx(900, rel=1e-12)

    @pytest.mark.parametrize(
        ("values", "stiffness"),
        [
            ({}, 80e3),  # 300 kW at 900 r/min are 3183 N m, the corner is at 2000 N m
            ({POWER: "150 kW"}, 20e3),
            ({SPEED: "720 rpm"}, 80e3),  # 2037 N m by the square of the speed
            ({SPEED: "700 rpm"}, 20e3),  # 1926 N m
            ({SPEED: "1000 rpm", POWER: "150 kW"}, 20e3),
            ({SPEED: "1100 rpm", POWER: "150 kW"}, 80e3),  # 2378 N m
        ],
    )
    def test_modes_follow(self, values, stiffness):
        found = answer(opened(SHIP), State(values=values))
        assert found["modes"]["natural"][1] == pytest.approx(vibration(stiffness, 50, 200), rel=1e-12)

    def test_saved_file_and_command_give_the_same(self, tmp_path, capsys):
        session = opened(SHIP)
        state = State(values={self.POWER: "150 kW", self.SPEED: "1100 rpm"}, band=(1.0, 9.0))
        saved = tn.loads(session.changed_file_text(state))
        assert saved.modes().natural_frequencies[1] == pytest.approx(vibration(80e3, 50, 200), rel=1e-12)
        assert saved.definition.load.power == 150e3
        path = tmp_path / "line.yaml"
        path.write_text(SHIP)
        words = ["modes", str(path), "--json"]
        for name, value in state.values.items():
            words += ["--set", f"{name}={value}"]
        assert main(words) == 0
        (printed,) = json.loads(capsys.readouterr().out)
        assert printed["undamped_natural_frequencies_Hz"][1] == pytest.approx(vibration(80e3, 50, 200), rel=1e-9)


class TestOut:
    def test_saved_where_the_author_wrote_it(self):
        session = opened(LINE + GEARS)
        saved = session.changed_file_text(State(values={CRANK: "40 N*m"}))
        assert saved == (LINE + GEARS).replace("crank: 20 N*m, wheel: -80 N*m", "crank: 40 N*m, wheel: -160 N*m")
        saved = session.changed_file_text(State({"configuration": "low"}, {CRANK: "50 N*m"}))
        assert saved == (LINE + GEARS).replace("crank: 100 N*m, wheel: -400 N*m", "crank: 50 N*m, wheel: -200 N*m")

    def test_point_of_the_command_line_is_saved(self):
        session = opened(LINE[: LINE.index("operating_point")], settings={CRANK: "60 N*m", WHEEL: "-240 N*m"})
        saved = tn.loads(session.changed_file_text(State(values={CRANK: "30 N*m"})))
        assert saved.mean_torques == pytest.approx({"crank": 30, "wheel": -120})

    def test_command_prints_the_same_numbers(self, tmp_path, capsys):
        path = tmp_path / "line.yaml"
        path.write_text(LINE)
        session = open_session(path)
        found = answer(session, State(values={CRANK: "60 N*m"}, output="crank", input="crank", band=(1.0, 20.0)))
        words = shlex.split(found["command"])
        assert [word for word in words if "=" in word] == [f"{CRANK}=60 N*m", f"{WHEEL}=-240 N*m"]
        assert main([*words[1:], "--json"]) == 0
        (printed,) = json.loads(capsys.readouterr().out)
        w = 2 * np.pi * np.array(printed["frequencies_Hz"])
        second = VEHICLE / RATIO**2
        expected = (SECOND - second * w**2) / (w**2 * (ENGINE * second * w**2 - SECOND * (ENGINE + second)))
        np.testing.assert_allclose(printed["responses"][0]["real"], expected, rtol=1e-7)


class TestSettings:
    """Settings of a model, in Python."""

    def test_they_change_single_entries(self):
        line = tn.loads(LINE)
        assert line.configured(**{CRANK: 21}).mean_torques == pytest.approx({"crank": 21, "wheel": -80})

    def test_they_hold_against_configurations(self):
        line = tn.loads(LINE + GEARS).configured(**{CRANK: 30, WHEEL: -120})
        assert line.configured("low").mean_torques == pytest.approx({"crank": 30, "wheel": -120})

    def test_they_change_a_point_that_was_asked_for(self):
        line = tn.loads(LINE).at(torque={"crank": 200, "wheel": -800}).configured(**{CRANK: "40 N*m", WHEEL: -160})
        assert line.modes().natural_frequencies[1] == pytest.approx(vibration(FIRST), rel=1e-12)

    def test_they_stay_when_the_model_is_changed(self):
        line = tn.loads(LINE).configured(**{CRANK: 60, WHEEL: -240}).with_entries_named(["set.ratio"])
        assert line.mean_torques == pytest.approx({"crank": 60, "wheel": -240})
        ship = tn.loads(SHIP).configured(**{"load.power": "150 kW"}).with_entries_named(["coupling.damping"])
        ship = ship.with_entries_named(["engine.inertia"])
        assert ship.definition.load.power == 150e3

    @pytest.mark.parametrize(
        ("name", "value", "message"),
        [
            ("operating_point.torque.crnk", 1, r'operating_point\.torque\.crnk: .*"crank".*unknown-node'),
            (CRANK, "1 m", r"operating_point\.torque\.crank: .*wrong-unit"),
            (CRANK, "2*x", r"operating_point\.torque\.crank: .*unknown-parameter"),
            (CRANK, float("nan"), "expected a finite number"),
            (
                "operating_point.tork.crank",
                1,
                "unknown-word",
            ),
            ("operating_point.torque.", 1, "operating_point.torque."),
            ("load.power", "3 kW", "missing-entry"),
            ("load.pwr", 1, '"load.power"'),
        ],
    )
    def test_wrong_ones_are_refused(self, name, value, message):
        with pytest.raises((ModelError, UsageError), match=message):
            tn.loads(LINE).configured(**{name: value})

    @pytest.mark.parametrize(
        ("name", "value", "message"),
        [
            ("load.torque", "3 kN*m", "missing-entry"),
            ("load.power", "3 N*m", r"load\.power: .*wrong-unit"),
            ("load.power", -3, r"load\.power: .*out-of-range"),
        ],
    )
    def test_wrong_loads_are_refused(self, name, value, message):
        with pytest.raises((ModelError, UsageError), match=message):
            tn.loads(SHIP).configured(**{name: value})

    def test_a_parameter_of_a_part_has_that_name_first(self):
        part = tn.Drivetrain("p", [tn.Inertia("disc", node="a", inertia="power")], parameters={"power": 3}, ports=["a"])
        whole = tn.Drivetrain("w", [tn.Inertia("own", node="b", inertia=1)]).with_part("load", part, at={"a": "b"})
        assert whole.configured(**{"load.power": 5}).parameters["load.power"] == 5


GAP = """torsionnet: 1
name: pair
elements:
  engine: {type: inertia, node: crank, inertia: 0.15 kg*m^2}
  mesh: {type: gear, nodes: [crank, wheel], ratio: 4, stiffness: 20 kN*m/rad, backlash: 0.5 deg}
  vehicle: {type: inertia, node: wheel, inertia: 24 kg*m^2}
"""


def test_rigid_bodies_are_counted_with_the_teeth_pressed_together_under_torque():
    loaded = GAP + "operating_point: {torque: {crank: 20 N*m, wheel: -80 N*m}}\n"
    counted = [
        [fault.message for fault in tn.loads(text).check() if "rigid" in fault.message] for text in (GAP, loaded)
    ]
    assert counted == [
        ["the drivetrain can turn freely: 2 rigid-body modes"],
        ["the drivetrain can turn freely: one rigid-body mode while torque presses mesh together"],
    ]
    assert [sum(kind == "rigid body" for kind in tn.loads(text).modes().kinds) for text in (GAP, loaded)] == [2, 1]


def test_labels_of_a_schematic_show_stages_and_backlash():
    from torsionnet.plot.drawing.labels import value_lines

    def shown(**entries):
        return [line.replace("$", "") for line in value_lines(entries.pop("of"), {})]

    stages = [{"stiffness": "460 N*m/rad", "to": "0.12 rad"}, {"stiffness": "1500 N*m/rad"}]
    spring = shown(of=tn.Spring("dmf", nodes=("a", "b"), damping=0.5, stages=stages))
    assert [line.rpartition("= ")[2] for line in spring] == ["460 N·m/rad", "1.5 kN·m/rad", "0.5 N·m·s/rad"]
    mesh = shown(of=tn.Gear("mesh", nodes=("a", "b"), ratio=4, stiffness="20 kN*m/rad", damping=2, backlash="0.01 rad"))
    assert mesh[-1].endswith("= 0.01 rad")
    linear = shown(of=tn.Gear("mesh", nodes=("a", "b"), ratio=4, stiffness="20 kN*m/rad", damping=2))
    assert len(linear) == 3
