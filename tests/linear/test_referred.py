"""Values quoted at another shaft, and readings referred to one: closed forms and models written in real values."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from support.modelica_reader import Model as ModelicaModel

import torsionnet as tn
from torsionnet.app.cli.app import app
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.io import to_modelica
from torsionnet.linear.modes.mode_pairs import referred_shapes
from torsionnet.linear.sensitivity.parametric import parametric_response
from torsionnet.model.channels import Sensor
from torsionnet.model.files.model_schema import json_schema
from torsionnet.model.files.reader import read_text
from torsionnet.model.files.writer import dump

F = np.array([0.4, 3.0, 8.0, 30.0])
TAU = 2.5
GIVEN = {"k": 800.0, "J": 3.0, "c": 2.0}


def line(*, referred_to=None, scale=1.0, sensors=None, **more):
    """Engine, spring, gear of ratio tau = crank over propeller shaft, its spring and propeller."""
    parameters = {"tau": TAU, **{name: value * scale for name, value in GIVEN.items()}}
    return tn.Drivetrain(
        "line",
        [
            tn.Inertia("engine", node="crank", inertia=2),
            tn.Spring("coupling", nodes=("crank", "pinion"), stiffness=1000, damping=1),
            tn.Gear("gear", nodes=("pinion", "wheel"), ratio="tau"),
            tn.Spring("shaft", nodes=("wheel", "prop"), stiffness="k", damping="c", referred_to=referred_to),
            tn.Inertia("screw", node="prop", inertia="J", referred_to=referred_to),
            *more.pop("elements", ()),
        ],
        parameters=parameters,
        inputs={"T": {"torque": "crank"}},
        sensors={"T_s": {"torque": "shaft"}, "a": {"angle": "prop"}, **(sensors or {})},
        **more,
    )


def response(s, k, c, J, tau):
    """Torque in the propeller shaft over a torque on the crank, all quoted at the crank: a chain of two springs."""
    # Referred to the crank: 2 s^2, kappa_1, kappa_2 = k + c s (quoted), J s^2 (quoted); real torque is tau times it.
    kappa1, kappa2 = 1000 + s, k + c * s
    beyond = 1 / (1 / kappa2 + 1 / (J * s**2))
    after = 1 / (1 / kappa1 + 1 / beyond)
    return tau * after / (2 * s**2 + after)


class TestValues:
    def test_response_is_that_of_the_chain_at_the_crank(self):
        found = line(referred_to="crank").frequency_response("T_s", "T", F).values[:, 0, 0]
        expected = response(2j * np.pi * F, GIVEN["k"], GIVEN["c"], GIVEN["J"], TAU)
        assert found == pytest.approx(expected, rel=1e-10)

    def test_as_the_model_in_real_values(self):
        quoted, real = line(referred_to="crank"), line(scale=TAU**2)
        assert quoted.modes().natural_frequencies == pytest.approx(real.modes().natural_frequencies, rel=1e-12)
        assert quoted.modes().damping_ratios[1:] == pytest.approx(real.modes().damping_ratios[1:], rel=1e-9)
        own = line(referred_to="wheel").frequency_response("T_s", "T", F).values
        assert own == pytest.approx(line().frequency_response("T_s", "T", F).values, rel=1e-12)

    def test_slower_shaft(self):
        """Engine values quoted at the propeller: divided by the ratio squared."""
        elements = [
            tn.Inertia("engine", node="crank", inertia=2 * 6.25, referred_to="prop"),
            tn.Spring("coupling", nodes=("ground", "crank"), stiffness=625, referred_to="prop"),
            tn.Gear("gear", nodes=("crank", "prop"), ratio=-2.5),
            tn.Inertia("screw", node="prop", inertia=0),
        ]
        found = tn.Drivetrain("one", elements).modes().natural_frequencies
        assert found == pytest.approx([np.sqrt(100 / 2) / 2 / np.pi], rel=1e-12)

    def test_every_kind_of_value(self):
        """Hysteresis, a damping measure, a compliant mesh and a planetary set."""

        def both(referred_to, scale, ring):
            parts = [
                tn.Inertia("a_J", node="a", inertia=1),
                tn.Gear("g", nodes=("a", "b"), ratio=3),
                tn.HystereticSpring("h", nodes=("b", "c"), stiffness=100 * scale, loss_factor=0.1, referred_to=referred_to),
                tn.Inertia("c_J", node="c", inertia=4),
                tn.Gear("mesh", nodes=("c", "d"), ratio=2, stiffness=50 * scale, damping={"zeta": 0.02, "at": "5 Hz"},
                        referred_to=referred_to),
                tn.Inertia("d_J", node="d", inertia=7),
                tn.Planetary("set", sun="d", ring=ring, carrier="e", ratio=2, stiffness=30 * scale,
                             referred_to=referred_to),
                tn.Inertia("e_J", node="e", inertia=20),
            ]  # fmt: skip
            parts += [tn.Lock("brake", node="ring")] if ring == "ring" else []
            return tn.Drivetrain("kinds", parts).frequency_response(["e", "torque(mesh)"], "a", F).values

        # Shafts b and c turn 3 times slower than a, d 6 times.
        def real(ring):
            parts = {"h": 9, "mesh": 9, "set": 36}
            rig = tn.Drivetrain(
                "kinds",
                [
                    tn.Inertia("a_J", node="a", inertia=1),
                    tn.Gear("g", nodes=("a", "b"), ratio=3),
                    tn.HystereticSpring("h", nodes=("b", "c"), stiffness=100 * parts["h"], loss_factor=0.1),
                    tn.Inertia("c_J", node="c", inertia=4),
                    tn.Gear("mesh", nodes=("c", "d"), ratio=2, stiffness=50 * parts["mesh"],
                            damping={"zeta": 0.02, "at": "5 Hz"}),
                    tn.Inertia("d_J", node="d", inertia=7),
                    tn.Planetary("set", sun="d", ring=ring, carrier="e", ratio=2, stiffness=30 * parts["set"]),
                    tn.Inertia("e_J", node="e", inertia=20),
                    *([tn.Lock("brake", node="ring")] if ring == "ring" else []),
                ],
            )  # fmt: skip
            return rig.frequency_response(["e", "torque(mesh)"], "a", F).values

        for ring in ("ground", "ring"):
            assert both("a", 1, ring) == pytest.approx(real(ring), rel=1e-10)

    def test_through_a_planetary_set_and_a_housing_that_stands(self):
        """Ring on a brake: sun over carrier 1 + z = 4; gear in a housing on mounts."""
        elements = [
            tn.Planetary("set", sun="s", ring="r", carrier="c", ratio=3),
            tn.Lock("brake", node="r"),
            tn.Inertia("s_J", node="s", inertia=1),
            tn.Gear("g", nodes=("c", "o"), ratio=-2, housing="box"),
            tn.Inertia("box_J", node="box", inertia=50),
            tn.Spring("mount", nodes=("box", "ground"), stiffness=1e4),
            tn.Inertia("o_J", node="o", inertia=0.5, referred_to="s"),
        ]
        rig = tn.Drivetrain("set", elements)
        (law,) = rig.elements["o_J"].parts(tn_values(rig))
        assert law.inertia == pytest.approx(0.5 * 64)

    @pytest.mark.parametrize("kind", ["final_drive", "differential"])
    def test_half_shafts_quoted_at_the_engine(self, kind):
        """On a straight road both turn as the cage: with wheels that hold still, the two shafts are 2 k at the engine."""
        i, k, J = 3.5 * 4, 30.0, 0.2
        if kind == "final_drive":
            drive = [tn.FinalDrive("axle", pinion="o", left="l", right="r", ratio=4)]
        else:
            drive = [
                tn.Gear("crown", nodes=("o", "cage"), ratio=4),
                tn.Differential("axle", cage="cage", left="l", right="r"),
            ]
        wheels = {side: 60 * (1 + number) for number, side in enumerate("lr")}
        elements = [
            tn.Inertia("e_J", node="e", inertia=J),
            tn.Gear("box", nodes=("e", "o"), ratio=3.5),
            *drive,
            *(tn.Spring(f"h{one}", nodes=(one, f"w{one}"), stiffness=k, referred_to="e") for one in wheels),
            *(tn.Inertia(f"J{one}", node=f"w{one}", inertia=size) for one, size in wheels.items()),
        ]
        rig = tn.Drivetrain("car", elements, inputs={"T": {"torque": "e"}})
        # Both outputs carry the same torque: at the cage the half shafts are in series, of twice the twist.
        found = rig.frequency_response(["twist(hl)", "angle(e)"], "T", F).values[:, :, 0]
        s = 2j * np.pi * F
        flexible = sum(1 / (k * i**2) + 1 / (size * s**2) for size in wheels.values())
        angle = 1 / (J * s**2 + 4 / flexible / i**2)
        assert found[:, 1] == pytest.approx(angle, rel=1e-9)
        torque = angle * 2 / flexible / i  # in each half shaft
        assert found[:, 0] == pytest.approx(torque / (k * i**2), rel=1e-9)

    def test_wheel_that_stands(self):
        """The other one turns twice as fast as the cage, which the values follow."""
        elements = [
            tn.Inertia("c_J", node="c", inertia=1),
            tn.Differential("axle", cage="c", left="l", right="r"),
            tn.Lock("jack", node="l"),
            tn.Inertia("r_J", node="r", inertia=1, referred_to="c"),
        ]
        (law,) = (rig := tn.Drivetrain("axle", elements)).elements["r_J"].parts(tn_values(rig))
        assert law.inertia == pytest.approx(1 / 4)

    def test_ratio_follows_the_gear(self):
        rig = line(
            referred_to="crank",
            configurations={"gear": {"low": {"tau": 4}, "high": {"tau": 1.25}}},
        )
        for name, tau in (("low", 4), ("high", 1.25)):
            found = rig.configured(name).frequency_response("T_s", "T", F).values[:, 0, 0]
            expected = response(2j * np.pi * F, GIVEN["k"], GIVEN["c"], GIVEN["J"], tau)
            assert found == pytest.approx(expected, rel=1e-10)

    def test_ratio_follows_what_is_switched_on(self):
        elements = [
            tn.Inertia("a_J", node="a", inertia=1),
            tn.Gear("one", nodes=("a", "b"), ratio=2),
            tn.Gear("two", nodes=("a", "b"), ratio=5, enabled=False),
            tn.Spring("k", nodes=("b", "ground"), stiffness=100, referred_to="a"),
        ]
        shift = {"gear": {"I": {"on": ["two"], "off": ["one"]}, "II": {"on": ["one"], "off": ["two"]}}}
        rig = tn.Drivetrain("shift", elements, configurations=shift)
        # k_b = 100 tau^2, seen from a 100 again: the same mode in every gear.
        for name in ("I", "II"):
            assert rig.configured(name).modes().natural_frequencies == pytest.approx([10 / 2 / np.pi], rel=1e-12)

    def test_in_symbols(self):
        import sympy

        k, tau, J, c = sympy.symbols("k tau J c")
        system = line(referred_to="crank").symbolic()
        place = system.coordinates.index("prop")
        assert sympy.simplify(system.K[place, place] - k * tau**2) == 0
        assert sympy.simplify(system.M[place, place] - J * tau**2) == 0
        assert sympy.simplify(system.C[place, place] - c * tau**2) == 0
        function = line(referred_to="crank").symbolic().transfer_function("T_s", "T")
        expected = response(2j * np.pi * F, GIVEN["k"], GIVEN["c"], GIVEN["J"], TAU)
        assert function.evaluate(F).values[:, 0, 0] == pytest.approx(expected, rel=1e-10)
        assert function.evaluate(F, tau=4.0).values[:, 0, 0] == pytest.approx(expected * 4 / TAU, rel=1e-10)

    def test_derivative_to_the_ratio_sees_it(self):
        """The torque at the crank does not depend on tau, so that the real one grows with it."""
        rig = line(referred_to="crank")
        found = parametric_response(rig, "T_s", "T", F, ["tau", "k"]).evaluation([TAU, GIVEN["k"]])
        expected = response(2j * np.pi * F, GIVEN["k"], GIVEN["c"], GIVEN["J"], TAU)
        assert found.jacobian[:, 0, 0, 0] == pytest.approx(expected / TAU, rel=1e-9)
        h = 1e-3
        ends = [response(2j * np.pi * F, GIVEN["k"] + d, GIVEN["c"], GIVEN["J"], TAU) for d in (h, -h)]
        assert found.jacobian[:, 0, 0, 1] == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=1e-5)

    def test_modelica_text(self):
        model = ModelicaModel(to_modelica(line(referred_to="crank")))
        for f in F:
            s = 2j * np.pi * f
            expected = response(s, GIVEN["k"], GIVEN["c"], GIVEN["J"], TAU)
            assert model.responses(s)[0, 0] == pytest.approx(expected, rel=1e-8)

    def test_simulation_and_state_space(self):
        S = line(referred_to="crank").to_control()
        for f in F:
            s = 2j * np.pi * f
            gain = S.C @ np.linalg.solve(s * np.eye(len(S.A)) - S.A, S.B) + S.D
            assert gain[0, 0] == pytest.approx(response(s, GIVEN["k"], GIVEN["c"], GIVEN["J"], TAU), rel=1e-8)


def tn_values(rig):
    from torsionnet.model.elements import Values

    return Values(rig.exact_values)


class TestFaults:
    @pytest.mark.parametrize(
        ("element", "message"),
        [
            (tn.Inertia("x", node="prop", inertia=1, referred_to="cranc"), 'did you mean "crank".*unknown-node'),
            (tn.RigidCoupling("x", nodes=("prop", "y"), referred_to="crank"), r"elements\.x\.referred_to: .*no-ratio"),
            (tn.Lock("x", node="prop", referred_to="crank"), r"elements\.x\.referred_to: .*no-ratio"),
            (tn.Gear("x", nodes=("prop", "y"), ratio=2, referred_to="crank"), r"elements\.x\.referred_to: .*no-ratio"),
            (tn.Shaft("x", nodes=("prop", "y"), outer_diameter=0.1, length=1, referred_to="crank"), "follows from its dimensions"),
            (tn.TabulatedSpring("x", nodes=("prop", "y"), table=[[1, 400, 2], [20, 500, 1]], referred_to="crank"), "table"),
        ],
    )  # fmt: skip
    def test_what_cannot_be_referred(self, element, message):
        with pytest.raises(ModelError, match=message.replace("?", r"\?")):
            line(
                elements=[element, *([tn.Inertia("y_J", node="y", inertia=1)] if "y" in element.ports.values() else [])]
            )

    @pytest.mark.parametrize("first", ["gear", "spring"])
    def test_two_ways_with_different_ratios(self, first):
        """Gears of 17 and 41 teeth beside a spring: which of both the values are quoted over cannot be told."""
        ways = {
            "gear": tn.Gear("gear", nodes=("a", "b"), ratio="41/17"),
            "spring": tn.Spring("spring", nodes=("a", "b"), stiffness=5),
        }
        parts = [
            tn.Inertia("a_J", node="a", inertia=1),
            *(ways[name] for name in sorted(ways, key=lambda name: name != first)),
            tn.Spring("shaft", nodes=("b", "c"), stiffness=3, referred_to="a"),
            tn.Inertia("c_J", node="c", inertia=1),
        ]
        with pytest.raises(ModelError, match=r"elements\.shaft\.referred_to: .*no-ratio") as caught:
            tn.Drivetrain("loop", parts)
        (fault,) = caught.value.faults
        assert fault.path == ("elements", "shaft", "referred_to")
        one, other = ("2.41176", "1") if first == "gear" else ("1", "2.41176")
        assert f"a turns {one} or {other} times" in str(fault)

    def test_second_ratio_over_two_gears(self):
        """41/17 over one pair and, the other way around the loop, 2 * 3 over two, each way with a shaft in it."""
        parts = [
            tn.Inertia("a_J", node="a", inertia=1),
            tn.Gear("pair", nodes=("a", "p"), ratio="41/17"),
            tn.Spring("p_shaft", nodes=("p", "b"), stiffness=4),
            tn.Gear("first", nodes=("a", "q"), ratio=2),
            tn.Spring("q_shaft", nodes=("q", "r"), stiffness=4),
            tn.Gear("second", nodes=("r", "b"), ratio=3),
            tn.Inertia("b_J", node="b", inertia=1, referred_to="a"),
        ]
        with pytest.raises(ModelError, match=r"elements\.b_J\.referred_to: .*2\.41176.*no-ratio"):
            tn.Drivetrain("loop", parts)

    def test_loops_that_leave_one_ratio(self):
        """One that agrees with itself, and one beyond the shafts in question."""
        parts = [
            tn.Inertia("a_J", node="a", inertia=1),
            tn.Gear("g", nodes=("a", "b"), ratio=3),
            tn.Gear("g2", nodes=("a", "c"), ratio=3, stiffness=5),
            tn.Spring("across", nodes=("b", "c"), stiffness=7),
            tn.Inertia("c_J", node="c", inertia=1, referred_to="a"),
            tn.Gear("aside", nodes=("a", "d"), ratio=2, stiffness=5),
            tn.Spring("locking", nodes=("a", "d"), stiffness=5),
            tn.Inertia("d_J", node="d", inertia=1),
        ]
        assert tn.Drivetrain("loop", parts).elements["c_J"].referred_to == "a"

    def test_ground_is_no_shaft(self):
        with pytest.raises(ModelError, match="ground does not move"):
            tn.Inertia("x", node="prop", inertia=1, referred_to="ground")

    def test_open_clutch(self):
        """The connection is there as written, and in the configuration with the clutch open it is not."""
        elements = [
            tn.Inertia("a_J", node="a", inertia=1),
            tn.RigidCoupling("clutch", nodes=("a", "b")),
            tn.Inertia("b_J", node="b", inertia=1, referred_to="a"),
        ]
        with pytest.raises(ModelError, match=r"elements\.b_J\.referred_to: .*no-ratio"):
            tn.Drivetrain("clutch", elements, configurations={"clutch": {"closed": {}, "open": {"off": ["clutch"]}}})
        with pytest.raises(ModelError, match=r"elements\.b_J\.referred_to: .*no-ratio"):
            tn.Drivetrain("clutch", elements).switched(off=["clutch"])
        damped = [elements[0], tn.Damper("slip", nodes=("a", "b"), damping=1), elements[2]]
        with pytest.raises(ModelError, match=r"elements\.b_J\.referred_to: .*no-ratio"):
            tn.Drivetrain("slipping", damped)

    def test_a_free_planetary_set(self):
        elements = [
            tn.Inertia("s_J", node="s", inertia=1),
            tn.Planetary("set", sun="s", ring="r", carrier="c", ratio=2),
            tn.Inertia("r_J", node="r", inertia=1, referred_to="s"),
            tn.Inertia("c_J", node="c", inertia=1),
        ]
        with pytest.raises(ModelError, match=r"elements\.r_J\.referred_to: .*no-ratio"):
            tn.Drivetrain("set", elements)

    def test_place_in_a_file(self):
        text = line(referred_to="crank").to_yaml().replace("referred_to: crank", "referred_to: cranc")
        _, faults = read_text(text, "line.yaml")
        errors = [fault for fault in faults if fault.severity == "error"]
        assert [fault.path for fault in errors] == [
            ("elements", "shaft", "referred_to"),
            ("elements", "screw", "referred_to"),
        ]


class TestFiles:
    def test_round_trip_keeps_what_was_written(self):
        import jsonschema

        rig = line(referred_to="crank", sensors={"T_c": {"torque": "shaft", "referred_to": "crank"}})
        definition, _ = read_text(dump(rig.definition), "line.yaml")
        data = definition.to_data()
        assert data == rig.definition.to_data()
        assert data["elements"]["shaft"] == {
            "type": "spring", "nodes": ["wheel", "prop"], "stiffness": "k", "damping": "c", "referred_to": "crank",
        }  # fmt: skip
        assert data["sensors"]["T_c"] == {"torque": "shaft", "referred_to": "crank"}
        jsonschema.Draft202012Validator(json_schema()).validate(json.loads(json.dumps(data)))


class TestReadings:
    def test_of_one_power(self):
        """Torque times angle, and torque times velocity, are those of the own shaft."""
        names = ["torque(shaft)", "angle(wheel)", "velocity(prop)", "twist(shaft)"]
        rig = line()
        own = rig.frequency_response(names, "T", F).values[:, :, 0]
        referred = rig.frequency_response([f"{name} referred to crank" for name in names], "T", F).values[:, :, 0]
        assert referred == pytest.approx(own * [1 / TAU, TAU, TAU, TAU], rel=1e-11)

    def test_rigid_connections_read_alike_on_both_sides(self):
        """The torque out of a rigid gear, referred to its input, is the torque in; opposite for an idler's sense."""
        for tau in (3, -3):
            rig = tn.Drivetrain(
                "pair",
                [
                    tn.Inertia("a_J", node="a", inertia=1),
                    tn.Gear("g", nodes=("a", "b"), ratio=tau),
                    tn.Inertia("b_J", node="b", inertia=2),
                    tn.Spring("k", nodes=("b", "ground"), stiffness=90),
                ],
            )
            into, out = (
                rig.frequency_response(name, "a", F).values for name in ("torque(g)", "torque(g, b) referred to a")
            )
            assert out == pytest.approx(into, rel=1e-10)

    def test_declared_by_node_and_by_object(self):
        rig = line(sensors={"T_c": {"torque": "shaft", "referred_to": "crank"}})
        texts = ["T_c", "T_s referred to crank", Sensor("torque", "shaft", referred_to="crank")]
        found = [rig.frequency_response(text, "T", F).values for text in texts]
        assert found[1] == pytest.approx(found[0])
        assert found[2] == pytest.approx(found[0])
        angle = rig.frequency_response("prop referred to crank", "T", F).values
        assert angle == pytest.approx(TAU * rig.frequency_response("prop", "T", F).values, rel=1e-12)

    def test_in_symbols_over_a_measured_input_and_as_derivative(self):
        rig = line()
        output = "T_s referred to crank"
        for source in ("T", "torque(coupling)"):
            numbers = rig.frequency_response(output, source, F).values[:, 0, 0]
            symbols = rig.symbolic().transfer_function(output, source).evaluate(F).values[:, 0, 0]
            assert symbols == pytest.approx(numbers, rel=1e-9)
        measured = rig.frequency_response("a", output, F).values[:, 0, 0]
        assert measured == pytest.approx(TAU * rig.frequency_response("a", "T_s", F).values[:, 0, 0], rel=1e-10)
        assert rig.to_control("a", output)(2j * np.pi * F) == pytest.approx(measured, rel=1e-6)
        symbols = rig.symbolic().transfer_function("a", output).evaluate(F).values[:, 0, 0]
        assert symbols == pytest.approx(measured, rel=1e-9)
        found = parametric_response(rig, output, "T", F, ["tau"]).evaluation([TAU])
        h = 1e-5
        ends = [rig.configured(tau=TAU + d).frequency_response(output, "T", F).values for d in (h, -h)]
        assert found.jacobian[..., 0] == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=1e-6)

    def test_over_time_and_through_orders(self):
        rig = line(
            speeds={"of": "crank", "range": "100..300 rpm", "step": "100 rpm"},
            excitations={"e": {"type": "harmonic", "node": "crank", "orders": {2: {"amplitude": 1}}}},
        )
        record = rig.simulate(["T_s", "T_s referred to crank"], {"T": np.arange(50.0)}, 100.0)
        assert record["T_s referred to crank"].values == pytest.approx(record["T_s"].values / TAU, rel=1e-9)
        run = rig.order_response(["T_s", "T_s referred to crank"]).values
        assert run[..., 1] == pytest.approx(run[..., 0] / TAU, rel=1e-10)

    def test_faults(self):
        with pytest.raises(ModelError, match=r"sensors\.x\.referred_to: .*unknown-node"):
            line(sensors={"x": {"torque": "shaft", "referred_to": "cranc"}})
        with pytest.raises(UsageError, match="unfit-channel"):
            Sensor("stress", "shaft", referred_to="crank")
        loose = line(elements=[tn.Inertia("y_J", node="y", inertia=1), tn.Damper("d", nodes=("y", "prop"), damping=1)])
        with pytest.raises(UsageError, match="no-ratio"):
            loose.frequency_response("y referred to crank", "T", F)

    def test_shapes(self):
        """A chain at the crank: angles of the propeller side times tau."""
        rig = line(elements=[tn.Inertia("b", node="y", inertia=1), tn.Damper("d", nodes=("y", "prop"), damping=1e-9)])
        modes = rig.modes()
        found = referred_shapes(rig, modes, "crank")
        own, at_crank = modes.shapes[:, -1], found.shapes[:, -1]
        place = {node: number for number, node in enumerate(modes.nodes)}
        ratio = at_crank[place["prop"]] / at_crank[place["crank"]]
        assert ratio == pytest.approx(TAU * own[place["prop"]] / own[place["crank"]], rel=1e-9)
        assert np.abs(at_crank).max() == pytest.approx(1)
        assert "no ratio leads there from y" in found.notes

    def test_command_line(self, tmp_path):
        path = tmp_path / "line.yaml"
        path.write_text(line(referred_to="crank").to_yaml(), encoding="utf-8")
        words = ["frf", str(path), "--output", "T_s", "--input", "T", "--frequencies", "3", "--full"]
        expected = response(6j * np.pi, GIVEN["k"], GIVEN["c"], GIVEN["J"], TAU)
        for more, size in (([], abs(expected)), (["--referred-to", "crank"], abs(expected) / TAU)):
            result = CliRunner().invoke(app, [*words, *more])
            assert result.exit_code == 0, result.output
            assert f"{size:.6g}" in result.output
        shown = CliRunner().invoke(app, ["show", str(path)])
        assert "referred_to crank" in " ".join(shown.output.split())
        shapes = CliRunner().invoke(app, ["modes", str(path), "--shapes", "--referred-to", "crank"])
        assert shapes.exit_code == 0
        assert "angles referred to crank" in shapes.output


