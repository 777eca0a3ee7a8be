"""The drivetrain itself: immutability, parameters, configurations, operating point, checks in Python."""

import copy
import math
import pickle
import re
import time

import numpy as np
import pytest
from support.models import geared_line

import torsionnet as tn
from torsionnet.model.channels import Input, Sensor
from torsionnet.model.parameters import Parameter


def faults_of(*elements, **entries):
    with pytest.raises(tn.ModelError) as caught:
        tn.Drivetrain("wrong", elements, **entries)
    return [str(fault) for fault in caught.value.faults]


WHEEL = tn.Inertia("wheel", node="a", inertia=1)
HELD = tn.Spring("held", nodes=("a", "ground"), stiffness=5)


class TestParameters:
    def test_derived_parameters_follow(self):
        rig = tn.load("amt_rig")
        assert rig.parameters["I_F"] == pytest.approx(0.152, abs=1e-15)
        assert rig.configured(I_1=0.3).parameters["I_F"] == pytest.approx(0.222, abs=1e-15)

    def test_an_overridden_derived_parameter_loses_its_expression(self):
        changed = tn.load("amt_rig").configured(I_F=0.2).configured(I_1=9)
        assert changed.parameters["I_F"] == 0.2

    def test_overrides_take_units_and_expressions(self):
        rig = tn.load("amt_rig").configured(c_O="0.36 kN*m*s/rad", c_B="c_O / 240")
        assert (rig.parameters["c_O"], rig.parameters["c_B"]) == (360, 1.5)

    def test_values_are_those_written(self):
        assert tn.load("amt_rig").exact_values["tau"] * 100 == 796

    def test_powers_of_powers_end_as_floats(self):
        chain = {"p0": "1.0001"} | {f"p{number + 1}": f"p{number}**4" for number in range(8)}
        start = time.process_time()
        rig = tn.Drivetrain("x", [tn.Inertia("wheel", node="a", inertia="p8")], parameters=chain)
        assert time.process_time() - start < 1.0
        assert rig.parameters["p8"] == pytest.approx(math.exp(4**8 * math.log(1.0001)), rel=1e-9)

    def test_bounds_have_the_unit_of_the_parameter(self):
        with pytest.raises(tn.ModelError, match=r":2:46: .*wrong-unit") as caught:
            tn.loads(
                "torsionnet: 1\n"
                "parameters: {k: {value: 1 kN*m/rad, bounds: [100 kg, 2 kN*m/rad]}}\n"
                "elements:\n"
                "  wheel: {type: inertia, node: a, inertia: 1}\n"
                "  held: {type: spring, nodes: [a, ground], stiffness: k}\n"
            )
        (fault,) = caught.value.faults
        assert (fault.position.line, fault.position.column) == (2, 46)

    def test_unknown_or_impossible_overrides(self):
        rig = tn.load("amt_rig")
        with pytest.raises(tn.UsageError, match='did you mean "c_O"'):
            rig.configured(c_o=3)
        with pytest.raises(tn.ModelError, match=r"elements\.oil\.damping: .*out-of-range"):
            rig.configured(c_O=-3)
        with pytest.raises(tn.ModelError, match="expected stiffness"):
            rig.configured("V", k_1="3 kg")
        with pytest.raises(tn.ModelError, match="write 1/k_1"):
            rig.configured(k_1="0.002 rad/Nm")
        with pytest.raises(tn.ModelError, match="decimal comma"):
            rig.configured(c_O="3,5")


