"""A fan on a motor behind a gear: what runs, in numbers small enough to know its torques by heart."""

import json

import numpy as np

RPM = np.pi / 30
ROTOR, WHEEL, STIFFNESS, RATIO = 2.0, 1.0, 1e4, 2.5
"""Inertias in kg m^2 (the wheel's at the fan), N m/rad at the fan, motor over fan."""

MODEL = {
    "torsionnet": 1,
    "name": "fan",
    "parameters": {"k": "10 kN*m/rad", "c": "4 N*m*s/rad", "J": "1 kg*m^2"},
    "elements": {
        "rotor": {"type": "inertia", "node": "motor", "inertia": ROTOR},
        "belt": {"type": "gear", "nodes": ["motor", "pulley"], "ratio": RATIO},
        "shaft": {"type": "spring", "nodes": ["pulley", "fan"], "stiffness": "k", "damping": "c"},
        "wheel": {"type": "inertia", "node": "fan", "inertia": "J"},
        "lock": {"type": "lock", "node": "fan", "enabled": False},
    },
    "sensors": {"T": {"torque": "shaft"}, "twist": {"twist": "shaft"}},
    "speeds": {"of": "motor", "range": "300..1500 rpm", "step": "3 rpm", "rated": "1200 rpm"},
    "excitations": {
        "blades": {"type": "harmonic", "node": "fan", "orders": {order: {"amplitude": 12 / order} for order in range(1, 6)}},
        "poles": {"type": "harmonic", "node": "motor", "orders": {3: {"amplitude": "0.1 N*m", "phase": "40 deg"}}},
    },
    "configurations": {
        "supply": {"mains": {}, "rough": {"poles.orders": {3: {"amplitude": "40 N*m"}}}},
        "rig": {"free": {}, "locked": {"on": ["lock"]}},
    },
}  # fmt: skip


def write(folder):
    """The path of the model file in a folder."""
    path = folder / "fan.json"
    path.write_text(json.dumps(MODEL), encoding="utf-8")
    return path


def shaft_torque(rpm, order):
    """Magnitude in N m of the torque in the shaft by an order of the blades,; speeds of the motor.

    Two inertias at the fan with a spring and a damper between them, a torque on one of them.
    """
    s = 1j * order * rpm * RPM / RATIO
    rotor, between = ROTOR * RATIO**2, STIFFNESS + 4 * s
    return np.abs(12 / order * between * rotor * s**2 / (rotor * WHEEL * s**4 + between * (rotor + WHEEL) * s**2))
