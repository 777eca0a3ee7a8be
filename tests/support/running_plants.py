"""Plants that run: the marine plant and the car with excitations, and two masses for closed forms."""

from pathlib import Path

import numpy as np

import torsionnet as tn
from torsionnet.machinery.excitations.reciprocating_engine import ReciprocatingEngine

FOLDER = Path(__file__).parents[1] / "plants"

_ANGLE = 2 * np.pi * np.arange(720) / 360
PRESSURE = 2.5e5 + 9e6 * np.exp(-((np.degrees(np.minimum(_ANGLE, 4 * np.pi - _ANGLE)) / 30) ** 2))
"""A made-up cycle with its peak at firing top dead centre, a little rounder after it."""
PRESSURE += 3e6 * np.exp(-(((np.degrees(_ANGLE) - 25) / 25) ** 2))
INLINE_SIX = {
    "type": "reciprocating_engine",
    "speed_of": "c1",
    "cycle": 4,
    "cylinders": {number: f"c{number}" for number in range(1, 7)},
    "firing_order": [1, 5, 3, 6, 2, 4],
    "bore": "320 mm",
    "stroke": "400 mm",
    "rod_length": "840 mm",
    "reciprocating_mass": "78 kg",
    "gas": {"fired": PRESSURE.round(1).tolist()},
}


def engine(**changes):
    return ReciprocatingEngine(**{name: value for name, value in {**INLINE_SIX, **changes}.items() if name != "type"})


def marine(excitations, configurations=None):
    """Six-cylinder diesel with damper, gear and propeller, 300 to 788 r/min of the flywheel."""
    plant = tn.load(FOLDER / "marine.yaml")
    return tn.Drivetrain(
        "marine",
        plant.elements.values(),
        parameters=plant.definition.parameters,
        sensors=plant.definition.sensors,
        speeds={"of": "fly", "range": "300..788 rpm", "step": "2 rpm"},
        excitations=excitations,
        configurations=configurations,
    )


def car():
    """Front-wheel-drive car in gear III with the second order of its engine."""
    plant = tn.load(FOLDER / "front_wheel_drive_car.yaml").configured("gear=III,clutch=closed")
    return tn.Drivetrain(
        "car",
        plant.elements.values(),
        parameters=plant.definition.parameters,
        sensors=plant.definition.sensors,
        speeds={"of": "prim", "range": "400..1500 rpm", "step": "5 rpm"},
        excitations={"engine": {"type": "harmonic", "node": "pulley", "orders": {2: {"amplitude": "100 N*m"}}}},
    )


def two_mass(damping):
    """2 and 1 kg m^2 on a shaft of 10 kN m/rad; order 2 acts on the smaller one."""
    return tn.Drivetrain(
        "two masses",
        [
            tn.Inertia("rotor", node="a", inertia=2),
            tn.Inertia("wheel", node="b", inertia=1),
            tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4, damping=damping),
        ],
        speeds={"of": "a", "list": ["400 rpm", "700 rpm"]},
        excitations={"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}},
    )
