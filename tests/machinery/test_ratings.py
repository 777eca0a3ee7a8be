"""Powers, speeds and directions that a model states several times: they agree, or the odd one is named."""

import math
import re

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.model.elements import Values

SHIP = """torsionnet: 1
name: ship
parameters:
  Q: {by: load, of: prop}
  n: {by: speed, of: prop}
elements:
  flywheel: {type: inertia, node: fly, inertia: 1000 kg*m^2}
  coupling: {type: spring, nodes: [fly, pin], stiffness: 300 kN*m/rad, damping: 400 N*m*s/rad}
  mesh: {type: gear, nodes: [pin, wheel], ratio: -4.94}
  shaft: {type: shaft, nodes: [wheel, prop], outer_diameter: 345 mm, length: 7.2 m}
  screw: {type: propeller, node: prop, inertia: 7936 kg*m^2, archer: 30, torque: Q, speed: n}
speeds: {of: fly, range: 400..750 rpm, step: 50 rpm, rated: 750 rpm}
load: {absorbed_at: prop, power: 3000 kW, torque_exponent: 2}
excitations:
  engine:
    type: reciprocating_engine
    speed_of: fly
    cycle: 4
    cylinders: {1: fly, 2: fly, 3: fly, 4: fly, 5: fly, 6: fly}
    firing_order: [1, 5, 3, 6, 2, 4]
    bore: 320 mm
    stroke: 400 mm
    rod_length: 840 mm
    gas: {harmonics: {0 bar: {0.5: {cosine: 0 bar, sine: 0 bar}}, 30000 bar: {0.5: {cosine: 0 bar, sine: 1 bar}}}}
    load: {power: 3000 kW, mechanical_efficiency: 0.92, rated: 750 rpm, exponent: 2}
  propeller:
    type: propeller
    node: prop
    blades: 4
    torque: 188.7 kN*m
    rated: 151.8 rpm
    blade_orders: {1: {share: 8 %}}
"""
INDICATED = "load: {mean_indicated_pressure: 27 bar, rated: 750 rpm, exponent: 2}"
POWER = "load: {power: 3000 kW, mechanical_efficiency: 0.92, rated: 750 rpm, exponent: 2}"


def said(text, *severities):
    """What is found, by the entry it is at."""
    found = tn.loads(text).check()
    wanted = severities or ("warning",)
    return {".".join(map(str, one.path)): one.message for one in found if one.severity in wanted and one.path}


def test_powers_that_agree_are_silent():
    assert said(SHIP, "warning", "note") == {}
    assert said(SHIP.replace(POWER, INDICATED), "warning", "note") == {}
    assert said(SHIP.replace("power: 3000 kW, torque", "power: 3100 kW, torque"), "warning", "note") == {}


@pytest.mark.parametrize(
    ("old", "new", "place", "words"),
    [
        (POWER, POWER.replace("3000 kW", "3 kW"), "excitations.engine.load.power",
         ' 3 kW .* 3000 kW .*MW.*"3000 kW"'),
        (POWER, POWER.replace("3000 kW", "3000 MW"), "excitations.engine.load.power", "MW for kW, or kW for W"),
        (POWER, POWER.replace("3000 kW", "2800 kW"), "excitations.engine.load.power", "gives 2800 kW .* takes 3000 kW"),
        (POWER, INDICATED.replace("27", "18"), "excitations.engine.load.mean_indicated_pressure", "kW indicated"),
        ("151.8 rpm", "750 rpm", "excitations.propeller.rated",
         ' 750 rpm, .*prop .* 151.822 rpm .*fly .* 750 rpm: .*fly; .*"151.822 rpm"'),
        ("151.8 rpm", "15.9 rad/s", "excitations.propeller.rated", None),
        ("151.8 rpm", "151.8 rad/s", "excitations.propeller.rated", 'rpm for rad/s. Did you mean "151.822 rpm"'),
        ("0.92, rated: 750 rpm", "0.92, rated: 720 rpm", "excitations.engine.load.rated", "fly turns at 750 rpm"),
        ("188.7 kN*m", "188.7 N*m", "excitations.propeller.torque", 'N.m for kN.m. .*"188.7 kN'),
        ("188.7 kN*m", "38.2 kN*m", "excitations.propeller.torque",
         'propeller .* 607.3 kW .* 3000 kW; .* fly; .*"188'),
        ("188.7 kN*m", "205 kN*m", "excitations.propeller.torque", "propeller takes 3259 kW"),
        ("torque_exponent: 2}", "torque_exponent: 2, rated: 750 rpm}", "load.rated", "that is the speed of fly"),
        ("power: 3000 kW, torque", "power: 3 kW, torque", "load.power",
         ' 3 kW .*"3000 kW"'),
    ],
)  # fmt: skip
def test_the_odd_one_is_named(old, new, place, words):
    """Every slip that is marked alone, at its entry, with both numbers; 15.9 rad/s are 151.8 rpm, and none."""
    assert SHIP.count(old) == 1
    found = said(SHIP.replace(old, new))
    if words is None:
        assert found == {}
        return
    assert list(found) == [place]
    assert tn.loads(SHIP.replace(old, new)).check()  # a warning, no error
    assert re.search(words, found[place]), found[place]


