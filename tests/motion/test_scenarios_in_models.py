"""Scenarios in models: configurations change them, parts stand beside them, Python and files give the same."""

import numpy as np
import pytest
import scipy
import yaml

import torsionnet as tn

TIP_IN = """\
torsionnet: 1
name: launch
elements:
  engine: {type: inertia, node: crank, inertia: 0.25 kg*m^2}
  clutch: {type: clutch, nodes: [crank, disc], state: slipping, friction: [[0 rad/s, 1], [900 rad/s, 1]], clamp_torque: 300 N*m}
  disc:   {type: inertia, node: disc, inertia: 0.02 kg*m^2}
  shafts: {type: spring, nodes: [disc, car], stiffness: 350 N*m/rad, damping: 0.6 N*m*s/rad}
  car:    {type: inertia, node: car, inertia: 2.4 kg*m^2}
sensors: {T_shafts: {torque: shafts}, n: {velocity: crank}}
operating_point: {torque: {crank: 20 N*m, car: -20 N*m}}
scenarios:
  tip_in: {type: torques, duration: 2 s, rate: 10 kHz, start: operating_point, torque: {crank: {0 s: 20 N*m, 50 ms: 250 N*m}}, clutch: {clamp: {0 s: 0 N*m, 0.5 s: 300 N*m}}}
"""


def test_tip_in_of_a_clutch_that_is_clamped_over_time():
    """While it slips, friction 1 gives the clamp torque itself: crank and the rest move apart under known torques."""
    record = tn.loads(TIP_IN).simulate(scenario="tip_in", sampling_rate=1e3, duration=0.4)
    t = record.time

    def rate(time, y):  # angles of disc and car, speeds of crank, disc and car
        clamp, shaft = 600 * time, 350 * (y[0] - y[1]) + 0.6 * (y[3] - y[4])
        engine = np.interp(time, [0, 0.05], [20, 250])
        return [y[3], y[4], (engine - clamp) / 0.25, (clamp - shaft) / 0.02, (shaft - 20) / 2.4]

    start = [20 / 350, 0, 0, 0, 0]  # at the operating point the clutch holds 20 N m
    y = scipy.integrate.solve_ivp(rate, (0, 0.4), start, "DOP853", t, rtol=1e-10, atol=1e-12, max_step=5e-3).y
    assert record["n"].values == pytest.approx(y[2], abs=1e-6)
    assert record["T_shafts"].values == pytest.approx(350 * (y[0] - y[1]) + 0.6 * (y[3] - y[4]), abs=1e-5)
    assert "the clamp of clutch is 300 at the operating point and 0 from the start on, in SI units" in record.notes


RIG = """\
torsionnet: 1
name: rig
parameters: {T_1: 10 N*m}
elements:
  J: {type: inertia, node: a, inertia: 2 kg*m^2}
  k: {type: spring, nodes: [a, ground], stiffness: 80 kN*m/rad}
sensors: {T: {torque: k}}
scenarios:
  step: {type: torques, duration: 50 ms, rate: 10 kHz, torque: {a: T_1}}
configurations: {as_written: {}, more: {step.torque: {a: 3*T_1}, step.duration: 60 ms}, other: {ENTRY}}
"""


def rig(entry="T_1: 12 N*m"):
    return tn.loads(RIG.replace("ENTRY", entry), file="rig.yaml")


def test_a_configuration_changes_entries_of_a_scenario(tmp_path):
    """An undamped mass on a spring goes to twice the torque of a step."""
    found = {name: rig().configured(name).simulate(scenario="step") for name in rig().configurations}
    largest = {name: float(record["T"].values.max()) for name, record in found.items()}
    assert largest == pytest.approx({"as_written": 20, "more": 60, "other": 24}, rel=1e-3)
    assert {name: len(record) for name, record in found.items()} == {"as_written": 501, "more": 601, "other": 501}
    rig().to_yaml(tmp_path / "again.yaml")
    again = tn.load(tmp_path / "again.yaml")
    assert again.configured("more").definition.scenarios == rig().configured("more").definition.scenarios