class TestConfigurations:
    def model(self):
        return tn.Drivetrain(
            "car",
            [
                tn.Inertia("engine", node="e", inertia=0.2),
                tn.RigidCoupling("clutch", nodes=("e", "i")),
                tn.Inertia("box", node="i", inertia=0.05),
                tn.Gear("stage", nodes=("i", "o"), ratio="tau"),
                tn.Inertia("car", node="o", inertia=90),
                tn.Spring("shaft", nodes=("o", "w"), stiffness=8000),
                tn.Inertia("wheel", node="w", inertia="J"),
            ],
            {"tau": 4, "J": 3},
            configurations={
                "gear": {"1": {"tau": 14}, "5": {"tau": 3}},
                "clutch": {"closed": None, "open": {"off": ["clutch"]}},
                "wheel": {"small": {"J": 3}, "large": {"J": 5}},
            },
        )

    def test_axes_combine_without_multiplying(self):
        car = self.model()
        assert dict(car.axes) == {"gear": ("1", "5"), "clutch": ("closed", "open"), "wheel": ("small", "large")}
        assert len(car.configurations) == 8
        chosen = car.configured("gear=1, clutch=open").configured("large")
        assert chosen.configuration == "gear=1,clutch=open,wheel=large"
        assert (chosen.parameters["tau"], chosen.parameters["J"], "clutch" in chosen.elements) == (14, 5, False)

    def test_another_alternative_of_an_axis_takes_the_place_of_the_first(self):
        rig = tn.load("amt_rig").configured("V_c_O_360").configured("V")
        assert (rig.configuration, rig.parameters["c_O"]) == ("V", 170)
        car = self.model().configured("open").configured("closed")
        assert "clutch" in car.elements
        assert self.model().configured("wheel=large,gear=1").configuration == "gear=1,wheel=large"

    def test_changes_by_hand_outlast_a_configuration(self):
        car = self.model()
        assert car.configured(tau=7).configured("gear=5").parameters["tau"] == 7
        assert "clutch" in car.switched(on=["clutch"]).configured("open").elements

    def test_copies_that_share_their_rows_keep_their_own_elements(self):
        """Two springs, or two couplings, between the same nodes: same rows, other names."""
        for make in (
            lambda name, **state: tn.Spring(name, nodes=("a", "b"), stiffness=10, **state),
            lambda name, **state: tn.RigidCoupling(name, nodes=("a", "b"), **state),
        ):
            parts = [WHEEL, HELD, tn.Inertia("j", node="b", inertia=1), make("one"), make("two", enabled=False)]
            first = tn.Drivetrain("x", parts, configurations={"b": {"on": ["two"], "off": ["one"]}})
            torque = first.frequency_response("torque(one)", "a", [1.0]).values
            second = first.configured("b")
            np.testing.assert_array_equal(second.frequency_response("torque(two)", "a", [1.0]).values, torque)
            with pytest.raises(tn.UsageError, match="switched off"):
                second.frequency_response("torque(one)", "a", [1.0])

    def test_two_axes_may_not_set_the_same(self):
        axes = {"x": {"p": {"k": 2}}, "y": {"q": {"k": 3}}}
        (fault,) = faults_of(
            WHEEL, tn.Spring("s", nodes=("a", "ground"), stiffness="k"), parameters={"k": 1}, configurations=axes
        )
        assert "on axis x too" in fault

    def test_copies_and_pickles_keep_everything(self):
        car = self.model().configured("open", J=9)
        car.modes()
        for twin in (pickle.loads(pickle.dumps(car)), copy.deepcopy(car)):
            assert twin == car
            assert (twin.configuration, twin.configured("closed").parameters["J"]) == ("clutch=open", 9)
        error = pickle.loads(pickle.dumps(tn.ModelError("wrong", "car")))
        assert (error.title, error.faults[0].message) == ("car", "wrong")

    def test_the_original_stays_as_it_was(self):
        car = self.model()
        before = car.to_yaml()
        car.configured("gear=1,clutch=open", J=99)
        assert car.to_yaml() == before
        assert car.configuration == ""

    def test_an_alternative_with_a_unique_name_needs_no_axis(self):
        assert self.model().configured("open").configuration == "clutch=open"

    def test_wrong_choices_list_what_there_is(self):
        car = self.model()
        for text, words in (
            ("gear=2", "unknown-word"),
            ("gaer=1", 'did you mean "gear"'),
            ("gear=1,gear=5", "chooses twice"),
            ("neutral", "no configuration"),
        ):
            with pytest.raises(tn.UsageError, match=words):
                car.configured(text)

    def test_no_configuration_is_named_as_all_of_them(self):
        found = faults_of(WHEEL, HELD, parameters={"k": 1}, configurations={"all": {"k": 2}, "soft": {"k": 1}})
        assert any('"all" means every configuration' in fault for fault in found)

    def test_one_axis_needs_no_name(self):
        flat = tn.Drivetrain("x", [WHEEL, HELD], configurations={"a": {}, "b": {}})
        assert flat.configurations == ("a", "b")


