"""Propellers: damping by several laws over speed, and entrained water at any pitch."""

import mpmath
import numpy as np
import pytest

import torsionnet as tn
from torsionnet.model.elements import Values

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
    ("damping", "kind"),
    [
        ("archer: 30, torque: Q", "missing-entry"),
        (ARCHER + ", damping: 3 kN*m*s/rad", "contradicting-entries"),
        ("archer: 30, torque: Q, speed: 150 kg", "wrong-unit"),
        (ARCHER + ", exponent: 2", "contradicting-entries"),
        ("torque: Q, speed: n", "needless-entry"),
        ("exponent: 2, torque: Q", "missing-entry"),
        (ARCHER + ", advance_ratio: 0.6", "needless-entry"),
        ("torque_slope: -0.05, torque: Q, speed: n", "missing-entry"),
        ("entrained_inertia: 1 t*m^2", "contradicting-entries"),
        ("pitch_ratio: 0.5", "missing-entry"),
    ],
)
def test_what_is_wrong_is_said(damping, kind):
    with pytest.raises(tn.ModelError, match=f":8:.*{kind}"):
        ship(damping)


def law(**given):
    (found,) = tn.Propeller("screw", node="prop", inertia=6200, **given).parts(Values({}))
    return found


def test_damping_of_a_power_law_is_its_slope():
    found = law(exponent=2.1, torque=188.7e3, speed=15.9).damping
    slope = mpmath.diff(lambda omega: 188.7e3 * (omega / mpmath.mpf("15.9")) ** mpmath.mpf("2.1"), mpmath.mpf("15.9"))
    assert float(found) == pytest.approx(float(slope), rel=1e-12)


def test_open_water_damping_is_the_slope_at_a_kept_speed_of_the_ship():
    """K_Q = 0.05 - 0.04 J of a propeller of 3 m in sea water at 7 m/s."""

    def coefficient(advance):
        return 0.05 - 0.04 * advance

    def torque(omega):
        turns = omega / (2 * mpmath.pi)
        return coefficient(7 / (turns * 3)) * 1025 * 3**5 * turns**2

    omega = 16.0
    advance = 7 * 2 * np.pi / (omega * 3)
    found = law(
        torque_slope=-0.04, torque_coefficient=float(coefficient(advance)), advance_ratio=advance,
        torque=float(torque(omega)), speed=omega,
    ).damping  # fmt: skip
    assert float(found) == pytest.approx(float(mpmath.diff(torque, omega)), rel=1e-12)


def test_water_by_share_or_by_inertia():
    assert law(entrained_water=0.25).inertia == law(entrained_inertia=1550).inertia == 7750


@pytest.mark.parametrize("pitch", [-0.4, 0, 0.3, 0.9, 1.2])
def test_water_is_entrained_by_what_moves_across_the_blade(pitch):
    sine, design = (np.sin(np.arctan(ratio / (0.7 * np.pi))) for ratio in (pitch, 0.9))
    found = law(entrained_water=0.25, pitch_ratio=pitch, design_pitch_ratio=0.9).inertia
    assert float(found) == pytest.approx(6200 * (1 + 0.25 * (sine / design) ** 2), rel=1e-14)
    assert float(law(entrained_inertia=1550, pitch_ratio=pitch, design_pitch_ratio=0.9).inertia) == float(found)