@pytest.mark.parametrize(
    ("entry", "marked", "words"),
    [
        ("stop.duration: 1 s", "stop.", r":10:97: .*unknown-element"),
        ("step.durations: 1 s", "step.d", r":10:97: .*unknown-name"),
        ("step.duration: 1 kg", "1 kg", r":10:112: .*wrong-unit"),
        ("step.torque: {b: 1 N*m}", "step.torque", r":10:97: .*unknown-node"),
        ("step.torque: {a: T_2}", "T_2", r":10:114: .*unknown-parameter"),
        ("scenarios.step: {}", "scenarios.", r":10:97: .*fixed-entry"),
    ],
)
def test_what_a_configuration_changes_wrongly_has_its_place(entry, marked, words):
    line = next(line for line in RIG.replace("ENTRY", entry).splitlines() if line.startswith("configurations"))
    with pytest.raises(tn.ModelError, match=words) as caught:
        rig(entry)
    assert f"rig.yaml:10:{line.index(marked, line.index('other')) + 1}: " in str(caught.value)


def test_duration_of_the_call_counts():
    record = rig().simulate(scenario="step", duration=0.02)
    assert len(record) == 201
    with pytest.raises(tn.ModelError, match="greater than 0"):
        rig().simulate(scenario="step", duration=0)
    assert len(rig().simulate("T", {"a": np.ones(11)}, 100, duration=0.1)) == 11
    with pytest.raises(tn.UsageError, match="11 and 21 samples"):
        rig().simulate("T", {"a": np.ones(11)}, 100, duration=0.2)
    for rate in (0, -1.0, float("nan")):
        with pytest.raises(tn.UsageError, match="out-of-range"):
            rig().simulate(scenario="step", sampling_rate=rate)
    with pytest.raises(tn.UsageError, match="too-large"):
        rig().simulate(scenario="step", sampling_rate=1e9)
    fault = tn.ShortCircuitScenario(machine="J", phases=3, at=0.1, x=0.2, rated_torque=1, frequency=50)
    with pytest.raises(tn.ModelError, match="simulate longer"):
        rig().simulate(scenario=fault, duration=0.05)


def test_public_classes_are_those_that_files_make():
    by_hand = tn.TorqueScenario(duration="50 ms", rate="10 kHz", torque={"a": "T_1"})
    assert by_hand == rig().definition.scenarios["step"]
    assert rig().simulate(scenario=by_hand)["T"].values.max() == rig().simulate(scenario="step")["T"].values.max()
    ssr = tn.load("turbine_generator_ssr").definition.scenarios["two_phases"]
    entries = {"machine": "G", "phases": 2, "x": 0.135, "rated_torque": "T_0", "frequency": "60 Hz"}
    assert tn.ShortCircuitScenario(**entries).to_data() == ssr.to_data()
    given = tn.Drivetrain("rig", rig().elements.values(), parameters={"T_1": "10 N*m"}, scenarios={"step": by_hand})
    assert tn.loads(given.to_yaml()).definition.scenarios == given.definition.scenarios


PART = {
    "ports": ["hub"],
    "parameters": {"k": "80 kN*m/rad"},
    "elements": {
        "shaft": {"type": "spring", "nodes": ["hub", "end"], "stiffness": "k"},
        "disc": {"type": "inertia", "node": "end", "inertia": 2},
        "slip": {"type": "clutch", "nodes": ["end", "ground"], "state": "slipping", "friction": [[0, 1], [9e3, 1]],
                 "clamp_torque": 1},
    },
}  # fmt: skip


def test_scenarios_name_what_parts_hold():
    """A disc of a part that slips against a clamped face: J w = (T - T_1) t."""
    scenario = {
        "type": "torques", "duration": 0.015, "rate": 1e3, "torque": {"left.end": "5 N*m"},
        "left.slip": {"clamp": "2 N*m"},
    }  # fmt: skip
    data = {
        "torsionnet": 1, "name": "whole", "parts": {"arm": PART}, "use": {"left": {"part": "arm", "at": {"hub": "ground"}}}, "scenarios": {"push": scenario},
    }  # fmt: skip
    model = tn.loads(yaml.safe_dump(data, sort_keys=False))
    record = model.simulate("velocity(left.end)", scenario="push")
    first = record.signals[-1].values
    t = record.time
    w = np.sqrt(8e4 / 2)
    assert first == pytest.approx(3 / 2 / w * np.sin(w * t), abs=1e-9)
    again = tn.loads(model.to_yaml())
    assert again.definition.scenarios == model.definition.scenarios
    assert "use" in model.definition.to_data()