class TestOperatingPoint:
    def test_speeds_pass_through_ratios_and_springs(self):
        point = {"speed": {"m": "3000 rpm"}, "torque": {"m": "80 N*m"}}
        rig = geared_line()
        line = tn.Drivetrain("line", [*rig.elements.values()][:-1], rig.parameters, operating_point=point)
        assert line.mean_speeds["h"] == pytest.approx(3000 / 3 * 2 * np.pi / 60)
        assert line.mean_torques == {"m": 80}

    def test_contradicting_speeds_are_refused(self):
        rig = geared_line()
        with pytest.raises(tn.ModelError, match=r"operating_point\.speed: .*contradicting-speeds"):
            tn.Drivetrain("x", rig.elements.values(), rig.parameters, operating_point={"speed": {"m": 10, "o": 5}})

    def test_total_ratio(self):
        assert geared_line().ratio_between("m", "h") == 3
        assert geared_line().ratio_between("h", "m") == pytest.approx(1 / 3)
        with pytest.raises(tn.UsageError, match="no node is named"):
            geared_line().ratio_between("m", "hub")

    @pytest.mark.parametrize("order", [1, -1])
    def test_a_housing_on_springs_keeps_the_ratio_of_its_set(self, order):
        """1 + z, as with a ring that is held; whichever is declared first."""
        parts = [
            tn.Planetary("set", sun="s", ring="r", carrier="c", ratio=3, stiffness=100),
            tn.Spring("arms", nodes=("r", "ground"), stiffness=50),
            *(tn.Inertia(f"j{node}", node=node, inertia=1) for node in "src"),
        ]
        assert tn.Drivetrain("mounted", parts[::order]).ratio_between("s", "c") == 4
        with pytest.raises(tn.UsageError, match="no fixed ratio"):
            tn.Drivetrain("loose", [parts[0], *parts[2:]][::order]).ratio_between("s", "c")

    def test_a_spring_to_ground_does_not_stop_what_is_asked_for(self):
        """A rig that is wound up against a wall keeps its ratios."""
        rig = tn.Drivetrain(
            "wall",
            [
                tn.Gear("g", nodes=("a", "b"), ratio=3),
                tn.Spring("wall", nodes=("b", "ground"), stiffness=5),
                tn.Inertia("j", node="a", inertia=1),
            ],
        )
        assert rig.ratio_between("a", "b") == 3

    def test_open_differential_has_no_fixed_ratio(self):
        parts = [tn.Inertia(f"j{n}", node=n, inertia=1) for n in "clr"]
        axle = tn.Drivetrain("axle", [tn.Differential("d", cage="c", left="l", right="r"), *parts])
        with pytest.raises(tn.UsageError, match="no fixed ratio"):
            axle.ratio_between("c", "l")
        locked = tn.Drivetrain("axle", [tn.Differential("d", cage="c", left="l", right="r", locked=True), *parts])
        assert locked.ratio_between("c", "l") == 1

    def test_the_order_of_clamps_does_not_matter(self):
        gear = tn.Planetary("set", sun="s", ring="r", carrier="c", ratio=3)
        clamps = [tn.Lock("ring", node="r"), tn.Lock("hub", node="h")]
        rest = [
            tn.Inertia("js", node="s", inertia=1),
            tn.Inertia("jc", node="c", inertia=1),
            tn.Spring("k", nodes=("c", "h"), stiffness=5),
        ]
        for order in (clamps, clamps[::-1]):
            model = tn.Drivetrain("x", [gear, *rest, *order], operating_point={"speed": {"s": 100}})
            assert (model.mean_speeds["c"], model.mean_speeds["r"]) == (25, 0)

    @pytest.mark.parametrize(("held", "expected"), [("r", 3.5), ("s", 3.5 / 2.5), ("c", -2.5)])
    def test_planetary_with_a_clamped_member(self, held, expected):
        """z = 2.5; ring held: sun/carrier 1+z; sun held: ring/carrier (1+z)/z; carrier held: sun/ring -z."""
        parts = [tn.Inertia(f"j{n}", node=n, inertia=1) for n in "src" if n != held]
        gear = tn.Planetary("set", sun="s", ring="r", carrier="c", ratio=2.5)
        model = tn.Drivetrain("set", [gear, *parts, tn.Lock("clamp", node=held)])
        free = [n for n in "src" if n != held]
        assert model.ratio_between(*free) == pytest.approx(expected)


