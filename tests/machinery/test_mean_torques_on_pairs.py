"""Mean torques that react on another node: the block of an engine, the housing of an electric machine."""

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.base.errors import ModelError
from torsionnet.model.files.reader import read_text

RPM = np.pi / 30
ENGINE = """
  engine:
    type: reciprocating_engine
    speed_of: fly
    cycle: 4
    cylinders: {1: c1, 2: fly}
    firing_order: [1, 2]
    bore: 320 mm
    stroke: 400 mm
    rod_length: 840 mm
    reciprocating_mass: 78 kg
    reaction: block
"""
SET = """torsionnet: 1
name: generating set
elements:
  c1: {{type: inertia, node: c1, inertia: 3 kg*m^2}}
  crank: {{type: spring, nodes: [c1, fly], stiffness: 2 MN*m/rad}}
  flywheel: {{type: inertia, node: fly, inertia: 20 kg*m^2}}
  coupling: {{type: spring, nodes: [fly, gen], stiffness: 0.1 MN*m/rad}}
  rotor: {{type: inertia, node: gen, inertia: 10 kg*m^2}}
  block: {{type: inertia, node: block, inertia: 60 kg*m^2}}
  bearings: {{type: damper, nodes: [fly, block], damping: 2 N*m*s/rad}}
  mounts: {{type: spring, nodes: [block, ground], stiffness: 0.5 MN*m/rad}}
  frame: {{type: inertia, node: frame, inertia: 40 kg*m^2}}
  flange: {{type: spring, nodes: [block, frame], stiffness: 4 MN*m/rad}}
  feet: {{type: spring, nodes: [frame, ground], stiffness: 0.25 MN*m/rad, outer_diameter: 100 mm}}
speeds: {{of: fly, range: 1000..1500 rpm, step: 100 rpm, rated: 1500 rpm}}
{rest}
"""
ABSORBED = "power: 300 kW, torque_exponent: 0"
SENSORS = ["torque(coupling)", "torque(mounts)", "torque(flange)", "torque(feet)"]


def generating_set(rest):
    return tn.loads(SET.format(rest=rest))


def through(on_block, on_frame):
    """Torques in mounts, flange and feet: three springs between ground, block and frame."""
    k_m, k_f, k_g = 0.5e6, 4e6, 0.25e6
    block, frame = np.linalg.solve([[k_m + k_f, -k_f], [-k_f, k_f + k_g]], [on_block, on_frame])
    return [k_m * block, k_f * (block - frame), k_g * frame]


TORQUE = 300e3 / (1500 * RPM)


class TestLoad:
    @pytest.mark.parametrize(
        ("load", "on_block", "on_frame"),
        [
            (f"{{absorbed_at: gen, {ABSORBED}, driven_by: {{engine: 1}}}}", -TORQUE, 0),
            (f"{{absorbed_at: gen, {ABSORBED}}}", -TORQUE, 0),  # the only engine drives
            (f"{{absorbed_at: gen-frame, {ABSORBED}, driven_by: {{engine: 1}}}}", -TORQUE, TORQUE),
            (f"{{absorbers: {{gen-frame: {{{ABSORBED}}}}}, driven_by: {{fly-frame: 1}}}}", 0, 0),
            (f"{{absorbed_at: gen, {ABSORBED}, driven_by: {{c1: 1}}}}", -TORQUE, 0),  # where the engine acts
        ],
    )
    def test_the_reaction_reaches_the_mounts(self, load, on_block, on_frame):
        rig = generating_set(f"excitations:{ENGINE}load: {load}")
        run = rig.mean_response(SENSORS, [1500 * RPM])
        assert run.values[0] == pytest.approx([TORQUE, *through(on_block, on_frame)], rel=1e-9, abs=1e-8)

    def test_a_machine_reacts_on_its_stator(self):
        machine = "  machine: {type: electric_machine, node: gen, stator: frame, rated_torque: 2 kN*m, orders: {1: {share: 1 %}}}\n"
        rig = generating_set(f"excitations:{ENGINE}{machine}load: {{absorbed_at: gen, {ABSORBED}}}")
        run = rig.mean_response([*SENSORS, "stress(feet)"], [1500 * RPM])
        expected = through(-TORQUE, TORQUE)
        assert run.values[0, :4] == pytest.approx([TORQUE, *expected], rel=1e-9)
        assert run.values[0, 4] == pytest.approx(16 * expected[2] / (np.pi * 0.1**3), rel=1e-9)
        state = {(one.element, one.port): one.torque for one in rig.static_state(1500 * RPM).loads}
        assert state["feet", "frame"] == pytest.approx(expected[2], rel=1e-9)

    def test_a_torque_on_a_frame_that_stands_has_no_power(self):
        rig = generating_set(f"load: {{absorbed_at: gen-frame, {ABSORBED}, driven_by: {{fly: 1}}}}")
        balance = rig.power_balance(1500 * RPM)
        assert balance.state.external == pytest.approx({"fly": TORQUE, "gen": -TORQUE, "frame": TORQUE})
        assert balance.powers == {"fly": pytest.approx(300e3), "gen": pytest.approx(-300e3), "frame": 0}

    def test_power_is_of_the_relative_speed(self):
        """A motor whose housing turns with the wheel at half its speed gives half the power of one that stands."""
        rig = tn.Drivetrain(
            "hub motor",
            [
                tn.Inertia("rotor", node="a", inertia=1),
                tn.Gear("gear", nodes=("a", "wheel"), ratio=2),
                tn.Inertia("wheel", node="wheel", inertia=1),
                tn.Spring("shaft", nodes=("wheel", "out"), stiffness=1e4),
                tn.Inertia("out", node="out", inertia=1),
            ],
            speeds={"of": "a", "list": [100], "rated": 100},
            load={"absorbed_at": "out", "torque": 30, "torque_exponent": 0, "driven_by": {"a-wheel": 1}},
        )
        # 30 N m at 50 rad/s are 1500 W; the motor's relative speed is 50 rad/s: 30 N m on the rotor, -30 on the wheel.
        assert rig.external_torques.at(100.0) == pytest.approx({"out": -30, "a": 30, "wheel": -30})
        assert rig.mean_response("torque(shaft)", [100]).values[0] == pytest.approx([30], rel=1e-12)