SHIP = """\
torsionnet: 1
name: ship
elements:
  engine: {type: inertia, node: fly, inertia: 40 kg*m^2}
  shaft:  {type: spring, nodes: [fly, prop], stiffness: 200 kN*m/rad, damping: 200 N*m*s/rad}
  screw:  {type: propeller, node: prop, inertia: 25 kg*m^2, exponent: 2, torque: 9 kN*m, speed: 20 rad/s}
sensors: {T: {torque: shaft}, n: {velocity: prop}}
speeds: {of: fly, range: 50..200 rpm, step: 50 rpm, rated: 20 rad/s}
load: {absorbed_at: prop, torque: 9 kN*m, torque_exponent: 2, driven_by: {fly: 1}}
operating_point: {speed: {fly: 20 rad/s}}
scenarios:
  steady: {type: torques, duration: 0.2 s, rate: 1 kHz, start: operating_point, torque: {fly: 9 kN*m}}
  push:   {type: torques, duration: 3 s, rate: 200 Hz, start: operating_point, torque: {fly: {0 s: 9 kN*m, 0.5 s: 12 kN*m}}}
"""


WITH_STOP = SHIP.replace(
    "sensors:", "  stop: {type: clearance, nodes: [fly, prop], gap: 1 rad, stiffness: 1}\nsensors:"
)


@pytest.mark.parametrize(("text", "speed"), [(SHIP, 0.0), (WITH_STOP, 20.0)])
def test_a_propeller_brakes_once_where_the_load_states_its_torque(text, speed):
    """Linear, readings count from the mean motion; with the stop, which is not reached, laws act in full."""
    record = tn.loads(text).simulate(scenario="steady")
    assert record["T"].values == pytest.approx(np.full(201, 9000.0), rel=1e-6)
    assert record["n"].values == pytest.approx(np.full(201, speed), rel=1e-6, abs=1e-9)
    assert ("torque on prop" in record.names) == (speed == 0)
    assert not any("held" in note or "not in balance" in note for note in record.notes)


def test_a_propeller_follows_the_speed():
    """J w' = T(t) - Q (w/20)^2 of two rotors, integrated apart."""
    record = tn.loads(WITH_STOP).simulate(scenario="push")

    def rate(t, y):
        shaft = 2e5 * y[0] + 200 * (y[1] - y[2])
        return [y[1] - y[2], (np.interp(t, [0, 0.5], [9e3, 12e3]) - shaft) / 40, (shaft - 22.5 * y[2] ** 2) / 25]

    start = [9e3 / 2e5, 20, 20]
    y = scipy.integrate.solve_ivp(rate, (0, 3), start, "DOP853", record.time, rtol=1e-10, atol=1e-10, max_step=0.02).y
    assert record["n"].values == pytest.approx(y[2], rel=1e-7)
    assert record["T"].values == pytest.approx(2e5 * y[0] + 200 * (y[1] - y[2]), rel=1e-6)


def test_a_load_without_such_an_element_is_held_and_said_to_be():
    held = SHIP.replace("exponent: 2, torque: 9 kN*m, speed: 20 rad/s}", "damping: 0}")
    record = tn.loads(held).simulate(scenario="push")
    assert "the torques of the load at prop are held, whatever the speed" in record.notes
    assert record["torque on prop"].values == pytest.approx(np.full(601, -9000.0))
    hoist = tn.loads(held.replace("torque_exponent: 2", "torque_exponent: 0"))
    assert not any("held" in note for note in hoist.simulate(scenario="push").notes)


def test_torque_between_two_nodes_takes_the_place_of_the_mean_torque_there():
    elements = [tn.Inertia("J", node="a", inertia=2), tn.Inertia("B", node="b", inertia=3)]
    springs = [
        tn.Spring("k", nodes=("a", "ground"), stiffness=100),
        tn.Spring("m", nodes=("b", "ground"), stiffness=50),
        tn.Damper("c", nodes=("a", "b"), damping=1),
    ]
    push = tn.TorqueScenario(duration=0.5, rate=100, start="operating_point", torque={"a-b": "10 N*m"})
    rig = tn.Drivetrain("rig", [*elements, *springs], operating_point={"torque": {"a-b": 10}}, scenarios={"push": push})
    record = rig.simulate(["torque(k)", "torque(m)"], scenario="push")
    assert record["torque(k)"].values == pytest.approx(np.full(51, 10.0))
    assert record["torque(m)"].values == pytest.approx(np.full(51, -10.0))