CUT = """torsionnet: 1
elements:
  engine: {type: inertia, node: crank, inertia: 2}
  clutch: {type: spring, nodes: [crank, disc], stiffness: 1000}
  mesh: {type: gear, nodes: [disc, wheel], ratio: 3}
  car: {type: inertia, node: wheel, inertia: 9}
  brake: {type: spring, nodes: [wheel, drum], stiffness: 50}
  drum: {type: inertia, node: drum, inertia: 1}
sensors:
  speed: {velocity: wheel, referred_to: crank}
  pull:
    torque: mesh
    at: wheel
    referred_to: crank
  own: {twist: brake}
configurations:
  clutch:
    closed: {}
    open: {off: [clutch]}
"""


class TestCheckOfSensors:
    def test_a_sensor_that_no_ratio_leads_to_is_an_error_in_that_configuration(self):
        _, faults = read_text(CUT, "car.yaml")
        errors = [fault for fault in faults if fault.severity == "error"]
        assert [(fault.path[1], fault.position.line, fault.configuration) for fault in errors] == [
            ("speed", 19, "open"),
            ("pull", 19, "open"),
        ]
        assert {fault.kind for fault in errors} == {"no-ratio"}

    def test_where_it_holds_for_all_it_is_at_the_line_of_the_sensor(self):
        text = CUT.replace("stiffness: 1000}", "stiffness: 1000, enabled: false}").partition("configurations:")[0]
        _, faults = read_text(text, "car.yaml")
        errors = [fault for fault in faults if fault.severity == "error"]
        assert [(fault.path, fault.position.line) for fault in errors] == [
            (("sensors", "speed", "referred_to"), 10),
            (("sensors", "pull", "referred_to"), 14),
        ]

    def test_with_a_way_there_is_nothing_to_say(self):
        _, faults = read_text(CUT.replace("    open: {off: [clutch]}\n", ""), "car.yaml")
        assert not [fault for fault in faults if fault.severity == "error"]

    def test_what_is_switched_off_is_a_note_only(self):
        _, faults = read_text(CUT.replace("off: [clutch]", "off: [mesh, car, brake, drum, clutch]"), "car.yaml")
        assert not [fault for fault in faults if fault.severity == "error"]
        assert any("switched off" in fault.message for fault in faults)


IN_A_PART = """torsionnet: 1
parts:
  load:
    ports: [n, crank]
    elements:
      g: {type: gear, nodes: [n, m], ratio: 2}
      j: {type: inertia, node: m, inertia: 4, referred_to: SHAFT}
elements:
  a: {type: inertia, node: c, inertia: 1}
  s: {type: spring, nodes: [c, d], stiffness: 100}
use:
  l: {part: load, at: {n: d, crank: c}}
"""


class TestInParts:
    def test_a_port_that_is_referred_to_needs_no_element(self):
        assert read_text(IN_A_PART.replace("SHAFT", "crank"), "train.yaml")[0] is not None

    def test_a_word_that_is_no_port_is_named_beside_the_port_that_nothing_uses(self):
        _, faults = read_text(IN_A_PART.replace("SHAFT", "c"), "train.yaml")
        errors = [fault for fault in faults if fault.severity == "error"]
        assert [(fault.about, fault.position.line, fault.position.column) for fault in errors] == [
            ("crank", 4, 16),
            ("c", 7, 60),
        ]