def test_what_the_engine_could_give_besides_is_a_note():
    text = SHIP.replace(POWER, POWER.replace("3000 kW", "3600 kW"))
    assert said(text) == {}
    assert said(text, "note") == {
        "excitations.engine.load.power": "engine gives 3600 kW at rated speed, the load takes 3000 kW from it"
    }


def test_without_a_load_engine_and_propeller_are_compared():
    text = SHIP.replace("load: {absorbed_at: prop, power: 3000 kW, torque_exponent: 2}\n", "")
    text = text.replace("  Q: {by: load, of: prop}\n", "  Q: 188.7 kN*m\n")
    assert said(text) == {}
    (message,) = said(text.replace(POWER, POWER.replace("3000 kW", "3 kW"))).values()
    assert re.match("engine .* 3 kW .* 3000 kW", message)


def test_two_engines_give_their_shares():
    second = SHIP.partition("  engine:")[2].partition("  propeller:")[0]
    text = SHIP.replace("  propeller:\n    type", f"  other:{second}  propeller:\n    type")
    text = text.replace("torque_exponent: 2}", "torque_exponent: 2, driven_by: {engine: 50 %, other: 50 %}}")
    half = text.replace("power: 3000 kW, mech", "power: 1500 kW, mech")
    assert said(half, "warning", "note") == {}
    assert list(said(text, "note")) == ["excitations.engine.load.power", "excitations.other.load.power"]


def test_a_compressor_takes_what_its_gas_does():
    """Indicated power by hand: p V n, one cycle a revolution; below the power at its shaft."""
    volume = math.pi / 4 * 0.3**2 * 0.2
    indicated = 2e5 * volume * 25  # W at 25 rev/s
    text = f"""torsionnet: 1
name: compressor
elements:
  m: {{type: inertia, node: m, inertia: 10}}
  k: {{type: spring, nodes: [m, c], stiffness: 1e6, damping: 10}}
  c: {{type: inertia, node: c, inertia: 10}}
speeds: {{of: m, list: [1500 rpm], rated: 1500 rpm}}
load: {{absorbed_at: c, power: POWER, torque_exponent: 0, driven_by: {{m: 1}}}}
excitations:
  gas:
    type: reciprocating_engine
    speed_of: c
    cycle: 2
    cylinders: {{1: c}}
    firing_order: [1]
    bore: 300 mm
    stroke: 200 mm
    rod_length: 500 mm
    gas: {{fired: {[round(1e5 + 4e5 * (i >= 36)) for i in range(72)]}, reference: gauge}}
"""
    # 1 bar while the piston goes down, 5 bar while it comes up.
    mean = (1e5 - 5e5) * volume * 25
    assert mean == pytest.approx(-2 * indicated)
    assert said(text.replace("POWER", f"{-mean * 1.1} W")) == {}
    assert list(said(text.replace("POWER", f"{-mean * 0.8} W"))) == ["excitations.gas.gas.fired"]