class TestOperatingPoint:
    def test_a_torque_between_two_nodes(self):
        point = "operating_point: {speed: {fly: 1500 rpm}, torque: {fly-block: 500 N*m, gen: -500 N*m}}"
        rig = generating_set(point)
        assert dict(rig.mean_torques) == {"fly": 500, "block": -500, "gen": -500}
        assert rig.mean_response(SENSORS).values[0] == pytest.approx([500, *through(-500, 0)], rel=1e-9)
        again = tn.loads(rig.to_yaml())
        assert dict(again.mean_torques) == dict(rig.mean_torques)

    def test_in_a_part(self):
        text = """torsionnet: 1
parts:
  motor:
    ports: [out]
    elements:
      rotor: {type: inertia, node: rotor, inertia: 1}
      shaft: {type: spring, nodes: [rotor, out], stiffness: 1e4}
      housing: {type: inertia, node: housing, inertia: 1}
      bearing: {type: damper, nodes: [rotor, housing], damping: 1}
      mount: {type: spring, nodes: [housing, ground], stiffness: 1e3}
    configurations: {state: {idle: {}, driving: {operating_point: {torque: {rotor-housing: 20}}}}}
elements: {wheel: {type: inertia, node: wheel, inertia: 1}}
use: {left: {part: motor, at: {out: wheel}}}
operating_point: {torque: {wheel: -20}}
"""
        rig = tn.loads(text).configured("driving")
        assert dict(rig.mean_torques) == {"left.rotor": 20, "left.housing": -20, "wheel": -20}


@pytest.mark.parametrize(
    ("rest", "message"),
    [
        ("operating_point: {torque: {fly-blok: 1}}", '"blok"; did you mean "block"'),
        ("operating_point: {torque: {fly-fly: 1}}", 'both nodes are "fly"'),
        ("operating_point: {torque: {ground-fly: 1}}", "ground does not move"),
        (f"load: {{absorbed_at: gen-frme, {ABSORBED}, driven_by: {{fly: 1}}}}", 'did you mean "frame"'),
        (f"load: {{absorbed_at: gen-gen, {ABSORBED}, driven_by: {{fly: 1}}}}", 'both nodes are "gen"'),
        (f"load: {{absorbed_at: gen, {ABSORBED}, driven_by: {{fly-blok: 1}}}}", "fly-blok"),
    ],
)
def test_what_is_no_pair_is_named(rest, message):
    _, faults = read_text(SET.format(rest=rest), "set.yaml")
    assert message in " ".join(fault.message for fault in faults)
    assert all(fault.position for fault in faults)
    with pytest.raises(ModelError):
        generating_set(rest)