STATES = """\
torsionnet: 1
name: states
elements:
  J: {type: inertia, node: a, inertia: 2 kg*m^2}
  K: {type: inertia, node: b, inertia: 4 kg*m^2}
  clutch: {type: clutch, nodes: [a, b], friction: [[0 rad/s, 1], [900 rad/s, 1]], clamp_torque: 300 N*m}
scenarios:
  push: {type: torques, duration: 10 ms, rate: 1 kHz, torque: {a: 3 N*m}, clutch: {clamp: 1 N*m}}
  fault: {type: short_circuit, machine: K, phases: 3, x: 0.2, rated_torque: 1 N*m, frequency: 50 Hz}
configurations: {slipping: {clutch.state: slipping}, without: {off: [clutch, K]}}
"""


def test_a_scenario_may_need_a_configuration():
    """The face takes 1 N m of the 3: J w = 2 t."""
    model = tn.loads(STATES)
    record = model.configured("slipping").simulate("velocity(a)", scenario="push")
    assert record.signals[-1].values == pytest.approx(record.time, abs=1e-12)
    with pytest.raises(tn.UsageError, match=r'(?s)clutch .*"clamp".*unknown-word'):
        model.simulate("velocity(a)", scenario="push")
    with pytest.raises(tn.UsageError, match="switched-off"):
        model.configured("without").simulate("velocity(a)", scenario="fault")
    with pytest.raises(tn.ModelError, match="nothing scales its torque"):
        tn.loads(STATES.replace("clutch.state: slipping", "J.inertia: 3"))


MACHINE = """\
torsionnet: 1
name: machine
elements:
  rotor: {type: inertia, node: gen, inertia: 2 kg*m^2}
  frame: {type: inertia, node: frame, inertia: 9 kg*m^2}
  feet:  {type: spring, nodes: [frame, ground], stiffness: 1 MN*m/rad}
  bearing: {type: damper, nodes: [gen, frame], damping: 1e-9}
  fan:   {type: propeller, node: frame, inertia: 1}
operating_point: {speed: {gen: SPEED}}
excitations:
  machine: {type: electric_machine, node: gen, stator: frame, pole_pairs: 2, rated_torque: 2 kN*m, orders: {1: {share: 1 %}}}
scenarios:
  fault: {type: short_circuit, machine: machine, phases: 3, x: 0.2, duration: 20 ms, rate: 10 kHz}
"""


@pytest.mark.parametrize(("speed", "sign"), [("1500 rpm", 1), ("-1500 rpm", -1)])
def test_a_fault_acts_against_the_rotation_and_the_other_way_on_the_stator(speed, sign):
    """Two pole pairs at 1500 rpm are 50 Hz; T_r/x is 10 kN m."""
    model = tn.loads(MACHINE.replace("SPEED", speed))
    record = model.simulate("torque(feet)", scenario="fault")
    assert record.names[0] == "torque on gen against frame"
    torque = record.signals[0].values
    assert torque == pytest.approx(-sign * 1e4 * np.sin(100 * np.pi * record.time), abs=1e-6)
    w, s = np.sqrt(1e6 / 10), 100 * np.pi  # frame and fan on their feet, from rest
    phi = sign * 1e3 / (w**2 - s**2) * (np.sin(s * record.time) - s / w * np.sin(w * record.time))
    assert record.signals[-1].values == pytest.approx(1e6 * phi, abs=1e-4)


def test_a_fan_is_no_electric_machine():
    text = MACHINE.replace("SPEED", "1500 rpm").replace("machine: machine", "machine: fan")
    with pytest.raises(tn.ModelError, match=r":13:41: .*not-applicable"):
        tn.loads(text)


GERMAN = [
    "Drehmoment an crank und Anpressung von clutch über 0.02 s. ",
    "Simuliert: launch, ab dem Betriebspunkt unter den Drehmomenten am ersten Abtastpunkt. ",
    "clamp von clutch ist 300 am Betriebspunkt und 0 vom Beginn an, in SI-Einheiten. ",
]


def test_a_german_report_tells_scenarios_in_german():
    from torsionnet.report import make_report

    model = tn.loads(TIP_IN.replace("duration: 2 s, rate: 10 kHz", "duration: 20 ms, rate: 1 kHz"))
    (section,) = make_report(model, date=None, template=None, sections=["scenarios"], language="de").sections
    assert section.title == ("Bewegung über der Zeit",)
    assert [*section.blocks[1].text] == GERMAN