class TestChecks:
    def test_everything_wrong_is_said_at_once(self):
        found = faults_of(
            WHEEL,
            tn.Spring("s", nodes=("a", "b"), stiffness="k_1"),
            tn.Inertia("j", node="b", inertia="-2 kg*m^2"),
            parameters={"k1": 5, "loop": "loop + 1"},
            sensors={"t": {"torque": "x"}, "angle": {"angle": "q"}},
        )
        text = "\n".join(found)
        for words in (
            '"k_1"; did you mean "k1"',
            "loop",
            "elements.j.inertia: error: -2: ",
            "sensors.t.torque: error: ",
            "sensors.angle.angle: error: ",
        ):
            assert words in text

    def test_contradicting_gears_are_named_and_bystanders_are_not(self):
        (fault,) = faults_of(
            WHEEL,
            tn.Gear("outer", nodes=("a", "b"), ratio=2),
            tn.Gear("inner", nodes=("b", "c"), ratio=3),
            tn.Gear("short", nodes=("a", "c"), ratio=5),
            tn.RigidCoupling("bystander", nodes=("c", "d")),
            tn.Inertia("j", node="d", inertia=1),
        )
        assert re.search(r" outer, inner, short .*\[contradicting-gears\]$", fault)
        assert "bystander" not in fault

    def test_consistent_and_compliant_loops_are_fine(self):
        gears = [("g1", "a", "b", 2), ("g2", "b", "c", 3), ("g3", "a", "c", 6)]
        rigid = tn.Drivetrain("x", [WHEEL, *(tn.Gear(n, nodes=(a, b), ratio=r) for n, a, b, r in gears)])
        assert len(rigid.assembly.kinematics.coordinates) == 1
        soft = [tn.Gear(n, nodes=(a, b), ratio=r + 1, stiffness=1e5) for n, a, b, r in gears]
        assert tn.Drivetrain("y", [WHEEL, *soft]).modes().kinds == ("oscillatory",)

    def test_unconnected_part_with_the_likely_typo(self):
        (fault,) = faults_of(
            WHEEL,
            tn.Spring("s", nodes=("a", "output"), stiffness=3),
            tn.Inertia("j", node="outpt", inertia=1),
        )
        assert re.search(r'outpt .*"output"[?] \[unconnected-nodes\]$', fault)

    def test_massless_node_without_hold(self):
        (fault,) = faults_of(WHEEL, tn.Gear("diff", nodes=("a", "b"), ratio=2, housing="h"))
        assert re.search(r"b, h .*\[indeterminate-motion\]$", fault)

    def test_a_damper_is_hold_enough(self):
        model = tn.Drivetrain(
            "x",
            [
                WHEEL,
                HELD,
                tn.Damper("d", nodes=("a", "b"), damping=3),
                tn.Damper("e", nodes=("b", "ground"), damping=1),
            ],
        )
        assert "rigid body" in model.modes().kinds  # b alone has a position that nothing restores

    def test_inputs_on_what_cannot_move(self):
        found = faults_of(WHEEL, tn.Lock("l", node="a"), inputs={"T": {"torque": "a"}})
        assert any('"a" is locked' in fault for fault in found)
        found = faults_of(WHEEL, HELD, inputs={"T": {"torque": "a"}, "x": {"angle": "a"}})
        assert any("is imposed by x" in fault for fault in found)

    @pytest.mark.parametrize("quantity", ["torque", "angle"])
    @pytest.mark.parametrize("locked_as_written", [False, True])
    def test_free_and_locked_share_a_file(self, quantity, locked_as_written):
        rig = tn.Drivetrain(
            "x",
            [
                tn.Inertia("rotor", node="a", inertia=1),
                tn.Spring("k", nodes=("a", "b"), stiffness=1e3),
                tn.Inertia("load", node="b", inertia=2),
                tn.Lock("brake", node="b", enabled=locked_as_written),
            ],
            inputs={"driven": {quantity: "b"}, "T": {"torque": "a"}},
            sensors={"speed": {"velocity": "b"}, "angle": {"angle": "a"}},
            configurations={"free": {"off": ["brake"]}, "locked": {"on": ["brake"]}},
        )
        said = [fault.text for fault in rig.check() if fault.severity == "warning"]
        where = "" if locked_as_written else "in configuration locked: "
        assert f'{where}input driven does nothing: "b" is locked' in said
        assert f'{where}sensor speed reads zero: "b" is locked' in said
        free, locked = rig.configured("free"), rig.configured("locked")
        omega = 2 * np.pi * 3.0
        given = free.frequency_response("angle", "driven", [3.0]).values[0, 0, 0]
        determinant = (1e3 - omega**2) * (1e3 - 2 * omega**2) - 1e6
        expected = 1e3 / (1e3 - omega**2 if quantity == "angle" else determinant)
        assert given == pytest.approx(expected, rel=1e-12)
        held = locked.frequency_response("angle", "T", [3.0]).values[0, 0, 0]
        assert held == pytest.approx(1 / (1e3 - omega**2), rel=1e-12)
        with pytest.raises(tn.UsageError, match="no-effect"):
            locked.frequency_response("angle", "driven", [3.0])
        with pytest.raises(tn.UsageError, match="zero-reading"):
            locked.frequency_response("speed", "T", [3.0])
        assert locked.frequency_response("b", "T", [3.0]).values[0, 0, 0] == 0  # a node asked for by name is zero

    def test_a_channel_that_no_configuration_sets_free_is_an_error(self):
        with pytest.raises(tn.ModelError, match=r"inputs\.T\.torque: .*no-effect"):
            tn.Drivetrain(
                "x",
                [WHEEL, tn.Lock("l", node="a")],
                parameters={"p": 1},
                inputs={"T": {"torque": "a"}},
                configurations={"one": {"p": 2}, "two": {"p": 3}},
            )

    def test_a_torque_that_one_configuration_leaves_undetermined(self):
        rig = tn.Drivetrain(
            "x",
            [
                WHEEL,
                HELD,
                tn.RigidCoupling("one", nodes=("a", "b")),
                tn.RigidCoupling("two", nodes=("a", "b"), enabled=False),
            ],
            inputs={"T": {"torque": "a"}},
            sensors={"through": {"torque": "one"}},
            configurations={"single": {}, "double": {"on": ["two"]}},
        )
        assert any(fault.severity == "warning" and "rigid loop" in fault.text for fault in rig.check())
        assert np.isfinite(rig.configured("single").frequency_response("through", "T", [1.0]).values).all()
        with pytest.raises(tn.UsageError, match="rigid loop"):
            rig.configured("double").frequency_response("through", "T", [1.0])

    def test_two_imposed_angles_on_one_rigid_part(self):
        found = faults_of(
            WHEEL, tn.RigidCoupling("c", nodes=("a", "b")), HELD, inputs={"x": {"angle": "a"}, "y": {"angle": "b"}}
        )
        assert any("impose" in fault for fault in found)

    def test_indeterminate_torque_sensor(self):
        found = faults_of(
            WHEEL,
            HELD,
            tn.RigidCoupling("one", nodes=("a", "b")),
            tn.RigidCoupling("two", nodes=("a", "b")),
            sensors={"T": {"torque": "one"}},
        )
        assert any("one, two form" in fault for fault in found)

    def test_dimensions(self):
        found = faults_of(
            tn.Inertia("j", node="a", inertia="k"),
            tn.Spring("s", nodes=("a", "ground"), stiffness="e"),
            parameters={"k": "5 N*m/rad", "e": "0.01 rad/Nm", "x": "k + J", "J": "1 kg*m^2"},
        )
        text = "\n".join(found)
        assert "expected inertia in kg*m^2" in text
        assert "write 1/e" in text
        assert (
            "write k"
            in faults_of(HELD, tn.Spring("s", nodes=("a", "ground"), stiffness="1/k"), parameters={"k": "5 N*m/rad"})[0]
        )
        assert "parameters.x" in text

    def test_faults_of_a_configuration_name_it(self):
        found = faults_of(
            WHEEL,
            HELD,
            tn.Spring("s", nodes=("a", "ground"), stiffness="k"),
            parameters={"k": 1},
            configurations={"gear": {"bad": {"k": -1}}},
        )
        assert any("bad: k = -1" in fault for fault in found)

    def test_warnings_and_notes_do_not_stop(self):
        model = tn.Drivetrain(
            "x", [WHEEL, tn.Spring("s", nodes=("a", "b"), stiffness=3)], {"unused": 1}, {"b": {"torque": "a"}}
        )
        assert sorted(fault.severity for fault in model.check()) == ["note", "warning", "warning", "warning"]
        assert any("rigid-body mode" in fault.message for fault in model.check())
        assert any('"unused" is not used' in fault.message for fault in model.check())

    def test_names_that_hide_a_node_are_told(self):
        for entries in (
            {"sensors": {"a": {"velocity": "a"}}},
            {"sensors": {"a": {"angle": "a"}}},
            {"inputs": {"a": {"angle": "a"}}},
        ):
            model = tn.Drivetrain(
                "x",
                [WHEEL, tn.Spring("s", nodes=("a", "b"), stiffness=1), tn.Inertia("j", node="b", inertia=1)],
                **entries,
            )
            assert any("is also a node" in fault.message for fault in model.check())
        plain = tn.Drivetrain("x", [WHEEL, HELD], inputs={"a": {"torque": "a"}})
        assert not any("is also a node" in fault.message for fault in plain.check())

    def test_channels_are_checked_where_they_are_made(self):
        for make in (
            lambda: Input("force", "a"),
            lambda: Sensor("angel", "a"),
            lambda: Sensor("angle", "a", at="b"),
            lambda: Sensor("angle", 5),
        ):
            with pytest.raises(tn.UsageError):
                make()
        assert Parameter(3).value.evaluate({}) == 3

    def test_a_measure_of_no_damping_that_is_none_is_placed(self):
        found = faults_of(WHEEL, tn.Spring("s", nodes=("a", "ground"), stiffness=-10, damping={"Q": 0, "at": 10}))
        assert len(found) == 1 or any("s cannot be calculated" in fault for fault in found)
        found = faults_of(WHEEL, tn.Spring("s", nodes=("a", "ground"), stiffness=10, damping={"Q": 0, "at": 10}))
        assert any("elements.s" in fault for fault in found)

    @pytest.mark.parametrize("elements", [None, [], "abc", [1]])
    def test_what_is_no_list_of_elements(self, elements):
        with pytest.raises(tn.ModelError, match="element"):
            tn.Drivetrain("x", elements)

    def test_sizes_beyond_all_drivetrains(self):
        with pytest.raises(tn.ModelError, match=r"elements\.j\.inertia: .*200.*implausible-size"):
            tn.Inertia("j", node="a", inertia="1e-200")
        beyond = faults_of(tn.Inertia("j", node="a", inertia="J**2"), HELD, parameters={"J": 1e-30})
        assert "far outside the sizes" in beyond[0]

    def test_duplicate_names(self):
        (fault,) = faults_of(WHEEL, HELD, tn.Inertia("wheel", node="a", inertia=2))
        assert 'named "wheel"' in fault


def test_equality_and_repr():
    assert tn.load("amt_rig") == tn.load("amt_rig")
    assert tn.load("amt_rig") != tn.load("amt_rig").configured("V")
    assert (
        repr(tn.load("amt_rig").configured("V"))
        == "<Drivetrain 'AMT test rig': 11 elements, 5 nodes, 11 parameters, V>"
    )
    assert repr(WHEEL) == "Inertia('wheel', node='a', inertia=1)"


def test_switched():
    rig = geared_line()
    assert "brake" not in rig.switched(off=["brake"]).elements
    with pytest.raises(tn.UsageError, match='did you mean "brake"'):
        rig.switched(off=["brak"])
