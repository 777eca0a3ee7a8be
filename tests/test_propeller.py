"""Propellers: damping by Archer over speed, and entrained water."""

import numpy as np
import pytest

import torsionnet as tn

RPM = np.pi / 30
SHIP = """torsionnet: 1
name: ship
parameters: {{water: 28 %, Q: {{by: load, of: prop}}, n: {{by: speed, of: prop}}}}
elements:
  engine: {{type: inertia, node: fly, inertia: 900 kg*m^2}}
  gear: {{type: gear, nodes: [fly, wheel], ratio: -4.94}}
  shaft: {{type: spring, nodes: [wheel, prop], stiffness: 15 MN*m/rad}}
  screw: {{type: propeller, node: prop, inertia: 6200 kg*m^2, entrained_water: water, {damping}}}
speeds: {{of: fly, range: 300..750 rpm, step: 150 rpm, rated: 750 rpm}}
load: {{absorbed_at: prop, power: 3000 kW, torque_exponent: 2, driven_by: {{fly: 1}}}}
excitations: {{engine: {{type: harmonic, node: fly, orders: {{0.5: {{amplitude: 1 kN*m}}}}}}}}
configurations: {{water: {{dry: {{water: 0}}, wet: {{}}}}}}
"""
ARCHER = "archer: 30, torque: Q, speed: n"


def ship(damping=ARCHER):
    return tn.loads(SHIP.format(damping=damping))


def test_archer_at_rated_speed():
    """37.29 kN m s/rad for a = 30 at 188.7 kN m and 151.8 r/min."""
    value = ship().assembly.system.damping.max()
    assert value == pytest.approx(30 * 188.7e3 / 151.8, rel=2e-4)
    assert value == pytest.approx(37.29e3, rel=2e-4)


def test_damping_follows_torque_over_speed():
    run = ship().order_response("torque(shaft)")
    for place, rpm in enumerate(run.rpm):
        torque = 3e6 / (750 / 4.94 * RPM) * (rpm / 750) ** 2
        given = ship(f"damping: {float(30 * torque / (rpm / 4.94))!r}")
        assert run.values[place] == pytest.approx(
            given.order_response("torque(shaft)", speeds=[rpm * RPM]).values[0], rel=1e-9
        )


def test_water_adds_to_the_inertia():
    for name, factor in (("dry", 1), ("wet", 1.28)):
        system = ship().configured(name).assembly.system
        assert system.inertia.max() == pytest.approx(6200 * factor)


def test_water_takes_no_mean_torque():
    values = ship().mean_response(["torque(screw)", "torque(shaft)"], [750 * RPM]).values[0]
    assert values == pytest.approx([0, -3e6 / (750 / 4.94 * RPM)])


@pytest.mark.parametrize(
    ("damping", "what"),
    [
        ("archer: 30, torque: Q", "needs archer, torque and speed; here is no speed"),
        (ARCHER + ", damping: 3 kN*m*s/rad", "the damping is given or by Archer, not both"),
        ("archer: 30, torque: Q, speed: 150 kg", "not a value of speed"),
    ],
)
def test_what_is_wrong_is_said(damping, what):
    with pytest.raises(tn.ModelError, match=f"8:.*{what}"):
        ship(damping)