@pytest.mark.parametrize(("torques", "wrong"), [
    ("{fly: 38.2 kN*m, prop: 188.7 kN*m}", []), ("{fly: -38.2 kN*m, prop: -188.7 kN*m}", ["fly", "prop"]),
])  # fmt: skip
def test_torques_that_act_the_wrong_way(torques, wrong):
    """Behind the gear the propeller turns in the negative sense: what it takes is a positive torque."""
    text = SHIP.replace("load: {absorbed_at: prop, power: 3000 kW, torque_exponent: 2}\n", "")
    text = text.replace("{by: load, of: prop}", "188.7 kN*m")
    found = said(text + f"operating_point: {{speed: {{fly: 750 rpm}}, torque: {torques}}}\n")
    assert list(found) == [f"operating_point.torque.{node}" for node in wrong]
    if wrong:
        assert found["operating_point.torque.fly"] == (
            "-38200 N*m act against the rotation of fly, 750 rpm, but engine drives there; did you mean 38200 N*m?"
        )
        assert "act in the rotation of prop, -151.822 rpm, but" in found["operating_point.torque.prop"]


@pytest.mark.parametrize("said", ["propeller.condition: zero_pitch", "propeller.torque: 37.74 kN*m"])
def test_a_condition_of_less_torque_is_asked_for_its_damping(said):
    """At zero pitch the load is 20 % of full ahead, the propeller says so, too; Archer's damping does not hold."""
    text = SHIP.replace("    torque: 188.7", "    pitch: controllable\n    conditions: {zero_pitch: {torque: 20 %, "
                        "blade_orders: {1: {share: 10 %}}}}\n    torque: 188.7")  # fmt: skip
    text += "configurations: {pitch: {full: {}, zero: {load.power: 600 kW, SAID}}}\n".replace("SAID", said)
    (found,) = (one for one in tn.loads(text).check() if one.severity == "warning")
    assert found.path == ("configurations", "pitch", "zero", "load.power")
    assert "37.74 kN*m, 20% of" in found.message
    forgotten = text.replace("load.power: 600 kW, ", "").replace(said, "propeller.condition: zero_pitch")
    (found,) = (one for one in tn.loads(forgotten).check() if one.severity == "warning")
    assert re.search("propeller .* 600 kW .* 3000 kW", found.message)


def test_a_condition_has_a_torque_curve_and_a_damping_of_its_own():
    """At half the speed 0.2 Q (1/2)^1.5 of blade order 1, and the load's own 0.2 Q (1/2)^1.5."""
    text = SHIP.replace("    torque: 188.7", "    pitch: controllable\n    conditions: {zero_pitch: {torque: 20 %, "
                        "exponent: 1.5, blade_orders: {1: {share: 10 %}}}}\n    torque: 188.7")  # fmt: skip
    text += """configurations:
  pitch:
    full: {}
    zero: {load.power: 600 kW, load.torque_exponent: 1.5, propeller.condition: zero_pitch, screw.archer: null,
           screw.torque: null, screw.speed: null, screw.damping: 12 kN*m*s/rad}
"""
    ship = tn.loads(text)
    assert [one.message for one in ship.check() if one.severity == "warning"] == []
    zero = ship.configured("zero")
    found = zero.definition.excitations["propeller"].torques(np.array([75.9]) * math.pi / 30)
    assert found.amplitudes[0, 0, 0] == pytest.approx(-0.1 * 0.2 * 188.7e3 * 0.5**1.5)
    mean = zero.mean_response("torque(shaft)", speeds=[375 * math.pi / 30])
    assert abs(mean.values[0, 0]) == pytest.approx(600e3 / (750 / 4.94 * math.pi / 30) * 0.5**1.5)
    (law,) = zero.elements["screw"].parts(Values(zero.exact_values))
    assert float(law.damping) == 12e3


@pytest.mark.parametrize("stated", ["load", "operating_point"])
@pytest.mark.parametrize(("speed", "warns"), [("151.8 rpm", False), ("151 rpm", True)])
def test_an_element_calculated_at_a_speed_of_its_own_is_compared(speed, warns, stated):
    """The propeller's damping of 151 rpm, 0.54 % beside the 151.822 rpm at which it turns behind the gear."""
    text = SHIP.replace("  n: {by: speed, of: prop}\n", "").replace("speed: n", f"speed: {speed}")
    if stated == "operating_point":
        text = text.replace("load: {absorbed_at: prop, power: 3000 kW, torque_exponent: 2}\n", "")
        text = text.replace("  Q: {by: load, of: prop}\n", "  Q: 188.7 kN*m\n")
        text += "operating_point: {speed: {fly: 750 rpm}}\n"
    found = said(text).get("elements.screw.speed")
    words = "screw is calculated at 151 rpm, but turns at 151.822 rpm with fly at 750 rpm"
    assert found == (words if warns else None)
